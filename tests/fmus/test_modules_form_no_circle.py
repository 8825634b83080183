"""The modules that make FMUs import each other in one direction, at whatever place they do it."""

import ast
from pathlib import Path

import networkx as nx

ROOT = Path(__file__).parents[2]


def dotted(path: Path) -> str:
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


def graph() -> nx.DiGraph:
    """Module to module; `from package import name` counts for the module, where it is one."""
    sources = {dotted(path): path for path in (ROOT / "fmus").rglob("*.py")}
    found = nx.DiGraph()
    for name, path in sources.items():
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module and not node.level:
                inner = [f"{node.module}.{alias.name}" for alias in node.names]
                modules = [one for one in inner if one in sources] or [node.module]
                found.add_edges_from((name, one) for one in modules if one in sources)
    return found


def test_no_circle() -> None:
    imports = graph()
    assert imports.number_of_edges() > 50
    assert [sorted(c) for c in nx.strongly_connected_components(imports) if len(c) > 1] == []


def test_plants_and_blocks_do_not_know_each_other() -> None:
    for one, other in graph().edges:
        ends = {one.removeprefix("fmus.packaging."), other.removeprefix("fmus.packaging.")}
        rooms = {end.partition(".")[0] for end in ends}
        assert not {"plant", "block"} <= rooms, f"{one} imports {other}"
