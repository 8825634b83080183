"""The power system: its loop through the FMU is what its equations say, and what it loses."""

from pathlib import Path

import numpy as np
import pytest

from harness.experiment.experiment import Experiment
from harness.experiment.sweep import run_sweep
from tests.controllers.compiled import run
from tests.fmus.plants.bench import Simulator, single_machine_infinite_bus

FOLDER = Path(__file__).parents[2] / "experiments/takata"
SHORT = {"stop_time": 2.0, "components": {"plant": {"start_values": {"speed": -4.0}}}}
STATES = ("angle_deviation", "speed")


def stacked(result, component):
    return np.column_stack([result[f"{component}.{name}"] for name in STATES])


def trajectory(variant):
    """x_k by Radau, u_k by the interpreted controller and filter: the sequence by hand."""
    experiment = Experiment.load(FOLDER / "figure_4.toml", SHORT)
    bench = experiment.bench(variant).system()
    block = {c.name: c.block for c in bench.components if c.name != "plant"}
    plant = Simulator(single_machine_infinite_bus)
    start = experiment.variant_spec(variant).components["plant"].start_values
    x, rows, u = np.array([start[name] for name in STATES]), [], 0.0
    memory = {name: (b.parameters.copy(), b.state.copy(), np.zeros(len(b.outputs)))
              for name, b in block.items()}  # fmt: skip
    for _ in range(201):
        given = np.array([u, x[1], *x])[: len(block["filter"].inputs)]
        block["filter"].step(*memory["filter"][:2], given, memory["filter"][2])
        estimate = memory["filter"][2][:2] if variant[-4:] != "full" else x
        block["controller"].step(*memory["controller"][:2], estimate, memory["controller"][2])
        u = float(memory["controller"][2][0])
        rows.append([*x, u])
        x = plant.step(x, np.array([u, 0.0]), 1e-10)
    return np.array(rows)


@pytest.mark.parametrize("variant", ["aaccf", "loc", "aaccf_full", "loc_start"])
def test_the_loop_is_the_sequence_of_the_equations(variant):
    result = Experiment.load(FOLDER / "figure_4.toml", SHORT).run(variant)
    found = np.column_stack([stacked(result, "plant"), result["controller.u"]])
    expected = trajectory(variant)
    assert np.abs(found - expected).max() < 1e-5 * np.abs(expected).max()


def test_a_filter_that_starts_at_the_state_is_the_full_state():
    experiment = Experiment.load(FOLDER / "figure_4.toml", SHORT)
    for controller in ("aaccf", "loc"):
        full, known = (experiment.run(f"{controller}_{kind}") for kind in ("full", "start"))
        assert np.abs(stacked(full, "plant") - stacked(known, "plant")).max() < 1e-5
        assert np.abs(stacked(known, "filter") - stacked(known, "plant")).max() < 1e-5


def test_the_printed_filter_does_not_see_the_saddle():
    """From (1.3, 0) the machine has slipped within 3 s while the estimate has not left 0.2 rad."""
    result = Experiment.load(FOLDER / "figure_4.toml", {"stop_time": 3.0}).run("aaccf")
    assert result["plant.angle_deviation"][-1] > 2 * np.pi
    assert np.abs(result["filter.angle_deviation"]).max() < 0.2


@pytest.mark.slow
def test_stable_shares_on_a_coarse_grid():
    """11 × 11 points of figure 3: the full state is the known start, and what the README says."""
    axes = {"x": {"count": 11}, "y": {"count": 11}}
    regions = run_sweep(Experiment.load(FOLDER / "figure_3.toml", {"sweep": axes}))
    share = {name: region.share for name, region in regions.items()}
    assert share["aaccf_full"] == share["aaccf_start"] > share["loc_full"] == share["loc_start"]
    gained = regions["aaccf_full"].inside & ~regions["loc_full"].inside
    assert np.all(np.array(regions["loc_full"].spec.x.values)[np.nonzero(gained)[1]] > 0.0)
    assert max(share["aaccf"], share["loc"]) < 0.6


def test_the_controllers_of_the_file_are_those_of_section_6():
    experiment = Experiment.load(FOLDER / "figure_4.toml")
    block = next(c.block for c in experiment.bench("loc").system().components
                 if c.name == "controller")  # fmt: skip
    assert run(block, np.eye(2))[:, 0] == pytest.approx([0.5, 0.96453114], abs=1e-8)
