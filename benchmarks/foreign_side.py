"""One side of a comparison, in the process that `benchmarks.foreign.ask` starts for it.

    python -m benchmarks.foreign_side SIDE TASK ANSWER

SIDE is a function of this module, TASK its arguments as JSON; ANSWER, an npz file, receives the
columns and, as JSON, their names, the seconds of the simulation and the words of a fault.
"""

from __future__ import annotations

import json
import sys
import tempfile
import time
from typing import Any

import numpy as np

from benchmarks.foreign import Columns


def ours(
    path: str, kind: str, start: float, stop: float, step: float, names: list[str],
    compiled: bool, event_mode: bool, validate: bool = True,
) -> Columns:  # fmt: skip
    """The harness; model exchange by CVODE with rows every `step` (s)."""
    from harness import simulate

    rows: dict[str, Any] = {"output_interval" if kind == "model-exchange" else "step_size": step}
    result = simulate(
        path, interface_type=kind, start_time=start, stop_time=stop, output_variables=names,
        relative_tolerance=1e-5, event_mode=event_mode, validate=validate, **rows,
    )  # fmt: skip
    columns = {name: result[name] for name in names if name not in result.texts}
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


def main() -> int:
    """Run the side and write the answer."""
    side, task, answer = sys.argv[1:]
    run = {"ours": ours, "fmpy": fmpy}[side]
    columns: Columns = {}
    words, begun = "", time.perf_counter()
    try:
        columns = run(**json.loads(task))
    except Exception as fault:
        words = f"{type(fault).__name__}: {fault}" if side != "ours" else str(fault)
        words = words or type(fault).__name__
    told = {"words": words, "seconds": time.perf_counter() - begun, "names": list(columns)}
    arrays: dict[str, Any] = {f"column{i}": v for i, v in enumerate(columns.values())}
    np.savez(answer, told=np.array(json.dumps(told)), **arrays)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
