"""Scenes of heat in fluids that a new user may write: each is refused with what, where, and what to do."""

import pytest
from restshape_apps.thermal import application

SCENE = (application.folder / "scenes" / "thermal.toml").read_text(encoding="utf-8")
OWN = "rho = 1000\nmu = 1e-3\nconductivity = 0.6\nheat_capacity = 4180"
GRAVITY, REFERENCE, WARM = (
    'gravity = { g = [0, "-9.81 m/s^2"] }\n',
    'reference = "20 degC"\n',
    'temperature = "21 degC - 1 K*(x/22 mm)^4"',
)
EFFECTS = "[effects]"
REFUSED = {
    "no gravity": (GRAVITY, "", "effects.buoyancy (line", "buoyancy needs gravity", "add gravity = {"),
    "no expansion": ('name = "water"', OWN, "fluid.expansion (line", "buoyancy needs fluid.expansion", "3.4e-3 1/K"),
    "no T0": (REFERENCE, "", "fluid.reference (line", "buoyancy needs fluid.reference", '"20 degC"'),
    "no conductivity": (
        'name = "water"',
        "rho = 1\nmu = 1\nexpansion = 1",
        "fluid (line",
        "conducts it",
        "diffusivity",
    ),
    "thrice": (
        'name = "water"',
        f"{OWN}\ndiffusivity = 1e-7\nexpansion = 1e-4",
        "fluid (line",
        "give the third",
        "out",
    ),
    "a scale": ('"1 K"', '"1 degC"', "nusselt.difference (line", "a temperature on a scale, but a", "difference in K"),
    "no difference": ('"1 K"', "0", "quantities.nusselt.nusselt (line", "difference is 0", "give the difference"),
    "no heat": ("heat = {}\n", "", "boundary.stove.temperature (line", "heat is off", "add [effects.heat]"),
    "no flow": ('flow = { time_step = "500 ms" }\n', "", "effects.buoyancy (line", "flow is off", "add [effects.flow]"),
    "supports": (
        EFFECTS,
        '[supports.s]\non = "lid"\nfix = {}\n[effects]',
        "supports.s (line",
        "no [supports",
        "[boundary",
    ),
    "loads": (EFFECTS, '[loads.s]\non = "lid"\nflux = 3\n[effects]', "loads.s (line", "no [loads.NAME]", "[boundary"),
    "material": (EFFECTS, "[material.m]\nrho = 3\n[effects]", "material.m (line", "no [material.NAME]", "in [fluid]"),
    "too cold": (
        WARM,
        'temperature = "-300 degC"',
        "boundary.stove.temperature (line",
        "below absolute zero",
        "higher",
    ),
    "both": (WARM, f"{WARM}\nheat_flux = 3", "boundary.stove (line", "temperature and heat_flux", ""),
    "a power": (WARM, 'heat_flux = "3 W"', "heat_flux (line", "is a power, but a heat flux is wanted", "kW/m^2"),
    "at an edge": (
        EFFECTS,
        '[heat.h]\non = "lid"\nsource = 3\n[effects]',
        "heat.h.on (line",
        "which is an edge",
        "region",
    ),
    "no condition": ('on = "bottom"\nwall = true', 'on = "bottom"', "boundary.stove (line", "none of them", ""),
    "storage": (
        "heat = {}",
        'heat = {}\nstorage = { time_step = "1 s", initial = "20 degC" }',
        "effects.storage (line",
        "a fluid that does not flow",
        "leave it out",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_refused(name, command, tmp_path):
    before, after, where, what, do = REFUSED[name]
    assert before in SCENE
    (tmp_path / "scene.toml").write_text(SCENE.replace(before, after, 1), encoding="utf-8")
    done = command("check", "scene.toml")
    assert done.returncode == 2
    assert "scene.toml: " in done.stderr and where in done.stderr and what in done.stderr, done.stderr
    assert do in done.stderr.partition("try: ")[2], done.stderr


@pytest.mark.parametrize(("gravity", "moves"), [('[0, "-9.81 m/s^2"]', True), ("[0, 0]", False)])
def test_a_fluid_that_nothing_moves_is_warned_of(gravity, moves, command, tmp_path):
    (tmp_path / "scene.toml").write_text(SCENE.replace('[0, "-9.81 m/s^2"]', gravity), encoding="utf-8")
    done = command("check", "scene.toml")
    assert done.returncode == 0, done.stderr
    assert ("nothing moves the fluid" in done.stdout) != moves


BODY = """format = "restshape-scene"
version = 1
app = "thermal"
[shape]
outline = ["below", "right", "above", "left"]
vertices = { a = [0, 0], b = [1, 0], c = [1, 1], d = [0, 1] }
[shape.edges]
below = { line = ["a", "b"] }
right = { line = ["b", "c"] }
above = { line = ["c", "d"] }
left = { line = ["d", "a"] }
[material.m]
conductivity = 1
[supports.hot]
on = "below"
fix = { temperature = 300 }
[supports.cold]
on = "right"
fix = { temperature = "300 + 5*y" }
[mesh]
size = 0.2
"""


@pytest.mark.parametrize(
    ("text", "jump"),
    [
        (SCENE, ""),
        (SCENE.replace(WARM, 'temperature = "21 degC"'), "jumps by 1 K where 'bottom' and 'belly' meet"),
        (SCENE.replace(WARM, 'temperature = "21 degC + 2 K*t"'), "jumps by 3 K where 'bottom' and 'belly' meet"),
        (BODY, ""),
        (BODY.replace("300 + 5*y", "305 - 5*y"), "jumps by 5 K where 'below' and 'right' meet"),
        (BODY.replace('on = "right"', 'on = "above"').replace("300 + 5*y", "310"), ""),
    ],
)
def test_temperatures_that_jump_between_edges_are_warned_of(text, jump, command, tmp_path):
    (tmp_path / "scene.toml").write_text(text, encoding="utf-8")
    done = command("check", "scene.toml")
    assert done.returncode == 0, done.stderr
    assert jump in done.stdout and ("jumps" in done.stdout) == bool(jump), done.stdout


@pytest.mark.parametrize("kind", [(), ("--kind", "fluid")])
def test_no_template_has_temperatures_that_jump(kind, command):
    assert command("new", "thermal", "mine", *kind).returncode == 0
    done = command("check", "mine/scene.toml")
    assert done.returncode == 0 and "jumps" not in done.stdout, done.stdout
