"""A shape with edges and loops of all kinds, and edits of each, for tests of exports."""

from pathlib import Path

from small_scenes import CURVED, write_script

from restshape.export.edited_frame import EditedFrame, frame_of_script
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene

MORE = """[shape.regions]
core = { circle = { center = [1.6, 0.75], radius = 0.1 } }
[shape.points]
gauge = [1.0, 0.8]
[shape.holes]
slot = { polygon = [[0.9, 0.2], [1.3, 0.2], [1.2, 0.4]] }
[shape.holes.window]"""
CORE = """nu = 0.3
thickness = "20 mm"
[material.core]
region = "core"
E = 1e9
nu = 0.3
thickness = "20 mm\""""
POLYLINE = 'left = { polyline = ["d", "a"], through = [[-0.05, 0.7], [0.05, 0.3]] }'
ALL_KINDS = CURVED.replace("[shape.holes.window]", MORE).replace("nu = 0.3", CORE)
ALL_KINDS = ALL_KINDS.replace('left = { line = ["d", "a"] }', POLYLINE)
"""A plate with a line, an arc, a spline and a polyline around it, a round hole, a polygon, a round region, a point."""

EDITS = [
    {"do": "press", "on": "top", "at": [1.0, 1.1]},
    {"do": "drag", "path": [[1.0, 1.2]], "frames": 2},
    {"do": "release"},
    {"do": "pull", "on": "top", "at": [1.5, 1.2]},
    {"do": "drag", "path": [[1.5, 1.35]], "frames": 2},
    {"do": "release"},
    {"do": "arc", "on": "right", "bulge": -0.3, "frames": 2},
    {"do": "press", "on": "window"},
    {"do": "drag", "path": [[0.52, 0.53]], "frames": 2},
    {"do": "release"},
    {"do": "insert", "on": "top", "name": "m", "s": 0.4},
    {"do": "press", "on": "m"},
    {"do": "drag", "path": [[1.2, 1.3]], "frames": 2},
    {"do": "release"},
    {"do": "hole", "name": "bore", "center": [1.3, 0.6], "radius": 0.06},
    {"do": "rotate", "on": "bore", "by": 0.3},
    {"do": "arc", "on": "bottom", "bulge": 0.1, "frames": 1},
    {"do": "set", "key": "material.steel.E", "value": "70 GPa"},
]
"""Edits of each of them: the spline is bent, and cut in two; one hole moves, another is made and turned."""


def edited(folder: Path, number: int = -1) -> EditedFrame:
    """The frame of these edits of that number."""
    (folder / "plate.toml").write_text(ALL_KINDS)
    scene = load_scene(folder / "plate.toml")
    return frame_of_script(scene, load_script(write_script(folder, EDITS), scene), number)
