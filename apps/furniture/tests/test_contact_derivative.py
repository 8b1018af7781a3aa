"""Derivatives of forces where contacts slide, lift off, stand in a line, or on two planes: Taylor remainders.

The derivative keeps what each contact does: hold, slide, or nothing. Each test checks that this stays as it is over
its steps; where it changes there is no derivative, and none is tested. Where contacts leave a motion free, how far the
piece goes along it is a convention, not an answer: there forces are tested, and displacements are not.
"""

from dataclasses import replace

import numpy as np
import pytest
from restshape_apps.furniture.physics.derivatives import ForceDerivative, force_derivative
from restshape_apps.furniture.physics.furniture import Compliance, Forces, Furniture
from restshape_apps.furniture.pieces import shelf_1, stool_chair, table
from restshape_apps.furniture.shape.design_modes import DesignModes
from restshape_apps.furniture.shape.planks import Load, Piece, Plane
from restshape_apps.furniture.small_pieces import bench, ladder, stool

FORCES = ("tension", "bending", "shear")
STEPS = np.array([8e-3, 4e-3, 2e-3])
"""In parts of the piece's size."""


def doing(furniture: Furniture, forces: Forces) -> list[str]:
    """What each contact does: holds, slides, or nothing."""
    found = []
    normals = np.repeat([furniture.piece.planes[foot.plane].normal for foot in furniture.piece.feet], 4, axis=0)
    mus = np.repeat([furniture.piece.planes[foot.plane].mu for foot in furniture.piece.feet], 4)
    for f, n, mu in zip(forces.contacts, normals, mus):
        pressed = float(f @ n)
        along = float(np.linalg.norm(f - pressed * n))
        found.append("nothing" if pressed <= 0.0 else "slides" if along >= mu * pressed * (1.0 - 1e-9) else "holds")
    return found


def remainders(
    furniture: Furniture, change: ForceDerivative, gamma: np.ndarray, weights: np.ndarray, names: tuple[str, ...]
) -> dict[str, list[float]]:
    """What the derivative leaves at each step, in parts of the largest force or displacement of the last case."""
    case = len(furniture.cases) - 1
    furniture.test()
    base, found = furniture.forces(case), {}
    at_first = doing(furniture, base)
    largest = max(np.abs(getattr(base, name)).max(initial=0.0) for name in FORCES)
    for step in STEPS:
        furniture.test(step * gamma)
        moved = furniture.forces(case)
        assert moved.one_sided == base.one_sided and (not base.one_sided or doing(furniture, moved) == at_first)
        for name in names:
            now, before = getattr(moved, name), getattr(base, name)
            rest = now - before - step * np.tensordot(weights, getattr(change, name), axes=1)
            size = largest if name in FORCES else np.abs(before).max()
            found.setdefault(name, []).append(float(np.abs(rest).max(initial=0.0) / (size or 1.0)))
    furniture.test()
    return found


def check(
    piece: Piece,
    width: float = 1.0,
    names: tuple[str, ...] = ("u", *FORCES),
    compliance: Compliance | None = None,
) -> Furniture:
    """The model, after remainders of second order along combinations of all modes, and along single ones.

    Args:
        width: of a combination, in parts of a mode's unit.
        names: of what is looked at.
    """
    furniture = Furniture(piece, compliance)
    furniture.test()
    modes, case = DesignModes.of(piece, furniture.kernel.freedoms()), len(furniture.cases) - 1
    furniture.test()
    change = force_derivative(furniture, modes.directions, case)
    rng = np.random.default_rng(11)
    trials = [width * w / np.linalg.norm(w) for w in rng.normal(size=(3, len(modes)))]
    trials += list(width * np.eye(len(modes))[rng.choice(len(modes), min(3, len(modes)), replace=False)])
    curved = 0
    for weights in trials:
        gamma = (weights @ modes.directions).reshape(-1, 8)
        for name, rest in remainders(furniture, change, gamma, weights, names).items():
            # Below that there is nothing but rounding: the force goes as a straight line.
            if rest[0] > 3e-6:
                curved += 1
                assert np.log2(np.array(rest[:-1]) / rest[1:]) == pytest.approx(2.0, abs=0.15), (name, rest)
            else:
                assert max(rest) < 1e-5
    assert curved >= 1
    return furniture


@pytest.mark.parametrize(("lean", "kilograms", "mu"), [(0.2, 20.0, 0.03), (0.3, 80.0, 0.05)])
def test_where_feet_slide(lean: float, kilograms: float, mu: float) -> None:
    piece = replace(stool_chair(lean=lean, kilograms=kilograms), planes=(Plane(mu=mu),))
    furniture = check(piece, 0.6)
    forces = furniture.forces()
    assert forces.one_sided and "slides" in doing(furniture, forces)


def test_where_a_push_lifts_feet() -> None:
    push = Load("push", 0, (0.0, 0.0, 0.5), (0.0, 55.0, 0.0))
    furniture = check(replace(shelf_1(), pushes=(push,)), 0.3)
    forces = furniture.forces(1)
    assert forces.one_sided and "nothing" in doing(furniture, forces)


def test_where_a_push_is_borne_by_springs() -> None:
    furniture = check(table(push=30.0))
    assert not furniture.forces(1).one_sided


@pytest.mark.parametrize(("mu", "names"), [(0.0, FORCES), (0.5, ("u", *FORCES))])
def test_where_feet_stand_in_a_line(mu: float, names: tuple[str, ...]) -> None:
    # Two legs of 10 mm by 10 mm: all feet lie within 5 mm of a line, above which the weight is.
    piece = stool([(-0.4, 0.0), (0.4, 0.0)], (0.1, 0.0), 10.0, mu=mu, width=(0.0, 0.01, 0.0))
    thin = tuple(replace(p, size=np.array([p.size[0], 0.01, 0.01])) for p in piece.planks[1:])
    furniture = check(replace(piece, planks=(piece.planks[0], *thin)), 0.3, names, Compliance(least_overlap=1e-6))
    assert np.ptp(furniture.geometry().contacts[:, 1]) == pytest.approx(0.01)


def test_where_a_plank_stands_on_two_planes() -> None:
    # A ladder against a smooth wall: it has lines for feet, and one plank.
    furniture = check(ladder(1.2, 0.5), 1.0, ("u",))
    assert {foot.plane for foot in furniture.piece.feet} == {0, 1}


def test_where_nothing_holds_along_the_floor() -> None:
    furniture = check(bench(mu=0.0, leg=0.02), 1.0, FORCES)
    assert np.abs(furniture.forces().contacts[:, :2]).max() < 1e-6
