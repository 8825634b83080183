"""Pictures of verdicts over a quantity: the figure of a claim with its interval, and the limit."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from textwrap import fill

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from harness.experiment.judging import FAILS, HOLDS, UNDECIDED, Finding, Verdict
from harness.results.atomic import atomic_write, writing
from harness.results.plots import PALETTE, axis_label, legend_of_all, new_figure

_MET = {True: ("o", "full", HOLDS), False: ("X", "full", FAILS), None: ("o", "none", UNDECIDED)}
_MANY = 8.0  # from this ratio of the ends on a logarithmic axis shows more


def verdict_plot(verdict: Verdict) -> Figure | None:
    """A panel a reading: the mean with the interval that holds for all claims of the paper at once,
    full where the claim holds, a cross where it does not, empty where it is undecided; None where
    nothing is varied."""
    regions = [finding for finding in verdict.findings if len(finding.trials) > 1]
    if not regions:
        return None
    figure = new_figure(
        (4.6 * len(regions) + 0.6, 3.8), fill(verdict.claim.claim, 34 + 30 * len(regions))
    )
    panels = figure.subplots(1, len(regions), squeeze=False).ravel()
    for panel, finding in zip(panels, regions, strict=True):
        _draw(panel, finding)
        panel.set_title(finding.reading, fontsize="medium")
        of_limit = bool(finding.trials[0].test.curve)
        unit = verdict.claim.unit if of_limit else finding.unit
        panel.set_xlabel(axis_label(finding.quantity.replace("_", " "), unit))
        panel.set_ylabel(_figure_label(finding, verdict.claim.unit))
    legend_of_all(figure, panels)
    return figure


def _draw(panel: Axes, finding: Finding) -> None:
    x = np.array([trial.at for trial in finding.trials], dtype=float)
    ours = [trial.ours for trial in finding.trials]
    middle = np.array([one.value for one in ours])
    below = middle - [one.low for one in ours]
    above = [one.high for one in ours] - middle
    panel.errorbar(x, middle, (below, above), color=PALETTE[0], capsize=3, zorder=2)
    for at, y, trial in zip(x, middle, finding.trials, strict=True):
        marker, style, name = _MET[trial.met]
        panel.plot(at, y, marker, color=PALETTE[0], fillstyle=style, label=name)
    test = finding.trials[0].test
    near = test.near
    limits = [trial.test.limit for trial in finding.trials]
    if near is not None:
        panel.axhspan(near[0] - near[1], near[0] + near[1], color="0.9", zorder=0)
    elif len(set(limits)) == 1:
        panel.axhline(float(limits[0] or 0.0), color="black", linestyle="--", linewidth=1.0)
    else:
        panel.plot(x, np.array(limits, dtype=float), color="black", linestyle="--", linewidth=1.0)
    if x[0] > 0.0 and x[-1] / x[0] >= _MANY:
        panel.set_xscale("log")
        panel.set_xticks(x, [f"{value:g}" for value in x])
        panel.minorticks_off()


def _figure_label(finding: Finding, unit: str) -> str:
    test = finding.trials[0].test
    name = test.metric.replace("_", " ")
    if test.share_above is not None:
        varied = "the limit" if test.curve else f"{test.share_above:g}"
        return axis_label(f"share of runs with {name}\nabove {varied}", "1")
    if test.is_comparison:
        name = f"{name}\n{test.variant} − {test.other.variant}"
        if test.compare == "ratio":
            name = name.replace("−", "over")
    return axis_label(name, unit)


def write_pictures(verdicts: Iterable[Verdict], output: Path) -> tuple[Path, ...]:
    """`claims/ID.png` in `output` for each verdict that is a region."""
    written = []
    for verdict in verdicts:
        figure = verdict_plot(verdict)
        if figure is not None:
            path = output / "claims" / f"{verdict.claim.id}.png"
            with writing(f"{path} cannot be written", path.parent), atomic_write(path) as partial:
                figure.savefig(partial, format="png")
            written.append(path)
    return tuple(written)
