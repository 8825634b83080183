"""The arrows between rooms and between modules point one way, as ARCHITECTURE.md draws them."""

import ast
from pathlib import Path

import networkx as nx
import pytest

ROOT = Path(__file__).parents[1]
ROOMS = ("fmus", "harness", "controllers", "experiments", "tests", "benchmarks")
FLOORS = (
    "harness.errors",
    "harness.siblings",
    "harness.clock",
    "harness.interrupts",
    "harness.display",
    "harness.construction",
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
FAMILIES = ("core", "signals", "pid", "fuzzy", "kalman", "state_space", "identification", "papers")


def is_module(name: str) -> bool:
    place = ROOT.joinpath(*name.split("."))
    return place.is_dir() or place.with_suffix(".py").is_file()


def imported(path: Path, *, typed: bool = False) -> set[str]:
    """Modules that a file imports when it runs, in functions too; with `typed` also those that
    only a type checker sees."""
    found = set()
    tree = ast.parse(path.read_text(encoding="utf-8"))
    checked = [
        node
        for node in ast.walk(tree)
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test) and not typed
    ]
    hidden = {id(inner) for node in checked for inner in ast.walk(node)}
    for node in ast.walk(tree):
        if id(node) in hidden:
            continue
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            inside = {f"{node.module}.{alias.name}" for alias in node.names}
            found |= {name if is_module(name) else node.module for name in inside}
    return found


def modules(room: str) -> list[Path]:
    return sorted((ROOT / room).rglob("*.py"))


def dotted(path: Path) -> str:
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


def circles(room: str) -> set[frozenset[str]]:
    """Groups of modules each of which reaches every other one by imports."""
    files = {dotted(path): path for path in modules(room)}
    graph = nx.DiGraph(
        (name, other)
        for name, path in files.items()
        for other in imported(path, typed=True) & files.keys() - {name}
    )
    return {frozenset(group) for group in nx.strongly_connected_components(graph) if len(group) > 1}


@pytest.mark.parametrize("room", ["fmus", "controllers", "harness"])
def test_no_two_modules_need_each_other(room: str) -> None:
    """Imports for the type checker count: who reads one of two such modules must read both."""
    assert circles(room) == set()


def test_fmus_of_plants_and_of_blocks_do_not_know_each_other() -> None:
    for room, other in (("plant", "block"), ("block", "plant")):
        for path in (ROOT / "fmus/packaging" / room).rglob("*.py"):
            reached = imported(path, typed=True)
            assert not [m for m in reached if m.startswith(f"fmus.packaging.{other}")], path


@pytest.mark.parametrize("path", modules("controllers"), ids=dotted)
def test_among_controllers_imports_go_down_and_papers_stand_alone(path: Path) -> None:
    own = dotted(path).split(".")
    for other in (m.split(".") for m in imported(path, typed=True)):
        if len(own) > 2 and len(other) > 2 and other[0] == "controllers":
            assert FAMILIES.index(other[1]) <= FAMILIES.index(own[1]), f"{path} imports {other}"
            assert own[1] != "papers" or other[1] != "papers" or other[2] == own[2], f"{other}"


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
        makes_objects = path.relative_to(ROOT).as_posix() == "fmus/packaging/block/objects.py"
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


@pytest.mark.parametrize("path", modules("harness"), ids=dotted)
def test_inside_the_harness_imports_go_down(path: Path) -> None:
    name = dotted(path)
    own = floor(name)
    if own is None:
        return
    for module in imported(path):
        other = floor(module)
        assert other is None or other <= own, f"{name} imports {module}, which is above it"
