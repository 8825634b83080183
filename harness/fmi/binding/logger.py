"""The log callbacks that an FMU calls, formatted in native code and recorded.

FMI 1 and 2 hand over a printf format with its arguments, which Python cannot receive. A variadic
C function, emitted here once per process, formats the message with the C library's vsnprintf and
passes plain text on. Formats that would make the C library crash are passed on as they are.

An FMU may call back at any time, from any thread, with null or garbage, a million times: what is
kept of it is bounded, and no exception leaves a callback.
"""

from __future__ import annotations

import ctypes
import platform
import sys
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from harness.fmi.binding.formats import expandable
from harness.fmi.wording import shorten

STATUS_NAMES = ("OK", "Warning", "Discard", "Error", "Fatal", "Pending")
MOST_MESSAGES = 200
LONGEST_MESSAGE = 4096
"""Characters of a message that are kept."""

_REASON = 500  # characters of messages in an error


@dataclass(frozen=True)
class LogMessage:
    """One message of an FMU."""

    status: int
    category: str
    text: str

    def __str__(self) -> str:
        name = STATUS_NAMES[self.status] if 0 <= self.status < len(STATUS_NAMES) else "?"
        return f"[{name}] {self.category}: {self.text}"


@dataclass
class MessageLog:
    """The last `MOST_MESSAGES` messages of an instance; `echo` sees each as it arrives.

    `count` is the number of all messages so far, `dropped` that of those no longer kept.
    """

    echo: Callable[[LogMessage], None] | None = None
    messages: deque[LogMessage] = field(default_factory=lambda: deque(maxlen=MOST_MESSAGES))
    count: int = 0

    @property
    def dropped(self) -> int:
        """How many messages came and are no longer kept."""
        return self.count - len(self.messages)

    def add(self, status: int, category: bytes | None, text: bytes | None) -> None:
        """Keep a message; anything that is no text is replaced, and no exception leaves."""
        message = LogMessage(status, _decoded(category), _decoded(text).rstrip())
        self.count += 1
        self.messages.append(message)
        if self.echo is not None:
            try:
                self.echo(message)
            except Exception:
                self.echo = None

    def reasons(self) -> str:
        """The last messages that report trouble, as a phrase for an error."""
        known = [m for m in list(self.messages) if m.text]  # a copy: another thread may be logging
        troubles = [m.text for m in known if m.status >= 1] or [m.text for m in known]
        return shorten("; ".join(troubles[-2:]), _REASON) or "the FMU logged no reason"


def _decoded(raw: bytes | None) -> str:
    return (raw or b"")[:LONGEST_MESSAGE].decode("utf-8", "replace")


PLAIN_LOGGER = ctypes.CFUNCTYPE(
    None, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p
)
"""void logger(environment, instance name, status, category, text)"""

_CHECK = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p)


@_CHECK  # type: ignore[untyped-decorator]
def _check(form: Any, arguments: Any) -> int:
    """1 where the format may be expanded with its arguments."""
    try:
        return int(expandable(ctypes.string_at(form), arguments or 0))
    except Exception:
        return 0


_logs: dict[int | bytes, MessageLog] = {}


@PLAIN_LOGGER  # type: ignore[untyped-decorator]
def _receive(environment: Any, name: Any, status: int, category: Any, text: Any) -> None:
    log = _logs.get(environment or 0) or _logs.get(name or b"")
    if log is not None:
        log.add(status, category, text)


FMI3_LOGGER = ctypes.CFUNCTYPE(
    None, ctypes.c_void_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p
)


@FMI3_LOGGER  # type: ignore[untyped-decorator]
def fmi3_logger(environment: Any, status: int, category: Any, text: Any) -> None:
    """The log callback of FMI 3."""
    log = _logs.get(environment or 0)
    if log is not None:
        log.add(status, category, text)


def register(log: MessageLog) -> int:
    """A number that stands for `log` as the environment of an instance."""
    key = id(log)
    _logs[key] = log
    return key


def forget(key: int) -> None:
    """Messages for `key` are dropped from now on."""
    _logs.pop(key, None)


def register_name(name: str, log: MessageLog) -> None:
    """`log` receives the messages of the instance called `name`; FMI 1 has no environment."""
    _logs[name.encode()] = log


def forget_name(name: str, log: MessageLog) -> None:
    """Undo `register_name`, unless another instance has taken the name since."""
    if _logs.get(name.encode()) is log:
        del _logs[name.encode()]


@cache
def _code() -> tuple[Any, int]:
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    machine = llvm.Target.from_default_triple().create_target_machine(opt=1)
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine)
    module = llvm.parse_assembly(_ir())
    engine.add_module(module)
    engine.finalize_object()
    return (engine, machine, module), engine.get_function_address("fmu_harness_logger")


def variadic_logger() -> int:
    """Address of `void logger(env, instance name, status, category, format, …)` of FMI 2."""
    return _code()[1]


def _ir() -> str:
    library = ctypes.CDLL("msvcrt" if sys.platform == "win32" else None)
    name = "_vsnprintf" if sys.platform == "win32" else "vsnprintf"
    formatter = ctypes.cast(getattr(library, name), ctypes.c_void_p).value
    receiver = ctypes.cast(_receive, ctypes.c_void_p).value
    checker = ctypes.cast(_check, ctypes.c_void_p).value
    # where va_list is an array (System V, AAPCS64) its address is passed, elsewhere its content
    x86_64 = "x86_64" in platform.machine().lower()
    by_value = sys.platform == "win32" or (sys.platform == "darwin" and not x86_64)
    load = "%list = load i8*, i8** %slot" if by_value else "%list = bitcast i8** %slot to i8*"
    return f"""
declare void @llvm.va_start(i8*)
declare void @llvm.va_end(i8*)
define void @fmu_harness_logger(
    i8* %env, i8* %name, i32 %status, i8* %category, i8* %format, ...) {{
  %area = alloca [8 x i64], align 16
  %text = alloca [{LONGEST_MESSAGE} x i8], align 16
  %slot = bitcast [8 x i64]* %area to i8**
  %raw = bitcast [8 x i64]* %area to i8*
  %first = bitcast [{LONGEST_MESSAGE} x i8]* %text to i8*
  store i8 0, i8* %first
  %missing = icmp eq i8* %format, null
  br i1 %missing, label %pass, label %print
print:
  call void @llvm.va_start(i8* %raw)
  {load}
  %check = inttoptr i64 {checker} to i32 (i8*, i8*)*
  %safe = call i32 %check(i8* %format, i8* %list)
  %sound = icmp ne i32 %safe, 0
  br i1 %sound, label %expand, label %leave
expand:
  %vsnprintf = inttoptr i64 {formatter} to i32 (i8*, i64, i8*, i8*)*
  %n = call i32 %vsnprintf(i8* %first, i64 {LONGEST_MESSAGE}, i8* %format, i8* %list)
  call void @llvm.va_end(i8* %raw)
  %last = getelementptr i8, i8* %first, i64 {LONGEST_MESSAGE - 1}
  store i8 0, i8* %last
  br label %pass
leave:
  call void @llvm.va_end(i8* %raw)
  br label %pass
pass:
  %out = phi i8* [ %first, %0 ], [ %first, %expand ], [ %format, %leave ]
  %receive = inttoptr i64 {receiver} to void (i8*, i8*, i32, i8*, i8*)*
  call void %receive(i8* %env, i8* %name, i32 %status, i8* %category, i8* %out)
  ret void
}}
"""
