"""What `restshape.replay` gives besides rows: some frames alone, counts of work, and less that is measured."""

import math
from pathlib import Path

import pytest

import restshape

BRACKET = Path(__file__).parents[2] / "docs" / "examples" / "bracket.toml"
DRAG = [
    {"do": "press", "on": "window", "at": [0.09, 0.062]},
    {"do": "drag", "to": [0.1, 0.062], "frames": 4, "t": 0.1},
]


@pytest.fixture(scope="module")
def asked():
    scene = restshape.load(BRACKET, "mesh.size='30 mm'", "mesh.near.window='15 mm'")
    return scene, restshape.new_script(scene, DRAG)


@pytest.fixture(scope="module")
def whole(asked):
    return list(restshape.replay(*asked).rows())


def test_chosen_frames_alone_are_solved_for(asked, whole):
    last = whole[4]
    found = list(restshape.replay(*asked, only=[4]))
    assert [frame.index for frame in found] == [0, 1, 2, 3, 4]
    for frame in found[2:-1]:
        assert all(map(math.isnan, frame.quantities.values())) and not frame.row["iterations"]
    # Each solve is to the tolerance of the scene.
    assert found[-1].quantities == pytest.approx({name: last[f"q_{name}"] for name in found[-1].quantities}, rel=1e-5)
    with pytest.raises(restshape.UserError, match="no frames are chosen"):
        restshape.replay(*asked, only=[])


def test_what_is_measured_changes_no_other_column(asked, whole):
    for measured in ("residual", "nothing"):
        for frame, row in zip(restshape.replay(*asked, measured=measured), whole, strict=True):
            assert math.isnan(frame.row["residual"]) is (measured == "nothing")
            same = {"iterations", "level", "factor_age", *(name for name in row if name[:2] == "q_")} & row.keys()
            assert {name: frame.row[name] for name in same} == {name: row[name] for name in same}
            assert math.isnan(frame.row.get("estimate", math.nan)) and not math.isnan(row["estimate"])


def test_counts_are_those_of_each_frame(asked):
    counted = list(restshape.replay(*asked, measured="residual", counted=True))
    assert counted[0].counts.events["MatCholFctrNum"] == 1
    kernel = next(name for name in counted[0].counts.calls if name.startswith("linear_elastic"))
    cells = len(counted[-1].mesh.cells)
    # The hand takes hold in frame 1, in which nothing moves.
    assert [frame.index for frame in counted if frame.counts.events["PCApply"]] == [0, 2, 3, 4, 5]
    tangents = [frame.counts.calls.get(kernel, {}).get("tangent") for frame in counted]
    assert tangents == [[1, cells], None, *[[1, cells]] * 4]
    assert restshape.replay(*asked).__next__().counts is None
