"""What a hand of the live page takes hold of is the plank that is drawn under it."""

from pathlib import Path

import numpy as np

import restshape
from restshape.live.frame_picture import FramePicture

TABLE = Path(__file__).parents[1] / "scenes" / "table.toml"


def test_the_triangles_of_a_plank_are_around_its_centre():
    with restshape.open(restshape.load(TABLE)) as sim:
        picture = FramePicture(sim)
        (shape,) = picture.parts()
        planks = sim.replay.solver.space.frame.design.piece.planks
        points, cells = (shape.arrays[key].astype(float) for key in ("points", "cells"))
        seen = []
        for thing, plank in zip(picture.things(), planks, strict=True):
            rows = np.concatenate([np.arange(first, first + count) for first, count in thing.triangles])
            corners = points[cells[rows].astype(int)].reshape(-1, 3)
            assert thing.name == plank.name and len(np.unique(corners, axis=0)) == 8
            np.testing.assert_allclose(corners.mean(axis=0), plank.centre, atol=0.02)
            seen += rows.tolist()
        assert sorted(seen) == list(range(len(cells)))
