"""µs a sample of each controller, compiled and interpreted; fuzzy inference and a Kalman filter
against libraries that do the same work."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache, partial

import numpy as np

from benchmarks import pendulum
from benchmarks.frame import Aim, Comparison, RefusedError, Setting, Side
from benchmarks.peers.environments import FILTER, INFERENCE, PEERS, titled
from benchmarks.peers.loop import measured_rows
from benchmarks.peers.task import RowsTask
from benchmarks.samples import Array, compiled, interpreted
from controllers.core.block import Block, Signal
from controllers.fuzzy.inference import FuzzySystem, grid_rules, triangular_partition
from controllers.fuzzy.map_block import fuzzy_map_block
from controllers.papers.ahn2009.fuzzy_pid import LABELS, TABLE_2
from harness import registry
from harness.experiment.experiment import Experiment
from tests.harness.export.blocks import EXAMPLES, example

ROWS, FEW = 20_000, 200
"""Rows of a round, compiled and interpreted."""
Measure = Callable[[Block, Array], tuple[Array, float]]


def comparisons(setting: Setting) -> Iterator[Comparison]:
    """Each controller on what it read in its experiment; both libraries' work on random rows."""
    sides = {name: Side(partial(sample, name, compiled, ROWS)) for name in EXAMPLES}
    aim = Aim(
        "the robust-EKF tuner, a sample", "tuned_fuzzy_pid", 10.0,
        "Three filters of 35 states each, of which 12 at a time are tuned: products of matrices.",
    )  # fmt: skip
    note = "Its inputs are those of the experiment that configures it."
    yield Comparison(
        "controllers", "A sample of each controller, compiled", "µs", sides, "pid", (aim,),
        note=note,
    )  # fmt: skip
    plain = {name: Side(partial(sample, name, interpreted, FEW)) for name in EXAMPLES}
    yield Comparison(
        "controllers_interpreted", "A sample of each controller, in plain Python", "µs", plain,
        "pid", note="What a debugger steps through; the same bits.",
    )  # fmt: skip
    yield _against(setting, "inference", INFERENCE, *inference())
    yield _against(setting, "filter", FILTER, *kalman())


@cache
def inputs(name: str) -> Array:
    """What a controller read in its experiment, shape (rows, n_u), repeated to `ROWS`."""
    file, variant, component = EXAMPLES[name]
    block, _ = example(name)
    result = Experiment.load(registry.experiment(file), {"record": ["*"]}).run(variant)
    columns = [result.numbers(f"{component}.{signal.name}") for signal in block.inputs]
    rows = np.array(columns).reshape(len(columns), -1).T if columns else np.zeros((1, 0))
    return np.ascontiguousarray(np.resize(rows, (ROWS, rows.shape[1])))


def sample(name: str, measure: Measure, rows: int) -> float:
    """µs a sample of a registered controller."""
    return measure(example(name)[0], inputs(name)[:rows])[1]


def _against(
    setting: Setting, name: str, kind: str, block: Block, rows: Array, model: dict[str, object],
    outputs: int,
) -> Comparison:  # fmt: skip
    """A block and the peers of one kind on the same rows, of which they get a part."""
    few = rows[:2000]

    def ours(measure: Measure, given: Array) -> float:
        found, microseconds = measure(block, given)
        if not np.array_equal(found[:FEW], interpreted(block, given[:FEW])[0]):
            raise RefusedError("compiled and interpreted differ")
        return microseconds

    @cache
    def right() -> Array:
        return compiled(block, few)[0][:, :outputs]

    def theirs(peer: str) -> float:
        return measured_rows(peer, RowsTask(model, few.tolist()), right()) / 1e3

    sides = {
        "ours, compiled": Side(partial(ours, compiled, rows)),
        "ours, in plain Python": Side(partial(ours, interpreted, few)),
    }
    asked = [peer for peer in setting.peers if PEERS[peer].loop == kind]
    sides |= {titled(peer): Side(partial(theirs, peer)) for peer in asked}
    title = f"The same {kind} elsewhere, a sample"
    return Comparison(name, title, "µs", sides, "ours, compiled")


def inference() -> tuple[Block, Array, dict[str, object], int]:
    """Table 2 of the lead paper for K_p: two inputs of five triangles, 25 rules, five weights."""
    table = tuple(tuple(LABELS.index(cell[0]) for cell in row) for row in TABLE_2)
    triangles, weights = triangular_partition(5), (0.0, 0.25, 0.5, 0.75, 1.0)
    system = FuzzySystem((triangles, triangles), (weights,), grid_rules(table))
    block = fuzzy_map_block(system, (Signal("a"), Signal("b")), (Signal("u"),))
    model = {
        "centres": [one.parameters[0] for one in triangles], "width": triangles[0].parameters[1],
        "weights": weights, "table": table,
    }  # fmt: skip
    return block, np.random.default_rng(4).uniform(size=(ROWS, 2)), model, 1


def kalman() -> tuple[Block, Array, dict[str, object], int]:
    """The pendulum of `benchmarks.pendulum`."""
    return pendulum.estimator(), pendulum.measurements(ROWS), pendulum.MODEL, 2
