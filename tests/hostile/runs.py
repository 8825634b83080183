"""What hostile FMUs do at run time, and what the command line has to say about it."""

from __future__ import annotations

from dataclasses import dataclass

STARTED, HALFWAY = 0, 6
"""Rows of a run that dies before its first step, and in the sixth of ten."""

_CRASHES = {
    "segfault": "SIGSEGV", "bus": "SIGBUS", "abort": "SIGABRT", "illegal": "SIGILL",
    "divide": "SIGFPE", "overflow": "SIGSEGV", "killed": "SIGKILL", "terminated": "SIGTERM",
}  # fmt: skip
DIES = {action: f"crashed with {signal}" for action, signal in _CRASHES.items()} | {
    "exit": r"ended the process as by exit\(0\)", "_exit": r"ended the process as by exit\(0\)",
    "hang": "had not returned after 0.3 s and was ended", "spin": "had not returned after 0.3 s",
    "stop": "had not returned after 0.3 s",
}  # fmt: skip
STATUSES = {"discard": "Discard", "error": "Error", "fatal": "Fatal", "pending": "Pending",
            "status 0 17": "status 17", "status 0 -1": "status -1"}  # fmt: skip

CALLS = {
    2: {"SetupExperiment": "fmi2SetupExperiment", "SetReal": "setting u", "GetReal": "getting y"},
    3: {"SetFloat64": "setting u", "GetFloat64": "getting y"},
}
COMMON = {
    "EnterInitializationMode": "EnterInitializationMode",
    "ExitInitializationMode": "ExitInitializationMode", "DoStep": "doStep by 10 ms",
}  # fmt: skip
STAGES = {"load": "loading its library", "Terminate": "fmi3Terminate",
          "FreeInstance": "fmi3FreeInstance", "unload": "unloading the library",
          "EnterInitializationMode": "fmi3EnterInitializationMode",
          "InstantiateCoSimulation": "fmi3Instantiate", "GetFloat64": "getting y"}  # fmt: skip


@dataclass(frozen=True)
class Run:
    """One behaviour: what the sentence says, the exit code, and the rows that are there."""

    behaviour: str
    words: str
    fmi: int = 3
    code: int = 1
    rows: int | None = None  # None: any number
    settings: str = "call = 0.3"

    def __str__(self) -> str:
        return f"{self.behaviour} (FMI {self.fmi})"


def _deaths() -> list[Run]:
    in_steps = [
        Run(f"DoStep {action} 5", rf"plant .*doStep by 10 ms at t = 0\.05 s {words}", rows=HALFWAY)
        for action, words in DIES.items()
    ]
    elsewhere = [
        Run(f"{phase} {action}", f"{call}.*{DIES[action]}")
        for phase, call in STAGES.items()
        for action in ("segfault", "exit", "hang")
    ]
    return [*in_steps, *elsewhere, Run("DoStep segfault 5", "with SIGSEGV", 2, rows=HALFWAY)]


def _statuses() -> list[Run]:
    runs = []
    for fmi, calls in CALLS.items():
        for phase, call in {**calls, **COMMON}.items():
            for action, label in STATUSES.items():
                if phase != "DoStep" and action not in ("error", "fatal", "discard"):
                    continue
                runs.append(Run(f"{phase} {action}", f"plant: .*{call}.* returned {label}", fmi))
    return runs


def _oddities() -> list[Run]:
    ended = "asked for the end of the run in the step at t = 0.05 s"
    memory = "held .* of memory, more than its limit of 500 MiB"
    return [
        Run("GetFloat64 nan 7", r"output plant\.y is nan at t = 0\.0\d s"),
        Run("GetFloat64 infinite 7", r"output plant\.y is inf at t = 0\.0\d s"),
        Run("GetReal nan 7", r"output plant\.y is nan", 2),
        Run("DoStep terminate 5", ended, rows=HALFWAY),
        Run("DoStep early 5", "returned before the end of the step", rows=HALFWAY),
        Run("InstantiateCoSimulation null", "could not be instantiated"),
        Run("Instantiate null", "could not be instantiated", 2),
        Run("DoStep memory 5", memory, rows=HALFWAY, settings='memory = "500 MiB"\ncall = 20.0'),
        Run(
            "DoStep sleep 0 60",
            "the run had not ended after 0.2 s",
            settings="call = 0.3\nrun = 0.2",
        ),
        Run("DoStep exit 5 3", r"as by exit\(3\)", rows=HALFWAY),
        Run("DoStep log_error\nDoStep segfault 5", "SIGSEGV.*the valve broke", rows=HALFWAY),
        Run("DoStep log_garbage\nDoStep error 5", "returned Error: .*not text", 2, rows=HALFWAY),
        Run("DoStep child 5\nDoStep segfault 6", "SIGSEGV", rows=HALFWAY + 1),
    ]


def _harmless() -> list[Run]:
    behaviours = [
        "DoStep warning", "DoStep event", "DoStep backwards 5", "DoStep last_nan 5",
        "DoStep log_null", "DoStep log_garbage", "DoStep log_format", "DoStep log_long",
        "DoStep log_missing", "DoStep log_write", "DoStep log_thread", "DoStep log_stranger",
        "DoStep log_many 9 10000", "DoStep print", "DoStep litter", "FreeInstance log",
        "Terminate discard", "Terminate error", "Terminate fatal",
    ]  # fmt: skip
    runs = [Run(one, "", code=0, rows=11) for one in behaviours]
    second = ("log_missing", "log_write", "log_pointer", "log_null", "log_many 9 10000")
    return runs + [Run(f"DoStep {one}", "", 2, code=0, rows=11) for one in second]


FATAL_RUNS = [*_deaths(), *_statuses(), *_oddities()]
HARMLESS_RUNS = _harmless()
