"""Calls that cannot be meant: one sentence and exit code 2, from Python, file and command line."""

from pathlib import Path
from typing import Any

import pytest

from harness.bench import Bench
from harness.cli.main import run_command_line
from harness.errors import HarnessError
from tests.hostile.build import description, hostile_fmu

FILE = """title = "A lag"
stop_time = 0.1
step = 0.01

[components.plant]
fmu = "hostile.fmu"
[components.reference]
signal = "step"
parameters = { time = 0.02, final = 1.0 }

[connections]
"plant.u" = "reference.value"
"""
NUMBERS = {
    'stop_time="later"': "valid number", "stop_time=nan": "must be finite",
    "stop_time=inf": "must be finite", "stop_time=0.0": "is not after start",
    "stop_time=-1.0": "is not after start time", "start_time=1.0": "is not after start time 1 s",
    "stop_time=1e300": "must be finite",
    "step=0.0": "step must be positive", "step=-0.01": "must be positive", "step=nan": "finite",
    "step=inf": "must be finite", "step=0.3": "step 300 ms is longer than the run of 100 ms",
    "step=1e-10": "no whole number of nanoseconds", "step=[0.01]": "valid number",
    "record_step=1.0": "record",
    "components.plant.step=0.0077": "divide|multiple|cycle",
    "components.plant.step=-1.0": "step of plant must be positive",
    "components.plant.tolerance=-1.0": "tolerance must be positive, not -1.0",
    "components.plant.tolerance=nan": "tolerance must be positive, not nan",
    "components.plant.start_values.T=nan": "start value of 'T' must be finite, not nan",
    "components.plant.start_values.T=inf": "must be finite",
    "components.plant.start_values.T='slow'": "must be a number (Float64), not 'slow'",
    "components.plant.start_values.T=true": "must be a number (Float64), not True",
    "components.plant.start_values.T={a=1}": "must be a number",
    "components.plant.start_values.time=1": "cannot be set, for it is the independent variable",
    "components.plant.start_values.t=1": "no variable 't' to give a start value; legal names: T",
    'components.plant.fmu="gone.fmu"': "gone.fmu is not a file",
    'components.plant.fmu="plnat"': "no plant 'plnat'",
    'connections."plant.w"="reference.value"': "plant has no input 'w'",
    'connections."plnat.u"="reference.value"': "no component 'plnat'; did you mean 'plant'?",
    'connections."plant.u"="reference"': "", 'connections."plant.u".delay=-1.0': "negative|from",
    'record=["plant.z"]': "nothing to record matches 'plant.z'", "seed=-1": "seed",
    'components.reference.parameters.time="soon"': "'time'",
    'components.reference.parameters.tmie=1.0': "tmie",
    'components.reference.signal="stpe"': "did you mean 'step'",
}  # fmt: skip


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    hostile_fmu(tmp_path)
    (tmp_path / "lag.toml").write_text(FILE)
    return tmp_path


@pytest.mark.parametrize("setting", NUMBERS)
def test_settings(folder: Path, capsys: pytest.CaptureFixture[str], setting: str) -> None:
    arguments = ["run", str(folder / "lag.toml"), "--set", setting, "--output", str(folder / "o")]
    code = run_command_line(arguments)
    shown = capsys.readouterr().err
    error = shown[max(0, shown.find("error: ")) :]  # a progress bar may stand before it
    if not NUMBERS[setting]:
        assert code == 0, error
        return
    assert code == (1 if "gone.fmu" in setting else 2), error
    assert any(words in error for words in NUMBERS[setting].split("|")), error
    assert error.startswith("error: ") and "Traceback" not in error and error.count("\n") <= 2


LIMITED = {
    11: "'T' is 11, above its max 10", -1.5: "'T' is -1.5, below its min 0",
    "1x": "must be a number (Float64), not '1x'", None: "must be a number (Float64), not None",
    10**400: "must be finite, not a number of 401 digits",
    (1.0, "x"): "has no unit, but 'x' was given", (1.0, 2.0): "must have 1 element(s), not 2",
}  # fmt: skip
TYPED = (
    '<Int8 name="i" valueReference="9" causality="parameter" start="0"/>'
    '<Boolean name="b" valueReference="10" causality="parameter" start="false"/>'
    '<String name="s" valueReference="11" causality="parameter"><Start value=""/></String>'
)
MISTYPED = {
    "i": {300: "between -128 and 127 (Int8), not 300", 1.5: "must be a whole", "x": "number"},
    "b": {2: "must be true or false, not 2", "yes": "true or false", 0.5: "true or false"},
    "s": {1: "must be text, not 1", None: "must be text"},
}  # fmt: skip


def fault_of(fmu: Path, name: str, value: Any) -> str:
    bench = Bench(stop_time=0.1)
    bench.fmu("plant", fmu, start_values={name: value})
    with pytest.raises(HarnessError) as caught:
        bench.run()
    return str(caught.value)


def described(folder: Path, old: str, new: str) -> Path:
    from tests.harness.fmi.archives import rewritten

    document = description(3).replace(old, new).encode()
    source = hostile_fmu(folder)
    return rewritten(source, folder / "changed.fmu", modelDescription_dot_xml=document)


@pytest.mark.parametrize("value", LIMITED, ids=lambda value: str(value)[:8])
def test_start_values_outside_their_limits(tmp_path: Path, value: Any) -> None:
    fmu = described(tmp_path, 'start="0.1"', 'start="0.1" min="0" max="10"')
    text = fault_of(fmu, "T", value)
    assert any(words in text for words in LIMITED[value].split("|")), text


PAIRS = [(name, value) for name, some in MISTYPED.items() for value in some]


@pytest.mark.parametrize(("name", "value"), PAIRS)
def test_start_values_of_another_type(tmp_path: Path, name: str, value: Any) -> None:
    fmu = described(tmp_path, "</ModelVariables>", TYPED + "</ModelVariables>")
    assert MISTYPED[name][value] in fault_of(fmu, name, value)  # type: ignore[index]
