"""A model description made of variables only."""

from __future__ import annotations

from harness.fmi.description.model_description import ModelDescription, Variable


def described(*variables: Variable) -> ModelDescription:
    """The description of an FMI 3 FMU with these variables and nothing else."""
    named = {v.name: v for v in variables}
    return ModelDescription(
        "made", "3.0", "", "", "", None, None, named, {}, {}, (), None, None, None, None
    )
