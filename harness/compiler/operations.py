"""The operations of a program: opcodes, and what the columns of a row of int64 mean.

A program is an int64 array of shape (n, WIDTH): column 0 is the opcode, the others are operands.
`loop.run_cycles` executes it compiled; the tests execute it in plain Python.

COPY         first, n: for i in [first, first + n): v[destination[i]] = v[source[i]]
SCALE        first, n: for i in [first, first + n):
             v[destination[i]] = factor[i] * v[source[i]] + offset[i]
SAMPLE       signal, slot: v[slot] = next prepared sample of that signal
CALL_n       address, then n int64 arguments: int32 status = (*address)(…). Blocks take 5 (p, x, u,
             y, sizes) and plain Python ones 4, get and set functions 4 in FMI 2 and 5 in FMI 3,
             directional derivatives 7 and 9, get functions of an FMU's state 2
SET_FMI2     as CALL_4, SET_FMI3 as CALL_5: a set function of an FMU, which reads the array at its
             fourth argument and leaves it as it is
GET_FMI2     address, n, instance, references, number of them, values: a get function of an FMU,
GET_FMI3     which gives n reals; then the number of values. The run ends where one of n is NaN or
             infinite
BLOCK        address, n_y, p, x, u, y, sizes, n_u: a block, called as numba does, that changes none
             of its n_u inputs, and of all slots only its n_y outputs, of which none may be NaN or
             infinite
STEP_FMI2    address, instance, step in ns, final
STEP_FMI3    address, instance, step in ns, flags, last successful time, final: the flags are
             eventHandlingNeeded, terminateSimulation and earlyReturn, a byte each. `final` is 1
             where the state before the step will not be asked for again, else 0
CHECK        first slot, n: the run ends where one of n slots is NaN or infinite
ENCODE       kind, first slot, last slot, byte offset: float64 slots to C integers in the buffer;
             the run ends where a number does not fit
DECODE       the same operands: from C integers in the buffer
RECORD       0, n: append the n recorded slots as a row
ADD          as SCALE, added to what is there
CALL_2_AT    address, int64 argument, place: the second argument is the int64 at address `place`
REPEAT       slot, rows: leap by that many rows (back) while v[slot] is not zero; the run ends where
             it is NaN
UNLESS_STOP  0, `TO_THE_END`: at the stop time the instant ends here
COPY_TYPED   first, n: as SCALE, each by its conversion (third column of copies); the run ends
             where a number does not fit
STEP_CALL    address, context, step in ticks, first slot, last slot: status = (*address)(context,
             time, end of the step), both times in s, for what no single function of an FMU does;
             statuses from `ASKED` on are outcomes
SKIP         place, rows: leap by that many rows where the int64 at address `place` is 0

What a program comes to:

STATUS         a function returned a status that ends the run
NOT_FINITE     a checked slot is NaN or infinite
TERMINATED     an FMI 3 component asked for the end of the simulation
EARLY          an FMI 3 component returned before the end of its step, which it was not allowed to
OUT_OF_RANGE   a number does not fit into the C type of the input that it is written to
NOT_CONVERGED  a repetition came to no end
FULL           there is no room for more rows: to be called again, after they have been taken away
"""

from __future__ import annotations

# Indices into `clock`, the loop's own state, which the caller keeps between calls. RESUMED is 1 +
# the number of the instant at whose operation to go on, or 0.
CYCLE, INSTANT, ROWS, OPERATION, RETURNED, RESUMED = range(6)
CLOCK_SIZE = 6

UNTOUCHED = -1.7976931348623157e308
"""What stands in place of the last successful time until an FMU has written it."""

(
    PROGRAM, INSTANTS, N_INSTANTS, START, STOP, CYCLE_NS, TICKS, UNTIL, CLOCK, V, COPIES, SCALES,
    SAMPLES, CURSORS, EXCHANGE, RECORDED, ROWS_AT, N_ROWS, TIMES, RESULT, FAULT,
) = range(21)  # fmt: skip
"""Cells of a frame (`harness.master.program.frame`), int64 each: addresses of arrays, lengths of
some, and times in ticks; TICKS is a float64, the number of ticks in a second. RESULT and
FAULT are what functions compiled by numba write to."""
FRAME_SIZE = 21

INSTANT_WIDTH = 4
"""Columns of an instant: its offset in the cycle in ticks, its first row and that after its last
one, and the address of its straight code, 0 where there is none."""

WIDTH = 11
(
    COPY, SAMPLE, CALL_4, CALL_5, CALL_7, CALL_9, STEP_FMI2, STEP_FMI3, CHECK, ENCODE, DECODE,
    RECORD, ADD, CALL_2, CALL_2_AT, REPEAT, UNLESS_STOP, COPY_TYPED, STEP_CALL, SKIP, SCALE,
    SET_FMI2, SET_FMI3, GET_FMI2, GET_FMI3, BLOCK,
) = range(26)  # fmt: skip
COUNTED = (COPY, SCALE, ADD, COPY_TYPED, CHECK, RECORD, GET_FMI2, GET_FMI3, BLOCK)
"""These are done as often as their second operand says."""
LEAPING = (REPEAT, SKIP, UNLESS_STOP)
"""After these the next row may be another one: that by their second operand further on."""
TO_THE_END = 2**32
"""A leap that ends the instant."""
OK, STATUS, NOT_FINITE, TERMINATED, EARLY, OUT_OF_RANGE, NOT_CONVERGED, FULL = range(8)
LEAP = -1
"""What an operation comes to after which the next row is another one."""

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
