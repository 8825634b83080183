"""The page of documentation inside a block's FMU: equations, timing, variables, certificate."""

from __future__ import annotations

from collections.abc import Iterable

from fmus.packaging.block.description import timing
from fmus.packaging.block.interface import BlockModel, BlockVariable
from fmus.packaging.documentation import Page, Row, documents

_CERTIFICATE = (
    "extra/fmu-harness.parity/certificate.json, where it is there, holds inputs and the outputs "
    "that the same step gave in the process that made this FMU; `fmu-harness verify FILE` replays "
    "them on any machine."
)


def block_page(model: BlockModel) -> Page:
    """What the block computes and when, and tables of its variables."""
    head = ("name", "unit", "start", "description")
    tunable = tuple(v for v in model.parameters if v.tunable)
    fixed = tuple(v for v in model.parameters if not v.tunable)
    return Page(
        f"{model.name} {model.version}",
        (model.description, timing(model), _CERTIFICATE),
        model.equations,
        (
            ("Inputs", head, _rows(model.inputs)),
            ("Outputs", head, _rows(model.outputs)),
            ("Parameters that may be tuned", head, _rows(tunable)),
            ("Parameters that are part of the design", head, _rows(fixed)),
            ("States", head, _rows(model.states)),
        ),
    )


def block_documents(
    model: BlockModel, fmi_version: int, needs: Iterable[str] | None = None
) -> dict[str, bytes]:
    """Page, licence, icon and what else lies in the FMU for people, by path in the archive."""
    names = [[v.name for v in group] for group in (model.inputs, model.outputs)]
    return documents(block_page(model), fmi_version, *names, needs=needs)


def _rows(variables: Iterable[BlockVariable]) -> tuple[Row, ...]:
    return tuple((v.name, v.unit, f"{v.start:g}", v.description) for v in variables)
