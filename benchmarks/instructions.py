"""Instructions that the loop and `--help` execute, against the last commit's.
`python -m benchmarks.instructions`.

Counts do not depend on how busy the machine is. Of the loop they are machine instructions of a
sample: a process is stepped instruction by instruction (ptrace, which needs no rights) through runs
of two lengths, and the difference is what samples cost: read, controller, write, record, doStep
of the trivial FMU in `c/`. It is compiled for no particular processor, so that other machines
count the same. Of `--help` they are bytecodes of Python, its own start left out.

`instructions.json` holds the counts of the last commit; `--write` writes it. One that grows by more
than 5 % is a failure. Other versions of Python or numba count otherwise, and are not compared.
"""

from __future__ import annotations

import argparse
import ctypes
import json
import os
import platform
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping
from importlib.metadata import version
from pathlib import Path

COUNTS = Path(__file__).with_suffix(".json")
MOST_GROWTH = 0.05
_FEW, _MANY = 100, 300
_TRACEME, _SINGLESTEP = 0, 9
_HELP = """
import sys
count = 0
def trace(frame, event, argument):
    global count
    frame.f_trace_opcodes, frame.f_trace_lines = True, False
    count += event == "opcode"
    return trace
sys.settrace(trace)
from harness.cli.main import run_command_line
run_command_line(["--help"])
sys.settrace(None)
print(count, file=sys.stderr)
"""


def versions() -> dict[str, str]:
    """On what counts depend."""
    return {
        "python": ".".join(platform.python_version_tuple()[:2]),
        "numba": version("numba"),
        "typer": version("typer"),
        "machine": platform.machine(),
    }


def help_bytecodes() -> int:
    """Bytecodes that `fmu-harness --help` executes, all modules being compiled."""
    environment = {**os.environ, "PYTHONHASHSEED": "0"}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    with tempfile.TemporaryDirectory() as folder:
        environment["PYTHONPYCACHEPREFIX"] = folder
        for _ in range(2):
            done = subprocess.run(
                [sys.executable, "-c", _HELP], env=environment, capture_output=True, text=True,
                check=True,
            )  # fmt: skip
    return int(done.stderr.split()[-1])


def loop_instructions() -> float | None:
    """Machine instructions of one sample of the compiled loop, in a process that compiles for no
    particular processor; None where processes cannot be stepped or there is no C compiler."""
    environment = {**os.environ, "NUMBA_CPU_NAME": "generic", "PYTHONHASHSEED": "0"}
    command = [sys.executable, "-m", "benchmarks.instructions", "--sample"]
    done = subprocess.run(
        command, env=environment, capture_output=True, text=True, check=True,
        cwd=Path(__file__).parents[1],
    )  # fmt: skip
    found: float | None = json.loads(done.stdout)
    return found


def _sample() -> float | None:
    from benchmarks.lag import build_lag
    from benchmarks.sides import compiled
    from harness.master import run as loop
    from harness.master.program.frame import Frame

    if sys.platform != "linux":
        return None
    loop._FIRST_CHUNK = _MANY + 1  # all in one call
    run = Frame.run

    def stopping(frame: Frame) -> int:
        if frame.until == 1:  # the outputs of initialisation
            return run(frame)
        os.kill(os.getpid(), signal.SIGSTOP)
        outcome = run(frame)
        os.kill(os.getpid(), signal.SIGSTOP)
        return outcome

    with tempfile.TemporaryDirectory() as folder:
        try:
            lag = build_lag(Path(folder), 3)
        except OSError:
            return None
        compiled(lag, True, 1000)  # compiles
        Frame.run = stopping  # type: ignore[method-assign]
        counts = [stepped(lambda n=n: compiled(lag, True, n)) for n in (_FEW, _MANY)]
    if None in counts:
        return None
    few, many = (count or 0 for count in counts)
    return (many - few) / (_MANY - _FEW)


def stepped(work: Callable[[], object]) -> int | None:
    """How many instructions a copy of this process executes in `work` between the two moments at
    which that stops itself; None where it cannot be stepped."""
    library = ctypes.CDLL(None, use_errno=True)
    pid = os.fork()
    if pid == 0:
        try:
            if library.ptrace(_TRACEME, 0, None, None) == 0:
                work()
        finally:
            os._exit(0)
    try:
        if not _stopped_by(pid, signal.SIGSTOP):
            return None
        count = 0
        while library.ptrace(_SINGLESTEP, pid, None, None) == 0:
            if not _stopped_by(pid, signal.SIGTRAP):
                return count
            count += 1
        return None
    finally:
        os.kill(pid, signal.SIGKILL)
        os.waitpid(pid, 0)


def _stopped_by(pid: int, number: int) -> bool:
    status = os.waitpid(pid, os.WUNTRACED)[1]
    return os.WIFSTOPPED(status) and os.WSTOPSIG(status) == number


def counted() -> dict[str, float | None]:
    """The counts by name; None where this machine cannot count."""
    return {"loop": loop_instructions(), "help": help_bytecodes()}


def grown(now: Mapping[str, float | None], before: Mapping[str, float | None]) -> list[str]:
    """A sentence for each count that has grown too much."""
    return [
        f"{name}: {count:.6g} instructions, {100 * (count / old - 1):.1f} % more than the "
        f"{old:.6g} of the last commit"
        for name, count in now.items()
        if count is not None and (old := before.get(name)) and count > (1 + MOST_GROWTH) * old
    ]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true", help="keep the counts for later commits")
    parser.add_argument("--sample", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.sample:
        print(json.dumps(_sample()))
        return
    now = counted()
    for name, count in now.items():
        print(f"{name}: {'cannot be counted here' if count is None else format(count, '.6g')}")
    if options.write:
        COUNTS.write_text(json.dumps({"versions": versions(), "counts": now}, indent=2) + "\n")
        return
    kept = json.loads(COUNTS.read_text())
    if kept["versions"] != versions():
        print(f"not compared: the last commit's counts are of {kept['versions']}")
    elif faults := grown(now, kept["counts"]):
        raise SystemExit("\n".join(faults))


if __name__ == "__main__":
    main()
