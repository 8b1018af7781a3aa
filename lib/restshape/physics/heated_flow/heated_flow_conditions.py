"""What a fluid that heat enters does at the edges of its shape: its flow's conditions, and temperatures."""

from collections.abc import Iterator

import numpy as np

from restshape.fem.dirichlet import Prescribed
from restshape.fem.space import PlaneSpace
from restshape.physics.flow.flow_conditions import FlowConditions
from restshape.scene.expressions import Value
from restshape.scene.model import Scene


def warm_edges(scene: Scene) -> list[str]:
    """Names of the edges at which the temperature is prescribed."""
    return [*given_temperatures(scene)]


def given_temperatures(scene: Scene) -> dict[str, tuple[str, Value]]:
    """The edges at which the temperature is prescribed by name, with where the scene gives it, and the value."""
    return {
        on: (f"boundary.{name}.temperature", table.temperature)
        for name, table in scene.boundary.items()
        if table.temperature is not None
        for on in table.on
    }


def prescribed_temperatures(scene: Scene, space: PlaneSpace, column: int) -> Iterator[Prescribed]:
    """The temperatures of the border as conditions on a column; a corner has that of the table that comes first."""
    taken = np.empty(0, dtype=np.int32)
    for name, table in scene.boundary.items():
        if table.temperature is None:
            continue
        nodes = np.unique(space.facets[np.concatenate([space.facets_of(on) for on in table.on])])
        yield Prescribed(
            f"boundary.{name}.temperature", column, np.setdiff1d(nodes, taken).astype(np.int32), table.temperature
        )
        taken = np.union1d(taken, nodes)


class HeatedFlowConditions(FlowConditions):
    """The conditions of a scene on the border of a space, temperatures in the column after x, y and p."""

    columns = 4

    def _others(self) -> Iterator[Prescribed]:
        return prescribed_temperatures(self.scene, self.space, 3)
