"""Where plates are still, and where they are hung, against closed forms."""

import numpy as np
from petsc4py import PETSc
from restshape_studies.validation.case import CLOSED_FORM, Check
from restshape_verification.metallophone.reference import solved
from scipy.optimize import brentq
from scipy.special import iv, jv

from restshape.analysis.modal.hanging import Hanging, hanging_of, hanging_points
from restshape.analysis.modal.modal import ModalAnalysis
from restshape.analysis.modal.nodal_lines import linear_triangles, nodal_lines

RING = 3
"""The mode of a free disc that is still along a circle: two with two nodal diameters lie below it."""
PAIR = 4
"""The first mode of a free square that is one of a pair."""
NARROW = (
    "effects.modal.model=plate",
    "effects.modal.modes=4",
    "material.aluminium.nu=0",
    'material.aluminium.thickness="0.4 mm"',
    'mesh.size="2.5 mm"',
    'shape.vertices.c=["200 mm", "6 mm"]',
    'shape.vertices.d=["0 mm", "6 mm"]',
)
"""Overrides that make a bar a beam of 200 mm."""


def hanging(comm: PETSc.Comm) -> list[Check]:
    """Hanging points of a free bar, the cross of a free square, ring of a free disc; pairs, whose lines are free."""
    bar = solved("bar_200.toml", comm, NARROW)
    hung = hanging_points(bar)
    node, ends = beam_node(), "nodes of Euler and Bernoulli's free beam"
    checks = [
        Check(
            "first hanging point of a free bar, x / length",
            float(hung.places[0, 0]) / 0.2,
            node,
            3e-4,
            ends,
            CLOSED_FORM,
        ),
        Check("second one", float(hung.places[1, 0]) / 0.2, 1.0 - node, 1e-4, ends, CLOSED_FORM),
        Check("what they take from mode 2", float(hung.losses[1]), beam_energy(2, node), 5e-3, "the same", CLOSED_FORM),
        Check("what they take from mode 3", float(hung.losses[2]), beam_energy(3, node), 1e-2, "the same", CLOSED_FORM),
    ]
    square, disc = solved("square.toml", comm), solved("disc.toml", comm, ["supports={}", "mesh.size=0.06"])
    cross = line_places(square, 1) - 5.0
    farthest, ring = float(np.abs(cross).min(axis=1).max()) / 10.0, np.hypot(*line_places(disc, RING).T)
    radius, bessel = disc_radius(0.3), "J_0(k r) + C I_0(k r) = 0, free disc, nu = 0.3"
    checks += [
        Check(
            "distance of a free square's lines from the cross, over its side",
            farthest,
            0.0,
            5e-3,
            "symmetry",
            CLOSED_FORM,
        ),
        Check(
            "least radius of the ring of a free disc, over its own",
            float(ring.min()),
            radius,
            2e-3,
            bessel,
            CLOSED_FORM,
        ),
        Check("largest one", float(ring.max()), radius, 1e-3, bessel, CLOSED_FORM),
    ]
    symmetry = "a pair by symmetry has no lines of its own"
    fixed = {
        "free square, mode 1": fixed_lines(square, 1),
        "free square, one of a pair": fixed_lines(square, PAIR),
        "free disc, one of a pair": fixed_lines(disc, 1),
        "free disc, the ring": fixed_lines(disc, RING),
    }
    return checks + [
        Check(f"whether lines are fixed: {what}", float(found), float("pair" not in what), 0.0, symmetry, CLOSED_FORM)
        for what, found in fixed.items()
    ]


def fixed_lines(analysis: ModalAnalysis, mode: int) -> bool:
    """Whether a mode has lines of its own."""
    return hanging_of(analysis.state, Hanging(mode=mode)).found


def line_places(analysis: ModalAnalysis, rank: int) -> np.ndarray:
    """Places (m, 2) on the nodal lines of a mode by its rank."""
    body, modes = analysis.state.body, analysis.state.modes
    shape = body.shapes(modes.vectors[modes.chosen[rank - 1]][None])[0, :, 2]
    return nodal_lines(linear_triangles(body.plane.cells), shape).ends(body.plane.X).reshape(-1, 2)


def beam_shape(mode: int, x: float | np.ndarray) -> np.ndarray:
    """The mode of a free beam at shares x of its length; its mean square is 1."""
    beta = brentq(lambda b: np.cos(b) - 1.0 / np.cosh(b), (mode + 0.25) * np.pi, (mode + 0.75) * np.pi, xtol=1e-14)
    ratio = (np.cosh(beta) - np.cos(beta)) / (np.sinh(beta) - np.sin(beta))
    b = beta * np.asarray(x)
    return np.cosh(b) + np.cos(b) - ratio * (np.sinh(b) + np.sin(b))


def beam_node() -> float:
    """Where the first mode of a free beam is still: 0.2242 of its length from an end."""
    return float(brentq(lambda x: float(beam_shape(1, x)), 0.1, 0.4, xtol=1e-14))


def beam_energy(mode: int, x: float) -> float:
    """The energy of a mode of a free beam at a share of its length, over its mean."""
    return float(beam_shape(mode, x)) ** 2


def disc_radius(nu: float) -> float:
    """The radius, over its own, of the circle along which the ring mode of a free disc is still: 0.680 for nu = 0.3.

    w = J_0(k r) + C I_0(k r) with no moment and no shear at r = 1.
    """

    def moments(k: float) -> tuple[float, float]:
        bent, grown = k * (1.0 - nu) * jv(1, k) - k**2 * jv(0, k), k**2 * iv(0, k) - k * (1.0 - nu) * iv(1, k)
        return float(bent), float(grown)

    def determinant(k: float) -> float:
        bent, grown = moments(k)
        return bent * k**3 * iv(1, k) - grown * k**3 * jv(1, k)

    k = float(brentq(determinant, 2.5, 3.5, xtol=1e-14))
    bent, grown = moments(k)
    return float(brentq(lambda r: jv(0, k * r) - bent / grown * iv(0, k * r), 0.3, 0.95, xtol=1e-14))
