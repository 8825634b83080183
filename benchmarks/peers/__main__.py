"""python -m benchmarks.peers install [NAME …]: environments for the peers, all where none is named;
python -m benchmarks.peers list: what is installed."""

from __future__ import annotations

import argparse

from benchmarks.peers.environments import PEERS, Environment, install, installed


def main() -> None:
    """Install or list, a line a peer."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.peers", description=__doc__)
    parser.add_argument("action", choices=("install", "list"))
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(PEERS))
    given = parser.parse_args()
    if unknown := set(given.names) - set(PEERS):
        parser.error(f"no peer is called {', '.join(unknown)}; there are {', '.join(PEERS)}")
    for name in given.names or PEERS:
        found: Environment = (install if given.action == "install" else installed)(name)
        print(f"{name:12} {found.version or found.refusal}", flush=True)


if __name__ == "__main__":
    main()
