"""Validation cases of panels that are sewn: a cone, tension across a seam, energy on nested meshes, a gathered edge."""

import numpy as np
from petsc4py import PETSc
from restshape_studies.validation.case import CLOSED_FORM, IDENTITY, Check
from restshape_verification.couture.validation_meshes import slope
from restshape_verification.couture.validation_seams import BENDING, CLOTH, HEAD, MEMBRANE, frame_of
from scipy.integrate import quad
from scipy.optimize import brentq

from restshape.physics.cloth.relaxation.relaxation_analysis import RelaxationAnalysis

INNER, OUTER = 0.05, 0.2
"""Radii of the ring of which a part is a cone [m]."""
PART = 0.75
"""Of the ring: the sine of the cone's half angle."""
COS, SIN, BULGE = np.cos(PART * np.pi), np.sin(PART * np.pi), np.tan(0.5 * PART * np.pi)
SECTOR = f"""
[shape]
outline = ["from", "inner", "to", "outer"]
[shape.vertices]
a = [{OUTER * COS}, {-OUTER * SIN}]
b = [{INNER * COS}, {-INNER * SIN}]
c = [{INNER * COS}, {INNER * SIN}]
d = [{OUTER * COS}, {OUTER * SIN}]
[shape.edges]
from = {{ line = ["a", "b"] }}
inner = {{ arc = ["b", "c"], bulge = {BULGE} }}
to = {{ line = ["c", "d"] }}
outer = {{ arc = ["d", "a"], bulge = {-BULGE} }}
[seams.back]
from = "from"
to = "to"
stitched = "flat"
reverse = false
[supports.pin]
on = "b"
fix = ["x", "y", "z"]
[start]
scatter = "1 mm"
[mesh]
size = "20 mm"
"""
PANEL = """
[panels.{name}]
outline = ["bottom", "right", "top", "left"]
material = "{name}"
turn = ["90 deg", 0, 0]
move = [0, 0, {z}]
[panels.{name}.vertices]
a = [{left}, {low}]
b = [{right}, {low}]
c = [{right}, {high}]
d = [{left}, {high}]
[panels.{name}.edges]
bottom = {{ line = ["a", "b"] }}
right = {{ line = ["b", "c"] }}
top = {{ line = ["c", "d"] }}
left = {{ line = ["d", "a"] }}
[material.{name}]
E = {modulus}
nu = 0
rho = {density}
thickness = "0.3 mm"
bending = {bending}
"""
PLANE = """
[supports.plane]
on = "all"
fix = ["y"]
"""
REST = "[effects.drape]\ntolerance = 1e-9\n"
WIDTH, LENGTH, PULL, SIDEWAYS = 0.1, 0.2, 0.02, 0.01
"""Of each of two panels that are pulled [m], the distance between them at first, and its part along the seam."""
UPPER, LOWER, SEAM, LIMP = 3.0, 6.0, 3e3, 1e-12
"""Stiffness [N/m] of two panels that hang on each other, of their seam [N/m^2], and of their bending [N m]."""
WEIGHT = 500.0 * 3e-4 * 9.81
"""Of the cloth [N/m^2]."""
SHORT, LONG = 0.1, 0.12
"""Sides of a seam that is gathered [m]."""


def rectangle(
    name: str, x: tuple[float, float], y: tuple[float, float], membrane: float, z: float = 0.0, bending: float = BENDING
) -> str:
    """A panel upright in space, of a cloth of its own with this stiffness [N/m], moved up by z [m]."""
    return PANEL.format(
        name=name,
        left=x[0],
        right=x[1],
        low=y[0],
        high=y[1],
        z=z,
        modulus=membrane / 3e-4,
        density=500,
        bending=bending,
    )


def sewn_cone(comm: PETSc.Comm) -> list[Check]:
    """A part of a ring whose straight edges are sewn together flat: a cone cut off.

    The sine of its half angle is that part.

    Around it the curvature is cot(half angle)/s at the distance s from the tip: the energy is half of bending stiffness
    times the square of that.
    """
    analysis = frame_of(HEAD + CLOTH + SECTOR, comm)
    problem = analysis.problem
    x = problem.corners(analysis.x)
    rims = [x[problem.mesh.nodes_of(name)] for name in ("inner", "outer")]
    radii = [np.linalg.norm(rim - centre(rim), axis=1).mean() for rim in rims]
    height = np.linalg.norm(centre(rims[1]) - centre(rims[0]))
    energy = BENDING * np.pi * PART * (1.0 / PART**2 - 1.0) * np.log(OUTER / INNER)
    source = "a cone's development"
    return [
        Check(
            "half angle [rad]",
            float(np.arctan2(radii[1] - radii[0], height)),
            float(np.arcsin(PART)),
            1e-2,
            source,
            CLOSED_FORM,
        ),
        Check("radius of the upper rim [m]", float(radii[0]), PART * INNER, 5e-3, source, CLOSED_FORM),
        Check("radius of the lower rim [m]", float(radii[1]), PART * OUTER, 5e-3, source, CLOSED_FORM),
        Check("energy of bending [J]", problem.energy(analysis.x), energy, 1e-2, source, CLOSED_FORM),
    ]


def centre(rim: np.ndarray) -> np.ndarray:
    """The middle (3,) of the circle nearest to the nodes (n, 3), in the plane through them."""
    mean = rim.mean(axis=0)
    axes = np.linalg.svd(rim - mean)[2][:2]
    flat = (rim - mean) @ axes.T
    found = np.linalg.lstsq(np.column_stack([2.0 * flat, np.ones(len(flat))]), (flat**2).sum(axis=1), rcond=None)[0]
    return mean + found[:2] @ axes


def pulled(comm: PETSc.Comm, along: float) -> RelaxationAnalysis:
    """Two panels of unlike cloth and unlike meshes, held at their far ends, which a seam closes between them."""
    panels = rectangle("front", (-LENGTH, 0), (0, WIDTH), MEMBRANE, bending=LIMP)
    panels += rectangle("back", (PULL, LENGTH + PULL), (0, WIDTH), 3.0 * MEMBRANE, along, LIMP)
    # A vertex of one side has no node across the seam.
    panels = panels.replace('"right", "top"', '"lower", "upper", "top"', 1)
    panels = panels.replace(
        'right = { line = ["b", "c"] }', 'lower = { line = ["b", "m"] }\nupper = { line = ["m", "c"] }', 1
    )
    panels = panels.replace("a = [", f"m = [0, {0.37 * WIDTH}]\na = [", 1)
    seam = '[seams.pull]\nfrom = ["front.lower", "front.upper"]\nto = "back.left"\n'
    seam += f"stiffness = {1e3 * MEMBRANE}\n"
    ends = '[supports.ends]\non = ["front.left", "back.right"]\nfix = ["x", "y", "z"]\n'
    return frame_of(HEAD + panels + seam + ends + PLANE + REST + '[mesh]\nsize = "20 mm"\n', comm)


def seam_tension(comm: PETSc.Comm) -> list[Check]:
    """Two panels pulled apart at a seam: uniform stretch in each; and pulled askew: the same force from both sides.

    Force by length is the same in both panels and in the seam between them, which gives by that over its stiffness.
    """
    stiffness = (MEMBRANE, 3.0 * MEMBRANE)

    def longer(force: float) -> float:
        return LENGTH * sum(stretch(force, own) - 1.0 for own in stiffness) + force / (1e3 * MEMBRANE) - PULL

    force = brentq(longer, 0.0, MEMBRANE)
    problem, x = (analysis := pulled(comm, 0.0)).problem, analysis.x
    tensions, checks = problem.tensions(x), []
    for number, (name, own) in enumerate(zip(("front", "back"), stiffness)):
        found = tensions[problem.mesh.cell_piece == number]
        wanted = np.array([force / stretch(force, own), 0.0, 0.0])
        worst = found[np.abs(found - wanted).max(axis=1).argmax()]
        off = float(np.abs(worst - wanted).max() / force)
        what = f"{name}: tension of the triangle that is farthest off, over the pull"
        checks.append(Check(what, wanted[0] / force + off, wanted[0] / force, 1e-10, "a stretched strip", CLOSED_FORM))
    gaps = problem.seams.gaps(problem.corners(x))
    for what, gap in (("least", gaps.min()), ("largest", gaps.max())):
        wanted = force / (1e3 * MEMBRANE)
        checks.append(
            Check(f"{what} gap of the seam [m]", float(gap), wanted, 1e-10, "what its spring gives", CLOSED_FORM)
        )
    askew = pulled(comm, SIDEWAYS)
    front, back = forces(askew, 0), forces(askew, 1)
    for axis, way in ((0, "across"), (2, "along")):
        what = f"askew: force {way} the seam from the front [N]"
        checks.append(Check(what, float(front[axis]), float(-back[axis]), 1e-10, "the force from the back", IDENTITY))
    return checks


def forces(analysis: RelaxationAnalysis, number: int) -> np.ndarray:
    """What (3,) [N] the triangles of one of two panels pull with at its side of the seam."""
    problem = analysis.problem
    cells = np.flatnonzero(problem.mesh.cell_piece == number).astype(np.int32)
    out = np.zeros_like(analysis.x)
    problem.membrane.integral(problem.X, weighs=False).add_residual(analysis.x, out, cells)
    line = (problem.seams.pairs[0].first, problem.seams.pairs[0].second)[number]
    return out[problem.corner_number[line.nodes]].sum(axis=0)


def stretch(force: float, membrane: float) -> float:
    """Of cloth of this stiffness [N/m] under a force by length [N/m] of its pattern: St. Venant and Kirchhoff's law."""
    return float(brentq(lambda s: 0.5 * membrane * (s**2 - 1.0) * s - force, 1.0, 10.0, xtol=1e-14))


def sewn_refined(comm: PETSc.Comm) -> list[Check]:
    """A panel sewn to another one that hangs: on nested meshes the energy at rest falls, and comes to the exact one.

    Both move in their plane alone, and hardly resist bending, whose energy is not nested. Weight is consistent, and
    squared gaps summed over the nodes of either side only fall as nodes are added: what one mesh can do the next can.
    """
    panels = rectangle("upper", (0, WIDTH), (0, WIDTH), UPPER, bending=LIMP)
    panels += rectangle("lower", (0, WIDTH), (-WIDTH, 0), LOWER, -0.01, LIMP)
    seam = f'[seams.hung]\nfrom = "upper.bottom"\nto = "lower.top"\nstiffness = {SEAM}\n'
    top = '[supports.top]\non = "upper.top"\nfix = ["x", "y", "z"]\n[effects.gravity]\n'
    found = []
    for level in range(3):
        mesh = f"[mesh]\nsize = {0.025 / 2**level}\nlevels = {level + 1}\n"
        analysis = frame_of(HEAD + panels + seam + top + PLANE + REST + mesh, comm)
        found.append(analysis.problem.energy(analysis.x))
    exact, falls = hung_energy(), -np.diff(found)
    source, rate = "two strips that hang", "linear triangles"
    rise = float(max(0.0, *-falls) / -exact)
    errors = np.array(found) - exact
    return [
        Check("rise of the energy, by itself", rise, 0.0, 1e-12, "least on each mesh", IDENTITY),
        Check("energy at rest [J]", found[-1], exact, 5e-4, source, CLOSED_FORM),
        Check("slope of its error", slope(errors[:2]), 2.0, 0.05, rate, CLOSED_FORM),
        Check("slope of its error, finer", slope(errors[1:]), 2.0, 0.05, rate, CLOSED_FORM),
    ]


def hung_energy() -> float:
    """The energy [J] of both panels and the seam, from the tension that the weight below each place asks for."""
    total = 0.0
    for membrane, below in ((UPPER, WIDTH), (LOWER, 0.0)):

        def density(s: float, membrane: float = membrane, below: float = below) -> float:
            # What is stored at s above the lower side, and what the weight below it sinks by the stretch there.
            own = stretch(WEIGHT * (below + s), membrane)
            return 0.125 * membrane * (own**2 - 1.0) ** 2 - WEIGHT * (below + s) * own

        total += quad(density, 0.0, WIDTH)[0]
    # The seam stores half of what the lower panel sinks by it; the upper side is at the height of the panel.
    return WIDTH * (total - 0.5 * (WEIGHT * WIDTH) ** 2 / SEAM + 2.0 * WIDTH * WEIGHT * WIDTH)


def gathered(comm: PETSc.Comm) -> list[Check]:
    """A frill sewn to a side that is held: its edge, a fifth longer, has the length of that side; with slack its own.

    Without slack all of its nodes are on the line of the side, evenly: it is shorter in its plane. With it, it folds. A
    pleat takes in what is too long: three layers lie on the line, and none of them is shorter.
    """
    tied, taut = edge_of_frill("", comm)
    free, folded = edge_of_frill('slack = "8 mm"\n', comm)
    sewn, pleated = edge_of_frill("pleats.middle = { at = 0.5, depth = 0.01 }\n", comm)
    source, own = "the side that it is sewn to", "cloth that folds keeps its length"
    share = SHORT / LONG
    return [
        Check("length of the edge [m]", float(tied.sum()), SHORT, 1e-3, source, CLOSED_FORM),
        Check("least part of an edge's length", float((tied / taut).min()), share, 2e-3, source, CLOSED_FORM),
        Check("largest part", float((tied / taut).max()), share, 2e-3, source, CLOSED_FORM),
        Check("slack of 8 mm: length of the edge [m]", float(free.sum()), LONG, 5e-3, own, CLOSED_FORM),
        Check("slack of 8 mm: least part", float((free / folded).min()), 1.0, 5e-3, own, CLOSED_FORM),
        Check("a pleat of 10 mm: length of the edge [m]", float(sewn.sum()), LONG, 1e-4, own, CLOSED_FORM),
        Check("a pleat of 10 mm: least part", float((sewn / pleated).min()), 1.0, 1e-3, own, CLOSED_FORM),
        Check("a pleat of 10 mm: largest part", float((sewn / pleated).max()), 1.0, 1e-3, own, CLOSED_FORM),
    ]


def edge_of_frill(keys: str, comm: PETSc.Comm) -> tuple[np.ndarray, np.ndarray]:
    """Lengths (k,) [m] of the mesh's edges along its sewn side, at rest and in the pattern."""
    panels = rectangle("band", (0, SHORT), (0, 0.02), MEMBRANE) + rectangle("frill", (0, LONG), (-0.04, 0), MEMBRANE)
    seam = f'[seams.gather]\nfrom = "frill.top"\nto = "band.bottom"\nease = 0.2\n{keys}'
    pins = '[supports.pins]\non = "band"\nfix = ["x", "y", "z"]\n[start]\nscatter = "1 mm"\n[effects.gravity]\n'
    analysis = frame_of(HEAD + panels + seam + pins + '[mesh]\nsize = "10 mm"\n', comm)
    problem = analysis.problem
    line = problem.seams.pairs[0].first.nodes
    x, X = problem.corners(analysis.x)[line], problem.mesh.X[line]
    return np.linalg.norm(np.diff(x, axis=0), axis=1), np.linalg.norm(np.diff(X, axis=0), axis=1)
