"""What large deformation refuses, why, and that the replay goes on."""

import numpy as np
import pytest
from elastica import stretched_elastica
from large import LARGE, TIP, WALL, beam, gravity, solid
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


def test_elements_inverted_by_a_support(tmp_path):
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
    assert len(_kernels.inverted_cells(analysis.mesh.X, analysis.x, analysis.mesh.cells)) == 0


@pytest.mark.parametrize("cells", ["straight", "second order"])
def test_inverted_cells_are_found(cells):
    X = np.array([[0, 0], [1, 0], [0, 1], [0.5, 0], [0.5, 0.5], [0, 0.5]], dtype=float)
    cell = np.arange(3 if cells == "straight" else 6, dtype=np.int32)[None]
    u = np.zeros_like(X)
    assert len(_kernels.inverted_cells(X, u, cell)) == 0
    if cells == "straight":
        u[2] = [0, -1.5]
    else:
        # The middle of a side is drawn past a quarter of it: det F < 0 near one corner only.
        u[3] = [0.3, 0]
    assert list(_kernels.inverted_cells(X, u, cell)) == [0]


def incompressible_strip(folder, order, element, size, path):
    """Rows of a strip of 1:25, free to become thicker at the wall, whose end is dragged; and what rods do there."""
    height, E, nu = 0.04, 1e6, 0.4999
    # P = E I / L^2 with E / (1 - nu^2) for E, at the first length.
    bending = E / (1 - nu**2) * height**3 / 12
    text = HEAD + block(1.0, height) + f"[material.m]\nE = {E}\nnu = {nu}\n" + LARGE
    text += solid() + f'element = "{element}"\n[supports.wall]\non = "left"\nfix = ["x"]\n'
    text += f'[supports.pin]\non = "a"\nfix = ["y"]\n[loads.tip]\non = "right"\nforce = [0, {-bending!r}]\n'
    text += meshed(size) + f"order = {order}\n" + TIP.replace('at = "c"', 'at = "right", take = "mean"')
    script = write_script(folder, drag("right", (1, height / 2), path))
    rows = rows_of(make_replay(write_scene(folder, text), script))
    lengths = [1.0, 1.0, *(x for x, _ in path), path[-1][0]]
    wanted = [[length * part for part in stretched_elastica(length**2, height / length)] for length in lengths]
    assert not any(row["refused"] for row in rows) and max(row["residual"] for row in rows) <= 1e-6
    return np.array([[-row["q_y"], -row["q_x"]] for row in rows]), np.array(wanted)


def test_a_nearly_incompressible_strip_bends_like_the_elastica_under_a_drag(tmp_path):
    path, errors = across((1, 0.02), (1.04, 0.02), 2), []
    for size in (0.02, 0.01):
        found, wanted = incompressible_strip(tmp_path, 2, "mean_dilatation", size, path)
        errors.append(found / wanted - 1)
    # A pressure that is even in each triangle is too soft where it varies over the thickness, by its size squared.
    coarse, fine = errors
    assert np.all(fine > 0) and np.all(coarse > 3.5 * fine)
    np.testing.assert_array_less(fine, [[0.016, 0.033]] * len(fine))
    # Extrapolated to triangles of size 0, what is left is the shear and the foot of a strip of 1:25.
    np.testing.assert_allclose((4 * fine - coarse) / 3, 0, atol=0.011)


def test_a_nearly_incompressible_strip_of_first_order_locks(tmp_path):
    found, wanted = incompressible_strip(tmp_path, 1, "displacement", 0.02, across((1, 0.02), (1.3, 0.02), 3))
    assert np.all(found[:, 0] > 0) and np.all(found[:, 0] < 0.1 * wanted[:, 0])
