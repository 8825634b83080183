"""Results, benches and FMUs are one line each as text, tables as HTML; figures are pictures, and a
run in a notebook has a bar."""

import sys
from types import SimpleNamespace
from typing import Any

import pytest

from harness.bench import Bench
from harness.fmi.fmu import Fmu
from harness.registry import plant_fmu


def bench() -> Bench:
    made = Bench(stop_time=1.0, step=0.1)
    made.fmu("plant", "oscillator_left")
    made.controller("<i>c", lambda time, y: -y)
    made.connect("plant.position", "<i>c.y", delay=0.1, convert_units=False)
    made.connect("<i>c.u", "plant.coupling_force", convert_units=False)
    return made


def test_reprs_are_one_short_line() -> None:
    result = bench().run()
    with Fmu(plant_fmu("oscillator_left")) as fmu:
        shown = [repr(result), repr(bench()), repr(fmu)]
        assert "position" in fmu._repr_html_() and "N.s/m" in fmu._repr_html_()
    assert all(len(one) < 250 and "\n" not in one for one in shown)
    assert shown[0].startswith("<Result: 11 rows, t = 0 … 1 s, 5 columns, complete")
    assert shown[1] == "<Bench: 0 … 1 s, step 0.1 s; plant, <i>c; 2 wires>"


def test_html_has_every_signal_and_wire_and_is_escaped() -> None:
    result = bench().run()
    pages = result._repr_html_(), bench()._repr_html_()
    assert all(name.replace("<", "&lt;").replace(">", "&gt;") in pages[0] for name in result.names)
    assert "0.1" in pages[1] and "plant.coupling_force" in pages[1]
    assert not any("<i>c" in page for page in pages)


def test_figures_are_pictures_without_magic() -> None:
    figure: Any = bench().run().plot("plant.position")
    assert figure._repr_png_().startswith(b"\x89PNG")


def test_a_run_in_a_notebook_has_a_bar(monkeypatch: pytest.MonkeyPatch) -> None:
    shown: list[str] = []

    def display(first: str, display_id: bool) -> SimpleNamespace:
        return SimpleNamespace(update=shown.append)

    shell = SimpleNamespace(kernel=object())
    fake = SimpleNamespace(
        get_ipython=lambda: shell, display=SimpleNamespace(display=display, HTML=str)
    )
    monkeypatch.setitem(sys.modules, "IPython", fake)
    bench().run()
    assert "<progress" in shown[0] and shown[-1] == ""
    del shell.kernel
    shown.clear()
    bench().run()
    assert not shown
