"""What `--set` says holds in every variant, also in one that states the same key."""

import json
from pathlib import Path

import pytest

from harness.cli.main import run_command_line
from tests.harness.experiment.loops import FILE, load, write

LIKE = FILE.replace("[study]", '[variants.harder]\nlike = "hard"\nstop_time = 0.5\n[study]')
GAIN = "components.controller.parameters.kp"
WIRED = FILE.replace("[study]", '[variants.wired]\nconnections."lag.u" = "controller.u"\n[study]')
OTHER = FILE.replace(
    "[study]",
    '[variants.other]\ncomponents.controller = { controller = "gain", '
    "parameters = { kp = [[1.0]] } }\n[study]",
)


def gain(path: Path, variant: str, *pairs: str) -> float:
    value = load(path, LIKE, *pairs).variant_spec(variant).components["controller"]
    return float(value.parameters["kp"])  # type: ignore[union-attr]


@pytest.mark.parametrize("variant", ["soft", "hard", "harder"])
def test_a_key_that_variants_state(tmp_path: Path, variant: str) -> None:
    assert gain(tmp_path, variant) == (0.5 if variant == "soft" else 1.0)
    assert gain(tmp_path, variant, f"{GAIN}=7.0") == 7.0


def test_a_setting_of_one_variant_wins_over_that_of_all(tmp_path: Path) -> None:
    pairs = f"variants.hard.{GAIN}=3.0", f"{GAIN}=7.0"
    assert gain(tmp_path, "hard", *pairs) == 3.0 and gain(tmp_path, "soft", *pairs) == 7.0


def test_a_wire_that_is_a_plain_string(tmp_path: Path) -> None:
    experiment = load(tmp_path, WIRED, 'connections."lag.u".delay=0.02')
    wires = [experiment.variant_spec(v).connections["lag.u"] for v in experiment.variants]
    assert [wire.delay for wire in wires] == [0.02, 0.02, 0.02]


def test_a_component_that_becomes_another_one(tmp_path: Path) -> None:
    experiment = load(tmp_path, FILE, 'components.controller={controller="gain"}')
    assert {experiment.variant_spec(v).components["controller"].controller  # type: ignore[union-attr]
            for v in experiment.variants} == {"gain"}  # fmt: skip


def test_a_setting_that_cannot_reach_a_variant_says_so(tmp_path: Path) -> None:
    with pytest.warns(UserWarning, match=r"parameters\.ki does not reach variant other"):
        experiment = load(tmp_path, OTHER, "components.controller.parameters.ki=2.0")
    assert "ki" not in experiment.data["variants"]["other"]["components"]["controller"]


def test_the_command_line_runs_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    runs = []
    for number, pair in enumerate(("seed=5", f"{GAIN}=0.5")):
        folder = tmp_path / str(number)
        code = run_command_line(
            ["run", str(write(tmp_path)), "--variant", "hard", "--output", str(folder),
             "--set", pair]
        )  # fmt: skip
        assert code == 0, capsys.readouterr().err
        manifest = json.loads((folder / "hard" / "manifest.json").read_text())
        runs.append(manifest["experiment"]["components"]["controller"]["parameters"]["kp"])
    assert runs == [1.0, 0.5]
