"""`[study.levels]` repeats a study at values of a quantity, as files that say so would."""

from pathlib import Path

import pytest

from harness.errors import ExperimentError
from harness.experiment.study import run_study
from tests.harness.experiment.loops import FILE, load

STD = 'connections."controller.measured".imperfections.0.std'
LEVELS = f"""
[study.levels]
quantity = "noise"
keys = ['{STD}']
values = [0.0, 0.05, 0.1]
nominal = 0.05
"""
TEXT = FILE + LEVELS
AT_A_TENTH = FILE.replace("std = 0.05", "std = 0.1")


def test_each_level_is_the_study_of_a_file_that_says_so(tmp_path: Path) -> None:
    study = run_study(load(tmp_path, TEXT))
    assert tuple(study.levels) == (0.0, 0.05, 0.1)
    assert study.levels[0.1].runs == run_study(load(tmp_path, AT_A_TENTH)).runs
    assert study.runs == study.levels[0.05].runs == run_study(load(tmp_path)).runs
    assert list(study.frame()["noise"].unique()) == [0.0, 0.05, 0.1]


def test_a_factor_multiplies_what_the_file_gives(tmp_path: Path) -> None:
    text = TEXT.replace("[0.0, 0.05, 0.1]", "[1.0, 2.0]").replace("nominal = 0.05", "nominal = 1.0")
    study = run_study(load(tmp_path, f"{text}factor = true\n"))
    assert study.levels[2.0].runs == run_study(load(tmp_path, AT_A_TENTH)).runs


def test_the_fast_subset_has_the_nominal_level_and_an_end(tmp_path: Path) -> None:
    for nominal, values in ((0.05, (0.0, 0.05)), (0.0, (0.0, 0.1))):
        text = TEXT.replace("nominal = 0.05", f"nominal = {nominal}")
        study = load(tmp_path, text).fast().spec.study
        assert study is not None and study.levels is not None
        assert study.levels.values == values


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ("[0.0, 0.05, 0.1]", "[0.05, 0.0]", "values must increase"),
        ("nominal = 0.05", "nominal = 0.06", "nominal must be one of the values"),
    ],
)
def test_faults_of_levels(tmp_path: Path, before: str, after: str, words: str) -> None:
    with pytest.raises(ExperimentError, match=f"key study.levels: {words}"):
        load(tmp_path, TEXT.replace(before, after))


def test_a_factor_of_what_the_file_does_not_give(tmp_path: Path) -> None:
    text = TEXT.replace("imperfections.0", "imperfections.1") + "factor = true\n"
    with pytest.raises(ExperimentError, match=r"the file gives no number for it"):
        run_study(load(tmp_path, text))
