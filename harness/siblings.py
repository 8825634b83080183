"""Packages that lie beside the harness, found also where a user's module has the name of one, and
a user's modules that lie beside his experiment.

Python takes `controllers` from the first folder that has one, which with a `controllers.py` beside
a script, or in the working folder, is the user's. Then ours is imported while his is set aside, and
`sys.modules` has both afterwards: `controllers` is his, `controllers.pid` and all below it ours, so
that what ours import later, and unpickling, finds them too. His package with a module of the same
dotted name as one of ours cannot be told from it, and is refused.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from importlib import import_module, invalidate_caches
from importlib.util import find_spec, module_from_spec, spec_from_file_location
from pathlib import Path
from pkgutil import iter_modules
from types import ModuleType

from harness.errors import UsageError

HOME = Path(__file__).resolve().parents[1]
PACKAGES = ("controllers", "experiments", "fmus")


def is_sibling(module: str) -> bool:
    """Whether a module of this dotted name is one of those beside the harness."""
    if module.partition(".")[0] not in PACKAGES:
        return False
    place = HOME.joinpath(*module.split("."))
    return place.with_suffix(".py").is_file() or (place / "__init__.py").is_file()


def import_sibling(module: str) -> ModuleType:
    """Import a module that lies beside the harness, such as "controllers.pid.pid".

    Raises `UsageError` where a package of the user has a module of the same name as one of ours.
    """
    package = module.partition(".")[0]
    theirs = _hiding(package)
    if theirs is None:
        return import_module(module)
    if module not in sys.modules:
        _refuse_clashes(package, theirs)
        with _set_aside(package):
            for child in iter_modules([str(HOME / package)]):
                import_module(f"{package}.{child.name}")
            import_module(module)
    return sys.modules[module]


def import_beside(module: str, folders: Iterable[Path]) -> ModuleType:
    """Import a module of the first folder that has it, else an installed one.

    The folder goes to the end of Python's path, for what the module imports itself, so it hides
    nothing that is installed. Raises `UsageError` where the module has the name of another one.
    """
    package = module.partition(".")[0]
    for folder in folders:
        here = (folder / f"{package}.py", folder / package / "__init__.py")
        file = next((one for one in here if one.is_file()), None)
        if file is None:
            continue
        loaded = sys.modules.get(package)
        found = find_spec(package) if loaded is None else loaded.__spec__
        origin = getattr(loaded, "__file__", None) or (found and found.origin)
        if found is not None and Path(origin or "nowhere").resolve() != file.resolve():
            raise UsageError(
                f"{file} has the name of another module ({origin or package}), and cannot be "
                "imported beside it; rename it"
            )
        if str(folder) not in sys.path:
            sys.path.append(str(folder))
        invalidate_caches()  # the file may be younger than what Python knows of the folder
        break
    return import_module(module)


def _hiding(package: str) -> Path | None:
    """The file of another module that has the name of our package; None where ours is found."""
    loaded = sys.modules.get(package)
    found = find_spec(package) if loaded is None else loaded.__spec__
    theirs = Path((found and found.origin) or "nowhere").resolve()
    return None if theirs == HOME / package / "__init__.py" else theirs


def _refuse_clashes(package: str, theirs: Path) -> None:
    if theirs.name == "__init__.py":
        ours = {child.name for child in iter_modules([str(HOME / package)])}
        both = sorted(ours & {child.name for child in iter_modules([str(theirs.parent)])})
        if both:
            raise UsageError(
                f"the package {theirs.parent} hides the package {package} of the harness, and both "
                f"have a module {both[0]}; rename yours"
            )


@contextmanager
def _set_aside(package: str) -> Iterator[None]:
    """While open, `package` is ours."""
    theirs = sys.modules.pop(package, None)
    spec = spec_from_file_location(package, HOME / package / "__init__.py")
    assert spec is not None and spec.loader is not None
    sys.modules[package] = module_from_spec(spec)
    try:
        spec.loader.exec_module(sys.modules[package])
        yield
    finally:
        del sys.modules[package]
        if theirs is not None:
            sys.modules[package] = theirs
