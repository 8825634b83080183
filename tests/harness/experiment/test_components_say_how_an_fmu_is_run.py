"""The keys of an FMU in an experiment file are those of the policy, and the run follows them."""

import math
from pathlib import Path

import pytest

from harness import Bench
from harness.errors import HarnessError
from harness.experiment.experiment import Experiment
from harness.experiment.schema import FmuSpec
from harness.system.policy import Policy
from tests.harness.simulation.fmus import misbehaving_fmu, model_fmu, needs_compiler

pytestmark = needs_compiler
FILE = """
title = "x' = -x"
stop_time = 0.2
step = 0.1
record = ["plant.x"]
[components.plant]
fmu = "{}"
{}
"""
EULER = 'interface_type = "model-exchange"\nsolver = "euler"\nlargest_step = 0.01'


def load(folder: Path, keys: str, fmu: Path | None = None) -> Experiment:
    path = folder / "one.toml"
    path.write_text(FILE.format(fmu or model_fmu("2"), keys), encoding="utf-8")
    return Experiment.load(path)


def test_the_words_and_what_holds_without_them_are_those_of_the_policy() -> None:
    given = FmuSpec(fmu="any").model_dump(by_alias=True)
    assert {name: given.pop(name) for name in vars(Policy())} == vars(Policy())
    assert set(given) == {"fmu", "step", "start_values"}


def test_the_solver_and_its_step_are_those_of_the_file(tmp_path: Path) -> None:
    held = load(tmp_path, EULER).run("run")
    assert held["plant.x"][-1] == pytest.approx(0.99**20, rel=1e-12)
    exact = load(tmp_path, "").run("run")
    assert exact["plant.x"][-1] == pytest.approx(math.exp(-0.2), rel=1e-12)


def test_not_finite_outputs_are_allowed_where_the_file_says_so(tmp_path: Path) -> None:
    spoilt = misbehaving_fmu("m->p.x = NAN", "SPOIL")
    with pytest.raises(HarnessError, match=r"output plant\.x is nan"):
        load(tmp_path, "", spoilt).run("run")
    result = load(tmp_path, "allow_not_finite = true", spoilt).run("run")
    assert math.isnan(result["plant.x"][-1]) and result.status.state == "complete"


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ('solver = "magic"', "components.plant.solver: must be one of 'cvode', 'euler', 'rk4' or"),
        ('discarded_steps = "skip"', "discarded_steps: must be one of 'divide' or 'fail', not"),
        ("validat = false", "components.plant.validat: unknown key; did you mean 'validate'"),
        ("largest_step = -1.0", "component plant: largest_step must be positive, not -1.0"),
        ('interface_type = "other"', "component plant: interface type 'other' is unknown; choose"),
    ],
)
def test_what_cannot_be_meant_is_named(tmp_path: Path, keys: str, words: str) -> None:
    with pytest.raises(HarnessError) as caught:
        load(tmp_path, keys).run("run")
    assert words in str(caught.value)


def test_a_bench_names_the_legal_words_too() -> None:
    bench = Bench(stop_time=1.0, step=0.1)
    bench.fmu("plant", model_fmu("2"), solver="magic", discarded_steps="skip")
    with pytest.raises(HarnessError) as caught:
        bench.run()
    assert "component plant: solver 'magic': legal names: cvode, dopri5, euler" in str(caught.value)
    assert "component plant: discarded_steps 'skip': legal names: divide, fail" in str(caught.value)
