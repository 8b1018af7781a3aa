"""What large deformation refuses, why, and that the replay goes on."""

import numpy as np
import pytest
from large import LARGE, WALL, beam, gravity, solid
from small_scenes import HEAD, across, block, drag, make_replay, meshed, rows_of, write_scene, write_script

from restshape import _kernels


def set_gravity(*values):
    return [{"do": "set", "key": "effects.gravity.g", "value": [0, -g]} for g in values]


def test_gravity_without_an_equilibrium(tmp_path):
    script = write_script(tmp_path, set_gravity(20, 200, 2000, 20000, 10))
    rows = rows_of(make_replay(write_scene(tmp_path, beam()), script))
    first, twice, *beyond, back = rows
    assert not twice["refused"] and abs(twice["q_y"]) > 1.3 * abs(first["q_y"])
    for row in beyond:
        assert row["refused"].startswith("no equilibrium found beyond") and "% of the load" in row["refused"]
        # What is shown is the last equilibrium.
        assert row["q_y"] == twice["q_y"] and row["residual"] <= 1e-6
    assert not back["refused"]
    assert back["q_y"] == pytest.approx(first["q_y"], rel=1e-5)
    assert back["q_wall_y"] == pytest.approx(1000 * 10 * 0.2, rel=1e-5)


@pytest.mark.parametrize("share", [0.9, 1.1])
def test_a_column_stands_until_it_buckles_under_its_weight(tmp_path, share):
    # Greenhill 1881: a clamped column stands while its weight is below 7.8373 E I / L^2.
    length, height, E = 1.0, 0.05, 1e6
    limit = 7.8373 * E * height**3 / 12 / length**3 / (1000 * height)
    text = beam(solid("plane_stress"), gravity(-limit, 0), length=length, height=height, size=0.05)
    text = text.replace("[mesh]", "[mesh]\norder = 2").replace("nu = 0.3", "nu = 0.0")
    script = write_script(tmp_path, [{"do": "set", "key": "effects.gravity.g", "value": [-share * limit, 0]}])
    start = [f"effects.gravity.g=[{-0.3 * limit}, 0]"]
    _, row = rows_of(make_replay(write_scene(tmp_path, text), script, overrides=start))
    assert bool(row["refused"]) == (share > 1)
    if row["refused"]:
        # It says how far it came: a little beyond the limit is where the straight column ends.
        reached = float(row["refused"].split("beyond ")[1].split(" %")[0]) / 100
        assert 0.97 < reached * share < 1.03


def test_a_drag_that_folds_the_beam_over_itself(tmp_path):
    # The lower right corner is pulled through the beam to its other side and back again.
    path = [*across((1, 0), (0.6, 0.6), 12), *across((0.6, 0.6), (1, 0), 12)]
    script = write_script(tmp_path, drag("b", (1, 0), path))
    made = make_replay(write_scene(tmp_path, beam()), script)
    rows = rows_of(made)
    refused = [row["refused"] for row in rows if row["refused"]]
    assert refused and all("cross" in why or "closer" in why for why in refused), refused
    assert not rows[-1]["refused"] and rows[-1]["residual"] <= 1e-6
    assert rows[-1]["q_y"] == pytest.approx(rows[0]["q_y"], rel=5e-2)
    # The mesh is another one by then, coarse as the first.
    assert rows[-1]["q_wall_y"] == pytest.approx(rows[0]["q_wall_y"], rel=1e-4)


def test_elements_turned_over_by_a_support(tmp_path):
    # The right side is pushed beyond the left one: every way there turns triangles inside out.
    text = HEAD + "[parameters]\npush = 0.1\n" + block() + "[material.m]\nE = 1e6\nnu = 0.3\n" + WALL + LARGE
    text += solid() + '[supports.press]\non = "right"\nfix = { x = "-push", y = 0 }\n' + meshed(0.2)
    text += '[quantities]\nwall = { reaction = "x", at = "left" }\n'
    pushes = (1.3, 0.2, 5.0, 0.1)
    script = write_script(tmp_path, [{"do": "set", "key": "parameters.push", "value": p} for p in pushes])
    made = make_replay(write_scene(tmp_path, text), script)
    rows = rows_of(made)
    assert [bool(row["refused"]) for row in rows] == [False, True, False, True, False]
    assert "no equilibrium found beyond" in rows[1]["refused"]
    assert rows[4]["q_wall"] == pytest.approx(rows[0]["q_wall"], rel=1e-4)
    analysis = made.analysis
    assert len(_kernels.turned_over_cells(analysis.mesh.X, analysis.x, analysis.mesh.cells)) == 0


@pytest.mark.parametrize("cells", ["straight", "second order"])
def test_cells_turned_over_are_found(cells):
    X = np.array([[0, 0], [1, 0], [0, 1], [0.5, 0], [0.5, 0.5], [0, 0.5]], dtype=float)
    cell = np.arange(3 if cells == "straight" else 6, dtype=np.int32)[None]
    u = np.zeros_like(X)
    assert len(_kernels.turned_over_cells(X, u, cell)) == 0
    if cells == "straight":
        u[2] = [0, -1.5]
    else:
        # The middle of a side is drawn past the opposite corner's reach: det F < 0 at a corner only.
        u[3] = [0.3, 0]
    assert list(_kernels.turned_over_cells(X, u, cell)) == [0]


@pytest.mark.parametrize("element", ["mean_dilatation", "displacement"])
def test_a_nearly_incompressible_beam_under_a_drag(tmp_path, element):
    order = 2 if element == "mean_dilatation" else 1
    text = beam(solid() + f'element = "{element}"\n', gravity(0, -10)).replace("nu = 0.3", "nu = 0.4999")
    text = text.replace("[mesh]", f"[mesh]\norder = {order}")
    script = write_script(tmp_path, drag("b", (1, 0), across((1, 0), (1.2, -0.1), 15)))
    rows = rows_of(make_replay(write_scene(tmp_path, text), script))
    assert len(rows) == 18
    for row in rows:
        assert row["refused"].startswith("no equilibrium") if row["refused"] else row["residual"] <= 1e-6
    assert not rows[-1]["refused"]
