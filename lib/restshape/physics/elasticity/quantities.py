"""Quantities of interest: numbers that a scene asks for, taken from a solid's displacement."""

from collections.abc import Callable
from functools import cached_property

import numpy as np

from restshape import _kernels
from restshape.errors import UserError
from restshape.mesh.mesh import Mesh
from restshape.physics.elasticity.target_curves import GoalDistance
from restshape.fem.averages import mean_over
from restshape.fem.entity_sets import observed_nodes
from restshape.fem.recovery import NodalStress
from restshape.physics.elasticity.plane_solid import PlaneSolid
from restshape.scene.model import Quantity


def largest(values: np.ndarray) -> float:
    """The largest size among values."""
    return np.max(np.abs(values))


# Of a single solution the peak over a frame's time steps is its largest size.
TAKES = {"max": np.max, "min": np.min, "mean": np.mean, "sum": np.sum, "absmax": largest, "peak": largest}


def von_mises(s: np.ndarray) -> np.ndarray:
    """Equivalent stresses (n,) [Pa] of plane stress states s (n, 4): xx, yy, xy, zz."""
    xx, yy, xy, zz = s.T
    return np.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3.0 * xy**2)


def principal(s: np.ndarray, sign: float) -> np.ndarray:
    """The larger (sign 1) or smaller (sign -1) in-plane principal stresses (n,) [Pa] of states s (n, 4)."""
    xx, yy, xy, _ = s.T
    return 0.5 * (xx + yy) + sign * np.hypot(0.5 * (xx - yy), xy)


COMPONENTS: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "xx": lambda s: s[:, 0],
    "yy": lambda s: s[:, 1],
    "xy": lambda s: s[:, 2],
    "von_mises": von_mises,
    "max_principal": lambda s: principal(s, 1.0),
    "min_principal": lambda s: principal(s, -1.0),
}


def area(mesh: Mesh, cells: np.ndarray | slice = slice(None)) -> float:
    """The area [m^2] of cells of a mesh, at rest."""
    return _kernels.total_area(mesh.X, mesh.cells[cells])


def areas(mesh: Mesh, quantities: dict[str, Quantity]) -> dict[str, float]:
    """The quantities that the mesh alone tells, which are areas, by name; not a number for all others."""
    known = {name: mesh.cells_of(q.at) if q.at else slice(None) for name, q in quantities.items() if q.area}
    return {name: area(mesh, known[name]) if name in known else np.nan for name in quantities}


class Observer:
    """Evaluates the quantities of a scene for a solid on its mesh.

    Stresses are recovered at nodes; at a node between materials each side has its own, and a quantity of a region takes
    that region's.

    Args:
        physics: the solid, on the mesh whose nodes are looked at.
        quantities: by name, as in the scene.

    Raises:
        UserError: a quantity names a place where it has no meaning.
    """

    def __init__(self, physics: PlaneSolid, quantities: dict[str, Quantity]) -> None:
        self.physics, self.mesh = physics, physics.mesh
        self.functions = {name: self._function(name, quantity) for name, quantity in quantities.items()}
        self._nodal: np.ndarray | None = None
        self._cells: dict[str, tuple[int, np.ndarray]] = {}

    def __call__(self, x: np.ndarray) -> dict[str, float]:
        """All quantities at the displacement x (n, 2) [m]."""
        self._nodal = None
        return {name: float(function(x)) for name, function in self.functions.items()}

    @cached_property
    def recovery(self) -> NodalStress:
        """What recovers stresses at nodes, made where a quantity is one."""
        return NodalStress(self.mesh)

    def nodal_stress(self, x: np.ndarray) -> np.ndarray:
        """Recovered stresses [Pa] at the nodes, in the rows of `recovery`, computed once a frame."""
        if self._nodal is None:
            self._nodal = self.recovery(self.physics.stress(x, self.recovery.points))
        return self._nodal

    def _function(self, name: str, quantity: Quantity) -> Callable[[np.ndarray], float]:
        if quantity.area or quantity.energy:
            cells = self._region(name, quantity)
            if quantity.area:
                return lambda x: area(self.mesh, cells)
            return self._energy(name, quantity.energy, cells)
        if quantity.distance:
            return self._distance(name, quantity)
        if quantity.frequency or quantity.mode:
            raise UserError(
                "only free vibrations have frequencies",
                f"quantities.{name}",
                'leave it out, or use app = "metallophone"',
            )
        if quantity.load_factor:
            raise UserError(
                "without buckling there are no load factors",
                f"quantities.{name}.load_factor",
                'leave it out, or add [effects.buckling] to a scene of app = "solid"',
            )
        nodes = observed_nodes(self.mesh, name, quantity)
        take = TAKES[quantity.take]
        if quantity.reaction:
            column = "xy".index(quantity.reaction)
            return lambda x: self.physics.reaction(x, nodes, self._around(name, nodes))[:, column].sum()
        if quantity.stress:
            component = COMPONENTS[quantity.stress]
            cells = self.mesh.cells_of(quantity.at) if quantity.at else np.empty(0, dtype=np.int32)
            rows = self.recovery.rows(nodes, cells)
            if quantity.take == "mean":
                take = mean_over(self.mesh, quantity.at, self.recovery.nodes[rows])
            return lambda x: take(component(self.nodal_stress(x)[rows]))
        if quantity.take == "mean":
            take = mean_over(self.mesh, quantity.at, nodes)
        if quantity.displacement == "magnitude":
            return lambda x: take(np.hypot(x[nodes, 0], x[nodes, 1]))
        column = "xy".index(quantity.displacement)
        return lambda x: take(x[nodes, column])

    def _energy(self, name: str, kind: str, cells: np.ndarray | slice) -> Callable[[np.ndarray], float]:
        """The energy of that kind in the cells; a solid at rest has one kind only."""
        if kind != "strain":
            raise UserError(f"a solid at rest has no {kind!r} energy", f"quantities.{name}.energy", 'use "strain"')
        return lambda x: self.physics.energies(x)[cells].sum()

    def _distance(self, name: str, quantity: Quantity) -> Callable[[np.ndarray], float]:
        """The distance between a goal and the deformed edges."""
        at = quantity.at or "outline"
        facets = self.mesh.facets[self.mesh.facets_of(at)]
        if len(facets) == 0:
            raise UserError(f"{at!r} has no edge", f"quantities.{name}.at", "name an edge, a hole or a group of them")
        distance = GoalDistance(self.physics.scene.goal[quantity.distance], facets, quantity.take)
        return lambda x: distance(self.mesh.X + x)

    def _around(self, name: str, nodes: np.ndarray) -> np.ndarray:
        """The cells around the nodes of a quantity, found once a topology."""
        version, cells = self._cells.get(name, (None, None))
        if version != self.mesh.topology:
            cells = self.physics.cells_around(nodes)
            self._cells[name] = (self.mesh.topology, cells)
        return cells

    def _region(self, name: str, quantity: Quantity) -> np.ndarray | slice:
        if quantity.at is None:
            return slice(None)
        cells = self.mesh.cells_of(quantity.at)
        if len(cells) == 0:
            raise UserError(f"{quantity.at!r} holds no cell of the mesh", f"quantities.{name}.at", "name a region")
        return cells
