"""FMUs of all versions around one model with known solution, compiled once a session.

x' = u - k x, a ball that bounces, a counter with a time event every 0.25 s, echoes of all types; in
FMI 3 arrays and clocks. The co-simulation is solved exactly in C.
"""

import atexit
import math
import shutil
import subprocess
import tempfile
import zipfile
from collections.abc import Iterable
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from harness.fmi.binding.library import platform_tuple

COMPILER = shutil.which("cc")
needs_compiler = pytest.mark.skipif(COMPILER is None, reason="needs a C compiler")
SOURCES = Path(__file__).parent / "c"
G, E = 9.81, 0.7

# name, value reference, type, causality, variability, further attributes
MODEL = (
    ("x", 1, "Real", "output", "continuous", 'initial="exact" start="1" unit="K"'),
    ("der(x)", 2, "Real", "local", "continuous", 'derivative="1"'),
    ("h", 3, "Real", "output", "continuous", 'initial="exact" start="1" unit="m"'),
    ("v", 4, "Real", "output", "continuous", 'initial="exact" start="0"'),
    ("der(v)", 5, "Real", "local", "continuous", 'derivative="4"'),
    ("der(h)", 4, "Real", "local", "continuous", 'derivative="3"'),
    ("k", 6, "Real", "parameter", "tunable", 'start="1"'),
    ("u", 7, "Real", "input", "continuous", 'start="0"'),
    ("e", 8, "Real", "parameter", "fixed", 'start="0.7"'),
    ("end", 11, "Real", "parameter", "fixed", 'start="1e300"'),
    ("counter", 9, "Integer", "output", "discrete", ""),
    ("completed", 10, "Integer", "local", "discrete", ""),
)
ECHO_2 = (
    ("i_in", 12, "Integer", "input", "discrete", 'start="0"'),
    ("i_out", 13, "Integer", "output", "discrete", ""),
    ("b_in", 14, "Boolean", "input", "discrete", 'start="false"'),
    ("b_out", 15, "Boolean", "output", "discrete", ""),
    ("s_in", 16, "String", "input", "discrete", 'start=""'),
    ("s_out", 17, "String", "output", "discrete", ""),
    ("o_in", 18, "Enumeration", "input", "discrete", 'start="1" declaredType="Option"'),
    ("o_out", 19, "Enumeration", "output", "discrete", 'declaredType="Option"'),
)
TYPES_3 = (
    "Float32", "Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64",
    "Boolean", "String", "Binary", "Enumeration",
)  # fmt: skip
_UNITS = """<UnitDefinitions>
  <Unit name="K"><BaseUnit K="1"/><DisplayUnit name="degC" offset="-273.15"/></Unit>
  <Unit name="m"><BaseUnit m="1"/><DisplayUnit name="ft" factor="3.280839895013123"/></Unit>
</UnitDefinitions>"""


def _fmi1(kind: str) -> str:
    lines = []
    for name, reference, type_, causality, variability, more in MODEL:
        role = {"local": "internal", "parameter": "internal"}.get(causality, causality)
        kept = " ".join(a for a in more.split() if not a.startswith(("initial", "deriv", "unit")))
        change = "parameter" if causality == "parameter" else variability
        lines.append(_scalar(name, reference, type_, role, change, kept))
    lines.append(
        '<ScalarVariable name="minus_h" valueReference="3" variability="continuous" '
        'causality="output" alias="negatedAlias"><Real/></ScalarVariable>'
    )
    for i, (type_, start) in enumerate((("Integer", "0"), ("Boolean", "false"), ("String", ""))):
        letter, extra = type_[0].lower(), f'start="{start}"'
        lines.append(_scalar(f"{letter}_in", 12 + i, type_, "input", "discrete", extra))
        lines.append(_scalar(f"{letter}_out", 12 + i, type_, "output", "discrete", "", "alias"))
    tail = "" if kind == "model" else (
        '<Implementation><CoSimulation_StandAlone><Capabilities '
        'canHandleVariableCommunicationStepSize="true" canHandleEvents="true"/>'
        "</CoSimulation_StandAlone></Implementation>"
    )  # fmt: skip
    return f"""<fmiModelDescription fmiVersion="1.0" modelName="test" modelIdentifier="test"
  guid="{{1}}" numberOfContinuousStates="3" numberOfEventIndicators="1"><ModelVariables>
  {_join(lines)}</ModelVariables>{tail}</fmiModelDescription>"""


def _scalar(
    name: str, reference: int, type_: str, causality: str, variability: str, more: str,
    alias: str = "",
) -> str:  # fmt: skip
    alias = f' alias="{alias}"' if alias else ""
    return (
        f'<ScalarVariable name="{name}" valueReference="{reference}" causality="{causality}" '
        f'variability="{variability}"{alias}><{type_} {more}/></ScalarVariable>'
    )


def _fmi2() -> str:
    rows = [*MODEL, *ECHO_2]
    index = {name: i for i, (name, *_) in enumerate(rows, start=1)}
    lines = []
    for name, reference, type_, causality, variability, more in rows:
        initial = ' initial="exact"' if 'initial="exact"' in more else ""
        kept = more.replace('initial="exact"', "")
        for target, number in (("x", 1), ("v", 4), ("h", 3)):
            kept = kept.replace(f'derivative="{number}"', f'derivative="{index[target]}"')
        line = _scalar(name, reference, type_, causality, variability, kept)
        lines.append(line.replace("><", f"{initial}><", 1))
    unknowns = "".join(f'<Unknown index="{index[r[0]]}"/>' for r in rows if r[3] == "output")
    rates = "".join(f'<Unknown index="{index[n]}"/>' for n in ("der(x)", "der(h)", "der(v)"))
    calculated = [r[0] for r in rows if r[3] in ("output", "local") and "exact" not in r[5]]
    initial = "".join(f'<Unknown index="{i}"/>' for i in sorted(index[n] for n in calculated))
    return f"""<fmiModelDescription fmiVersion="2.0" modelName="test" guid="{{2}}"
  numberOfEventIndicators="1"><ModelExchange modelIdentifier="test"/>
  <CoSimulation modelIdentifier="test" canHandleVariableCommunicationStepSize="true"/>{_UNITS}
  <TypeDefinitions><SimpleType name="Option"><Enumeration><Item name="low" value="1"/>
  <Item name="high" value="7"/></Enumeration></SimpleType></TypeDefinitions>
  <ModelVariables>{_join(lines)}</ModelVariables><ModelStructure><Outputs>{unknowns}</Outputs>
  <Derivatives>{rates}</Derivatives><InitialUnknowns>{initial}</InitialUnknowns></ModelStructure>
  </fmiModelDescription>"""


def _fmi3() -> str:
    lines = ['<Float64 name="time" valueReference="0" causality="independent"/>']
    for name, reference, type_, causality, variability, more in MODEL:
        if name == "der(h)":  # v itself; a value reference is used once in FMI 3
            continue
        kind = {"Real": "Float64", "Integer": "Int32"}[type_]
        more = more + ' derivative="3"' if name == "v" else more
        lines.append(_three(kind, name, reference, causality, variability, more))
    lines.append(_three("UInt64", "n", 20, "structuralParameter", "fixed", 'start="3"'))
    size, two = '<Dimension valueReference="20"/>', '<Dimension start="2"/>'
    for name, reference, causality, start, inner in (
        ("w", 21, "input", 'start="1 2 3"', size), ("doubled", 22, "output", "", size),
        ("table", 23, "output", "", size + two),
    ):  # fmt: skip
        lines.append(_three("Float64", name, reference, causality, "continuous", start, inner))
    for name, reference, causality, more in (
        ("tick", 30, "input", 'intervalVariability="constant" intervalCounter="1" resolution="10"'),
        ("down", 31, "input", 'intervalVariability="countdown"'),
        ("user", 32, "input", 'intervalVariability="triggered"'),
        ("even", 33, "output", 'intervalVariability="triggered"'),
        ("changing", 37, "input", 'intervalVariability="changing"'),
    ):
        lines.append(
            f'<Clock name="{name}" valueReference="{reference}" causality="{causality}" {more}/>'
        )
    for name, reference, clock in (("ticks", 34, 30), ("downs", 35, 31), ("users", 36, 32),
                                   ("changes", 38, 37)):  # fmt: skip
        lines.append(_three("Int32", name, reference, "output", "discrete", f'clocks="{clock}"'))
    for i, type_ in enumerate(TYPES_3):
        start = {"Boolean": "false", "Enumeration": "1"}.get(type_, "0")
        text = {"String": "", "Binary": "00"}.get(type_)
        inner = "" if text is None else f'<Start value="{text}"/>'
        more = "" if text is not None else f'start="{start}"'
        declared = ' declaredType="Option"' if type_ == "Enumeration" else ""
        kind = "continuous" if type_ == "Float32" else "discrete"
        lines.append(
            _three(type_, f"{type_}_in", 40 + 2 * i, "input", kind, more + declared, inner)
        )
        lines.append(_three(type_, f"{type_}_out", 41 + 2 * i, "output", kind, declared))
    outputs = [1, 3, 4, 9, 22, 23, 33, 34, 35, 36, 38, *(41 + 2 * i for i in range(len(TYPES_3)))]
    structure = "".join(f'<Output valueReference="{r}"/>' for r in outputs)
    structure += "".join(f'<ContinuousStateDerivative valueReference="{r}"/>' for r in (2, 4, 5))
    unknown = [r for r in (2, 5, 9, 10, *outputs[4:]) if r not in (33, 34, 35, 36, 38)]
    structure += "".join(f'<InitialUnknown valueReference="{r}"/>' for r in unknown)
    structure += '<EventIndicator valueReference="3"/>'
    return f"""<fmiModelDescription fmiVersion="3.0" modelName="test" instantiationToken="{{3}}">
  <ModelExchange modelIdentifier="test" needsCompletedIntegratorStep="true"/>
  <CoSimulation modelIdentifier="test" hasEventMode="true"
  canHandleVariableCommunicationStepSize="true" mightReturnEarlyFromDoStep="true"/>{_UNITS}
  <TypeDefinitions><EnumerationType name="Option"><Item name="low" value="1"/>
  <Item name="high" value="7"/></EnumerationType></TypeDefinitions>
  <ModelVariables>{_join(lines)}</ModelVariables><ModelStructure>{structure}</ModelStructure>
  </fmiModelDescription>"""


def _three(
    type_: str, name: str, reference: int, causality: str, variability: str, more: str = "",
    inner: str = "",
) -> str:  # fmt: skip
    return (
        f'<{type_} name="{name}" valueReference="{reference}" causality="{causality}" '
        f'variability="{variability}" {more}>{inner}</{type_}>'
    )


def _join(lines: Iterable[str]) -> str:
    return "\n  ".join(lines)


@cache
def _folder() -> Path:
    folder = Path(tempfile.mkdtemp(prefix="test-fmus-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


@cache
def model_fmu(kind: str) -> Path:
    """The FMU of a kind: "1-slave", "1-model", "2", "3"."""
    texts = {"1-slave": _fmi1("slave"), "1-model": _fmi1("model"), "2": _fmi2(), "3": _fmi3()}
    flags = ["-DSLAVE"] if kind == "1-slave" else []
    return packed(kind, texts[kind], SOURCES / f"fmi{kind[0]}.c", flags)


@cache
def misbehaving_fmu(action: str, place: str = "CRASH") -> Path:
    """The FMU of FMI 2 that does `action` (C) in a `place`: CRASH, the step that would pass 0.55 s;
    SPOIL, the end of each step of *m; CRASH_RATES, the 51st evaluation of its derivatives; TELL,
    the end of each iteration of its events, which says *i; STEPPED, the end of each completed
    integrator step of *p, which says *event and *terminate."""
    flags = [f"-D{place}={action}", "-include", "stdlib.h", "-include", "unistd.h"]
    return packed(f"2-{abs(hash((action, place)))}", _fmi2(), SOURCES / "fmi2.c", flags)


def compiled(source: Path, library: Path, flags: Iterable[str] = ()) -> Path:
    command = [str(COMPILER), "-shared", "-fPIC", "-w", "-O1", str(source), "-o", str(library)]
    subprocess.run([*command, *flags, "-lm"], check=True, cwd=library.parent)
    return library


def packed(name: str, description: str, source: Path, flags: Iterable[str] = ()) -> Path:
    library = compiled(source, _folder() / f"{name}.so", flags)
    path = _folder() / f"test-{name}.fmu"
    platform = platform_tuple() if name[0] == "3" else "linux64"
    head = '<?xml version="1.0" encoding="UTF-8"?>\n'
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", head + description)
        archive.write(library, f"binaries/{platform}/test.so")
    return path


def ball(time: np.ndarray) -> np.ndarray:
    """The height of the ball at times that are no bounces, by the parabolas between them."""
    start, speed, found = 0.0, 0.0, np.empty(len(time))
    height = 1.0
    for i in np.argsort(time, kind="stable"):
        while True:
            flight = (speed + math.sqrt(speed**2 + 2 * G * height)) / G
            if time[i] <= start + flight:
                break
            speed, height, start = E * (G * flight - speed), 0.0, start + flight
        t = time[i] - start
        found[i] = height + speed * t - 0.5 * G * t * t
    return found


def bounces(until: float) -> list[float]:
    """The times at which the ball touches the ground."""
    times = [math.sqrt(2.0 / G)]
    speed = E * math.sqrt(2.0 * G)
    while times[-1] + 2.0 * speed / G < until:
        times.append(times[-1] + 2.0 * speed / G)
        speed *= E
    return times
