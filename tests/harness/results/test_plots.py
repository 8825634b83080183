"""Pictures name quantities with units, tell variants apart alike everywhere, touch no global."""

import subprocess
import sys
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.figure import Figure

from harness.errors import RecordingError, UsageError
from harness.results.membership_plot import MembershipCurves, membership_plot
from harness.results.plots import (
    gains_plot,
    overview_plot,
    save_figures,
)
from harness.results.recording import Column, Recording
from harness.results.result import Result

COLUMNS = (Column("c.reference", "N"), Column("p.force", "N"), Column("c.u"), Column("c.gain", "s"))
FORCE, REFERENCE = "p.force", "c.reference"
NAMES = ["PID", "fuzzy PID", "EKF", "robust EKF"]


def result(scale: float) -> Result:
    recording = Recording(COLUMNS)
    t = np.arange(50)
    recording.append(t / 100, np.column_stack([t * 0 + 2.0, t * scale, t * 0.1, t * 0.2]))
    return recording.finish()


VARIANTS = {name: result(1.0 + i) for i, name in enumerate(NAMES)}
GRID = np.linspace(0, 1, 11)
CURVES = [MembershipCurves("|e|", "1", GRID, {"small": 1 - GRID, "big": GRID})]
FIGURES = {
    "overview": lambda: overview_plot(VARIANTS, FORCE, REFERENCE, "c.u", title="all"),
    "gains": lambda: gains_plot(VARIANTS, ["c.gain", "c.u"]),
    "membership": lambda: membership_plot(CURVES, CURVES),
    "signals": lambda: VARIANTS["PID"].plot(),
}


def legend_texts(figure: Figure) -> list[str]:
    legends = [*figure.legends, *filter(None, (one.get_legend() for one in figure.axes))]
    return [text.get_text() for legend in legends for text in legend.get_texts()]


@pytest.mark.parametrize("name", FIGURES)
def test_axes_have_units_and_there_is_a_legend(name: str) -> None:
    figure = FIGURES[name]()
    for axes in figure.axes:
        assert axes.get_ylabel().endswith(("(N)", "(s)", "(–)"))
    assert figure.axes[-1].get_xlabel() == ("|e| (–)" if name == "membership" else "time (s)")
    assert len(legend_texts(figure)) >= 2


@pytest.mark.parametrize("name", ["overview", "gains"])
def test_a_variant_looks_the_same_everywhere_and_unlike_the_others(name: str) -> None:
    figure = FIGURES[name]()
    assert [text for text in legend_texts(figure) if text != "reference"] == NAMES
    looks = {
        line.get_label(): (line.get_color(), str(line.get_linestyle()), line._dash_pattern[1])
        for axes in figure.axes
        for line in axes.get_lines()
        if line.get_label() in NAMES
    }
    reference = {
        line.get_label(): (line.get_color(), str(line.get_linestyle()), line._dash_pattern[1])
        for line in FIGURES["overview"]().axes[0].get_lines()
    }
    assert all(looks[one] == reference[one] for one in NAMES)
    assert len({look[0] for look in looks.values()}) == 4
    assert len({str(look[1:]) for look in looks.values()}) == 4


def test_curves_hold_the_data() -> None:
    figure = FIGURES["overview"]()
    line = next(one for one in figure.axes[1].get_lines() if one.get_label() == "fuzzy PID")
    drawn = np.asarray(line.get_ydata())
    assert np.array_equal(drawn, 2.0 - 2.0 * np.arange(50))


def test_saving_writes_pictures_and_leaves_globals_alone(tmp_path: Path) -> None:
    before = dict(mpl.rcParams)
    paths = save_figures(tmp_path / "figures", {name: make() for name, make in FIGURES.items()})
    assert [path.stem for path in paths] == list(FIGURES)
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in paths)
    assert dict(mpl.rcParams) == before
    with pytest.raises(RecordingError, match=r"cannot write the figure .*x.nonsense"):
        save_figures(tmp_path, {"x": FIGURES["gains"]()}, ".nonsense")


def test_pyplot_is_never_imported() -> None:
    code = (
        "import sys, harness.results.membership_plot; sys.exit('matplotlib.pyplot' in sys.modules)"
    )
    root = Path(__file__).parents[3]
    assert subprocess.run([sys.executable, "-c", code], cwd=root, check=False).returncode == 0


def test_what_cannot_be_drawn_is_said() -> None:
    with pytest.raises(UsageError, match=r"no variant recorded 'c.gian'"):
        gains_plot(VARIANTS, ["c.gian"])
    with pytest.raises(UsageError, match="no variant was given"):
        overview_plot({}, FORCE, REFERENCE, "c.u")
    with pytest.raises(UsageError, match=r"did you mean 'p.force'"):
        overview_plot(VARIANTS, "p.forc", REFERENCE, "c.u")
    with pytest.raises(UsageError, match="before and after must be of the same variables"):
        membership_plot(CURVES, [])
