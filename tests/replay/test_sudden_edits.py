"""A shape that goes far in one frame of a motion: the note says that this puts energy into it."""

import pytest
from small_scenes import (
    CLAMPED,
    HEAD,
    PULLED,
    STEEL,
    across,
    block,
    drag,
    head,
    make_replay,
    meshed,
    rows_of,
    write_scene,
    write_script,
)

BODY = block(2.0, 1.0) + STEEL + CLAMPED + PULLED + meshed(0.25)
IN_TIME = head("moving") + '[effects.dynamics]\ntime_step = "1 ms"\nsteps = 3\n' + BODY
WORK = '[quantities]\nwork = { energy = "edit" }\nwhole = { energy = "total" }\n'


def notes(folder, text, frames):
    """The rows of a drag in so many frames, and its undo."""
    events = [{"do": "idle", "frames": 9}, *drag("c", (2, 1), across((2, 1), (2.4, 1), frames)), {"do": "undo"}]
    return rows_of(make_replay(write_scene(folder, text), write_script(folder, events)))


@pytest.mark.parametrize(("frames", "said"), [(8, False), (2, True)])
def test_what_goes_far_in_a_frame_of_a_motion_is_said_to_put_energy_into_it(tmp_path, frames, said):
    rows = notes(tmp_path, IN_TIME + WORK, frames)
    assert not any(row["refused"] for row in rows)
    by_event = {row["event"]: str(row["note"]) for row in rows}
    assert ("puts energy into the motion: take more frames" in by_event["drag"]) == said and by_event["idle"] == ""
    assert "goes 17 % of its size in a frame" in by_event["undo"] and "drag it back over frames" in by_event["undo"]
    # It is true.
    last, before = rows[-1], rows[-2]
    assert last["q_work"] - before["q_work"] > 0.01 * before["q_whole"]


def test_steady_answers_have_no_energy_of_motion(tmp_path):
    assert not any(row["note"] for row in notes(tmp_path, HEAD + BODY, 2))
