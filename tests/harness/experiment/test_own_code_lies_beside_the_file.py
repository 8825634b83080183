"""A controller, metric or signal of one's own is found beside the experiment file, from anywhere,
and hides nothing that is installed."""

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from harness import registry
from harness.cli.main import run_command_line
from harness.errors import UsageError
from harness.results.recording import read_recording
from tests.harness.experiment.loops import FILE

CODE = """
from controllers.core.block import Block
import numpy as np
import {helper}


class Law:
    def __init__(self, k):
        self.K = np.array([[k]])

    def step(self, time, reference, measured):
        return self.K @ np.array([reference - measured])


def law(time, reference, measured, *, gain=1.0, scale={helper}.SCALE):
    return gain * scale * (reference - measured)


def largest(values):
    return values.max()
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    modules, path = set(sys.modules), list(sys.path)
    place = tmp_path / "own"
    place.mkdir()
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    yield place
    sys.path[:] = path
    for name in set(sys.modules) - modules:
        if str(tmp_path) in str(getattr(sys.modules[name], "__file__", "")):
            del sys.modules[name]


def write(folder: Path, name: str, controller: str) -> Path:
    (folder / f"{name}.py").write_text(CODE.format(helper=f"{name}_helper"))
    (folder / f"{name}_helper.py").write_text("SCALE = 2.0\n")
    text = FILE.replace('controller = "pid"', f'controller = "{name}:{controller}"')
    text = text.replace("parameters = { kp = 0.5, ki = 8.0, u_min = -10.0, u_max = 10.0 }", "")
    own = f'[metrics.top]\nkind = "{name}:largest"\nsignal = "lag.y"\n'
    path = folder / "loop.toml"
    key = "k" if controller == "Law" else "gain"
    path.write_text(
        text.replace(
            "controller.parameters.kp = 1.0", f"controller.parameters.{key} = 1.0"
        ).replace(
            "[variants.soft]", f"[variants.soft]\ncomponents.controller.parameters.{key} = 3.0"
        )
        + own
    )
    return path


@pytest.mark.parametrize(("name", "kind"), [("ctl_one", "Law"), ("ctl_two", "law")])
def test_a_class_and_a_function(folder: Path, name: str, kind: str) -> None:
    path = write(folder, name, kind)
    assert run_command_line(["run", str(path), "--output", "out", "--set", "stop_time=0.2"]) == 0
    soft, hard = (read_recording(Path("out") / one) for one in ("soft", "hard"))
    factor = 1.0 if kind == "Law" else 2.0
    for run, gain in ((soft, 3.0), (hard, 1.0)):
        e = run["controller.reference"] - run["controller.measured"]
        assert (run["controller.u"] == gain * factor * e).all()
    assert ",top," in Path("out/metrics.csv").read_text()


@pytest.mark.parametrize("taken", ["numpy", "colorsys"])
def test_the_name_of_an_installed_module_is_refused(folder: Path, taken: str) -> None:
    (folder / f"{taken}.py").write_text("law = 1\n")
    registry.search_in(folder)
    with pytest.raises(UsageError, match=rf"{taken}\.py has the name of another module .*rename"):
        registry.controller(f"{taken}:law")


def test_faults_of_the_module_are_sentences(folder: Path) -> None:
    (folder / "ctl_broken.py").write_text("x = 1 / 0\n")
    (folder / "ctl_near.py").write_text("def regulator(time, y):\n    return y\n")
    registry.search_in(folder)
    for name, words in (
        ("ctl_broken:law", "cannot be imported: ZeroDivisionError: division by zero"),
        ("ctl_near:regulater", "ctl_near has no 'regulater'; did you mean 'regulator'"),
        ("ctl_nowhere:law", f"No module named 'ctl_nowhere'; looked for in {folder}"),
    ):
        with pytest.raises(UsageError) as caught:
            registry.controller(name)
        assert words in str(caught.value)
