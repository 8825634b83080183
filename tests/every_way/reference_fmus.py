"""The public Reference FMUs as cases: those below the given folders, in every kind of theirs."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from tests.every_way.cases import Case
from tests.every_way.descriptions import KINDS, Model, Variable
from tests.every_way.plain_events import SECOND
from tests.every_way.plain_fmu import read_root, read_variables

TIMES = {
    "BouncingBall": (3.0, 0.01), "Clocks": (9.0, 1.0), "Dahlquist": (10.0, 0.1),
    "Feedthrough": (2.0, 0.1), "Resource": (1.0, 1.0), "Roberts": (0.4, 0.01), "Stair": (8.8, 0.2),
    "StateSpace": (10.0, 1.0), "VanDerPol": (20.0, 0.01),
}  # fmt: skip
"""Stop time and step (s); Stair ends the simulation at 9 s."""
TEXTS = ("String", "Binary")


def reference_cases(folders: Sequence[Path]) -> Iterator[Case]:
    """In order of name, version, kind and mode."""
    for path in sorted(path for folder in folders for path in folder.rglob("*.fmu")):
        if path.stem in TIMES:
            yield from _cases(path)


def _cases(path: Path) -> Iterator[Case]:
    root = read_root(path)
    version = int(root.get("fmiVersion", "0")[0])
    kinds = [kind for kind, tag in KINDS.items() if root.find(tag) is not None]
    if version == 1:
        kinds = [["model-exchange", "co-simulation"][root.find("Implementation") is not None]]
    interface = root.find("CoSimulation")
    has_events = interface is not None and interface.get("hasEventMode") == "true"
    outputs = tuple(
        Variable(name, v.reference, v.type, "output",
                 dimensions=tuple(3 if isinstance(size, str) else size for size in v.sizes))
        for name, v in read_variables(root).items()
        if v.causality == "output" and v.type != "Clock"
    )  # fmt: skip
    for title in ("", "-texts"):
        watched = [v.name for v in outputs if (v.type in TEXTS) == bool(title)]
        for kind in kinds if watched else ():
            if path.stem == "Roberts" and kind == "co-simulation":
                continue  # 10^4 steps inside, one more by the last bit of the communication step
            for events in (None, True) if kind == "co-simulation" and has_events else (None,):
                yield _case(path, outputs, version, kind, events, watched, title)


def _case(
    path: Path, outputs: tuple[Variable, ...], version: int, kind: str, events: bool | None,
    watched: list[str], title: str,
) -> Case:  # fmt: skip
    stop, step = TIMES[path.stem]
    name = f"{path.stem}{title}-fmi{version}-{kind}{'-events' if events else ''}"
    clocks = path.stem == "Clocks"
    triggers = {"inClock2": tuple(t * SECOND for t in (0, 1, 8, 9))} if clocks else {}
    return Case(
        name, Model(path.stem, outputs, stop=stop), version, kind, tuple(watched),
        event_mode=events,
        triggers=triggers, path=path, step_ns=round(step * SECOND),
        tolerance=1e-10 if kind == "model-exchange" else None, accuracy=1e-5,
    )  # fmt: skip
