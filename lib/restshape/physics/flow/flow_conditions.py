"""What a flow does at the edges of its shape: prescribed velocities, walls, outflow, and the datum of the pressure."""

from collections import Counter
from collections.abc import Iterator, Sequence

import numpy as np

from restshape.errors import ReplayProblem, UserError
from restshape.fem.dirichlet import Dirichlet, Prescribed
from restshape.fem.nodal_values import evaluate
from restshape.fem.sliding import Sliding
from restshape.fem.space import PlaneSpace
from restshape.scene.expressions import Value
from restshape.scene.model import Scene
from restshape.shape.outline import Outline

UNBALANCED = 0.02
"""Part of what flows through a vessel without outflow by which what comes in may differ from what goes out."""
FORCES = ("drag", "lift", "drag_coefficient", "lift_coefficient", "strouhal")
"""Quantities that are taken from the force on edges."""
NOTHING = 1e-12
"""Of a velocity, by which rounding may turn it."""
ALONG = 1e-9
"""Of what passes along the border, by which rounding may make it pass through it."""
PIECES = 50
"""Parts of each straight piece of an edge, on which the flow through it is summed up before there is a mesh."""


class FlowConditions:
    """The conditions of a scene on the border of a space.

    Args:
        scene: its boundaries and parameters.
        space: whose nodes may move; its facets stay on their edges.

    Attributes:
        dirichlet: of velocity and pressure, columns x, y, p.
        closed: there is no outflow: the pressure has a datum at one node.
        constrained_edges: names of the edges at which the velocity is prescribed.
        outflow: (k, 2) int32 facets by which the fluid leaves as it will.
        curved_slip: (k, 2) int32 facets with slip of edges that turn, or go on in others with slip.
    """

    columns = 3

    def __init__(self, scene: Scene, space: PlaneSpace) -> None:
        self.scene, self.space = scene, space
        outline = space.outline
        self._kinds = edge_kinds(scene, outline)
        self.closed = not any(table.kind == "outflow" for table in scene.boundary.values())
        self.constrained_edges = [outline.edges[k].name for k, (kind, _) in self._kinds.items() if kind != "outflow"]
        self._inlets = self.facets_of("velocity")
        conditions = [*self._walls(), *self._velocities()]
        if self.closed:
            conditions.append(Prescribed("boundary", 2, space.facets[:1, 0], 0.0))
        conditions += self._others()
        self.outflow = np.ascontiguousarray(self.facets_of("outflow"))
        self.curved_slip = np.ascontiguousarray(space.facets[self._slips(curved=True)])
        shape = (len(space.X), self.columns)
        self.dirichlet = Dirichlet(shape, conditions, scene.parameters, "m/s", self._sliding())

    def evaluate(self, time: float, balanced: bool = True) -> None:
        """Set prescribed velocities for the nodes where they lie, at a time [s].

        Args:
            balanced: as much must leave a closed vessel as flows in.

        Raises:
            UserError: two velocities meet at a node.
            ReplayProblem: a formula has no number somewhere, or more flows into a closed vessel than out of it.
        """
        self.dirichlet.parameters = {**self.scene.parameters, "t": time}
        self.dirichlet.evaluate(self.space.X)
        if self.closed and balanced:
            self._check_balance()

    def is_outflow(self, edge: int) -> bool:
        """Whether the fluid leaves by an edge of the outline as it will."""
        return self._kinds.get(edge, ("", ""))[0] == "outflow"

    def facets_of(self, kind: str) -> np.ndarray:
        """Facets (k, 2) with a condition of a kind."""
        edges = [edge for edge, (found, _) in self._kinds.items() if found == kind]
        return self.space.facets[np.isin(self.space.facet_edge, edges)]

    def fluxes(self, facets: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        """What flows out by facets (k, 2), (k,) [m^2/s], of a velocity (n, 2) of all nodes."""
        along = self.space.X[facets[:, 1]] - self.space.X[facets[:, 0]]
        mean = 0.5 * (velocity[facets[:, 0]] + velocity[facets[:, 1]])
        return mean[:, 0] * along[:, 1] - mean[:, 1] * along[:, 0]

    def enters(self, velocity: np.ndarray) -> bool:
        """Whether fluid comes in at a node of an outflow, by a velocity (n, 2) of all nodes, not by rounding alone."""
        ends = self.space.X[self.outflow]
        x, y = (ends[:, 1] - ends[:, 0]).T[:, :, None]
        here = velocity[self.outflow]
        if not len(here):
            return False
        size = np.abs(here).max() * np.sqrt((x * x + y * y).max())
        return bool((here[:, :, 0] * y - here[:, :, 1] * x).min() < -NOTHING * size)

    def slips_at(self, edge: str) -> bool:
        """Whether the fluid slips on an entity of the border."""
        return bool(np.any(self._slips()[self.space.facets_of(edge)]))

    def normal_friction(self, edge: str, x: np.ndarray) -> np.ndarray:
        """The sum (2,) of normals times what velocities x (n, >=2) grow by along each facet with slip of an entity.

        Times the viscosity it is the part n du_n/dn of the stress that the Laplace form lacks, in a flow without
        divergence.
        """
        of = self.space.facets_of(edge)
        facets = self.space.facets[of[self._slips()[of]]]
        along = self.space.X[facets[:, 1]] - self.space.X[facets[:, 0]]
        along /= np.linalg.norm(along, axis=1)[:, None]
        growth = ((x[facets[:, 1], :2] - x[facets[:, 0], :2]) * along).sum(axis=1)
        return growth @ np.column_stack([along[:, 1], -along[:, 0]])

    def _walls(self) -> Iterator[Prescribed]:
        self._wall = np.unique(self.facets_of("wall"))
        yield from (Prescribed("boundary", k, self._wall, 0.0) for k in range(2))

    def _velocities(self) -> Iterator[Prescribed]:
        for name, table in self.scene.boundary.items():
            if table.kind == "velocity":
                nodes = np.setdiff1d(self._nodes(name), self._wall)
                yield from self._components(f"boundary.{name}.velocity", nodes, table.velocity)
        self._given = np.union1d(self._wall, self._inlets)

    def _others(self) -> Iterator[Prescribed]:
        """Conditions of columns besides those of the flow."""
        return iter(())

    def _components(self, where: str, nodes: np.ndarray, values: Sequence[Value]) -> Iterator[Prescribed]:
        yield from (Prescribed(f"{where}.{k}", k, nodes, value) for k, value in enumerate(values))

    def _sliding(self) -> Sliding | None:
        """The nodes at which the fluid slips; None where it does nowhere."""
        slips = self._slips()
        if not slips.any():
            return None
        edges = self.space.facet_edge[slips]
        rounded = np.array([self.space.outline.edges[edge].kind in ("arc", "spline") for edge in edges])
        return Sliding(self.space.facets[slips], np.where(rounded, edges, -1 - np.arange(len(edges))), self._given)

    def _slips(self, curved: bool = False) -> np.ndarray:
        """On which facets (k,) the fluid slips; only those whose edge turns or goes on in another, where asked for."""
        outline = self.space.outline
        edges = [edge for edge, (kind, _) in self._kinds.items() if kind == "slip"]
        if curved:
            ends = Counter(end for k in edges for end in (outline.edges[k].start, outline.edges[k].end))
            edges = [
                k
                for k in edges
                if outline.edges[k].kind != "line" or ends[outline.edges[k].start] > 1 or ends[outline.edges[k].end] > 1
            ]
        return np.isin(self.space.facet_edge, edges)

    def _facets(self, name: str) -> np.ndarray:
        return np.unique(np.concatenate([self.space.facets_of(on) for on in self.scene.boundary[name].on]))

    def _nodes(self, name: str) -> np.ndarray:
        return np.unique(self.space.facets[self._facets(name)])

    def _check_balance(self) -> None:
        velocity = self.dirichlet.values[:, :2]
        fluxes = self.fluxes(self._inlets, velocity)
        along = self.space.X[self._inlets[:, 1]] - self.space.X[self._inlets[:, 0]]
        if unbalanced(fluxes, np.abs(velocity[self._inlets]).max(axis=(1, 2)) * np.abs(along).max(axis=1)):
            raise ReplayProblem(unequal(fluxes))


def unbalanced(fluxes: np.ndarray, sizes: np.ndarray) -> bool:
    """Whether what flows out, net, is too much beside all that flows through the border.

    Args:
        fluxes: (k,) [m^2/s] out of the vessel by parts of its border.
        sizes: (k,) of velocity times length of these: a border that moves along itself has fluxes by rounding alone.
    """
    net = abs(float(fluxes.sum()))
    return net > UNBALANCED * float(np.abs(fluxes).sum()) and net > ALONG * float(sizes.sum())


def unequal(fluxes: np.ndarray) -> str:
    """What is wrong where more flows into a vessel than out of it, for people; fluxes (k,) [m^2/s] out of it."""
    out, into = float(fluxes[fluxes > 0].sum()), float(np.abs(fluxes[fluxes < 0]).sum())
    return f"{into:.4g} m^2/s flow in and {out:.4g} m^2/s out, and there is no outflow where the rest could go"


def border(outline: Outline) -> dict[int, bool]:
    """The edges on the border of the fluid, and whether each is run along as its loop has it."""
    return {edge: forward for loop in outline.loops if loop.kind != "region" for edge, forward in loop.edges}


def edge_kinds(scene: Scene, outline: Outline) -> dict[int, tuple[str, str]]:
    """The condition of each edge of the border: its kind, and the name of its table; walls have none.

    Raises:
        UserError: an edge has two conditions, or one lies inside.
    """
    found = dict.fromkeys(border(outline), ("wall", ""))
    for name, table in scene.boundary.items():
        for on in table.on:
            for edge in outline.entity(on).edges:
                if edge not in found:
                    what = (
                        f"the edge {outline.edges[edge].name!r} of {on!r} lies inside: it is of no border of the fluid"
                    )
                    do = "name an edge of the outline, or of a hole; a solid in a fluid is a hole"
                    raise UserError(what, f"boundary.{name}.on", do)
                before = found[edge][1]
                if before not in ("", name):
                    what = f"the edge {outline.edges[edge].name!r} has two conditions, [boundary.{before}] and this one"
                    raise UserError(what, f"boundary.{name}.on", "take it out of one of them")
                found[edge] = table.kind, name
    return found


def check_shape(scene: Scene, outline: Outline) -> None:
    """Makes sure that edges have one condition each, that what flows into a closed vessel flows out of it, and that
    forces are asked for where there are some.

    Raises:
        UserError: they are not.
    """
    try:
        kinds = edge_kinds(scene, outline)
        _check_forces(scene, outline, kinds)
        settings = scene.effects.get("flow", {})
        frame = (settings.get("time_step") or 0.0) * settings.get("steps", 1)
        for time in dict.fromkeys((0.0, frame)):
            if error := balance(scene, outline, time):
                raise error
    except UserError as error:
        raise scene.located(error) from error


def balance(scene: Scene, outline: Outline, time: float) -> UserError | None:
    """The error of a vessel without outflow into which more flows at a time [s] than out of it; None of others.

    Raises:
        UserError: a formula has no number somewhere.
    """
    kinds = edge_kinds(scene, outline)
    parts = [part for edge in border(outline) for part in _parts(scene, outline, kinds, edge, time)]
    fluxes = np.concatenate([(u[:, 0] * along[1] - u[:, 1] * along[0]) / PIECES for u, along in parts] or [np.zeros(0)])
    sizes = np.array([np.abs(u).max() * np.abs(along).max() for u, along in parts])
    closed = not any(kind == "outflow" for kind, _ in kinds.values())
    if not closed or not unbalanced(fluxes, sizes):
        return None
    first = next(name for kind, name in kinds.values() if kind == "velocity")
    do = "add one, such as [boundary.outlet] with on and outflow = true, or let velocities agree"
    return UserError(unequal(fluxes), f"boundary.{first}.velocity", do)


def _check_forces(scene: Scene, outline: Outline, kinds: dict[int, tuple[str, str]]) -> None:
    for name, quantity in scene.quantities.items():
        if quantity.kind not in FORCES or quantity.at is None:
            continue
        for edge in outline.entity(quantity.at).edges:
            if kinds.get(edge, ("", ""))[0] == "outflow":
                what = f"the fluid leaves by {outline.edges[edge].name!r}, so that there is no force on it"
                raise UserError(what, f"quantities.{name}.at", "name edges that hold the fluid, such as a body")


def border_velocities(scene: Scene, outline: Outline, time: float) -> Iterator[np.ndarray]:
    """Velocities (k, 2) [m/s] on short parts of each edge that has some, at a time [s].

    Raises:
        UserError: a formula has no number somewhere.
    """
    kinds = edge_kinds(scene, outline)
    for edge in border(outline):
        yield from (velocity for velocity, _ in _parts(scene, outline, kinds, edge, time))


def _parts(
    scene: Scene, outline: Outline, kinds: dict[int, tuple[str, str]], edge: int, time: float
) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Velocities (k, 2) [m/s] on parts of each straight piece of an edge, and the piece (2,) [m]."""
    kind, name = kinds[edge]
    if kind != "velocity":
        return
    corners = outline.polyline(edge)[:: 1 if border(outline)[edge] else -1]
    places, where = (np.arange(PIECES) + 0.5) / PIECES, f"boundary.{name}.velocity"
    for start, along in zip(corners, np.diff(corners, axis=0)):
        at = start + places[:, None] * along
        try:
            yield evaluate(scene.boundary[name].velocity, at, {**scene.parameters, "t": time}, where), along
        except ReplayProblem as error:
            raise UserError(str(error).removeprefix(f"{where}: "), where, "change the formula") from error
