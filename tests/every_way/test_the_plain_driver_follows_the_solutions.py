"""The oracle is right: where the solution is known it gives that, of every version and kind."""

import math

import pytest

from tests.every_way.cases import CASES, STEP_NS
from tests.every_way.models import needs_compiler
from tests.every_way.ways import by_plain_driver

pytestmark = needs_compiler
TIMES = [k * STEP_NS / 1e9 for k in range(129)]


def of(title: str) -> list[str]:
    return [name for name in CASES if name.startswith(f"{title}-")]


def heights(fall: float) -> list[float]:
    """The ball, parabola by parabola."""
    begin, height, speed, found = 0.0, 1.0, 0.0, []
    for time in TIMES:
        while time > begin + (flight := (speed + math.sqrt(speed**2 + 2 * fall * height)) / fall):
            begin, height, speed = begin + flight, 0.0, 0.7 * (fall * flight - speed)
        t = time - begin
        found.append(height + speed * t - 0.5 * fall * t * t)
    return found


def temperatures() -> list[float]:
    """The room with its thermostat, exponential by exponential."""
    begin, first, rest, found = 0.0, 20.0, 35.0, []
    for time in TIMES:
        while time > begin + (
            ends := math.log((rest - first) / (rest - (21 if rest > 30 else 19)))
        ):
            begin, first, rest = begin + ends, 21.0 if rest > 30 else 19.0, 40.0 - rest
        found.append(rest + (first - rest) * math.exp(begin - time))
    return found


@pytest.mark.parametrize("name", of("ball"))
def test_the_ball_flies_in_parabolas(name: str) -> None:
    rows = by_plain_driver(CASES[name])
    assert rows["h"] == pytest.approx(heights(9.81 - 1.0), abs=1e-11)
    assert rows["height"] == rows["h"] and rows["speed"] == rows["v"]
    assert rows["bounces"][-1] == 4
    if "minus_h" in rows:
        assert rows["minus_h"] == [-h for h in rows["h"]]
        assert rows["fall"] == [-v for v in rows["v"]]


@pytest.mark.parametrize("name", of("thermostat"))
def test_the_thermostat_has_events_of_all_kinds(name: str) -> None:
    rows = by_plain_driver(CASES[name])
    assert rows["T"] == pytest.approx(temperatures(), abs=1e-10)
    assert rows["counter"] == [math.floor(4 * t) for t in TIMES]
    assert rows["chain"] == [3 * math.floor(4 * t) for t in TIMES]
    assert rows["laps"] == [math.floor(2 * t) for t in TIMES]
    jumped = [1000 * math.exp(1 - t) if t >= 1 else math.exp(-t) for t in TIMES]
    assert rows["x"] == pytest.approx(jumped, rel=1e-10)


@pytest.mark.parametrize("name", of("clocks") + of("triggered"))
def test_clocks_tick_in_time(name: str) -> None:
    rows = by_plain_driver(CASES[name])
    ticks = [math.floor(8 * t) + 1 for t in TIMES]
    downs = [math.floor((t - 0.3125) / 0.375) + 1 for t in TIMES]  # 1/16 s after each third tick
    users = [(t >= 0.25) + (t >= 1.0) for t in TIMES]
    wanted = [a + 100 * b for a, b in zip(ticks, downs, strict=True)]
    if name.startswith("triggered"):
        wanted = [a + 10000 * b for a, b in zip(wanted, users, strict=True)]
    assert rows["total"] == wanted


@pytest.mark.parametrize("name", of("partitions"))
def test_partitions_run_by_priority(name: str) -> None:
    rows = by_plain_driver(CASES[name])
    assert rows["x"] == pytest.approx([1 - 0.875 ** (math.floor(8 * t) + 1) for t in TIMES])
    assert rows["total"][-1] == 17 + 100 * 9 + 10000 * 5
    assert rows["y"][16] == rows["x"][0] + rows["x"][16]  # after the fast partition, before `down`


def test_numbers_beyond_53_bits_are_exact() -> None:
    rows = by_plain_driver(CASES["large-fmi3-co-simulation"])
    assert rows["large"] == [2**53 + 1 + k for k in range(129)]
    assert rows["largest"] == [2**64 - 1 - k for k in range(129)]
    long = by_plain_driver(CASES["long-fmi3-co-simulation"])
    assert (long["Int64_out"][1], long["UInt64_again"][-1]) == (-(2**63), 2**53 + 1)


def test_arrays_have_the_size_of_their_parameter() -> None:
    rows = by_plain_driver(CASES["resized-fmi3-co-simulation"])
    assert rows["doubled"][1] == [11.0, 9.0, 7.0, 5.0, 3.0]
    assert rows["table"][0] == [11.0, 12.0, 21.0, 22.0, 31.0, 32.0, 41.0, 42.0, 51.0, 52.0]
