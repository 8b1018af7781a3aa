"""What scenes of heat conduction may say."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import Field

from restshape.scene.derived_effects import On
from restshape.scene.effect import Effect, StartOnly
from restshape.scene.load_kind import AREAS, CURVES, LoadKind
from restshape.scene.materials import library
from restshape.scene.model import Material, Scene
from restshape.scene.physics import Invariant, Physics, PictureField
from restshape.scene.quantity import QuantityKind
from restshape.scene.solver import DEFINITE, SolverPlan, System
from restshape.scene.source import Source
from restshape.scene.units import declare_dimension
from restshape.scene.values import Number, Strict, Whole, number_of, value_of

CONDUCTIVITY = declare_dimension("conductivity", "W/(m K)", "50 W/(m K)")
SPECIFIC_HEAT = declare_dimension("specific heat", "J/(kg K)", "900 J/(kg K)")
HEAT_FLUX = declare_dimension("heat flux", "W/m^2", "2 kW/m^2")
HEAT_SOURCE = declare_dimension("heat source", "W/m^3", "1 MW/m^3")
FILM = declare_dimension("film coefficient", "W/(m^2 K)", "25 W/(m^2 K)", least=0.0)


class ThermalMaterial(Material):
    """``[material.NAME]``: what conducts heat, and with density and specific heat stores it."""

    conductivity: Annotated[number_of(CONDUCTIVITY), Field(gt=0, description="by Fourier's law [W/(m K)]")]
    specific_heat: Annotated[number_of(SPECIFIC_HEAT), Field(ge=0, description="heat capacity [J/(kg K)]")] = 0.0
    rho: Annotated[number_of("density"), Field(ge=0, description="density [kg/m^3]")] = 0.0
    thickness: Annotated[number_of("length"), Field(gt=0, description="of the body [m]")] = 1.0


class Convection(Strict):
    """``{ film = ..., ambient = ... }``: film (T - ambient) leaves by each unit of area."""

    film: Annotated[value_of(FILM), Field(description="film coefficient [W/(m^2 K)]")]
    ambient: Annotated[value_of("temperature"), Field(description="temperature around the body [K]")]


class Storage(Strict):
    """``[effects.storage]``: the temperature in time by the theta method; the first frame shows it at time 0.

    ``steps`` steps of ``time_step`` [s] a frame; ``theta`` is 1 for backward Euler, 1/2 for Crank and Nicolson.
    """

    time_step: Annotated[number_of("time"), Field(gt=0, description="of one step [s]")]
    steps: Annotated[Whole, Field(ge=1, description="time steps a frame")] = 1
    theta: Annotated[Number, Field(ge=0.5, le=1, description="1: backward Euler, 1/2: Crank and Nicolson")] = 1.0
    initial: Annotated[number_of("temperature"), StartOnly(), Field(description="temperature at time 0 [K]")]
    capacity: Annotated[Literal["consistent", "lumped"], Field(description="matrix of storage")] = "consistent"


def heat_plan(scene: Scene, on: On, settings: Mapping[str, Any]) -> SolverPlan:
    """Which equations conduction makes, and which solver they get."""
    system = System("temperature", DEFINITE, "cg", "cholesky", "heat flows from warm to cold alone")
    frame = "one matrix for all time steps of a frame" if "storage" in on else "one solve a frame"
    return SolverPlan("linear", (system,), f"conductivity does not depend on temperature: {frame}")


def convections(scene: Scene, on: On) -> dict[str, list[str]]:
    """Where each convection acts: the pattern of the matrix depends on it."""
    return {name: list(load.on) for name, load in scene.loads.items() if load.kind == "convection"}


def check_heat(scene: Scene, source: Source) -> None:
    """Refuses bodies that store no heat though they should, and steady temperatures that nothing holds.

    Raises:
        UserError: there is one.
    """
    stored = "storage" in scene.effects
    for name in (name for name, m in scene.material.items() if stored and not m.rho * m.specific_heat):
        do = 'give it rho and specific_heat, e.g. "2700 kg/m^3" and "900 J/(kg K)"'
        raise source.error(("material", name), "a body without heat capacity cannot be followed in time", do)
    films = [load.convection.film for load in scene.loads.values() if load.kind == "convection"]
    if not (stored or any(films) or any("temperature" in support.fix for support in scene.supports.values())):
        what = "nothing holds the temperature: no edge has a fixed one, or a convection with a film above 0"
        do = 'fix one, as in fix = { temperature = "20 degC" } on an edge, or add a convection or [effects.storage]'
        raise source.error(("supports",), what, do)


HEAT = Physics(
    name="heat",
    summary="conduction of heat in the plane, steady and in time",
    solver=heat_plan,
    material=ThermalMaterial,
    materials=library("conductivity"),
    boundary={"temperature": "temperature"},
    loads={
        "source": LoadKind(value_of(HEAT_SOURCE), AREAS, "heat [W/m^3] set free inside"),
        "flux": LoadKind(value_of(HEAT_FLUX), CURVES, "heat [W/m^2] that enters by an edge"),
        "convection": LoadKind(Convection, CURVES, "heat that leaves by an edge to an ambient"),
    },
    quantities={
        "temperature": QuantityKind(Literal[True], "temperature", "mean", summary="temperature of an entity"),
        "heat_flow": QuantityKind(Literal[True], "power", "sum", summary="heat that leaves by an edge", on=CURVES),
    },
    effects={
        "storage": Effect(Storage, "the temperature in time", fixed=True, transient=True, kernels=("heat_cap",)),
    },
    invariants=(Invariant(convections, "where convection acts cannot change", "set its film to 0 instead"),),
    pictured={
        "temperature": PictureField("temperature", "K", from_zero=False, quantity=("temperature", True)),
        "heat_flux": PictureField("heat flux", "W/m^2"),
    },
    orders=(2, 1),
    check=check_heat,
    check_shape="restshape.fem.edge_reactions:check_heat_flows",
    inspect_shape="restshape.physics.heat.temperature_jumps:inspect_conduction",
)
