"""The operations of a program: opcodes, and what the columns of a row of int64 mean.

A program is an int64 array of shape (n, WIDTH): column 0 is the opcode, the others are operands.
`loop.run_cycles` executes it compiled; the tests execute it in plain Python.
"""

from __future__ import annotations

CYCLE, INSTANT, ROWS, OPERATION, RETURNED, RESUMED = range(6)
CLOCK_SIZE = 6
"""Indices into `clock`, the loop's own state, which the caller keeps between calls. RESUMED is 1 +
the number of the instant at whose operation to go on, or 0."""

UNTOUCHED = -1.7976931348623157e308
"""What stands in place of the last successful time until an FMU has written it."""

WIDTH = 11

COPY = 0
"""first, last: for i in [first, last): v[destination[i]] = factor[i] * v[source[i]] + offset[i]"""
SAMPLE = 1
"""signal, slot: v[slot] = next prepared sample of that signal"""
CALL_4 = 2
CALL_5 = 3
CALL_7 = 4
CALL_9 = 5
"""address, then as many int64 arguments: int32 status = (*address)(…). Blocks take 5 (p, x, u, y,
sizes) and plain Python ones 4, get and set functions 4 in FMI 2 and 5 in FMI 3, directional
derivatives 7 and 9."""
STEP_FMI2 = 6
"""address, instance, step in ns, final"""
STEP_FMI3 = 7
"""address, instance, step in ns, flags, last successful time, byte offset of the flags, final: the
flags are eventHandlingNeeded, terminateSimulation and earlyReturn, a byte each in the exchange
buffer. `final` is 1 where the state before the step will not be asked for again, else 0."""
CHECK = 8
"""first slot, last slot: the run ends where one of them is NaN or infinite"""
ENCODE = 9
DECODE = 10
"""kind, first slot, last slot, byte offset: float64 slots to, from C integers in the buffer; the
run ends where a number does not fit"""
RECORD = 11
"""no operands: append the recorded slots as a row"""

ADD = 12
"""first, last: for i in [first, last): v[destination[i]] += factor[i] * v[source[i]] + offset[i]"""
CALL_2 = 13
"""address, then 2 int64 arguments: get functions of an FMU's state take these"""
CALL_2_AT = 14
"""address, int64 argument, place: the second argument is the int64 that lies at address `place`"""
REPEAT = 15
"""slot, rows: go back by that many rows while v[slot] is not zero; the run ends where it is NaN"""
UNLESS_STOP = 16
"""no operands: at the stop time the instant ends here"""
COPY_TYPED = 17
"""first, last: as COPY, each by its conversion (third column of copies); the run ends where a
number does not fit"""
STEP_CALL = 18
"""address, context, step in ticks, first slot, last slot: status = (*address)(context, time, end of
the step), both times in s, for what no single function of an FMU does; statuses from `ASKED` on
are outcomes"""
SKIP = 19
"""place, rows: leave out that many rows where the int64 at address `place` is 0"""

OK = 0
STATUS = 1
"""a function returned a status that ends the run"""
NOT_FINITE = 2
"""a checked slot is NaN or infinite"""
TERMINATED = 3
"""an FMI 3 component asked for the end of the simulation"""
EARLY = 4
"""an FMI 3 component returned before the end of its step, which it was not allowed to"""
OUT_OF_RANGE = 5
"""a number does not fit into the C type of the input that it is written to"""
NOT_CONVERGED = 6
"""a repetition came to no end"""
FULL = 7
"""there is no room for more rows: to be called again, after they have been taken away"""

ASKED = 64
"""What a called participant adds to an outcome, to tell it from a status of FMI."""

(
    EXACT, FROM_INT64, FROM_UINT64, TO_INT64, TO_UINT64, INT64_TO_UINT64, UINT64_TO_INT64,
    ROUND, TRUTH, SINGLE,
) = range(10)  # fmt: skip
"""Conversions of COPY_TYPED: the same 64 bits; 64-bit integers to and from reals and one another;
reals as they are held in an integer of up to 32 bits, a boolean, a float32."""

BOOL8, INT8, UINT8, INT16, UINT16, INT32, UINT32, INT64, UINT64, FLOAT32, BOOL32 = range(11)
"""Kinds of C numbers that are not float64; booleans are 1 byte in FMI 3 and an int in FMI 2."""
ITEM_SIZE = (1, 1, 1, 2, 2, 4, 4, 8, 8, 4, 4)
