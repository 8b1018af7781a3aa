"""Scenes of rubber that deforms far, of any application that solves plane solids."""

from restshape_studies.stability.scenery import block, head, meshed

RUBBER = '\n[material.rubber]\nE = "1 MPa"\nnu = 0.3\nrho = 1000\n'
LARGE = "\n[effects.large_deformation]\n"
WALL = '\n[supports.wall]\non = "left"\nfix = ["x", "y"]\n'
TIP = """
[quantities]
x = { displacement = "x", at = "c" }
y = { displacement = "y", at = "c" }
wall_x = { reaction = "x", at = "left" }
wall_y = { reaction = "y", at = "left" }
energy = { energy = "strain" }
"""


def solid(model: str = "plane_strain") -> str:
    """The [effects.solid] of a plane model."""
    return f'\n[effects.solid]\nmodel = "{model}"\n'


def gravity(x: float, y: float) -> str:
    """The [effects.gravity] along (x, y) [m/s^2]."""
    return f"\n[effects.gravity]\ng = [{x}, {y}]\n"


def beam(app: str, *parts: str, length: float = 1.0, height: float = 0.2, size: float = 0.05) -> str:
    """A rubber beam clamped at its left end, of large deformation."""
    shape = head(app) + block(length, height) + RUBBER + WALL + LARGE
    return shape + "".join(parts or (solid(), gravity(0, -10))) + meshed(size) + TIP
