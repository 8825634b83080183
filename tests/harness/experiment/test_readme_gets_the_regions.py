"""The shares of a sweep go into the README of its paper, between markers, with the labels."""

from pathlib import Path

import numpy as np
import pytest

from harness.errors import RecordingError
from harness.experiment.claims import ClaimsSpec
from harness.experiment.evidence import Evidence
from harness.experiment.pages import update_readme
from harness.experiment.reproduce import Paper, Reproduction
from harness.experiment.schema import SweepSpec
from harness.experiment.sweep import Region

EXPERIMENT = """
title = "a constant"
stop_time = 1.0
components.a = { signal = "constant", parameters = { value = 1.0 } }
variants.one = { label = "the first" }
"""
CLAIMS = {"paper": "p", "claims": [{"id": "c", "page": "1", "claim": "c", "untestable": "no"}]}
README = "<!-- verdicts: begin -->\n<!-- verdicts: end -->\n"
MARKERS = "<!-- regions: begin -->\noutdated\n<!-- regions: end -->\nprose\n"


def reproduction(folder: Path) -> Reproduction:
    """A paper of one experiment, whose sweep of 3 × 2 points has four inside."""
    path = folder / "figure.toml"
    path.write_text(EXPERIMENT, encoding="utf-8")
    axes = {
        name: {"key": "a", "from": 0.0, "to": 1.0, "count": n} for name, n in (("x", 3), ("y", 2))
    }
    sweep = SweepSpec.model_validate({"outcome": "error", "below": 1.0, **axes})
    region = Region("one", sweep, np.array([[0.0, 0.5, 0.9], [1.0, 2.0, 0.1]]))
    paper = Paper("p", folder, {"figure": path}, ClaimsSpec.model_validate(CLAIMS))
    evidence = {"figure": Evidence({}, None, {"one": region})}
    return Reproduction(paper, (), evidence, {}, fast=False, family=1)


def test_between_the_markers_and_nowhere_else(tmp_path: Path) -> None:
    (tmp_path / "README.md").write_text(README + MARKERS, encoding="utf-8")
    text = update_readme(reproduction(tmp_path)).read_text(encoding="utf-8")
    part = text.partition("<!-- regions: begin -->\n")[2].partition("<!-- regions: end -->")
    assert part[0].splitlines()[-1] == (
        "| figure | the first | 3 × 2 | error < 1: 66.7 % | 0 at a = 0, a = 0 |"
    )
    assert "outdated" not in text
    assert part[2] == "\nprose\n"


def test_a_readme_without_markers_is_left_as_it_is(tmp_path: Path) -> None:
    (tmp_path / "README.md").write_text(README, encoding="utf-8")
    with pytest.raises(RecordingError, match="no markers <!-- regions: begin -->"):
        update_readme(reproduction(tmp_path))
    assert (tmp_path / "README.md").read_text(encoding="utf-8") == README
