"""A fixed-displacement pump that turns both ways and moves oil between lines A and B.

With D in m³/rad, ω⁺ = positive_part(ω), ω⁻ = positive_part(−ω), Δp = p_a − p_b, Δh = h_a − h_b:

    ṁ  = D (ρ_b ω⁺ − ρ_a ω⁻)       it fills with what its suction line holds
    T  = D Δp + b ω

Of the shaft power T ω the oil gets ṁ Δh; b ω² is friction, and the rest,

    D ω⁺ (Δp − ρ_b Δh) + D ω⁻ (ρ_a Δh − Δp) ≥ 0,

is lost where thin oil meets the dense line (v = dh/dp falls with p). A suction line near vapour
pressure therefore starves the pump instead of falling further.
"""

from __future__ import annotations

from dataclasses import dataclass

from fmus.physics.fluid import Oil
from fmus.physics.smooth import Expression, positive_part

SPEED_WIDTH = 0.5  # rad/s; the suction side changes over about this speed


@dataclass(frozen=True)
class Pump:
    """D (m³/rad) and b (N·m·s/rad) of the module's equations."""

    displacement: Expression
    viscous_torque: Expression

    def mass_flow(
        self, oil: Oil, speed: Expression, pressure_a: Expression, pressure_b: Expression
    ) -> Expression:
        """ṁ from B to A in kg/s."""
        forward = oil.density_at(pressure_b) * positive_part(speed, SPEED_WIDTH)
        backward = oil.density_at(pressure_a) * positive_part(-speed, SPEED_WIDTH)
        return self.displacement * (forward - backward)

    def torque(
        self, speed: Expression, pressure_a: Expression, pressure_b: Expression
    ) -> Expression:
        """T that the shaft must supply, in N·m."""
        return self.displacement * (pressure_a - pressure_b) + self.viscous_torque * speed

    def compression_loss(
        self, oil: Oil, speed: Expression, pressure_a: Expression, pressure_b: Expression
    ) -> Expression:
        """Power lost where thin oil meets the dense line, ≥ 0, in W."""
        rise = oil.enthalpy(pressure_a) - oil.enthalpy(pressure_b)
        ideal = self.displacement * speed * (pressure_a - pressure_b)
        return ideal - self.mass_flow(oil, speed, pressure_a, pressure_b) * rise
