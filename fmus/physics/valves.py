"""Valves between a line and the reservoir: volume flows in m³/s of oil at reference density.

All are static (their poppets are much faster than the line): flow = size · opening · √Δp.
"""

from __future__ import annotations

from fmus.physics.smooth import Expression, ramp, signed_root, step

ROOT_WIDTH = 2e4  # Pa; below it the orifice is laminar
RELIEF_WIDTH = 2e5  # Pa; rounding of the knee at the cracking pressure


def check_valve(
    difference: Expression, cracking: Expression, full: Expression, size: Expression
) -> Expression:
    """Flow of a spring-loaded check valve, from its inlet to its outlet.

    Q = size · step((Δp − p_crack)/p_full) · signed_root(Δp), with Δp = `difference` = inlet −
    outlet, opening over p_full = `full` above `cracking`; `size` in m³/(s·√Pa). Exactly zero
    below the cracking pressure, never negative.
    """
    return size * step((difference - cracking) / full) * signed_root(difference, ROOT_WIDTH)


def pilot_check_valve(
    difference: Expression,
    pilot: Expression,
    ratio: Expression,
    cracking: Expression,
    full: Expression,
    size: Expression,
) -> Expression:
    """Flow of a pilot-operated check valve, from the reservoir into its line; either sign.

    The force balance of poppet and pilot piston of area ratio R opens it by

        z = Δp + R p_pilot − p_crack,    Q = size · step(z/p_full) · signed_root(Δp),

    with Δp = `difference` = reservoir − line and `pilot` = opposite line − reservoir (Pa). Held
    open by its pilot, it lets the line's surplus out.
    """
    balance = difference + ratio * pilot - cracking
    return size * step(balance / full) * signed_root(difference, ROOT_WIDTH)


def relief_valve(difference: Expression, cracking: Expression, gradient: Expression) -> Expression:
    """Flow of a direct relief valve, from line to reservoir: gradient · ramp(Δp − p_crack).

    `gradient` in m³/(s·Pa) above the knee; the knee is rounded over ±2 bar, and the flow is
    exactly zero more than 2 bar below the cracking pressure.
    """
    return gradient * ramp(difference - cracking, RELIEF_WIDTH)
