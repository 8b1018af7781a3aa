"""Scenes whose shape formulas of parameters give, and the same written by hand."""

from pathlib import Path

from restshape.scene.load import load_scene
from restshape.scene.model import Scene

HEAD = """format = "restshape-scene"
version = 1
app = "plane"
"""
REST = """
[material.steel]
name = "steel"
thickness = "5 mm"
[supports.wall]
on = "back"
fix = ["x", "y"]
[mesh]
size = "15 mm"
[quantities.tip]
displacement = "y"
at = "tip"
[quantities.area]
area = true
"""
PLATE = """
[parameters]
width = "30 cm"
height = "width/3"
r = "height/5"
P = "1 kN"
[shape]
outline = ["bottom", "tip", "top", "back"]
[shape.vertices]
a = [0, 0]
b = ["width", 0]
c = ["width", "height"]
d = [0, "height"]
[shape.edges]
bottom = { line = ["a", "b"] }
tip = { line = ["b", "c"] }
top = { line = ["c", "d"] }
back = { line = ["d", "a"] }
[shape.holes]
bore = { circle = { center = ["width/2", "height/2"], radius = "r" } }
[loads.pull]
on = "tip"
force = [0, "-P"]
"""
"""A plate with a hole, whose area is width height - pi r^2."""
BRACKET = """
[parameters]
depth = "25 cm"
height = "0.8*depth"
band = "3 cm"
turn = "0.1"
[shape]
outline = ["foot", "curve", "tip", "top", "back"]
[shape.vertices]
a = [0, 0]
b = ["band", 0]
c = ["depth", "height - band"]
d = ["depth", "height"]
e = [0, "height"]
[shape.edges]
foot = { arc = ["a", "b"], bulge = "turn" }
curve = { arc = ["b", "c"], through = ["0.45*depth", "0.6*height"] }
tip = { polyline = ["c", "d"], through = [["depth + band/4", "height - band/2"]] }
top = { spline = ["d", "e"], through = [["0.7*depth", "height + band/5"], ["0.3*depth", "height"]] }
back = { line = ["e", "a"] }
[shape.holes]
slot = { polygon = [["band/2", "0.8*height"], ["band", "0.8*height"], ["band", "0.9*height"]] }
[loads.push]
on = "top"
force = [0, "-400 N"]
"""
"""Curves of each kind: the arc bends, and the spline has other knots, when the depth changes."""


def write_scene(folder: Path, body: str = PLATE, name: str = "plate") -> Path:
    """The file of a scene."""
    path = folder / f"{name}.toml"
    path.write_text(HEAD + body + REST, encoding="utf-8")
    return path


def scene_of(folder: Path, body: str = PLATE, *overrides: str) -> Scene:
    """The scene of a body."""
    return load_scene(write_scene(folder, body), overrides)
