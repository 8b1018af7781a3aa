"""What scenes of fluids may say of heat: beside what `physics.flow` declares, with which it shares tables."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from restshape.physics.heat.heat_declaration import CONDUCTIVITY, HEAT, HEAT_FLUX, HEAT_SOURCE, SPECIFIC_HEAT
from restshape.physics.heated_flow.heated_flow_checks import check_heated_flow
from restshape.physics.heated_flow.temperature_differences import differences, unheated
from restshape.scene.derived_effects import On
from restshape.scene.effect import DerivedEffect, Effect, StartOnly
from restshape.scene.load_kind import CURVES
from restshape.scene.model import Scene
from restshape.scene.physics import Physics, PictureField, Section
from restshape.scene.quantity import QuantityKind, of_the_end
from restshape.scene.solver import DEFINITE, UNSYMMETRIC, SolverPlan, System
from restshape.scene.units import UnitError, declare_dimension
from restshape.scene.values import Entities, Strict, number_of, only_one, value_of

DIFFUSIVITY = declare_dimension("diffusivity", "m^2/s", "2.1e-5 m^2/s")
EXPANSION = declare_dimension("expansion", "1/K", "3.4e-3 1/K")
DIFFERENCE = declare_dimension("temperature difference", "K", "15 K")


class HeatedFluid(Strict):
    """What ``[fluid]`` says of heat.

    Args:
        conductivity: by Fourier's law [W/(m K)].
        heat_capacity: by mass [J/(kg K)].
        diffusivity: conductivity over heat capacity by volume [m^2/s], in place of one of them, or of both.
        expansion: part by which the volume grows with each kelvin [1/K].
        reference: temperature at which nothing lifts the fluid [K].
    """

    conductivity: Annotated[number_of(CONDUCTIVITY), Field(gt=0)] | None = None
    heat_capacity: Annotated[number_of(SPECIFIC_HEAT), Field(gt=0)] | None = None
    diffusivity: Annotated[number_of(DIFFUSIVITY), Field(gt=0)] | None = None
    expansion: Annotated[number_of(EXPANSION), Field(ge=0)] | None = None
    reference: number_of("temperature") | None = None

    @model_validator(mode="before")
    @classmethod
    def _gives_heat_once(cls, raw: object) -> object:
        three = ("conductivity", "heat_capacity", "diffusivity")
        if isinstance(raw, dict) and raw.keys().isdisjoint({"name"}) and raw.keys() >= set(three):
            raise UnitError(f"{', '.join(three)} are given, and two of them give the third", "take one of them out")
        return raw


class HeatedEdge(Strict):
    """What ``[boundary.NAME]`` says of heat: at most one of its keys; without any, the edge is insulated.

    Where edges with two temperatures meet, the one that is named first has the corner.

    Args:
        temperature: of the fluid at the edges [K], a formula of x, y and the time t.
        heat_flux: heat that enters by the edges [W/m^2].
        insulated: none does.
    """

    temperature: value_of("temperature", timed=True) | None = None
    heat_flux: value_of(HEAT_FLUX, timed=True) | None = None
    insulated: Literal[True] | None = None

    @model_validator(mode="after")
    def _has_one_condition_of_heat(self) -> Self:
        keys = ("temperature", "heat_flux", "insulated")
        present = [key for key in keys if getattr(self, key) is not None]
        if len(present) > 1:
            what = f"at most one of {', '.join(keys)} is wanted here, but there is {' and '.join(present)}"
            raise UnitError(what, f"keep one of them: {' or '.join(present)}")
        return self


class HeatSource(Strict):
    """``[heat.NAME]``: heat that is set free inside of the fluid.

    Args:
        on: regions, or ``all``.
        source: by volume [W/m^3].
    """

    on: Entities
    source: value_of(HEAT_SOURCE)


class Heat(Strict):
    """``[effects.heat]``: the temperature of the fluid, which flow carries and conduction evens out.

    Args:
        coupling: velocity, pressure and temperature are found together, or in turn until both equations hold.
        initial: temperature at time 0 [K]; left out, ``fluid.reference``.
    """

    coupling: Literal["monolithic", "split"] = "monolithic"
    initial: Annotated[number_of("temperature") | None, StartOnly()] = None


class Buoyancy(Strict):
    """``[effects.buoyancy]``: warm fluid rises, by the approximation of Boussinesq."""


class Gravity(Strict):
    """``[effects.gravity]``: the acceleration of the fluid, of which buoyancy alone is left.

    Args:
        g: acceleration (x, y) [m/s^2].
    """

    g: Annotated[list[number_of("acceleration")], Field(min_length=2, max_length=2)] = [0.0, -9.81]


class NusseltNumber(Strict):
    """``{ length = ..., difference = ... }``: the mean heat flux q into the fluid as q length / (k difference).

    Args:
        length: of the vessel [m].
        difference: temperature of the edge less that of the fluid, or of the other edge [K]; not where heat fluxes are
            given, for then all of the number would be.
        against: in place of it an edge, a region or ``all``: the difference is that of mean temperatures, there and at
            the edge.
    """

    length: Annotated[number_of("length"), Field(gt=0)]
    difference: number_of(DIFFERENCE) | None = None
    against: str | None = None

    @model_validator(mode="after")
    def _is_a_difference(self) -> Self:
        only_one(self, ("difference", "against"))
        if self.difference == 0.0:
            raise UnitError("difference is 0, and heat fluxes are divided by it", "give the difference that drives it")
        return self


def heated_flow_plan(scene: Scene, on: On, settings: Mapping[str, Any]) -> SolverPlan | None:
    """Which equations heat makes, and which solver they get; None where no temperature differs."""
    if not differences(scene, on):
        return None
    if "flow" not in on:
        system = System("temperature", DEFINITE, "cg", "cholesky", "heat flows from warm to cold alone")
        return SolverPlan("linear", (system,), "nothing flows: heat is conducted")
    why = "in one matrix with the flow" if settings["heat"].coupling == "monolithic" else "in turn with the flow"
    system = System("temperature", UNSYMMETRIC, "gmres", "lu", f"the flow carries heat; {why}")
    return SolverPlan("nonlinear", (system,), "heat is advected by the velocity that is looked for")


ELSEWHERE = "solids alone have them: fluids have [fluid], [boundary.NAME] and [heat.NAME]"
HEATED_FLOW = Physics(
    name="heated flow",
    summary="heat and buoyancy in fluids",
    solver=heated_flow_plan,
    sections={
        "fluid": Section(HeatedFluid, "what flows", required=True, shared=True),
        "boundary": Section(HeatedEdge, "what happens at edges", named=True, shared=True),
        "heat": Section(HeatSource, "heat that is set free inside", named=True),
    },
    quantities=of_the_end(
        {
            "temperature": QuantityKind(Literal[True], "temperature", "mean", summary="temperature of an entity"),
            "bulk_temperature": QuantityKind(
                Literal[True],
                "temperature",
                "mean",
                reductions=("mean",),
                summary="temperature of what flows through an edge",
                on=CURVES,
            ),
            "heat_flow": QuantityKind(Literal[True], "power", "sum", summary="heat that leaves by an edge", on=CURVES),
            "nusselt": QuantityKind(
                NusseltNumber,
                "number",
                "mean",
                reductions=("mean",),
                summary="Nusselt number of the heat that enters by an edge",
                on=CURVES,
            ),
        }
    ),
    effects={
        "heat": Effect(
            Heat,
            "the temperature of the fluid",
            kernels=("heated_", "unsteady_heated_", "advected_", "conduction"),
            repeats=("buoyancy",),
            without=unheated,
        ),
        "buoyancy": Effect(Buoyancy, "warm fluid rises", drives=True, kernels=("lifted_", "unsteady_lifted_")),
        "storage": HEAT.effects["storage"],
        "gravity": Effect(Gravity, "the direction in which warm fluid rises", acceleration="g", repeats=("buoyancy",)),
    },
    derived={
        "temperature_difference": DerivedEffect(
            "temperatures that differ",
            differences,
            "no temperature differs from another: heat has no equation, and nothing is buoyant",
            needs="heat",
        ),
    },
    pictured={"temperature": PictureField("temperature", "K", from_zero=False, quantity=("temperature", True))},
    orders=(1,),
    check=check_heated_flow,
    check_shape="restshape.physics.heated_flow.heated_flow_conditions:check_heated_shape",
    inspect_shape="restshape.physics.heated_flow.heated_flow_inspection:inspect_heated_flow",
    instead={key: f"leave it out: {ELSEWHERE}" for key in ("material", "supports", "loads")},
)
