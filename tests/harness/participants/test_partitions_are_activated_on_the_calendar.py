"""Partitions of an FMU in scheduled execution run when their clocks tick, also inside of a step."""

import re
from fractions import Fraction
from pathlib import Path

import pytest

from harness import Bench, simulate
from harness.errors import FmuError
from tests.every_way.models import PARTITIONS, fmu, needs_compiler
from tests.harness.fmi.archives import member, rewritten

pytestmark = needs_compiler
EIGHTH = Fraction(1, 8)


def totals(stop: Fraction) -> list[tuple[float, int]]:
    """`fast` counts 1 every 1/8 s, `slow` 100 every 1/4 s, `down` 10000 a sixteenth after every
    third tick of `fast`: time (s) and the count after it, of every tick until `stop`."""
    times = [k * EIGHTH / 2 for k in range(int(stop / EIGHTH) * 2 + 1)]
    found, count = [], 0
    for time in times:
        fast, slow = time % EIGHTH == 0, time % (2 * EIGHTH) == 0
        down = (time - EIGHTH / 2) % (3 * EIGHTH) == 2 * EIGHTH
        count += fast + 100 * slow + 10000 * down
        if fast or down:
            found.append((float(time), count))
    return found


@pytest.mark.parametrize("step", [0.25, 1.0])
def test_each_tick_inside_of_a_step_is_a_row(step: float) -> None:
    result = simulate(fmu(PARTITIONS, 3, "all"), stop_time=1.0, step_size=step)
    assert list(zip(result.time, result["total"], strict=True)) == totals(Fraction(1))


def test_the_step_is_that_of_the_fastest_clock_where_nothing_is_said(tmp_path: Path) -> None:
    source = fmu(PARTITIONS, 3, "all")
    xml = re.sub(rb' stepSize="[^"]*"', b"", member(source, "modelDescription.xml"))
    silent = rewritten(source, tmp_path / "silent.fmu", modelDescription_dot_xml=xml)
    result = simulate(silent, stop_time=1.0)
    assert result.manifest.experiment["step_size"] == 0.125


def test_an_input_of_a_wire_is_set_before_the_ticks_of_the_step() -> None:
    """x moves an eighth of the way to u at each tick: first to 1 and then, after 0, to 9."""
    bench = Bench(stop_time=0.125, step=0.125, record=("fmu.x",))
    bench.fmu("fmu", fmu(PARTITIONS, 3, "all"))
    bench.controller("source", lambda time: 9.0)
    bench.connect("source.u", "fmu.u")
    assert list(bench.run()["fmu.x"]) == [0.125, 0.125 + 0.125 * (9.0 - 0.125)]


def test_an_interval_that_time_cannot_go_on_by_names_its_clock(tmp_path: Path) -> None:
    source = fmu(PARTITIONS, 3, "all")
    xml = member(source, "modelDescription.xml")
    stuck = xml.replace(b'intervalCounter="1" resolution="4"', b'intervalDecimal="-0.25"')
    assert stuck != xml
    made = rewritten(source, tmp_path / "stuck.fmu", modelDescription_dot_xml=stuck)
    with pytest.raises(FmuError, match=r"'slow' with interval -0.25, at which no clock ticks"):
        simulate(made, stop_time=1.0)
