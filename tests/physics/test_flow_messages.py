"""Scenes of flow that a new user may write: each is refused with what, where, and what to do, or warned of."""

import pytest
from restshape_studies.stability.scenery import make_replay, set_value, write_scene, write_script

BASE = """format = "restshape-scene"
version = 1
app = "flow"
[shape]
outline = ["bottom", "outlet", "top", "inlet"]
vertices = { a = [0, 0], b = [3, 0], c = [3, 1], d = [0, 1] }
[shape.edges]
bottom = { line = ["a", "b"] }
outlet = { line = ["b", "c"] }
top = { line = ["c", "d"] }
inlet = { line = ["d", "a"] }
[shape.holes]
body = { circle = { center = [1, 0.5], radius = 0.15 } }
[fluid]
rho = 1.5
mu = 0.1
[boundary.inlet]
on = "inlet"
velocity = ["4*y*(1 - y)", 0]
[boundary.outlet]
on = "outlet"
outflow = true
[effects]
flow = { steady = true }
convection = {}
[mesh]
size = 0.3
[quantities]
drag = { drag = true, at = "body" }
"""
STREAM, END, EFFECTS, QUANTITY = '["4*y*(1 - y)", 0]', "outflow = true", "[effects]", 'drag = true, at = "body"'
SOLID = "[shape.regions.rock]\ncircle = { center = [2, 0.5], radius = 0.2 }\n"
INSTEAD = "say in [boundary.NAME] what the fluid does at an edge"

REFUSED = {
    "viscosity 0": ("mu = 0.1", "mu = 0", "fluid.mu (line 16): 0 is too small: it must be greater than 0", ""),
    "no viscosity": ("mu = 0.1\n", "", "fluid (line 14): the fluid has no viscosity mu", 'known: "air"'),
    "no values": ("rho = 1.5\nmu = 0.1\n", "", "the fluid has no density rho and viscosity mu", "give it"),
    "kinematic": ("mu = 0.1", "nu = 1e-5", "nu is no key of a fluid, which has its dynamic", "write mu = rho nu"),
    "unknown fluid": ("rho = 1.5\nmu = 0.1", 'name = "oil"', "fluid.name (line 15): 'air'", "use one of: air, water"),
    "depth": ("mu = 0.1", "mu = 0.1\ndepth = -1", "fluid.depth (line 17): -1 is too small", ""),
    "two conditions": (END, f"{END}\nslip = true", "there is slip and outflow", "keep one of them: slip or outflow"),
    "no condition": (f"{END}\n", "", "but there is none of them", "add one of them"),
    "off by false": ("convection = {}", "convection = false", "wanted here, not False", "leave convection out"),
    "on by true": ("convection = {}", "convection = true", "wanted here, not True", "write convection = {}"),
    "an edge twice": (EFFECTS, '[boundary.x]\non = "inlet"\nwall = true\n[effects]', "two conditions", "take it out"),
    "no balance": (
        END,
        "wall = true",
        "boundary.inlet.velocity (line 19): 0.6668 m^2/s flow in and 0",
        "[boundary.outl",
    ),
    "a temperature": (STREAM, '["4 degC", 0]', "'4 degC' is a temperature, but a velocity is wanted", "1.5 m/s"),
    "a length": (STREAM, '["1 m", 0]', "boundary.inlet.velocity.0 (line 19): '1 m' is a length", "1.5 m/s"),
    "in a solid": (EFFECTS, f'{SOLID}[boundary.x]\non = "rock"\nvelocity = [1, 0]\n[effects]', "lies inside", "a hole"),
    "step": (
        "steady = true",
        "steady = true, time_step = 0.1",
        "effects.flow (line 24): a steady flow has no",
        "two scenes",
    ),
    "step 0": ("steady = true", "time_step = 0", "effects.flow.time_step (line 24): 0 is too small", ""),
    "supports": (EFFECTS, '[supports.s]\non = "top"\nfix = ["x"]\n[effects]', "no [supports.NAME]", INSTEAD),
    "loads": (EFFECTS, '[loads.s]\non = "top"\nforce = [1, 0]\n[effects]', "no [loads.NAME]", INSTEAD),
    "material": (EFFECTS, '[material.m]\nname = "steel"\n[effects]', "no [material.NAME]", "its values in [fluid]"),
    "no number": ("4*y*(1 - y)", "sqrt(y - 2)", "boundary.inlet.velocity (line 19): the expression is not", "change"),
    "t": ("4*y*(1 - y)", "t", "boundary.inlet.velocity.0 (line 19): 't' depends on the time t", "add a time_step"),
    "no boundary": ("[boundary.inlet]", None, "there is no [boundary.NAME]: all edges are walls", "add one, such as"),
    "one component": (STREAM, '["1"]', "two numbers [x, y] are wanted here", "write 2"),
    "one number": (
        STREAM,
        "1.0",
        "boundary.inlet.velocity (line 19): a velocity has components along x",
        "write [1.0, 0]",
    ),
    "one formula": (STREAM, '"1 m/s"', '"1 m/s" is one number', 'write ["1 m/s", 0]'),
    "no outflow": (END, "outflow = false", "true is wanted here, not false", "leave the key out"),
    "a pressure": (END, f"{END}\npressure = 3", "there is no key 'pressure' here", "use one of: on, velocity, wall"),
    "misspelt": (END, "outlow = true", "there is no key 'outlow' here", "did you mean 'outflow'?"),
    "nowhere": ('on = "outlet"\n', "", "boundary.outlet.on (line 20): the key 'on' is missing", "add it"),
    "at a vertex": ('on = "outlet"', 'on = "b"', "no condition on 'b', which is a vertex", "name an edge"),
    "a name": ('on = "outlet"', 'on = "outlett"', "there is no entity 'outlett'", "did you mean 'outlet'?"),
    "drag of nothing": (
        QUANTITY,
        'drag = true, at = "outlet"',
        "quantities.drag.at (line 29): the fluid leaves",
        "body",
    ),
    "no place": (QUANTITY, "drag = true", "quantities.drag (line 29): a drag needs a place", "say where"),
    "a stress": (QUANTITY, 'stress = "von_mises"', "no quantity of the kind 'stress'", "use one of: drag, lift"),
    "no length": (QUANTITY, 'drag_coefficient = { speed = 1 }, at = "body"', "the key 'length' is missing", "add it"),
    "order": ("size = 0.3", "size = 0.3\norder = 2", "no elements of order 2", "use one of: 1"),
    "turbulence": ("convection = {}", "turbulence = {}", "'flow' has no effect 'turbulence'", "use one of: convection"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_refused(name, command, tmp_path):
    """`check` ends with exit code 2 and one message: the file, the key and its line, what is wrong and what to do."""
    before, after, what, do = REFUSED[name]
    text = BASE.replace(before, after, 1) if after is not None else without_boundaries()
    assert before in BASE and text != BASE
    write_scene(tmp_path, text)
    done = command("check", "scene.toml")
    assert done.returncode == 2
    assert "scene.toml: " in done.stderr and what in done.stderr, done.stderr
    assert do in done.stderr.partition("try: ")[2], done.stderr


def without_boundaries():
    start, end = BASE.index("[boundary.inlet]"), BASE.index(EFFECTS)
    return BASE[:start] + BASE[end:]


@pytest.mark.parametrize(
    ("text", "warning"),
    [
        (BASE, ""),
        (BASE.replace(STREAM, "[0, 0]"), "nothing moves the fluid: velocities at edges are 0"),
        (BASE.replace(f"velocity = {STREAM}", END), "nothing moves the fluid: no edge has a velocity"),
    ],
)
def test_a_fluid_that_nothing_moves_is_warned_of(text, warning, command, tmp_path):
    write_scene(tmp_path, text)
    done = command("check", "scene.toml")
    assert done.returncode == 0, done.stderr
    assert warning in done.stdout and ("nothing moves" in done.stdout) == bool(warning)
    # rho u 0.3 m / mu, u at the middle of a part of the edge, and likewise of sides of 0.3 m.
    for words in (
        "4.5, of the size of body across the stream (300 mm)",
        "4.5, of the largest speed given and sides of",
    ):
        assert (words in done.stdout) == (not warning), done.stdout


TIMED = BASE.replace("steady = true", "time_step = 0.1, steps = 2")
CLOSED = TIMED.replace(END, "wall = true")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        # rho u L / mu of the length of 0.2 m, and 1 m/s * 0.1 s / 0.3 m.
        (
            TIMED.replace("drag = true", "drag_coefficient = { speed = 1, length = 0.2 }"),
            "3, of the length that quantities.drag",
        ),
        (TIMED, "Courant number        0.333, sides that"),
        (
            TIMED[: TIMED.index("[shape.holes]")] + TIMED[TIMED.index("[fluid]") : TIMED.index("drag =")],
            "15, of the size of the shape",
        ),
        (
            TIMED.replace(STREAM, '["t", 0]'),
            "90, of the size of body across the stream (300 mm) and the largest speed given, at 20 s",
        ),
    ],
    ids=["coefficient", "Courant", "channel", "largest of all times"],
)
def test_numbers_of_a_flow_say_what_they_are_of(text, words, command, tmp_path):
    write_scene(tmp_path, text)
    done = command("check", "scene.toml")
    assert done.returncode == 0 and words in done.stdout, done.stdout + done.stderr


def test_an_inflow_that_grows_without_outflow_is_refused_before_a_frame_is(command, tmp_path):
    write_scene(tmp_path, CLOSED.replace(STREAM, '["0.5*t", 0]'))
    done = command("check", "scene.toml")
    # Half of 0.2 s, on an edge of 1 m.
    assert done.returncode == 2 and "0.1 m^2/s flow in and 0 m^2/s out" in done.stderr, done.stderr
    write_scene(tmp_path, CLOSED.replace(STREAM, '["max(0, t - 1)", 0]'))
    done = command("check", "scene.toml")
    assert done.returncode == 0, done.stderr
    assert "boundary.inlet.velocity: at 1.2 s, in frame 6, 0.2 m^2/s flow in and 0 m^2/s out" in done.stdout, (
        done.stdout
    )
    assert "add one, such as [boundary.outlet]" in done.stdout


def test_a_steady_flow_that_will_hardly_be_one_is_warned_of(command, tmp_path):
    write_scene(tmp_path, BASE.replace("mu = 0.1", "mu = 1e-4"))
    done = command("check", "scene.toml")
    assert done.returncode == 0, done.stderr
    assert "at a Reynolds number of 4.5e+03 flows around bodies are hardly ever steady" in done.stdout, done.stdout
    assert "give [effects.flow] a time_step" in done.stdout


def test_edges_with_two_velocities_where_they_meet_are_no_supports(command, tmp_path):
    lid = '[boundary.lid]\non = "top"\nvelocity = [1, 0]\n'
    write_scene(tmp_path, BASE.replace("[boundary.outlet]", f"{lid}[boundary.outlet]"))
    found = command("replay", "scene.toml").stderr
    assert "two edges prescribe different values at (0, 1) m" in found and "let edges that meet agree" in found, found


@pytest.mark.parametrize(("viscosity", "counts"), [(0.1, True), (1.0, False)])
def test_a_flow_without_inertia_that_is_not_slow_is_warned_of(command, tmp_path, viscosity, counts):
    write_scene(tmp_path, BASE.replace("convection = {}\n", "").replace("mu = 0.1", f"mu = {viscosity}"))
    found = command("check", "scene.toml").stdout
    assert (
        "at a Reynolds number of 4.5 inertia counts where the fluid turns or speeds up, and the scene leaves it out"
        in found
    ) == counts, found


@pytest.mark.slow
def test_a_steady_flow_that_is_not_found_has_its_reynolds_number(command, tmp_path):
    text = BASE.replace("mu = 0.1", "mu = 1e-8").replace("size = 0.3", "size = 0.1\nnear = { body = 0.025 }")
    write_scene(tmp_path, text)
    done = command("replay", "scene.toml")
    assert done.returncode == 2
    assert (
        "no steady flow is found at a Reynolds number of 4.5e+07 (of the size of body across the stream)" in done.stderr
    )
    assert "give [effects.flow] a time_step" in done.stderr


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("fluid.mu", 0, "fluid.mu: 0 is too small"),
        ("boundary.inlet.velocity", ["1/(y - 0.5)^0.5", 0], "is not a finite number"),
        ("boundary.outlet", {"on": "outlet", "wall": True}, "there is no outflow where the rest could go"),
        ("boundary.inlet.velocity", ["t", 0], "depends on the time t, and the flow is steady"),
        ("boundary.outlet.on", "nobody", "there is no entity 'nobody'"),
        ("boundary.sides.slip", True, "there is no boundary.sides"),
        ("effects.flow.time_step", 0.1, "during an edit neither can change: make it two scenes"),
    ],
)
def test_a_value_that_an_edit_sets_is_refused_in_its_frame_alone(key, value, message, tmp_path):
    script = write_script(tmp_path, [*set_value(key, value), *set_value("fluid.mu", 0.2)])
    first, *_, before, last = [dict(row) for row in make_replay(write_scene(tmp_path, BASE), script).frames()]
    assert message in before["refused"], before["refused"]
    assert not last["refused"] and last["q_drag"] > 1.5 * first["q_drag"]


def test_steps_that_pass_many_cells_are_warned_of(command, tmp_path):
    write_scene(tmp_path, TIMED.replace("time_step = 0.1", "time_step = 6"))
    said = command("check", "scene.toml").stdout
    # 1 m/s * 6 s / 0.3 m
    assert "passes 20 sides of the largest cells in a step" in said and "a time_step near 0.3 s" in said
    write_scene(tmp_path, TIMED)
    assert "largest cells" not in command("check", "scene.toml").stdout
