"""Elementary functions that answer as C's do: NaN and infinity in place of exceptions.

Both branches of a case distinction are computed, so a division by zero in the branch not taken
must not raise.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from math import copysign, erf, fabs, inf, isnan, nan

__all__ = [
    "acos",
    "acosh",
    "asin",
    "asinh",
    "atan",
    "atan2",
    "atanh",
    "ceil",
    "copysign",
    "cos",
    "cosh",
    "div",
    "erf",
    "exp",
    "expm1",
    "fabs",
    "floor",
    "fmod",
    "hypot",
    "inf",
    "log",
    "log1p",
    "nan",
    "pow",
    "sin",
    "sinh",
    "sqrt",
    "tan",
    "tanh",
]

asinh, atan, atan2, hypot, tanh = math.asinh, math.atan, math.atan2, math.hypot, math.tanh


def div(a: float, b: float) -> float:
    """a / b with IEEE 754's answers to zero divisors."""
    if b != 0.0:
        return a / b
    return nan if a == 0.0 or isnan(a) or isnan(b) else copysign(inf, a) * copysign(1.0, b)


def _unary(function: Callable[[float], float], overflow: float) -> Callable[[float], float]:
    """`function` with NaN outside of its domain and `overflow` (times sign) beyond its range."""

    def answer(a: float) -> float:
        try:
            return float(function(a))
        except ValueError:
            return nan
        except OverflowError:
            return overflow if a > 0.0 else -overflow

    return answer


acos, asin, acosh = _unary(math.acos, inf), _unary(math.asin, inf), _unary(math.acosh, inf)
sin, cos, tan, sqrt = (_unary(f, inf) for f in (math.sin, math.cos, math.tan, math.sqrt))
exp, expm1, sinh = _unary(math.exp, inf), _unary(math.expm1, inf), _unary(math.sinh, inf)


def cosh(a: float) -> float:
    """Even, so its overflow has no sign."""
    return _cosh(fabs(a))


_cosh = _unary(math.cosh, inf)


def log(a: float) -> float:
    """Minus infinity at 0, NaN below."""
    return -inf if a == 0.0 else _log(a)


def log1p(a: float) -> float:
    """Minus infinity at -1, NaN below."""
    return -inf if a == -1.0 else _log1p(a)


def atanh(a: float) -> float:
    """Infinity at 1 and -1, NaN outside."""
    return copysign(inf, a) if fabs(a) == 1.0 else _atanh(a)


_log, _log1p, _atanh = (_unary(f, inf) for f in (math.log, math.log1p, math.atanh))


def pow(a: float, b: float) -> float:
    """a to the power b."""
    try:
        return math.pow(a, b)
    except ValueError:
        return inf if a == 0.0 else nan
    except OverflowError:
        return -inf if a < 0.0 and b % 2.0 == 1.0 else inf


def floor(a: float) -> float:
    """The next whole number below, as a float."""
    return float(math.floor(a)) if math.isfinite(a) else a


def ceil(a: float) -> float:
    """The next whole number above, as a float."""
    return float(math.ceil(a)) if math.isfinite(a) else a


def fmod(a: float, b: float) -> float:
    """Remainder with the sign of a."""
    try:
        return math.fmod(a, b)
    except ValueError:
        return nan
