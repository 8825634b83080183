"""What the drivers of tools that are programs share: inputs and results as files of values."""

from __future__ import annotations

import csv
import os
import subprocess
import sys
import sysconfig
import tempfile
import zipfile
from collections.abc import Callable, Sequence
from pathlib import Path

from tests.peers.order import Order

Table = list[tuple[float, list[float]]]
"""Instants (s), each with a row of values."""


def rows_by(
    program: Callable[[str, Path, Path], Sequence[str]], order: Order, table: Table
) -> list[list[float]]:
    """The rows at the ends of the steps of a program that is started with the arguments which
    `program` makes of the path of the FMU and those of the input and the result file."""
    ((name, path),) = order.fmus.items()
    with tempfile.TemporaryDirectory() as folder:
        given, found = Path(folder, "in.csv"), Path(folder, "out.csv")
        with given.open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(["time", *(port.removeprefix(f"{name}.") for port in order.inputs)])
            writer.writerows([repr(time), *map(repr, row)] for time, row in table)
        done = subprocess.run(
            [order.program, *program(path, given, found)],
            capture_output=True, text=True, errors="replace", timeout=100, check=False,
            env=environment(path),
        )  # fmt: skip
        said = (done.stdout + done.stderr).strip().partition("\n")[0]
        if done.returncode or not found.is_file():
            raise SystemExit(said or f"ended with {done.returncode}")
        with found.open(encoding="utf-8", newline="") as file:
            head, *lines = csv.reader(file)
    columns = [head.index(port.removeprefix(f"{name}.")) for port in order.outputs]
    rows = [(float(line[0]), [float(line[c]) for c in columns]) for line in lines]
    return _at_the_ends(order, rows, said)


def environment(path: str) -> dict[str, str]:
    """What a program that is not Python's needs for the FMU at `path`: for a portable one what its
    `documentation/externalDependencies.txt` asks for."""
    with zipfile.ZipFile(path) as archive:
        portable = "resources/slavemodule.txt" in archive.namelist()
    if not portable:
        return dict(os.environ)
    library = Path(sysconfig.get_config_var("LIBDIR"), sysconfig.get_config_var("INSTSONAME"))
    return {**os.environ, "LD_PRELOAD": str(library), "PYTHONHOME": sys.base_prefix}


def _at_the_ends(order: Order, rows: Table, said: str) -> list[list[float]]:
    """The rows at the ends of the steps, of a tool that writes others, too; one that adds up steps
    of its own may be one of them late."""
    found: dict[int, list[float]] = {}
    for time, row in rows:
        k = round(time / order.step)
        if abs(time - k * order.step) < 1e-3 * order.step:
            found[k] = row
    missing = order.steps - len(found.keys() - {0})
    if missing:
        raise SystemExit(said if not found else f"{missing} of {order.steps} rows are missing")
    return [found[k] for k in range(1, order.steps + 1)]
