"""Our solver and others on the same equations. `python -m benchmarks.work_precision`.

Each plant runs in closed loop at 10 ms with an input that jumps at every sample, since that is what
co-simulation does to a solver (`plant_loops`). Rodas5P is what our FMUs use; RODAS4 shares its
linear algebra and error control; CVODE is compiled, too; Radau is scipy's, in Python. The error is
the largest one of a state over the run, as a share of its range, of the worst state.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path

import matplotlib
import numpy as np
from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table

from benchmarks.measuring import machine, write_json
from benchmarks.plant_loops import LOOPS, Loop, closed_loop
from benchmarks.solvers import Solvers
from benchmarks.stepper import Stepped
from benchmarks.trajectory import STEP, Array, Trajectory

OURS = "Rodas5P (ours)"
TOLERANCES = tuple(10.0**-k for k in range(3, 10))
TARGETS = (1e-4, 1e-5, 1e-6, 1e-7)
"""Errors at which the methods are compared."""


@dataclass(frozen=True)
class Point:
    """One method at one tolerance: mean µs per sample, error as a share of the worst's range."""

    plant: str
    method: str
    tolerance: float
    microseconds: float
    error: float


def methods(solvers: Solvers) -> dict[str, Callable[[float, float, Array], Stepped]]:
    """By name, called with tolerance, step and inputs."""
    return {
        OURS: partial(solvers.rosenbrock, 5),
        "RODAS4": partial(solvers.rosenbrock, 4),
        "CVODE": solvers.cvode,
        "Radau (scipy)": solvers.radau,
    }


def points(trajectory: Trajectory, solvers: Solvers, repeats: int) -> list[Point]:
    """All methods in turn at each tolerance, Radau once; the fastest round of a sample counts."""
    made = []
    for tolerance in TOLERANCES:
        fastest: dict[str, Array] = {}
        states: dict[str, Array] = {}
        for number in range(repeats):
            for name, method in methods(solvers).items():
                if name.startswith("Radau") and number > 0:
                    continue
                run = method(tolerance, STEP, trajectory.inputs)
                fastest[name] = np.minimum(fastest.get(name, run.nanoseconds), run.nanoseconds)
                states[name] = run.states
        made += [
            Point(
                trajectory.plant.name, name, tolerance, float(fastest[name].mean() / 1e3),
                float(trajectory.error(states[name]).max()),
            )
            for name in fastest
        ]  # fmt: skip
    return made


def time_at(found: list[Point], error: float) -> float:
    """µs per sample at an error, between the two nearest points that enclose it on logarithmic
    scales; NaN where the method does not come there."""
    best = sorted((one.error, one.microseconds) for one in found)
    errors, times = np.array(best).T
    if not errors[0] <= error <= errors[-1]:
        return float("nan")
    return float(np.exp(np.interp(np.log(error), np.log(errors), np.log(times))))


def table(results: list[Point]) -> Table:
    """A row a plant and error."""
    made = Table(title="µs per sample of 10 ms at equal error", box=SIMPLE)
    names = list(dict.fromkeys(one.method for one in results))
    made.add_column("plant", no_wrap=True)
    made.add_column("error / range", justify="right", no_wrap=True)
    for name in names:
        made.add_column(name, justify="right", no_wrap=True)
    for plant in dict.fromkeys(one.plant for one in results):
        for target in TARGETS:
            times = [
                time_at([o for o in results if (o.plant, o.method) == (plant, name)], target)
                for name in names
            ]
            if not np.isnan(times[0]):
                cells = ("–" if np.isnan(t) else f"{t:.1f}" for t in times)
                made.add_row(plant, f"{target:.0e}", *cells)
    return made


def plot(results: list[Point], path: Path) -> None:
    """A panel a plant: to the left is more exact, below is faster."""
    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    plants = list(dict.fromkeys(one.plant for one in results))
    figure, axes = plt.subplots(2, 4, figsize=(12, 6.2), layout="constrained")
    for panel, plant in zip(axes.flat, plants, strict=False):
        rows = [one for one in results if one.plant == plant]
        for name, marker in zip(dict.fromkeys(o.method for o in rows), "os^d", strict=True):
            line = [(o.error, o.microseconds) for o in rows if o.method == name]
            panel.loglog(*np.array(line).T, marker + "-", label=name, markersize=4)
        panel.set_title(plant, fontsize=9)
        panel.grid(True, which="major", alpha=0.4)
        panel.tick_params(labelsize=8)
    handles, labels = axes.flat[0].get_legend_handles_labels()
    for panel in axes.flat[len(plants) :]:
        panel.axis("off")
        panel.legend(handles, labels, loc="center", fontsize=9)
    figure.supxlabel("largest error of the worst state / its range", fontsize=10)
    figure.supylabel("µs per sample of 10 ms", fontsize=10)
    figure.savefig(path, dpi=100)
    plt.close(figure)


def measure(loop: Loop, folder: Path, samples: int, repeats: int, console: Console) -> list[Point]:
    """All points of a loop, and how good its reference is."""
    solvers = Solvers.of(loop.plant, folder)
    trajectory = closed_loop(loop, solvers, samples)
    doubt = trajectory.error(solvers.rosenbrock(5, 1e-12, STEP, trajectory.inputs).states).max()
    console.print(f"{loop.plant.name}: Radau at 1e-10 and Rodas5P at 1e-12 differ by {doubt:.0e}")
    return points(trajectory, solvers, repeats)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--samples", type=int, default=100)
    parser.add_argument("--repeats", type=int, default=9)
    parser.add_argument("--json", type=Path, help="write all measurements there")
    parser.add_argument("--plot", type=Path, help="write the work-precision diagrams there (PNG)")
    options = parser.parse_args()
    console = Console(width=110)
    console.print(*machine().values(), sep="\n")
    results: list[Point] = []
    with tempfile.TemporaryDirectory() as folder:
        for loop in LOOPS:
            results += measure(loop, Path(folder), options.samples, options.repeats, console)
    console.print(table(results))
    if options.json:
        write_json(options.json, {"points": [asdict(one) for one in results]})
    if options.plot:
        plot(results, options.plot)


if __name__ == "__main__":
    main()
