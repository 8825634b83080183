"""One instance of a real FMU: values, life cycle, state and derivatives, FMI 2 and FMI 3 alike."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

from harness.errors import FmuError
from harness.fmi.binding.instance import FmuInstance
from harness.fmi.binding.library import platform_tuple
from harness.fmi.fmu import Fmu
from tests.harness.fmi.archives import member, oscillator_fmu, rewritten

MASS, DAMPING, STIFFNESS = 2.0, 1.5, 80.0
A = np.array([[0.0, 1.0], [-STIFFNESS / MASS, -DAMPING / MASS]])


@pytest.fixture(params=[2, 3])
def fmu(request: pytest.FixtureRequest) -> Iterator[Fmu]:
    with Fmu(oscillator_fmu(request.param)) as opened:
        yield opened


@pytest.fixture
def running(fmu: Fmu) -> Iterator[FmuInstance]:
    with fmu.instantiate("mass") as instance:
        instance.enter_initialization_mode(0.0, 1.0, None)
        instance.exit_initialization_mode()
        yield instance


def test_steps_follow_the_matrix_exponential(running: FmuInstance) -> None:
    state = np.array([0.1, 0.0])
    for k in range(20):
        running.do_step(k / 100, 0.01)
        state = expm(0.01 * A) @ state
        assert running.get("position") == pytest.approx(state[0], abs=1e-7)


def test_start_values_of_parameters_are_set_before_initialisation(fmu: Fmu) -> None:
    with fmu.instantiate("mass") as instance:
        instance.set({"stiffness": 200, "mass": 4.0})
        instance.enter_initialization_mode(0.0, None, 1e-6)
        instance.exit_initialization_mode()
        assert instance.get("acceleration") == pytest.approx(-0.1 * 200 / 4)
        assert instance.get("stiffness") == 200.0


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"stifness": 1.0}, "has no variable 'stifness'; did you mean 'stiffness'?"),
        ({"mass": "heavy"}, "component mass: variable 'mass' of type .* cannot be set to 'heavy'"),
        ({"mass": [1.0, 2.0]}, r"variable 'mass' has 1 element\(s\), but 2 value\(s\) were given"),
        ({"mass": None}, "cannot be set to None"),
    ],
)
def test_values_that_cannot_be_meant(running: FmuInstance, values: object, words: str) -> None:
    with pytest.raises(FmuError, match=words):
        running.set(values)  # type: ignore[arg-type]


def test_a_snapshot_brings_back_every_bit(running: FmuInstance) -> None:
    running.set({"force": 3.0})
    running.do_step(0.0, 0.01)
    state = running.get_state()
    first = [running.do_step(0.01 * k, 0.01) or running.get("position") for k in range(1, 6)]
    running.set({"force": -50.0})
    running.do_step(0.06, 0.01)
    running.set_state(state)
    again = [running.do_step(0.01 * k, 0.01) or running.get("position") for k in range(1, 6)]
    running.free_state(state)
    assert first == again


def test_directional_derivatives_are_the_matrices(running: FmuInstance) -> None:
    rates, names = [d for _, d in running.description.states], ["position", "velocity"]
    assert [name for name, _ in running.description.states] == names
    columns = [running.directional_derivative(rates, name) for name in names]
    assert np.allclose(np.array(columns).T, A, rtol=1e-14)
    assert np.allclose(running.directional_derivative(rates, "force", 4.0), [0.0, 4.0 / MASS])
    assert running.directional_derivative(["acceleration"], "force")[0] == 1 / MASS


def test_reset_starts_again(running: FmuInstance) -> None:
    running.do_step(0.0, 0.5)
    moved = running.get("position")
    running.reset()
    running.enter_initialization_mode(0.0, 1.0, None)
    running.exit_initialization_mode()
    assert running.get("position") == 0.1 != moved


def test_after_free_and_after_fatal_nothing_is_called(fmu: Fmu) -> None:
    first, second = fmu.instantiate("first"), fmu.instantiate("second")
    first.free()
    first.free()
    with pytest.raises(FmuError, match=r"component second: .*Dummy returned Fatal"):
        second.check(4, "Dummy")
    with pytest.raises(FmuError, match="reported Fatal before and cannot be called"):
        second.terminate()
    second.free()


def test_fatal_in_one_instance_ends_all_of_that_library(fmu: Fmu) -> None:
    """The standard: the model computations are irreparably corrupted for all instances."""
    first, second = fmu.instantiate("first"), fmu.instantiate("second")
    first.mark_dead()
    with pytest.raises(FmuError, match=r"component second.*Fatal before and cannot be called"):
        second.get("position")
    second.free()


def test_a_missing_library_names_the_platforms_that_are_there(tmp_path: Path) -> None:
    source = oscillator_fmu(3)
    here = f"binaries/{platform_tuple()}/oscillator.so"
    made = tmp_path / "foreign.fmu"
    elsewhere = {"binaries/riscv64-plan9/oscillator.so": member(source, here)}
    rewritten(source, made, **{here: None, **elsewhere})  # type: ignore[arg-type]
    with Fmu(made) as fmu, pytest.raises(FmuError, match="it has riscv64-plan9") as caught:
        fmu.instantiate("mass")
    assert platform_tuple() in str(caught.value)


def test_a_library_that_is_none_gives_the_loaders_reason(tmp_path: Path) -> None:
    here = f"binaries/{platform_tuple()}/oscillator.so"
    made = rewritten(oscillator_fmu(3), tmp_path / "a.fmu", **{here: b"no ELF"})
    with Fmu(made) as fmu, pytest.raises(FmuError, match=r"oscillator\.so of the FMU cannot be"):
        fmu.instantiate("mass")


def test_a_missing_function_is_named(running: FmuInstance) -> None:
    with pytest.raises(FmuError, match=rf"has no function {running.prefix}DoStepTwice"):
        running.address("DoStepTwice")


def test_what_an_fmu_cannot_do_is_said_with_its_own_reason(fmu: Fmu) -> None:
    wrong = object.__new__(type(fmu.description))
    wrong.__dict__.update(vars(fmu.description) | {"token": "another"})
    fmu.description = wrong
    with pytest.raises(FmuError, match="component mass: FMU oscillator could not be instantiated"):
        fmu.instantiate("mass")
