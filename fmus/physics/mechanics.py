"""Friction, end stops and the spring between two moving bodies: forces and their energies."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from fmus.physics.smooth import Expression, positive_part, ramp, ramp_integral, step

STOP_WIDTH = 2e-5  # m; a stop engages over this travel
CONTACT_WIDTH = 1e-5  # m; an unbolted spring loses contact over this travel


@dataclass(frozen=True)
class Friction:
    """Stribeck friction, always against the motion:

    F(v) = b v + (F_c + (F_s − F_c) exp(−(v/v_s)²)) tanh(v/v_t)

    Coulomb F_c, breakaway F_s (N), Stribeck speed v_s, smoothing speed v_t (m/s), viscous b
    (N·s/m). Below v_t it is viscous: a stuck rod creeps at most v_t.
    """

    coulomb: Expression
    breakaway: Expression
    stribeck_speed: Expression
    smoothing_speed: Expression
    viscous: Expression

    def force(self, speed: Expression) -> Expression:
        """F(v) in N."""
        ratio = speed / self.stribeck_speed
        dry = self.coulomb + (self.breakaway - self.coulomb) * ca.exp(-ratio * ratio)
        return self.viscous * speed + dry * ca.tanh(speed / self.smoothing_speed)


@dataclass(frozen=True)
class EndStops:
    """Stops at 0 and `stroke` (m): a spring, and a damper that acts only inside the stop.

    Into the stop by s > 0 at speed ds/dt:  F = k ramp(s) + c step(s/w) ds/dt, both from zero,
    exactly zero in free travel.
    """

    stroke: Expression
    stiffness: Expression
    damping: Expression

    def elastic_force(self, position: Expression) -> Expression:
        """Elastic force on the rod, positive in extension, in N."""
        lower = ramp(-position, STOP_WIDTH)
        return self.stiffness * (lower - ramp(position - self.stroke, STOP_WIDTH))

    def damping_force(self, position: Expression, speed: Expression) -> Expression:
        """Damping force on the rod, always against its motion, in N."""
        inside = step(-position / STOP_WIDTH) + step((position - self.stroke) / STOP_WIDTH)
        return -self.damping * inside * speed

    def stored_energy(self, position: Expression) -> Expression:
        """Elastic energy in J."""
        lower = ramp_integral(-position, STOP_WIDTH)
        return self.stiffness * (lower + ramp_integral(position - self.stroke, STOP_WIDTH))


@dataclass(frozen=True)
class CouplingSpring:
    """The spring between two bodies, with a damper in parallel.

    Compressed by δ (m):  F = k (r δ + (1 − r) δ⁺) + c dδ/dt, compression positive, where δ⁺ is
    `positive_part` with a width of 10 µm. r = 1: bolted at both ends, pulls as well as pushes;
    r = 0: only rests, and lets go.
    """

    stiffness: Expression
    damping: Expression
    tension_ratio: Expression

    def elastic_force(self, compression: Expression) -> Expression:
        """Elastic part in N."""
        pushed = positive_part(compression, CONTACT_WIDTH)
        ratio = self.tension_ratio
        return self.stiffness * (ratio * compression + (1 - ratio) * pushed)

    def damping_force(self, closing_speed: Expression) -> Expression:
        """Damping part c dδ/dt in N."""
        return self.damping * closing_speed

    def stored_energy(self, compression: Expression) -> Expression:
        """Elastic energy in J; its derivative by δ is `elastic_force`."""
        d, w = compression, CONTACT_WIDTH
        pushed = (d * d + d * ca.sqrt(d * d + w * w) + w * w * ca.asinh(d / w)) / 4
        ratio = self.tension_ratio
        return self.stiffness * (ratio * d * d / 2 + (1 - ratio) * pushed)
