"""One side of a comparison, in the process that `benchmarks.foreign.ask` starts for it.

    python -m benchmarks.foreign_side SIDE TASK ANSWER

SIDE is a function of this module, TASK its arguments as JSON; ANSWER, an npz file, receives the
columns and, as JSON, their names, the seconds of the simulation and the words of a fault.
"""

from __future__ import annotations

import json
import shutil
import sys
import tempfile
import time
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.foreign import Columns


def ours(
    path: str, kind: str, start: float, stop: float, step: float, names: list[str],
    compiled: bool, event_mode: bool, validate: bool = True,
) -> Columns:  # fmt: skip
    """The harness; model exchange by CVODE with rows every `step` (s)."""
    from harness import simulate
    from harness.fmi.sources import compiled as build

    path = str(build(path, validate=validate)) if compiled else path
    rows: dict[str, Any] = {"output_interval" if kind == "model-exchange" else "step_size": step}
    result = simulate(
        path, interface_type=kind, start_time=start, stop_time=stop, output_variables=names,
        relative_tolerance=1e-5, event_mode=event_mode, validate=validate, **rows,
    )  # fmt: skip
    columns = {name: result[name] for name in names if name in result.numeric}
    return {"time": result.time} | {n: np.asarray(c, float) for n, c in columns.items()}


def fmpy(
    path: str, kind: str, start: float, stop: float, step: float, names: list[str],
    compiled: bool, event_mode: bool,
) -> Columns:  # fmt: skip
    """FMPy with the same step and tolerance; with `compiled` it builds the sources first."""
    from fmpy import simulate_fmu

    if compiled:
        from fmpy import extract
        from fmpy.build import build_platform_binary

        path = extract(path, tempfile.mkdtemp())
        build_platform_binary(path)
    kind = {"co-simulation": "CoSimulation", "model-exchange": "ModelExchange"}.get(kind, kind)
    rows = simulate_fmu(
        path, fmi_type=kind, start_time=start, stop_time=stop, output_interval=step,
        relative_tolerance=1e-5, output=names, validate=False, use_event_mode=event_mode,
    )  # fmt: skip
    assert rows.dtype.names is not None
    kept = [name for name in rows.dtype.names if rows[name].dtype.kind in "biuf"]
    return {name: np.asarray(rows[name], float) for name in kept}


def package(path: str, longest: float, compiled: bool, validate: bool = True) -> Columns:
    """A package under the harness, its first description, for at most `longest` seconds."""
    from harness.ssp.to_experiment import open_experiment

    changed = {"validate_fmus": validate, "compile_fmus": compiled}
    with open_experiment(path, changed) as experiment:
        variant = experiment.variants[0]
        spec = experiment.variant_spec(variant)
        stop = min(spec.stop_time, spec.start_time + longest)
    with open_experiment(path, {**changed, "stop_time": stop}) as experiment:
        result = experiment.run(variant)
    numbers = {n: result[n] for n in result.numeric}
    return {"time": result.time} | {n: np.asarray(c, float) for n, c in numbers.items()}


def table(path: str) -> Columns:
    """A table of results beside a package."""
    from harness.instruments.csv_signal import read_csv_table

    read = read_csv_table(Path(path))
    names = read.names[1:]
    values = [np.asarray(read.columns.column(i), float) for i in range(1 + len(names))]
    return dict(zip(("time", *names), values, strict=True))


def ecos(
    path: str, compiled: bool, times: list[float], rows: int, names: list[str]
) -> Columns:  # fmt: skip
    """A package under Ecos, whose steps are those between our rows, with FMUs built as for us.
    Ecos applies a set of start values only where it is named."""
    from ecospy import EcosSimulation

    from harness.fmi.sources import compiled as build
    from harness.ssp.document import PARAMETER_SET_TYPE
    from harness.ssp.package import open_package
    from harness.ssp.parameters import ParameterSet
    from harness.ssp.tree import build_tree

    step = times[1] - times[0]
    found: dict[str, list[float]] = {name: [] for name in names}
    with open_package(path) as package, ExitStack() as stack:
        file = next(iter(package.structures))
        tree = build_tree(package, file, stack)
        bindings = [(one, node) for node in tree.fmus for one in node.element.bindings]
        sets = [
            node.scope.content(ParameterSet, one, PARAMETER_SET_TYPE, str(node.source))
            for one, node in bindings
        ]
        folder = package.folder
        if compiled and package.closed:
            for node in tree.fmus:
                if (made := build(node.source, validate=False)) != node.source:
                    shutil.copyfile(made, node.source)
        with EcosSimulation(ssp_path=str(folder), step_size=step) as simulation:
            simulation.init(parameter_set=sets[0].name if sets else None)
            for row in range(rows):
                if row:
                    simulation.step()
                for name in list(found):
                    try:
                        found[name].append(simulation.get_real(name.replace(".", "::", 1)))
                    except Exception:  # no real number
                        del found[name]
            simulation.terminate()
    columns = {name: np.array(values) for name, values in found.items()}
    return {"time": times[0] + step * np.arange(rows)} | columns


def main() -> int:
    """Run the side and write the answer."""
    side, task, answer = sys.argv[1:]
    run = {one.__name__: one for one in (ours, fmpy, package, table, ecos)}[side]
    columns: Columns = {}
    words, begun = "", time.perf_counter()
    try:
        columns = run(**json.loads(task))
    except Exception as fault:
        words = f"{type(fault).__name__}: {fault}" if side in ("fmpy", "ecos") else str(fault)
        words = words or type(fault).__name__
    told = {"words": words, "seconds": time.perf_counter() - begun, "names": list(columns)}
    arrays: dict[str, Any] = {f"column{i}": v for i, v in enumerate(columns.values())}
    np.savez(answer, told=np.array(json.dumps(told)), **arrays)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
