"""The lead experiment's PID loop as a script on FMPy (`docs/pid_loop_with_fmpy.py`), and here."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np

from harness import registry
from harness.experiment.experiment import Experiment
from harness.instruments.source import generator, named_seed

SCRIPT = Path(__file__).parents[1] / "docs/pid_loop_with_fmpy.py"
EXPERIMENT, VARIANT = "ahn2009/figure_11", "pid"
PAIRS = {"plant.force": "force", "controller.u": "u", "controller.measured": "measured"}


def prepared(folder: Path) -> list[str]:
    """The command that runs the script on our FMUs and random samples, results in `folder`."""
    here = Experiment.load(registry.experiment(EXPERIMENT)).run(VARIANT)
    seed = named_seed(1, "controller.measured/noise.source")
    noise = 5.0 * generator(seed).standard_normal(len(here.time))
    samples = np.column_stack([here["disturbance.value"], noise])
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / "samples.csv"
    np.savetxt(file, samples, fmt="%.17g", delimiter=",", header="disturbance,noise", comments="")
    fmus = (registry.plant_fmu(name, 3) for name in ("hybrid_actuator", "disturbance_generator"))
    command = [sys.executable, SCRIPT, *fmus, folder, "--samples", file]
    return list(map(str, command))


def difference(folder: Path) -> float:
    """The largest difference of the script's rows from ours, as a share of the signal's largest."""
    here = Experiment.load(registry.experiment(EXPERIMENT)).run(VARIANT)
    with (folder / "results.csv").open() as file:
        names = file.readline().strip().split(",")
        rows = dict(zip(names, np.loadtxt(file, delimiter=",").T, strict=True))
    gaps = (np.abs(here[a] - rows[b]).max() / np.abs(here[a]).max() for a, b in PAIRS.items())
    return float(max(gaps))


if __name__ == "__main__":
    subprocess.run(prepared(Path(sys.argv[1])), check=True)
    print(difference(Path(sys.argv[1])))
