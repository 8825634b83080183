"""The FMUs of these tests: their variables, as the sources in `c/` have them, and their files."""

import atexit
import shutil
import subprocess
import tempfile
import zipfile
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

from tests.every_way.descriptions import Alias, Model, Variable, fmi1, fmi2, fmi3

COMPILER = shutil.which("cc")
needs_compiler = pytest.mark.skipif(COMPILER is None, reason="needs a C compiler")
SOURCES = Path(__file__).parent / "c"
TYPES = (
    "Float64", "Float32", "Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64",
    "Boolean", "String", "Binary", "Enumeration",
)  # fmt: skip
STARTS = {"Boolean": "false", "String": "", "Binary": "00", "Enumeration": "1"}

BALL = Model(
    "ball",
    (
        Variable("h", 1, start="1", aliases=(Alias("height"), Alias("minus_h", negated=True))),
        Variable("v", 2, start="0", derivative_of="h", aliases=(
            Alias("speed"), Alias("fall", negated=True),
            Alias("der(h)", causality="local", derivative_of="h"),
        )),
        Variable("der(v)", 3, causality="local", derivative_of="v", aliases=(Alias("a"),)),
        Variable("u", 4, causality="input", start="0", aliases=(Alias("u_seen"),)),
        Variable("e", 5, causality="parameter", start="0.7"),
        Variable("bounces", 6, "Int32", aliases=(Alias("bounces_too"),)),
        Variable("falling", 7, "Boolean", aliases=(Alias("falling_too"), Alias("rising", True))),
    ),
    indicators=("h",), event_mode=True,
)  # fmt: skip

THERMOSTAT = Model(
    "thermostat",
    (
        Variable("T", 1, start="20"),
        Variable("der(T)", 2, causality="local", derivative_of="T"),
        Variable("x", 3, start="1"),
        Variable("der(x)", 4, causality="local", derivative_of="x"),
        Variable("z", 5, causality="local"),
        Variable("ambient", 6, causality="input", start="5"),
        Variable("heater", 7, "Boolean", aliases=(Alias("on"),)),
        Variable("counter", 8, "Int32"),
        Variable("chain", 9, "Int32"),
        Variable("laps", 10, "Int32"),
    ),
    indicators=("z",), event_mode=True,
)  # fmt: skip


def _echoes() -> Iterator[Variable]:
    for i, type_ in enumerate(TYPES):
        yield Variable(f"{type_}_in", 10 + 2 * i, type_, "input", STARTS.get(type_, "0"))
        yield Variable(f"{type_}_out", 11 + 2 * i, type_, aliases=(Alias(f"{type_}_again"),))


EVERY_TYPE = Model(
    "types",
    (
        Variable("steps", 1, "Int32", aliases=(Alias("steps_too"),)),
        Variable("large", 2, "Int64", aliases=(Alias("large_too"),)),
        Variable("largest", 3, "UInt64"),
        Variable("third", 4, "Float32"),
        Variable("label", 5, "String", aliases=(Alias("label_too"),)),
        Variable("bytes", 6, "Binary"),
        Variable("odd", 7, "Boolean"),
        Variable("n", 8, "UInt64", "structuralParameter", "3"),
        Variable("tolerance", 9),
        *_echoes(),
        Variable("w", 40, causality="input", start="1 2 3", dimensions=("n",)),
        Variable("doubled", 41, dimensions=("n",), aliases=(Alias("doubled_too"),)),
        Variable("table", 42, dimensions=("n", 2)),
    ),
    kinds=("co-simulation",),
)  # fmt: skip


def _clock(name: str, reference: int, causality: str = "input", **more: str) -> Variable:
    return Variable(name, reference, "Clock", causality, more=more)


def _ticks(name: str, reference: int, *clocks: int) -> Variable:
    more = {"clocks": " ".join(map(str, clocks))} if clocks else {}
    return Variable(name, reference, "Int32", more=more)


_EIGHTH = {"intervalVariability": "constant", "intervalCounter": "1", "resolution": "8"}
_QUARTER = {"intervalVariability": "constant", "intervalCounter": "1", "resolution": "4"}
CLOCKS = Model(
    "clocks",
    (
        Variable("x", 1, start="1"),
        Variable("der(x)", 2, causality="local", derivative_of="x"),
        _ticks("ticks", 3, 10), _ticks("downs", 4, 11), _ticks("users", 5, 12),
        _ticks("total", 6), _ticks("evens", 7, 13),
        _clock("tick", 10, **_EIGHTH),
        _clock("down", 11, intervalVariability="countdown"),
        _clock("user", 12, intervalVariability="triggered"),
        _clock("even", 13, "output", intervalVariability="triggered"),
    ),
    event_mode=True,
)  # fmt: skip

PARTITIONS = Model(
    "partitions",
    (
        Variable("x", 1), Variable("y", 2), _ticks("total", 3),
        Variable("u", 4, causality="input", start="1"),
        _clock("fast", 10, **_EIGHTH, priority="0"),
        _clock("slow", 11, **_QUARTER, priority="1"),
        _clock("down", 12, intervalVariability="countdown", priority="2"),
    ),
    kinds=("scheduled-execution",),
)  # fmt: skip


@cache
def folder() -> Path:
    """A folder for the whole process, removed at its end."""
    made = Path(tempfile.mkdtemp(prefix="every-way-"))
    atexit.register(shutil.rmtree, made, ignore_errors=True)
    return made


@cache
def library(name: str, version: int, *flags: str) -> Path:
    """The compiled `c/name.c` for one version of FMI."""
    made = folder() / f"{name}-{version}{'-'.join(flags)}.so"
    command = [str(COMPILER), "-std=c99", "-shared", "-fPIC", "-O1", "-w", *flags]
    command += [f'-DMODEL="{name}.c"', f"-DIDENTIFIER={name}", str(SOURCES / f"fmi{version}.c")]
    subprocess.run([*command, "-o", str(made), "-lm"], check=True)
    return made


def pack(path: Path, model: Model, version: int, text: str, *flags: str) -> Path:
    """An FMU of the description `text`, for 64 bits of an Intel machine with Linux."""
    place = "x86_64-linux" if version == 3 else "linux64"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", f'<?xml version="1.0" encoding="UTF-8"?>\n{text}')
        archive.write(library(model.name, version, *flags), f"binaries/{place}/{model.name}.so")
    return path


@cache
def _built(name: str, version: int, kind: str) -> Path:
    model = {m.name: m for m in (BALL, THERMOSTAT, EVERY_TYPE, CLOCKS, PARTITIONS)}[name]
    path = folder() / f"{name}-{version}-{kind}.fmu"
    if version == 1:
        flags = ["-DSLAVE"] * (kind == "co-simulation")
        return pack(path, model, 1, fmi1(model, kind), *flags)
    return pack(path, model, version, (fmi2 if version == 2 else fmi3)(model))


def fmu(model: Model, version: int, kind: str) -> Path:
    """The FMU of a model; those of FMI 1 have one kind of interface only."""
    return _built(model.name, version, kind if version == 1 else "all")
