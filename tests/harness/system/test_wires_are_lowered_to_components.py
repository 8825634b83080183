"""Imperfections and delays become components named after the wire's target, in order."""

import numpy as np
import pytest

from harness.instruments.imperfections import make_imperfection
from harness.system.graph import SignalComponent
from harness.system.lowering import DelayComponent, lower
from tests.harness.master.mock import Input, MockFmu, Output
from tests.harness.master.rows import run
from tests.harness.master.small_systems import MS, controller, fmu, system, wire

NOISE = make_imperfection("noise", {"std": 0.5})
BIAS = make_imperfection("bias", {"value": 2.0})


def parts(*imperfections: object, delay_ns: int = 0, unit: str | None = None):  # type: ignore[no-untyped-def]
    fmus = {"plant": MockFmu((Input("u", unit=unit),), (Output("y", unit="m"),), state=3.0)}
    loop = system(
        fmu(), controller(lambda time, y: y, 20 * MS, start=7.0),
        wire("plant.y", "controller.y", 0, *imperfections),
        wire("controller.u", "plant.u", delay_ns),
    )  # fmt: skip
    return loop, fmus


def test_names_rates_and_order() -> None:
    loop, fmus = parts(BIAS, NOISE, NOISE, delay_ns=5 * MS)
    lowered = lower(loop, {name: one.description for name, one in fmus.items()})
    made = {c.name: c for c in lowered.components[2:]}
    assert list(made) == [
        "controller.y/bias", "controller.y/noise", "controller.y/noise.source",
        "controller.y/noise2", "controller.y/noise2.source", "plant.u/delay",
    ]  # fmt: skip
    assert all(c.period_ns == 20 * MS for c in made.values()), "the rate of the reader"
    delay = made["plant.u/delay"]
    assert isinstance(delay, DelayComponent)
    assert (delay.phase_ns, delay.source_phase_ns) == (5 * MS, 0)
    assert isinstance(made["controller.y/noise.source"], SignalComponent)
    path = [str(w.source) for w in lowered.wires if "source" not in str(w.source)]
    assert path == [
        "plant.y", "controller.y/bias.out", "controller.y/noise.out", "controller.y/noise2.out",
        "controller.u", "plant.u/delay.out",
    ]  # fmt: skip


def test_true_and_measured_values_are_both_recorded() -> None:
    rows = run(*parts(BIAS))
    assert np.array_equal(rows["controller.y"][::2], rows["plant.y"][::2] + 2.0)


def test_two_noises_on_one_wire_are_not_the_same_noise() -> None:
    once = run(*parts(NOISE))["controller.y"]
    twice = run(*parts(NOISE, NOISE))["controller.y"]
    plain = run(*parts())["controller.y"]
    assert once[0] != plain[0]
    assert twice[0] - once[0] != once[0] - plain[0]


@pytest.mark.parametrize("imperfections", [(), (BIAS,), (NOISE, BIAS)])
def test_before_the_first_arrival_a_delayed_wire_carries_the_initial_value(
    imperfections: tuple[object, ...],
) -> None:
    fmus = {"plant": MockFmu(state=3.0)}
    delayed = system(
        fmu(), controller(lambda time, y: y), wire("plant.y", "controller.y", 30 * MS,
                                                   *imperfections),
    )  # fmt: skip
    rows = run(delayed, fmus)
    assert rows["controller.y"][:3].tolist() == [3.0] * 3


def test_the_wire_is_converted_at_its_end() -> None:
    fmus = {
        "plant": MockFmu(outputs=(Output("y", unit="m"),), state=3.0),
        "other": MockFmu((Input("u", unit="mm"),)),
    }
    loop = system(fmu(), fmu("other"), wire("plant.y", "other.u", 20 * MS, BIAS))
    rows = run(loop, fmus)
    expected = 1 / 1e-3 * (rows["plant.y"] + 2.0)  # the bias is in the unit of the source
    assert rows["other.u"][2:].tobytes() == expected[:-2].tobytes()
