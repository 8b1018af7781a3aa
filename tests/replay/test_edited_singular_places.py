"""Singular places that edits make and remove, against Williams's angle: re-entrant corners alone are singular."""

import math

import numpy as np
import pytest
from small_scenes import CLAMPED, HEAD, STEEL, drag, make_replay, plate, rows_of, write_scene, write_script

from restshape.replay.constraints import FAILS, HOLDS, UNCERTAIN
from restshape.replay.singular_quantities import AT, NO_MORE

STRIP = (
    HEAD
    + """
[shape]
outline = ["bottom", "right", "t1", "t2", "left"]
vertices = { a = [0, 0], b = [2, 0], c = [2, 1], m = [1, TOP], d = [0, 1] }
[shape.edges]
bottom = { line = ["a", "b"] }
right = { line = ["b", "c"] }
t1 = { line = ["c", "m"] }
t2 = { line = ["m", "d"] }
left = { line = ["d", "a"] }
"""
    + STEEL
    + CLAMPED
    + '[loads.pull]\non = "right"\ntraction = [1e6, 0]\n[mesh]\nsize = 0.25\n[quantities]\n'
    + 'tip = { stress = "von_mises", at = "m", max = "1 GPa" }\n[solve]\nestimate = "every"\n'
)


def moved(folder, top, to, frames=3):
    """The rows of a replay in which the middle of the upper side goes from one height to another."""
    scene = write_scene(folder, STRIP.replace("TOP", str(top)))
    events = [{"do": "press", "on": "m"}, {"do": "drag", "to": [1.0, to], "frames": frames}, {"do": "release"}]
    return rows_of(make_replay(scene, write_script(folder, events)))


@pytest.mark.parametrize("to", [0.6, 1.3])
def test_a_corner_that_an_edit_makes_is_singular_where_it_is_reentrant(tmp_path, to):
    rows = moved(tmp_path, 1.0, to)
    errors = [row["tip_error"] for row in rows]
    assert all(math.isfinite(error) for error in errors[:2]) and rows[0]["constraint_status"] == HOLDS
    if to < 1.0:
        assert errors[2:] == [math.inf] * 4 and {row["constraint_status"] for row in rows[2:]} == {UNCERTAIN}
        assert "tip holds, but uncertain: " in rows[2]["note"] and "at a singular place" in rows[2]["note"]
        assert f"tip {AT}" in rows[2]["note"] and not any(AT in row["note"] for row in rows[3:])
    else:
        assert np.isfinite(errors).all() and not any(AT in row["note"] for row in rows)


def test_a_corner_that_an_edit_makes_convex_is_singular_no_more(tmp_path):
    rows = moved(tmp_path, 0.6, 1.3, frames=1)
    assert rows[0]["tip_error"] == math.inf and rows[0]["constraint_status"] == UNCERTAIN
    assert f"tip {NO_MORE}" in rows[2]["note"] and math.isfinite(rows[2]["tip_error"])
    assert {row["constraint_status"] for row in rows[2:]} == {HOLDS}


def test_a_square_hole_that_an_edit_cuts_is_singular(tmp_path, command):
    text = STRIP.replace("TOP", "1.0").replace('at = "m", max', "max")
    scene = write_scene(
        tmp_path, text.replace('fix = ["x", "y"]', 'fix = ["x"]') + '[supports.b]\non = "a"\nfix = ["y"]\n'
    )
    square = [[0.8, 0.4], [1.2, 0.4], [1.2, 0.7], [0.8, 0.7]]
    script = write_script(tmp_path, [{"do": "hole", "name": "sq", "polygon": square}])
    rows = rows_of(make_replay(scene, script))
    assert f"tip {AT}" in rows[1]["note"] and rows[1]["tip_error"] == math.inf
    done = command("replay", scene, script)
    assert "tip is taken at a singular place (r^-0.456" in done.stdout, done.stdout


SIDEWAYS = STRIP.replace("TOP", "1.0").replace('at = "m", max', 'at = "left", max').replace('"1 GPa"', '"2 MPa"')


@pytest.mark.parametrize(
    ("key", "value", "back"),
    [("supports.wall.fix", ["x", "y"], ["x"]), ("material.steel.nu", 0.3, 0.0)],
)
def test_a_support_or_a_material_that_is_set_makes_corners_singular_as_in_a_replay_of_its_own(
    tmp_path, key, value, back
):
    """A clamped corner of 90 degrees is singular where the material contracts sideways, and not where it slides."""
    given = {"supports.wall.fix": ["x", "y"], "material.steel.nu": 0.3} | {key: back}
    text = SIDEWAYS.replace('fix = ["x", "y"]', f"fix = {given['supports.wall.fix']}")
    text += '[supports.pin]\non = "d"\nfix = ["y"]\n'
    scene = write_scene(tmp_path, text.replace("nu = 0.3", f"nu = {given['material.steel.nu']}"))
    (tmp_path / "own").mkdir()
    own = write_scene(tmp_path / "own", scene.read_text().replace(f"fix = {back}", f"fix = {value}"))
    own.write_text(own.read_text().replace(f"nu = {back}", f"nu = {value}"))
    events = [{"do": "set", "key": key, "value": value}, {"do": "set", "key": key, "value": back}, {"do": "undo"}]
    rows = rows_of(make_replay(scene, write_script(tmp_path, events)))
    (wanted,) = rows_of(make_replay(own, write_script(tmp_path / "own", [])))
    assert wanted["tip_error"] == math.inf and wanted["singular_places"]
    columns = ("constraint_status", "singular_places")
    for row in (rows[1], rows[3]):
        assert [row[name] for name in columns] == [wanted[name] for name in columns]
        assert row["tip_error"] == math.inf and f"tip {AT}" in row["note"]
    for row in (rows[0], rows[2]):
        assert math.isfinite(row["tip_error"]) and not row["singular_places"]
    assert f"tip {NO_MORE}" in rows[2]["note"]


def test_a_value_that_is_set_beside_them_takes_no_time(tmp_path, monkeypatch):
    from restshape.replay import singular_quantities

    seen = []
    found = singular_quantities.SingularQuantities._found
    monkeypatch.setattr(
        singular_quantities.SingularQuantities, "_found", lambda self, *of: seen.append(of) or found(self, *of)
    )
    text = STRIP.replace("TOP", "1.0").replace('"1 GPa"', '"most"') + '[parameters]\nmost = "1 GPa"\n'
    events = [{"do": "set", "key": "parameters.most", "value": f"{k} MPa"} for k in (900, 800)]
    rows = rows_of(make_replay(write_scene(tmp_path, text), write_script(tmp_path, events)))
    assert len(rows) == 3 and rows[2]["tip_max"] == 800e6 and len(seen) == 1


@pytest.fixture
def looked_at(monkeypatch):
    """The outlines whose places were looked for."""
    from restshape.replay import singular_quantities

    seen, found = [], singular_quantities.SingularQuantities._found
    monkeypatch.setattr(
        singular_quantities.SingularQuantities,
        "_found",
        lambda self, scene, outline: seen.append(outline) or found(self, scene, outline),
    )
    return seen


def test_frames_within_a_drag_take_no_time_for_it(tmp_path, looked_at):
    """Exponents of new angles take as long as some frames."""
    rows = moved(tmp_path, 1.0, 0.95, frames=8)
    # The first shape, the first one that moved, and the last one.
    assert len(looked_at) == 3 + sum(row["level"] > 2 for row in rows[3:-1]) and rows[-1]["constraint_status"] != FAILS


def test_frames_with_flips_take_no_time_for_it(tmp_path, looked_at):
    script = write_script(
        tmp_path, drag("window", (0.5, 0.5), [(0.5 + 0.03 * k, 0.5 + 0.01 * k) for k in range(1, 24)])
    )
    levels = [row["level"] for row in rows_of(make_replay(write_scene(tmp_path, plate(0.1)), script))]
    assert levels.count(2) > 2 and len(looked_at) == 3 + levels[3:-1].count(3)
