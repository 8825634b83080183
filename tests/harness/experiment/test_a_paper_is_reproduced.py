"""A paper is run, its claims are judged, and its page and README say so."""

import re
from html.parser import HTMLParser
from pathlib import Path

import pytest

from harness.cli.main import run_command_line
from harness.errors import ExperimentError, RecordingError, UsageError
from harness.experiment.experiment import Experiment
from harness.experiment.judging import FAILS, HOLDS, UNTESTABLE
from harness.experiment.pages import update_readme, write_page
from harness.experiment.reproduce import Reproduction, load_paper, reproduce
from harness.experiment.study import run_study
from harness.experiment.sweep import run_sweep
from tests.harness.experiment.papers import CLAIMS, paper


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("paper")


@pytest.fixture(scope="module")
def done(folder: Path) -> Reproduction:
    return reproduce(paper(folder), folder / "out")


def test_verdicts_are_those_of_the_runs(done: Reproduction, folder: Path) -> None:
    better, stable, measured = done.verdicts
    difference = run_study(Experiment.load(folder / "loops/lag.toml")).difference("hard", "iae")
    ours = better.findings[0].trials[0].ours
    assert ours.value == pytest.approx(difference.value, rel=1e-12)
    assert better.verdict == HOLDS
    region = run_sweep(Experiment.load(folder / "loops/machine.toml"))["light"]
    ours = stable.findings[0].trials[0].ours
    assert ours.value == region.share and stable.verdict == FAILS
    assert measured.verdict == UNTESTABLE and not measured.findings


class Images(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.sources: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.sources += [value or "" for name, value in attrs if tag == "img" and name == "src"]


def test_the_page_shows_every_picture(done: Reproduction, folder: Path) -> None:
    text = write_page(done, folder / "out").read_text(encoding="utf-8")
    images = Images()
    images.feed(text)
    assert set(images.sources) == {
        "lag/response.png", "machine/light.png", "machine/heavy.png", "machine/regions.png",
    }  # fmt: skip
    assert all((folder / "out" / source).is_file() for source in images.sources)
    assert "A paper of two loops" in text and "there is no test rig" in text
    assert "decides nothing" not in text


def test_the_readme_gets_its_tables_and_keeps_the_rest(done: Reproduction, folder: Path) -> None:
    first = update_readme(done).read_text(encoding="utf-8")
    assert update_readme(done).read_text(encoding="utf-8") == first
    assert "All points end at rest \\| with light weights" in first
    assert re.search(r"\| 1 \| The hard PID .*\| smaller \| .*\| holds \| its gain \|", first)
    assert "| lag | soft PID | 3 |" in first and "forgotten" not in first
    assert "# A paper" in first and "Between them." in first and first.endswith("The end.\n")
    (folder / "loops/README.md").write_text("nothing", encoding="utf-8")
    with pytest.raises(RecordingError, match="has no markers <!-- verdicts: begin -->"):
        update_readme(done)


def test_the_fast_subset_is_smaller_and_says_so(tmp_path: Path) -> None:
    fast = reproduce(paper(tmp_path), tmp_path / "out", fast=True)
    study = fast.evidence["lag"].study
    assert study is not None and study.seeds == (5, 6)
    assert fast.evidence["machine"].regions["light"].outcome.shape == (2, 2)
    assert "decides nothing" in write_page(fast, tmp_path / "out").read_text(encoding="utf-8")


def test_what_there_is_no_paper_for(tmp_path: Path) -> None:
    known = dict(paper(tmp_path).experiments)
    named = {f"loops/{name}": path for name, path in known.items()}
    with pytest.raises(UsageError, match=r"no paper 'loop'; did you mean 'loops'"):
        load_paper("loop", named)
    (tmp_path / "loops/claims.toml").unlink()
    with pytest.raises(ExperimentError, match=r"paper loops has no claims\.toml"):
        load_paper("loops", named)


def test_claims_about_what_is_not_there(tmp_path: Path) -> None:
    wrong = paper(tmp_path, CLAIMS.replace('experiment = "machine"', 'experiment = "machin"'))
    with pytest.raises(UsageError, match=r"no experiment 'machin'; did you mean 'machine'"):
        reproduce(wrong, tmp_path / "out")
    assert not (tmp_path / "out").exists()  # said before anything is run


def test_verdicts_of_the_fast_subset_go_into_no_readme(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command_line(["reproduce", "takata", "--fast", "--update"]) == 2
    assert "--update does not go with --fast" in capsys.readouterr().err
