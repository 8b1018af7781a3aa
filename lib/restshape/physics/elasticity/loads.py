"""Loads on points, edges and the volume of a plane solid."""

import numpy as np

from restshape.fem.elements import PRESSURE, TRACTION
from restshape.fem.entity_sets import facets_on, nodes_on
from restshape.fem.facets import SHAPES
from restshape.fem.integral import Integral
from restshape.fem.nodal_values import evaluate, rates
from restshape.fem.space import Space
from restshape.physics.elasticity.body_load import BodyLoads
from restshape.physics.elasticity.facet_load import FacetLoad
from restshape.scene.model import Load, Scene


class PlaneLoads:
    """All loads of a scene on one space.

    Args:
        scene: its loads.
        space: whose nodes may move.
        thickness: (regions + 1,) [m].
        follow: pressures act on the deformed boundary.

    Attributes:
        tractions: dead loads on edges; followers: pressures that act on the deformed boundary.
        points: loads on points, by name; body: those on the volume.
        varies: whether a value changes when nodes move.
    """

    def __init__(self, scene: Scene, space: Space, thickness: np.ndarray, follow: bool) -> None:
        self.scene, self.space = scene, space
        self.body = BodyLoads(scene, space, thickness)
        surface = {name: load for name, load in scene.loads.items() if load.body is None}
        on_edges = {name: len(facets_on(space, load.on)) > 0 for name, load in surface.items()}
        share = thickness[space.cell_region[space.facet_cell]]
        edges = [
            FacetLoad(name, load, space, share, scene.parameters) for name, load in surface.items() if on_edges[name]
        ]
        self.tractions = [part for part in edges if not (follow and part.load.pressure is not None)]
        self.followers = [part for part in edges if follow and part.load.pressure is not None]
        self.points: list[tuple[str, Load]] = [(name, surface[name]) for name in surface if not on_edges[name]]
        self.varies = self.body.varies or any(part.varies for part in edges)
        shape = SHAPES[space.cells.shape[1]][1]
        self._traction, self._pressure = TRACTION[shape], PRESSURE[shape]

    def update(self) -> None:
        """Evaluate the loads on edges where the nodes are now."""
        for part in (*self.tractions, *self.followers):
            part.update(self.space.X)

    def on_edges(self) -> list[Integral]:
        """The dead loads on edges."""
        X = self.space.X
        return [
            Integral(self._traction, X, p.facets, p.params, block=None, rate=lambda dX, p=p: p.rate(X, dX))
            for p in self.tractions
        ]

    def follower(self, part: float = 1.0) -> list[Integral]:
        """The pressures on the deformed boundary, or a part of them."""
        # A part of the thickness takes a part of the load.
        X = self.space.X
        return [
            Integral(
                self._pressure,
                X,
                p.facets,
                p.pressure_params * (1.0, 1.0, part),
                block=block,
                rate=lambda dX, p=p: np.ascontiguousarray(p.rate(X, dX)[:, 4:]),
            )
            for block, p in enumerate(self.followers, 1)
        ]

    def add_nodal(self, out: np.ndarray, sign: float, cells: np.ndarray | None = None) -> None:
        """Add `sign` times the loads on points, and on the volume between nodes, to `out` (n, 2) [N].

        Args:
            cells: (k,) int32; loads inside of others are left out.
        """
        for name, load in self.points:
            nodes = nodes_on(self.space, load.on)
            force = evaluate(load.force, self.space.X[nodes], self.scene.parameters, f"loads.{name}.force")
            out[nodes] += sign / len(nodes) * force
        self.body.add_to_nodes(out, sign, cells)

    def add_nodal_rates(self, dX: np.ndarray, out: np.ndarray) -> None:
        """Take the rates of the same loads when nodes move with rates dX (n, 2) from `out` (n, 2) [N]."""
        self.body.add_node_rates(dX, out)
        for name, load in self.points:
            nodes = nodes_on(self.space, load.on)
            where, places = f"loads.{name}.force", (self.space.X[nodes], dX[nodes])
            out[nodes] -= rates(load.force, *places, self.scene.parameters, where) / len(nodes)
