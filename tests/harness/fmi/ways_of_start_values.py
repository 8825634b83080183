"""The ways by which a start value reaches an FMU: each runs the FMU of FMI 3 with start values and
gives the first value of one of its outputs."""

import csv
import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from harness import simulate
from harness.bench import Bench
from harness.cli.main import run_command_line
from harness.errors import HarnessError
from harness.experiment.experiment import Experiment
from harness.ssp.to_experiment import open_experiment
from tests.harness.simulation.fmus import model_fmu
from tests.harness.ssp.packages import NAMESPACES, archive, component, ssd

Starts = Mapping[str, Any]
Way = Callable[[Starts, str, Path], float]
FEET = '<ssv:Units><ssc:Unit name="ft"><ssc:BaseUnit m="1" factor="0.3048"/></ssc:Unit></ssv:Units>'


def by_bench(starts: Starts, output: str, _: Path) -> float:
    bench = Bench(stop_time=0.1, step=0.1, record=[f"test.{output}"])
    bench.fmu("test", model_fmu("3"), start_values=starts)
    return float(bench.run()[f"test.{output}"][0])


def by_file(starts: Starts, output: str, folder: Path) -> float:
    lines = "".join(f"{json.dumps(n)} = {json.dumps(value)}\n" for n, value in starts.items())
    (folder / "e.toml").write_text(
        f'title = "e"\nstop_time = 0.1\nstep = 0.1\nrecord = ["test.{output}"]\n'
        f'[components.test]\nfmu = "{model_fmu("3")}"\n[components.test.start_values]\n{lines}'
    )
    return float(Experiment.load(folder / "e.toml").run("run")[f"test.{output}"][0])


def by_simulate(starts: Starts, output: str, _: Path) -> float:
    result = simulate(
        model_fmu("3"), stop_time=0.0, start_values=starts, output_variables=[output.split("[")[0]]
    )
    return float(result[output][0])


def as_text(value: Any) -> str:
    if isinstance(value, tuple):
        return f"{value[0]}[{value[1]}]"
    return " ".join(map(str, value)) if isinstance(value, list) else str(value)


def by_flag(starts: Starts, output: str, folder: Path) -> float:
    flags = [f"--start-values={name}={as_text(value)}" for name, value in starts.items()]
    code = run_command_line(
        ["simulate", str(model_fmu("3")), "--stop-time", "0", *flags, "--output-file",
         str(folder / "o.csv"), "--output-variables", output.split("[")[0]]
    )  # fmt: skip
    if code:
        raise HarnessError(f"exit code {code}")  # the sentence is on standard error
    with (folder / "o.csv").open() as file:
        return float(next(csv.DictReader(file))[output])


def as_parameter(name: str, value: Any) -> str:
    value, unit = value if isinstance(value, tuple) else (value, "")
    kind = {str: "String", int: "Int64"}.get(type(value), "Float64")
    sizes = f'<ssv:Dimension size="{len(value)}"/>' if isinstance(value, list) else ""
    of_unit = f' unit="{unit}"' if unit else ""
    return (
        f'<ssv:Parameter name="{name}"><ssv:{kind} value="{as_text(value)}"{of_unit}/>{sizes}'
        "</ssv:Parameter>"
    )


def by_package(starts: Starts, output: str, folder: Path) -> float:
    parameters = "".join(as_parameter(*pair) for pair in starts.items())
    ssv = (
        f'<ssv:ParameterSet {NAMESPACES} version="2.0" name="p"><ssv:Parameters>{parameters}'
        f"</ssv:Parameters>{FEET}</ssv:ParameterSet>"
    )
    binding = (
        '<ssd:ParameterBindings><ssd:ParameterBinding source="p.ssv"/></ssd:ParameterBindings>'
    )
    elements = component("test", "", binding, "resources/t.fmu")
    text = ssd(
        f"<ssd:Elements>{elements}</ssd:Elements>",
        '<ssd:DefaultExperiment stopTime="0.1"/>', version="2.0",
    )  # fmt: skip
    files = {"SystemStructure.ssd": text, "p.ssv": ssv,
             "resources/t.fmu": model_fmu("3").read_bytes()}  # fmt: skip
    settings = {"step": 0.1, "record": [f"test.{output}"]}
    with open_experiment(archive(folder / "p.ssp", files), settings) as experiment:
        return float(experiment.run(experiment.variants[0])[f"test.{output}"][0])


WAYS = [by_bench, by_file, by_simulate, by_flag, by_package]
