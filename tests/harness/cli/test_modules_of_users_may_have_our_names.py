"""A user's `controllers.py` or `fmus/` does not keep the harness from its own, nor him from his."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
SCRIPT = """
import pickle

from harness import Bench, registry
{before}
made = registry.controller("pid")(kp=2.0)
again = pickle.loads(pickle.dumps(made))
Bench(step=0.1, stop_time=1.0).controller("pid", again.block(0.1))
print(registry.plant_fmu("oscillator_left").suffix, type(again) is type(made), end=" ")
print(type(made).__module__)

from controllers import pid
print(pid)
"""
OURS = "controllers.pid.pid"
MODEL = "controllers.papers.takata.machine_model:MachineParameters"


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The working folder, with a user's `controllers.py` and package `fmus`."""
    (tmp_path / "controllers.py").write_text('pid = "his own"\n\n\ndef law(t, e):\n    return e\n')
    (tmp_path / "fmus").mkdir()
    (tmp_path / "fmus" / "__init__.py").write_text("")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(*arguments: str, first: str = "") -> subprocess.CompletedProcess[str]:
    """Python in that folder, with `first` before the repository on the path."""
    path = os.pathsep.join(filter(None, (first, str(ROOT))))
    return subprocess.run(
        [sys.executable, *arguments],
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize("before", ["", "import controllers, fmus"])
def test_a_script_has_both(folder: Path, before: str) -> None:
    (folder / "script.py").write_text(SCRIPT.format(before=before))
    done = run("script.py")
    assert done.stdout.splitlines() == [f".fmu True {OURS}", "his own"], done.stderr


@pytest.mark.parametrize(
    ("options", "first"), [(("-P", "-m"), ""), (("-m",), ""), (("-P", "-m"), ".")]
)
def test_the_command_line_lists_plants_controllers_and_experiments(
    options: tuple[str, ...], first: str
) -> None:
    done = run(*options, "harness.cli.main", "list", first=first)
    assert done.returncode == 0, done.stderr
    for name in ("hybrid_actuator", "tuned_fuzzy_pid", "ahn2009/figure_7"):
        assert name in done.stdout


def test_own_code_and_models_by_name_are_each_ones_own() -> None:
    code = (
        "from harness import registry;"
        f"model = registry.controller('lq_regulator')(model='{MODEL}', Q=(1.0, 1.0), R=(1.0,));"
        "print(registry.controller('controllers:law').__module__, model.block(0.1).step.__module__,"
        f"registry.controller('{OURS}:PID').__module__)"
    )
    done = run("-c", code)
    assert done.stdout.split() == ["controllers", "controllers.state_space.lq_regulator", OURS]


def test_own_code_that_cannot_see_ours_is_one_sentence(folder: Path) -> None:
    (folder / "mine.py").write_text("from controllers.core.block import Block\n")
    done = run("-m", "harness.cli.main", "build", "mine:Block", "--sample-time", "0.1")
    assert done.returncode == 2
    assert "'mine:Block' cannot be imported: No module named" in done.stderr
    assert "Traceback" not in done.stderr


def test_a_package_with_a_module_of_the_same_name_is_refused(folder: Path) -> None:
    (folder / "controllers.py").unlink()
    (folder / "controllers").mkdir()
    for name in ("__init__", "pid"):
        (folder / "controllers" / f"{name}.py").write_text("")
    done = run("-m", "harness.cli.main", "list")
    assert done.returncode == 2
    assert "both have a module pid; rename yours" in done.stderr
    assert "Traceback" not in done.stderr


def test_a_harness_of_the_user_does_not_reach_the_command(folder: Path) -> None:
    (folder / "harness.py").write_text("raise RuntimeError\n")
    assert run("-P", "-m", "harness.cli.main", "list").returncode == 0
