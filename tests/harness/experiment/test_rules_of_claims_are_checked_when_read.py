"""A claims file that breaks a rule is refused, with the sentence that says which."""

from pathlib import Path

import pytest

from harness.errors import ExperimentError
from harness.experiment.claims import load_claims

TEXT = """
paper = "p"
mechanisms.tuning = ["tuned", "tuned_slowly"]

[[claims]]
id = "tuned-is-better"
page = "1"
claim = "c"
experiment = "first"
variant = "tuned"
against = "fixed"
metric = "error"
below = 0.0

[claims.given]
experiment = "second"
variant = "tuned"
against = "fixed"
metric = "error"
below = 0.0
"""
CONDITION = "claim tuned-is-better: a condition \\(given\\) must keep what is claimed and may only "


def written(folder: Path, before: str = "", after: str = "") -> Path:
    """The file, with other words in its condition."""
    head, given, condition = TEXT.partition("[claims.given]")
    assert before in condition
    path = folder / "claims.toml"
    path.write_text(head + given + condition.replace(before, after), encoding="utf-8")
    return path


def test_another_experiment_is_a_condition(tmp_path: Path) -> None:
    assert load_claims(written(tmp_path)).claims[0].given is not None


def test_another_setting_of_the_same_mechanism_is_one(tmp_path: Path) -> None:
    path = written(tmp_path, 'variant = "tuned"', 'variant = "tuned_slowly"')
    assert load_claims(path).claims[0].given is not None


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ('variant = "tuned"', 'variant = "other"', "variant 'other' is not of the mechanism of"),
        (
            'against = "fixed"',
            'against = "top"',
            "against 'top' is not of the mechanism of 'fixed'",
        ),
        ('metric = "error"', 'metric = "mean"', "metric must stay 'error', not 'mean'"),
        ("below = 0.0", "below = 0.1", "below must stay 0.0, not 0.1"),
        ("below = 0.0", "above = 0.0", "below must stay 0.0, not None"),
    ],
)
def test_what_a_condition_must_keep(tmp_path: Path, before: str, after: str, words: str) -> None:
    with pytest.raises(ExperimentError, match=f"{CONDITION}change where: {words}"):
        load_claims(written(tmp_path, before, after))


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ("share_above = 2.0", "share_above counts the runs of one variant and compares nothing"),
        ("curve = [0.1]", "curve needs a limit that was chosen"),
    ],
)
def test_what_a_criterion_cannot_be(tmp_path: Path, more: str, words: str) -> None:
    path = tmp_path / "claims.toml"
    path.write_text(TEXT.partition("[claims.given]")[0] + more, encoding="utf-8")
    with pytest.raises(ExperimentError, match=words):
        load_claims(path)


def test_two_claims_of_one_id(tmp_path: Path) -> None:
    head, table, claim = TEXT.partition("[[claims]]")
    path = tmp_path / "claims.toml"
    path.write_text(head + (table + claim) * 2, encoding="utf-8")
    with pytest.raises(ExperimentError, match="tuned-is-better: each claim needs an id of its own"):
        load_claims(path)
