"""Contacts that slide: equilibria that Newton's method does not find from springs, and what is reported where none
is."""

from dataclasses import replace

import numpy as np
import pytest
from furniture_scenes import write_edits
from restshape_apps.furniture.analysis.plank_equilibrium import PlankEquilibrium
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_apps.furniture.pieces import SCENES, stool_chair, table
from restshape_apps.furniture.shape.planks import Load, Piece, Plane
from small_scenes import make_replay, rows_of

from restshape.errors import ReplayProblem


def slippery(lean: float, kilograms: float, mu: float) -> Furniture:
    """A chair of slanted legs on a floor of little friction, just tested."""
    furniture = Furniture(replace(stool_chair(lean=lean, kilograms=kilograms), planes=(Plane(mu=mu),)))
    furniture.test()
    return furniture


@pytest.mark.parametrize(("lean", "kilograms", "mu"), [(0.15, 20.0, 0.03), (0.2, 80.0, 0.05), (0.3, 80.0, 0.08)])
def test_legs_that_slide_come_to_rest(lean: float, kilograms: float, mu: float) -> None:
    furniture = slippery(lean, kilograms, mu)
    quick, solver = furniture.forces(), PlankEquilibrium(furniture)
    springs = solver.solve(0, one_sided=False)
    with pytest.raises(ReplayProblem):
        solver.solve(0, one_sided=True, guess=springs.u)
    for forces in (quick, solver.solve(0)):
        assert forces.one_sided and not solver.sprung
        pressed, along = forces.contacts[:, 2], np.hypot(*forces.contacts[:, :2].T)
        weight = 9.80665 * furniture.geometry().mass.sum() - sum(load.force[2] for load in furniture.piece.weights)
        assert forces.contacts.sum(axis=0) == pytest.approx([0.0, 0.0, weight], abs=1e-6 * weight)
        # What slides bears just as much as friction allows; nothing pulls.
        assert pressed.min() >= 0.0 and (along <= mu * pressed + 1e-6 * weight).all()
        assert (np.abs(along - mu * pressed) < 1e-6 * weight).sum() >= 2
    # The two ways agree, and do not depend on what was tested before.
    assert solver.solve(0).bending == pytest.approx(quick.bending, abs=1e-6 * np.abs(quick.bending).max())
    furniture.test(np.full((len(furniture.piece.planks), 8), 1e-3))
    furniture.test()
    assert furniture.forces().bending == pytest.approx(quick.bending, abs=1e-6 * np.abs(quick.bending).max())


def near_the_limit(newtons: float) -> Piece:
    """A table that is pushed at a corner."""
    return replace(table(), pushes=(Load("shove", 0, (0.3, -0.4, 0.5), (newtons, 0.0, 0.0)),))


@pytest.mark.slow
def test_what_springs_decide_is_reported(tmp_path) -> None:
    # The push is 98 % of what friction bears in all; it is the springs of no contact law that this is left to.
    furniture = Furniture(near_the_limit(200.0))
    furniture.test()
    assert furniture.forces(1).unbalanced < 1e-7 and not furniture.forces(1).one_sided
    script = write_edits(tmp_path, {"do": "idle"})
    overrides = ["pushes.push.at=[0.3, -0.4, 0.5]", "effects.push={}"]
    printed = {}
    for force in (200.0, 100.0):
        rows = rows_of(make_replay(SCENES / "table.toml", script, overrides=[*overrides, f"parameters.push={force}"]))
        printed[force] = [row["note"] for row in rows]
    words = "forces under push push are of feet that springs hold: with feet that only push no equilibrium was found"
    assert printed == {200.0: [words, words], 100.0: ["", ""]}
