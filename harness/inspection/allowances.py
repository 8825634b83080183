"""What the findings about an FMU mean for its use here: each use with what it demands.

The demands are those of the planner, the master and the checkpoints, besides what the uses need
to be right: a claim that the examination refuted counts as no claim. This module examines nothing.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from harness.fmi.binding.instance import CO_SIMULATION, MODEL_EXCHANGE
from harness.fmi.description.model_description import ModelDescription
from harness.inspection import catalogue as c
from harness.inspection.finding import Finding, Verdict
from harness.system.policy import remembers_states_only


@dataclass(frozen=True)
class Allowance:
    """Whether one way of using the FMU here is safe, and why not where it is not."""

    use: str
    allowed: bool
    reason: str


@dataclass(frozen=True)
class _Use:
    """`needs` must have passed; `sound` must not have failed, though it may not apply; it is
    `refused` for a reason that no check is needed for."""

    name: str
    needs: tuple[str, ...]
    sound: tuple[str, ...] = ()
    refused: str = ""


_ALONE: dict[str, _Use] = {
    CO_SIMULATION: _Use("simulate, co-simulation", (c.RUNS,)),
    MODEL_EXCHANGE: _Use(
        "simulate, model exchange", (c.RUNS,), (c.ROUND_TRIP, c.NOMINALS, c.INDICATORS)
    ),
}


def _in_loop(d: ModelDescription, kind: str) -> tuple[_Use, ...]:
    exchange = kind == MODEL_EXCHANGE
    unstored = "the solver cannot be stored" * exchange
    returns = () if exchange and remembers_states_only(d) else (c.RESTORES,)
    stateless = "" if d.states else "the FMU names no continuous states"
    return (
        _Use("jacobi and gauss-seidel", (c.RUNS,), (c.FEEDTHROUGH,)),
        _Use("linear wires (extrapolation = 1)", (c.RUNS,), (c.FEEDTHROUGH, c.INTERPOLATES)),
        _Use("iterative", (c.RUNS, *returns), (c.FEEDTHROUGH, c.INTERPOLATES)),
        _Use("algebraic loops solved", (c.RUNS,), (c.FEEDTHROUGH,)),
        _Use("delays within a step", (c.RUNS,) if exchange else (c.RUNS, c.OTHER_STEPS)),
        _Use("several instances in one run", (c.RUNS,), (c.TWICE,)),
        _Use("studies in one process", (c.RUNS, c.TWICE, c.REPEATS, c.SURVIVES)),
        _Use("resume", (c.RUNS, c.CONTINUES_ELSEWHERE), refused=unstored),
        _Use("sensitivity", (c.RUNS, c.DERIVATIVES), refused=stateless),
    )


def allowances(d: ModelDescription, findings: tuple[Finding, ...]) -> tuple[Allowance, ...]:
    """The uses, first that of the FMU alone, then those in the loop."""
    by_kind: dict[str, dict[str, Finding]] = {}
    for finding in findings:
        by_kind.setdefault(finding.interface_type, {})[finding.check] = finding
    alone = [_judged(_ALONE[kind], found) for kind, found in by_kind.items()]
    kind = next((k for k in (CO_SIMULATION, MODEL_EXCHANGE) if k in by_kind), "")
    in_loop = _in_loop(d, kind) if kind else ()
    return (*alone, *(_judged(use, by_kind[kind]) for use in in_loop))


def _judged(use: _Use, found: Mapping[str, Finding]) -> Allowance:
    if use.refused:
        return Allowance(use.name, False, use.refused)
    for name in (*use.needs, *use.sound):
        finding = found.get(name)
        first = found.get(c.SERIALISES)
        if finding is None and name == c.CONTINUES_ELSEWHERE and first is not None:
            finding = None if first.verdict is Verdict.PASSED else first
        if finding is None:
            if name in use.needs:
                return Allowance(use.name, False, f"{name}: not examined")
            continue
        failed = finding.verdict is Verdict.FAILED
        if failed or (name in use.needs and finding.verdict is not Verdict.PASSED):
            return Allowance(use.name, False, f"{finding.check}: {finding.detail}")
    return Allowance(use.name, True, "")
