"""d y(t + h) / d u(t) of a held input: against scipy's matrix exponential, and against finite
differences over one sample of the lead plant, which agree where the Jacobian holds for a sample."""

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from harness import registry
from harness.bench import Bench
from harness.fmi.binding.instance import FmuInstance
from harness.fmi.fmu import Fmu
from harness.participants.sensitivity import sampled_sensitivity


def kernel(jacobian: np.ndarray, nominal: np.ndarray, h: float) -> float:
    n = nominal.size
    y = np.zeros(1)
    work = np.full(3 * (n + 1) ** 2, np.nan)
    sampled_sensitivity(np.array([n, h, *nominal]), work, jacobian.T.ravel().copy(), y)
    return float(y[0])


@settings(max_examples=150, deadline=None, derandomize=True)
@given(st.integers(0, 2**31), st.integers(1, 6), st.floats(-4.0, 0.0))
def test_kernel_agrees_with_scipy_on_stiff_badly_scaled_systems(
    seed: int, n: int, log_step: float
) -> None:
    """Time constants over six decades, states over ten."""
    random = np.random.default_rng(seed)
    modes = np.diag(-(10.0 ** random.uniform(-2, 4, n)))
    basis = np.linalg.qr(random.normal(size=(n, n)))[0]
    a, b = basis @ modes @ basis.T, random.normal(size=n)
    c, d, h = random.normal(size=n), random.normal(), 10.0**log_step
    scale = 10.0 ** random.uniform(-5, 5, n)
    augmented = np.zeros((n + 1, n + 1))
    augmented[:n, :n], augmented[:n, n] = a, b
    exact = c @ expm(augmented * h)[:n, n] + d
    jacobian = np.zeros((n + 1, n + 1))
    jacobian[:n, :n] = a * scale[:, None] / scale
    jacobian[:n, n], jacobian[n, :n], jacobian[n, n] = b * scale, c / scale, d
    size = abs(d) + np.abs(c).sum() * h * np.abs(b).max()
    assert kernel(jacobian, scale, h) == pytest.approx(exact, abs=1e-11 * size, rel=1e-11)


def test_pure_integrators_give_the_polynomial() -> None:
    chain = np.diag(np.ones(4), 1)  # x1' = x2, x2' = x3, x3' = x4, x4' = u
    chain[4] = [1, 0, 0, 0, 0]
    assert kernel(chain, np.ones(4), 0.5) == pytest.approx(0.5**4 / 24, rel=1e-14)


def command(time: float) -> float:
    return 0.3 if time >= 0.02 else 0.0


@pytest.fixture(scope="module", params=[2, 3])
def version(request: pytest.FixtureRequest) -> int:
    return int(request.param)


def slopes_of_the_loop(fmi_version: int) -> np.ndarray:
    bench = Bench(stop_time=0.2, step=0.01, fmi_version=fmi_version)
    bench.fmu("plant", "hybrid_actuator", tolerance=1e-10)
    bench.controller("drive", command)
    bench.connect("drive.u", "plant.command")
    bench.sensitivity("slope", of="plant.force", to="plant.command")
    return bench.run()["slope.value"]


@contextmanager
def plant_at(k: int, fmi_version: int) -> Iterator[FmuInstance]:
    """The plant at sample k of the loop, before the command of that sample is applied."""
    path = registry.plant("hybrid_actuator").fmu(fmi_version)
    with Fmu(path) as fmu, fmu.instantiate("plant") as instance:
        instance.enter_initialization_mode(0.0, 0.2, 1e-10)
        instance.exit_initialization_mode()
        for i in range(k):
            instance.set({"command": command(i / 100)})
            instance.do_step(i / 100, 0.01)
        yield instance


def test_in_the_loop_it_is_that_of_the_fmus_own_jacobian(version: int) -> None:
    """Also in the transient after the command's step, where the Jacobian changes fast."""
    found = slopes_of_the_loop(version)
    for k in (0, 3, 5, 15):
        with plant_at(k, version) as instance:
            names, rates = zip(*instance.description.states, strict=True)
            unknowns = [*rates, "force"]
            columns = [instance.directional_derivative(unknowns, x) for x in (*names, "command")]
        m = len(columns)
        jacobian = np.array(columns).T
        scale = np.array([1.0, *(1e-6 for _ in names[1:]), 1.0])
        a = np.zeros((m, m))
        a[:-1] = jacobian[:-1]
        a = a * scale / scale[:, None]  # another scaling than the kernel's
        exact = jacobian[-1, :-1] @ (scale[:-1] * expm(0.01 * a)[:-1, -1]) + jacobian[-1, -1]
        assert found[k] == pytest.approx(exact, rel=1e-7), k


def test_at_rest_it_is_the_slope_of_the_plant_over_one_sample(version: int) -> None:
    with plant_at(0, version) as instance:
        state, forces = instance.get_state(), []
        for change in (1e-5, -1e-5):
            instance.set_state(state)
            instance.set({"command": change})
            instance.do_step(0.0, 0.01)
            forces.append(instance.get("force"))
        instance.free_state(state)
    slope = (forces[0] - forces[1]) / 2e-5
    assert slopes_of_the_loop(version)[0] == pytest.approx(slope, rel=1e-6)
