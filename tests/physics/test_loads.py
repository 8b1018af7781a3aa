"""Loads and their reactions: totals that statics alone gives."""

from pathlib import Path

import numpy as np
import pytest
from small_scenes import CLAMPED, HEAD, HOLE, STEEL, block, make_replay, meshed, rows_of, write_scene

from restshape.fem.assembled import Assembled
from restshape.fem.problem import INTERNAL
from restshape.interface.first_frame import first_frame
from restshape.interface.replays import replay_files

WIDTH, HEIGHT, THICKNESS, RHO = 1.0, 1.0, 0.01, 8000.0
BODY = HEAD + block() + STEEL + CLAMPED + meshed(0.13)
REACTIONS = """
[quantities]
x = { reaction = "x", at = "left" }
y = { reaction = "y", at = "left" }
area = { area = true }
"""


def row_of(folder, text):
    """The row of the only frame of a scene."""
    return rows_of(make_replay(write_scene(folder, text)))[0]


def reactions(folder, text):
    """The forces (2,) [N] of the wall on the body."""
    row = row_of(folder, BODY + text + REACTIONS)
    return np.array([row["q_x"], row["q_y"]])


def test_the_wall_carries_the_weight(tmp_path):
    weight = RHO * WIDTH * HEIGHT * THICKNESS * 9.81
    np.testing.assert_allclose(reactions(tmp_path, "[effects.gravity]\n"), [0, weight], atol=1e-6 * weight)


def test_weight_with_a_hole(tmp_path):
    row = row_of(
        tmp_path, HEAD + block() + HOLE + STEEL + CLAMPED + "[effects.gravity]\ng = [2, 0]\n" + meshed(0.05) + REACTIONS
    )
    assert row["q_x"] == pytest.approx(-2 * RHO * THICKNESS * row["mesh_area"], rel=1e-6)
    assert row["q_area"] == pytest.approx(1 - np.pi * 0.15**2, rel=1e-12)
    assert row["mesh_area"] == pytest.approx(1 - np.pi * 0.15**2, rel=5e-3)


def test_force_on_an_edge_is_its_total(tmp_path):
    np.testing.assert_allclose(
        reactions(tmp_path, '[loads.f]\non = "top"\nforce = [300, -700]\n'), [-300, 700], rtol=1e-5
    )


def test_a_force_that_varies_is_that_at_the_middle_of_its_edge(tmp_path):
    # The mesh is finer at one end, where most facets lie.
    text = BODY.replace("size = 0.13", "size = 0.13\nnear = { c = 0.01 }")
    row = row_of(tmp_path, text + '[loads.f]\non = "top"\nforce = ["1000*x", 0]\n' + REACTIONS)
    assert row["q_x"] == pytest.approx(-1000 * WIDTH / 2, rel=1e-5)


def test_force_on_a_point(tmp_path):
    np.testing.assert_allclose(
        reactions(tmp_path, '[loads.f]\non = "c"\nforce = [300, -700]\n'), [-300, 700], rtol=1e-5
    )


def test_force_on_two_points_is_their_total(tmp_path):
    load = '[loads.f]\non = ["b", "c"]\nforce = [300, -700]\n'
    np.testing.assert_allclose(reactions(tmp_path, load), [-300, 700], rtol=1e-5)


def test_force_on_a_point_that_is_held(tmp_path):
    np.testing.assert_allclose(
        reactions(tmp_path, '[loads.f]\non = "d"\nforce = [300, -700]\n'), [-300, 700], rtol=1e-5
    )


def test_traction_acts_on_length_times_thickness(tmp_path):
    found = reactions(tmp_path, '[loads.f]\non = "top"\ntraction = [0, "1 MPa"]\n')
    np.testing.assert_allclose(found, [0, -1e6 * WIDTH * THICKNESS], atol=1e-1)


def test_traction_that_varies(tmp_path):
    found = reactions(tmp_path, '[loads.f]\non = "top"\ntraction = [0, "x*1e6"]\n')
    np.testing.assert_allclose(found, [0, -0.5e6 * THICKNESS], atol=1e-1)


def test_pressure_pushes_against_the_outward_normal(tmp_path):
    found = reactions(tmp_path, '[loads.f]\non = "top"\npressure = "1 MPa"\n')
    np.testing.assert_allclose(found, [0, 1e6 * WIDTH * THICKNESS], atol=1e-1)


@pytest.mark.parametrize("place", ["window", "outline"])
def test_pressure_all_round_has_no_resultant(tmp_path, place):
    load = f'[loads.f]\non = "{place}"\npressure = "1 MPa"\n'
    row = row_of(tmp_path, HEAD + block() + HOLE + STEEL + CLAMPED + load + meshed(0.1) + REACTIONS)
    np.testing.assert_allclose([row["q_x"], row["q_y"]], 0.0, atol=1e-5 * 1e6 * THICKNESS)


def test_body_force_on_a_region(tmp_path):
    region = "[shape.regions]\nheavy = { polygon = [[0.4, 0.3], [0.8, 0.3], [0.8, 0.7], [0.4, 0.7]] }\n"
    load = '[loads.f]\non = "heavy"\nbody = [0, -5e4]\n'
    row = row_of(tmp_path, HEAD + block() + region + STEEL + CLAMPED + load + meshed(0.13) + REACTIONS)
    np.testing.assert_allclose([row["q_x"], row["q_y"]], [0, 5e4 * 0.16 * THICKNESS], atol=1e-4)


def test_two_loads_add_up(tmp_path):
    loads = '[loads.f]\non = "top"\nforce = [1, 2]\n[loads.g]\non = "right"\nforce = [10, 20]\n[effects.gravity]\n'
    weight = RHO * WIDTH * HEIGHT * THICKNESS * 9.81
    np.testing.assert_allclose(reactions(tmp_path, loads), [-11, weight - 22], atol=1e-6 * weight)


def test_area_and_energy_of_a_region(tmp_path):
    region = "[shape.regions]\nheavy = { polygon = [[0.4, 0.3], [0.8, 0.3], [0.8, 0.7], [0.4, 0.7]] }\n"
    stretched = '[supports.round]\non = "outline"\nfix = { x = "x*1e-3", y = 0 }\n'
    material = '[material.m]\nE = 1e9\nnu = 0\nthickness = 0.01\n[effects.solid]\nmodel = "plane_stress"\n'
    asked = '[quantities]\narea = { area = true, at = "heavy" }\nenergy = { energy = "strain", at = "heavy" }\n'
    row = row_of(tmp_path, HEAD + block() + region + material + stretched + meshed(0.13) + asked)
    assert row["q_area"] == pytest.approx(0.16, rel=1e-12)
    assert row["q_energy"] == pytest.approx(0.5 * 1e9 * 1e-6 * 0.16 * 0.01, rel=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("policy", ["auto", "refactor", "thesis"])
def test_supports_that_only_carry_the_body_elsewhere_leave_it_unstrained(policy):
    scene = Path(__file__).parents[1] / "scenes" / "plate.toml"
    moved = ["supports.wall.fix={x=1,y=0}", "loads.pull.traction=[0,0]", "mesh.size=0.15"]
    run = replay_files(scene, scene.with_name("plate.jsonl"), policy, moved)
    assert run["refused"] == 0
    assert max(row["residual"] for row in run["rows"]) <= 1e-6
    assert max(abs(value - 1.0) for value in run["quantities"]["stretch"]) < 1e-9
    # Rounding of a displacement of 1 m, and nothing else, strains the steel.
    assert max(run["quantities"]["peak_stress"]) < 210e9 * 1e-9


def test_integrals_are_made_once_and_again_where_their_values_follow_the_nodes(tmp_path):
    """A load inside of x: on a body of twice the width and the same density of it there is four times as much."""
    scenes = {
        name: f'[loads.f]\non = "all"\nbody = [{value}, 0]\n' for name, value in (("same", 5e4), ("x", '"1e4*x"'))
    }
    for name, load in scenes.items():
        problem = first_frame(write_scene(tmp_path, BODY + load, f"{name}.toml")).analysis.problem
        made, X = problem.integrals(INTERNAL), problem.space.X
        assert problem.integrals(INTERNAL) is made
        X[:, 0] *= 2.0
        problem.update()
        assert (problem.integrals(INTERNAL) is made) == (name == "same")
        total = Assembled(problem.integrals(INTERNAL)).residual(np.zeros_like(X))[:, 0].sum()
        expected = 2.0 * 5e4 if name == "same" else 4.0 * 1e4 / 2
        assert -total / THICKNESS == pytest.approx(expected, rel=1e-9)
