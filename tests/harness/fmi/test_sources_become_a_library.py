"""An FMU that holds sources only runs once a library was built from them, and says so before."""

import zipfile
from pathlib import Path

import numpy as np
import pytest

from harness import simulate
from harness.cli.main import run_command_line
from harness.errors import FmuError
from harness.fmi.sources import compiled
from tests.harness.inspection.liars import liar
from tests.harness.simulation.fmus import needs_compiler

SOURCE = Path(__file__).parents[1] / "inspection" / "liar.c"
pytestmark = needs_compiler
FILES = '<SourceFiles><File name="{}"/></SourceFiles></CoSimulation>'


@pytest.fixture(autouse=True)
def _empty_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FMU_HARNESS_CACHE", str(tmp_path / "cache"))


def sources_only(folder: Path, name: str = "model/liar.c", code: str = "") -> Path:
    """The lag of `liar.c` as sources, of which `name` is stated."""
    whole = liar(folder)
    made = folder / "sources.fmu"
    with zipfile.ZipFile(whole) as old, zipfile.ZipFile(made, "w") as new:
        text = old.read("modelDescription.xml").decode()
        head, slash, tail = text.partition("<CoSimulation")
        own, _, rest = tail.partition("/>")
        new.writestr("modelDescription.xml", f"{head}{slash}{own}>{FILES.format(name)}{rest}")
        new.writestr("sources/model/liar.c", code or SOURCE.read_text())
    return made


def test_it_runs_as_the_one_with_a_library(tmp_path: Path) -> None:
    made = compiled(sources_only(tmp_path))
    inputs = {"u": lambda t: 1.0}
    one, other = (simulate(f, stop_time=1.0, step_size=0.1, inputs=inputs)  # type: ignore[arg-type]
                  for f in (made, tmp_path / "liar.fmu"))  # fmt: skip
    assert one["y"][-1] > 0.1
    np.testing.assert_allclose(one["y"], other["y"], rtol=1e-12)
    assert compiled(tmp_path / "sources.fmu") == made and compiled(made) == made


@pytest.mark.parametrize("command", ["simulate", "info", "doctor"])
def test_every_command_builds_it(
    tmp_path: Path, command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path = sources_only(tmp_path)
    times = ["--stop-time", "1", "--step-size", "0.1"] if command == "simulate" else []
    if times:
        assert run_command_line([command, str(path), *times]) == 1
        assert "--compile builds one" in capsys.readouterr().err
    assert run_command_line([command, str(path), "--compile", *times]) == 0


@pytest.mark.parametrize(
    ("name", "code", "words"),
    [("model/none.c", "", "no 'model/none.c' below sources"),
     ("../modelDescription.xml", "", "no '../modelDescription.xml' below sources"),
     ("model/liar.c", "int x = ;", "the C compiler says .*error")],
)  # fmt: skip
def test_what_cannot_be_built_is_a_sentence(
    tmp_path: Path, name: str, code: str, words: str
) -> None:
    with pytest.raises(FmuError, match=words):
        compiled(sources_only(tmp_path, name, code))
