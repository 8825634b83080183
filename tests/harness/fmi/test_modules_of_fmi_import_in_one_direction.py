"""No two modules of `harness/fmi` need one another, not even for their types."""

import ast
from pathlib import Path

import networkx as nx

ROOT = Path(__file__).parents[3]


def test_there_is_no_circle() -> None:
    graph = nx.DiGraph()
    for path in (ROOT / "harness" / "fmi").rglob("*.py"):
        name = ".".join(path.relative_to(ROOT).with_suffix("").parts)
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("harness.fmi"):
                graph.add_edge(name, node.module)
    assert len(graph) > 10
    assert list(nx.simple_cycles(graph)) == []
