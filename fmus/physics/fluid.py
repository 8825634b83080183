"""Oil with a little free air: a barotropic fluid whose pressure cannot reach vapour pressure.

Specific volume at absolute pressure p, with π = p − p_v, π₀ = p₀ − p_v, liquid bulk modulus β,
and free air (volume fraction α at p₀, isothermal):

    ρ₀ v(p) = (1 − α)(1 − (p − p₀)/β) + α π₀/π

so ρ = 1/v falls to zero as p → p_v: a chamber that expands, or a pump that sucks, without a
supply gets ever thinner mixture and never a lower pressure than p_v. From v follow, exactly:

    β_eff = −v/(dv/dp),        h(p) = ∫ v dp from p₀,        h − p v  the internal energy.

The rational forms below are multiplied through by π, so they stay finite at π = 0.
Valid for p − p₀ ≪ β. Dissolving of air and temperature are left out.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from fmus.physics.smooth import Expression


@dataclass(frozen=True)
class Oil:
    """Density ρ₀ (kg/m³) at p₀ = `reference_pressure` (Pa), β, α and p_v as in the module."""

    density: Expression
    bulk_modulus: Expression
    air_fraction: Expression
    reference_pressure: Expression
    vapour_pressure: Expression

    def _coefficients(self) -> tuple[Expression, Expression, Expression]:
        """(a, b, c) of ρ₀ v = a − b π + c/π."""
        b = (1 - self.air_fraction) / self.bulk_modulus
        reference = self.reference_pressure - self.vapour_pressure
        return 1 - self.air_fraction + b * reference, b, self.air_fraction * reference

    def density_at(self, pressure: Expression) -> Expression:
        """ρ(p) = ρ₀ π/(a π − b π² + c) in kg/m³."""
        a, b, c = self._coefficients()
        excess = pressure - self.vapour_pressure
        return self.density * excess / (a * excess - b * excess * excess + c)

    def effective_bulk_modulus(self, pressure: Expression) -> Expression:
        """β_eff(p) = ρ dp/dρ = π (a π − b π² + c)/(b π² + c) in Pa."""
        a, b, c = self._coefficients()
        excess = pressure - self.vapour_pressure
        return excess * (a * excess - b * excess * excess + c) / (b * excess * excess + c)

    def pressure_rate(
        self, pressure: Expression, volume: Expression, inflow: Expression, growth: Expression
    ) -> Expression:
        """dp/dt = ((dp/dρ) Σṁ − β_eff dV/dt)/V in Pa/s: the balance of mass ρ(p) V of a chamber.

        `inflow` is Σṁ (kg/s), `growth` is dV/dt (m³/s). dp/dρ = β_eff/ρ is written without the
        common factor π, so that it stays finite down to vapour pressure.
        """
        a, b, c = self._coefficients()
        excess = pressure - self.vapour_pressure
        scaled = a * excess - b * excess * excess + c
        by_density = scaled * scaled / ((b * excess * excess + c) * self.density)
        return (by_density * inflow - self.effective_bulk_modulus(pressure) * growth) / volume

    def enthalpy(self, pressure: Expression) -> Expression:
        """h(p) in J/kg, zero at the reference pressure."""
        a, b, c = self._coefficients()
        excess = pressure - self.vapour_pressure
        reference = self.reference_pressure - self.vapour_pressure
        difference = excess - reference
        mean = (excess + reference) / 2
        return (difference * (a - b * mean) + c * ca.log(excess / reference)) / self.density

    def stored_energy(self, pressure: Expression, volume: Expression) -> Expression:
        """V (ρ h − (p − p₀)) in J: what a chamber of volume V holds, seen from outside at p₀.

        Its rate is h Σṁ − (p − p₀) dV/dt for any mass flows ṁ into the chamber.
        """
        gauge = pressure - self.reference_pressure
        return volume * (self.density_at(pressure) * self.enthalpy(pressure) - gauge)
