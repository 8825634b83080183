"""The fuzzy systems of the drive as maps to draw: Figs 3–5 of Serkies & Szabat 2013."""

from __future__ import annotations

from dataclasses import dataclass

from controllers.core.block import Block, Signal
from controllers.fuzzy.map_block import fuzzy_map_block
from controllers.kalman.gain_adaptation import GainAdaptation
from controllers.papers.serkies2013.inertia_estimator import FuzzyInertiaEstimator


@dataclass(frozen=True, kw_only=True)
class FuzzyInertiaTables(FuzzyInertiaEstimator):
    """The rules of `FuzzyInertiaEstimator` alone: (er, ω_ref) to T_2, k_T, q and r."""

    def block(self, sample_time: float) -> Block:
        """The block, for any sample time."""
        return fuzzy_map_block(
            self.system(),
            (Signal("er", "1", "integral of (11)"), Signal("reference", "1", "ω_ref")),
            (
                Signal("load_time_constant", "s", "T_2"),
                Signal("k_t", "1/s", "k_T"),
                Signal("q_scale", "1", "factor of Q"),
                Signal("r_scale", "1", "factor of R"),
            ),
        )


@dataclass(frozen=True, kw_only=True)
class GainAdaptationCurve(GainAdaptation):
    """The curve of `GainAdaptation` alone: D̄² to the factor g of the Kalman gain."""

    def block(self, sample_time: float) -> Block:
        """The block, for any sample time."""
        return fuzzy_map_block(
            self.system(), (Signal("distance", "1", "D̄²"),), (Signal("gain_factor", "1", "g"),)
        )
