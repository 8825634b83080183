"""Faults in the description of an identifier name the field, what is legal and what came."""

import numpy as np
import pytest

from controllers.core.errors import ControllerError
from controllers.fuzzy.inference import Rule
from controllers.fuzzy.takagi_sugeno import TakagiSugeno, grid, partition
from controllers.identification.adaptation import Adaptation
from controllers.identification.identifier import Identifier
from controllers.identification.narx import Lags
from controllers.identification.offline import Uncertainty, identify


@pytest.mark.parametrize(
    ("fields", "named"),
    [
        ({"measured": ("a", "a"), "measured_ranges": ((0, 1),) * 2}, "measured, exogenous"),
        ({"measured_ranges": ()}, "measured_ranges"),
        ({"measured_ranges": ((1.0, 1.0),)}, "range"),
        ({"exogenous_lags": 0}, "exogenous_lags"),
        ({"measured_lags": 0}, "output_lags"),
        ({"memberships": {"y_3": 2}}, "'y_1', 'y_2', 'u_1', 'u_2'"),
        ({"memberships": {"y_1": 0}}, "count"),
        ({"kind": "round"}, "'gaussian'"),
        ({"adapt": "everything"}, "'consequents'"),
        ({"filter": "ukf"}, "'robust_ekf'"),
        ({"noise_std": (0.0,)}, "noise_std"),
        ({"noise_std": (0.1, 0.1)}, "noise_std"),
        ({"start_sensitivity": ((1.0, 2.0),)}, "start_sensitivity"),
        ({"sensitivity_bounds": (2.0, 1.0)}, "sensitivity_bounds"),
        ({"width_range": (1.5, 2.0)}, "width_range"),
        ({"learn_until": -1.0}, "learn_until"),
        ({"model": grid([()], [[0.0, 0.0]])}, "Identifier.model"),
    ],
)
def test_identifier(fields: dict[str, object], named: str) -> None:
    with pytest.raises(ControllerError, match=named):
        Identifier(**fields)


def test_model_and_rows() -> None:
    model = grid([partition("gaussian", 2)], [[0.0, 1.0]])
    with pytest.raises(ControllerError, match="2 coefficients"):
        TakagiSugeno(model.inputs, (((1.0,),),), (Rule((0,), (0,)),))
    with pytest.raises(ControllerError, match="antecedents"):
        TakagiSugeno(model.inputs, model.models, (Rule((2,), (0,)),))
    with pytest.raises(ControllerError, match=r"shape \(k, 1\)"):
        model.evaluate(np.zeros((3, 2)))
    with pytest.raises(ControllerError, match="with_theta"):
        model.with_theta(np.zeros(3))
    adaptation = Uncertainty().adaptation(model, (1.0,))
    with pytest.raises(ControllerError, match="rows X, Y"):
        identify(model, np.zeros((3, 1)), np.zeros((2, 1)), adaptation)
    with pytest.raises(ControllerError, match="series"):
        Lags().rows(np.zeros((2, 1)), np.zeros((2, 1)))


@pytest.mark.parametrize(
    ("fields", "named"),
    [
        ({"noise": np.zeros(2)}, "noise"),
        ({"variance": np.full(3, -1.0)}, "variance"),
        ({"variance": np.zeros(3)}, "variance"),
        ({"r": (0.0,)}, "Adaptation.r"),
        ({"lower": np.ones(3), "upper": np.zeros(3)}, "lower"),
    ],
)
def test_adaptation(fields: dict[str, object], named: str) -> None:
    legal = {"variance": np.ones(3), "noise": np.zeros(3), "r": (1.0,)}
    with pytest.raises(ControllerError, match=named):
        Adaptation(**{**legal, **fields})
