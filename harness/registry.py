"""Plants, controllers, coupling algorithms and experiments by name, found through entry points.

Whatever package declares `fmu_harness.plants`, `fmu_harness.controllers`,
`fmu_harness.algorithms` or `fmu_harness.experiments` plugs in; the harness imports none of them
by itself, and has no list of its own. What a name in the form "package.module:object" means needs
no entry point: `named` imports it.
"""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from harness.errors import FmuError, UsageError, nearest
from harness.siblings import HOME, import_beside, import_sibling, is_sibling

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

PLANTS = "fmu_harness.plants"
CONTROLLERS = "fmu_harness.controllers"
ALGORITHMS = "fmu_harness.algorithms"
EXPERIMENTS = "fmu_harness.experiments"
PACKAGERS = "fmu_harness.packagers"


class Plant(Protocol):
    """A plant that can make its own FMU."""

    @property
    def name(self) -> str:
        """Its name."""

    @property
    def description(self) -> str:
        """One line for people."""

    def fmu(
        self, fmi_version: int = 3, *, portable: bool = False, targets: Sequence[str] = ()
    ) -> Path:
        """The path of its FMU, built when it is not there yet, for platforms such as "win64"."""


@cache
def _installed() -> dict[str, dict[str, EntryPoint]]:
    """By group and name: to look through all packages takes a hundredth of a second."""
    from importlib.metadata import entry_points

    found = entry_points()
    return {group: {e.name: e for e in found.select(group=group)} for group in found.groups}


def _entries(group: str) -> dict[str, EntryPoint]:
    return _installed().get(group, {})


def names(group: str) -> list[str]:
    """The registered names of a group, sorted."""
    return sorted(_entries(group))


def plant(name: str) -> Plant:
    """The plant registered under `name`; raises `UsageError` with the nearest names."""
    loaded: Plant = _load(PLANTS, name, "plant")
    return loaded


def plant_fmu(
    name: str | Plant,
    fmi_version: int = 3,
    *,
    portable: bool = False,
    targets: Sequence[str] = (),
) -> Path:
    """The FMU of a plant, by name or itself, FMI 2 where it is `portable`, with binaries for this
    machine or for `targets`; raises `FmuError` when there is none."""
    found = plant(name) if isinstance(name, str) else name
    given = {"targets": targets} if targets else {}  # plants of others may know this machine only
    try:
        return found.fmu(fmi_version, portable=portable, **given)
    except Exception as fault:  # a plant of another package has errors of its own
        raise FmuError(f"plant {found.name} cannot be packaged as an FMU: {fault}") from fault


def controller(name: str) -> Any:
    """The controller class registered under `name`, or that of "package.module:Class"."""
    return _load(CONTROLLERS, name, "controller")


def algorithm(name: str) -> Any:
    """The algorithm registered under `name`, or that of "package.module:Class"."""
    return _load(ALGORITHMS, name, "algorithm")


def packager(name: str) -> Any:
    """What makes FMUs of blocks, under `name`; raises `UsageError` when there is none."""
    return _load(PACKAGERS, name, "packager")


def experiments() -> dict[str, Path]:
    """All experiment files by name, such as "ahn2009/figure_7"."""
    from importlib.resources import files

    found = {}
    for entry in _entries(EXPERIMENTS).values():
        root = HOME / entry.value if is_sibling(entry.value) else Path(str(files(entry.value)))
        for path in sorted(set(root.glob("*/*.toml")) - set(root.glob("*/claims.toml"))):
            found[f"{path.parent.name}/{path.stem}"] = path
    return found


def experiment(name: str) -> Path:
    """The path of an experiment given by name or as a file; raises `UsageError`."""
    path = Path(name)
    if path.suffix == ".toml" or path.is_file():
        if path.is_file():
            return path
        raise UsageError(f"experiment file {name} does not exist")
    known = experiments()
    if name not in known:
        raise UsageError(f"no experiment {name!r}; {nearest(name, known)}")
    return known[name]


def check_name(group: str, name: str, what: str) -> None:
    """Raises `UsageError` for a name that is neither registered nor that of an object in a module;
    nothing is imported."""
    known = _entries(group)
    if name not in known and ":" not in name:
        raise UsageError(
            f"no {what} {name!r}; {nearest(name, known)} (or 'package.module:object' for your own)"
        )


def _load(group: str, name: str, what: str) -> Any:
    check_name(group, name, what)
    known = _entries(group)
    if name in known:
        entry = known[name]
        own = is_sibling(entry.module)
        return getattr(import_sibling(entry.module), entry.attr) if own else entry.load()
    return named(name, what)


def search_in(folder: Path) -> None:
    """From now on `named` looks for modules in this folder first, in the working folder then, and
    last where Python finds installed ones."""
    folder = folder.resolve()
    if folder in _places:
        _places.remove(folder)
    _places.insert(0, folder)


_places: list[Path] = []


def named(name: str, what: str) -> Any:
    """The object that "package.module:object" names, `what` in errors; raises `UsageError`."""
    module, _, attribute = name.partition(":")
    try:
        own = "." in module and is_sibling(module)
        found = import_sibling(module) if own else import_beside(module, [*_places, Path.cwd()])
    except UsageError as fault:
        raise UsageError(f"{what} {name!r}: {fault}") from fault
    except ModuleNotFoundError as fault:
        looked = ", ".join(map(str, dict.fromkeys((*_places[:1], Path.cwd()))))
        raise UsageError(
            f"{what} {name!r} cannot be imported: {fault}; looked for in {looked}, and among what "
            "is installed"
        ) from fault
    except Exception as fault:  # whatever the module does when it is imported
        raise UsageError(
            f"{what} {name!r} cannot be imported: {type(fault).__name__}: {fault}"
        ) from fault
    if not hasattr(found, attribute):
        public = [one for one in vars(found) if not one.startswith("_")]
        raise UsageError(
            f"{what} {name!r} cannot be imported: {module} has no {attribute!r}; "
            f"{nearest(attribute, public)}"
        )
    return getattr(found, attribute)


def run_folder(name: str) -> Path:
    """A folder that is not there yet, below `runs`, named after `name` and the time."""
    stamp = f"{name.replace('/', '-')}-{datetime.now():%Y%m%d-%H%M%S}"
    folder, number = Path("runs") / stamp, 1
    while folder.exists():
        number += 1
        folder = folder.with_name(f"{stamp}-{number}")
    return folder
