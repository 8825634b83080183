"""What is fuzzed: functions of bytes that end well or in a `HarnessError`, and in nothing else."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from pathlib import Path

from harness.cli.options import settings
from harness.errors import HarnessError
from harness.experiment.experiment import Experiment
from harness.fmi.archive.unpack import Archive
from harness.fmi.description.reader import read_model_description
from harness.instruments.csv_signal import CsvSignal, read_csv_table
from tests.fuzz.packages import package, parameter_mapping, parameter_set, system_structure
from tests.fuzz.place import CORPUS, written


def description(content: bytes) -> None:
    """modelDescription.xml, and all that is asked of it before a run."""
    document = written("modelDescription.xml", content)
    described, _ = read_model_description(document.parent, Path("fuzzed.fmu"))
    assert described.fmi_major in (1, 2, 3) and described.inputs is not None
    assert all(name == v.name for name, v in described.variables.items())


def archive(content: bytes) -> None:
    """A whole archive; nothing may be written outside its folder."""
    path = written("fuzzed.fmu", content)
    with Archive(path) as opened:
        root = opened.folder.resolve()
        assert all(root in found.resolve().parents for found in root.rglob("*"))
    assert not root.exists()


def experiment(content: bytes) -> None:
    """An experiment file, up to the system that it describes."""
    loaded = Experiment.load(written("fuzzed.toml", content))
    for variant in loaded.variants[:3]:
        loaded.bench(variant).system()


def csv(content: bytes) -> None:
    """A CSV file, read as a signal."""
    path = written("fuzzed.csv", content)
    table = read_csv_table(path)
    for name in table.names[-2:]:
        CsvSignal(path, name, "linear")


def setting(content: bytes) -> None:
    """A setting of the command line."""
    settings([content.decode("utf-8", "surrogateescape")])


TARGETS: dict[str, Callable[[bytes], None]] = {
    one.__name__: one
    for one in (
        description, archive, experiment, csv, setting,
        system_structure, parameter_set, parameter_mapping, package,
    )
}  # fmt: skip


def attempt(target: str, content: bytes) -> bool:
    """Whether `content` was accepted; anything raised but a `HarnessError` is a defect."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            TARGETS[target](content)
        except HarnessError as fault:
            assert str(fault) and len(str(fault)) < 20_000, fault
            return False
    return True


def corpus(target: str) -> list[bytes]:
    """The committed examples of a target."""
    return [path.read_bytes() for path in sorted((CORPUS / target).iterdir())]
