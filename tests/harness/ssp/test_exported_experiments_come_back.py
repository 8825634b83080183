"""Export, then import, is the identity; what cannot be exported says why."""

import zipfile
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from harness.errors import ExperimentError
from harness.experiment.experiment import Experiment, Table
from harness.ssp import from_experiment
from harness.ssp.to_experiment import open_experiment
from harness.system.block import Block
from tests.harness.fmi.archives import oscillator_fmu
from tests.harness.ssp.packages import WAY_OUT, described_only

pytestmark = pytest.mark.filterwarnings("ignore:in other tools")


def maker(folder: Path, block: Block, name: str, *_: Any, **__: Any) -> Path:
    return described_only(folder, block, name)


def loop(fmi_version: int = 2, **changes: Any) -> Table:
    """An oscillator under PID."""
    return {
        "title": "Oscillator <under> PID & noise",
        "stop_time": 0.2,
        "step": 0.01,
        "seed": 3,
        "components": {
            "plant": {"fmu": str(oscillator_fmu(fmi_version)), "start_values": {"mass": 3.5}},
            "reference": {"signal": "sine", "parameters": {"amplitude": 0.1, "frequency": 2.0}},
            "pid": {
                "controller": "pid",
                "sample_time": 0.02,
                "parameters": {"kp": 3.0, "ki": 1.0, "u_min": -9.0, "u_max": float("inf"),
                               "measured_unit": "m", "output_unit": "N"},
            },
        },
        "connections": {
            "pid.reference": {"from": "reference.value"},
            "pid.measured": {
                "from": "plant.position", "imperfections": [{"kind": "noise", "std": 1e-3}],
            },
            "plant.force": {"from": "pid.u", "delay": 0.005, "factor": 0.5, "offset": 0.125},
        },
        "measure": {"reference": "reference.value", "response": "plant.position",
                    "control": "pid.u"},
        **changes,
    }  # fmt: skip


def without_files(spec: Any) -> Any:
    data = spec.model_dump()
    for one in data["components"].values():
        one.pop("fmu", None)
    return data | {"variants": None}


def export(experiment: Experiment, target: Path) -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(from_experiment, "controller_fmu", partial(maker, target.parent))
        from_experiment.export_experiment(experiment, target, experiment.variants)


def exported(data: Table, tmp_path: Path) -> tuple[Experiment, Path]:
    experiment = Experiment.from_data(data, tmp_path / "loop.toml")
    target = tmp_path / "loop.ssp"
    export(experiment, target)
    return experiment, target


@pytest.mark.parametrize("fmi_version", [2, 3])
def test_settings_and_rows_are_the_same(tmp_path: Path, fmi_version: int) -> None:
    variants: Table = {
        "soft": {"label": "soft one"},
        "hard": {"components": {"pid": {"parameters": {"kp": 9.0}}}},
        "alone": {"connections": {"plant.force": {"delay": 0.0, "convert_units": False}}},
    }
    original, path = exported(loop(fmi_version, variants=variants), tmp_path)
    with open_experiment(path) as again:
        assert again.variants == original.variants
        for name in original.variants:
            assert again.label(name) == original.label(name)
            found = without_files(again.variant_spec(name))
            assert found == without_files(original.variant_spec(name))
            one, other = original.run(name), again.run(name)
            assert one.names == other.names
            assert all(np.array_equal(one[signal], other[signal]) for signal in one.names)
            assert one.metrics == other.metrics
        twice = tmp_path / "twice.ssp"
        export(again, twice)
    assert twice.read_bytes() == path.read_bytes()


NUMBERS = st.floats(-1e6, 1e6, allow_nan=False).filter(lambda x: x == 0 or abs(x) > 1e-300)


@given(
    starts=st.dictionaries(st.sampled_from(["mass", "damping", "force", "position"]), NUMBERS),
    factor=NUMBERS,
    offset=NUMBERS,
    convert=st.booleans(),
    parameters=st.dictionaries(st.sampled_from(["kp", "ki", "kd"]), NUMBERS),
    seed=st.integers(0, 2**40),
    title=st.text(st.characters(codec="utf-8", exclude_categories=("Cs", "Cc")), max_size=9),
    algorithm=st.sampled_from(["jacobi", "gauss-seidel"]),
    delay=st.integers(0, 10**9).map(lambda ns: ns / 1e9),
)
@settings(max_examples=15, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_settings_come_back(tmp_path: Path, starts: Table, factor: float, offset: float,
                                convert: bool, parameters: Table, delay: float,
                                **top: Any) -> None:  # fmt: skip
    data = loop(**top)
    data["components"]["plant"]["start_values"] = starts
    data["components"]["pid"]["parameters"] |= {"kp": 1.0, **parameters}
    data["connections"]["plant.force"] |= {
        "factor": factor, "offset": offset, "convert_units": convert, "delay": delay,
    }  # fmt: skip
    try:
        original, path = exported(data, tmp_path)
    except ExperimentError as fault:  # a gain that the controller refuses
        assert "cannot be exported" in str(fault)
        return
    with open_experiment(path) as again:
        assert without_files(again.variant_spec("run")) == without_files(original.spec)


def test_a_changed_fmu_runs_as_it_is(tmp_path: Path) -> None:
    _, path = exported(loop(), tmp_path)
    changed = path.with_name("changed.ssp")
    with zipfile.ZipFile(path) as old, zipfile.ZipFile(changed, "w") as new:
        for name in old.namelist():
            content = old.read(name)
            new.writestr(name, content + (b"\0" if name == "resources/pid.fmu" else b""))
    with (
        pytest.warns(UserWarning, match="pid runs as an FMU, not in process: its FMU was"),
        open_experiment(changed) as experiment,
    ):
        assert "fmu" in experiment.variant_spec("run").model_dump()["components"]["pid"]


SENSITIVITY = {"sensitivity": "plant.position", "to": "plant.force"}
PYTHON = {"controller": "tests.harness.experiment.loops:Lag", "outputs": ["y"]}


@pytest.mark.parametrize(
    ("component", "words"),
    [
        (SENSITIVITY, r"loop \(run\) cannot be exported: component more is a sensitivity"),
        (
            PYTHON,
            "component more is plain Python, of which no FMU can be made; write it",
        ),
    ],
)
def test_what_has_no_fmu_says_so(tmp_path: Path, component: Table, words: str) -> None:
    data = loop()
    data["components"]["more"] = component
    with pytest.raises(ExperimentError, match=words) as caught:
        exported(data, tmp_path)
    assert WAY_OUT.search(str(caught.value))
    assert not list(tmp_path.glob("*.ssp*"))
