"""The state controller of the two-mass drive, retuned for the T_2 in force: (4)–(8) of Serkies &
Szabat 2013. The law is `controllers.state_space.state_feedback`, the gains are those of `two_mass`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from controllers.core.block import Block, Signal
from controllers.core.errors import require_positive
from controllers.papers.serkies2013.two_mass import two_mass_gains, two_mass_gains_as_printed
from controllers.state_space.state_feedback import state_feedback_block


@dataclass(frozen=True, kw_only=True)
class TwoMassController:
    """State controller of the two-mass drive by (5)–(8), retuned at each sample for its T_2.

    resonant_frequency     ω_r, magnitude of the double pole pair [rad/s]
    damping                ξ of the pair
    motor_time_constant    T_1 [s];  shaft_time_constant  T_c [s]
    u_min, u_max           limits of the torque reference
    bumpless               keep the control where it is when T_2 changes
    as_printed             take (7) and (8) with their misprints, which place no poles

    Inputs: reference, measured (ω_2), motor_speed, shaft_torque, load_speed, load_time_constant.
    """

    resonant_frequency: float
    damping: float
    motor_time_constant: float
    shaft_time_constant: float
    u_min: float = -math.inf
    u_max: float = math.inf
    bumpless: bool = True
    as_printed: bool = False

    def __post_init__(self) -> None:
        """Raise `ControllerError` for values that cannot be meant."""
        for name in (
            "resonant_frequency", "damping", "motor_time_constant", "shaft_time_constant",
        ):  # fmt: skip
            require_positive(f"TwoMassController.{name}", getattr(self, name))

    def block(self, sample_time: float) -> Block:
        """The block for this sample time [s]."""
        p = np.array(
            [
                self.motor_time_constant,
                self.shaft_time_constant,
                self.resonant_frequency,
                self.damping,
            ]
        )
        states = (
            Signal("motor_speed", "1", "ω_1"),
            Signal("shaft_torque", "1", "m_s"),
            Signal("load_speed", "1", "ω_2"),
        )
        # until T_2 is known the load is taken to be as heavy as the motor
        scheduled = (Signal("load_time_constant", "s", "T_2 in force", self.motor_time_constant),)
        gains = two_mass_gains_as_printed if self.as_printed else two_mass_gains
        return state_feedback_block(
            gains, p, states, scheduled, sample_time=sample_time,
            u_min=self.u_min, u_max=self.u_max, bumpless=self.bumpless,
        )  # fmt: skip
