"""How exact coupled FMUs are, by algorithm and step. `python -m benchmarks.coupling_order`.

A two-mass oscillator, split into two FMUs that exchange force and motion, against its monolithic
solution (matrix exponential). The left mass is pulled aside by 0.1 m and let go. The error is the
largest one of a position, or of a velocity over 10 rad/s, in the run, as a share of 0.1 m.

Theory: in a step of length h an input that is held at the value of one end differs from the true
one by O(h), which makes O(h²) in the states; over the run these add up to O(h). At the value of
the middle, from a line through two values, it differs from the mean of the true one by O(h²), so
the error of the run is O(h²). This is so for Jacobi, Gauss–Seidel and the iterative algorithm
alike; they differ in the constant, and in how they bear strong coupling: a second table shows the
largest displacement as the spring between the masses stiffens, which never exceeds the initial one.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

import matplotlib
import numpy as np
from numpy.typing import NDArray
from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table
from scipy.linalg import expm

from benchmarks.measuring import write_json
from fmus.oscillator_left.model import plant as left
from fmus.oscillator_right.model import plant as right
from harness.bench import Bench

STEPS = (0.02, 0.01, 0.005, 0.0025, 0.00125)
DISPLACEMENT = 0.1  # m
PACE = 10.0  # rad/s
TOLERANCE = 1e-11  # of the FMUs' solvers and of the repetitions: far below every error shown
STIFFNESSES = (50.0, 1e3, 5e3, 5e4)  # N/m, of the spring between the masses
STATES = ("left.position", "left.velocity", "right.position", "right.velocity")
WIRES = (
    ("left.position", "right.left_position"),
    ("left.velocity", "right.left_velocity"),
    ("right.coupling_force", "left.coupling_force"),
)
ALGORITHMS = ("jacobi", "gauss-seidel", "iterative")
WIRE_NAMES = ("hold", "linear")


@dataclass(frozen=True)
class Study:
    """Errors of one algorithm at `steps` (s), with held (0) or linear (1) wires."""

    algorithm: str
    extrapolation: int
    steps: tuple[float, ...]
    errors: tuple[float, ...]

    @property
    def order(self) -> float:
        """The slope of log error over log step."""
        return float(np.polyfit(np.log(self.steps), np.log(self.errors), 1)[0])


def coupled(
    algorithm: str,
    extrapolation: int,
    step: float,
    stop_time: float,
    tolerance: float = TOLERANCE,
    spring: Mapping[str, float] | None = None,
) -> Bench:
    """The two halves, coupled by `algorithm` at communication steps of `step` (s); `spring` are
    other parameters of the right half."""
    bench = Bench(stop_time=stop_time, step=step, algorithm=algorithm, coupling_tolerance=tolerance)
    start = {"position": DISPLACEMENT}
    bench.fmu("left", left.fmu(), tolerance=tolerance, start_values=start)
    bench.fmu("right", right.fmu(), tolerance=tolerance, start_values=dict(spring or {}))
    for source, target in WIRES:
        bench.connect(source, target, extrapolation=extrapolation)
    return bench


def monolithic(times: NDArray[np.float64]) -> NDArray[np.float64]:
    """The exact states (n, 4) at evenly spaced `times` (n,), in the order of `STATES`."""
    one, other = ({q.name: q.value for q in plant.parameters} for plant in (left, right))
    c_k, d_k = other["coupling_stiffness"], other["coupling_damping"]
    a = np.zeros((4, 4))
    a[0, 1] = a[2, 3] = 1.0
    for row, p in ((1, one), (3, other)):
        own, across = row - 1, 3 - row
        a[row, own : own + 2] = -(p["stiffness"] + c_k), -(p["damping"] + d_k)
        a[row, across : across + 2] = c_k, d_k
        a[row] /= p["mass"]
    advance = expm(a * (times[1] - times[0]))
    x = np.zeros((times.size, 4))
    x[0, 0] = DISPLACEMENT
    for k in range(1, times.size):
        x[k] = advance @ x[k - 1]
    return x


def study(
    algorithm: str, extrapolation: int, steps: tuple[float, ...] = STEPS, stop_time: float = 2.0
) -> Study:
    """Run one algorithm at all steps."""
    size = DISPLACEMENT * np.array([1.0, PACE, 1.0, PACE])
    errors = []
    for step in steps:
        result = coupled(algorithm, extrapolation, step, stop_time).run()
        found = np.column_stack([result[name] for name in STATES])
        errors.append(float((np.abs(found - monolithic(result.time)) / size).max()))
    return Study(algorithm, extrapolation, steps, tuple(errors))


def swing(algorithm: str, extrapolation: int, stiffness: float) -> float:
    """Largest displacement / initial one in 2 s at 10 ms; damping grows with the stiffness."""
    spring = {"coupling_stiffness": stiffness, "coupling_damping": stiffness / 1000}
    result = coupled(algorithm, extrapolation, 0.01, 2.0, 1e-7, spring).run()
    return float(np.abs(result["left.position"]).max()) / DISPLACEMENT


def strong_coupling() -> Table:
    """One row an algorithm, one column a stiffness; "diverges" is beyond tenfold."""
    made = Table(title="Largest displacement / initial displacement at 10 ms", box=SIMPLE)
    made.add_column("algorithm", no_wrap=True)
    made.add_column("wires", no_wrap=True)
    for stiffness in STIFFNESSES:
        made.add_column(f"{stiffness:g} N/m", justify="right")
    for order, name in enumerate(WIRE_NAMES):
        for algorithm in ALGORITHMS:
            found = [swing(algorithm, order, stiffness) for stiffness in STIFFNESSES]
            cells = [f"{one:.2f}" if one < 10 else "diverges" for one in found]
            made.add_row(algorithm, name, *cells)
    return made


def table(studies: list[Study]) -> Table:
    """One row an algorithm, one column a step."""
    made = Table(title="Error of the coupled halves / initial displacement", box=SIMPLE)
    made.add_column("algorithm", no_wrap=True)
    made.add_column("wires", no_wrap=True)
    for step in studies[0].steps:
        made.add_column(f"{step * 1e3:g} ms", justify="right")
    made.add_column("order", justify="right")
    for one in studies:
        cells = [f"{error:.1e}" for error in one.errors]
        made.add_row(
            one.algorithm, WIRE_NAMES[one.extrapolation], *cells, f"{one.order:.2f}"
        )  # fmt: skip
    return made


def plot(studies: list[Study], path: Path) -> None:
    """Error over step, log-log, with the slopes of orders one and two."""
    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(figsize=(6.4, 4.6), layout="constrained")
    colours = dict(zip(ALGORITHMS, ("C0", "C1", "C2"), strict=True))
    for one in studies:
        axes.loglog(
            np.array(one.steps) * 1e3, one.errors, "o-" if one.extrapolation else "s--",
            color=colours[one.algorithm], markerfacecolor="none" if not one.extrapolation else None,
            label=f"{one.algorithm}, {WIRE_NAMES[one.extrapolation]} ({one.order:.2f})",
        )  # fmt: skip
    steps = np.array(studies[0].steps)
    for order, anchor in ((1, 2.2), (2, 0.35)):
        held = [one for one in studies if one.extrapolation == order - 1]
        pick = max if order == 1 else min
        top = pick(one.errors[0] for one in held) * anchor
        axes.loglog(steps * 1e3, top * (steps / steps[0]) ** order, ":", color="0.5")
        axes.annotate(
            f"order {order}", (steps[-2] * 1e3, top * (steps[-2] / steps[0]) ** order),
            textcoords="offset points", xytext=(-4, 6 if order == 1 else -14), color="0.35",
            fontsize=8,
        )  # fmt: skip
    axes.set_xticks(steps * 1e3, [f"{step * 1e3:g}" for step in steps])
    axes.minorticks_off()
    axes.set_xlabel("communication step in ms")
    axes.set_ylabel("largest error / initial displacement")
    axes.grid(True, which="major", alpha=0.4)
    axes.legend(fontsize=8, title="algorithm, wires (fitted order)", title_fontsize=8)
    figure.savefig(path, dpi=100)
    plt.close(figure)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="write all errors there")
    parser.add_argument("--plot", type=Path, help="write the log-log plot there (PNG)")
    options = parser.parse_args()
    studies = [study(algorithm, order) for order in (0, 1) for algorithm in ALGORITHMS]
    Console(width=110).print(table(studies), strong_coupling())
    if options.json:
        rows = [asdict(one) | {"order": one.order} for one in studies]
        write_json(options.json, {"coupling": rows})
    if options.plot:
        plot(studies, options.plot)


if __name__ == "__main__":
    main()
