"""The log callbacks that an FMU calls, formatted and recorded.

FMI 1 and 2 hand over a printf format with its arguments, which Python cannot receive. A variadic
C function, emitted here once per process, passes them on as a va_list, from which the C library's
vsnprintf makes the text. Formats that would make the C library crash are shown as they are.

An FMU may call back at any time, from any thread, with null or garbage, a million times. So a gate
in compiled code lets only so many messages through, and counts the others without calling Python;
those that report trouble (Discard and worse) always pass. What is held is bounded, and no exception
leaves a callback.
"""

from __future__ import annotations

import ctypes
import platform
import sys
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache, lru_cache
from typing import Any, NamedTuple

from harness.fmi.binding.formats import expandable
from harness.fmi.wording import shorten

STATUS_NAMES = ("OK", "Warning", "Discard", "Error", "Fatal", "Pending")
MOST_MESSAGES = 200
LONGEST_MESSAGE = 4096
"""Characters of a message that are kept."""
MOST_A_RUN = {True: 100_000, False: 1000}
"""Messages that pass in a run, by whether FMUs are asked to log."""

_REASON = 500  # characters of messages in an error


def status_name(status: int) -> str:
    """A status as the standard calls it."""
    return STATUS_NAMES[status] if 0 <= status < len(STATUS_NAMES) else f"status {status}"


class LogMessage(NamedTuple):
    """One message of an FMU."""

    status: int
    category: str
    text: str

    def __str__(self) -> str:
        line = f"[{status_name(self.status)}] {self.category}: {self.text}"
        if not line.isprintable():  # nothing in it may command a terminal
            line = "".join(c if c.isprintable() or c in "\n\t" else " " for c in line)
        return line


@dataclass
class MessageLog:
    """The last `MOST_MESSAGES` messages of an instance; `echo` sees each as it arrives.

    `count` is the number of all messages so far.
    """

    echo: Callable[[LogMessage], None] | None = None
    messages: deque[LogMessage] = field(default_factory=lambda: deque(maxlen=MOST_MESSAGES))
    count: int = 0

    def add(self, status: int, category: bytes | None, text: bytes | None) -> None:
        """Keep a message; anything that is no text is replaced, and no exception leaves."""
        message = LogMessage(status, _category(category), _decoded(text).rstrip())
        self.count += 1
        self.messages.append(message)
        if self.echo is not None and _gate[0] >= 0:
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


_category = lru_cache(maxsize=256)(_decoded)  # an FMU has few of them


C_LIBRARY = ctypes.CDLL("msvcrt" if sys.platform == "win32" else None)
_expand = ctypes.PyDLL(C_LIBRARY._name)["_vsnprintf" if sys.platform == "win32" else "vsnprintf"]
_expand.argtypes = ctypes.c_char_p, ctypes.c_size_t, ctypes.c_char_p, ctypes.c_void_p
_text = ctypes.create_string_buffer(LONGEST_MESSAGE + 1)  # PyDLL: one thread at a time writes it
_gate = (ctypes.c_int64 * 2)()  # messages that may yet pass, and those that were left out
_FMI3_LOGGER = ctypes.CFUNCTYPE(
    None, ctypes.c_void_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p
)
_LOGGER = ctypes.CFUNCTYPE(
    None, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, *[ctypes.c_char_p] * 2, ctypes.c_void_p
)
"""void logger(environment, instance name, status, category, format, va_list)"""

_logs: dict[int | bytes, MessageLog] = {}


def register(log: MessageLog, name: str = "", *, logging: bool = False) -> int:
    """`log` receives the messages of the instance whose environment is the number returned, or
    that is called `name`: FMI 1 has no environment. With the last instance a run begins."""
    _gate[0], _gate[1] = MOST_A_RUN[logging], 0
    _logs[name.encode() or id(log)] = log
    return id(log)


def forget(log: MessageLog) -> None:
    """Messages for `log` are dropped from now on."""
    for key in [key for key, known in list(_logs.items()) if known is log]:
        del _logs[key]


def left_out() -> str:
    """How many messages of the present or last run did not pass, as a note; "" for none."""
    many = MOST_A_RUN[True]
    return f"{_gate[1]} messages of FMUs were left out after {many}" if _gate[1] else ""


@_FMI3_LOGGER  # type: ignore[untyped-decorator]
def _receive_text(environment: Any, status: int, category: Any, text: Any) -> None:
    log = _logs.get(environment or 0)
    if log is not None:
        log.add(status, category, text)


@_LOGGER  # type: ignore[untyped-decorator]
def _receive(
    environment: Any, name: Any, status: int, category: Any, form: Any, arguments: Any
) -> None:
    log = _logs.get(environment or 0) or _logs.get(name or b"")
    if log is not None:
        log.add(status, category, _expanded(form or b"", arguments or 0))


def _expanded(form: bytes, arguments: int) -> bytes:
    """A printf format with the va_list at address `arguments`, or as it is where that is unsafe."""
    if b"%" not in form:
        return form
    try:
        if expandable(form, arguments):
            _expand(_text, LONGEST_MESSAGE, form, arguments)
            return _text.value
    except Exception:  # none leaves a callback
        return form
    return form


@cache
def _code() -> tuple[Any, int, int]:
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    machine = llvm.Target.from_default_triple().create_target_machine(opt=1)
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine)
    module = llvm.parse_assembly(_ir())
    engine.add_module(module)
    engine.finalize_object()
    variadic, plain = map(
        engine.get_function_address, ("fmu_harness_variadic", "fmu_harness_plain")
    )
    return (engine, machine, module), variadic, plain


def variadic_logger() -> int:
    """Address of `void logger(env, instance name, status, category, format, …)` of FMI 2."""
    return _code()[1]


def plain_logger() -> int:
    """Address of `void logger(env, status, category, text)` of FMI 3."""
    return _code()[2]


def _ir() -> str:
    variadic, plain = (ctypes.cast(f, ctypes.c_void_p).value for f in (_receive, _receive_text))
    # where va_list is an array (System V, AAPCS64) its address is passed, elsewhere its content
    x86_64 = "x86_64" in platform.machine().lower()
    by_value = sys.platform == "win32" or (sys.platform == "darwin" and not x86_64)
    load = "%list = load i8*, i8** %slot" if by_value else "%list = bitcast i8** %slot to i8*"
    gate = f"""
  %left = load i64, i64* inttoptr (i64 {ctypes.addressof(_gate)} to i64*)
  %less = sub i64 %left, 1
  store i64 %less, i64* inttoptr (i64 {ctypes.addressof(_gate)} to i64*)
  %open = icmp sgt i64 %left, 0
  %trouble = icmp ugt i32 %status, 1
  %passes = or i1 %open, %trouble
  %out = load i64, i64* inttoptr (i64 {ctypes.addressof(_gate) + 8} to i64*)
  %closed = xor i1 %open, 1
  %one = zext i1 %closed to i64
  %now = add i64 %out, %one
  store i64 %now, i64* inttoptr (i64 {ctypes.addressof(_gate) + 8} to i64*)
  br i1 %passes, label %pass, label %end
pass:"""
    return f"""
declare void @llvm.va_start(i8*)
declare void @llvm.va_end(i8*)
define void @fmu_harness_variadic(
    i8* %env, i8* %name, i32 %status, i8* %category, i8* %format, ...) {{
  %area = alloca [8 x i64], align 16
  {gate}
  %slot = bitcast [8 x i64]* %area to i8**
  %raw = bitcast [8 x i64]* %area to i8*
  call void @llvm.va_start(i8* %raw)
  {load}
  %receive = inttoptr i64 {variadic} to void (i8*, i8*, i32, i8*, i8*, i8*)*
  call void %receive(i8* %env, i8* %name, i32 %status, i8* %category, i8* %format, i8* %list)
  call void @llvm.va_end(i8* %raw)
  br label %end
end:
  ret void
}}
define void @fmu_harness_plain(i8* %env, i32 %status, i8* %category, i8* %text) {{
  {gate}
  %receive = inttoptr i64 {plain} to void (i8*, i32, i8*, i8*)*
  call void %receive(i8* %env, i32 %status, i8* %category, i8* %text)
  br label %end
end:
  ret void
}}
"""
