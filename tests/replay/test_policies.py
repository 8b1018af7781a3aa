"""Policies: what each keeps, and that none of them changes the answer."""

import numpy as np
import pytest
from small_scenes import across, drag, make_replay, plate, rows_of, write_scene, write_script

from restshape.errors import UserError
from restshape.policy import POLICIES, policy

EVENTS = drag("window", (0.5, 0.5), across((0.5, 0.5), (0.7, 0.5), 16))
TIGHT = ["solve.tolerance=1e-10"]


@pytest.fixture(scope="module")
def rows(tmp_path_factory):
    """The rows of the same drag under each policy."""
    folder = tmp_path_factory.mktemp("policies")
    scene, script = write_scene(folder, plate(0.06)), write_script(folder, EVENTS)
    return {name: rows_of(make_replay(scene, script, name, TIGHT)) for name in POLICIES}


def moving(rows):
    """The rows of frames in which the shape moves."""
    return [row for row in rows if row["event"] == "drag"]


@pytest.mark.slow
def test_rebuild_makes_a_new_mesh_in_each_frame(rows):
    assert {row["level"] for row in moving(rows["rebuild"])} == {3}


def test_refactor_makes_a_new_factor_in_each_frame(rows):
    found = moving(rows["refactor"])
    assert all(row["pc_rebuilt"] and row["pc_age"] == 0 for row in found)
    assert {row["level"] for row in found} <= {1, 2, 3} and found[0]["level"] == 1


def test_thesis_factors_with_new_meshes_only(rows):
    assert all(row["pc_rebuilt"] == (row["level"] == 3) for row in moving(rows["thesis"]))


def test_auto_keeps_factors_and_iterates_less(rows):
    auto, thesis = moving(rows["auto"]), moving(rows["thesis"])
    assert sum(row["pc_rebuilt"] for row in auto) <= len(auto) / 2
    assert sum(row["iterations"] for row in auto) < sum(row["iterations"] for row in thesis) / 3


def test_age_counts_the_frames_since_the_factor(rows):
    for found in rows.values():
        age = 0
        for row in found:
            age = 0 if row["pc_rebuilt"] else age + 1
            assert row["pc_age"] == age


def test_same_mesh_same_answer(rows):
    # Relocation decides in both alike; only the algebra differs.
    for a, b in zip(rows["auto"], rows["refactor"], strict=True):
        for name in ("q_stretch", "q_peak", "q_wall", "q_energy"):
            assert a[name] == pytest.approx(b[name], rel=1e-7)


def test_other_meshes_differ_by_discretisation_only(rows):
    reference = np.array([row["q_stretch"] for row in rows["rebuild"]])
    for name in ("auto", "thesis"):
        found = np.array([row["q_stretch"] for row in rows[name]])
        np.testing.assert_allclose(found, reference, rtol=5e-3)


def test_guesses_along_the_drag_save_iterations(tmp_path):
    scene, script = write_scene(tmp_path, plate(0.06)), write_script(tmp_path, EVENTS)
    spent = [
        sum(
            row["iterations"]
            for row in rows_of(make_replay(scene, script, "thesis", guess=guess, relocation="harmonic"))
        )
        for guess in ("same-mesh", "extrapolated")
    ]
    assert spent[1] < 0.95 * spent[0]


def test_transfer_to_a_new_mesh_saves_iterations(tmp_path):
    # A new mesh of the same shape: the old solution is nearly right.
    events = [{"do": "set", "key": "mesh.size", "value": size} for size in (0.06, 0.05, 0.04)]
    scene, script = write_scene(tmp_path, plate(0.07)), write_script(tmp_path, events)
    found = []
    for guess in ("same-mesh", "last"):
        rows = rows_of(make_replay(scene, script, "thesis", guess=guess))
        found.append([row["iterations"] for row in rows[1:]])
    assert all(b < 0.95 * a for a, b in zip(*found))


def test_a_policy_that_is_not_there():
    with pytest.raises(UserError, match="'fast'") as raised:
        policy("fast")
    assert all(name in str(raised.value) for name in POLICIES)
