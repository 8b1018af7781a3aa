"""Validation cases of seams: a strip sewn to a loop, and two panels sewn together tightly on a cylinder."""

import tempfile
from pathlib import Path

import numpy as np
from petsc4py import PETSc
from restshape_studies.validation.case import CLOSED_FORM, Check
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

from restshape.interface.first_frame import first_frame
from restshape.physics.cloth.relaxation.relaxation_analysis import RelaxationAnalysis

HEAD = 'format = "restshape-scene"\nversion = 1\napp = "couture"\n'
MEMBRANE, BENDING = 300.0, 5e-6
"""Stiffness of the cloth [N/m], and of its bending [N m]; nu = 0."""
CLOTH = f"""
[material.cotton]
E = {MEMBRANE / 3e-4}
nu = 0
rho = 0
thickness = "0.3 mm"
bending = {BENDING}
"""
LENGTH, WIDTH = 0.4, 0.05
"""Of the strip [m]."""
LOOP = f"""
[shape]
outline = ["bottom", "right", "top", "left"]
[shape.vertices]
a = [0, 0]
b = [{LENGTH}, 0]
c = [{LENGTH}, {WIDTH}]
d = [0, {WIDTH}]
[shape.edges]
bottom = {{ line = ["a", "b"] }}
right = {{ line = ["b", "c"] }}
top = {{ line = ["c", "d"] }}
left = {{ line = ["d", "a"] }}
[seams.side]
from = "left"
to = "right"
[supports.pin]
on = "left"
fix = ["x", "y", "z"]
[start]
scatter = "1 mm"
[mesh]
size = "12.5 mm"
"""
RADIUS, GIRTH, HEIGHT, STIFFNESS = 0.1, 0.6, 0.1, 3e5
"""Radius of the cylinder, girth and height of the panels sewn together around it [m], and stiffness of the seams [Pa].
"""
PANEL = """
[panels.{name}]
outline = [{outline}]
turn = ["90 deg", 0, {turn}]
move = [0, {y}, 0]
[panels.{name}.vertices]
a = [{left}, 0]
o = [0, 0]
b = [{right}, 0]
m = [{right}, {part}]
c = [{right}, {height}]
d = [{left}, {height}]
[panels.{name}.edges]
first = {{ line = ["a", "o"] }}
second = {{ line = ["o", "b"] }}
lower = {{ line = ["b", "m"] }}
upper = {{ line = ["m", "c"] }}
top = {{ line = ["c", "d"] }}
left = {{ line = ["d", "a"] }}
"""
AROUND = f"""
[seams.one]
from = "front.left"
to = ["back.lower", "back.upper"]
stiffness = {STIFFNESS}
[seams.other]
from = ["front.lower", "front.upper"]
to = "back.left"
stiffness = {STIFFNESS}
[bodies.torso]
capsule = {{ start = [0, 0, -0.3], end = [0, 0, 0.4], radius = {RADIUS} }}
[supports.middle]
on = "front.o"
fix = ["x", "z"]
[effects.cloth]
bending = "hinge"
[effects.contact]
thickness = "1 mm"
stiffness = "2 MN/m^3"
self = false
[mesh]
size = "10 mm"
"""


def frame_of(text: str, comm: PETSc.Comm) -> RelaxationAnalysis:
    """The rest of a scene's cloth."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "sewn.toml"
        path.write_text(text)
        return first_frame(path, (), comm).analysis


def sewn_loop(comm: PETSc.Comm) -> list[Check]:
    """A strip without weight whose ends are sewn together, and free to turn: one lobe of the elastic curve like an 8.

    Its ends are inflections at one place: 2 E(k) = K(k). It is k/K lengths deep, and its energy is 8 (k^2 - 1/2) K^2
    times bending stiffness by length, per width.
    """
    m = brentq(lambda m: 2.0 * ellipe(m) - ellipk(m), 0.5, 0.99)
    K = ellipk(m)
    source = "Euler's elastica: both inflections at one place"
    lobe = loop(comm, "", np.sqrt(m) / K * LENGTH, 8.0 * (m - 0.5) * K**2, source)
    return [*lobe, *loop(comm, 'stitched = "flat"', LENGTH / np.pi, 2.0 * np.pi**2, "a circle, for it is sewn flat")]


def loop(comm: PETSc.Comm, more: str, depth: float, energy: float, source: str) -> list[Check]:
    """The depth of a loop [m], and its energy over bending stiffness by length and width; `more` is of its seam."""
    text = LOOP.replace("[supports", f"{more}\n[supports", 1)
    analysis = frame_of(HEAD + CLOTH + text, comm)
    x = analysis.problem.corners(analysis.x)
    found = float(np.hypot(x[:, 0], x[:, 2]).max())
    scale = BENDING * WIDTH / LENGTH
    return [
        Check("depth of the loop [m]", found, depth, 5e-3, source, CLOSED_FORM),
        Check(
            "energy over bending stiffness",
            analysis.problem.energy(analysis.x) / scale,
            energy,
            1e-2,
            source,
            CLOSED_FORM,
        ),
    ]


def panel(name: str, y: float, turn: str) -> str:
    """Half of the girth, with nodes at other places on its right side than on its left one."""
    outline = ", ".join(f'"{edge}"' for edge in ("first", "second", "lower", "upper", "top", "left"))
    numbers = {"left": -GIRTH / 4, "right": GIRTH / 4, "height": HEIGHT, "part": 0.37 * HEIGHT}
    return PANEL.format(name=name, outline=outline, y=y, turn=turn, **numbers)


def sewn_cylinder(comm: PETSc.Comm) -> list[Check]:
    """Two panels sewn together, shorter than the way around a smooth cylinder: the same tension everywhere.

    The strain follows from the radius at which the nodes lie; across seams the springs give by tension over stiffness.
    Edges of triangles are chords: with 10 mm they are shorter by 1/60 of the strain.
    """
    panels = panel("front", -0.16, "0") + panel("back", 0.16, '"180 deg"')
    analysis = frame_of(HEAD + CLOTH + panels + AROUND, comm)
    problem = analysis.problem
    x, tensions = problem.corners(analysis.x), problem.tensions(analysis.x)
    around = float(2.0 * np.pi * np.hypot(x[:, 0], x[:, 1]).mean())
    # Of the way around, both seams have a part.
    stretch = brentq(lambda s: GIRTH * s + 2.0 * pull(s) / STIFFNESS - around, 1.0, 1.2)
    areas = problem.lumped.area.sum()
    strain = 0.5 * (stretch**2 - 1.0)
    source = "a stretched ring of this radius"
    checks = [
        Check(
            "membrane energy by area [J/m^2]",
            problem.membrane_energy(analysis.x) / areas,
            0.5 * MEMBRANE * strain**2,
            0.03,
            source,
            CLOSED_FORM,
        ),
    ]
    for number, name in enumerate(("front", "back")):
        own = problem.mesh.cell_piece == number
        mean = float(tensions[own, 0].mean())
        checks.append(Check(f"tension in the {name} [N/m]", mean, MEMBRANE * strain, 0.015, source, CLOSED_FORM))
    gaps = problem.seams.gaps(x)
    for name, own in problem.seams.springs_by_name():
        weights = problem.seams.coefficients[own, 0, 1]
        mean = float(weights @ gaps[own] / weights.sum()) * STIFFNESS
        checks.append(Check(f"tension across the seam {name!r} [N/m]", mean, pull(stretch), 0.015, source, CLOSED_FORM))
    return checks


def pull(stretch: float) -> float:
    """Force by length [N/m] of cloth stretched so many times: of St. Venant and Kirchhoff's law."""
    return MEMBRANE * 0.5 * (stretch**2 - 1.0) * stretch
