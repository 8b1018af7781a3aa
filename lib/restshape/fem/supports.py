"""The Dirichlet conditions that a scene's supports make."""

from collections.abc import Sequence

from restshape.fem.dirichlet import Dirichlet, Prescribed
from restshape.fem.entity_sets import nodes_on
from restshape.fem.problem import Unknown
from restshape.fem.space import Space
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
