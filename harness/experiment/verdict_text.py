"""Verdicts in words: the cells of a row, with regions as sentences."""

from __future__ import annotations

from collections.abc import Callable
from itertools import groupby

from harness.experiment.judging import (
    CONDITIONALLY,
    FAILS,
    HOLDS,
    PARTLY,
    UNDECIDED,
    Finding,
    Trial,
    Verdict,
)

_SAYS = {True: HOLDS, False: FAILS, None: UNDECIDED}


def ours(verdict: Verdict) -> str:
    """What was found, with its interval and unit; of a region at its two ends."""
    if not verdict.findings:
        return "–"
    unit = verdict.claim.unit
    cell = _of_readings(verdict, lambda finding: _figure(finding, unit))
    if verdict.given is not None:
        test = verdict.given.trials[0].test
        cell += f"; given {test.experiment}/{test.variant}: {_figure(verdict.given, unit)}"
    return cell


def said(verdict: Verdict) -> str:
    """The verdict; of a region where it holds and where it does not."""
    if not verdict.findings:
        return verdict.verdict
    if verdict.verdict != CONDITIONALLY:
        return _of_readings(verdict, lambda finding: _said(finding, verdict.claim.unit))
    assert verdict.given is not None
    where = f" ({region(verdict.given)})" if verdict.given.verdict == PARTLY else ""
    return verdict.verdict + where


def region(finding: Finding) -> str:
    """Where over the quantity a claim holds, and near which value that turns."""
    parts = []
    for met, group in groupby(finding.trials, key=lambda trial: trial.met):
        values = [trial.at for trial in group if trial.at is not None]
        ends = f"{values[0]:g}" + (f" to {values[-1]:g}" if len(values) > 1 else "")
        parts.append(f"{_SAYS[met]} {'for' if len(values) > 1 else 'at'} {ends}")
    unit = "" if finding.unit in ("", "1") else f" in {finding.unit}"
    text = f"{finding.quantity}{unit}: {', '.join(parts)}"
    border = finding.border
    return text if border is None else f"{text}; the mean crosses the limit near {border:.3g}"


def _said(finding: Finding, unit: str) -> str:
    if len({trial.met for trial in finding.trials}) > 1:
        return region(finding)
    text = finding.verdict
    if len(finding.trials) > 1:
        unit_of_quantity = "" if finding.unit in ("", "1") else f" {finding.unit}"
        first, last = finding.trials[0].at, finding.trials[-1].at
        text += f" ({finding.quantity} {first:g} to {last:g}{unit_of_quantity})"
    near = finding.trials[0].test.near
    if near is not None and finding.verdict in (HOLDS, FAILS):
        of = "" if near[0] == 0.0 else f" of {near[0]:g}"
        word = "equivalent within" if finding.verdict == HOLDS else "differs by more than"
        text += f": {word} {near[1]:g} {unit}".rstrip() + of
    return text


def _figure(finding: Finding, unit: str) -> str:
    if len(finding.trials) == 1:
        return _estimate(finding.trials[0], unit)
    ends = (finding.trials[0], finding.trials[-1])
    return " … ".join(f"at {trial.at:g}: {_estimate(trial, unit)}" for trial in ends)


def _estimate(trial: Trial, unit: str) -> str:
    if trial.sample.is_share:
        e = trial.ours
        return f"{100 * e.value:.3g} [{100 * e.low:.3g}, {100 * e.high:.3g}] % of runs"
    return f"{trial.ours} {unit}".strip()


def _of_readings(verdict: Verdict, cell: Callable[[Finding], str]) -> str:
    """The cells of all readings, each after the names of those that it is the cell of."""
    readings: dict[str, list[str]] = {}
    for finding in verdict.findings:
        readings.setdefault(cell(finding), []).append(finding.reading)
    return "; ".join(
        f"{' and '.join(names)}: {text}" if all(names) else text for text, names in readings.items()
    )
