"""µs per sample of a loop around equations: ours, bare C. `python -m benchmarks.model_exchange`.

A model-exchange FMU under a PI controller on a square wave: every sample changes the input, so it
is an event, and CVODE begins anew. The C program calls the same functions of the same FMU and of
the same SUNDIALS, with the same tolerance; both sides must end at the same y and u, bit for bit.
"""

from __future__ import annotations

import argparse
import subprocess
import tempfile
import xml.etree.ElementTree as ET
import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import fmpy
import numpy as np
from fmpy.model_description import ModelDescription
from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table

from benchmarks.lag import OPTIONS, SOURCES
from benchmarks.measuring import Series, interleaved, machine, write_json
from benchmarks.timed_run import timed_run
from fmus.hybrid_actuator.model import plant as hybrid_actuator
from fmus.two_mass_drive.model import plant as two_mass_drive
from harness.bench import Bench
from harness.system.block import Array, KernelBlock, Port

STEP, TOLERANCE, HALF_PERIOD, BOUND = 0.01, 1e-6, 50.0, 1.3
C, OURS = "bare C program", "ours"
SUNDIALS = ("core", "nvecserial", "sunmatrixdense", "sunlinsoldense", "cvode")


@dataclass(frozen=True)
class Case:
    """An FMU, its input and output, and the loop around it: gains (`ki` per sample), amplitude."""

    name: str
    fmu: Callable[[Path], Path]
    input: str
    output: str
    reference: float
    kp: float
    ki: float


def build_resonator(folder: Path) -> Path:
    """The FMU of `c/resonator.c`."""
    library, fmu = folder / "resonator.so", folder / "resonator.fmu"
    options = ("-fPIC", "-shared", "-fvisibility=hidden")
    subprocess.run([*OPTIONS, *options, SOURCES / "resonator.c", "-o", library], check=True)
    with zipfile.ZipFile(fmu, "w") as archive:
        archive.write(SOURCES / "modelDescription_resonator.xml", "modelDescription.xml")
        archive.write(library, "binaries/linux64/resonator.so")
    return fmu


CASES = (
    Case("resonator, FMI 2", build_resonator, "u", "y", 1.0, 0.2, 0.01),
    *(
        Case(f"{plant.name}, FMI {v}", lambda _, p=plant, v=v: p.fmu(v), *loop)  # type: ignore[misc]
        for v in (2, 3)
        for plant, loop in (
            (two_mass_drive, ("torque_reference", "motor_speed", 0.5, 1.0, 0.02)),
            (hybrid_actuator, ("command", "force", 1000.0, 6.5e-5, 1.1e-6)),
        )
    ),
)


def square_wave_pi(p: Array, x: Array, u: Array, y: Array) -> None:
    """p = (kp, ki, half a period), x = (integral, reference, samples left), u = (y,), y = (u,)."""
    if x[2] == 0.0:
        x[1], x[2] = -x[1], p[2]
    x[2] -= 1.0
    error = x[1] - u[0]
    x[0] += p[1] * error
    y[0] = p[0] * error + x[0]


@dataclass(frozen=True)
class Built:
    """The FMU, and the C program with the arguments before and after the number of samples."""

    case: Case
    fmu: Path
    before: tuple[str, ...]
    after: tuple[str, ...]


def build(case: Case, folder: Path) -> Built:
    """Compile the C program for a case; FMPy reads what it must know of the FMU, but for
    abilities, which it overlooks in FMI 3."""
    fmu = case.fmu(folder)
    unpacked = Path(fmpy.extract(str(fmu), str(folder / "unpacked")))
    d = fmpy.read_model_description(str(unpacked))
    identifier = d.modelExchange.modelIdentifier
    library = next(iter(unpacked.glob(f"binaries/*/{identifier}.so")))
    program = folder / "model_exchange"
    defined = [f"-D{name}={value}" for name, value in _constants(case, d, unpacked).items()]
    source = SOURCES / "model_exchange.c"
    subprocess.run([*OPTIONS, "-Wno-pedantic", *defined, source, "-o", program, "-lm"], check=True)
    place = next(iter((Path(fmpy.__file__).parent / "sundials").glob("x86_64-linux")))
    solver = tuple(str(place / f"sundials_{name}.so") for name in SUNDIALS)
    token = d.guid if d.fmiVersion.startswith("2") else d.instantiationToken
    return Built(case, fmu, (str(program), str(library), token), solver)


def _constants(case: Case, d: ModelDescription, unpacked: Path) -> dict[str, object]:
    version = int(d.fmiVersion[0])
    references = {v.name: v.valueReference for v in d.modelVariables}
    rates = [one.variable for one in d.derivatives]
    states = [v.derivative for v in rates]
    root = ET.parse(unpacked / "modelDescription.xml").getroot()
    said = {n for e in root.iter("ModelExchange") for n in e.attrib if e.get(n) in ("1", "true")}
    jacobian = {"providesDirectionalDerivative", "providesDirectionalDerivatives"} & said
    completed = version == 2 and "completedIntegratorStepNotNeeded" not in said
    completed |= "needsCompletedIntegratorStep" in said
    return {
        "FMI": version, "STATES": len(states), "TOLERANCE": TOLERANCE,
        "STATE_REFERENCES": ",".join(str(v.valueReference) for v in states),
        "RATE_REFERENCES": ",".join(str(v.valueReference) for v in rates),
        "JACOBIAN": int(bool(jacobian)), "COMPLETED": int(completed),
        "INPUT": references[case.input], "OUTPUT": references[case.output],
        "REFERENCE": case.reference, "KP": case.kp, "KI": case.ki,
        "HALF_PERIOD": HALF_PERIOD, "STEP_NS": round(STEP * 1e9),
    }  # fmt: skip


def bare_c(built: Built, samples: int) -> tuple[float, float, float]:
    """ns per sample, y and u at the last one."""
    command = [*built.before, str(samples), *built.after]
    text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    nanoseconds, y, u = text.split()
    return float(nanoseconds), float.fromhex(y), float.fromhex(u)


def ours(built: Built, samples: int) -> tuple[float, float, float]:
    """The same from our loop, with everything that a run does."""
    case = built.case
    bench = Bench(stop_time=samples * STEP, step=STEP)
    policy = {"interface_type": "model-exchange", "tolerance": TOLERANCE, "largest_step": STEP}
    bench.fmu("plant", built.fmu, **policy)  # type: ignore[arg-type]
    parameters = np.array([case.kp, case.ki, HALF_PERIOD])
    states = np.array([0.0, case.reference, HALF_PERIOD])
    block = KernelBlock((Port("y"),), (Port("u"),), square_wave_pi, parameters, states)
    bench.controller("controller", block)
    bench.connect(f"plant.{case.output}", "controller.y")
    bench.connect("controller.u", f"plant.{case.input}")
    recorded = (f"plant.{case.output}", "controller.u")
    run = timed_run(bench.system(), recorded)
    y, u = (float(run.result[name][-1]) for name in recorded)
    return run.nanoseconds, y, u


def measure(case: Case, samples: int, repeats: int) -> dict[str, Series]:
    """Both sides in turn, ns per sample."""
    with tempfile.TemporaryDirectory() as folder:
        built = build(case, Path(folder))
        end = bare_c(built, samples)[1:]

        def nanoseconds(run: Callable[[Built, int], tuple[float, float, float]]) -> float:
            found, *last = run(built, samples)
            if tuple(last) != end:
                raise SystemExit(f"{case.name}: ends at {tuple(last)}, the C program at {end}")
            return found

        sides = {C: partial(nanoseconds, bare_c), OURS: partial(nanoseconds, ours)}
        return interleaved(sides, repeats)


def ratios(series: dict[str, Series]) -> Series:
    """Ours over C, round by round."""
    pairs = zip(series[OURS].values, series[C].values, strict=True)
    return Series(tuple(a / b for a, b in pairs))


def table(results: dict[str, dict[str, Series]]) -> Table:
    """A row a case, medians with the smallest and largest in brackets."""
    made = Table(title="Model exchange in a closed loop, per sample of 10 ms", box=SIMPLE)
    made.add_column("", no_wrap=True)
    for heading in ("C, µs", "ours, µs", "ours / C"):
        made.add_column(heading, justify="right", no_wrap=True)
    for name, series in results.items():
        cells = [(series[C], 1e3, 2), (series[OURS], 1e3, 2), (ratios(series), 1.0, 3)]
        made.add_row(name, *(_spread(*cell) for cell in cells))
    return made


def _spread(series: Series, unit: float, digits: int) -> str:
    values = (series.median, series.minimum, max(series.values))
    median, low, high = (f"{value / unit:.{digits}f}" for value in values)
    return f"{median} ({low} to {high})"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--samples", type=int, default=10_000, help="at least 1000")
    parser.add_argument("--repeats", type=int, default=9)
    parser.add_argument("--json", type=Path, help="write all measurements there")
    options = parser.parse_args()
    console = Console(width=110)
    console.print(*machine().values(), sep="\n")
    results = {case.name: measure(case, options.samples, options.repeats) for case in CASES}
    console.print(table(results))
    if options.json:
        made = {n: {k: s.as_json() for k, s in series.items()} for n, series in results.items()}
        write_json(options.json, {"unit": "ns per sample", **made})
    broken = [name for name, series in results.items() if ratios(series).median > BOUND]
    if broken:
        raise SystemExit(f"more than {BOUND:g} times the C program: {', '.join(broken)}")


if __name__ == "__main__":
    main()
