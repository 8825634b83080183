"""The cases are found by name, and the loop of the first is measured and agrees with C."""

from contextlib import ExitStack
from pathlib import Path

import pytest

from benchmarks import closed_loop
from benchmarks.cases import CASES, master
from benchmarks.frame import Setting


def test_cases_are_functions_of_a_setting() -> None:
    assert set(CASES) >= {"master", "controllers", "identification", "jobs", "growth", "papers"}
    assert all(map(callable, CASES.values()))


def test_the_master_is_compared_with_c_and_its_peers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(master, "STEPS", 40_000)
    with ExitStack() as stack:
        made = list(CASES["master"](Setting(tmp_path, ("ecos", "fmpy"), stack)))
        names = [one.name for one in made]
        assert names[:2] == ["closed_loop_fmi2", "closed_loop_fmi3"]
        assert names[2:] == ["closed_loops", "peers_callback", "peers_fmus"]
        for name in (closed_loop.C, closed_loop.OURS):
            assert made[0].sides[name].measure() > 0.0
        assert made[2].sides["ours, 4 loops"].measure() > 0.0
        assert made[4].sides["ours"].measure() > 0.0
        assert any(name.startswith("ecospy") for name in made[4].sides)
