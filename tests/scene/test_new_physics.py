"""A physics that the library does not know, declared here alone: scenes, units, formulas, messages, schema, check."""

import json
from pathlib import Path
from typing import Annotated, Literal

import pytest
from pydantic import Field

from restshape.application import Application, application, applications
from restshape.cli.main import main
from restshape.cli.schema import scene_schema
from restshape.errors import UserError
from restshape.physics.elasticity.elasticity_declaration import PLANE_SOLIDS
from restshape.scene.effect import Effect
from restshape.scene.load import load_scene, revise
from restshape.scene.load_kind import AREAS, CURVES, LoadKind
from restshape.scene.model import Material
from restshape.scene.physics import Physics
from restshape.scene.plan import plan
from restshape.scene.quantity import QuantityKind
from restshape.scene.solver import DEFINITE, SolverPlan, System
from restshape.scene.units import declare_dimension
from restshape.scene.values import Strict, number_of, value_of

CONDUCTIVITY = declare_dimension("conductivity", "W/(m K)", "50 W/(m K)")
HEAT_FLUX = declare_dimension("heat flux", "W/m^2", "2 kW/m^2")
HEAT_SOURCE = declare_dimension("heat source", "W/m^3", "1 MW/m^3")
TRANSFER = declare_dimension("heat transfer", "W/(m^2 K)", "10 W/(m^2 K)")


class HeatMaterial(Material):
    """What conducts."""

    conductivity: Annotated[number_of(CONDUCTIVITY), Field(gt=0)]


class Convection(Strict):
    """Heat that the air takes."""

    h: value_of(TRANSFER)
    ambient: value_of("temperature") = 293.15


class Steady(Strict):
    """Nothing to choose."""


def solver(scene, on, settings) -> SolverPlan:
    """One solve a frame."""
    return SolverPlan(
        "linear", (System("temperature", DEFINITE, "cg", "cholesky", "heat flows down"),), "Fourier's law"
    )


HEAT = Physics(
    name="heat",
    summary="conduction",
    solver=solver,
    material=HeatMaterial,
    materials={"steel": {"conductivity": "50 W/(m K)"}, "brass": {}},
    boundary={"temperature": "temperature"},
    loads={
        "flux": LoadKind(value_of(HEAT_FLUX), CURVES, "heat that comes in"),
        "convection": LoadKind(Convection, CURVES, "to the air"),
        "source": LoadKind(value_of(HEAT_SOURCE), AREAS, "by volume"),
    },
    quantities={
        "temperature": QuantityKind(Literal[True], "temperature", "max"),
        "heat_flow": QuantityKind(Literal[True], "power", "sum"),
    },
    effects={"conduction": Effect(Steady, "steady conduction", required=True)},
)
FIN = """
format = "restshape-scene"
version = 1
app = "fins"
[parameters]
q = "2 kW/m^2"
[shape]
outline = ["a", "b", "c"]
vertices = { p = [0, 0], q = [1, 0], r = [0, 1] }
[shape.edges]
a = { line = ["p", "q"] }
b = { line = ["q", "r"] }
c = { line = ["r", "p"] }
[material.body]
conductivity = "0.2 kW/(m K)"
[supports.base]
on = "a"
fix = { temperature = "80 degC" }
[loads]
hot = { on = "b", flux = "q*(1 + x)" }
air = { on = "c", convection = { h = "10 W/(m^2 K)", ambient = "20 degC" } }
[mesh]
size = 0.2
[quantities]
peak = { temperature = true, limit = "90 degC" }
out = { heat_flow = true, at = "a" }
"""


def fins(*physics: Physics) -> Application:
    return Application("fins", "fins that cool", Path(__file__).parent, physics, "")


def others() -> list[Application]:
    """The installed applications but those of heat, whose keys have a meaning of their own."""
    return [app for app in applications().values() if all(one.name != "heat" for one in app.physics)]


@pytest.fixture
def fin(tmp_path, install):
    """Reads a scene of fins with some of its text replaced."""
    install(*others(), fins(HEAT))

    def read(old: str = "", new: str = ""):
        assert old in FIN
        path = tmp_path / "fin.toml"
        path.write_text(FIN.replace(old, new) if old else FIN)
        return load_scene(path)

    return read


def test_units_and_formulas_are_those_of_the_physics(fin):
    scene = fin()
    assert scene.material["body"].conductivity == 200.0
    assert scene.supports["base"].fix == {"temperature": 353.15}
    assert scene.loads["hot"].flux.evaluate(0.5, 0.0, scene.parameters) == 3000.0
    assert (scene.loads["air"].kind, scene.loads["air"].convection.ambient) == ("convection", 293.15)
    peak, out = scene.quantities["peak"], scene.quantities["out"]
    assert (peak.reduce, peak.max, out.reduce, out.dimension) == ("max", 363.15, "sum", "power")
    assert revise(scene, "material.body.conductivity", "50 W/(m K)").material["body"].conductivity == 50.0
    assert revise(scene, "loads.air.convection.h", 20).loads["air"].convection.h == 20.0
    assert fin('conductivity = "0.2 kW/(m K)"', 'name = "steel"').material["body"].conductivity == 50.0


@pytest.mark.parametrize(
    ("old", "new", "where", "what", "do"),
    [
        ("conductivity", "conductivty", "material.body.conductivty (line 15)", "no key", "'conductivity'"),
        ('"0.2 kW/(m K)"', '"3 MPa"', "material.body.conductivity", "a conductivity is wanted", "50 W/(m K)"),
        ('conductivity = "0.2 kW/(m K)"', 'name = "brass"', "material.body.conductivity", "missing", "add it"),
        ("{ temperature =", "{ temprature =", "supports.base.fix.temprature", "no key", "'temperature'"),
        ('"80 degC"', '"8 mm"', "supports.base.fix.temperature", "a length", "20 degC"),
        ('{ temperature = "80 degC" }', '["x"]', "supports.base.fix", "knows no direction 'x'", "temperature"),
        ('flux = "q*(1 + x)"', "flox = 1", "loads.hot.flox", "no key", "'flux'"),
        ('flux = "q*(1 + x)"', "pressure = 1", "loads.hot.pressure", "no load of the kind 'pressure'", "flux"),
        ('"q*(1 + x)"', '"q*(1 + z)"', "loads.hot.flux", "names 'z'", ""),
        ('"q*(1 + x)"', '"q*q"', "loads.hot.flux", "a heat flux is wanted", "2 kW/m^2"),
        ('h = "10 W/(m^2 K)"', 'h = "10 W"', "loads.air.convection.h", "a heat transfer is wanted", ""),
        ('{ on = "b", flux = "q*(1 + x)" }', '{ on = "p", flux = 1 }', "loads.hot.on", "cannot act on 'p'", "edge"),
        ('limit = "90 degC"', 'limit = "9 kW"', "quantities.peak.max", "a power", "20 degC"),
        ("heat_flow = true", 'stress = "xx"', "quantities.out.stress", "no quantity of the kind", "heat_flow"),
        ("[mesh]\n", "[mesh]\nlayers = 2\n", "mesh.layers", "no layers", "leave it out"),
        ("[mesh]\n", "[mesh]\norder = 2\n", "mesh.order", "no elements of order 2", "1"),
    ],
)
def test_what_is_wrong_is_reported_with_place_and_remedy(fin, old, new, where, what, do):
    with pytest.raises(UserError) as caught:
        fin(old, new)
    assert where in caught.value.where and what in caught.value.what and do in caught.value.do


def test_what_is_needed_of_a_material_is_what_the_physics_need(fin, install, tmp_path):
    material = type(fin().material["body"])
    assert set(material.model_fields) == {"name", "region", "conductivity"}
    install(fins(HEAT, PLANE_SOLIDS))
    with pytest.raises(UserError, match="'E' is missing"):
        load_scene(tmp_path / "fin.toml")
    both = load_scene(tmp_path / "fin.toml", ["material.body.E=1e9", "material.body.nu=0.3"])
    assert (both.material["body"].E, both.material["body"].conductivity) == (1e9, 200.0)
    assert both.supports["base"].fix == {"temperature": 353.15} and both.mesh.order == 1


def test_its_equations_and_effects_are_planned(fin):
    planned = plan(fin(), application("fins"))
    assert planned.on("conduction") and planned.solver.equations == "linear" and planned.solver.symmetric


def test_the_schema_holds_its_keys(fin):
    definitions = scene_schema()["$defs"]
    assert "conductivity" in definitions["Material"]["properties"]
    assert {"flux", "convection", "source"} <= set(definitions["Load"]["properties"])
    assert {"temperature", "heat_flow"} <= set(definitions["Quantity"]["properties"])
    assert "temperature" in json.dumps(definitions["Support"])
    assert "conduction" in scene_schema()["properties"]["effects"]["properties"]


def test_check_shows_its_keys_with_units(fin, tmp_path, capsys):
    fin()
    assert main(["check", str(tmp_path / "fin.toml")]) == 0
    reported = " ".join(capsys.readouterr().out.split())
    for words in (
        "conductivity 200 W/(m K)",
        "temperature = 353.15 K on a",
        "flux q*(1 + x) W/m^2 on b",
        "convection h 10 W/(m^2 K), ambient 293.15 K on c",
        "holds up to 363.15 K",
        "effect conduction on",
    ):
        assert words in reported
