"""Small scenes for tests, beside those that hard cases are made of."""

from functools import partial

from restshape_studies.stability import scenery
from restshape_studies.stability.scenery import (
    BLOCK,
    CLAMPED,
    HOLE,
    PULLED,
    QUANTITIES,
    STEEL,
    across,
    block,
    drag,
    head,
    make_replay,
    meshed,
    rows_of,
    write_scene,
    write_script,
)

__all__ = [
    "BLOCK",
    "CLAMPED",
    "CURVED",
    "HEAD",
    "HOLE",
    "PATCH",
    "PATCH_GRADIENT",
    "PULLED",
    "QUANTITIES",
    "STEEL",
    "across",
    "block",
    "drag",
    "head",
    "make_replay",
    "meshed",
    "plate",
    "rows_of",
    "write_scene",
    "write_script",
]

HEAD = head("plane")
plate = partial(scenery.plate, "plane")
CURVED = """
format = "restshape-scene"
version = 1
app = "plane"
[shape]
outline = ["bottom", "right", "top", "left"]
groups.pair = ["window", "top"]
[shape.vertices]
a = [0, 0]
b = [2, 0]
c = [2, 1]
d = [0, 1]
[shape.edges]
bottom = { line = ["a", "b"] }
right = { arc = ["b", "c"], through = [2.2, 0.5] }
top = { spline = ["c", "d"], through = [[1.5, 1.1], [0.5, 1.1]] }
left = { line = ["d", "a"] }
[shape.holes.window]
circle = { center = [0.5, 0.5], radius = 0.2 }
[material.steel]
E = "210 GPa"
nu = 0.3
[supports.left]
on = "left"
fix = ["x", "y"]
[loads.right]
on = "right"
traction = [1e6, 0]
[mesh]
size = 0.1
"""
"""A plate with edges of three kinds and a round hole."""

PATCH_GRADIENT = ((1e-3, 4e-4), (-2e-4, 7e-4))
PATCH = (
    HEAD
    + block()
    + HOLE
    + '[material.m]\nE = 1e9\nnu = 0.3\n[effects.solid]\nmodel = "plane_strain"\n'
    + '[supports.round]\non = ["outline", "window"]\n'
    + 'fix = { x = "1*(1e-3*x + 4e-4*y)", y = "1*(-2e-4*x + 7e-4*y)" }\n'
    + "[solve]\ntolerance = 1e-12\n"
    + meshed(0.12)
)
"""A block with a hole whose whole boundary is displaced linearly, by PATCH_GRADIENT, wherever it goes."""
