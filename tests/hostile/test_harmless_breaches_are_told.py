"""What an FMU does against the standard and changes no number is a note, not silence."""

from pathlib import Path

import pytest

from harness import simulate
from tests.harness.fmi.archives import rewritten
from tests.hostile.build import description, hostile_fmu

TIMES = {"stop_time": 0.1, "step_size": 0.01}
_WORD = '<String name="word" valueReference="5" causality="output" initial="calculated"/>'
_OUTPUT = '<Output valueReference="1" dependencies=""/>'


def notes(folder: Path, old: str, new: str, *behaviours: str, fmi: int = 3) -> list[str]:
    text = description(fmi).replace(old, new)
    if new == _WORD + old:
        text = text.replace(_OUTPUT, _OUTPUT + _OUTPUT.replace('"1"', '"5"'))
    source = hostile_fmu(folder, *behaviours, fmi=fmi)
    path = rewritten(source, folder / "x.fmu", modelDescription_dot_xml=text.encode())
    result = simulate(path, **TIMES)
    assert len(result.time) == 11
    return list(result.notes)


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_tool_that_is_needed(tmp_path: Path, fmi: int) -> None:
    told = notes(tmp_path, "<CoSimulation ", '<CoSimulation needsExecutionTool="true" ', fmi=fmi)
    assert told == ["component hostile: its FMU says that it needs its tool to run"]


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_library_of_another_version(tmp_path: Path, fmi: int) -> None:
    [note] = notes(tmp_path, "", "", "GetVersion other", fmi=fmi)
    assert f"library says that it is of FMI '1.0', its description that it is of FMI {fmi}" in note


@pytest.mark.parametrize(
    ("action", "words"),
    [("no_text", "a null pointer instead of a string"), ("latin_1", "a string that is not UTF-8")],
)
def test_texts_that_are_none(tmp_path: Path, action: str, words: str) -> None:
    end = "\n  </ModelVariables>"
    [note] = notes(tmp_path, end, _WORD + end, f"GetString {action}")
    assert words in note and "of variable 'word'" in note
