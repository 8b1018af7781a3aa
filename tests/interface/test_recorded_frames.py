"""Recordings for programs, and pictures of frames: those that a report draws."""

from pathlib import Path

import numpy as np
import pytest

import restshape
from restshape.application import application_of
from restshape.replay.request import Request
from restshape.scene.edit_script import Script
from restshape.variation.following_session import FollowingSession, Standing

BRACKET = Path(__file__).parents[2] / "docs" / "examples" / "bracket.toml"
PNG = b"\x89PNG\r\n"


@pytest.fixture(scope="module")
def bracket():
    return restshape.load(BRACKET, "mesh.size='30 mm'", "mesh.near.window='15 mm'")


def test_a_recording_has_the_frames_that_were_replayed(bracket, tmp_path):
    path, table = tmp_path / "bracket.vtkhdf", tmp_path / "bracket.csv"
    script = restshape.new_script(bracket, [{"do": "scale", "on": "window", "factor": 1.1, "frames": 3}])
    run = restshape.replay(bracket, script, out=path, csv=table, parity=True, summed=True)
    frames = [frame.keep() for frame in run]
    assert run.summary()["parity"]["holds"] and run.summary()["frames"] == 4
    assert len(table.read_text().splitlines()) == 5
    with restshape.recording(path) as found:
        assert found.status == "done" and found.header["scene"] == "bracket.toml"
        assert found.scene.raw == bracket.raw and found.script.events == script.events
        assert len(found.frames) == 4 and [frame.index for frame in found.frames[1:]] == [1, 2, 3]
        for then, frame in zip(frames, found.frames):
            assert frame.quantities == then.quantities and frame.findings == then.findings
            assert repr(frame) == repr(then) and frame.mesh.cell_type == then.mesh.cell_type
            np.testing.assert_array_equal(frame.mesh.points, then.mesh.points)
            np.testing.assert_array_equal(frame.mesh.cells, then.mesh.cells)
            assert frame.fields.keys() == then.fields.keys()
            for name, field in frame.fields.items():
                np.testing.assert_array_equal(field, then.fields[name])
        with pytest.raises(IndexError):
            found.frames[4]
        assert found.frames[-1].index == 3
        assert repr(found) == "<recording bracket.vtkhdf: 4 frames>"
        assert found._repr_png_().startswith(PNG) and found._repr_png_() != found.frames[1]._repr_png_()


def test_a_frame_is_drawn_as_a_recording_of_it(bracket, tmp_path):
    path = tmp_path / "first.vtkhdf"
    run = restshape.replay(bracket, out=path, parity=True)
    drawn = next(run)._repr_png_()
    assert not list(run)
    with restshape.recording(path) as found:
        assert drawn.startswith(PNG) and drawn == found._repr_png_() == found.frames[0]._repr_png_()
        (read,) = found.frames
        assert not found.closed and read.fields
    assert found.closed and found._repr_png_() is None and read._repr_png_() is None
    assert read.fields["displacement"].shape[1] == 2 and found.frames[0].quantities
    with pytest.raises(restshape.UserError, match="the recording is closed"):
        assert read.mesh


def test_a_frame_that_is_gone_is_not_drawn(bracket):
    with restshape.open(bracket) as sim:
        first, kept = sim.frame, sim.idle().keep()
        sim.scale("window", 1.2)
        assert first._repr_png_() is None
        assert kept._repr_png_() != sim._repr_png_()
    assert sim._repr_png_().startswith(PNG)


def test_of_frames_of_a_run_that_another_one_follows_nothing_more_is_read(bracket):
    run = restshape.replay(bracket)
    (frame,) = run
    points = frame.mesh.points
    other = restshape.changed(bracket, "material.steel.E", "70 GPa")
    script, before = Script.empty(other), Standing(run.replay.session.outline, bracket, False)
    session = FollowingSession(other, script, application_of(other), before, False, None)
    (next_frame,) = run.follow(session, Request.of(other, script))
    assert frame.mesh.points is points and next_frame.fields
    with pytest.raises(restshape.UserError, match="closed"):
        assert frame.fields


def test_a_run_that_is_left_has_written_what_it_had(bracket, tmp_path):
    path = tmp_path / "left.vtkhdf"
    script = restshape.new_script(bracket, [{"do": "idle", "frames": 9}])
    run = restshape.replay(bracket, script, out=path)
    next(run), next(run)
    run.close()
    with restshape.recording(path) as found:
        assert found.status == "interrupted" and found.n == 2
    restshape.replay(bracket, script, out=tmp_path / "none.vtkhdf").close()
    assert not [one.name for one in tmp_path.iterdir() if "none" in one.name]
    with pytest.raises(restshape.UserError, match="not summed up"):
        run.summary()
    with pytest.raises(restshape.UserError, match=r"ends in \.vtkhdf"):
        restshape.replay(bracket, script, out=tmp_path / "left.csv")
    with pytest.raises(restshape.UserError, match="no such recording"):
        restshape.recording(tmp_path / "none.vtkhdf")
