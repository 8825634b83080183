"""A parity certificate is replayed; an FMU that does something else is found out."""

from __future__ import annotations

import json
import shutil
import zipfile
from dataclasses import replace
from pathlib import Path

import pytest

from harness import registry
from harness.cli.main import run_command_line
from harness.errors import FmuError
from harness.export.certificate import MEMBER, Certificate, with_certificate
from harness.export.certify import block_certificate, plant_certificate
from harness.export.controller import controller_fmu
from harness.export.verify import verify
from harness.fmi.fmu import Fmu
from tests.harness.export.blocks import example


@pytest.fixture(scope="module")
def certified() -> Path:
    return controller_fmu(example("pid")[0], "certified", example("pid")[1], portable=True)


def certificate(path: Path) -> Certificate:
    with zipfile.ZipFile(path) as archive:
        return Certificate.from_bytes(archive.read(MEMBER), path)


def changed(path: Path, target: Path, **changes: object) -> Path:
    with_certificate(path, target, replace(certificate(path), **changes))  # type: ignore[arg-type]
    return target


def test_it_agrees_bit_for_bit(certified: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert verify(certified).exact
    assert run_command_line(["verify", str(certified)]) == 0
    assert "agrees bit for bit" in capsys.readouterr().out


def test_its_numbers_survive_the_file(certified: Path) -> None:
    first = certificate(certified)
    assert Certificate.from_bytes(first.as_bytes(), certified) == first


def test_another_behaviour_is_found_out(
    certified: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    first = certificate(certified)
    spoilt = {name: list(column) for name, column in first.outputs.items()}
    spoilt["u"][30] += 1e-6 * max(map(abs, spoilt["u"]))
    other = changed(certified, tmp_path / "other.fmu", outputs=spoilt)
    assert verify(other).off == ("u",)
    assert run_command_line(["verify", str(other)]) == 1
    assert "u differ by more than is allowed" in " ".join(capsys.readouterr().err.split())


def test_a_last_digit_is_within_the_tolerance(certified: Path, tmp_path: Path) -> None:
    first = certificate(certified)
    near = {name: list(column) for name, column in first.outputs.items()}
    near["u"][30] *= 1.0 + 2.0**-52
    found = verify(changed(certified, tmp_path / "near.fmu", outputs=near))
    assert not found.exact and found.off == ()


@pytest.mark.parametrize("text", [b"no JSON", b"{}", b"[]", b'{"format": 7}', b"\xff"])
def test_a_garbled_certificate_is_one_sentence(
    certified: Path, tmp_path: Path, text: bytes
) -> None:
    bad = tmp_path / "bad.fmu"
    with zipfile.ZipFile(certified) as source, zipfile.ZipFile(bad, "w") as made:
        for name in source.namelist():
            made.writestr(name, text if name == MEMBER else source.read(name))
    with pytest.raises(FmuError, match=r"certificate of .* cannot be read"):
        verify(bad)


def test_an_fmu_without_one_says_so() -> None:
    with pytest.raises(FmuError, match="has no parity certificate"):
        verify(registry.plant_fmu("two_mass_drive"))


@pytest.mark.parametrize("kind", ["FMI 2", "FMI 3", "portable FMI 2", "portable FMI 3"])
def test_plants_agree_with_their_equations_in_python(kind: str, tmp_path: Path) -> None:
    plant = registry.plant("single_machine_infinite_bus")
    path = plant.fmu(int(kind[-1]), portable=kind.startswith("portable"))
    scales = {u.name: (u.start, u.nominal) for u in plant.inputs}  # type: ignore[attr-defined]
    made = plant_certificate(path, plant.reference(), scales, 0.01)  # type: ignore[attr-defined]
    assert set(made.difference.values()) == {0.0}
    target = tmp_path / path.name
    with_certificate(path, target, made)
    assert verify(target).exact


def test_the_rest_of_the_archive_is_unchanged(certified: Path, tmp_path: Path) -> None:
    copy = tmp_path / "copy.fmu"
    shutil.copyfile(certified, copy)
    again = tmp_path / "again.fmu"
    with_certificate(copy, again, certificate(copy))
    with zipfile.ZipFile(copy) as a, zipfile.ZipFile(again) as b:
        assert sorted(a.namelist()) == sorted(b.namelist())
        assert all(a.read(name) == b.read(name) for name in a.namelist())
    with Fmu(again) as fmu:
        assert json.loads((fmu.folder / MEMBER).read_text())["model"] == "certified"


def test_an_fmu_for_other_machines_is_certified_without_being_run(
    certified: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As those that are built with --targets; they are replayed where they run."""
    monkeypatch.setattr("harness.export.certify._runs_here", lambda path: False)
    block, sample_time = example("pid")
    made = block_certificate(certified, block, sample_time)
    assert made.difference == {} and made.outputs == certificate(certified).outputs
    target = tmp_path / "certified.fmu"
    with_certificate(certified, target, made)
    assert run_command_line(["verify", str(target)]) == 0
