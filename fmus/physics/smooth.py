"""Smooth replacements of max, step, clip and the signed square root.

Two kinds: functions of compact support (`ramp`, `step`), C² and exact outside their width, for
things that must be exactly off (a closed valve, a free end stop); and algebraic ones
(`positive_part`, `saturate`, `signed_root`), C∞, for things that are always on.
"""

from __future__ import annotations

from typing import Any

import casadi as ca

Expression = Any
"""A CasADi SX scalar or a float."""


def positive_part(x: Expression, width: Expression) -> Expression:
    """max(x, 0) as (x + √(x² + w²))/2: positive everywhere, w/2 at zero, C∞.

    x = positive_part(x) − positive_part(−x) holds exactly.
    """
    return (x + ca.sqrt(x * x + width * width)) / 2


def step(x: Expression) -> Expression:
    """0 for x ≤ 0, 1 for x ≥ 1, between them 6x⁵ − 15x⁴ + 10x³; C²."""
    t = ca.fmin(ca.fmax(x, 0), 1)
    return t * t * t * (10 + t * (6 * t - 15))


def ramp(x: Expression, width: Expression) -> Expression:
    """max(x, 0), rounded for |x| < w and exact outside; C².

    With t = (x + w)/(2w) in [0, 1]:  2w (t³ − t⁴/2), whose derivative is 3t² − 2t³.
    """
    t = ca.fmin(ca.fmax((x + width) / (2 * width), 0), 1)
    return 2 * width * t**3 * (1 - t / 2) + ca.fmax(x - width, 0)


def ramp_integral(x: Expression, width: Expression) -> Expression:
    """∫ ramp dx from −∞ to x: the energy of a spring that engages by `ramp`, over its stiffness."""
    t = ca.fmin(ca.fmax((x + width) / (2 * width), 0), 1)
    above = ca.fmax(x - width, 0)
    return 4 * width**2 * t**4 * (1 / 4 - t / 10) + width * above + above**2 / 2


def saturate(x: Expression, width: Expression) -> Expression:
    """Clip to (−1, 1) as (√((x + 1)² + w²) − √((x − 1)² + w²))/2; C∞, |value| < 1.

    The slope at zero is 1/√(1 + w²); the value at x = 1 is about 1 − w/2.
    """
    upper = ca.sqrt((x + 1) * (x + 1) + width * width)
    lower = ca.sqrt((x - 1) * (x - 1) + width * width)
    return (upper - lower) / 2


def signed_root(x: Expression, width: Expression) -> Expression:
    """sign(x) √|x| as x/(x² + w²)^¼: slope 1/√w at zero, C∞."""
    return x / ca.sqrt(ca.sqrt(x * x + width * width))
