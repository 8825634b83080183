"""`--help` of the command line and of each command loads no library that only a run needs."""

import subprocess
import sys

import pytest

from harness.cli.main import app

HEAVY = {"fmpy", "lxml", "matplotlib", "numba", "numpy", "pandas", "pyarrow", "rich", "scipy"}
COMMANDS = [command.name or "" for command in app.registered_commands]
PROGRAM = """
import sys
from harness.cli.main import run_command_line
assert run_command_line({arguments!r}) == 0
print(*(name for name in sys.modules if "." not in name), file=sys.stderr)
"""


@pytest.mark.parametrize("command", ["", *COMMANDS])
def test_help_loads_no_library(command: str) -> None:
    program = PROGRAM.format(arguments=[*filter(None, [command]), "--help"])
    ran = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True, timeout=60
    )
    assert ran.stdout.startswith("Usage:")
    assert not HEAVY & set(ran.stderr.split())
