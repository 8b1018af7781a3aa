"""Arrays of frames that are kept while the edit goes on, and that are the solver's own where it makes new ones."""

from itertools import islice
from pathlib import Path

import numpy as np
import pytest

import restshape

ROOT = Path(__file__).parents[2]
APPS, BRACKET = ROOT / "apps", ROOT / "docs" / "examples" / "bracket.toml"
SCENES = {"steady_flow": "50 mm", "csm3": "20 mm", "building": "", "fins": "", "incline": "", "shelf-1": ""}
"""Scenes of many kinds of analysis, with the size of their mesh where their own takes long."""


def arrays(frame):
    """All arrays of a frame."""
    return {"points": frame.mesh.points, "cells": frame.mesh.cells, **frame.fields}


@pytest.mark.parametrize("name", SCENES)
def test_arrays_of_kept_frames_stay(name):
    (path,) = APPS.glob(f"*/scenes/{name}.toml")
    scene = restshape.load(path, *([f"mesh.size='{SCENES[name]}'"] if SCENES[name] else []))
    script = restshape.load_script(path.parents[1] / "edits" / f"{name}.jsonl", scene)
    kept, moved = [], False
    for frame in islice(restshape.replay(scene, script), 12):
        found = arrays(frame)
        kept.append((frame.keep(), {key: array.copy() for key, array in found.items()}))
        assert not any(array.flags.writeable for array in found.values())
    for frame, then in kept:
        for key, array in arrays(frame).items():
            np.testing.assert_array_equal(array, then[key], err_msg=f"{key} of frame {frame.index}")
        moved |= any(not np.array_equal(then[key], kept[0][1].get(key)) for key in frame.fields)
    assert moved


def test_fields_are_those_of_the_solver_and_frames_share_cells():
    scene = restshape.load(BRACKET, "mesh.size='20 mm'")
    with restshape.open(scene) as sim:
        first = sim.frame.keep()
        at_nodes, _ = sim._replay.analysis.fields()
        assert np.shares_memory(first.displacement, at_nodes["displacement"])
        with sim.press("window") as hand:
            moved = hand.to(0.091, 0.062)
            assert moved.row["level"] == 1 and moved.mesh.cells is first.mesh.cells
            assert not np.array_equal(moved.mesh.points, first.mesh.points)
        with pytest.raises(ValueError, match="read-only"):
            first.displacement[0] = 0.0
