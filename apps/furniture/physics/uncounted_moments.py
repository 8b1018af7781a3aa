"""Moments of joints that durability does not count: what bends a joint along its line, and what twists it."""

from collections.abc import Sequence

import numpy as np
from restshape_apps.furniture.physics.furniture import Forces, Furniture
from restshape_apps.furniture.physics.plank_phrases import uncounted

FAINT = 0.01
"""Of the moment that a joint bears about its line: so little twist is not reported of a single fastener."""


def uncounted_uses(
    furniture: Furniture, forces: Forces, length: np.ndarray, nails: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """What fasteners bear of a case's moments about the joint's other two axes, in parts of their strength.

    A joint bent along its line turns about the line's end; its fasteners, in the middles of equal parts of the line,
    are drawn in proportion to their distance from there, beside T. One that is twisted turns about the line's middle,
    and shears them in proportion to their distance from it; a single one does not hold it at all.

    Args:
        forces: of the case, with moments about x and n.
        length: (j,) of the joints [m]; nails: (j,) fasteners in them.

    Returns: (j,) pull and (j,) shear of the fastener that bears most.

    Source: docs/theory/furniture.md, "Not counted".
    """
    pull, shear = furniture.strength.T
    bent, twisted = np.abs(forces.twist).T
    drawn = (6.0 * bent / (length * (2.0 * nails + 1.0)) + forces.tension / nails) / pull
    turned = 6.0 * twisted / (length * (nails + 1.0)) / shear
    held = FAINT * 0.5 * furniture.lever * pull
    alone = np.where(twisted > held, np.inf, 0.0)
    return drawn, np.where(nails > 1, turned, alone)


def uncounted_moments(furniture: Furniture, cases: Sequence[Forces], gamma: np.ndarray) -> str:
    """Words on joints whose uncounted moments are more than their fasteners bear; empty without any.

    Args:
        furniture: as last tested, at design parameters gamma (n, 8).
        cases: forces of all cases there.
    """
    length, nails = furniture.geometry(gamma).length, furniture.nails()
    bent, twisted = set(), set()
    for forces in cases:
        drawn, turned = uncounted_uses(furniture, forces, length, nails)
        bent |= set(np.flatnonzero(drawn > 1.0).tolist())
        twisted |= set(np.flatnonzero(turned > 1.0).tolist())
    # What is drawn out by T alone is in the status.
    counted = {k for forces in cases for k in np.flatnonzero(forces.pull_use > 1.0).tolist()}
    return uncounted(furniture.piece, sorted(bent - counted), sorted(twisted))
