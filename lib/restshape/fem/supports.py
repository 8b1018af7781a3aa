"""The Dirichlet conditions that a scene's supports make."""

from collections.abc import Sequence

import numpy as np

from restshape.fem.dirichlet import Dirichlet, Prescribed
from restshape.fem.entity_sets import facets_on, nodes_on
from restshape.fem.problem import Unknown
from restshape.fem.space import PlaneSpace, Space
from restshape.scene.model import Scene


def dirichlet_of(scene: Scene, space: Space, unknowns: Sequence[Unknown]) -> Dirichlet:
    """The prescribed unknowns of a space, not evaluated yet.

    Args:
        scene: its supports name components of the unknowns.
        space: where they are.
        unknowns: fields of each node, in the order of the columns.
    """
    columns = [component for unknown in unknowns for component in unknown.components]
    conditions = [
        Prescribed(f"supports.{name}.fix.{axis}", columns.index(axis), nodes, value)
        for name, support in scene.supports.items()
        for nodes in [nodes_on(space, support.on)]
        for axis, value in support.fix.items()
    ]
    return Dirichlet((len(space.X), len(columns)), conditions, scene.parameters, unknowns[0].unit)


def scalar_dirichlet_of(scene: Scene, space: PlaneSpace, unknown: Unknown) -> Dirichlet:
    """The same of one unknown that may jump at corners: where edges meet the support that comes first holds."""
    conditions, before = [], list[tuple[np.ndarray, np.ndarray]]()
    for name, support in scene.supports.items():
        nodes, facets = nodes_on(space, support.on), facets_on(space, support.on)
        for taken, others in before:
            if len(facets) and len(others) and not np.intersect1d(facets, others).size:
                nodes = np.setdiff1d(nodes, taken)
        before.append((nodes, facets))
        conditions += [
            Prescribed(f"supports.{name}.fix.{axis}", 0, nodes.astype(np.int32), value)
            for axis, value in support.fix.items()
        ]
    return Dirichlet((len(space.X), 1), conditions, scene.parameters, unknown.unit)
