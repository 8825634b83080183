"""The loop: executes a program cycle by cycle, compiled, without the interpreter lock.

It knows neither algorithms nor components by name; all of that is in the order and the operands
of the program (`operations`). Time is integer nanoseconds; a real number of seconds is made of
them only where an FMU asks for it.

`perform` is what the operations mean. An instant is performed row by row (`by_table`), or by a
function in which `perform` has been laid out for the opcodes of that instant (`straight`); both do
the same, to the bit.

It refuses to allocate, to print, to decide what an error means, and to write past its buffers:
the caller prepares enough samples and rows for the cycles that it asks for.
"""

from __future__ import annotations

import math

from harness.compiler import operations as op
from harness.compiler.calls import (
    call_outcome,
    call_status,
    fixed,
    integers,
    load_int64,
    octets,
    reals,
)
from harness.compiler.machine_code import compiled, inlined
from harness.compiler.operations import CYCLE, INSTANT, OPERATION, RESUMED, RETURNED, ROWS
from harness.master.program.exchange import convert, decode, encode

_WARNING = 1  # the highest FMI status with which a run goes on


@compiled
def run_cycles(frame: int) -> int:
    """Run until cycle UNTIL begins or the stop time is done; returns an outcome of `operations`.

    `frame` is the address of the cells of a `Frame`; on a fault, its clock names the operation.
    """
    clock = integers(fixed(frame, op.CLOCK))
    start, stop, cycle_ns = fixed(frame, op.START), fixed(frame, op.STOP), fixed(frame, op.CYCLE_NS)
    ticks = reals(frame)[op.TICKS]
    resumed = clock[RESUMED]
    clock[RESUMED] = 0
    while clock[CYCLE] < fixed(frame, op.UNTIL):
        for i in range(max(0, resumed - 1), fixed(frame, op.N_INSTANTS)):
            instant = integers(fixed(frame, op.INSTANTS) + 8 * op.INSTANT_WIDTH * i)
            offset, first, end, straight = instant[0], instant[1], instant[2], instant[3]
            now = start + clock[CYCLE] * cycle_ns + offset
            if now > stop:
                break
            clock[INSTANT] = now
            if straight != 0 and resumed == 0:
                row = fixed(frame, op.PROGRAM) + 8 * op.WIDTH * first
                outcome = call_outcome(straight, (first, row, frame, now, now / ticks))
            else:
                first = first if resumed == 0 else clock[OPERATION]
                outcome = by_table(frame, first, end, now, now / ticks)
            resumed = 0
            if outcome != op.OK:
                if outcome == op.FULL:
                    clock[RESUMED] = i + 1
                return outcome
        clock[CYCLE] += 1
    return op.OK


@inlined
def by_table(frame: int, first: int, end: int, now: int, time: float) -> int:
    """Perform rows first..end-1 of the program at `now` (ticks), which is `time` (s)."""
    o = first
    while o < end:
        row = fixed(frame, op.PROGRAM) + 8 * op.WIDTH * o
        code, n = integers(row)[0], integers(row)[2]
        outcome = perform(code, n, o, row, frame, now, time)
        if outcome == op.OK:
            o += 1
        elif outcome == op.LEAP:
            o += n
        else:
            return outcome
    return op.OK


@inlined
def perform(code: int, n: int, o: int, row: int, frame: int, now: int, time: float) -> int:
    """Perform row number `o`, at address `row`: OK, LEAP, or the outcome that ends the run.

    `code` is its opcode and `n` its second operand; of operations that are done n times both are
    constants in straight code.
    """
    clock, v = integers(fixed(frame, op.CLOCK)), reals(fixed(frame, op.V))
    r = integers(row)
    a, b, c, d, e, f = r[1], n, r[3], r[4], r[5], r[6]
    clock[OPERATION] = o
    status = 0
    if code == op.COPY:
        copies = integers(fixed(frame, op.COPIES))
        for i in range(a, a + n):
            v[copies[3 * i + 1]] = v[copies[3 * i]]
    elif code == op.SCALE:
        copies, scales = integers(fixed(frame, op.COPIES)), reals(fixed(frame, op.SCALES))
        for i in range(a, a + n):
            v[copies[3 * i + 1]] = scales[2 * i] * v[copies[3 * i]] + scales[2 * i + 1]
    elif code == op.SAMPLE:
        samples, cursors = reals(fixed(frame, op.SAMPLES)), integers(fixed(frame, op.CURSORS))
        v[b] = samples[cursors[a]]
        cursors[a] += 1
    elif code == op.CALL_4 or code == op.SET_FMI2:
        status = call_status(a, (b, c, d, e))
    elif code == op.CALL_5 or code == op.SET_FMI3:
        status = call_status(a, (b, c, d, e, f))
    elif code == op.GET_FMI2 or code == op.GET_FMI3 or code == op.BLOCK:
        if code == op.GET_FMI2:
            status = call_status(a, (c, d, e, f))
        elif code == op.GET_FMI3:
            status = call_status(a, (c, d, e, f, r[7]))
        else:
            own = frame + 8 * op.RESULT, frame + 8 * op.FAULT
            status = call_status(a, (*own, c, d, e, f, r[7]))
        if status == 0 or status == _WARNING:
            values = reals(f)
            for i in range(n):
                if not math.isfinite(values[i]):
                    return op.NOT_FINITE
    elif code == op.STEP_FMI3:
        if now + c <= fixed(frame, op.STOP):
            flags = octets(d)
            h = c / reals(frame)[op.TICKS]
            status = call_status(a, (b, time, h, f, d, d + 1, d + 2, e))
            if status <= _WARNING and flags[2] != 0:
                return op.EARLY
            if status <= _WARNING and flags[1] != 0:
                return op.TERMINATED
    elif code == op.STEP_FMI2:
        if now + c <= fixed(frame, op.STOP):
            status = call_status(a, (b, time, c / reals(frame)[op.TICKS], d))
    elif code == op.CHECK:
        for slot in range(a, a + n):
            if not math.isfinite(v[slot]):
                return op.NOT_FINITE
    elif code == op.RECORD:
        done = clock[ROWS]
        if done >= fixed(frame, op.N_ROWS):
            return op.FULL
        rows, recorded = reals(fixed(frame, op.ROWS_AT)), integers(fixed(frame, op.RECORDED))
        for column in range(n):
            rows[done * n + column] = v[recorded[column]]
        reals(fixed(frame, op.TIMES))[done] = time
        clock[ROWS] = done + 1
    elif code == op.ENCODE:
        if not encode(a, v, b, c, octets(fixed(frame, op.EXCHANGE)), d):
            return op.OUT_OF_RANGE
    elif code == op.DECODE:
        decode(a, v, b, c, octets(fixed(frame, op.EXCHANGE)), d)
    elif code == op.ADD:
        copies, scales = integers(fixed(frame, op.COPIES)), reals(fixed(frame, op.SCALES))
        for i in range(a, a + n):
            v[copies[3 * i + 1]] += scales[2 * i] * v[copies[3 * i]] + scales[2 * i + 1]
    elif code == op.CALL_2:
        status = call_status(a, (b, c))
    elif code == op.CALL_2_AT:
        status = call_status(a, (b, load_int64(c)))
    elif code == op.REPEAT:
        if math.isnan(v[a]):
            return op.NOT_CONVERGED
        if v[a] != 0.0:
            return op.LEAP
    elif code == op.COPY_TYPED:
        copies, scales = integers(fixed(frame, op.COPIES)), reals(fixed(frame, op.SCALES))
        if not convert(copies, scales, v, integers(fixed(frame, op.V)), a, a + n):
            return op.OUT_OF_RANGE
    elif code == op.STEP_CALL:
        if now + c <= fixed(frame, op.STOP):
            status = call_status(a, (b, time, (now + c) / reals(frame)[op.TICKS]))
            if status >= op.ASKED:
                return status - op.ASKED
    elif code == op.SKIP:
        if load_int64(a) == 0:
            return op.LEAP
    elif code == op.UNLESS_STOP:
        if now >= fixed(frame, op.STOP):
            return op.LEAP
    elif code == op.CALL_7:
        status = call_status(a, (b, c, d, e, f, r[7], r[8]))
    else:
        status = call_status(a, (b, c, d, e, f, r[7], r[8], r[9], r[10]))
    if status > _WARNING or status < 0:
        clock[RETURNED] = status
        return op.STATUS
    return op.OK
