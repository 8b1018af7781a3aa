"""Steady flows with heat agree with cold solves where temperatures answer strongly: water at large Peclet numbers."""

from restshape_studies.stability.scenery import make_replay, write_scene, write_script
from restshape_verification.flow.heated_scenes import HEAD, SQUARE

from restshape.physics.heated_flow.heated_flow_search import HeatedFlowSearch
from restshape.replay.parity import Parity

CHANNEL = f"""{HEAD}
[shape]
outline = ["south", "outlet", "north", "inlet"]
vertices = {{ a = [0, 0], b = ["200 mm", 0], c = ["200 mm", "20 mm"], d = [0, "20 mm"] }}
[shape.edges]
south = {{ line = ["a", "b"] }}
outlet = {{ line = ["b", "c"] }}
north = {{ line = ["c", "d"] }}
inlet = {{ line = ["d", "a"] }}
[shape.holes]
pin = {{ circle = {{ center = ["50 mm", "10 mm"], radius = "3 mm" }} }}
[fluid]
name = "water"
reference = "20 degC"
[parameters]
U = "0.02 m/s"
H = "20 mm"
[boundary.entry]
on = "inlet"
velocity = ["6*U*(y/H)*(1-y/H)", 0]
temperature = "20 degC"
[boundary.out]
on = "outlet"
outflow = true
[boundary.pin]
on = "pin"
wall = true
temperature = "60 degC"
[boundary.low]
on = "south"
wall = true
heat_flux = "2 kW/m^2"
[effects]
flow = {{}}
convection = {{}}
heat = {{}}
[mesh]
size = "2 mm"
near = {{ pin = "0.6 mm" }}
[quantities]
heat = {{ heat_flow = true, at = "pin" }}
"""
DRAG = [
    {"do": "press", "on": "pin"},
    {"do": "drag", "to": [0.07, 0.008], "frames": 4},
    {"do": "release"},
]


def parity_of(folder):
    """The parity of all frames of the drag, and iterations of Newton's method in each."""
    replay = make_replay(write_scene(folder, CHANNEL), write_script(folder, DRAG))
    check, steps = Parity(replay), []
    for row in replay.frames():
        check()
        steps.append(row["newton"])
    return check, steps


def test_temperatures_agree_with_cold_solves_within_the_tolerance(tmp_path):
    check, _ = parity_of(tmp_path)
    assert check.summary()["holds"] and check.solution < 2e-6


def test_residuals_alone_do_not_show_it(tmp_path, monkeypatch):
    """What the search adds is a step of Newton's method in some frames."""
    _, steps = parity_of(tmp_path)
    monkeypatch.setattr(HeatedFlowSearch, "_lacking", lambda self, x: 0.0)
    check, fewer = parity_of(tmp_path)
    assert not check.summary()["holds"]
    added = [more - less for more, less in zip(steps, fewer)]
    assert set(added) == {0, 1} and added[0] == 0


HEATED_FROM_BELOW = f"""{HEAD}{SQUARE}
[fluid]
rho = 1
mu = 0.71
diffusivity = 1
expansion = {2000 * 0.71}
reference = "300 K"
[boundary]
hot = {{ on = "bottom", wall = true, temperature = "300.5 K" }}
cold = {{ on = "top", wall = true, temperature = "299.5 K" }}
[effects]
flow = {{}}
convection = {{}}
heat = {{ coupling = "split" }}
buoyancy = {{}}
gravity = {{ g = [0, -1] }}
[mesh]
size = 0.1
"""


def test_turns_that_bring_little_are_ended_by_both_parts_together(tmp_path):
    """Near the Rayleigh number from which a fluid rolls turns gain a tenth each: residuals are small long before."""
    moved = [{"do": "press", "on": "right"}, {"do": "drag", "to": [1.1, 0.5], "frames": 2}, {"do": "release"}]
    replay = make_replay(write_scene(tmp_path, HEATED_FROM_BELOW), write_script(tmp_path, moved))
    check = Parity(replay)
    for row in replay.frames():
        check()
        assert not row["refused"]
    assert check.summary()["holds"] and check.solution < 2e-6
