"""How far the fields of two recordings are from each other: node by node, or sampled where the meshes differ."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from restshape.arrays import Indices, Reals
from restshape.comparison.series_difference import Gathered, SeriesDifference
from restshape.mesh.transfer import Transfer
from restshape.replay.recording.recording import Recording

SAME, SAMPLED, OTHER = "same cells", "sampled", "other meshes"
"""How fields of a frame are compared: node by node, at nodes of the first mesh that lie in the second, not at all."""
TRIANGLES = {3: "tri3", 6: "tri6"}
WITHIN = 1e-9
"""Of the size of a mesh: a point that is farther from where it was found lies outside."""


class RecordedMesh(NamedTuple):
    """The mesh of a frame, as `Transfer` searches it."""

    X: Reals
    cells: Indices
    cell_type: str
    dim: int = 2

    @property
    def corners(self) -> Reals:
        """Nodes at the corners of the cells."""
        return np.ascontiguousarray(self.cells[:, :3])


@dataclass(frozen=True)
class FieldDifferences:
    """The differences of all fields.

    Args:
        ways: frames by how they were compared: `SAME`, `SAMPLED` and `OTHER`.
        points: of the nodes [m], in frames with the same cells.
        fields: of each field that both have.
        alone: names of fields that one of them has only, or with other components.
    """

    ways: dict[str, int]
    points: SeriesDifference
    fields: list[SeriesDifference]
    alone: list[str]


def field_differences(first: Recording, second: Recording) -> FieldDifferences:
    """The differences of the fields of two recordings, in the frames that both have."""
    names = [name for name in first.fields if name in second.fields and _same_kind(name, first, second)]
    gathered, points = {name: Gathered(name) for name in names}, Gathered("points")
    ways = dict.fromkeys((SAME, SAMPLED, OTHER), 0)
    for i in range(min(first.n, second.n)):
        known = [name for name in names if max(one.fields[name].first_frame for one in (first, second)) <= i]
        cells = first.cells(i), second.cells(i)
        if first.cell_type(i) == second.cell_type(i) and np.array_equal(*cells):
            ways[SAME] += 1
            points.add(i, first.points(i), second.points(i))
            for name in known:
                gathered[name].add(i, first.field(i, name), second.field(i, name))
            continue
        transfer = _transfer(first, second, i)
        ways[SAMPLED if transfer else OTHER] += 1
        if transfer is None:
            continue
        inside, sampled = transfer
        for name in known:
            if first.fields[name].where == "point_data":
                values = second.field(i, name)
                there = sampled(values.reshape(len(values), -1)).reshape(-1, *values.shape[1:])
                gathered[name].add(i, first.field(i, name)[inside], there[inside])
    found = [one.difference() for one in gathered.values()]
    alone = sorted({*first.fields, *second.fields} - set(names))
    return FieldDifferences(ways, points.difference(), found, alone)


def _same_kind(name: str, first: Recording, second: Recording) -> bool:
    """Whether a field has values at the same places, and as many components, in both recordings."""
    one, other = first.fields[name], second.fields[name]
    return (one.where, one.components) == (other.where, other.components)


def _transfer(first: Recording, second: Recording, i: int) -> tuple[Reals, Transfer] | None:
    """What interpolates fields of the second mesh to nodes of the first, and which of these lie in it."""
    X, cells = second.mesh(i)
    kind = TRIANGLES.get(cells.shape[1])
    if first.dimension != 2 or second.dimension != 2 or kind is None or not len(cells):
        return None
    at = first.points(i)
    transfer = Transfer(RecordedMesh(X, cells, kind), at)
    far = np.linalg.norm(transfer(X) - at, axis=1)
    inside = far <= WITHIN * float(np.ptp(X, axis=0).max())
    return (inside, transfer) if inside.any() else None
