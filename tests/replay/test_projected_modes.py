"""Modes, load factors and drapes of Morley's triangles that go on to a new mesh within a drag."""

import json
from itertools import pairwise

import modal
import numpy as np
import pytest
from columns import column
from drape_designs import HELD, sheet
from small_scenes import make_replay, rows_of, write_scene

from restshape.mesh.moving import MovingMesh
from restshape.replay.parity import Parity
from restshape.replay.sampled_frames import SampledFrames

FRAME, SHORT = 1.0 / 60.0, 1e-5
"""Edit time [s] of a frame, and one that pays for no solve."""
NEW = 29
"""The frame after the rests: it has a new mesh."""


def timed(path, on, rests, far, back):
    """A script with rests, then a way far off and back in no edit time: what it is predicted from was known before."""
    events, t = [{"t": 0.0, "do": "press", "on": on, "at": list(rests[0])}], 0.2
    for place in rests[1:]:
        events += [{"t": t, "do": "drag", "to": list(place)}, {"t": t + FRAME, "do": "idle", "frames": 8}]
        t += 20 * FRAME
    events += [{"t": t + SHORT * k, "do": "drag", "to": list(place)} for k, place in enumerate((far, *back))]
    events += [{"t": t + 1.0, "do": "release"}]
    head = {"format": "restshape-edits", "version": 1, "units": "m"}
    path.write_text("".join(json.dumps(line) + "\n" for line in (head, *events)))
    return path


def back_through(rests):
    """Places in the middle between those of rests, backwards."""
    return [tuple(0.5 * (np.array(a) + b)) for a, b in pairwise(rests[::-1])]


def ways_back(begin, look, monkeypatch):
    """Mean relative errors of the frames after a new mesh, with samples of the mesh before and without, and rows."""
    found, errors, follow = {}, {}, MovingMesh._follow

    def remesh(self, frame):
        return self._reconstruct(frame, {}, "for the test") if frame.index == NEW else follow(self, frame)

    monkeypatch.setattr(MovingMesh, "_follow", remesh)
    for way in ("none", "gmls", "alone"):
        with monkeypatch.context() as patch:
            if way == "alone":
                patch.setattr(SampledFrames, "_leave", lambda *_: None)
            made, values = begin("none" if way == "none" else "gmls"), []
            rows = rows_of(made, lambda row, made=made, values=values: values.append(look(made.analysis)))
        found[way] = rows, values
    exact = found["none"][1]
    new = max(row["index"] for row in found["gmls"][0] if row["level"] == 3)
    for way in ("gmls", "alone"):
        rows, values = found[way]
        after = [k for k in range(new + 1, len(rows)) if rows[k]["predicted"]]
        errors[way] = np.mean([np.linalg.norm(values[k] - exact[k]) / np.linalg.norm(exact[k]) for k in after])
    return errors, found["gmls"][0], new


def with_parity(made, frames):
    """All solved frames are those of cold solves."""
    check = Parity(made)
    assert sum(1 for _ in made.frames() if check()) == frames and check.summary()["holds"]


SQUARE = ["mesh.size=1.2", "effects.modal.modes=3"]
BAR = (0.1, 0.01)
CASES = {
    "plate": ("square.toml", SQUARE, "c", [(10.0, 10.0), (10.8, 10.2), (11.6, 10.4), (12.4, 10.6)], (12.6, 10.65)),
    "tet10": (*modal.SMALL["tet10"], "right", [BAR, (0.105, 0.01), (0.11, 0.01), (0.115, 0.01)], (0.116, 0.01)),
    "tri6": (
        "slender.toml",
        [*modal.SMALL["plane"][1], "mesh.order=2"],
        "right",
        [(1.0, 0.025), (1.05, 0.025), (1.1, 0.025), (1.15, 0.025)],
        (1.16, 0.025),
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_modes_of_a_drag_go_on_to_a_new_mesh(tmp_path, case, monkeypatch):
    scene, own, on, rests, far = CASES[case]
    script = timed(tmp_path / "edits.jsonl", on, rests, far, back_through(rests))
    over = [*own, "solve.tolerance=1e-7", "predict.frame_time=0"]
    begin = lambda way: modal.replay(scene, script, over, predict=way)  # noqa: E731
    errors, rows, new = ways_back(begin, lambda analysis: analysis.frequencies.copy(), monkeypatch)
    assert rows[new]["samples_projected"] == rows[new]["samples"] - 1 >= 3
    assert errors["gmls"] < errors["alone"] / 6.0
    if case == "plate":
        with_parity(begin("gmls"), len(rows))


@pytest.mark.slow
def test_load_factors_of_a_drag_go_on_to_a_new_mesh(tmp_path, monkeypatch):
    scene = write_scene(tmp_path, column(height=0.2, size=0.06))
    rests = [(0.5, 0.2), (0.5, 0.17), (0.5, 0.14), (0.5, 0.11)]
    script = timed(tmp_path / "edits.jsonl", "top", rests, (0.5, 0.105), back_through(rests))
    begin = lambda way: make_replay(scene, script, overrides=["predict.frame_time=0"], predict=way)  # noqa: E731
    errors, rows, new = ways_back(begin, lambda analysis: analysis.load_factors.copy(), monkeypatch)
    assert rows[new]["samples_projected"] == rows[new]["samples"] - 1 == 3
    assert errors["gmls"] < errors["alone"] / 2.0
    with_parity(begin("gmls"), len(rows))


@pytest.mark.slow
def test_drapes_with_mid_edge_unknowns_go_on_to_a_new_mesh(tmp_path, monkeypatch):
    scene = write_scene(tmp_path, sheet("morley", HELD, size=0.04))
    rests = [(0.2, 0.1), (0.22, 0.1), (0.24, 0.1), (0.26, 0.1)]
    script = timed(tmp_path / "edits.jsonl", "right", rests, (0.265, 0.1), back_through(rests))
    begin = lambda way: make_replay(scene, script, overrides=["predict.frame_time=0"], predict=way)  # noqa: E731
    errors, rows, new = ways_back(begin, lambda analysis: analysis.problem.corners(analysis.x).copy(), monkeypatch)
    assert rows[new]["samples_projected"] == rows[new]["samples"] - 1 == 4
    assert errors["gmls"] < errors["alone"] / 1.5
