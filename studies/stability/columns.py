"""Scenes of columns that lie along x and buckle, of any application that solves plane solids, and what Euler says."""

from restshape_studies.stability.scenery import block, head

ELASTIC = """
[material.steel]
E = 200e9
nu = {nu}
rho = 8000
thickness = 0.01

[effects.solid]
model = "{model}"
"""
FOOT = '\n[supports.foot]\non = "left"\nfix = ["x", "y"]\n'
HINGES = '\n[supports.ends]\non = ["left", "right"]\nfix = ["y"]\n[supports.hold]\non = "a"\nfix = ["x"]\n'
PUSHED = '\n[loads.head]\non = "right"\nforce = [-{0}, 0]\n[loads.foot]\non = "left"\nforce = [{0}, 0]\n'
FACTORS = "\n[quantities]\n" + "\n".join(
    f"{name} = {{ load_factor = {k} }}" for k, name in enumerate(("first", "second"), 1)
)
MASTS = """
[shape]
outline = ["bottom", "right", "tip2", "in2", "base", "in1", "tip1", "left"]

[shape.vertices]
a = [0, 0]
b = [0.6, 0]
c = [0.6, 1]
d = [0.55, 1]
e = [0.55, 0.1]
f = [0.05, 0.1]
g = [0.05, 1]
h = [0, 1]

[shape.edges]
bottom = { line = ["a", "b"] }
right = { line = ["b", "c"] }
tip2 = { line = ["c", "d"] }
in2 = { line = ["d", "e"] }
base = { line = ["e", "f"] }
in1 = { line = ["f", "g"] }
tip1 = { line = ["g", "h"] }
left = { line = ["h", "a"] }

[material.steel]
E = 200e9
nu = 0.3
thickness = 0.01

[effects.solid]

[effects.buckling]
modes = 3

[supports.base]
on = ["bottom", "base"]
fix = ["x", "y"]

[loads.tips]
on = ["tip1", "tip2"]
traction = [0, -2e7]

[mesh]
size = 0.025

[solve]
tolerance = 1e-10

[quantities]
first = { load_factor = 1 }
"""


def twins(app: str) -> str:
    """The scene of two masts on one base."""
    return head(app) + MASTS


def column(
    app: str,
    *parts: str,
    length: float = 1.0,
    height: float = 0.05,
    size: float = 0.03,
    order: int = 2,
    modes: int = 2,
    nu: float = 0.0,
    model: str = "plane_stress",
    load: str = "given",
) -> str:
    """The scene of a column with parts that hold and load it; by default 1 kN on a clamped one."""
    body = head(app) + block(length, height) + ELASTIC.format(nu=nu, model=model)
    effects = f'\n[effects.buckling]\nmodes = {modes}\nload = "{load}"\n'
    mesh = f"\n[mesh]\nsize = {size}\norder = {order}\n\n[solve]\ntolerance = 1e-9\n"
    return body + effects + "".join(parts or (FOOT, PUSHED.format(1e3))) + mesh + FACTORS + "\n"


def euler(height: float, z: float, length: float = 1.0, E: float = 200e9) -> float:
    """Euler's critical load z^2 E I / L^2 [N] of that column."""
    return z**2 * E * 0.01 * height**3 / 12 / length**2
