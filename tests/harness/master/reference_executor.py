"""The loop in plain Python, written from the meaning of the operations.

Floats are Python floats, addresses are called through ctypes, C integers are packed by `struct`.
"""

import ctypes
import math
import struct
from fractions import Fraction
from typing import Any

from harness.compiler import operations as op
from harness.master.program.frame import Frame

FORMATS = {op.BOOL8: "?", op.INT8: "b", op.UINT8: "B", op.INT16: "h", op.UINT16: "H",
           op.INT32: "i", op.UINT32: "I", op.INT64: "q", op.UINT64: "Q",
           op.FLOAT32: "f", op.BOOL32: "i"}  # fmt: skip
ARGUMENTS = {op.CALL_2: 2, op.CALL_4: 4, op.CALL_5: 5, op.CALL_7: 7, op.CALL_9: 9,
             op.SET_FMI2: 4, op.SET_FMI3: 5}  # fmt: skip
SIDES = {op.EXACT: ("d", "d"), op.FROM_INT64: ("q", "d"), op.FROM_UINT64: ("Q", "d"),
         op.TO_INT64: ("d", "q"), op.TO_UINT64: ("d", "Q"), op.INT64_TO_UINT64: ("q", "Q"),
         op.UINT64_TO_INT64: ("Q", "q"), op.ROUND: ("d", "d"), op.TRUTH: ("d", "d"),
         op.SINGLE: ("d", "d")}  # fmt: skip
"""What lies in the source and in the target of a conversion, as formats of `struct`."""


def call(address: int, *arguments: Any) -> int:
    kinds = [ctypes.c_double if isinstance(a, float) else ctypes.c_int64 for a in arguments]
    return int(ctypes.CFUNCTYPE(ctypes.c_int32, *kinds)(address)(*arguments))


class Executor:
    """Executes the program of a frame."""

    def __init__(self, frame: Frame) -> None:
        self.clock, self.v = frame.clock, frame.v
        self.wires = list(zip(frame.copies, frame.scales, strict=True))
        self.samples, self.cursors, self.exchange = frame.samples, frame.cursors, frame.exchange
        self.recorded, self.rows, self.times = frame.recorded, frame.rows, frame.times

    def run(self, frame: Frame) -> int:
        while self.clock[0] < frame.until:
            for offset, first, end, _ in frame.instants.tolist():
                now = frame.start + int(self.clock[0]) * frame.cycle_ns + offset
                if now > frame.stop:
                    continue
                self.clock[1] = now
                index = first
                while index < end:
                    self.clock[3] = index
                    code, *o = (int(x) for x in frame.program[index])
                    if self.leaps(code, o[0], now, frame.stop):
                        index += o[1]
                        continue
                    outcome = self.execute(now, frame.stop, [code, *o])
                    if outcome:
                        return outcome
                    index += 1
            self.clock[0] += 1
        return op.OK

    def leaps(self, code: int, operand: int, now: int, stop: int) -> bool:
        if code == op.REPEAT:
            return bool(self.v[operand] != 0 and not math.isnan(self.v[operand]))
        return code == op.UNLESS_STOP and now >= stop

    def execute(self, now: int, stop: int, row: list[int]) -> int:
        code, *o = row
        if code == op.COPY:
            for (source, target, _), _ in self.wires[o[0] : o[0] + o[1]]:
                self.v[target : target + 1] = self.v[source : source + 1]
        elif code == op.SCALE:
            for (source, target, _), (factor, offset) in self.wires[o[0] : o[0] + o[1]]:
                self.v[target] = float(factor) * float(self.v[source]) + float(offset)
        elif code == op.ADD:
            for (source, target, _), (factor, offset) in self.wires[o[0] : o[0] + o[1]]:
                self.v[target] += float(factor) * float(self.v[source]) + float(offset)
        elif code == op.COPY_TYPED:
            return self.copy_typed(o[0], o[0] + o[1])
        elif code == op.REPEAT:
            return op.NOT_CONVERGED if math.isnan(self.v[o[0]]) else op.OK
        elif code == op.CALL_2_AT:
            return self.status(call(o[0], o[1], ctypes.c_int64.from_address(o[2]).value))
        elif code == op.SAMPLE:
            self.v[o[1]] = self.samples[self.cursors[o[0]]]
            self.cursors[o[0]] += 1
        elif code in ARGUMENTS:
            return self.status(call(*o[: 1 + ARGUMENTS[code]]))
        elif code in (op.GET_FMI2, op.GET_FMI3):
            return self.checked(call(o[0], *o[2 : 6 + (code == op.GET_FMI3)]), o[5], o[1])
        elif code == op.BLOCK:
            unused = (ctypes.c_int64 * 2)()
            places = [ctypes.addressof(unused), ctypes.addressof(unused) + 8]
            return self.checked(call(o[0], *places, *o[2:7]), o[5], o[1])
        elif code in (op.STEP_FMI2, op.STEP_FMI3):
            return self.step(now, stop, code, o)
        elif code == op.CHECK:
            return 0 if all(map(math.isfinite, self.v[o[0] : o[0] + o[1]])) else op.NOT_FINITE
        elif code == op.RECORD:
            row_number = int(self.clock[2])
            self.times[row_number] = float(Fraction(now, 10**9))
            self.rows[row_number] = [self.v[slot] for slot in self.recorded]
            self.clock[2] += 1
        elif code in (op.ENCODE, op.DECODE):
            return self.convert(code, *o[:4])
        return op.OK

    def checked(self, status: int, place: int, n: int) -> int:
        values = (ctypes.c_double * n).from_address(place)
        if status not in (0, 1):
            return self.status(status)
        return 0 if all(map(math.isfinite, values)) else op.NOT_FINITE

    def copy_typed(self, first: int, last: int) -> int:
        for (source, target, how), (factor, offset) in self.wires[first:last]:
            given, taken = SIDES[int(how)]
            cell = self.v[source : source + 1].tobytes()
            value = struct.unpack(f"<{given}", cell)[0]
            if "d" in (given, taken) or (factor, offset) != (1.0, 0.0):
                value = float(factor) * float(value) + float(offset)
            if how == op.EXACT:
                value = struct.unpack("<d", cell)[0]
            if how in (op.ROUND, op.TRUTH, op.SINGLE):
                value = {
                    op.ROUND: lambda x: float(round(x)) if math.isfinite(x) else x,
                    op.TRUTH: lambda x: float(x != 0.0),
                    op.SINGLE: lambda x: ctypes.c_float(x).value,
                }[int(how)](value)
            elif taken != "d":
                if not math.isfinite(value):
                    return op.OUT_OF_RANGE
                value = round(value)
            try:
                packed = struct.pack(f"<{taken}", value)
            except struct.error:
                return op.OUT_OF_RANGE
            self.v[target : target + 1] = struct.unpack("<d", packed)
        return op.OK

    def step(self, now: int, stop: int, code: int, o: list[int]) -> int:
        if now + o[2] > stop:
            return op.OK
        head = (o[0], o[1], now / 10**9, o[2] / 10**9, o[3 if code == op.STEP_FMI2 else 5])
        if code == op.STEP_FMI2:
            return self.status(call(*head))
        status = call(*head, o[3], o[3] + 1, o[3] + 2, o[4])
        _, terminate, early = (ctypes.c_uint8 * 3).from_address(o[3])
        if status > 1:
            return self.status(status)
        if early:
            return op.EARLY
        return op.TERMINATED if terminate else op.OK

    def status(self, status: int) -> int:
        if status in (0, 1):
            return op.OK
        self.clock[4] = status
        return op.STATUS

    def convert(self, code: int, kind: int, first: int, last: int, start: int) -> int:
        form, n = FORMATS[kind], last - first
        size = struct.calcsize(f"<{form}") * n
        if code == op.DECODE:
            stored = struct.unpack(f"<{n}{form}", self.exchange[start : start + size].tobytes())
            self.v[first:last] = [float(bool(x) if kind == op.BOOL32 else x) for x in stored]
            return op.OK
        values = [float(x) for x in self.v[first:last]]
        if kind in (op.BOOL8, op.BOOL32):
            values = [x != 0.0 for x in values]
        elif kind != op.FLOAT32:
            values = [round(x) for x in values]
        try:
            self.exchange[start : start + size] = list(struct.pack(f"<{n}{form}", *values))
        except (struct.error, OverflowError):
            return op.OUT_OF_RANGE
        return op.OK


def run(frame: Frame) -> int:
    """What `Frame.run` does."""
    return Executor(frame).run(frame)
