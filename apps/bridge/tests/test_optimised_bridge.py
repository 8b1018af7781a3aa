"""The bridge that scipy.optimize finds, with derivatives of frames, beside that of the scripted designer."""

import runpy
from pathlib import Path

import numpy as np
import pytest

import restshape

EXAMPLE = runpy.run_path(str(Path(__file__).parents[1] / "python" / "optimise.py"))
COARSE = ("mesh.size='900 mm'", "mesh.order=1")


def test_derivatives_of_a_design_are_those_of_designs_beside_it():
    scene = restshape.load(EXAMPLE["SCENE"], *COARSE)
    with restshape.open(EXAMPLE["with_parameters"](scene)) as sim:
        design, x, step = EXAMPLE["Design"](sim), np.array(EXAMPLE["START"]), np.array([1e-4, 0.0])
        areas, rooms = ([ask(x + way) for way in (step, -step)] for ask in (design.score, design.room))
        assert design.score(x)[1][0] == pytest.approx((areas[0][0] - areas[1][0]) / 2e-4, rel=1e-6)
        assert design.room_slopes(x)[0] == pytest.approx((rooms[0] - rooms[1]) / 2e-4, rel=1e-2)
        assert design.count == 3


@pytest.mark.weekly
def test_the_optimised_bridge_is_no_worse_than_the_designers():
    scene = restshape.load(EXAMPLE["SCENE"], *COARSE)
    with restshape.open(EXAMPLE["with_parameters"](scene)) as sim:
        _, best, design = EXAMPLE["optimised"](sim)
    assert best["strength"] <= design.limit
    assert best["score"] <= EXAMPLE["designer"](scene)
