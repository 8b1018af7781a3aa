"""The process of a live session that simulates, as the server drives it."""

from pathlib import Path

import numpy as np
from live_worker import live_worker

import restshape

BRACKET = Path(__file__).parents[2] / "docs" / "examples" / "bracket.toml"
COARSE = ("mesh.size='30 mm'", "mesh.near.window='15 mm'", "mesh.order=1")
SET = [word for value in COARSE for word in ("--set", value)]


def rows_of(script: Path, predict: str = "none") -> list[dict[str, object]]:
    """The rows of a replay, cut likewise."""
    loaded = restshape.load(BRACKET, *COARSE)
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


def test_the_script_of_a_session_replays_to_its_rows_and_a_bad_message_is_answered_and_ignored(tmp_path):
    out, frames = tmp_path / "session.jsonl", []
    with live_worker(BRACKET, *SET, "--out", str(out)) as live:
        welcome = live.next()
        assert (welcome["type"], welcome["field"], welcome["dim"]) == ("welcome", "von_mises", 2)
        frames.append(live.next())
        sent = [live.event("press", on="window", at=[0.09, 0.062])]
        sent += [live.event("drag", to=[0.09 + 0.003 * i, 0.062 + 0.0005 * i]) for i in range(1, 12)]
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
    assert [cut(frame["columns"]) for frame in frames] == rows_of(out)
    loaded = restshape.load(BRACKET, *COARSE)
    *_, last = (frame.keep() for frame in restshape.replay(loaded, restshape.load_script(out, loaded)))
    assert np.array_equal(shape["points"][:, :2], last.mesh.points.astype("f4"))
    assert np.array_equal(shape["cells"], last.mesh.cells)
    assert np.array_equal(shape["displacement"][:, :2], last.displacement.astype("f4"))
    assert np.array_equal(shape["value"], last.von_mises.astype("f4"))
