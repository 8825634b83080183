"""The components' identities: smooth functions, oil, spring and stops, by exact derivatives."""

import casadi as ca
import numpy as np
import pytest

from fmus.physics import smooth
from fmus.physics.fluid import Oil
from fmus.physics.mechanics import CouplingSpring, EndStops
from fmus.physics.motor import ServoDrive

OIL = Oil(870.0, 1.5e9, 1e-3, 101325.0, 500.0)
PRESSURES = np.geomspace(501.0, 250e5, 60)
X = ca.SX.sym("x")


def on(expression, points) -> np.ndarray:
    return np.array(ca.Function("on", [X], [expression])(np.atleast_1d(points)[None, :])).ravel()


def slope(expression):
    return ca.jacobian(expression, X)


def test_ramp_and_step_are_exact_outside_their_width_and_c2_at_its_edges():
    ramp = smooth.ramp(X, 0.5)
    assert np.all(on(ramp, [-3.0, -0.5]) == 0.0)
    assert np.array_equal(on(ramp, [0.5, 3.0]), [0.5, 3.0])
    difference = slope(smooth.ramp_integral(X, 0.5)) - ramp
    assert np.abs(on(difference, np.linspace(-1, 1, 41))).max() < 1e-15
    for function, edges in ((ramp, (-0.5, 0.5)), (smooth.step(X), (0.0, 1.0))):
        for order in range(3):
            for edge in edges:
                below, above = on(function, [edge - 1e-9, edge + 1e-9])
                assert below == pytest.approx(above, abs=1e-7), order
            function = slope(function)


def test_positive_part_splits_and_root_and_saturation_are_odd():
    points = np.linspace(-4, 4, 33)
    split = smooth.positive_part(X, 0.3) - smooth.positive_part(-X, 0.3)
    assert on(split, points) == pytest.approx(points, abs=1e-15)
    assert np.abs(on(smooth.saturate(X, 0.1), [-1e3, -2, 2, 1e3])).max() < 1.0
    assert on(smooth.signed_root(X, 1e-6), [-4.0, 9.0]) == pytest.approx([-2.0, 3.0], rel=1e-9)


def test_oil_bulk_modulus_and_enthalpy_follow_from_its_density():
    density = OIL.density_at(X)
    bulk = density / slope(density)
    assert on(OIL.effective_bulk_modulus(X) / bulk, PRESSURES) == pytest.approx(1.0, rel=1e-9)
    assert on(slope(OIL.enthalpy(X)) * density, PRESSURES) == pytest.approx(1.0, rel=1e-9)
    assert on(density, 101325.0) == pytest.approx(870.0, rel=1e-14)
    assert on(OIL.enthalpy(X), 101325.0) == pytest.approx(0.0, abs=1e-12)


def test_oil_is_stiff_under_pressure_and_vanishes_at_vapour_pressure():
    assert on(OIL.effective_bulk_modulus(X), 100e5) == pytest.approx(1.5e9, rel=0.01)
    assert np.all(np.diff(on(OIL.density_at(X), PRESSURES)) > 0)
    assert on(OIL.density_at(X), 500.0) == 0.0
    assert on(OIL.pressure_rate(X, 1e-4, 0.0, 1e-3), 500.0) == 0.0


@pytest.mark.parametrize("ratio", [0.0, 0.5, 1.0])
def test_spring_and_stop_forces_are_slopes_of_their_energies(ratio):
    spring = CouplingSpring(519e3, 500.0, ratio)
    points = np.array([-2e-3, -1e-5, 0.0, 1e-5, 2e-3])
    force = on(spring.elastic_force(X), points)
    assert on(slope(spring.stored_energy(X)), points) == pytest.approx(force, abs=1e-6)
    assert force[0] == pytest.approx(-ratio * 519e3 * 2e-3, abs=0.02)
    stops = EndStops(0.15, 2e8, 2e5)
    points = np.array([-1e-4, -1e-5, 1e-5, 0.075, 0.15 + 1e-5, 0.1501])
    force = on(stops.elastic_force(X), points)
    assert on(-slope(stops.stored_energy(X)), points) == pytest.approx(force, abs=1e-6)
    assert force[3] == 0.0


def test_available_torque_is_the_smaller_of_torque_and_power_limit():
    drive = ServoDrive(18.6, 2900.0, 1e-3, 1.0, 0.04)
    torque = on(drive.available_torque(X), [0.0, 20.0, 1000.0])
    assert torque == pytest.approx([18.6, 18.6, 2.9], rel=1e-3)
