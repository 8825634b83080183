"""`reproduce PAPER --claim ID` runs what this claim needs, and prints the row that the page has."""

from pathlib import Path

import pytest

from harness.cli.main import run_command_line
from harness.errors import UsageError
from harness.experiment.pages import verdict_rows
from harness.experiment.reproduce import reproduce
from tests.harness.experiment.papers import paper


def test_it_is_the_row_of_the_page(tmp_path: Path) -> None:
    page = list(verdict_rows(reproduce(paper(tmp_path), tmp_path / "page")))
    for row, name in zip(page[1:], ("harder_is_better", "all_stable", "measured"), strict=True):
        alone = reproduce(paper(tmp_path), tmp_path / name, only=[name])
        assert list(verdict_rows(alone)) == [page[0], row]
        assert row[-1] == ("" if name == "measured" else f"`reproduce loops --claim {name}`")


def test_what_is_not_needed_is_not_run(tmp_path: Path) -> None:
    alone = reproduce(paper(tmp_path), tmp_path / "out", only=["all_stable"])
    assert set(alone.evidence) == {"machine"}
    assert set(alone.evidence["machine"].regions) == {"light"}


def test_a_wrong_name_is_said_with_the_right_one(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"no claim 'all_stabel'; did you mean 'all_stable'"):
        reproduce(paper(tmp_path), tmp_path / "out", only=["all_stabel"])


def test_a_page_needs_all_claims(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command_line(["reproduce", "takata", "--claim", "noise-works", "--update"]) == 2
    assert "--claim goes with one paper and without --update" in capsys.readouterr().err
