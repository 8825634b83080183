"""`fmu-harness describe`: what a plant, controller, signal, imperfection or metric is, and how it
is wired."""

from __future__ import annotations

from typing import Annotated

import typer

from harness.cli.tables import show_table
from harness.cli.terminal import say, table


def describe_command(
    name: Annotated[
        str, typer.Argument(help="A name that `list` shows, a metric, or module:Class")
    ],
) -> None:
    """Show ports, units, parameters and an example of whatever has that name."""
    from harness.experiment.catalogue import describe

    for one in describe(name):
        article = "an" if one.kind[0] in "aeiou" else "a"
        say(f"{one.name}, {article} {one.kind}", style="bold")
        say(one.text)
        if one.ports:
            show_table(table(("port", "direction", "unit", "meaning"), one.ports))
        elif one.kind == "controller":
            say("ports: as its parameters say")
        if one.parameters:
            headings = ("parameter", "default", "unit", "meaning")
            show_table(table(headings, one.parameters))
        say(f"example:\n{one.example}\n")
