"""µs per doStep of our plants, and how exact they are. `python -m benchmarks.plant_steps`.

Work against precision at several relative tolerances: doStep is called by address from compiled
code, over a step response at 10 ms macro steps (`trajectory`), and every state is compared with
scipy's Radau at rtol 1e-10. The error is the largest one of a state over the run, as a share of
that state's range, of the worst state.
"""

from __future__ import annotations

import argparse
from dataclasses import asdict, dataclass
from pathlib import Path

import matplotlib
import numpy as np
from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table

from benchmarks.measuring import machine, write_json
from benchmarks.stepper import step_through
from benchmarks.trajectory import STEP, Trajectory, step_response
from fmus.disturbance_generator.model import plant as disturbance_generator
from fmus.hybrid_actuator.model import plant as hybrid_actuator

AMPLITUDES = {hybrid_actuator: 0.1, disturbance_generator: 0.3}
VERSIONS = {hybrid_actuator: (2, 3), disturbance_generator: (3,)}
TOLERANCES = tuple(10.0**-k for k in range(3, 9))


@dataclass(frozen=True)
class Work:
    """One FMU at one tolerance: µs per doStep, worst error as a share of the state's range."""

    plant: str
    fmi_version: int
    tolerance: float
    median: float
    p99: float
    error: float
    worst_state: str


def work(trajectory: Trajectory, fmi_version: int, tolerance: float, repeats: int) -> Work:
    """Measure one FMU at one tolerance."""
    plant = trajectory.plant
    stepped = step_through(
        plant.fmu(fmi_version), tolerance, STEP, trajectory.names, trajectory.inputs, repeats
    )
    error = trajectory.error(stepped.states)
    microseconds = stepped.nanoseconds / 1e3
    return Work(
        plant.name,
        fmi_version,
        tolerance,
        float(np.median(microseconds)),
        float(np.percentile(microseconds, 99)),
        float(error.max()),
        trajectory.names[1][int(error.argmax())],
    )


def table(results: list[Work]) -> Table:
    """One row a measurement."""
    made = Table(title="doStep of 10 ms over a step response", box=SIMPLE)
    made.add_column("plant", no_wrap=True)
    for heading in ("FMI", "tolerance", "median µs", "p99 µs", "error / range"):
        made.add_column(heading, justify="right", no_wrap=True)
    made.add_column("worst state", no_wrap=True)
    for one in results:
        made.add_row(
            one.plant, str(one.fmi_version), f"{one.tolerance:.0e}", f"{one.median:.1f}",
            f"{one.p99:.1f}", f"{one.error:.1e}", one.worst_state,
        )  # fmt: skip
    return made


def plot(results: list[Work], path: Path) -> None:
    """The work-precision diagram: to the left is more exact, below is faster."""
    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(figsize=(6.4, 4.2), layout="constrained")
    for place, plant in zip((6, -12), dict.fromkeys(one.plant for one in results), strict=True):
        rows = [one for one in results if one.plant == plant and one.fmi_version == 3]
        errors = [one.error for one in rows]
        (line,) = axes.loglog(errors, [one.median for one in rows], "o-", label=f"{plant}, median")
        axes.loglog(
            errors, [one.p99 for one in rows], "o:", color=line.get_color(), label=f"{plant}, p99",
            markerfacecolor="white",
        )  # fmt: skip
        for one in rows:
            axes.annotate(
                f"{one.tolerance:.0e}".replace("e-0", "e-"),
                (one.error, one.median),
                textcoords="offset points", xytext=(0, place), color=line.get_color(), fontsize=7,
            )  # fmt: skip
    axes.margins(x=0.08)
    axes.set_xlabel("largest error of the worst state / its range")
    axes.set_ylabel("µs per doStep of 10 ms")
    axes.grid(True, which="major", alpha=0.4)
    axes.legend(fontsize=8)
    figure.savefig(path, dpi=100)
    plt.close(figure)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=9)
    parser.add_argument("--json", type=Path, help="write all measurements there")
    parser.add_argument("--plot", type=Path, help="write the work-precision diagram there (PNG)")
    options = parser.parse_args()
    console = Console(width=110)
    console.print(*machine().values(), sep="\n")
    results, doubts = [], {}
    for plant, amplitude in AMPLITUDES.items():
        trajectory = step_response(plant, amplitude)
        coarser = step_response(plant, amplitude, rtol=1e-9)
        doubts[plant.name] = float(trajectory.error(coarser.exact[1:]).max())
        for fmi_version in VERSIONS[plant]:
            results += [work(trajectory, fmi_version, t, options.repeats) for t in TOLERANCES]
    console.print(table(results))
    for name, doubt in doubts.items():
        console.print(
            f"reference of {name}: Radau at rtol 1e-9 differs by {doubt:.0e} of the range"
        )
    if options.json:
        write_json(options.json, {"reference": doubts, "steps": [asdict(one) for one in results]})
    if options.plot:
        plot(results, options.plot)


if __name__ == "__main__":
    main()
