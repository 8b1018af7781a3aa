"""What scenes of incompressible flow may say."""

import json
import tomllib
from collections.abc import Mapping
from importlib.resources import files
from typing import Annotated, Any, Literal, Self

from pydantic import Field, field_validator, model_validator

from restshape.scene.derived_effects import On
from restshape.scene.effect import DerivedEffect, Effect
from restshape.scene.load_kind import CURVES, ENTITIES, any_of
from restshape.scene.materials import named
from restshape.scene.model import Scene
from restshape.scene.physics import Invariant, Physics, PictureField, Section
from restshape.scene.quantity import QuantityKind, of_the_end
from restshape.scene.solver import UNSYMMETRIC, SolverPlan, System
from restshape.scene.source import Source, name_suggestion
from restshape.scene.units import UnitError, declare_dimension
from restshape.scene.values import RESERVED, Entities, Strict, Whole, number_of, only_one, value_of

VISCOSITY = declare_dimension("viscosity", "Pa s", "1.8e-5 Pa s")
DISCHARGE = declare_dimension("discharge", "m^3/s", "0.2 m^3/s")
FLUIDS: dict[str, dict[str, object]] = tomllib.loads((files(__package__) / "fluids.toml").read_text("utf-8"))
"""Keys of a fluid by its name, as a scene would hold them, and the source of their values."""
CONDITIONS = ("velocity", "wall", "slip", "outflow")
LACKING = {"rho": "density", "mu": "viscosity"}


class Fluid(Strict):
    """``[fluid]``: what flows. ``name`` takes the values of a fluid that is known; what is given comes before that.

    Args:
        name: a known fluid at 20 degrees Celsius, whose values are taken where none are given.
        rho: density [kg/m^3].
        mu: dynamic viscosity [Pa s].
        depth: of the flow across the plane [m], by which forces, discharges and energies are multiplied.
    """

    name: Literal[tuple(FLUIDS)] | None = None  # type: ignore[valid-type]
    rho: Annotated[number_of("density"), Field(gt=0)]
    mu: Annotated[number_of(VISCOSITY), Field(gt=0)]
    depth: Annotated[number_of("length"), Field(gt=0)] = 1.0

    @model_validator(mode="before")
    @classmethod
    def _take_the_named(cls, raw: object) -> object:
        if isinstance(raw, dict):
            _refuse_lacking(raw)
        return named(raw, FLUIDS, cls.model_fields)


def _refuse_lacking(raw: dict[str, Any]) -> None:
    """Refuses a fluid without values, and one with another viscosity than its model wants.

    Raises:
        UnitError: what it lacks, and what to write.
    """
    for key in ("nu", "kinematic_viscosity"):
        if key in raw and "mu" not in raw:
            raise UnitError(f"{key} is no key of a fluid, which has its dynamic viscosity mu", f"write mu = rho {key}")
    lacking = [] if "name" in raw else [key for key in ("rho", "mu") if key not in raw]
    if lacking:
        what = " and ".join(f"{LACKING[key]} {key}" for key in lacking)
        known = ", ".join(f'"{name}"' for name in FLUIDS)
        raise UnitError(f"the fluid has no {what}", f"give it, or the name of one that is known: {known}")


class EdgeCondition(Strict):
    """``[boundary.NAME]``: what the flow does at edges; exactly one of its keys besides ``on``.

    Edges of the border that no table names are walls. Where edges meet, a wall goes before a velocity, and that before
    a wall on which the fluid slips.

    Args:
        on: the edges.
        velocity: of the fluid [m/s], two formulas of x, y and the time t.
        wall: the fluid sticks to it; it stands still, also while it is edited.
        slip: the fluid goes along it without friction, whatever its direction; where two such edges meet at more than
            20 degrees, it stands still.
        outflow: mu du/dn = p n, so that the fluid leaves as it will, at a pressure of 0.
    """

    on: Entities
    velocity: tuple[value_of("velocity", timed=True), value_of("velocity", timed=True)] | None = None
    wall: Literal[True] | None = None
    slip: Literal[True] | None = None
    outflow: Literal[True] | None = None

    @field_validator("velocity", mode="before")
    @classmethod
    def _has_two_components(cls, raw: object) -> object:
        if isinstance(raw, int | float | str) and not isinstance(raw, bool):
            given = json.dumps(raw, ensure_ascii=False)
            raise UnitError(
                f"a velocity has components along x and y, and {given} is one number", f"write [{given}, 0]"
            )
        return raw

    @property
    def kind(self) -> str:
        """Which of the conditions it is."""
        return only_one(self, CONDITIONS)

    @model_validator(mode="after")
    def _is_one_condition(self) -> Self:
        only_one(self, CONDITIONS)
        return self


class FlowSettings(Strict):
    """``[effects.flow]``: steady, or in time: then the first frame shows the fluid at rest, at time 0.

    Args:
        steady: nothing changes in time; so it is where there is no ``time_step``.
        time_step: of one step [s].
        steps: time steps a frame.
        scheme: backward differences of second order, or of first.
        carry: what nodes that move take along: what they had, with the velocity of the mesh in the equations (ale);
            what was at their new places (remap); or the one or the other, by how far they go in a step (auto).
    """

    steady: Literal[True] | None = None
    time_step: Annotated[number_of("time"), Field(gt=0)] | None = None
    steps: Annotated[Whole, Field(ge=1)] = 1
    scheme: Literal["bdf2", "backward_euler"] = "bdf2"
    carry: Literal["auto", "ale", "remap"] = "auto"

    @model_validator(mode="after")
    def _is_one_of_both(self) -> Self:
        if self.steady and self.time_step is not None:
            do = "take out one of steady and time_step; during an edit neither can change: make it two scenes"
            raise UnitError("a steady flow has no time_step", do)
        key = next(
            (one for one in ("steps", "scheme", "carry") if getattr(self, one) != type(self).model_fields[one].default),
            None,
        )
        if self.time_step is None and key:
            raise UnitError(f"{key} is of a flow in time, and there is no time_step", "give one, or take it out")
        return self


class Advection(Strict):
    """``[effects.convection]``: the fluid has inertia; without it, it flows as if it were infinitely slow (Stokes)."""


class Between(Strict):
    """``{ from = ..., to = ... }``: two places, such as the stagnation points of a body.

    Args:
        start: where the pressure is taken.
        to: where another one is, which is subtracted.
    """

    start: Annotated[str, Field(alias="from", description="where the pressure is taken")]
    to: str


class Coefficient(Strict):
    """``{ speed = ..., length = ... }``: a force F as 2 F / (rho speed^2 length depth), or f length / speed.

    Args:
        speed: of the flow far away [m/s].
        length: of the body [m].
    """

    speed: Annotated[number_of("velocity"), Field(gt=0)]
    length: Annotated[number_of("length"), Field(gt=0)]


def flow_plan(scene: Scene, on: On, settings: Mapping[str, Any]) -> SolverPlan | None:
    """Which equations flow makes, and which solver they get; None where it is off."""
    if "flow" not in on:
        return None
    why = "velocity and pressure together, stabilised: no pivot of a complete factor need be exchanged"
    system = System("velocity and pressure", UNSYMMETRIC, "gmres", "lu", why)
    if "convection" in on:
        return SolverPlan("nonlinear", (system,), "the velocity is advected by itself")
    return SolverPlan("linear", (system,), "without inertia forces are in proportion to velocities")


def in_time(scene: Scene, on: On) -> bool:
    """Whether the flow is followed in time."""
    return scene.effects.get("flow", {}).get("time_step") is not None


def check_flow(scene: Scene, source: Source) -> None:
    """Refuses conditions on what is no edge, a parameter t, and quantities at places that there are not.

    Raises:
        UserError: there is one.
    """
    if "t" in scene.parameters:
        raise source.error(("parameters", "t"), "'t' is the time in velocities of boundaries", "rename it")
    if not scene.boundary:
        what = "there is no [boundary.NAME]: all edges are walls, and nothing flows"
        raise source.error(("boundary",), what, 'add one, such as [boundary.inlet] with on and velocity = ["1 m/s", 0]')
    for name, one in scene.boundary.items():
        if one.kind == "velocity" and not in_time(scene, frozenset()):
            _refuse_time(name, one, source)
    if scene.shape.file or scene.mesh.file:
        return
    kinds = {**source.edited, **scene.shape.kinds()}
    places = [(("boundary", name, "on"), one, CURVES) for name, table in scene.boundary.items() for one in table.on]
    for name, quantity in scene.quantities.items():
        if quantity.kind == "pressure_drop":
            ends = quantity.pressure_drop
            place = ("quantities", name, "pressure_drop")
            places += [((*place, "from"), ends.start, tuple(ENTITIES)), ((*place, "to"), ends.to, tuple(ENTITIES))]
    for place, at, accepted in places:
        if at not in kinds:
            raise source.error(place, f"there is no entity {at!r}", name_suggestion(at, sorted(kinds), RESERVED))
        if kinds[at] not in accepted:
            what = f"the flow has no condition on {at!r}, which is {ENTITIES[kinds[at]]}"
            raise source.error(place, what, f"name {any_of(accepted)}")


def _refuse_time(name: str, table: EdgeCondition, source: Source) -> None:
    for k, value in enumerate(table.velocity or ()):
        if "t" in getattr(value, "names", ()):
            what = f"{value.text!r} depends on the time t, and the flow is steady"
            raise source.error(("boundary", name, "velocity", str(k)), what, "add a time_step to [effects.flow]")


def _closed(scene: Scene, on: On) -> str:
    if "flow" not in on or any(table.kind == "outflow" for table in scene.boundary.values()):
        return ""
    return "there is no outflow: only differences of pressure matter, and its mean is 0"


def _drawing_in(scene: Scene, on: On) -> str:
    names = [f"boundary.{name}" for name, table in scene.boundary.items() if table.kind == "outflow"]
    if not names or "convection" not in on:
        return ""
    return (
        f"{', '.join(names)}: where fluid is drawn in, what it brings along is held there; else there is no such term"
    )


def _moving(scene: Scene, on: On) -> str:
    if not in_time(scene, on) or scene.effects["flow"].get("carry") == "remap":
        return ""
    return "a flow in time, whose frames move nodes: velocities are relative to the mesh there"


CONDITION = "say in [boundary.NAME] what the fluid does at an edge: velocity, wall, slip or outflow"
PLACE = "of the fluid on it, by the residual of the equations"
FLOW = Physics(
    name="flow",
    summary="incompressible flow in the plane, steady and in time",
    solver=flow_plan,
    sections={
        "fluid": Section(Fluid, "what flows", required=True, shared=True),
        "boundary": Section(EdgeCondition, "what the flow does at edges", named=True, shared=True),
    },
    quantities=of_the_end(
        {
            "drag": QuantityKind(Literal[True], "force", "sum", summary=f"force along x {PLACE}", on=CURVES),
            "lift": QuantityKind(Literal[True], "force", "sum", summary=f"force along y {PLACE}", on=CURVES),
            "drag_coefficient": QuantityKind(Coefficient, "number", "sum", summary="of the force along x", on=CURVES),
            "lift_coefficient": QuantityKind(Coefficient, "number", "sum", summary="of the force along y", on=CURVES),
            "strouhal": QuantityKind(
                Coefficient, "number", "sum", summary="frequency of the lift over its last full cycles", on=CURVES
            ),
            "pressure": QuantityKind(Literal[True], "pressure", "mean", summary="pressure of an entity"),
            "pressure_drop": QuantityKind(
                Between,
                "pressure",
                "mean",
                whole=True,
                reductions=("mean",),
                summary="pressure of one place less that of another",
            ),
            "flux": QuantityKind(
                Literal[True], DISCHARGE, "sum", summary="volume that leaves by an edge in a second", on=CURVES
            ),
            "speed": QuantityKind(Literal[True], "velocity", "max", summary="length of the velocity at an entity"),
            "kinetic": QuantityKind(Literal[True], "moment", "sum", whole=True, summary="kinetic energy of the fluid"),
        }
    ),
    effects={
        "flow": Effect(
            FlowSettings, "velocity and pressure of a fluid", fixed=True, drives=True, transient="time_step"
        ),
        "convection": Effect(Advection, "the fluid's inertia", kernels=("flow_tri3", "unsteady_flow")),
    },
    derived={
        "mesh_velocity": DerivedEffect(
            "velocity of the mesh",
            _moving,
            "steady flow does not know how nodes came there, and remap takes fields at their new places",
        ),
        "backflow": DerivedEffect(
            "outflows that draw in", _drawing_in, "there is no outflow, or no inertia that fluid could bring along"
        ),
        "pressure_datum": DerivedEffect("pressure without a datum", _closed, "the pressure at outflows is 0"),
    },
    invariants=(Invariant(in_time, "a flow cannot become steady, or unsteady, during an edit", "make it two scenes"),),
    pictured={
        "pressure": PictureField("pressure", "Pa", signed=True, quantity=("pressure", True)),
        "speed": PictureField("speed", "m/s", quantity=("speed", True)),
    },
    vectors={"velocity": PictureField("velocity", "m/s")},
    orders=(1,),
    check=check_flow,
    check_shape="restshape.physics.flow.flow_conditions:check_shape",
    inspect_shape="restshape.physics.flow.flow_inspection:inspect_flow",
    instead=dict.fromkeys(("supports", "loads"), CONDITION) | {"material": "a fluid has its values in [fluid]"},
)
