"""Where the algorithm adds energy to a strong coupling, a note says so and names one that holds it;
where the coupling is held, and where growth is a polynomial, there is none."""

import numpy as np
import pytest

from benchmarks.coupling_order import coupled
from harness.bench import Bench
from harness.master.growth import CouplingGrowth
from harness.master.prepared import PreparedSystem

WORDS = "what left and right exchange grew in every 8th of the run"


def run(algorithm: str, linear: int, stiffness: float) -> tuple[float, str]:
    """The largest displacement (m) of the left mass, pulled aside by 0.1 m, and the notes."""
    spring = {"coupling_stiffness": stiffness}
    result = coupled(algorithm, linear, 0.01, 2.0, 1e-6, spring).run()
    return float(np.abs(result["left.position"]).max()), " ".join(result.manifest.notes)


@pytest.mark.parametrize(
    ("algorithm", "linear", "stiffness"),
    [("jacobi", 0, 1e3), ("jacobi", 1, 5e3), ("gauss-seidel", 0, 5e3), ("iterative", 0, 5e3)],
)
def test_one_that_is_not_held(algorithm: str, linear: int, stiffness: float) -> None:
    largest, notes = run(algorithm, linear, stiffness)
    assert largest > 1.0 and WORDS in notes and f"too strong for the {algorithm} algorithm" in notes
    assert 'try algorithm = "iterative" with extrapolation = 1' in notes


@pytest.mark.parametrize(
    ("algorithm", "linear", "stiffness"),
    [("jacobi", 0, 50.0), ("gauss-seidel", 1, 1e3), ("iterative", 1, 5e3), ("iterative", 1, 5e4)],
)
def test_one_that_is_held(algorithm: str, linear: int, stiffness: float) -> None:
    largest, notes = run(algorithm, linear, stiffness)
    assert largest < 0.11 and WORDS not in notes


def growth(power: int, stop: float = 2.0) -> str:
    """The note for signals that grow as that power of time."""
    bench: Bench = coupled("jacobi", 0, 0.01, stop)
    with PreparedSystem(bench.system(), ("*",)) as prepared:
        watch = CouplingGrowth(prepared.plan, {n: f.description for n, f in prepared.fmus.items()})
        times = np.arange(1001) * stop / 1000
        rows = np.repeat((times[:, None] / stop) ** power, len(prepared.plan.recorded), axis=1)
        for part in np.array_split(np.arange(1001), 7):
            watch.see(times[part], rows[part])
        return watch.note()


def test_polynomials_are_no_instability() -> None:
    assert [bool(growth(power)) for power in (0, 1, 2, 4, 20)] == [False, False, False, False, True]
