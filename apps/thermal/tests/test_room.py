"""Air of a room with a radiator and a window, from rest."""

from restshape_studies.stability.scenery import make_replay, write_scene, write_script

ROOM = """format = "restshape-scene"
version = 1
app = "thermal"
[shape]
outline = ["floor", "window", "ceiling", "back"]
vertices = { a = [0, 0], b = [4, 0], c = [4, 2.5], d = [0, 2.5] }
[shape.edges]
floor = { line = ["a", "b"] }
window = { line = ["b", "c"] }
ceiling = { line = ["c", "d"] }
back = { line = ["d", "a"] }
[shape.holes]
radiator = { polygon = [[0.3, 0.2], [0.4, 0.2], [0.4, 0.8], [0.3, 0.8]] }
[fluid]
name = "air"
reference = "20 degC"
[boundary]
radiator = { on = "radiator", wall = true, temperature = "50 degC" }
window = { on = "window", wall = true, temperature = "10 degC" }
[effects]
flow = { time_step = 0.05, steps = 4 }
convection = {}
heat = {}
buoyancy = {}
gravity = {}
[mesh]
size = 0.15
near = { radiator = 0.05, window = 0.08 }
"""


def test_air_of_a_room_begins_to_move(tmp_path):
    """In few of Newton's steps: times of stabilisation do not jump where air that was at rest begins to move."""
    rows = [*make_replay(write_scene(tmp_path, ROOM), write_script(tmp_path, [{"do": "idle", "frames": 3}])).frames()]
    assert not any(row["refused"] for row in rows)
    assert sum(row["newton"] for row in rows) <= 4 * 12
