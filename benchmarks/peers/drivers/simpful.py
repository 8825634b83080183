"""Simpful: a Sugeno system of zeroth order, rules as text."""

from typing import Any

from simpful import FuzzySystem, LinguisticVariable, TriangleFuzzySet

from benchmarks.peers.task import OfRow, carry_out_rows


def prepare(model: dict[str, Any]) -> OfRow:
    system = FuzzySystem(show_banner=False, verbose=False)
    for name in ("a", "b"):
        sets = [
            TriangleFuzzySet(c - model["width"], c, c + model["width"], term=f"s{i}")
            for i, c in enumerate(model["centres"])
        ]
        system.add_linguistic_variable(
            name, LinguisticVariable(sets, universe_of_discourse=[-1.0, 2.0])
        )
    for i, weight in enumerate(model["weights"]):
        system.set_crisp_output_value(f"w{i}", weight)
    system.add_rules([
        f"IF (a IS s{i}) AND (b IS s{j}) THEN (u IS w{weight})"
        for i, row in enumerate(model["table"])
        for j, weight in enumerate(row)
    ])  # fmt: skip

    def compute(row: list[float]) -> list[float]:
        system.set_variable("a", row[0])
        system.set_variable("b", row[1])
        return [float(system.Sugeno_inference(["u"])["u"])]

    return compute


carry_out_rows(prepare)
