"""Creeping flow by Taylor and Hood's elements, as a problem on a `MixedSpace`, beside a closed form."""

import numpy as np

from restshape.analysis.static.steady import SteadyAnalysis
from restshape.fem.dirichlet import Dirichlet, Prescribed
from restshape.fem.elements import STOKES
from restshape.fem.integral import Integral
from restshape.fem.mixed import MixedSpace
from restshape.fem.observer import Observer
from restshape.fem.problem import INTERNAL, STIFFNESS, SteadyProblem, Unknown
from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.scene.expressions import Expression

VISCOSITY = 0.1
FLOW = ("(sin(y) + y*cos(y))*exp(x)", "-y*sin(y)*exp(x)", "-0.2*exp(x)*sin(y)")
"""Velocity and pressure of the stream function y e^x sin y, which needs no body force at this viscosity."""


class Stokes(SteadyProblem):
    """Creeping flow whose velocity is prescribed on the whole boundary, and whose pressure is at a corner."""

    name = "stokes"
    unknowns = (Unknown("velocity", "m/s", ("x", "y")), Unknown("pressure", "Pa", ("p",)))
    symmetric, definite, linear, varies, loaded_inside = True, False, True, True, False

    def __init__(self, scene, plan, base: LagrangeSpace) -> None:
        self.element = STOKES[base.cell_type]
        self.space = MixedSpace(base, self.element.layout)
        velocity = self.space.rows("velocity", np.unique(base.facets))
        pressure = self.space.rows("pressure", base.corner_number[base.mesh.vertex_node[:1]])
        parts = zip(("x", "y", "p"), (velocity[:, 0], velocity[:, 1], pressure[:, 0]), FLOW)
        given = [Prescribed(f"flow.{name}", 0, rows, Expression(value)) for name, rows, value in parts]
        self.boundary = Dirichlet((len(self.space.node), 1), given, {})
        self.update()

    def update(self) -> None:
        self.boundary.evaluate(self.space.dof_X)

    def blocks(self):
        return [(self.space.cells, self.space.dofs)]

    def integrals(self, kind, part=1.0):
        if kind not in (INTERNAL, STIFFNESS):
            return []
        parameters = np.array([VISCOSITY, 0.0, 0.0])
        return [Integral(self.element, self.space.X, self.space.cells, parameters, dofs=self.space.dofs)]

    def observer(self, quantities):
        return Observer({"drop": lambda x: float(np.ptp(self.space.values("pressure", x)))})

    def fields(self, x):
        pressure = np.full(len(self.space.X), np.nan)
        pressure[self.space.base.corner_number] = self.space.values("pressure", x)[:, 0]
        return {"velocity": self.space.values("velocity", x), "pressure": pressure}, {}


def stokes_analysis(scene, plan, context) -> SteadyAnalysis:
    """The flow in the shape of any scene whose elements are of second order."""
    return SteadyAnalysis(scene, plan, context, Stokes)


def flow(X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Velocity (n, 2) and pressure (n,) at places (n, 2)."""
    x, y = X.T
    velocity = np.column_stack([np.sin(y) + y * np.cos(y), -y * np.sin(y)]) * np.exp(x)[:, None]
    return velocity, -2 * VISCOSITY * np.exp(x) * np.sin(y)
