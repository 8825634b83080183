"""Models by name, their linear models about a point, and measurements of states.

For dx/dt = f(x, u) with n states and r inputs, about (x_s, u_s):

    dx/dt ≈ A·x + B·u + w,   A = ∂f/∂x,  B = ∂f/∂u,  w = f(x_s, u_s) − A·x_s − B·u_s

B is exact where u enters linearly, f(x, u) = f(x) + g(x)·u, which `affine` demands.

This module refuses to know a plant, a filter and a design.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from controllers.core.block import Array, Signal
from controllers.core.errors import ControllerError, require
from controllers.kalman.estimator import Measurement, Model
from controllers.kalman.linear_model import linear_measurement, linear_model


@dataclass(frozen=True, eq=False)
class Affine:
    """A (n, n), B (n, r) and w (n,) of dx/dt ≈ A·x + B·u + w."""

    A: Array
    B: Array
    w: Array


def find_model(source: str | Model, parameters: Mapping[str, Any]) -> Model:
    """The model that `source` names.

    `source` is a model, or "package.module:Class" of a class that takes `parameters` by keyword
    and has a method `model()`. Raises `ControllerError` where there is no such thing.
    """
    if isinstance(source, Model):
        require(not parameters, "model_parameters", "none beside a ready model", dict(parameters))
        return source
    module, _, name = source.partition(":")
    try:
        kind = getattr(importlib.import_module(module), name)
        made = kind(**parameters).model()
    except ControllerError:
        raise
    except (ImportError, AttributeError, TypeError, ValueError) as fault:
        raise ControllerError(
            f"model {source!r}: expected 'package.module:Class' with a method model(), and the "
            f"parameters it takes; {fault}."
        ) from fault
    require(isinstance(made, Model), f"model {source!r}", "a Model from its method model()", made)
    return made  # type: ignore[no-any-return]


def rate(model: Model, x: Array, u: Array) -> Array:
    """f(x, u), shape (n,)."""
    out = np.empty(len(model.states))
    model.rate(model.parameters, np.asarray(x, dtype=np.float64), u, out)
    return out


def affine(model: Model, point: Sequence[float]) -> Affine:
    """The linear model about (`point`, 0); raises `ControllerError` where f is not affine in u."""
    n, r = len(model.states), len(model.inputs)
    x = np.asarray(point, dtype=np.float64)
    require(x.shape == (n,), "linear model: point", f"{n} numbers, one a state", tuple(point))
    flat = np.empty(n * n)
    model.jacobian(model.parameters, x, np.zeros(r), flat)
    A = flat.reshape(n, n)
    at_rest = rate(model, x, np.zeros(r))
    B = np.empty((n, r))
    for j, unit in enumerate(np.eye(r)):
        B[:, j] = rate(model, x, unit) - at_rest
        bent = rate(model, x, -unit) - at_rest + B[:, j]
        legal = np.abs(bent).max() <= 1e-9 * (np.abs(at_rest).max() + np.abs(B[:, j]).max())
        require(bool(legal), f"linear model at {tuple(point)}: input {model.inputs[j].name}",
                "a rate that is affine in it", bent.tolist())  # fmt: skip
    return Affine(A, B, at_rest - A @ x)


def linearised(model: Model) -> Model:
    """The linear model about x = 0, u = 0, where f must be 0; its noise is that at 0 too."""
    n, r = len(model.states), len(model.inputs)
    about = affine(model, np.zeros(n).tolist())
    require_rest(model)
    G = np.zeros(n * len(model.noises))
    model.noise(model.parameters, np.zeros(n), np.zeros(r), G)
    return linear_model(
        model.states, model.inputs, model.noises, about.A, about.B, G.reshape(n, -1)
    )


def require_rest(model: Model) -> None:
    """Raise `ControllerError` unless f(0, 0) = 0."""
    drift = rate(model, np.zeros(len(model.states)), np.zeros(len(model.inputs)))
    legal = bool(np.abs(drift).max() < 1e-9)
    require(legal, "model at x = 0, u = 0", "an equilibrium, f(0) = 0", drift.tolist())


def measure_states(model: Model, names: Sequence[str], R: Array) -> Measurement:
    """Measurement of some states, each the input `measured_…` with noise of covariance R (m, m)."""
    known = [state.name for state in model.states]
    for name in names:
        require(name in known, "measured", "names of states: " + ", ".join(known), name)
    chosen = [known.index(name) for name in names]
    signals = tuple(
        Signal(f"measured_{s.name}", s.unit, f"what the sensor reads: {s.description}")
        for s in (model.states[i] for i in chosen)
    )
    return linear_measurement(signals, np.eye(len(known))[chosen], R)
