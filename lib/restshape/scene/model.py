"""What a scene holds, as validated models."""

from collections.abc import Collection, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal, Self, get_args

from pydantic import (
    BeforeValidator,
    Field,
    PrivateAttr,
    Tag,
    WithJsonSchema,
    model_validator,
)

from restshape.bounds import POLYLINE_POINTS, TOLERANCE
from restshape.errors import UserError
from restshape.scene.dart_keys import PlacedDart
from restshape.scene.expressions import Value
from restshape.scene.load_kind import LoadKind
from restshape.scene.materials import named
from restshape.scene.plain_values import Table
from restshape.scene.pleat_keys import PlacedPleat
from restshape.scene.quantity import Quantity
from restshape.scene.shape_edges import EdgeSpec, tag_by_key
from restshape.scene.source import Source, split_key
from restshape.scene.units import UnitError
from restshape.scene.values import (
    UNIT_SCHEMA,
    AnyNumber,
    Entities,
    Length,
    Name,
    Number,
    PartName,
    Point,
    Strict,
    Time,
    Whole,
    only_one,
    read_unit,
)

FORMAT = "restshape-scene"
VERSION = 1
if TYPE_CHECKING:
    Fix = dict[str, Value]
else:
    # Which components there are, and of which dimension, is known of the supports of physics alone.
    Fix = dict[str, object]


class Circle(Strict):
    """A circle by centre [m] and radius [m].

    Args:
        center: its centre.
        radius: its radius.
    """

    center: Point
    radius: Annotated[Length, Field(gt=0)]


class CircleLoop(Strict):
    """A round loop of four arcs, ``NAME.1`` to ``NAME.4``, through vertices ``NAME.v1`` to ``NAME.v4``.

    Args:
        circle: centre and radius.
    """

    circle: Circle


class EdgeLoop(Strict):
    """A loop of named edges.

    Args:
        loop: names of edges, in the order in which they are joined.
    """

    loop: Annotated[list[str], Field(min_length=1)]


class PolygonLoop(Strict):
    """A loop of straight edges ``NAME.1``, ``NAME.2``, ... between corners [m].

    Args:
        polygon: its corners, three or more, in order.
    """

    polygon: Annotated[list[Point], Field(min_length=3, max_length=POLYLINE_POINTS)]


LoopSpec = Annotated[
    Annotated[CircleLoop, Tag("<circle>")]
    | Annotated[EdgeLoop, Tag("<loop>")]
    | Annotated[PolygonLoop, Tag("<polygon>")],
    tag_by_key(("circle", "loop", "polygon")),
]


class ShapeSpec(Strict):
    """``[shape]``: the outline with its holes, and what has a name on it.

    Args:
        file: a drawing (.dxf, .svg, .step, .geo) beside the scene that the outline is read from; other keys add to
            it.
        layers: layers of a .dxf, or groups and shapes of an .svg, that are read, each with its name in the scene;
            left out, all are.
        tolerance: the largest gap between two ends of curves in the file that is closed; left out, none is.
        outline: names of edges, in order around the shape.
        vertices: points where edges end, by name.
        edges: lines, arcs, splines and polylines between vertices, by name.
        holes: loops that are cut out, by name.
        regions: loops that may have a material of their own, by name.
        points: points that the mesh has a node at, by name.
        groups: lists of entities, by the name that stands for them.
    """

    named: ClassVar[dict[str, str]] = {
        "vertices": "vertex",
        "edges": "edge",
        "holes": "hole",
        "regions": "region",
        "points": "point",
        "groups": "group",
    }

    file: str | None = None
    layers: dict[str, PartName] = {}
    tolerance: Annotated[Length, Field(gt=0)] | None = None
    outline: Annotated[list[str], Field(min_length=1)] | None = None
    vertices: dict[PartName, Point] = {}
    edges: dict[PartName, EdgeSpec] = {}
    holes: dict[PartName, LoopSpec] = {}
    regions: dict[PartName, LoopSpec] = {}
    points: dict[PartName, Point] = {}
    groups: dict[PartName, Annotated[list[str], Field(min_length=1)]] = {}
    _darts: tuple[PlacedDart, ...] = PrivateAttr(())
    _pleats: tuple[PlacedPleat, ...] = PrivateAttr(())

    @model_validator(mode="after")
    def _reads_a_file(self) -> Self:
        of_file = [key for key in ("layers", "tolerance") if self.file is None and getattr(self, key)]
        if of_file:
            raise UnitError(f"{of_file[0]} says how shape.file is read, which the scene does not have: leave it out")
        return self

    @property
    def darts(self) -> tuple[PlacedDart, ...]:
        """What is cut out of it, or folded."""
        return self._darts

    def with_darts(self, darts: tuple[PlacedDart, ...]) -> Self:
        """This shape with darts, whose parts have names in it."""
        found = self.model_copy()
        found._darts = darts
        return found

    @property
    def pleats(self) -> tuple[PlacedPleat, ...]:
        """Where its edges are folded as they are sewn."""
        return self._pleats

    def with_pleats(self, pleats: tuple[PlacedPleat, ...]) -> Self:
        """This shape with pleats, whose folds are vertices of it."""
        found = self.model_copy()
        found._pleats = pleats
        return found

    @property
    def pieces(self) -> Mapping[str, list[str]]:
        """Names of the edges around each piece, by the piece's name; one that has no name of its own is "outline"."""
        return {} if self.outline is None else {"outline": self.outline}

    def panel_frames(self) -> Mapping[str, tuple[float, float, float]]:
        """Where the coordinates of each panel lie: origin [m] and angle [rad], by name; a sheet has none."""
        return {}

    def written_key(self, key: tuple[str, ...]) -> tuple[str, ...]:
        """The key of the scene that a key of the shape comes from: the same."""
        return key

    def kinds(self) -> dict[str, str]:
        """Every name that this shape gives, also those inside loops, with what it names: vertex, edge, hole, ..."""
        kinds = {name: kind for key, kind in self.named.items() for name in getattr(self, key)}
        for name, loop in (self.holes | self.regions).items():
            corners = 4 if isinstance(loop, CircleLoop) else len(loop.polygon) if isinstance(loop, PolygonLoop) else 0
            for i in range(1, corners + 1):
                kinds |= {f"{name}.{i}": "edge", f"{name}.v{i}": "vertex"}
        former = {edge.part_of: "edge" for edge in self.edges.values() if edge.part_of is not None}
        for dart in self._darts:
            kinds |= dart.kinds()
        kinds |= {fold: "vertex" for pleat in self._pleats for fold in pleat.folds}
        return former | kinds | {"outline": "outline", "all": "all"}


class Material(Strict):
    """``[material.NAME]``: what a body is made of; without ``region`` it fills what no other material does.

    ``name`` takes the values of a material that is known; what is given besides comes before that.

    Args:
        name: a known material, whose values are taken where none are given.
        region: the regions that it fills; left out, all that no other material fills.
    """

    known: ClassVar[Mapping[str, Mapping[str, object]]] = {}

    name: str | None = None
    region: Entities | None = None

    @model_validator(mode="before")
    @classmethod
    def _take_the_named(cls, raw: object) -> object:
        if not cls.known and isinstance(raw, dict) and raw.get("name") is not None:
            raise UnitError("no material is known by a name here", "leave name out, and give its values")
        return named(raw, cls.known, cls.model_fields)


def read_fix(raw: object, warm: Collection[str] = ()) -> Table:
    """What is constrained, as a table of values: a list stands for zeros.

    Args:
        warm: unknowns that are temperatures, whose zero nobody means.

    Raises:
        UnitError: it is neither a table nor a list of names, or a list that names a temperature.
    """
    if isinstance(raw, list) and raw and all(isinstance(component, str) for component in raw):
        if named := [component for component in raw if component in warm]:
            what = f"a list fixes {named[0]} at 0 K, which is absolute zero"
            raise UnitError(what, f'give it a value, as in fix = {{ {named[0]} = "20 degC" }}')
        return dict.fromkeys(raw, 0.0)
    if not isinstance(raw, dict) or not raw:
        what = (
            f'directions such as ["x", "y"], or a table such as {{ x = 0, y = "1 mm" }}, are wanted here, not {raw!r}'
        )
        raise UnitError(what, f'write fix = ["{raw}"]' if isinstance(raw, str) else "")
    return raw


class Support(Strict):
    """``[supports.NAME]``: where, and to which values, unknowns are constrained: ``fix = ["x"]``, or ``{ x = 0 }``.

    Args:
        on: the entities that it holds.
        fix: directions that are constrained, or the values of unknowns.
    """

    boundary: ClassVar[Mapping[str, str]] = {}

    on: Entities
    fix: Annotated[Fix, BeforeValidator(read_fix)] = {}

    @model_validator(mode="after")
    def _says_something(self) -> Self:
        if not any(getattr(self, key) for key in type(self).model_fields if key != "on"):
            raise UnitError("the key 'fix' is missing", "add it")
        return self


class Load(Strict):
    """``[loads.NAME]``: what acts on a part of the shape; of one kind.

    Args:
        on: the entities that it acts on.
    """

    kinds: ClassVar[Mapping[str, LoadKind]] = {}

    on: Entities

    @property
    def kind(self) -> str:
        """Which of the kinds this load is."""
        return only_one(self, self.kinds)

    @model_validator(mode="after")
    def _is_one_kind(self) -> Self:
        only_one(self, self.kinds)
        return self


def _read_reach(raw: object) -> object:
    """A length, or nothing for "auto"."""
    return None if raw == "auto" else raw


class MeshSpec(Strict):
    """``[mesh]``: how fine, of which order (left out, the effects decide), and how it follows the shape.

    Solids over the plane outline have ``layers`` of tetrahedra. Of ``levels`` of nested meshes the finest has the sizes
    given; the coarsest is what moves, flips and is rebuilt.

    Args:
        size: edge length of the mesh.
        near: edge length at an entity, by its name.
        edges_per_circle: mesh edges of a whole circle; left out, 24 of first order and 12 of second.
        levels: nested meshes.
        order: element order; left out, as the effects decide.
        layers: layers of tetrahedra over the thickness; left out, as thickness and modes decide.
        relocation: how nodes follow the outline.
        reach: distance within which nodes follow what the hand moves of the outline; "auto": all of them do.
        criterion: the measure of triangles by which they flip and meshes are rebuilt.
        min_quality: the quality below which a mesh is rebuilt.
        mesher: the program that makes meshes.
        file: a mesh (.inp, .bdf, .msh, .vtu) that the shape is taken from.
        unit: of the numbers in the file.
    """

    size: Annotated[Length, Field(gt=0)] | None = None
    near: dict[str, Annotated[Length, Field(gt=0)]] = {}
    edges_per_circle: Annotated[Whole, Field(ge=8, le=720)] | None = None
    levels: Annotated[Whole, Field(ge=1, le=5)] = 1
    order: Literal[1, 2] | None = None
    layers: Annotated[Whole, Field(ge=1)] | None = None
    relocation: Literal["harmonic", "pmvc", "mvc", "laplacian"] = "harmonic"
    reach: Annotated[Annotated[Length, Field(gt=0)] | None, BeforeValidator(_read_reach)] = None
    criterion: Literal["quality", "author"] = "quality"
    min_quality: Annotated[Number, Field(gt=0, lt=1)] = 0.3
    mesher: Literal["auto", "cgal", "gmsh"] = "auto"
    file: str | None = None
    unit: Annotated[float, BeforeValidator(read_unit), Field(gt=0), WithJsonSchema(UNIT_SCHEMA)] = 1.0

    @model_validator(mode="after")
    def _reaches_by_its_map(self) -> Self:
        if self.reach is not None and self.relocation != "harmonic":
            what = (
                f"mesh.relocation {self.relocation!r} moves all nodes, and mesh.reach = {self.reach:g} m some of them"
            )
            raise UnitError(what, 'leave mesh.reach out, or take mesh.relocation = "harmonic"')
        return self


EstimatedFrames = Literal["auto", "every", "idle", "none"]


def _read_frames(raw: object) -> object:
    """Frames by a word, or every so many."""
    if raw in get_args(EstimatedFrames) or (isinstance(raw, int) and raw >= 1 and not isinstance(raw, bool)):
        return raw
    raise UnitError(f"{raw!r} names no frames", f"{', '.join(get_args(EstimatedFrames))}, or a number N: every N-th")


class SolveSpec(Strict):
    """``[solve]``: the relative residual to reach, the policy of reuse, the bytes that a complete factor may take.

    ``jumps``: report by how much each quantity jumps where flips or a new mesh change the mesh; left out, wherever that
    can be known. ``estimate``: the frames whose errors are estimated: `docs/accuracy.md`, "Frames with an estimate".

    Args:
        tolerance: relative residual at which a solve has converged, no less than rounding allows.
        policy: what is reused from frame to frame.
        factor_memory: bytes that a complete factor may take.
        jumps: whether jumps of quantities by the mesh alone are reported; left out, wherever that can be known.
        estimate: frames whose errors are estimated: "auto", "every", every so many, "idle" or "none".
    """

    tolerance: Annotated[Number, Field(ge=TOLERANCE, lt=1)] = 1e-6
    policy: Literal["auto", "thesis", "refactor", "rebuild"] = "auto"
    factor_memory: Annotated[Number, Field(gt=0)] = 4e9
    jumps: bool | None = None
    estimate: Annotated[EstimatedFrames | int, BeforeValidator(_read_frames)] = "auto"


class PredictSpec(Strict):
    """``[predict]``: how ``--predict gmls`` mixes what is known at several places of a drag.

    Args:
        epsilon: distance below which samples weigh alike, in parts of the shape's diagonal, or of the spread of
            the samples where that is less.
        samples: how many are kept at most.
        frame_time: seconds of a frame of a drag that solver steps may take, by the calibration.
        levels: nested meshes of a drag: the coarsest of them is predicted, the finest shown, and solved in idle time;
            left out, all of mesh.levels; 1: the finest alone.
    """

    epsilon: Annotated[Number, Field(ge=1e-6, le=100)] = 10.0**-1.5
    samples: Annotated[Whole, Field(ge=1, le=10)] = 10
    frame_time: Annotated[Time, Field(ge=0, le=10)] = 1.0 / 60.0
    levels: Annotated[Whole, Field(ge=1)] | None = None


class RecordingSpec(Strict):
    """``[recording]``: what recordings hold besides what they always do.

    Args:
        fields: groups of fields of the application's physics: "stress", "principal" and "strain".
    """

    fields: tuple[str, ...] = ()


# More than 15 attributes: each is a table or a value at the top of a scene.
class Scene(Strict):
    """A whole scene: object, material, effects, supports, loads, mesh, solution and what is observed.

    Physics add keys and tables of their own: `scene.physics.Physics`.

    Args:
        format: what the file is.
        version: of the format.
        app: the application that simulates it.
        title: for tables and pictures.
        parameters: named numbers for formulas.
        shape: the outline with its holes, and what has a name on it.
        material: materials by name.
        effects: the effects that are simulated, each with its keys.
        supports: what is constrained, by name.
        loads: what acts on the shape, by name.
        mesh: how fine the mesh is, and how it follows the shape.
        solve: how exactly is solved, and what is reused.
        predict: how frames of a drag are predicted from several samples.
        recording: what recordings hold besides what they always do.
        quantities: numbers a frame that are reported, by name.

    Attributes:
        tables: keys of the tables that its physics have registered, by their models.
    """

    tables: ClassVar[Mapping[type, str]] = {}

    format: Literal["restshape-scene"]
    version: Literal[1]
    app: str
    title: str = ""
    parameters: dict[Name, AnyNumber] = {}
    shape: ShapeSpec = ShapeSpec()
    material: Annotated[dict[Name, Material], Field(min_length=1)] = {}
    effects: dict[str, Table] = {}
    supports: dict[Name, Support] = {}
    loads: dict[Name, Load] = {}
    mesh: MeshSpec = MeshSpec()
    solve: SolveSpec = SolveSpec()
    predict: PredictSpec = PredictSpec()
    recording: RecordingSpec = RecordingSpec()
    quantities: dict[Name, Quantity] = {}

    _source: Source = PrivateAttr(default_factory=lambda: Source(Path("scene.toml")))
    _raw: Table = PrivateAttr(default_factory=dict)
    _as_read: Self | None = PrivateAttr(None)

    @property
    def as_read(self) -> Self | None:
        """What validation has made of `raw`, before panels, darts, effects and the plan made the rest of it."""
        return self._as_read

    @property
    def path(self) -> Path:
        """The file that the scene was read from."""
        return self._source.path

    @property
    def raw(self) -> Table:
        """The plain tables that the scene was built from, overrides included."""
        return self._raw

    @property
    def sections(self) -> Table:
        """The tables that the scene's physics add, by key, with defaults filled in."""
        return {key: getattr(self, key) for key in type(self).model_fields if key not in Scene.model_fields}

    @property
    def predicted_levels(self) -> int:
        """Nested meshes of a drag that is predicted from several samples, from the coarse one to the finest."""
        return self.predict.levels or self.mesh.levels

    @property
    def folder(self) -> Path:
        """Where files that the scene names are looked for."""
        return self._source.path.parent

    def with_parts(self, kinds: Mapping[str, str]) -> Self:
        """The same scene, which may name parts that edits have made, by their names: vertex, edge, hole, region."""
        if kinds == self._source.edited:
            return self
        scene = self.model_copy()
        scene._source = self._source.with_parts(kinds)
        return scene

    def located(self, error: UserError) -> UserError:
        """The same error with file and line, if its place is a key of this scene such as ``shape.edges.top``."""
        key = split_key(error.where)
        if not key or key[0] not in type(self).model_fields:
            return error
        return self._source.error(self.shape.written_key(key), error.what, error.do)
