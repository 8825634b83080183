"""The benchmarks of foreign FMUs and packages tell what ran, what was refused, what differs."""

import zipfile
from pathlib import Path

import numpy as np
import pytest

from benchmarks import foreign_fmus, foreign_packages
from benchmarks.foreign import ask, difference
from tests.harness.fmi.archives import oscillator_fmu, rewritten
from tests.harness.ssp.packages import archive, component, connector, ssd


def faulty(folder: Path) -> Path:
    """An FMU with two variables of one name."""
    with zipfile.ZipFile(oscillator_fmu(2)) as opened:
        text = opened.read("modelDescription.xml").decode()
    twice = text.replace('name="damping"', 'name="mass"').encode()
    return rewritten(oscillator_fmu(2), folder / "faulty.fmu", modelDescription_dot_xml=twice)


@pytest.mark.slow
def test_fmus(tmp_path: Path) -> None:
    faulty(tmp_path)
    (tmp_path / "good.fmu").write_bytes(oscillator_fmu(3).read_bytes())
    (tmp_path / "none.fmu").write_bytes(b"no archive")
    elsewhere = rewritten(oscillator_fmu(2), tmp_path / "elsewhere.fmu")
    with zipfile.ZipFile(oscillator_fmu(2)) as old, zipfile.ZipFile(elsewhere, "w") as new:
        new.writestr("modelDescription.xml", old.read("modelDescription.xml"))
    rows = [row for found in foreign_fmus.compare_all([tmp_path], "", 60.0) for row in found]
    verdicts = {row.name: row.verdict for row in rows if row.kind in ("co-simulation", "")}
    assert verdicts == {
        "elsewhere.fmu": "no binary", "faulty.fmu": "agree", "good.fmu": "agree",
        "none.fmu": "no binary",
    }  # fmt: skip
    assert {row.verdict for row in rows if row.name == "good.fmu"} == {"agree"}
    refused = next(row for row in rows if row.name == "faulty.fmu")
    assert "twice" in refused.refused and "with --no-validate" in " ".join(
        foreign_fmus.cells(refused)
    )
    assert "FMUs: 4, can run here: 2, ran in the harness: 2" in foreign_fmus.summary(rows)


@pytest.mark.slow
@pytest.mark.parametrize(("last", "kind"), [(0.0, "ran"), (1.0, "differs")])
def test_packages(tmp_path: Path, last: float, kind: str) -> None:
    one = component("o", connector("position", "output"), source="o.fmu")
    text = ssd(f"<ssd:Elements>{one}</ssd:Elements>", '<ssd:DefaultExperiment stopTime="0.1"/>')
    path = archive(
        tmp_path / "p.ssp",
        {"SystemStructure.ssd": text, "o.fmu": oscillator_fmu(2).read_bytes()},
    )
    options = {"longest": 0.05, "compiled": False}
    first = ask("package", {"path": str(path), **options}, 60.0)
    values = first.columns["o.position"].copy()
    assert first.columns["time"][-1] == pytest.approx(0.05)
    values[-1] += last * max(1.0, np.ptp(values))
    table = np.stack([first.columns["time"], values], axis=1)
    np.savetxt(tmp_path / "p_out.csv", table, delimiter=",", header="time,o.position", comments="")
    assert foreign_packages.run(path, "p", options, 60.0).kind == kind


def test_a_side_that_hangs_is_ended() -> None:
    answer = ask("fmpy", {}, 0.01)
    assert not answer.ran and "did not end within 0.01 s" in answer.words


def test_an_event_may_be_seen_a_row_apart_and_no_more() -> None:
    time = np.arange(10.0)
    step = {"time": time, "y": (time >= 5).astype(float)}
    assert difference(step, {"time": time, "y": (time >= 6).astype(float)})[0] == 0.0
    assert difference(step, {"time": time, "y": (time >= 7).astype(float)}) == (1.0, "y")
    assert difference(step, {"time": time, "y": np.where(time > 8, np.nan, 0.0)})[0] == np.inf
    assert difference(step, {"time": time + 0.5, "y": time}) == (np.inf, "time")
