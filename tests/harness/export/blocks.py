"""Blocks as the experiments configure them, one of each kind of controller and estimator."""

from __future__ import annotations

from functools import cache

from harness import registry
from harness.experiment.experiment import Experiment
from harness.system.graph import BlockComponent

CASES = {
    "pid": ("ahn2009/figure_11", "pid", "controller"),
    "fuzzy_pid": ("ahn2009/figure_11", "fuzzy_pid", "controller"),
    "tuned_fuzzy_pid": ("ahn2009/figure_11", "robust_ekf", "controller"),
    "state_controller": ("serkies2013/figure_10", "fuzzy", "controller"),
    "kalman": ("serkies2013/figure_7", "fixed", "kalman"),
    "inertia_estimator": ("serkies2013/figure_10", "fuzzy", "inertia_estimator"),
    "encoder": ("serkies2013/figure_10", "fuzzy", "encoder"),
    "augmented_choosing": ("takata/figure_1", "n_3", "controller"),
    "lq_regulator": ("takata/figure_3", "loc", "controller"),
    "power_filter": ("takata/figure_3", "aaccf", "filter"),
    "servo_filter": ("raheem2013/figure_10", "matched", "filter"),
    "identifier": ("barragan/narendra_parthasarathy", "linear", "identifier"),
}


@cache
def component(case: str) -> BlockComponent:
    """The component of one of `CASES`."""
    experiment, variant, name = CASES[case]
    system = Experiment.load(registry.experiment(experiment)).bench(variant).system()
    found = next(c for c in system.components if c.name == name)
    assert isinstance(found, BlockComponent)
    return found
