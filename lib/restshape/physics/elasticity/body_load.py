"""Forces on the volume of a plane solid: its weight, and body loads that a scene gives."""

import numpy as np

from restshape.errors import UserError
from restshape.fem.elements import MASS
from restshape.fem.entity_sets import cells_on
from restshape.fem.nodal_values import evaluate, rates, varies
from restshape.fem.space import Space
from restshape.scene.model import Load, Scene


class BodyLoads:
    """Body forces of a scene: those that are constant in each cell, and those that are interpolated between nodes.

    Args:
        scene: its loads.
        space: whose cells they act in.
        thickness: (regions + 1,) [m].

    Attributes:
        of_cells: loads that cells have as parameters; of_nodes: those that vary inside cells of second order.
    """

    def __init__(self, scene: Scene, space: Space, thickness: np.ndarray) -> None:
        self.scene, self.space, self._thickness = scene, space, thickness
        given = [(name, load) for name, load in scene.loads.items() if load.body is not None]
        # Of second order a body force is interpolated like the displacement, or the answer would be of first order.
        smooth = space.cells.shape[1] == 6
        self.of_cells = [(name, load) for name, load in given if not (smooth and varies(load.body))]
        self.of_nodes = [(name, load) for name, load in given if smooth and varies(load.body)]
        self.varies = any(varies(load.body) for _, load in given)
        self._consistent = MASS["tri6"] if self.of_nodes else None

    def add_to_cells(self, params: np.ndarray) -> None:
        """Add the forces (ne, 2) [N/m^3] on cells to the columns 3 and 4 of parameters (ne, p)."""
        for name, load in self.of_cells:
            cells = cells_on(self.space, load.on)
            centres = self.space.X[self.space.corners[cells]].mean(axis=1)
            params[cells, 3:] += evaluate(load.body, centres, self.scene.parameters, f"loads.{name}.body")

    def cell_rates(self, dX: np.ndarray, width: int) -> np.ndarray | None:
        """Rates (ne, width) of the parameters of cells when nodes move with dX (n, 2); None where there are none.

        Without stiffness the element's residual is that of its body force alone.
        """
        if not self.of_cells:
            return None
        space = self.space
        params = np.zeros((len(space.cells), width))
        params[:, 2] = self._thickness[space.cell_region]
        for name, load in self.of_cells:
            cells = cells_on(space, load.on)
            corners = space.corners[cells]
            places = space.X[corners].mean(axis=1), dX[corners].mean(axis=1)
            params[cells, 3:] += rates(load.body, *places, self.scene.parameters, f"loads.{name}.body")
        return params

    def add_to_nodes(self, out: np.ndarray, sign: float, subset: np.ndarray | None = None) -> None:
        """Add `sign` times the forces that are interpolated between nodes to `out` (n, 2) [N].

        Args:
            subset: (k,) cells that alone count; None: all.
        """
        if not self.of_nodes:
            return
        space, total = self.space, np.zeros_like(out)
        thickness = np.ascontiguousarray(self._thickness[space.cell_region][:, None])
        for name, load in self.of_nodes:
            cells = cells_on(space, load.on)
            cells = cells if subset is None else np.intersect1d(cells, subset)
            nodes = np.unique(space.cells[cells])
            force = np.zeros_like(space.X)
            force[nodes] = self._value(name, load, nodes)
            self._consistent.residual(space.X, force, space.cells, thickness, total, cells)
        out += sign * total

    def add_node_rates(self, dX: np.ndarray, out: np.ndarray) -> None:
        """Take the rates of the same forces when nodes move with dX (n, 2) from `out` (n, 2) [N]."""
        space = self.space
        for name, load in self.of_nodes:
            chosen = cells_on(space, load.on)
            cells = np.ascontiguousarray(space.cells[chosen])
            share = np.ascontiguousarray(self._thickness[space.cell_region][chosen, None])
            nodes, where = np.unique(cells), f"loads.{name}.body"
            force, force_rate, total = np.zeros((3, *out.shape))
            force[nodes] = self._value(name, load, nodes)
            force_rate[nodes] = rates(load.body, space.X[nodes], dX[nodes], self.scene.parameters, where)
            self._consistent.design(space.X, dX, force, cells, share, total, dx=force_rate)
            out -= total

    def _value(self, name: str, load: Load, nodes: np.ndarray) -> np.ndarray:
        return evaluate(load.body, self.space.X[nodes], self.scene.parameters, f"loads.{name}.body")


def require_density(scene: Scene, gravity: np.ndarray | None) -> None:
    """Refuse gravity on a material without density; one that is said to be 0 is none where another has weight.

    Raises:
        UserError: gravity (2,) [m/s^2] is on, and some material has none.
    """
    if gravity is None or not np.any(gravity):
        return
    materials = scene.material.values()
    heavy = any(material.rho for material in materials)
    for name, material in scene.material.items():
        if not material.rho and not (heavy and "rho" in material.model_fields_set):
            do = 'give it one, e.g. rho = "7850 kg/m^3", or leave out [effects.gravity]'
            raise UserError("gravity is on, but the material has no density", f"material.{name}", do)
