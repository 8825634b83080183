"""An order for one FMU's equations carried out by CasADi: DaeBuilder reads them, CVODES solves."""

from __future__ import annotations

import zipfile
from tempfile import TemporaryDirectory

import casadi as ca
import numpy as np

from tests.peers.order import TOLERANCE, Order, answer, read_order


def rows_of(order: Order, folder: str) -> list[list[float]]:
    ((name, path),) = order.fmus.items()
    with zipfile.ZipFile(path) as archive:
        archive.extractall(folder)
    dae = ca.DaeBuilder(name, folder, {"debug": False})
    parameters = dae.get(dae.p())
    x, u = ca.MX.sym("x", dae.nx()), ca.MX.sym("u", dae.nu())
    wanted = [port.removeprefix(f"{name}.") for port in order.outputs]
    places = [(dae.y() + dae.x()).index(one) for one in wanted]
    equations = dae.create("equations", ["x", "u", "p"], ["ode", "y"])
    rates, outputs = equations(x, u, parameters)
    read = ca.Function("read", [x, u], [ca.vertcat(outputs, x)])
    advance = None
    if dae.nx():
        tolerances = {"reltol": TOLERANCE, "abstol": TOLERANCE * 1e-4}
        scale = np.array([dae.nominal(one) for one in dae.x()])
        scaled = {"x": x, "u": u, "ode": ca.substitute(rates / scale, x, x * scale)}
        advance = ca.integrator("advance", "cvodes", scaled, 0.0, order.step, tolerances)
        state = np.array(dae.start(dae.x())) / scale
    given = [list(order.inputs).index(f"{name}.{one}") for one in dae.u()]
    rows = []
    for row in order.rows():
        held = [row[i] for i in given]
        if advance is not None:
            state = advance(x0=state, u=held)["xf"].full().ravel()
        found = read(state * scale if advance is not None else [], held).full().ravel()
        rows.append([float(found[i]) for i in places])
    return rows


def main() -> None:
    order = read_order()
    if order.interface != "model-exchange":
        raise SystemExit("model exchange only")
    with TemporaryDirectory() as folder:
        answer(rows_of(order, folder))


main()
