"""Each status of each function that the loop calls ends the run or not, as the standard says."""

from pathlib import Path

import pytest

from harness.errors import HarnessError
from tests.hostile.worlds import bench

NAMES = {2: ("GetReal", "SetReal"), 3: ("GetFloat64", "SetFloat64")}
ENDING = [
    ("discard", "returned Discard"),
    ("error", "returned Error"),
    ("fatal", "returned Fatal"),
    ("pending", "returned Pending"),
    ("status 77", "returned status 77"),
    ("status -1", "returned status -1"),
]


def told(folder: Path, *behaviours: str, fmi: int) -> HarnessError:
    with pytest.raises(HarnessError) as caught:
        bench(folder, "DoStep log_error 50", *behaviours, fmi=fmi).run()
    assert "\n" not in str(caught.value)
    return caught.value


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize(("status", "words"), ENDING)
def test_in_the_loop(tmp_path: Path, fmi: int, status: str, words: str) -> None:
    action, _, number = status.partition(" ")
    fault = told(tmp_path, f"DoStep {action} 50 {number or 0}", fmi=fmi)
    assert f"component plant: doStep by 10 ms at t = 0.5 s {words}: the valve broke" in str(fault)
    assert len(fault.result.time) == 51
    for function in NAMES[fmi]:
        fault = told(tmp_path, f"{function} {action} 50 {number or 0}", fmi=fmi)
        assert words in str(fault) and "component plant" in str(fault)


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("phase", ["EnterInitializationMode", "ExitInitializationMode"])
@pytest.mark.parametrize("status", ["discard", "error", "fatal", "pending"])
def test_outside_the_loop(tmp_path: Path, fmi: int, phase: str, status: str) -> None:
    fault = told(tmp_path, f"{phase} {status}", fmi=fmi)
    assert f"component plant: fmi{fmi}{phase} returned {status.capitalize()}" in str(fault)


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("status", ["discard", "error", "fatal", "pending"])
def test_at_the_end_it_is_a_note_since_all_rows_are_there(
    tmp_path: Path, fmi: int, status: str
) -> None:
    result = bench(tmp_path, f"Terminate {status}", fmi=fmi).run()
    assert result.status.state == "complete" and len(result.time) == 101
    said = [note for note in result.manifest.notes if "Terminate" in note]
    assert len(said) == 1 and "component plant" in said[0]
    assert f"fmi{fmi}Terminate returned {status.capitalize()}" in said[0]


@pytest.mark.parametrize("fmi", [2, 3])
def test_warnings_go_on(tmp_path: Path, fmi: int) -> None:
    phases = ("DoStep", "EnterInitializationMode", "Terminate", *NAMES[fmi])
    result = bench(tmp_path, *(f"{phase} warning" for phase in phases), fmi=fmi).run()
    assert result.status.state == "complete" and len(result.time) == 101


@pytest.mark.parametrize("fmi", [2, 3])
def test_nothing_is_called_after_fatal(tmp_path: Path, fmi: int) -> None:
    late = ("Terminate abort", "FreeInstance abort", "unload abort")
    fault = told(tmp_path, "DoStep fatal 50", *late, fmi=fmi)
    assert "returned Fatal" in str(fault)


@pytest.mark.parametrize("fmi", [2, 3])
def test_no_instance(tmp_path: Path, fmi: int) -> None:
    function = "Instantiate" if fmi == 2 else "InstantiateCoSimulation"
    fault = told(tmp_path, f"{function} null", fmi=fmi)
    assert "component plant: FMU hostile could not be instantiated" in str(fault)


@pytest.mark.parametrize("action", ["early", "terminate"])
def test_early_return_and_the_wish_to_end(tmp_path: Path, action: str) -> None:
    words = {"early": "returned before the end of the step", "terminate": "asked for the end"}
    fault = told(tmp_path, f"DoStep {action} 50", fmi=3)
    assert words[action] in str(fault) and "at t = 0.5 s" in str(fault)


@pytest.mark.parametrize(
    ("time", "words"),
    [
        ("middle", "(it got to t = 0.505 s)"),
        ("backwards", "(and its lastSuccessfulTime is 0.49, which is not within the step)"),
        ("last_nan", "(and its lastSuccessfulTime is nan, which is not within the step)"),
    ],
)
def test_the_time_that_a_step_reached(tmp_path: Path, time: str, words: str) -> None:
    """It counts where the step ended early or was discarded, and nowhere else."""
    assert f"before the end of the step {words}" in str(
        told(tmp_path, f"DoStep early_{time} 50", fmi=3)
    )
    assert f"returned Discard {words}: the valve" in str(
        told(tmp_path, f"DoStep discard_{time} 50", fmi=3)
    )
    result = bench(tmp_path, f"DoStep {time} 50").run()
    assert result.status.state == "complete" and len(result.time) == 101


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("value", ["nan", "infinite"])
def test_values_that_are_no_numbers(tmp_path: Path, fmi: int, value: str) -> None:
    fault = told(tmp_path, f"{NAMES[fmi][0]} {value} 50", fmi=fmi)
    assert f"output plant.y is {'nan' if value == 'nan' else 'inf'} at t = " in str(fault)


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("kind", ["null", "garbage", "format", "long", "stranger"])
def test_loggers_may_be_abused(tmp_path: Path, fmi: int, kind: str) -> None:
    made = bench(tmp_path, f"DoStep log_{kind} 50", "SetupExperiment log", fmi=fmi)
    heard: list[str] = []
    result = made.run(echo=lambda component, message: heard.append(f"{component} {message}"))
    assert result.status.state == "complete"
    assert heard or kind == "stranger"


def test_many_messages(tmp_path: Path) -> None:
    result = bench(tmp_path, "DoStep log_many 99 100000").run()
    assert result.status.state == "complete"
