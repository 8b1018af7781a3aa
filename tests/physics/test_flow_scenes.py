"""What scenes of flow may say, and the messages for those that make no sense."""

import numpy as np
import pytest
from flow_scenes import CHANNEL, CYLINDER
from restshape_studies.stability.scenery import make_replay, set_value, write_scene, write_script
from restshape_verification.flow.scenes import HEAD, SQUARE, STEADY, everywhere, in_time
from thermal_scenes import solved

from restshape.application import application
from restshape.cli.main import main
from restshape.errors import UserError
from restshape.physics.flow.flow_conditions import unbalanced, unequal
from restshape.replay.parity import Parity
from restshape.scene.load import load_scene
from restshape.scene.plan import plan

BOTH = {"mesh_velocity", "pressure_datum"}
MESH = "[mesh]\nsize = 0.2\n"
DRAG = '[quantities]\ndrag = { drag = true, at = "top" }\n'
VESSEL = HEAD + SQUARE + "[fluid]\nrho = 1\nmu = 1\n" + STEADY + MESH


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("mu = 0.1", "mu = 0"), "fluid.mu .*greater than 0"),
        (("mu = 0.1", ""), "the fluid has no viscosity mu"),
        (("mu = 0.1", 'mu = "0.1 Pa"'), "viscosity is wanted"),
        (('on = "inlet"', 'on = "outlet"'), "the edge 'outlet' has two conditions"),
        (('on = "inlet"', 'on = "inlat"'), "there is no entity 'inlat'"),
        (('on = "inlet"', 'on = "a"'), "no condition on 'a', which is a vertex"),
        (("outflow = true", "outflow = true\nwall = true"), "exactly one of velocity, wall, slip, outflow"),
        (("outflow = true", "wall = true"), "flow in and 0 m\\^2/s out, and there is no outflow"),
        (('"4*y*(1 - y)"', '"4*y*(1 - y)*t"'), "depends on the time t, and the flow is steady"),
        (('"4*y*(1 - y)"', '"4*y*(1 - y)*s"'), "names 's', which is not in"),
        (("steady = true", 'steady = true, time_step = "1 s"'), "a steady flow has no time_step"),
        (("steady = true", "steps = 4"), "steps is of a flow in time"),
        (("steady = true", 'carry = "remap"'), "carry is of a flow in time"),
        (("convection = {}", "convection = {}\n[parameters]\nt = 1"), "'t' is the time"),
        (("convection = {}", 'convection = {}\n[supports.s]\non = "top"\nfix = ["x"]'), "supports"),
        (("convection = {}", "convection = {}\n[loads.l]\non = 'top'\npressure = 1"), "loads"),
        (("[mesh]", DRAG + "[mesh]"), None),
        (("[mesh]", DRAG.replace(', at = "top"', "") + "[mesh]"), "a drag needs a place"),
        (("[mesh]", DRAG.replace('"top"', '"outlet"') + "[mesh]"), "no force on it"),
        (("[mesh]", '[quantities]\nd = { pressure_drop = { from = "a", to = "z" } }\n[mesh]'), "no entity 'z'"),
    ],
)
def test_messages(tmp_path, change, message):
    before, after = change
    text = CHANNEL + STEADY + MESH
    assert before in text
    if message is None:
        solved(tmp_path, text.replace(before, after, 1))
        return
    with pytest.raises(UserError, match=message):
        solved(tmp_path, text.replace(before, after, 1))


def test_a_scene_without_a_condition_is_refused(tmp_path):
    with pytest.raises(UserError, match="all edges are walls, and nothing flows"):
        load_scene(write_scene(tmp_path, VESSEL))


def test_an_edge_inside_has_no_condition(tmp_path):
    region = "[shape.regions.core]\ncircle = { center = [0.5, 0.5], radius = 0.2 }\n"
    text = VESSEL.replace("[fluid]", region + '[boundary.b]\non = "core"\nwall = true\n[fluid]')
    with pytest.raises(UserError, match="of 'core' lies inside: it is of no border of the fluid"):
        solved(tmp_path, text)


def test_a_channel_with_slip_is_a_uniform_stream(tmp_path):
    text = CHANNEL.replace('["4*y*(1 - y)", 0]', "[1, 0]") + STEADY + MESH
    row = solved(tmp_path, text + '[boundary.sides]\non = ["top", "bottom"]\nslip = true\n' + DRAG).row
    assert row["q_drag"] == pytest.approx(0.0, abs=1e-6)


def test_a_known_fluid_has_its_values(tmp_path):
    text = CHANNEL.replace("rho = 1.5\nmu = 0.1", 'name = "water"\nrho = "1 g/cm^3"')
    fluid = load_scene(write_scene(tmp_path, text + STEADY + MESH)).fluid
    assert (fluid.rho, fluid.mu) == pytest.approx((1000.0, 1.003e-3))


def test_conditions_can_be_set_during_an_edit(tmp_path):
    text = CYLINDER + STEADY + '[quantities]\ndrag = { drag = true, at = "body" }\n' + MESH
    script = write_script(tmp_path, set_value("boundary.inlet.velocity", ["8*y*(1 - y)", 0]))
    first, *_, last = [dict(row) for row in make_replay(write_scene(tmp_path, text), script).frames()]
    assert last["q_drag"] > 1.9 * first["q_drag"]


@pytest.mark.parametrize(
    ("effects", "closed", "on"),
    [(STEADY, False, {"backflow"}), (in_time(), True, BOTH), (in_time(carry="remap"), False, {"backflow"})],
)
def test_what_follows_from_a_scene(tmp_path, effects, closed, on):
    """The velocity of the mesh counts in time; the pressure has no datum in a closed vessel, outflows may draw in."""
    text = everywhere("[1, 0]", effects) if closed else CHANNEL + effects + MESH
    planned = plan(load_scene(write_scene(tmp_path, text)), application("flow"))
    assert {one.name for one in planned.derived if one.on} == on


def test_a_steady_flow_cannot_become_one_in_time(tmp_path):
    text, script = CYLINDER + STEADY + MESH, write_script(tmp_path, set_value("effects.flow", {"time_step": 0.1}))
    rows = [dict(row) for row in make_replay(write_scene(tmp_path, text), script).frames()]
    assert "steady, or unsteady, during an edit" in rows[-1]["refused"]


CONDITIONS = [
    ("body", "slip", "wall"),
    ("body", "wall", "slip"),
    ("body", "outflow", "slip"),
    ("top", "slip", "outflow"),
]


@pytest.mark.parametrize("effects", [STEADY, in_time(1.0, "backward_euler", 4)], ids=["steady", "in time"])
@pytest.mark.parametrize(("edge", "before", "after"), CONDITIONS)
def test_an_edge_takes_another_condition_during_an_edit(tmp_path, effects, edge, before, after):
    """The flow is that of the scene with this condition, and of a cold solve."""
    quantities = '[quantities]\nout = { flux = true, at = "outlet" }\nspeed = { speed = true, reduce = "mean" }\n'
    table = f'[boundary.other]\non = "{edge}"\n'
    text = f"{CYLINDER}{table}{before} = true\n{effects}{MESH}{quantities}"
    edits = [*set_value("boundary.other", {"on": edge, after: True}), {"do": "idle", "frames": 3}]
    replay = make_replay(write_scene(tmp_path, text), write_script(tmp_path, edits))
    check = Parity(replay)
    rows = [(dict(row), check())[0] for row in replay.frames()]
    assert check.summary()["holds"] and not any(row["refused"] for row in rows)
    idle = write_script(tmp_path, [{"do": "idle", "frames": 4}])
    scene = write_scene(tmp_path, text.replace(f"{table}{before}", f"{table}{after}"))
    fresh = [dict(row) for row in make_replay(scene, idle).frames()][-1]
    for name in ("q_out", "q_speed"):
        assert rows[-1][name] == pytest.approx(fresh[name], rel=1e-4 if effects == STEADY else 0.02)


def test_an_inflow_that_depends_on_the_time(tmp_path):
    """A velocity that grows with the time t is there at the end of each step."""
    text = CHANNEL.replace('"4*y*(1 - y)"', '"4*y*(1 - y)*t"') + in_time(0.25) + MESH
    text += '[quantities]\nout = { flux = true, at = "outlet" }\nin = { flux = true, at = "inlet" }\n'
    script = write_script(tmp_path, [{"do": "idle", "frames": 4}])
    rows = [dict(row) for row in make_replay(write_scene(tmp_path, text), script).frames()]
    for row in rows:
        assert row["q_out"] == pytest.approx(-row["q_in"], rel=1e-6, abs=1e-12)
    assert [row["time"] for row in rows] == pytest.approx([0.0, 0.25, 0.5, 0.75, 1.0])
    assert rows[-1]["q_in"] == pytest.approx(4 * rows[1]["q_in"], rel=1e-9)


@pytest.mark.parametrize("size", [0.3, 1.0, 2.5])
def test_a_vessel_whose_wall_turns_is_no_unequal_inflow(tmp_path, size):
    """Fluid between a cylinder that turns and a wall: u = A r + B / r, and what flows through the walls is rounding."""
    text = f"""format = "restshape-scene"
version = 1
app = "flow"
[shape]
outline = ["lower", "upper"]
vertices = {{ west = [-{size}, 0], east = [{size}, 0] }}
edges = {{ lower = {{ arc = ["west", "east"], bulge = 1 }}, upper = {{ arc = ["east", "west"], bulge = 1 }} }}
holes = {{ drum = {{ circle = {{ center = [0, 0], radius = {size / 2} }} }} }}
points = {{ middle = [{0.75 * size}, 0] }}
[fluid]
rho = 1
mu = 0.1
[boundary.drum]
on = "drum"
velocity = ["-y", "x"]
[effects]
flow = {{}}
[mesh]
size = {0.05 * size}
[quantities]
middle = {{ speed = true, at = "middle" }}
"""
    row = solved(tmp_path, text).row
    assert row["q_middle"] == pytest.approx(size * (-0.75 / 3 + 1 / 3 / 0.75), rel=2e-3)


def test_what_flows_in_by_a_turning_wall_is_still_missed():
    assert unbalanced(np.array([-1e-6, 1e-17, -1e-17]), np.array([1e-6, 1.0, 1.0]))
    assert not unbalanced(np.array([-4.5e-16, 4.3e-16]), np.array([1.0, 1.0]))


def test_a_vessel_into_which_nothing_flows_is_said_without_a_sign():
    assert unequal(np.array([1.5, 0.5])).startswith("0 m^2/s flow in and 2 m^2/s out")


def test_pressures_of_a_closed_vessel_have_the_mean_0(tmp_path):
    """Whatever the node is at which the equations hold them."""
    text = VESSEL.replace("[effects]", '[boundary.lid]\non = "top"\nvelocity = [1, 0]\n[effects]')
    row = solved(
        tmp_path,
        text + '[quantities]\nmean = { pressure = true, at = "all" }\nmost = { pressure = true, reduce = "max" }\n',
    ).row
    assert row["q_most"] > 1.0 and abs(row["q_mean"]) < 1e-9 * row["q_most"]


def test_a_parameter_of_a_quantity_is_refused_with_its_name(tmp_path):
    """The speed of a coefficient holds for the whole edit; another quantity is not named."""
    coefficient = 'drag_coefficient = { speed = "2*fast", length = 0.1 }, at = "body"'
    quantities = f"[quantities]\nq = {{ speed = true }}\ncd = {{ {coefficient} }}\n"
    text = f"{CYLINDER}[parameters]\nfast = 1.5\n{STEADY}{MESH}{quantities}"
    edits = [*set_value("parameters.fast", 2.0)]
    rows = [dict(row) for row in make_replay(write_scene(tmp_path, text), write_script(tmp_path, edits)).frames()]
    why = rows[-1]["refused"]
    assert "this changes quantities.cd as well" in why and "write numbers in quantities.cd" in why


def test_a_velocity_needs_no_number_where_a_wall_goes_before_it(tmp_path):
    """`check` takes what the first frame takes: the corners of an inlet are those of walls."""
    scene = write_scene(tmp_path, CHANNEL.replace('"4*y*(1 - y)"', '"0.01/y + 0.01/(1 - y)"') + STEADY + MESH)
    assert main(["check", str(scene)]) == main(["replay", str(scene)]) == 0
    assert main(["check", str(scene), "--set", 'boundary.inlet.velocity=["0.01/(y - y)", 0]']) == 2
