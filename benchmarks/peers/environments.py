"""The peers, and environments of their own for them, in a folder of the user's cache."""

from __future__ import annotations

import json
import os
import subprocess
import venv
from dataclasses import asdict, dataclass
from pathlib import Path


@dataclass(frozen=True)
class Peer:
    """A tool: its distributions, of which the first has its version; which `loop` its driver
    closes, or what it computes; by how many samples what is computed acts later there than here;
    steps of a round; and what its numbers may differ (1e-12 where it adds up its times, 1e-6 where
    it rounds to single precision)."""

    name: str
    packages: tuple[str, ...]
    loop: str
    delay: int = 0
    steps: int = 20_000
    tolerance: float = 1e-12


CALLBACK, FMUS = "Python controller", "controller as an FMU"
INFERENCE, FILTER = "fuzzy inference", "extended Kalman filter"
PEERS = {
    peer.name: peer
    for peer in (
        Peer("fmpy", ("fmpy",), CALLBACK, steps=50_000),
        Peer("fmugym", ("fmugym",), CALLBACK, steps=10_000, tolerance=1e-6),
        Peer("sofirpy", ("sofirpy",), CALLBACK, delay=1),
        Peer("pathsim", ("pathsim", "pathsim-fmi"), CALLBACK, steps=5_000),
        Peer("pyfmi", ("pyfmi",), CALLBACK),
        Peer("ecos", ("ecospy", "tbb"), FMUS, delay=1, steps=200_000),
        Peer("libcosim", ("libcosimpy",), FMUS, delay=1, steps=50_000),
        Peer("cofmupy", ("cofmupy",), FMUS, delay=1, steps=5_000),
        Peer("omsimulator", ("omsimulator",), FMUS, delay=1),
        Peer("simpful", ("simpful",), INFERENCE),
        Peer("skfuzzy", ("scikit-fuzzy", "numpy", "scipy", "networkx", "packaging"), INFERENCE),
        Peer("filterpy", ("filterpy",), FILTER),
    )
}


@dataclass(frozen=True)
class Environment:
    """What came of an installation: the `version` of the peer, or the words of its refusal."""

    version: str = ""
    refusal: str = ""


def folder(name: str) -> Path:
    """Where the environment of a peer is or would be."""
    cache = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(cache) / "fmu-harness-peers" / name


def python(name: str) -> Path:
    """Its interpreter."""
    return folder(name) / ("Scripts/python.exe" if os.name == "nt" else "bin/python")


def installed(name: str) -> Environment:
    """What is known of a peer's environment."""
    record = folder(name) / "peer.json"
    if not record.is_file():
        return Environment(refusal=f"not installed: python -m benchmarks.peers install {name}")
    return Environment(**json.loads(record.read_text()))


def titled(name: str) -> str:
    """The peer with its version, where it is installed."""
    return f"{PEERS[name].packages[0]} {installed(name).version}".strip()


def install(name: str) -> Environment:
    """Make the environment of a peer anew, from wheels alone: nothing is compiled."""
    peer, place = PEERS[name], folder(name)
    venv.create(place, with_pip=True, clear=True)
    command = [str(python(name)), "-m", "pip", "install", "-q", "--only-binary=:all:"]
    done = subprocess.run([*command, *peer.packages], capture_output=True, text=True, check=False)
    if done.returncode:
        said = [line for line in done.stderr.splitlines() if line.startswith("ERROR: ")]
        words = said[-1].removeprefix("ERROR: ") if said else f"pip ended with {done.returncode}"
        found = Environment(refusal=f"there is no wheel to install: {words}")
    else:
        asked = f"import importlib.metadata as m; print(m.version({peer.packages[0]!r}))"
        version = subprocess.check_output([str(python(name)), "-c", asked], text=True)
        found = Environment(version.strip())
    (place / "peer.json").write_text(json.dumps(asdict(found)))
    return found


def variables(name: str, root: Path) -> dict[str, str]:
    """Environment variables of a driver: this repository's modules, and the peer's shared
    libraries, where PyPI's `tbb` puts the one that Ecos is linked with."""
    libraries = [str(folder(name) / "lib"), os.environ.get("LD_LIBRARY_PATH", "")]
    found = os.pathsep.join(filter(None, libraries))
    return {**os.environ, "PYTHONPATH": str(root), "LD_LIBRARY_PATH": found}
