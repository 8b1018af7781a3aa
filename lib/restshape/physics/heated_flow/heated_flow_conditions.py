"""What a fluid that heat enters does at the edges of its shape: its flow's conditions, and temperatures."""

from collections.abc import Iterator

import numpy as np

from restshape.errors import UserError
from restshape.fem.dirichlet import Prescribed
from restshape.fem.space import PlaneSpace
from restshape.physics.flow.flow_conditions import FlowConditions, edge_kinds
from restshape.scene.expressions import Value
from restshape.scene.model import Quantity, Scene
from restshape.shape.outline import Outline


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


def check_heated_shape(scene: Scene, outline: Outline) -> None:
    """Makes sure that heat fluxes that are given are not divided by differences that are, and that fluid passes edges
    whose bulk temperature is asked for.

    Raises:
        UserError: they are, or none does.
    """
    try:
        for name, one in scene.quantities.items():
            check_edge(scene, outline, name, one)
    except UserError as error:
        raise scene.located(error) from error


def check_edge(scene: Scene, outline: Outline, name: str, quantity: Quantity) -> None:
    """The same of one quantity.

    Raises:
        UserError: without the line of the scene.
    """
    if quantity.kind == "bulk_temperature":
        kinds = edge_kinds(scene, outline)
        if not any(kinds.get(k, ("", ""))[0] in ("velocity", "outflow") for k in outline.entity(quantity.at).edges):
            what = f"no fluid passes {quantity.at!r}, so that it has no bulk temperature"
            raise UserError(what, f"quantities.{name}.at", "name an edge with a velocity or an outflow")
    if quantity.kind != "nusselt" or quantity.nusselt.difference is None:
        return
    given = {
        edge
        for table in scene.boundary.values()
        if table.heat_flux is not None
        for on in table.on
        for edge in outline.entity(on).edges
    }
    if given.intersection(outline.entity(quantity.at).edges):
        what = f"the heat flux at {quantity.at!r} is given, and so would be all of a Nusselt number with a difference"
        do = 'give in place of the difference where the other temperature is, as in against = "all"'
        raise UserError(what, f"quantities.{name}.nusselt", do)


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
