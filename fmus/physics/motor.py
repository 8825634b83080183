"""A servo motor under its drive: first-order torque loop, PI speed loop, torque and power limits.

    T_max(ω) = T_lim P/(P⁴ + (T_lim ω)⁴)^¼         smooth minimum of T_lim and P/|ω|
    T_PI     = K_p (ω_ref − ω) + z
    T_ref    = T_max saturate(T_PI/T_max)
    τ dT/dt  = T_ref − T
    dz/dt    = (K_p (ω_ref − ω) + T_ref − T_PI)/T_i      integral with back-calculation

so |T| < T_lim always, and a stalled motor holds z at the torque limit.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from fmus.physics.smooth import Expression, saturate

TORQUE_WIDTH = 0.1  # of the torque limit; rounding of the saturation


@dataclass(frozen=True)
class ServoDrive:
    """T_lim (N·m), P (W), τ (s), K_p (N·m·s/rad) and T_i (s) of the module's equations."""

    torque_limit: Expression
    power_limit: Expression
    torque_time_constant: Expression
    speed_gain: Expression
    speed_integral_time: Expression

    def available_torque(self, speed: Expression) -> Expression:
        """T_max(ω) in N·m."""
        ratio = self.torque_limit * speed / self.power_limit
        return self.torque_limit / ca.sqrt(ca.sqrt(1 + ratio**4))

    def derivatives(
        self, speed_reference: Expression, speed: Expression, torque: Expression, z: Expression
    ) -> tuple[Expression, Expression]:
        """(dT/dt, dz/dt)."""
        proportional = self.speed_gain * (speed_reference - speed)
        demand = proportional + z
        available = self.available_torque(speed)
        allowed = available * saturate(demand / available, TORQUE_WIDTH)
        torque_rate = (allowed - torque) / self.torque_time_constant
        return torque_rate, (proportional + allowed - demand) / self.speed_integral_time
