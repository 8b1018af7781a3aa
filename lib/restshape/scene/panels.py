"""Several outlines of one scene: ``[panels.NAME]``, laid side by side in one pattern plane."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Literal, NamedTuple, Self

from pydantic import Field, RootModel, model_validator

from restshape.errors import UserError
from restshape.scene.dart_keys import IMAGE
from restshape.scene.descriptions import listing
from restshape.scene.model import CircleLoop, EdgeLoop, PolygonLoop, ShapeSpec
from restshape.scene.pattern_packing import PanelFrame, Where, bounds, packed, with_bulge
from restshape.scene.shape_edges import ArcSpec, EdgePart, LineSpec
from restshape.scene.space_values import ORIGIN, Angles, Place
from restshape.scene.unfolding import unfolded
from restshape.scene.units import UnitError
from restshape.scene.values import Angle, Length, Point

if TYPE_CHECKING:
    from restshape.scene.model import Scene

QUARTER = 2.0**0.5 - 1.0
"""tan(angle / 4) of a quarter of a circle."""


# More than 15 attributes: each is a key of a table.
class Panel(ShapeSpec):
    """``[panels.NAME]``: a piece of the pattern with the keys of ``[shape]``, in coordinates of its own.

    Elsewhere its parts are named ``NAME.PART``. In space it is turned about x, then y, then z through ``about``, then
    moved.

    Args:
        at: where its origin lies in the pattern plane; left out, it is packed in rows with the others.
        angle: by which it is turned in the pattern plane, about its origin.
        move: displacement in space, after it is turned.
        turn: angles in space about x, then y, then z.
        about: the point in space that stays where it is turned, and the one that it is wrapped about.
        around: body that it is wrapped on, before it is turned: its y runs along the axis of the body, its x around
            it, from the front (-y) to the right, with all lengths kept.
        radius: of the cylinder that it is wrapped on; left out, that of the body and 10 mm.
        grain: angle of the grain from its own x axis; left out, that of its material.
        mirror: straight edge around it that it is unfolded about: it is cut on the fold. Parts of the other half are
            named ``mirror.PART``.
        material: name of its material; left out, the one that no region and no panel names.
        layer: panels of a larger one lie outside of those of a smaller one, seen from the bodies; left out, it has no
            place among them.
    """

    at: Point | None = None
    angle: Angle = 0.0
    move: Place = ORIGIN
    turn: Angles = ORIGIN
    about: Place = ORIGIN
    around: str | None = None
    radius: Annotated[Length, Field(gt=0)] | None = None
    grain: Angle | None = None
    mirror: str | None = None
    material: str | None = None
    layer: int | None = None

    @model_validator(mode="after")
    def _is_written_out(self) -> Self:
        if self.file is not None:
            raise UnitError("a panel is read from no file", "write its vertices, edges and outline")
        return self


class PatternLayout(RootModel[Literal["auto"]]):
    """``layout = "auto"``: all panels are packed in rows, wherever they say that they lie."""


class PanelShape(ShapeSpec):
    """All panels of a scene in the pattern plane, as one shape of several outlines.

    Args:
        outlines: names of the edges around each panel, by its name.
        frames: where each panel's own coordinates lie.
    """

    outlines: dict[str, list[str]]
    frames: dict[str, PanelFrame]

    def panel_frames(self) -> Mapping[str, PanelFrame]:
        """Where the coordinates of each panel lie."""
        return self.frames

    def kinds(self) -> dict[str, str]:
        """Every name that this shape gives, with what it names; panels are outlines."""
        return super().kinds() | dict.fromkeys(self.outlines, "outline")

    def written_key(self, key: tuple[str, ...]) -> tuple[str, ...]:
        """The key of a panel that a key of the shape comes from."""
        panel = key[2].partition(".")[0] if len(key) > 2 else ""
        if panel not in self.outlines:
            return ("panels", *key[2:]) if key[:1] == ("shape",) else key
        own = key[2].partition(".")[2].removeprefix(f"{IMAGE}.")
        return ("panels", panel, key[1], own, *key[3:])

    @property
    def pieces(self) -> Mapping[str, list[str]]:
        """Names of the edges around each piece, by the piece's name."""
        return self.outlines


class Parts(NamedTuple):
    """What the panels laid so far have, by name."""

    vertices: dict[str, object]
    edges: dict[str, object]
    holes: dict[str, object]
    regions: dict[str, object]
    points: dict[str, object]
    groups: dict[str, object]


def panels_of(scene: Scene) -> Mapping[str, Panel]:
    """The panels of a scene by name; none where no physics of it has registered a table of them."""
    key = scene.tables.get(Panel)
    return getattr(scene, key) if key else {}


def frames_of(scene: Scene) -> Mapping[str, PanelFrame]:
    """Where the coordinates of each panel lie in the pattern plane, by name; none of a scene of one sheet."""
    return scene.shape.frames if isinstance(scene.shape, PanelShape) else {}


def with_panels(scene: Scene) -> Scene:
    """The scene whose shape is that of its panels, where it has any.

    Raises:
        UserError: it has a shape besides, or a panel without an outline.
    """
    panels = panels_of(scene)
    if not panels:
        return scene
    for key in ("shape", "mesh"):
        if key in scene.model_fields_set and (key == "shape" or scene.mesh.file):
            what = f"the scene has [panels] and {'a [shape]' if key == 'shape' else 'a mesh from a file'}"
            raise UserError(what, key if key == "shape" else "mesh.file", "keep one of the two")
    for name, panel in panels.items():
        if panel.outline is None:
            raise UserError("the panel has no outline", f"panels.{name}.outline", 'add outline = ["edge", ...]')
    unfolded_panels = {name: whole(name, one) for name, one in panels.items()}
    layout = scene.tables.get(PatternLayout)
    packs = layout is not None and getattr(scene, layout) is not None
    return scene.model_copy(update={"shape": pattern_shape(unfolded_panels, packs)})


def whole(name: str, panel: Panel) -> Panel:
    """A panel with both of its halves, where it is cut on the fold.

    Raises:
        UserError: it cannot be unfolded.
    """
    if panel.mirror is None:
        return panel
    try:
        return unfolded(panel, panel.mirror)
    except UserError as error:
        raise UserError(error.what, f"panels.{name}.{error.where}", error.do) from error


def folds_of(scene: Scene) -> dict[str, str]:
    """The edges that panels are unfolded about, by the names of the panels."""
    return {name: f"{name}.{panel.mirror}" for name, panel in panels_of(scene).items() if panel.mirror is not None}


def pattern_shape(panels: Mapping[str, Panel], packs: bool = False) -> PanelShape:
    """The shape of panels, each where it lies in the pattern plane, in the order of the scene; all packed if wanted."""
    places = {name: None if packs else panel.at for name, panel in panels.items()}
    given = {name: Where(bounds(panel, panel.angle), places[name], panel.angle) for name, panel in panels.items()}
    frames, parts, outlines = packed(given), Parts({}, {}, {}, {}, {}, {}), {}
    for name, panel in panels.items():
        _lay(name, panel, frames[name], parts)
        outlines[name] = [f"{name}.{edge}" for edge in panel.outline or ()]
    return PanelShape.model_construct(outlines=outlines, frames=frames, **parts._asdict())


def _lay(name: str, panel: Panel, frame: PanelFrame, parts: Parts) -> None:
    """Adds what a panel has, under its names in the scene, where it lies."""
    parts.vertices.update((f"{name}.{key}", frame.place(point)) for key, point in panel.vertices.items())
    parts.points.update((f"{name}.{key}", frame.place(point)) for key, point in panel.points.items())
    edges = {key: with_bulge(edge, panel.vertices) for key, edge in panel.edges.items()}
    parts.edges.update((f"{name}.{key}", _placed_edge(name, edge, frame)) for key, edge in edges.items())
    for key, loops in (("holes", panel.holes), ("regions", panel.regions)):
        for loop_name, loop in loops.items():
            getattr(parts, key)[f"{name}.{loop_name}"] = _placed_loop(name, f"{name}.{loop_name}", loop, frame, parts)
    parts.groups.update((f"{name}.{key}", [f"{name}.{one}" for one in group]) for key, group in panel.groups.items())


def _placed_edge(name: str, edge: EdgePart, frame: PanelFrame) -> EdgePart:
    start, end = getattr(edge, edge.kind)
    update: dict[str, object] = {edge.kind: (f"{name}.{start}", f"{name}.{end}")}
    if edge.part_of is not None:
        update["part_of"] = f"{name}.{edge.part_of}"
    through = getattr(edge, "through", None)
    if through is not None:
        update["through"] = frame.place(through) if isinstance(edge, ArcSpec) else [frame.place(p) for p in through]
    return edge.model_copy(update=update)


def _placed_loop(
    panel: str, name: str, loop: CircleLoop | EdgeLoop | PolygonLoop, frame: PanelFrame, parts: Parts
) -> EdgeLoop:
    """A loop of edges where it lies: circles turn with their panel."""
    if isinstance(loop, EdgeLoop):
        return EdgeLoop.model_construct(loop=[f"{panel}.{edge}" for edge in loop.loop])
    corners = list(_corners(loop))
    for i, corner in enumerate(corners, 1):
        parts.vertices[f"{name}.v{i}"] = frame.place(corner)
        ends = f"{name}.v{i}", f"{name}.v{i % len(corners) + 1}"
        round_edge = isinstance(loop, CircleLoop)
        edge = ArcSpec.model_construct(arc=ends, bulge=QUARTER) if round_edge else LineSpec.model_construct(line=ends)
        parts.edges[f"{name}.{i}"] = edge
    return EdgeLoop.model_construct(loop=[f"{name}.{i}" for i in range(1, len(corners) + 1)])


def _corners(loop: CircleLoop | PolygonLoop) -> Iterator[tuple[float, float]]:
    if isinstance(loop, PolygonLoop):
        yield from loop.polygon
        return
    (x, y), radius = loop.circle.center, loop.circle.radius
    for dx, dy in ((radius, 0.0), (0.0, radius), (-radius, 0.0), (0.0, -radius)):
        yield x + dx, y + dy


def panel_words(panel: Panel) -> str:
    """What a panel says besides its shape, for people."""
    edges = f"{len(panel.outline or ())} edges around it"
    place = "packed in rows" if panel.at is None else f"at {listing(panel.at)} m"
    said = [f"turned by {listing(panel.turn)} rad in space", f"moved by {listing(panel.move)} m"]
    said = [f"wrapped on {panel.around}", *said] if panel.around else said
    said += [f"of {panel.material}"] if panel.material else []
    return "; ".join([edges, place, *said])
