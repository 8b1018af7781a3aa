"""Effects switch with the state of the body, frame by frame: what a frame does not need, it does not compute."""

import pytest
from counted_replays import begin_log, happened, kernels, watched
from small_scenes import (
    CLAMPED,
    HEAD,
    HOLE,
    PULLED,
    STEEL,
    across,
    block,
    drag,
    head,
    meshed,
    write_scene,
    write_script,
)

BODY = block(2.0, 1.0) + HOLE + STEEL + CLAMPED
PLATE = HEAD + BODY + PULLED + meshed(0.12)
STRETCH = '[quantities]\nstretch = { displacement = "x", at = "right" }\n'
PEAK = 'peak = { stress = "von_mises" }\n'
MOVING = head("moving") + '[effects.dynamics]\ntime_step = "1 ms"\nsteps = 3\n'
SHORT = [*drag("window", (0.5, 0.5), across((0.5, 0.5), (0.56, 0.5), 6)), {"do": "idle", "frames": 2}]
LONG = drag("window", (0.5, 0.5), across((0.5, 0.5), (1.4, 0.5), 40))
SYMBOLIC = ("MatCholFctrSym", "MatICCFactorSym", "MatILUFactorSym", "MatLUFactorSym")
NUMERIC = ("MatCholFctrNum", "MatICCFactorSym", "MatLUFactorNum")


@pytest.fixture(scope="module", autouse=True)
def _logged():
    begin_log()


def rows_of(folder, text, events=SHORT, **given):
    """The rows of a script's replay."""
    rows, _ = watched(write_scene(folder, text), write_script(folder, events), **given)
    assert not any(row["refused"] for row in rows)
    return rows


def test_frames_in_which_nothing_moves_call_no_kernel_and_no_solver(tmp_path):
    rows = rows_of(tmp_path, PLATE + STRETCH + PEAK)
    still = [row for row in rows[1:] if row["event"] != "drag"]
    assert {row["event"] for row in still} == {"press", "release", "idle"}
    for row in still:
        assert row["calls"] == {} and not any(row["events"].values())
    assert all(row["calls"] and row["events"]["PCApply"] >= 1 for row in rows if row["event"] == "drag")


def test_a_linear_motion_goes_on_without_kernels_while_the_shape_rests(tmp_path):
    rows = rows_of(tmp_path, MOVING + BODY + PULLED + meshed(0.2) + STRETCH)
    idle = [row for row in rows if row["event"] == "idle"]
    assert idle and all(row["events"]["PCApply"] >= 3 for row in idle)
    for row in idle:
        assert (
            row["calls"] == {} and not row["events"]["RestshapeValues"] and not any(row["events"][n] for n in NUMERIC)
        )


def test_stresses_are_recovered_once_a_frame_and_only_where_a_quantity_is_one(tmp_path):
    rows = rows_of(tmp_path, PLATE + STRETCH)
    assert "recover" not in kernels(rows) and not kernels(rows, "stress")
    peak, wall = PEAK, 'wall = { stress = "xx", at = "left" }\n'
    for row in rows_of(tmp_path, PLATE + STRETCH + peak + wall):
        moved = row["event"] in ("start", "drag")
        assert row["calls"].get("recover", {}) == ({"field": (1, row["elements"])} if moved else {})


def test_stresses_and_energies_of_triangles_come_of_one_loop(tmp_path):
    energy = 'energy = { energy = "strain" }\n'
    for row in rows_of(tmp_path, PLATE + STRETCH + PEAK + energy):
        moved = row["event"] in ("start", "drag")
        calls = row["calls"].get("linear_elastic_tri3", {})
        assert "energy" not in calls and calls.get("stress") == ((1, row["elements"]) if moved else None)


def test_flips_only_patch(tmp_path):
    rows = rows_of(tmp_path, PLATE + STRETCH, LONG)
    flipped = [row for row in rows if row["level"] == 2]
    relocated = [row for row in rows if row["level"] == 1]
    assert flipped and relocated
    for row in flipped:
        assert row["events"]["RestshapePattern"] == 0 and row["events"]["RestshapePatch"] == 1
    for row in relocated:
        assert row["events"]["RestshapePattern"] == row["events"]["RestshapePatch"] == 0
        assert not any(row["events"][name] for name in SYMBOLIC) or row["pc_rebuilt"]


def test_ground_costs_only_where_it_shakes(tmp_path):
    text = MOVING + BODY + PULLED + meshed(0.2)
    ground = '[effects.ground]\nfrequency = 5\nacceleration = "{} m/s^2"\n'
    still, none, shaken = (
        rows_of(tmp_path, text + more + STRETCH) for more in (ground.format(0), "", ground.format(1))
    )
    assert [row["calls"] for row in still] == [row["calls"] for row in none]

    def applied(row):
        return row["calls"].get("mass_tri3", {}).get("residual", (0, 0))[0]

    assert not any(map(applied, none))
    # Once a matrix; the first frame takes no step, so that nothing shakes yet.
    assert [applied(row) for row in shaken] == [0] + [
        int(row["event"] == "drag" or row["index"] == 1) for row in shaken[1:]
    ]


def test_pressures_follow_only_under_large_deformation(tmp_path):
    pressed = HEAD + BODY + '[loads.push]\non = "right"\npressure = "1 MPa"\n' + meshed(0.2) + STRETCH
    small = rows_of(tmp_path, pressed)
    assert "pressure_edge2" not in kernels(small) and "traction_edge2" in kernels(small)
    assert happened(small, "MatLUFactorNum") == 0
    large = rows_of(tmp_path, pressed, overrides=["effects.large_deformation={}"])
    assert "traction_edge2" not in kernels(large) and "pressure_edge2" in kernels(large)
    assert happened(large, "MatLUFactorNum") > 0 == happened(large, "MatCholFctrNum")


def test_stability_is_looked_at_only_where_it_is_due(tmp_path):
    text = PLATE + "[effects.large_deformation]\n" + STRETCH
    rows = rows_of(tmp_path, text)
    factored = {row["index"]: sum(row["events"][name] for name in NUMERIC) for row in rows}
    dragged = [row for row in rows if row["event"] == "drag"]
    # A small step from a stable equilibrium is believed; the hand's release is where the tangent is factored again.
    assert sum(not factored[row["index"]] for row in dragged) >= len(dragged) - 1
    (release,) = (row for row in rows if row["event"] == "release")
    assert factored[release["index"]] == 1
    idle = [row for row in rows if row["event"] == "idle"]
    assert idle and not any(factored[row["index"]] or row["calls"] for row in idle)


def test_derivatives_are_taken_only_where_frames_are_predicted(tmp_path):
    plain = rows_of(tmp_path, PLATE + STRETCH)
    assert not kernels(plain, "design")
    predicted = rows_of(tmp_path, PLATE + STRETCH, predict="linear")
    assert [row["index"] for row in predicted if any("design" in calls for calls in row["calls"].values())] == [1]
    shown = [row for row in predicted if row["predicted"] and row["event"] == "drag"]
    assert shown and not any("tangent" in calls for row in shown for calls in row["calls"].values())
    assert not any(row["events"]["KSPSolve"] for row in shown)
