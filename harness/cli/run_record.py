"""What a run folder was made from: `experiment.json`, from which the run can be resumed.

It holds the content of the experiment file after settings, so that a resumed run is the run that
was begun, whatever has become of the file since. A package (SSP) is unpacked while a run lasts
only, so it is opened again; a run whose package is gone or has changed does not go on.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from harness.errors import RecordingError
from harness.experiment.experiment import Experiment
from harness.experiment.journal import JOURNAL_FILE, RUN_FILE
from harness.results.atomic import ANOTHER_FOLDER, writing
from harness.results.manifest import FmuRecord, Manifest, read_manifest, run_state
from harness.results.recording import clear_run
from harness.ssp import is_package

_TABLES = ("metrics.csv", "study.csv", "regions.csv", "regions.png")
_PACKAGE_FILES = (".ssd", ".ssv", ".ssm", ".ssb", ".ssp", ".fmu", ".csv")


@dataclass(frozen=True)
class RunRecord:
    """An experiment and the variants of it that are run into one folder; `settings` are those with
    which it was opened, `kind` is "run", "study" or "sweep"."""

    experiment: Experiment
    variants: tuple[str, ...]
    settings: Mapping[str, Any] = field(default_factory=dict)
    kind: str = "run"

    def write(self, folder: Path, *, overwrite: bool = False) -> None:
        """Begin the folder, in place of what was run into it if `overwrite`; raises
        `RecordingError` where another run has, or it cannot be made."""
        if overwrite and (folder / RUN_FILE).exists():
            _clear(folder)
        path = self.experiment.path.resolve()
        content: dict[str, Any] = {
            "file": str(path),
            "kind": self.kind,
            "variants": self.variants,
            "data": self.experiment.data,
        }
        if is_package(path):
            content["package"] = {"settings": self.settings, "sha256": _digest(path)}
        text = json.dumps(content, indent=2, default=str) + "\n"
        with writing(f"cannot make the run folder {folder}", folder, way_out=ANOTHER_FOLDER):
            file = folder / RUN_FILE
            try:
                with file.open("x", encoding="utf-8") as opened:
                    opened.write(text)
            except FileExistsError as fault:
                raise RecordingError(
                    f"the run folder {folder} holds a run already; nothing was changed in it: "
                    f"choose another folder, replace it by --overwrite, or go on with it by "
                    f"`fmu-harness resume {folder}`"
                ) from fault
            except OSError:
                file.unlink(missing_ok=True)
                raise

    def manifest(self, folder: Path) -> Manifest:
        """The manifest of a study or sweep, of which each run is what it says and a point of
        `runs.jsonl`. Raises `RecordingError` where an FMU is not the one that `folder` was begun
        with."""
        loaded = self.experiment
        fmus = tuple(
            FmuRecord(f"{variant}/{component.name}", component.path.name, digest)
            for variant in self.variants
            for component in loaded.bench(variant).system().fmus
            if (digest := digest_of(component.path))
        )
        if run_state(folder):
            for before, now in zip(read_manifest(folder).fmus, fmus, strict=False):
                if before != now:
                    raise RecordingError(
                        f"the {self.kind} in {folder} cannot go on: {now.file} of {now.instance} "
                        f"is another file ({before.file}) or has changed since; run anew into "
                        "another folder"
                    )
        seeds = {"seed": loaded.spec.seed}
        if loaded.spec.study is not None and self.kind == "study":
            seeds["seeds"] = loaded.spec.study.seeds
        resolved = {v: loaded.resolved(v, loaded.variant_spec(v)) for v in self.variants}
        file = {"file": str(loaded.path.resolve()), "sha256": digest_of(loaded.path)}
        return Manifest(
            fmus=fmus, seeds=seeds, experiment={**file, "kind": self.kind, "variants": resolved}
        )


def _clear(folder: Path) -> None:
    """Remove what a run, study or sweep has written; pictures are replaced by those to come."""
    for one in (folder, *(inner for inner in folder.iterdir() if inner.is_dir())):
        clear_run(one)
    with writing(f"cannot clear the run folder {folder}", way_out=ANOTHER_FOLDER):
        for name in (RUN_FILE, JOURNAL_FILE, *_TABLES):
            (folder / name).unlink(missing_ok=True)


def digest_of(file: Path) -> str:
    """The SHA-256 of a file, hexadecimal; empty where it cannot be read."""
    try:
        with file.open("rb") as opened:
            return hashlib.file_digest(opened, "sha256").hexdigest()
    except OSError:
        return ""


@contextmanager
def opened_run(folder: Path) -> Iterator[RunRecord]:
    """What the run in `folder` was made from, while its files are there; raises `RecordingError`,
    `ExperimentError`."""
    path = folder / RUN_FILE
    try:
        held = json.loads(path.read_text(encoding="utf-8"))
        data, file, variants = held["data"], Path(held["file"]), tuple(map(str, held["variants"]))
        package, kind = held.get("package"), held.get("kind", "run")
        settings, digest = (package["settings"], package["sha256"]) if package else ({}, "")
    except FileNotFoundError as fault:
        raise RecordingError(
            f"{folder} holds no run of the command line: it has no {RUN_FILE}; give the folder "
            "that `fmu-harness run` named, or resume from Python with Bench.run(resume=True)"
        ) from fault
    except (OSError, ValueError, KeyError, TypeError) as fault:
        raise RecordingError(
            f"{path} cannot be read: {fault!r}; run anew into another folder"
        ) from fault
    if not package:
        yield RunRecord(Experiment.from_data(data, file), variants, kind=kind)
        return
    if _digest(file) != digest:
        what = "has changed since" if file.exists() else "is gone"
        raise RecordingError(
            f"the run in {folder} cannot go on: the package {file} that it runs {what}; put the "
            "one back with which it was begun, or run anew into another folder"
        )
    from harness.ssp.to_experiment import open_experiment

    with open_experiment(file, settings) as experiment:
        yield RunRecord(experiment, variants, settings, kind)


def _digest(package: Path) -> str:
    """Of the content of a package: of the file, or of the files in a folder that may belong to it;
    empty for what cannot be read."""
    files = [package]
    if package.is_dir():
        files = sorted(p for p in package.rglob("*") if p.suffix in _PACKAGE_FILES)
    digest = hashlib.sha256()
    try:
        for path in files:
            content = path.read_bytes()
            digest.update(f"{path.relative_to(package)}\0{len(content)}\0".encode())
            digest.update(content)
    except OSError:
        return ""
    return digest.hexdigest()
