"""Steady flows with heat agree with cold solves where temperatures answer strongly: water at large Peclet numbers."""

from restshape_studies.stability.scenery import make_replay, write_scene, write_script
from restshape_verification.flow.heated_scenes import HEAD

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
