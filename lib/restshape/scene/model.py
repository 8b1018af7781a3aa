"""What a scene holds, as validated models."""

from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Discriminator,
    Field,
    PrivateAttr,
    Tag,
    WithJsonSchema,
    model_validator,
)

from restshape.errors import UserError
from restshape.scene.bodies import Body, Start
from restshape.scene.expressions import Expression, Value
from restshape.scene.materials import NAMES, named
from restshape.scene.quantity import Quantity
from restshape.scene.source import Source, split_key
from restshape.scene.units import UnitError, quantity
from restshape.scene.values import Entities, Length, Name, Point, Strict, number_of, only_one, value_of

FORMAT = "restshape-scene"
VERSION = 1


def _tag_by_key(keys: tuple[str, ...]) -> Discriminator:
    """A discriminator that tells models apart by which of the keys is there."""

    def tag(raw: Any) -> str | None:
        held = [key for key in keys if (key in raw if isinstance(raw, dict) else hasattr(raw, key))]
        return f"<{held[0]}>" if held else None

    wanted = f"one of {', '.join(keys)} is wanted here"
    return Discriminator(
        tag, custom_error_type="kind", custom_error_message=wanted, custom_error_context={"keys": keys}
    )


class LineSpec(Strict):
    """A straight edge: ``{ line = ["a", "b"] }``."""

    line: tuple[str, str]

    @model_validator(mode="after")
    def _has_length(self) -> Self:
        _check_ends(self.line)
        return self


class ArcSpec(Strict):
    """A circular edge: ``{ arc = ["a", "b"], through = [x, y] }``, or ``bulge`` = tan(angle / 4).

    A positive bulge lies to the right of the way from a to b, as in DXF.
    """

    arc: tuple[str, str]
    through: Point | None = None
    bulge: float | None = None

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        _check_ends(self.arc)
        only_one(self, ("through", "bulge"))
        return self


class SplineSpec(Strict):
    """An edge that interpolates points: ``{ spline = ["a", "b"], through = [[x, y], ...] }``."""

    spline: tuple[str, str]
    through: Annotated[list[Point], Field(min_length=1)]


class PolylineSpec(Strict):
    """An edge of straight pieces: ``{ polyline = ["a", "b"], through = [[x, y], ...] }``."""

    polyline: tuple[str, str]
    through: Annotated[list[Point], Field(min_length=1)]


def _check_ends(ends: tuple[str, str]) -> None:
    """Refuses an edge from a vertex to itself."""
    if ends[0] == ends[1]:
        raise UnitError(f"the edge has zero length: it goes from {ends[0]!r} to itself")


EdgeSpec = Annotated[
    Annotated[LineSpec, Tag("<line>")]
    | Annotated[ArcSpec, Tag("<arc>")]
    | Annotated[SplineSpec, Tag("<spline>")]
    | Annotated[PolylineSpec, Tag("<polyline>")],
    _tag_by_key(("line", "arc", "spline", "polyline")),
]


class Circle(Strict):
    """A circle by centre [m] and radius [m]."""

    center: Point
    radius: Annotated[Length, Field(gt=0)]


class CircleLoop(Strict):
    """A round loop of four arcs, ``NAME.1`` to ``NAME.4``, through vertices ``NAME.v1`` to ``NAME.v4``."""

    circle: Circle


class EdgeLoop(Strict):
    """A loop of named edges."""

    loop: Annotated[list[str], Field(min_length=1)]


class PolygonLoop(Strict):
    """A loop of straight edges ``NAME.1``, ``NAME.2``, ... between corners [m]."""

    polygon: Annotated[list[Point], Field(min_length=3)]


LoopSpec = Annotated[
    Annotated[CircleLoop, Tag("<circle>")]
    | Annotated[EdgeLoop, Tag("<loop>")]
    | Annotated[PolygonLoop, Tag("<polygon>")],
    _tag_by_key(("circle", "loop", "polygon")),
]


class ShapeSpec(Strict):
    """``[shape]``: the outline with its holes, and what has a name on it."""

    named: ClassVar[dict[str, str]] = {
        "vertices": "vertex",
        "edges": "edge",
        "holes": "hole",
        "regions": "region",
        "points": "point",
        "groups": "group",
    }

    file: str | None = None
    outline: Annotated[list[str], Field(min_length=1)] | None = None
    vertices: dict[Name, Point] = {}
    edges: dict[Name, EdgeSpec] = {}
    holes: dict[Name, LoopSpec] = {}
    regions: dict[Name, LoopSpec] = {}
    points: dict[Name, Point] = {}
    groups: dict[Name, Annotated[list[str], Field(min_length=1)]] = {}

    def kinds(self) -> dict[str, str]:
        """Every name that this shape gives, also those inside loops, with what it names: vertex, edge, hole, ..."""
        kinds = {name: kind for key, kind in self.named.items() for name in getattr(self, key)}
        for name, loop in (self.holes | self.regions).items():
            corners = 4 if isinstance(loop, CircleLoop) else len(loop.polygon) if isinstance(loop, PolygonLoop) else 0
            for i in range(1, corners + 1):
                kinds |= {f"{name}.{i}": "edge", f"{name}.v{i}": "vertex"}
        return kinds | {"outline": "outline", "all": "all"}


def _refuse_flat(value: Value) -> Value:
    """The thickness, unless it is a number that is not positive."""
    if not isinstance(value, Expression) and value <= 0.0:
        raise UnitError(f"a thickness is greater than 0, not {value:g}")
    return value


def _read_bending(raw: Any) -> float | tuple[float, float]:
    """One bending stiffness, or two, along and across the grain."""
    given = raw if isinstance(raw, (list, tuple)) else [raw, raw]
    if len(given) != 2:
        raise UnitError(f"two bending stiffnesses are wanted, along and across the grain, or one, not {len(given)}")
    along, across = (quantity(value, "moment") for value in given)
    if min(along, across) < 0.0:
        raise UnitError(f"{min(along, across):g} is too small: a bending stiffness must be at least 0")
    return along if given is not raw else (along, across)


Bending = Annotated[
    float | tuple[float, float],
    BeforeValidator(_read_bending),
    WithJsonSchema(
        {
            "anyOf": [{"type": kind} for kind in ("number", "string", "array")],
            "description": 'in N m, such as "5e-6 N m", or two along and across the grain',
        }
    ),
]
Modulus = Annotated[number_of("pressure"), Field(gt=0)]
Ratio = number_of("number")


class Orthotropic(Strict):
    """``{ E = [E1, E2, E3], nu = [nu12, nu13, nu23], G = [G12, G13, G23] }``: stiffness along and across a grain.

    1 is along the grain, 2 across it in the plane, 3 through the thickness; nu12 is how much 2 contracts where 1 is
    pulled.
    """

    E: tuple[Modulus, Modulus, Modulus]
    nu: tuple[Ratio, Ratio, Ratio]
    G: tuple[Modulus, Modulus, Modulus]

    @model_validator(mode="after")
    def _resists(self) -> Self:
        # The strain energy is positive: Jones, Mechanics of Composite Materials, 2nd edition, 1999, section 2.4.
        (E1, E2, E3), (n12, n13, n23) = self.E, self.nu
        couplings = (n12**2 * E2 / E1, n13**2 * E3 / E1, n23**2 * E3 / E2)
        if max(couplings) >= 1 or sum(couplings) + 2 * n12 * n13 * n23 * E3 / E1 >= 1:
            raise UnitError("with these ratios nu some strains would set energy free: make them smaller")
        return self


class Material(Strict):
    """``[material.NAME]``: what a body is made of; without ``region`` it fills what no other material does.

    Isotropic by ``E`` and ``nu``, or ``orthotropic`` with a ``grain`` at an angle from x towards y. ``name`` takes all
    of these and the density from a material that is known; what is given besides comes before that. Cloth bends by
    E thickness^3/(12 (1 - nu^2)) [N m], or by ``bending``; two values are those along and across the grain.
    """

    name: Literal[NAMES] | None = None
    E: Modulus | None = None
    nu: Annotated[Ratio, Field(gt=-1, lt=0.5)] | None = None
    orthotropic: Orthotropic | None = None
    grain: number_of("angle") = 0.0
    rho: Annotated[number_of("density"), Field(ge=0)] = 0.0
    thickness: Annotated[value_of("length"), AfterValidator(lambda value: _refuse_flat(value))] = 1.0
    bending: Bending | None = None
    region: Entities | None = None

    @model_validator(mode="before")
    @classmethod
    def _take_the_named(cls, raw: Any) -> Any:
        return named(raw)

    @model_validator(mode="after")
    def _is_stiff_in_one_way(self) -> Self:
        missing = [key for key in ("E", "nu") if getattr(self, key) is None]
        if self.orthotropic is None:
            if missing:
                raise UnitError(f"the key {missing[0]!r} is missing: add it, or name a material: {', '.join(NAMES)}")
            if self.grain:
                raise UnitError("an isotropic material has no grain: leave it out, or add orthotropic")
        elif len(missing) < 2:
            raise UnitError("E and nu are of isotropic materials: set orthotropic.E and orthotropic.nu instead")
        if isinstance(self.bending, tuple) and self.orthotropic is None:
            raise UnitError("an isotropic material has one bending stiffness: give one, or add orthotropic")
        return self


Displacement = value_of("length")


def _read_fix(raw: Any) -> Any:
    """Directions that are held, as a table of displacements."""
    if isinstance(raw, list) and raw and all(isinstance(direction, str) for direction in raw):
        return dict.fromkeys(raw, 0.0)
    if not isinstance(raw, dict) or not raw:
        raise UnitError(f'directions such as ["x", "y"], or a table such as {{ x = 0, y = "1 mm" }}, not {raw!r}')
    return raw


DIRECTIONS = ("x", "y", "z", "rx", "ry", "slope")


class Support(Strict):
    """``[supports.NAME]``: where and in which directions the displacement is given.

    z is normal to the plane, rx and ry are turns about x and y: for bodies that have them. Cloth may be clamped at an
    edge, "slope", across which its direction then stays; ``symmetry`` instead of fix puts an edge on a plane of
    symmetry with the normal x or y.
    """

    on: Entities
    fix: Annotated[
        dict[Literal[DIRECTIONS], Displacement],
        BeforeValidator(_read_fix),
        WithJsonSchema(
            {
                "anyOf": [{"type": "array", "items": {"enum": list(DIRECTIONS)}}, {"type": "object"}],
                "description": "directions",
            }
        ),
    ] = {}
    symmetry: Literal["x", "y"] | None = None

    @model_validator(mode="after")
    def _is_one_kind(self) -> Self:
        if not self.fix and self.symmetry is None:
            raise UnitError("the key 'fix' is missing: add it")
        if self.fix and self.symmetry is not None:
            raise UnitError("a support has fix or symmetry, not both: make it two supports")
        if self.fix.get("slope", 0.0) != 0.0:
            raise UnitError("a slope is held as it is, and has no displacement: write slope = 0")
        return self


Force = tuple[value_of("force"), value_of("force")]
Traction = tuple[value_of("pressure"), value_of("pressure")]
BodyForce = tuple[value_of("body force"), value_of("body force")]


class Load(Strict):
    """``[loads.NAME]``: a force [N], a dead traction [Pa], a pressure [Pa], or a body force [N/m^3].

    A force on an edge is a total, spread evenly; a pressure acts along the inward normal.
    """

    kinds: ClassVar[tuple[str, ...]] = ("force", "traction", "pressure", "body")

    on: Entities
    force: Force | None = None
    traction: Traction | None = None
    pressure: value_of("pressure") | None = None
    body: BodyForce | None = None

    @property
    def kind(self) -> str:
        """Which of force, traction, pressure and body this load is."""
        return only_one(self, self.kinds)

    @model_validator(mode="after")
    def _is_one_kind(self) -> Self:
        only_one(self, self.kinds)
        return self


class MeshSpec(Strict):
    """``[mesh]``: how fine, of which order (left out, the effects decide), and how it follows the shape.

    Solids over the plane outline have ``layers`` of tetrahedra. Of ``levels`` of nested meshes the finest has the sizes
    given; the coarsest is what moves, flips and is made anew.
    """

    size: Annotated[Length, Field(gt=0)] | None = None
    near: dict[str, Annotated[Length, Field(gt=0)]] = {}
    levels: Annotated[int, Field(ge=1, le=5)] = 1
    order: Literal[1, 2] | None = None
    layers: Annotated[int, Field(ge=1)] | None = None
    relocation: Literal["harmonic", "mvc", "laplacian"] = "harmonic"
    criterion: Literal["quality", "author"] = "quality"
    min_quality: Annotated[float, Field(gt=0, lt=1)] = 0.3
    mesher: Literal["auto", "cgal", "gmsh"] = "auto"
    file: str | None = None
    unit: Annotated[float, BeforeValidator(lambda raw: _read_scale(raw)), Field(gt=0)] = 1.0


def _read_scale(raw: Any) -> float:
    """Metres in one unit of an imported mesh, given as a number or as the name of a unit."""
    return quantity(f"1 {raw}" if isinstance(raw, str) and raw.strip().isalpha() else raw, "length")


class SolveSpec(Strict):
    """``[solve]``: the relative residual to reach, the policy of reuse, the bytes that a complete factor may take."""

    tolerance: Annotated[float, Field(gt=0, lt=1)] = 1e-6
    policy: Literal["auto", "thesis", "refactor", "rebuild"] = "auto"
    factor_memory: Annotated[float, Field(gt=0)] = 4e9


class Goal(Strict):
    """``[goal.NAME]``: a curve in the plane that a deformed shape is measured against, through points [m] in order.

    ``spline`` is a cubic spline through them, ``polyline`` straight pieces between them.
    """

    spline: Annotated[list[Point], Field(min_length=2)] | None = None
    polyline: Annotated[list[Point], Field(min_length=2)] | None = None

    @model_validator(mode="after")
    def _is_one_curve(self) -> Self:
        points = getattr(self, only_one(self, ("spline", "polyline")))
        if any(a == b for a, b in pairwise(points)):
            raise UnitError("two points of a goal that follow each other are the same")
        return self


class Scene(Strict):
    """A whole scene: object, material, effects, supports, loads, mesh, solution and what is observed.

    Applications add tables of their own: `scene.extension.SceneExtension`.
    """

    format: Literal["restshape-scene"]
    version: Literal[1]
    app: str
    title: str = ""
    parameters: dict[Name, number_of(None)] = {}
    shape: ShapeSpec = ShapeSpec()
    material: Annotated[dict[Name, Material], Field(min_length=1)] = {}
    effects: dict[str, dict[str, Any]] = {}
    supports: dict[Name, Support] = {}
    loads: dict[Name, Load] = {}
    bodies: dict[Name, Body] = {}
    start: Start | None = None
    goal: dict[Name, Goal] = {}
    mesh: MeshSpec = MeshSpec()
    solve: SolveSpec = SolveSpec()
    quantities: dict[Name, Quantity] = {}

    _source: Source = PrivateAttr(default_factory=lambda: Source(Path("scene.toml")))
    _raw: dict[str, Any] = PrivateAttr(default_factory=dict)

    @property
    def path(self) -> Path:
        """The file that the scene was read from."""
        return self._source.path

    @property
    def raw(self) -> dict[str, Any]:
        """The plain tables that the scene was built from, overrides included."""
        return self._raw

    @property
    def sections(self) -> dict[str, Any]:
        """The tables that the scene's application adds, by key, with defaults filled in."""
        return {key: getattr(self, key) for key in type(self).model_fields if key not in Scene.model_fields}

    @property
    def folder(self) -> Path:
        """Where files that the scene names are looked for."""
        return self._source.path.parent

    def located(self, error: UserError) -> UserError:
        """The same error with file and line, if its place is a key of this scene such as ``shape.edges.top``."""
        key = split_key(error.where)
        if not key or key[0] not in type(self).model_fields:
            return error
        return self._source.error(key, error.what, error.do)
