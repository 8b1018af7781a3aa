"""What scenes of fluids may say of heat, and the messages for those that make no sense."""

import pytest
from restshape_studies.explain.without import without
from restshape_studies.stability.scenery import make_replay, set_value, write_scene, write_script
from restshape_verification.flow.heated_scenes import BUOYANT, CAVITY, HEAD, STEADY
from thermal_scenes import solved

from restshape.application import application_of, applications
from restshape.errors import UserError
from restshape.physics.heated_flow.fluid_heat import heat_properties
from restshape.scene.load import load_scene
from restshape.scene.plan import plan

TEXT = CAVITY + STEADY + BUOYANT + "[mesh]\nsize = 0.25\n"
GRAVITY = 'gravity = { g = [0, "-1 m/s^2"] }\n'
FLUX = 'wall = true\nheat_flux = "2 W/m^2"'
WARM = 'wall = true\ntemperature = "300.5 K"'


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("diffusivity = 1\n", ""), "heat needs to know how the fluid conducts it"),
        (("diffusivity = 1\n", "conductivity = 1\n"), "heat needs to know how the fluid conducts it"),
        (("diffusivity = 1", 'diffusivity = "1 m^2"'), "diffusivity is wanted"),
        (('expansion = "Ra*Pr"\n', ""), "buoyancy needs fluid.expansion"),
        (('expansion = "Ra*Pr"', 'expansion = "3 1/degC"'), "a scale of temperatures, which is no unit"),
        (('reference = "300 K"\n', ""), "buoyancy needs fluid.reference"),
        ((GRAVITY, ""), "buoyancy needs gravity"),
        (("heat = {}\n", ""), "heat is off, so that this says nothing"),
        (("flow = { steady = true }\n", ""), "buoyancy moves a fluid, and flow is off"),
        (("heat = {}", "heat = {}\nstorage = { time_step = 1, initial = 300 }"), "heat in a fluid that does not flow"),
        ((WARM, FLUX), "by fluid.conductivity|needs the conductivity"),
        ((WARM, WARM + "\ninsulated = true"), "at most one of temperature, heat_flux, insulated"),
        ((WARM, 'temperature = "300 K"'), "exactly one of velocity, wall, slip, outflow"),
        ((WARM, WARM.replace('"300.5 K"', '"300 + t"')), "depends on the time t, and the temperature is steady"),
        (('difference = "1 K"', 'difference = "1 degC"'), "a temperature difference is wanted"),
        (('difference = "1 K"', "difference = 0"), "difference is 0"),
        (("[mesh]", '[heat.h]\non = "left"\nsource = 1\n[mesh]'), "needs the conductivity"),
        (("[mesh]", '[supports.s]\non = "left"\nfix = { temperature = 1 }\n[mesh]'), "supports|direction"),
        (("[mesh]", '[loads.l]\non = "left"\nflux = 1\n[mesh]'), "loads|load"),
        (("[mesh]", "[material.m]\nconductivity = 1\n[mesh]"), "conductivity|material"),
    ],
)
def test_messages(tmp_path, change, message):
    assert change[0] in TEXT
    with pytest.raises(UserError, match=message):
        load_scene(write_scene(tmp_path, TEXT.replace(*change, 1)))


def test_a_flux_needs_a_temperature_somewhere(tmp_path):
    text = TEXT.replace("diffusivity = 1", "conductivity = 1\nheat_capacity = 1").replace(WARM, FLUX)
    with pytest.raises(UserError, match="nothing holds the temperature"):
        load_scene(write_scene(tmp_path, text.replace('\ntemperature = "299.5 K"', "")))


def test_a_source_is_in_an_area(tmp_path):
    text = TEXT.replace("diffusivity = 1", "conductivity = 1\nheat_capacity = 1")
    for at, message in (("left", "which is an edge"), ("core", "there is no entity 'core'")):
        with pytest.raises(UserError, match=message):
            load_scene(write_scene(tmp_path, text + f'[heat.h]\non = "{at}"\nsource = 1\n'))


def test_a_body_has_no_boundary(tmp_path):
    text = HEAD + "[material.m]\nconductivity = 1\n"
    with pytest.raises(UserError, match=r"has no table 'boundary'|add \[fluid\]"):
        load_scene(write_scene(tmp_path, text + '[boundary.b]\non = "left"\nwall = true\n[mesh]\nsize = 1\n'))


@pytest.mark.parametrize(
    ("keys", "found"),
    [
        ("conductivity = 3\nheat_capacity = 5", (10.0, 3.0)),
        ("conductivity = 3\ndiffusivity = 2", (1.5, 3.0)),
        ("diffusivity = 2", (1.0, 2.0)),
        ('name = "water"', (2 * 4182.0, 0.603)),
        ('name = "water"\ndiffusivity = "1e-7 m^2/s"', (6.03e6, 0.603)),
    ],
)
def test_heat_capacity_and_conductivity(tmp_path, keys, found):
    text = TEXT.replace("rho = 1\n", "rho = 2\n").replace("diffusivity = 1", keys)
    assert heat_properties(load_scene(write_scene(tmp_path, text))) == pytest.approx(found)


def test_temperatures_are_on_scales_and_differences_are_not(tmp_path):
    text = TEXT.replace('"300.5 K"', '"20 degC"').replace("Ra*Pr", "3.4e-3 1/K")
    scene = load_scene(write_scene(tmp_path, text))
    assert scene.boundary["hot"].temperature == pytest.approx(293.15)
    assert scene.fluid.expansion == pytest.approx(3.4e-3)


def test_what_follows_from_a_scene(tmp_path):
    def derived(text):
        scene = load_scene(write_scene(tmp_path, text))
        return {one.name: one.why for one in plan(scene, application_of(scene)).derived if one.on}

    assert derived(TEXT)["temperature_difference"] == "boundary.hot.temperature is above boundary.cold.temperature"
    even = TEXT.replace("300.5 K", "300 K").replace("299.5 K", "300 K")
    assert "temperature_difference" not in derived(even)
    assert "reference" in derived(even.replace('reference = "300 K"', 'reference = "301 K"'))["temperature_difference"]
    assert "pressure_datum" in derived(even)


def test_scenes_of_bodies_are_as_they_were():
    seen = next(one for one in applications().values() if one.kinds).as_seen
    assert [one.orders for one in seen] == [(2, 1), (1,)]
    assert [set(one.effects) for one in seen] == [
        {"storage"},
        {"flow", "convection", "heat", "buoyancy", "storage", "gravity"},
    ]


def test_flow_cannot_become_unsteady(tmp_path):
    text = TEXT.replace("steady = true", "")
    script = write_script(tmp_path, set_value("effects.flow.time_step", 0.1))
    rows = [dict(row) for row in make_replay(write_scene(tmp_path, text), script).frames()]
    assert "cannot become steady, or unsteady" in rows[-1]["refused"]


def test_values_can_change_during_an_edit(tmp_path):
    text = TEXT.replace("diffusivity = 1", "conductivity = 1\nheat_capacity = 1")
    events = [
        *set_value("fluid.conductivity", 2),
        *set_value("fluid.heat_capacity", 3),
        *set_value("parameters.Ra", 2e4),
        *set_value("effects.gravity.g", [0, 1]),
        *set_value("boundary.cold.temperature", "299 + y"),
        *set_value("effects.heat.coupling", "split"),
    ]
    rows = [dict(row) for row in make_replay(write_scene(tmp_path, text), write_script(tmp_path, events)).frames()]
    values = [row["q_hot"] for row in rows]
    assert len({round(value, 6) for value in values[:-1]}) == len(values) - 1
    assert values[-1] == pytest.approx(values[-2], rel=1e-5)


def test_a_fluid_that_nothing_moves_any_more_is_at_rest(tmp_path):
    """What rounding leaves of an earlier flow is no flow, and no scale of residuals."""
    script = write_script(tmp_path, set_value("effects.gravity.g", [0, 0]))
    row = dict(list(make_replay(write_scene(tmp_path, TEXT), script).frames())[-1])
    assert row["residual"] <= 1e-6
    assert "rounding" not in row["note"]


def test_a_reynolds_number_names_the_speed_that_no_edge_gives(tmp_path):
    """In the message that no steady flow is found: with walls alone it is that which buoyancy may bring about."""
    analysis = solved(tmp_path, TEXT).analysis
    problem = analysis.state.problem
    assert problem.speed_words == f", and {problem.speed:.3g} m/s that buoyancy may bring about"
    assert problem.speed_words in analysis._search(analysis.state.equations)._reynolds()


def test_a_new_reference_lifts_as_before(tmp_path):
    """A closed vessel flows by differences alone: with another reference it has another pressure."""
    row = solved(tmp_path, TEXT).row
    other = solved(tmp_path, TEXT.replace('reference = "300 K"', 'reference = "280 K"')).row
    assert other["q_hot"] == pytest.approx(row["q_hot"], rel=1e-4)


def test_without_a_difference_there_is_the_flow_alone(tmp_path):
    """What `explain` runs beside a scene to know the price of heat."""
    text = TEXT.replace("diffusivity = 1", "conductivity = 1\nheat_capacity = 1").replace(
        "heat = {}", "heat = { initial = 300 }"
    )
    text += '[heat.h]\non = "all"\nsource = 1\n'
    scene = load_scene(
        write_scene(
            tmp_path, text.replace("[boundary.hot]", '[boundary.low]\non = "bottom"\n' + FLUX + "\n[boundary.hot]")
        )
    )
    effects = frozenset(scene.effects)
    part = application_of(scene).derived["temperature_difference"]
    assert "heat.h.source" in part.cause(scene, effects) and "boundary.low.heat_flux" in part.cause(scene, effects)
    alone = without(scene, application_of(scene), ["heat"])
    assert part.cause(alone, frozenset(alone.effects)) == "" and "buoyancy" not in alone.effects


def test_a_fluid_at_rest_has_no_speed(tmp_path):
    text = TEXT.replace("flow = { steady = true }\nconvection = {}\n", "").replace(BUOYANT, "")
    with pytest.raises(UserError, match="a speed is of a flow, and flow is off"):
        load_scene(write_scene(tmp_path, text.replace("[quantities]\n", "[quantities]\nfast = { speed = true }\n")))
