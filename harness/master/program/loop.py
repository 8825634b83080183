"""The loop: executes a program cycle by cycle, compiled, without the interpreter lock.

It knows neither algorithms nor components by name; all of that is in the order and the operands
of the program (`operations`). Time is integer nanoseconds; a real number of seconds is made of
them only where an FMU asks for it.

It refuses to allocate, to print, to decide what an error means, and to write past its buffers:
the caller prepares enough samples and rows for the cycles that it asks for.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from harness.compiler import operations as op
from harness.compiler.calls import call_status, load_int64
from harness.compiler.machine_code import compiled
from harness.compiler.operations import CYCLE, INSTANT, OPERATION, RESUMED, RETURNED, ROWS
from harness.master.program.exchange import convert, decode, encode

_WARNING = 1  # the highest FMI status with which a run goes on


@compiled
def run_cycles(
    program: Any, instants: Any, span: Any, clock: Any, v: Any, copies: Any, scales: Any,
    samples: Any, cursors: Any, exchange: Any, recorded: Any, rows: Any, row_times: Any,
) -> int:  # fmt: skip
    """Run until cycle span[3] begins or the stop time is done; returns an outcome of `operations`.

    program    int64 (n_operations, WIDTH), in order of execution
    instants   int64 (n_instants, 3): offset in the cycle in ns, first and last operation
    span       int64 (5,): start, stop, length of a cycle, number of the cycle to stop before, and
               ticks in a second: a tick, the unit of all times, is a nanosecond or a part of it
    clock      int64 (6,): see `CYCLE` and its fellows; on a fault it names the operation
    v          float64 (n_slots,): every signal of the system
    copies     int64 (n_copies, 3): source and destination slot, conversion; scales (n_copies, 2):
               factor, offset
    samples    float64, prepared samples of all signals; cursors int64 (n_signals,): next of each
    exchange   uint8, where C integers are encoded and decoded
    recorded   int64 (n_columns,): slots of a row; rows float64 (n_rows, n_columns), row_times
               float64 (n_rows,) in s
    """
    start, stop, cycle_ns, last_cycle = span[0], span[1], span[2], span[3]
    ticks, wide = float(span[4]), v.view(np.int64)
    resumed = clock[RESUMED]
    clock[RESUMED] = 0
    while clock[CYCLE] < last_cycle:
        for instant in range(max(0, resumed - 1), instants.shape[0]):
            now = start + clock[CYCLE] * cycle_ns + instants[instant, 0]
            if now > stop:
                break
            clock[INSTANT] = now
            time = now / ticks
            o, end = instants[instant, 1], instants[instant, 2]
            if resumed > 0:
                o, resumed = clock[OPERATION], 0
            while o < end:
                clock[OPERATION] = o
                # one by one: a view of the row would cost atomic reference counting; unsigned: an
                # index that may be negative is looked at each time
                r = np.uint64(o)
                code, a, b, c = program[r, 0], program[r, 1], program[r, 2], program[r, 3]
                d, e, f = program[r, 4], program[r, 5], program[r, 6]
                status = 0
                if code == op.COPY:
                    for i in range(np.uint64(a), np.uint64(b)):
                        source, target = np.uint64(copies[i, 0]), np.uint64(copies[i, 1])
                        v[target] = scales[i, 0] * v[source] + scales[i, 1]
                elif code == op.SAMPLE:
                    v[b] = samples[cursors[a]]
                    cursors[a] += 1
                elif code == op.CALL_4:
                    status = call_status(a, (b, c, d, e))
                elif code == op.CALL_5:
                    status = call_status(a, (b, c, d, e, f))
                elif code == op.STEP_FMI3:
                    if now + c <= stop:
                        h = c / ticks
                        final = program[r, 7]
                        status = call_status(a, (b, time, h, final, d, d + 1, d + 2, e))
                        if status <= _WARNING and exchange[f + 2] != 0:
                            return op.EARLY
                        if status <= _WARNING and exchange[f + 1] != 0:
                            return op.TERMINATED
                elif code == op.STEP_FMI2:
                    if now + c <= stop:
                        status = call_status(a, (b, time, c / ticks, d))
                elif code == op.CHECK:
                    for slot in range(a, b):
                        if not math.isfinite(v[slot]):
                            return op.NOT_FINITE
                elif code == op.RECORD:
                    row = clock[ROWS]
                    if row >= rows.shape[0]:
                        clock[RESUMED] = instant + 1
                        return op.FULL
                    for column in range(np.uint64(recorded.shape[0])):
                        rows[np.uint64(row), column] = v[np.uint64(recorded[column])]
                    row_times[row] = time
                    clock[ROWS] = row + 1
                elif code == op.ENCODE:
                    if not encode(a, v, b, c, exchange, d):
                        return op.OUT_OF_RANGE
                elif code == op.DECODE:
                    decode(a, v, b, c, exchange, d)
                elif code == op.ADD:
                    for i in range(a, b):
                        v[copies[i, 1]] += scales[i, 0] * v[copies[i, 0]] + scales[i, 1]
                elif code == op.CALL_2:
                    status = call_status(a, (b, c))
                elif code == op.CALL_2_AT:
                    status = call_status(a, (b, load_int64(c)))
                elif code == op.REPEAT:
                    if math.isnan(v[a]):
                        return op.NOT_CONVERGED
                    if v[a] != 0.0:
                        o -= b
                        continue
                elif code == op.COPY_TYPED:
                    if not convert(copies, scales, v, wide, a, b):
                        return op.OUT_OF_RANGE
                elif code == op.STEP_CALL:
                    if now + c <= stop:
                        status = call_status(a, (b, time, (now + c) / ticks))
                        if status == op.ASKED + op.FULL:
                            clock[RESUMED] = instant + 1
                        if status >= op.ASKED:
                            return int(status - op.ASKED)
                elif code == op.SKIP:
                    if load_int64(a) == 0:
                        o += b
                elif code == op.UNLESS_STOP:
                    if now >= stop:
                        break
                elif code == op.CALL_7:
                    status = call_status(a, (b, c, d, e, f, program[r, 7], program[r, 8]))
                else:
                    more = (program[r, 7], program[r, 8], program[r, 9], program[r, 10])
                    status = call_status(a, (b, c, d, e, f, *more))
                if status > _WARNING or status < 0:
                    clock[RETURNED] = status
                    return op.STATUS
                o += 1
        clock[CYCLE] += 1
    return op.OK
