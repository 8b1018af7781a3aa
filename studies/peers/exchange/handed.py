"""What a peer is handed over: meshes and moved places of an edit as arrays, and the numbers of its physics."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np


@dataclass(frozen=True)
class HandedMesh:
    """Triangles with the border's pieces by name.

    Args:
        points: (n, 2) [m] places of the nodes.
        cells: (ne, 3) nodes of each triangle, counter-clockwise.
        facets: by outline edge, (k, 2) nodes of the border's sides.
    """

    points: np.ndarray
    cells: np.ndarray
    facets: dict[str, np.ndarray]

    def nodes_on(self, *names: str) -> np.ndarray:
        """Nodes on these pieces of the border, ascending."""
        return np.unique(np.concatenate([self.facets[name].ravel() for name in names]))


@dataclass(frozen=True)
class HandedCase:
    """A case of a folder that `restshape bench peers` has written.

    Args:
        problem: its name, such as "static"; parameters: numbers and names of its physics, in SI units.
        meshes: that occur; mesh_of: of each frame, their number; places: of each frame, (n, 2) [m].
    """

    problem: str
    parameters: dict
    meshes: list[HandedMesh]
    mesh_of: list[int]
    places: list[np.ndarray]


def read_case(folder: Path) -> HandedCase:
    """The case of a folder: ``case.json`` and ``arrays.npz``."""
    case = json.loads((folder / "case.json").read_text())
    arrays = np.load(folder / "arrays.npz")
    places = [arrays[f"places_{k}"] for k in range(len(case["mesh_of"]))]
    meshes = []
    for number in range(max(case["mesh_of"]) + 1):
        facets = {name: arrays[f"facets_{number}_{name}"].astype(np.int64) for name in case["edges"]}
        first = places[case["mesh_of"].index(number)]
        meshes.append(HandedMesh(first, arrays[f"cells_{number}"].astype(np.int64), facets))
    return HandedCase(case["problem"], case["parameters"], meshes, case["mesh_of"], places)
