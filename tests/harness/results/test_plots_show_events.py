"""A plot of one run draws both sides of an event, holds what is held and leaves texts out."""

from pathlib import Path

import numpy as np
import pytest

from harness.errors import RecordingError, UsageError
from harness.results.plots import save_figure, signals_plot
from harness.results.recording import Column, Recording
from harness.results.result import Result

TIME = [0.0, 1.0, 1.0, 2.0]
COLUMNS = (
    Column("v", "m/s"), Column("count", "1", "", "int64"), Column("on", "1", "", "boolean"),
    Column("valve", "1", held=True), Column("phase", type="text"),
    *(Column(f"long_name_of_a_signal_{i}", "m") for i in range(7)),
)  # fmt: skip


def result() -> Result:
    recording = Recording(COLUMNS)
    recording.add_texts(["free", "down"])
    rows = np.zeros((4, len(COLUMNS)))
    rows[:, 0] = [-1.0, -4.0, 3.0, 0.0]
    rows[:, 1] = np.array([0, 0, 1, 1]).view(np.float64)
    rows[:, 2] = rows[:, 3] = [0.0, 0.0, 1.0, 1.0]
    rows[:, 4] = np.array([0, 0, 1, 1]).view(np.float64)
    recording.append(np.array(TIME), rows)
    return recording.finish()


def test_jumps_are_drawn_and_what_is_held_is_a_step() -> None:
    figure = result().plot()
    lines = {line.get_label(): line for axes in figure.axes for line in axes.get_lines()}
    assert set(lines) == {column.name for column in COLUMNS} - {"phase"}
    assert np.asarray(lines["v"].get_xdata()).tolist() == TIME
    assert np.asarray(lines["v"].get_ydata()).tolist() == [-1.0, -4.0, 3.0, 0.0]
    styles = {name: lines[name].get_drawstyle() for name in ("v", "count", "on", "valve")}
    assert styles == {"v": "default", **dict.fromkeys(("count", "on", "valve"), "steps-post")}


def test_a_panel_has_one_unit_and_at_most_five_curves() -> None:
    figure = result().plot()
    shown = [(axes.get_ylabel(), len(axes.get_lines())) for axes in figure.axes]
    assert shown == [("v (m/s)", 1), ("value (–)", 3), ("value (m)", 5), ("value (m)", 2)]
    figure.draw_without_rendering()
    for axes in figure.axes:
        legend = axes.get_legend()
        assert legend is not None and legend.get_window_extent().x1 <= figure.bbox.x1


def test_a_text_is_refused_and_a_figure_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="'phase' was recorded as text, where numbers were exp"):
        signals_plot(result(), ["phase"])
    assert save_figure(tmp_path / "deep" / "v.svg", result().plot("v")).stat().st_size > 1000
    (tmp_path / "file").touch()
    with pytest.raises(RecordingError, match=r"cannot write the figure .*file/v.png"):
        save_figure(tmp_path / "file" / "v.png", result().plot("v"))
