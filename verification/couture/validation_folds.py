"""Validation case of four layers: a strip that is folded twice, which lies as two nested folds and one on top."""

import numpy as np
from petsc4py import PETSc
from restshape_studies.each_week import each_week
from restshape_studies.validation.case import CLOSED_FORM, Check
from restshape_verification.couture.nested_folds import nested_heights
from restshape_verification.couture.placed_strips import along, fix, heights_at, placed, rested
from restshape_verification.couture.validation_layers import FOLDED, GUESS, SCENES, loop_height

from restshape.interface.first_frame import first_frame
from restshape.physics.cloth.cloth_problem import ClothProblem

LENGTH, WIDTH, FLAT, MIDDLE = 0.76, 5e-3, 0.18, 0.13
"""Length and width [m] of the strip, how far lower layers lie flat at first, and where all four are flat [m]."""
FOLD = 0.02
"""(D/w)^(1/3) [m]."""
TWICE = [
    *(f"shape.vertices.{name}={place}" for name, place in (("b", [LENGTH, 0]), ("c", [LENGTH, WIDTH]))),
    f"shape.vertices.d={[0, WIDTH]}",
    *FOLDED[3:],
]
SIZES = ((2.5e-3, 0.03),)
"""Mesh sizes [m], and bounds of the heights of the lower folds on them. At 1.25e-3 it is 0.002, in minutes."""
THICKNESS = 1.25e-4
"""Distance [m] at which layers touch."""
CAUGHT = 0.03
"""Bound of the height of the upper fold: layers that catch on each other push it in or draw it out."""


@each_week()
def folded_twice(comm: PETSc.Comm) -> list[Check]:
    """The heights of the three folds of a strip folded twice, and the four layers between them.

    The two lower ones are nested. The inner one has less length than the outer one, and pokes into it, so that the
    outer one is higher than a fold alone and the inner one lower. How far their tips are apart follows from the lengths
    that are given to them, and is measured.
    """
    return [check for size, bound in SIZES for check in _folded_twice(comm, size, bound)]


def _folded_twice(comm: PETSc.Comm, size: float, bound: float) -> list[Check]:
    """The checks on a mesh of a size [m]."""
    sizes = [f"mesh.size={size}", f"effects.contact.self_thickness={THICKNESS}"]
    analysis = first_frame(SCENES / "incline.toml", [*TWICE, *sizes], comm).analysis
    sheet = analysis.problem
    x = _arranged(sheet, sheet.corners(analysis.x)[:, 2].mean())
    s = sheet.mesh.X[:, 0]
    # The ends and the crease on top stay along the strip; across it nothing moves.
    still = (s < 1e-9) | (s > s.max() - 1e-9) | (np.abs(s - 0.5 * s.max()) < 0.52 * size)
    fix(sheet, np.flatnonzero(still), 0, x)
    fix(sheet, np.arange(len(s)), 1, x)
    y, report = rested(analysis, x)
    layers = heights_at(sheet, y, (MIDDLE, 0.52 * WIDTH))
    gaps = np.diff(layers) / FOLD
    four = len(gaps) == 3 and bool((gaps > 0.3 * THICKNESS / FOLD).all() and (gaps < THICKNESS / FOLD).all())
    outer, inner = (y[(y[:, 0] > MIDDLE) & part] for part in (s < 0.5 * s.max(), s > 0.5 * s.max()))
    apart = (outer[:, 0].max() - inner[:, 0].max()) / FOLD
    known = nested_heights(float(gaps.mean()), apart)
    heights = [(part[:, 2].max() - y[:, 2].min()) / FOLD for part in (inner, outer)]
    top = (y[y[:, 0] < MIDDLE, 2].max() - layers[2]) / FOLD if len(layers) == 4 else 0.0
    what, fold = f"folded twice, {1e3 * size:g} mm", "fold over (D/w)^(1/3)"
    nested, source = "two elastica that touch, by shooting", "heavy elastica with contact, by shooting"
    return [
        Check(f"{what}: four layers, contact apart", int(four), 1, 0, "nothing passes", CLOSED_FORM),
        Check(f"{what}: upper {fold}", top, loop_height(THICKNESS / FOLD), CAUGHT, source, CLOSED_FORM),
        Check(f"{what}: inner lower {fold}", heights[0], known[0], bound, nested, CLOSED_FORM),
        Check(f"{what}: outer lower {fold}", heights[1], known[1], bound, nested, CLOSED_FORM),
        Check(f"{what}: crossings", len(sheet.surface.crossed(y)), 0, 0, "nothing passes", CLOSED_FORM),
        Check(f"{what}: rests", int(report.converged), 1, 0, "it is heavy", CLOSED_FORM),
    ]


def _arranged(sheet: ClothProblem, bottom: float) -> np.ndarray:
    """Places (corners, 3) [m] of the strip folded twice in arcs, on a height [m]."""
    inner, outer = GUESS * FOLD, 3.0 * GUESS * FOLD
    above = 0.5 * (LENGTH - 2.0 * FLAT - np.pi * (outer + 2.0 * inner))
    lower, upper = (np.pi * outer, 1.0 / outer), (np.pi * inner, 1.0 / inner)
    curve = along([(FLAT, 0), lower, (above, 0), upper, (above, 0), (np.pi * inner, -1.0 / inner), (FLAT, 0)])
    x = placed(sheet, curve)
    x[:, 2] += bottom
    return x
