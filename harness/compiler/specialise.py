"""Straight code: one function for a sequence of opcodes, without a look at any of them.

The operations are written once, in `harness.master.program.loop.perform`. Here its code is laid out
row after row with the opcode of each row made a constant, so that LLVM leaves of it what that
opcode needs. Operands are not part of it: they are read from the program as ever, so one function
serves all programs with these opcodes, and its machine code is kept from one process to the next.
Opcodes that come again and again become a loop.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from itertools import count
from pathlib import Path
from typing import Any

import llvmlite
import llvmlite.binding as llvm
from numba.core.compiler_lock import global_compiler_lock

from harness.compiler import operations as op


@dataclass(frozen=True)
class Operation:
    """An opcode; its second operand, where it is a constant; whether it may leap by that."""

    code: int
    n: int | None = None
    leaps: bool = False


_LONGEST_PERIOD, _FEWEST_TIMES = 8, 8
_DIGEST = 32
HOST = f"{llvmlite.__version__} {llvm.get_host_cpu_name()} {llvm.get_host_cpu_features().flatten()}"
"""On what machine code depends besides its source."""


def source(operations: Sequence[Operation], name: str) -> str:
    """The function `int64 name(first, row, frame, now, time)` in LLVM's language: performs rows
    from number `first` on, which lies at address `row`, and returns OK or what ended it."""
    lines = [f"define i64 @{name}(i64 %first, i64 %row, i64 %frame, i64 %now, double %time) {{"]
    lines += ["  %done = alloca i64", "  %outcome = alloca i64", "  br label %at0"]
    for start, period, times in _stretches(operations):
        end = start + period * times
        lines += [f"at{start}:", f"  store i64 {start}, ptr %done", f"  br label %again{start}"]
        lines += [f"again{start}:", f"  %done{start} = load i64, ptr %done"]
        for k in range(start, start + period):
            lines += _performed(operations, k, f"%done{start}", k - start)
        lines += [
            f"  %next{start} = add i64 %done{start}, {period}",
            f"  store i64 %next{start}, ptr %done",
            f"  %more{start} = icmp slt i64 %next{start}, {end}",
            f"  br i1 %more{start}, label %again{start}, label {_label(operations, end)}",
        ]
    lines += ["end:", f"  ret i64 {op.OK}", "leave:", "  %left = load i64, ptr %outcome"]
    return "\n".join([*lines, "  ret i64 %left", "}", ""])


def _performed(operations: Sequence[Operation], k: int, done: str, more: int) -> list[str]:
    """Perform row number `first` + `done` + `more`, which is like operation k."""
    one = operations[k]
    lines = [
        f"  %place{k} = add i64 {done}, {more}",
        f"  %number{k} = add i64 %first, %place{k}",
        f"  %bytes{k} = mul i64 %place{k}, {8 * op.WIDTH}",
        f"  %row{k} = add i64 %row, %bytes{k}",
    ]
    n = str(one.n)
    if one.n is None:
        n = f"%n{k}"
        lines += [
            f"  %address{k} = add i64 %row{k}, 16",
            f"  %pointer{k} = inttoptr i64 %address{k} to ptr",
            f"  {n} = load i64, ptr %pointer{k}",
        ]
    operands = f"i64 {one.code}, i64 {n}, i64 %number{k}, i64 %row{k}, i64 %frame, i64 %now"
    lines += [
        f"  %found{k} = call i64 @perform({operands}, double %time)",
        f"  %fine{k} = icmp eq i64 %found{k}, {op.OK}",
        f"  br i1 %fine{k}, label %fine_{k}, label %other{k}",
        f"other{k}:",
    ]
    if one.leaps:
        lines += [
            f"  %leaps{k} = icmp eq i64 %found{k}, {op.LEAP}",
            f"  br i1 %leaps{k}, label {_label(operations, k + (one.n or 0))}, label %leaves{k}",
            f"leaves{k}:",
        ]
    return [*lines, f"  store i64 %found{k}, ptr %outcome", "  br label %leave", f"fine_{k}:"]


def _label(operations: Sequence[Operation], k: int) -> str:
    return f"%at{k}" if k < len(operations) else "%end"


def _stretches(operations: Sequence[Operation]) -> list[tuple[int, int, int]]:
    """(first, period, times) of stretches that follow each other: of more than one time where
    opcodes repeat, and never where something leaps."""
    n, i, found = len(operations), 0, []
    leaping = any(one.leaps for one in operations)
    while i < n:
        best = (i, 1, 1)
        for period in range(1, 0 if leaping else _LONGEST_PERIOD + 1):
            once = operations[i : i + period]
            times = next(
                k for k in count(1) if operations[i + k * period : i + (k + 1) * period] != once
            )
            if times >= _FEWEST_TIMES and period * times > best[1] * best[2]:
                best = (i, period, times)
        found.append(best)
        i += best[1] * best[2]
    return found


def size(operations: Sequence[Operation]) -> int:
    """How many operations the function spells out."""
    return sum(period for _, period, _ in _stretches(operations))


class Specialiser:
    """Makes straight code of the operations whose meaning is `text`: an LLVM module with the
    function `int64 perform(code, row, frame, now, time)`. Machine code is kept in `folder`."""

    def __init__(self, text: str, folder: Path) -> None:
        self._text, self._folder = text, folder
        self._addresses: dict[tuple[Operation, ...], int] = {}

    def address(self, operations: tuple[Operation, ...], make: bool) -> int:
        """The address of the function for these opcodes, 0 where there is none and it is not to be
        made now."""
        if operations not in self._addresses:
            name = self._name(operations)
            code = read(self._folder / f"{name}.o")
            if code is None and make:
                code = self._compile(source(operations, name))
                write(self._folder / f"{name}.o", code)
            if code is None:
                return 0
            self._addresses[operations] = _loaded(code, name)
        return self._addresses[operations]

    def _name(self, operations: tuple[Operation, ...]) -> str:
        parts = (self._text, HOST, Path(__file__).read_text(), operations)
        return f"straight_{hashlib.sha256(repr(parts).encode()).hexdigest()[:32]}"

    def _compile(self, text: str) -> bytes:
        """Object code for this machine; empty where it would need anything but itself."""
        with global_compiler_lock:
            module = llvm.parse_assembly(self._text + text)
            module.get_function("perform").linkage = llvm.Linkage.internal
            simplify(module)
            needed = [f.name for f in module.functions if f.is_declaration]
            if any(not name.startswith("llvm.") for name in needed):
                return b""
            return bytes(_machine().emit_object(module))


def prepared(text: str, function: str) -> str:
    """`text`, the module of a function compiled by numba, with the function `perform` in front of
    it, and with nothing that this does not need."""
    given = "i64 %code, i64 %n, i64 %o, i64 %row, i64 %frame, i64 %now, double %time"
    module = llvm.parse_assembly(
        f"{text}\ndefine i64 @perform({given}) alwaysinline {{\n"
        "  %outcome = alloca i64\n  %fault = alloca ptr\n"
        f"  %status = call i32 @{function}(ptr %outcome, ptr %fault, {given})\n"
        "  %found = load i64, ptr %outcome\n  ret i64 %found\n}\n"
    )
    for one in (*module.functions, *module.global_variables):
        if not one.is_declaration and one.name != "perform":
            one.linkage = llvm.Linkage.internal
    simplify(module)
    return str(module)


def simplify(module: llvm.ModuleRef) -> None:
    """Inline and clean up; without vectors, which would cost the calls around them more than they
    save."""
    options = llvm.create_pipeline_tuning_options(speed_level=2)
    options.loop_vectorization = options.slp_vectorization = False
    options.loop_interleaving = False
    builder = llvm.create_pass_builder(_machine(), options)
    builder.getModulePassManager().run(module, builder)


@cache
def _machine() -> Any:
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    target = llvm.Target.from_default_triple()
    features = llvm.get_host_cpu_features().flatten()
    return target.create_target_machine(
        llvm.get_host_cpu_name(), features, opt=2, reloc="pic", codemodel="jitdefault", jit=True
    )


@cache
def _engine() -> Any:
    return llvm.create_mcjit_compiler(llvm.parse_assembly(""), _machine())


def _loaded(code: bytes, name: str) -> int:
    """The address of the function in object code; 0 where that is empty."""
    if not code:
        return 0
    with global_compiler_lock:
        engine = _engine()
        engine.add_object_file(llvm.ObjectFileRef.from_data(code))
        engine.finalize_object()
        return int(engine.get_function_address(name))


def read(path: Path) -> bytes | None:
    """What was written there, None where nothing was or it is damaged."""
    try:
        content = path.read_bytes()
    except OSError:
        return None
    digest, code = content[:_DIGEST], content[_DIGEST:]
    return code if hashlib.sha256(code).digest() == digest else None


def write(path: Path, code: bytes) -> None:
    """Keep it where that is possible."""
    partial = path.with_suffix(f".{os.getpid()}")
    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        partial.write_bytes(hashlib.sha256(code).digest() + code)
        partial.replace(path)
