"""Validation case of four layers: a strip that is folded twice, which lies as two nested folds and one on top."""

import numpy as np
from petsc4py import PETSc
from restshape_studies.validation.case import CLOSED_FORM, Check
from restshape_verification.couture.placed_strips import along, fix, heights_at, placed, rested
from restshape_verification.couture.validation_layers import FOLDED, GUESS, SCENES, loop_height

from restshape.replay.first_frame import first_frame

LENGTH, WIDTH, FLAT, MIDDLE = 0.76, 5e-3, 0.18, 0.13
"""Length and width [m] of the strip, how far lower layers lie flat at first, and where all four are flat [m]."""
FOLD = 0.02
"""(D/w)^(1/3) [m]."""
TWICE = [
    *(f"shape.vertices.{name}={place}" for name, place in (("b", [LENGTH, 0]), ("c", [LENGTH, WIDTH]))),
    f"shape.vertices.d={[0, WIDTH]}",
    *FOLDED[3:],
]
CAUGHT = 0.03
"""Bound of the height of the upper fold: layers that catch on each other push it in or draw it out."""
GLUED = 4.0 ** (1.0 / 3.0)
"""Length of a fold of two layers that do not slide, of 8 D and 2 w, over that of one layer."""


def folded_twice(comm: PETSc.Comm) -> list[Check]:
    """The heights of the two folds, and the four layers between them.

    Layers that slide on each other have as nested folds the shape of each alone, (2 D/2 w)^(1/3) being (D/w)^(1/3), and
    layers that do not are as stiff as one of twice the thickness. The lower fold is between both.
    """
    analysis = first_frame(SCENES / "incline.toml", TWICE, comm).analysis
    sheet = analysis.problem
    inner, outer = GUESS * FOLD, 3.0 * GUESS * FOLD
    above = 0.5 * (LENGTH - 2.0 * FLAT - np.pi * (outer + 2.0 * inner))
    lower, upper = (np.pi * outer, 1.0 / outer), (np.pi * inner, 1.0 / inner)
    curve = along([(FLAT, 0), lower, (above, 0), upper, (above, 0), (np.pi * inner, -1.0 / inner), (FLAT, 0)])
    s, bottom = sheet.mesh.X[:, 0], sheet.corners(analysis.x)[:, 2].mean()
    x = placed(sheet, curve)
    x[:, 2] += bottom
    # The ends and the crease on top stay along the strip; across it nothing moves.
    still = (s < 1e-9) | (s > s.max() - 1e-9) | (np.abs(s - 0.5 * s.max()) < 1.3e-3)
    fix(sheet, np.flatnonzero(still), 0, x)
    fix(sheet, np.arange(len(s)), 1, x)
    y, report = rested(analysis, x)
    thickness = sheet.self_contact.values.thickness
    layers = heights_at(sheet, y, (MIDDLE, 0.52 * WIDTH))
    gaps = np.diff(layers) / thickness
    double = (y[y[:, 0] > MIDDLE, 2].max() - y[:, 2].min()) / FOLD
    top = (y[y[:, 0] < MIDDLE, 2].max() - layers[2]) / FOLD if len(layers) == 4 else 0.0
    source, known = "heavy elastica with contact, by shooting", loop_height(thickness / FOLD)
    four = len(gaps) == 3 and bool((gaps > 0.3).all() and (gaps < 1.0).all())
    between = known <= double <= GLUED * known
    return [
        Check("folded twice: four layers, contact apart", int(four), 1, 0, "nothing passes", CLOSED_FORM),
        Check("folded twice: upper fold over (D/w)^(1/3)", top, known, CAUGHT, source, CLOSED_FORM),
        Check("folded twice: lower fold as free to as glued layers", int(between), 1, 0, source, CLOSED_FORM),
        Check("folded twice: crossings", len(sheet.surface.crossed(y)), 0, 0, "nothing passes", CLOSED_FORM),
        Check("folded twice: rests", int(report.converged), 1, 0, "it is heavy", CLOSED_FORM),
    ]
