"""What marks of shapes look at: the last frame of a simulation, with what it shows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from restshape.arrays import Indices, Reals
    from restshape.fem.space import PlaneSpace
    from restshape.interface.shown_frame import ShownFrame
    from restshape.interface.simulation import Simulation
    from restshape.scene.model import Scene

IN_PLANE = (3, 6)
"""Nodes of the cells of meshes in the plane."""


@dataclass(eq=False, slots=True)
class SeenFrame:
    """The last frame of a simulation of a shape.

    Args:
        frame: its row and its fields; scene: the values that hold in it.
        space: on whose nodes its fields are, and which knows the outline's names.
        deformed: displacements (n, 2) or (n, 3) [m] of the nodes; None where it has none.
        solved: it shows an answer, its own or one that is predicted.
    """

    frame: ShownFrame
    scene: Scene
    space: PlaneSpace
    deformed: Reals | None
    solved: bool = True

    @classmethod
    def of(cls, simulation: Simulation) -> SeenFrame:
        """The last frame of a simulation."""
        frame, replay = simulation.frame, simulation.replay
        solver, at_nodes = replay.solver, frame.fields_apart[0]
        # Shapes that have marks by their nodes lie in the plane: other sessions have marks of their own.
        space: PlaneSpace = solver.space  # type: ignore[assignment]
        return cls(frame, replay.session.scene, space, at_nodes.get("displacement"), solver.known)

    @property
    def all_nodes_drawn(self) -> bool:
        """Whether the picture has all nodes of the mesh, as that of triangles; of bodies in space it has the skin's."""
        return self.space.cells.shape[1] in IN_PLANE

    def moved(self, nodes: Indices) -> Reals | None:
        """The displacements [m] of nodes; None where there are none to be drawn."""
        return None if self.deformed is None or not self.solved else self.deformed[nodes]

    def places(self, nodes: Indices) -> Reals:
        """The places [m] of nodes at rest, with as many components as their displacements have."""
        X = self.space.X[nodes]
        if self.deformed is None or self.deformed.shape[1] <= X.shape[1]:
            return X
        found = np.zeros((*X.shape[:-1], self.deformed.shape[1]))
        found[..., : X.shape[-1]] = X
        return found
