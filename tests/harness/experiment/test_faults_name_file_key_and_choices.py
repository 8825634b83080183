"""Every fault of an experiment file: the file, the key, what was given, the legal choices."""

import re
from pathlib import Path

import pytest

from harness.errors import ExperimentError, HarnessError, nearest
from tests.harness.experiment.loops import FILE, load, write

CASES = [
    ("stop_time = 1.0", "", "key stop_time: this key is required"),
    ("stop_time = 1.0", 'stop_time = "long"', "key stop_time: .*number.*not 'long'"),
    ("seed = 5", "sead = 5", "key sead: unknown key; did you mean 'seed'"),
    ("seed = 5", "seed = -1", "key seed: .*greater than or equal to 0, not -1"),
    ("seed = 5", 'algorithm = "jacoby"', "algorithm: .*no algorithm 'jacoby'; did.*'jacobi'"),
    ("seed = 5", "fmi_version = 1", "key fmi_version: must be one of 2 or 3, not 1"),
    ('outputs = ["y"]', 'output = ["y"]', r"lag\.output: unknown key; did.*'outputs'"),
    ('signal = "step"', 'signl = "step"', "reference: must have exactly one of the keys"),
    ('signal = "step"', 'signal = "stp"', "component reference: unknown.*'stp': did.*'step'"),
    ("final = 2.0", "fnal = 2.0", "no key 'fnal'.*did you mean 'final'"),
    ("final = 2.0", "final = 2.0, step = 0.1", "reference: a parameter may not be called 'step'"),
    ('"pid"', '"pdi"', "no controller 'pdi'; did you mean 'pid'"),
    ("kp = 0.5", "kpp = 0.5", "controller: PID has no parameter 'kpp'; did.*'kp'"),
    ("delay = 0.01", "dealy = 0.01", r"dealy: unknown key; did you mean 'delay'"),
    ("delay = 0.01", "delay = 0.0000000001", "delay of controller.u -> lag.u.*nanosec"),
    ('kind = "noise", std', 'kind = "nois", std', "lag.y -> controller.measured: unknown.*'noise'"),
    ('kind = "noise", std', "std", "lacks its 'kind'"),
    ('"lag.u" =', '"lagg.u" =', "no component 'lagg'; did you mean 'lag'"),
    ('from = "lag.y"', 'from = "lag.z"', "lag has no output 'z'; legal names: y"),
    ('response = "lag.y"', 'response = "lag.x"', "'lag.x'.*lag.y"),
    ('baseline = "soft"', 'baseline = "sofd"', r"study\.baseline 'sofd': did you mean 'soft'"),
    ("seeds = 3", "seeds = 1", r"key study\.seeds: .*greater than or equal to 2, not 1"),
    ("seeds = 2", "seeds = 1", r"key study\.fast\.seeds: .*greater than or equal to 2, not 1"),
    ("seeds = 2", "seds = 2", r"key study\.fast\.seds: unknown key; did you mean 'seeds'"),
    ("[variants.hard]", "[variants.hard]\nlike = 'sofd'", r"variants\.hard\.like 'sofd'.*'soft'"),
    ("[variants.hard]", "[variants.hard]\nsteep = 1", "variants.hard.*steep: unknown key.*'step'"),
]  # fmt: skip


@pytest.mark.parametrize(("before", "after", "words"), CASES)
def test_fault(tmp_path: Path, before: str, after: str, words: str) -> None:
    assert before in FILE
    with pytest.raises(HarnessError) as caught:
        load(tmp_path, FILE.replace(before, after)).run("hard")
    assert re.search(words, str(caught.value)), str(caught.value)


def test_all_faults_of_a_file_come_at_once(tmp_path: Path) -> None:
    text = FILE.replace("stop_time = 1.0", "").replace("seed = 5", "sead = 5")
    with pytest.raises(ExperimentError) as caught:
        load(tmp_path, text)
    lines = str(caught.value).splitlines()
    assert len(lines) == 2 and all("lag.toml: key " in line for line in lines)


def test_a_variant_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(ExperimentError, match=r"no variant 'sof'; did you mean 'soft'"):
        load(tmp_path).run("sof")


@pytest.mark.parametrize(
    ("content", "words"),
    [(b"title = ", "is no valid TOML"), (b"\xff\xfe", "cannot be read")],
)
def test_files_that_are_no_toml(tmp_path: Path, content: bytes, words: str) -> None:
    from harness.experiment.experiment import Experiment

    path = write(tmp_path)
    path.write_bytes(content)
    with pytest.raises(ExperimentError, match=rf"lag\.toml {words}"):
        Experiment.load(path)
    with pytest.raises(ExperimentError, match="cannot be read"):
        Experiment.load(tmp_path / "none.toml")


def test_near_names_are_near() -> None:
    assert nearest("forse", ["force", "speed"]) == "did you mean 'force'?"
    assert nearest("q", ["force", "speed"]) == "legal names: force, speed"
    assert nearest("q", []) == "there are none to choose from"
