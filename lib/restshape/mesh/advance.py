"""What the advance of a moving mesh by a frame gives."""

from dataclasses import dataclass, field

import numpy as np

from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.mesh.mesh import Mesh
from restshape.mesh.reach import MovingPart

NO_CELLS = np.empty(0, dtype=np.int32)


@dataclass(slots=True)
class MeshUpdate:
    """What a frame did to the mesh.

    Args:
        level: 0 idle, 1 relocation, 2 reconnection, 3 reconstruction.
        flips: number of flipped edges.
        changed_cells: cells (int32, ascending) of the mesh of the fields whose nodes changed by flips.
        min_quality: smallest quality of a triangle afterwards, 1 for equilateral; of nested meshes in the coarsest.
        old_mesh: level 3, and level 2 of nested meshes, of which flips make others: the mesh of the fields before,
            where it could be relocated to the new shape, else as it lay.
        stages: seconds spent in "relocate", "map", "flip" and "mesh".
        part: what alone moves while it is the same, where it is worth being solved for by itself; None: everything.
    """

    level: int
    flips: int
    changed_cells: np.ndarray
    min_quality: float
    old_mesh: Mesh | LagrangeSpace | None = None
    stages: dict[str, float] = field(default_factory=dict)
    part: MovingPart | None = None

    @classmethod
    def nothing(cls, min_quality: float = float("nan")) -> "MeshUpdate":
        """An idle frame."""
        return cls(0, 0, NO_CELLS, min_quality)


CONNECTIVITY = ("cells", "cell_edges", "edge_nodes", "facet_cell")
"""Arrays of a mesh that flips change."""
