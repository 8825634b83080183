"""What is held is drawn as steps, both ends of a wire are seen, a unit that is unknown is no unit,
and the picture of the response shows the variants that the file names."""

from pathlib import Path

import pytest
from matplotlib.figure import Figure

from harness.bench import Bench
from harness.errors import ExperimentError
from harness.experiment.report import figures
from harness.results.plots import axis_label, overview_plot
from tests.harness.experiment.loops import FILE, load

ONE = FILE.replace('control = "controller.u"', 'control = "controller.u"\nvariants = ["hard"]')


def styles(figure: Figure) -> dict[str, str]:
    return {
        str(line.get_label()): line.get_drawstyle()
        for axes in figure.axes
        for line in axes.get_lines()
    }


def bench() -> Bench:
    made = Bench(stop_time=1.0, step=0.1)
    made.fmu("plant", "oscillator_left")
    made.signal("reference", "step", time=0.5, final=1.0)
    made.controller("c", lambda time, r, y: r - y)
    made.connect("reference", "c.r")
    made.connect("plant.position", "c.y", convert_units=False)
    made.connect("c.u", "plant.coupling_force", convert_units=False)
    return made


def test_what_is_sampled_is_drawn_as_steps() -> None:
    result = bench().run()
    drawn = styles(result.plot())
    held = {"reference.value", "c.r", "c.y", "c.u", "plant.coupling_force"}
    assert {name for name, style in drawn.items() if style == "steps-post"} == held
    assert {name for name, style in drawn.items() if style == "default"} >= {"plant.position"}
    overview = styles(overview_plot({"run": result}, "plant.position", "reference.value", "c.u"))
    assert overview["reference"] == "steps-post"


def test_both_ends_of_a_wire_are_seen() -> None:
    lines = [line for axes in bench().run().plot("c.u", "reference.value", "c.r").axes
             for line in axes.get_lines()]  # fmt: skip
    widths = [line.get_linewidth() for line in lines]
    assert widths == sorted(widths, reverse=True) and widths[0] > widths[-1] + 1.0


@pytest.mark.parametrize(("unit", "label"), [("", "u"), ("1", "u (–)"), ("N", "u (N)")])
def test_a_unit_that_is_not_known(unit: str, label: str) -> None:
    assert axis_label("u", unit) == label


def test_the_response_shows_the_variants_that_are_named(tmp_path: Path) -> None:
    experiment = load(tmp_path, ONE)
    results = {name: experiment.run(name) for name in experiment.variants}
    names = set(styles(figures(experiment, results)["response"]()))
    assert "hard" in names and "soft PID" not in names
    with pytest.raises(ExperimentError, match=r"measure\.variants 'hrad': did you mean 'hard'"):
        load(tmp_path, ONE.replace('"hard"', '"hrad"'))
