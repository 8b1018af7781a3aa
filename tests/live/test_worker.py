"""The process of a live session that simulates, as the server drives it."""

from pathlib import Path

import numpy as np
import pytest
from live_worker import live_worker

import restshape

PLATE = """
format = "restshape-scene"
version = 1
app = "solid"

[shape]
outline = ["bottom", "right", "top", "left"]

[shape.vertices]
a = [0, 0]
b = [2, 0]
c = [2, 1]
d = [0, 1]

[shape.edges]
bottom = { line = ["a", "b"] }
right = { line = ["b", "c"] }
top = { line = ["c", "d"] }
left = { line = ["d", "a"] }

[shape.holes]
window = { circle = { center = [0.4, 0.5], radius = 0.12 } }

[material.steel]
E = "210 GPa"
nu = 0.3
thickness = "10 mm"

[effects.solid]
model = "plane_stress"

[supports.wall]
on = "left"
fix = ["x", "y"]

[loads.pull]
on = "right"
traction = ["100 MPa", 0]

[mesh]
size = "150 mm"
order = 1

[quantities]
peak_stress = { stress = "von_mises", reduce = "max" }
"""


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "plate.toml"
    path.write_text(PLATE)
    return path


def rows_of(scene: Path, script: Path, predict: str = "none") -> list[dict[str, object]]:
    """The rows of a replay, cut likewise."""
    loaded = restshape.load(scene)
    return [
        cut(frame.row) for frame in restshape.replay(loaded, restshape.load_script(script, loaded), predict=predict)
    ]


def cut(row):
    """The columns of a row that a frame of the page has, but times."""
    return {
        name: value
        for name, value in row.items()
        if not name.startswith("ms") and value != "" and value == value and name not in ("t", "estimate_time")
    }


def test_the_script_of_a_session_replays_to_its_rows_and_a_bad_message_is_answered_and_ignored(scene, tmp_path):
    out, frames = tmp_path / "session.jsonl", []
    with live_worker(scene, "--out", str(out)) as live:
        welcome = live.next()
        assert (welcome["type"], welcome["field"], welcome["dim"]) == ("welcome", "von_mises", 2)
        frames.append(live.next())
        sent = [live.event("press", on="window", at=[0.4, 0.5])]
        sent += [live.event("drag", to=[0.4 + 0.02 * i, 0.5 + 0.001 * i]) for i in range(1, 12)]
        sent += [live.event("release"), live.event("undo"), live.event("redo")]
        for number in sent:
            frames.append(live.until(number))
        assert live.until(live.send("dance"))["type"] == "refused"
        live.link.send({"type": "event"})
        assert live.next()["message"]
        assert live.until(live.event("drag", to=[1, 1]))["place"]
        frames.append(live.until(live.event("drill", on="x")))
        assert frames.pop()["type"] == "refused"
        shape = {key: live.arrays["shape", key] for key in ("points", "cells", "displacement", "value")}
    assert [frame["type"] for frame in frames] == ["frame"] * 16
    assert [cut(frame["columns"]) for frame in frames] == rows_of(scene, out)
    loaded = restshape.load(scene)
    *_, last = (frame.keep() for frame in restshape.replay(loaded, restshape.load_script(out, loaded)))
    assert np.array_equal(shape["points"][:, :2], last.mesh.points.astype("f4"))
    assert np.array_equal(shape["cells"], last.mesh.cells)
    assert np.array_equal(shape["displacement"][:, :2], last.displacement.astype("f4"))
    assert np.array_equal(shape["value"], last.von_mises.astype("f4"))
