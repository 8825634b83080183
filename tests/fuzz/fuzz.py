"""Coverage-guided fuzzing with atheris (`pip install fmu-harness[fuzz]`), a target at a time:

    python -m tests.fuzz.fuzz description -max_total_time=300

What follows the target goes to libFuzzer. The committed corpus is where it starts; what it finds
on the way is kept in `.fuzz/<target>` and may be added to the corpus by hand. It ends at the
first input that raises anything but a `HarnessError`, and writes that input to a file.
"""

from __future__ import annotations

import sys
from pathlib import Path

import atheris

with atheris.instrument_imports(include=["harness", "fmpy", "zipfile", "tomllib", "csv"]):
    from tests.fuzz import targets
    from tests.fuzz.place import CORPUS


def main() -> None:
    """Fuzz the target named by the first argument."""
    if len(sys.argv) < 2 or sys.argv[1] not in targets.TARGETS:
        sys.exit(f"usage: python -m tests.fuzz.fuzz {{{','.join(targets.TARGETS)}}} [libFuzzer …]")
    target = sys.argv[1]
    found = Path(".fuzz") / target
    found.mkdir(parents=True, exist_ok=True)
    limits = ["-timeout=10", "-rss_limit_mb=4096", "-max_len=20000"]
    folders = [str(found), str(CORPUS / target)]
    atheris.Setup(
        [sys.argv[0], *limits, *sys.argv[2:], *folders],
        lambda content: targets.attempt(target, content),
    )
    atheris.Fuzz()


if __name__ == "__main__":
    main()
