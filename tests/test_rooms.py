"""The arrows between the rooms point one way, as ARCHITECTURE.md draws them."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
ROOMS = ("fmus", "harness", "controllers", "experiments", "tests", "benchmarks")
FLOORS = (
    "harness.errors",
    "harness.clock",
    "harness.registry",
    "harness.system.block",
    "harness.system.units",
    "harness.instruments",
    "harness.fmi",
    "harness.results",
    "harness.system",
    "harness.compiler",
    "harness.participants",
    "harness.master",
    "harness.process",
    "harness.simulation",
    "harness.inspection",
    "harness.bench",
    "harness.experiment",
    "harness.export",
    "harness.ssp",
    "harness.cli",
)


def imported(path: Path) -> set[str]:
    """Modules that a file imports when it runs; what only a type checker sees does not count."""
    found = set()
    tree = ast.parse(path.read_text(encoding="utf-8"))
    checked = [
        node
        for node in ast.walk(tree)
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test)
    ]
    hidden = {id(inner) for node in checked for inner in ast.walk(node)}
    for node in ast.walk(tree):
        if id(node) in hidden:
            continue
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found |= {node.module} | {f"{node.module}.{alias.name}" for alias in node.names}
    return found


def modules(room: str) -> list[Path]:
    return sorted((ROOT / room).rglob("*.py"))


@pytest.mark.parametrize("room", ["fmus", "controllers", "harness"])
def test_a_room_imports_no_other_room(room: str) -> None:
    others = set(ROOMS) - {room}
    for path in modules(room):
        reached = {name.partition(".")[0] for name in imported(path)}
        assert not reached & others, f"{path.relative_to(ROOT)} imports {reached & others}"


@pytest.mark.parametrize("room", ["fmus", "controllers"])
def test_plants_and_controllers_do_not_need_the_compiler_of_the_loop(room: str) -> None:
    for path in modules(room):
        reached = {name.partition(".")[0] for name in imported(path)}
        makes_objects = path.relative_to(ROOT).as_posix() == "fmus/packaging/blocks/objects.py"
        forbidden = {"numba", "fmpy"} if makes_objects else {"numba", "llvmlite", "fmpy"}
        assert not reached & forbidden, path.relative_to(ROOT)


def floor(module: str) -> int | None:
    """The highest entry of FLOORS to which a module belongs."""
    known = [
        (len(name), i)
        for i, name in enumerate(FLOORS)
        if module == name or module.startswith(name + ".")
    ]
    return max(known)[1] if known else None


@pytest.mark.parametrize("path", modules("harness"), ids=lambda p: str(p.relative_to(ROOT)))
def test_inside_the_harness_imports_go_down(path: Path) -> None:
    name = ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
    own = floor(name)
    if own is None:
        return
    for module in imported(path):
        other = floor(module)
        assert other is None or other <= own, f"{name} imports {module}, which is above it"
