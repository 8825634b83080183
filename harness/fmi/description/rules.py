"""The sentences of the standard that descriptions break, by section, in few words."""

from __future__ import annotations

from collections.abc import Mapping

_RULES: Mapping[str, tuple[str, str]] = {  # of FMI 2.0.5 and of FMI 3.0.2
    "unique name": (
        "2.2.7: every variable is uniquely identified within an FMU instance by its name",
        "2.4: names of list elements must be unique within that list",
    ),
    "unique reference": ("", "2.4.7.4: the valueReference must be unique for all variables"),
    "start needed": (
        '2.2.7: if initial is "exact" or "approx", or causality "input", a start value must be '
        "provided",
        '2.4.7.5: if initial is "exact" or "approx", or causality "input", a start attribute must '
        "be provided",
    ),
    "start forbidden": (
        '2.2.7: if initial is "calculated" or causality "independent", it is not allowed to '
        "provide a start value",
        '2.4.7.5: for "calculated" variables a start attribute must not be provided',
    ),
    "continuous": (
        '2.2.7: only a variable of type Real can be "continuous"',
        '2.4.7.4: only variables of type Float32 or Float64 may be "continuous"',
    ),
    "combination": (
        "2.2.7: table of the combinations of variability and causality that are allowed",
        "2.4.7.4: table of the combinations of variability and causality that are allowed",
    ),
    "unit": (
        "2.2.7: the unit is defined with UnitDefinitions.Unit.name",
        "2.4.7.5: the unit refers to a Unit with the same name, which must exist",
    ),
    "display unit": (
        "2.2.7: a displayUnit that is not defined under its Unit is ignored",
        "2.4.7.5: the displayUnit refers to a DisplayUnit of its Unit, which must exist",
    ),
    "independent": ("", "2.4.7.4: exactly one variable must be defined as independent"),
    "outputs": (
        '2.2.8: every variable with causality "output" must be listed in Outputs, and no other',
        '2.4.8: every variable with causality "output" must be listed as Output, and no other',
    ),
    "derivatives": (
        "2.2.8: the states are defined by the attribute derivative of the state derivatives",
        "2.4.8: the states are defined by the attribute derivative of the state derivatives",
    ),
    "initial unknowns": (
        '2.2.8: InitialUnknowns lists the outputs with initial "approx" or "calculated", the '
        "calculated parameters, and such states and derivatives",
        '2.4.8: InitialUnknown lists the unclocked outputs with initial "approx" or '
        '"calculated", the calculated parameters, and such states and derivatives',
    ),
    "dependencies kind": (
        "2.2.8: with dependenciesKind, dependencies must be present and as many",
        "2.4.8: with dependenciesKind, dependencies must be present and as many",
    ),
    "names": (
        "2.2.9: the grammar of the variableNamingConvention",
        "2.4.7.5.1: the grammar of the variableNamingConvention",
    ),
}


def rule(key: str, fmi_major: int) -> str:
    """The sentence as a citation, "" where that version of FMI has none."""
    text = _RULES[key][fmi_major - 2] if fmi_major > 1 else ""
    return f"FMI {fmi_major}.0, {text}" if text else ""
