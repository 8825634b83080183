"""What the README shows runs as it stands there."""

import re
from pathlib import Path

import pytest

from harness.experiment.experiment import Experiment

README = (Path(__file__).parents[1] / "README.md").read_text(encoding="utf-8")


def block(language: str, start: str) -> str:
    blocks = re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)
    return next(text for text in blocks if text.startswith(start))


def test_the_ten_lines_of_python_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    scope: dict[str, object] = {}
    exec(block("python", "from harness import Bench"), scope)
    assert (tmp_path / "force.png").stat().st_size > 10_000
    force = scope["result"]["plant.force"]  # type: ignore[index]
    assert abs(force[-1] - 2000.0) < 200.0


def test_the_experiment_file_runs(tmp_path: Path) -> None:
    path = tmp_path / "step.toml"
    path.write_text(block("toml", "title ="), encoding="utf-8")
    experiment = Experiment.load(path)
    rises = [experiment.run(v).metrics["rise_time"] for v in ("gentle", "quick")]
    assert rises[0] is not None and rises[1] is not None and rises[1] < rises[0]


def test_the_pictures_are_there() -> None:
    for name in re.findall(r"!\[[^]]*\]\(([^)]+)\)", README):
        assert (Path(__file__).parents[1] / name).is_file()
