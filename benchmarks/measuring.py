"""What the benchmarks share: interleaved repetition, the machine's class, JSON."""

from __future__ import annotations

import json
import os
import platform
import statistics
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class Series:
    """Repeated measurements of one thing, in one unit."""

    values: tuple[float, ...]

    @property
    def median(self) -> float:
        """The middle one."""
        return statistics.median(self.values)

    @property
    def minimum(self) -> float:
        """The one least disturbed by the rest of the machine."""
        return min(self.values)

    def as_json(self) -> dict[str, Any]:
        """For the JSON file."""
        return {"median": self.median, "min": self.minimum, "values": list(self.values)}


def interleaved(sides: Mapping[str, Callable[[], float]], repeats: int) -> dict[str, Series]:
    """Each side once a round, so that whatever disturbs the machine disturbs all of them.

    A first round warms caches and is thrown away.
    """
    rounds = [{name: side() for name, side in sides.items()} for _ in range(repeats + 1)][1:]
    return {name: Series(tuple(one[name] for one in rounds)) for name in sides}


def machine() -> dict[str, str]:
    """The class of the machine and the versions that matter; no names of hosts."""
    cpuinfo = Path("/proc/cpuinfo")
    lines = cpuinfo.read_text().splitlines() if cpuinfo.is_file() else []
    models = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    packages = ("numpy", "numba", "fmpy", "casadi")
    return {
        "processor": f"{models[0] if models else platform.machine()}, {os.cpu_count()} cores",
        "system": f"{platform.system()} {platform.machine()}, Python {platform.python_version()}",
        "packages": ", ".join(f"{name} {version(name)}" for name in packages),
    }


def write_json(path: Path, results: Mapping[str, Any]) -> None:
    """Results with the machine's class."""
    path.write_text(json.dumps({"machine": machine(), **results}, indent=2) + "\n")
