"""Hard cases of linear solids at rest: jumps, thin parts, stiff and soft, nearly incompressible, no refresh."""

from dataclasses import replace

import numpy as np
import pytest
from small_scenes import (
    CLAMPED,
    HEAD,
    PULLED,
    across,
    block,
    drag,
    make_replay,
    meshed,
    plate,
    rows_of,
    write_scene,
    write_script,
)

from restshape.calibration import Calibration
from restshape.policy import POLICIES
from restshape.replay.parity import Parity

STRETCH = '[quantities]\nstretch = { displacement = "x", at = "right", take = "mean" }\n'


def checked(made):
    """The rows of a replay that agrees with cold solves."""
    check = Parity(made)
    rows = rows_of(made, lambda row: check())
    assert check.summary()["holds"], check.summary()
    return rows


@pytest.mark.parametrize("name", POLICIES)
def test_a_drag_that_jumps(tmp_path, name):
    # 0.8 m of 2 m in one frame, there and back.
    events = drag("window", (0.5, 0.5), [(1.3, 0.5), (0.5, 0.5), (1.4, 0.6)])
    rows = checked(make_replay(write_scene(tmp_path, plate(0.08)), write_script(tmp_path, events), name))
    assert not any(row["refused"] for row in rows)
    cold = write_scene(tmp_path, plate(0.08).replace("[0.5, 0.5]", "[1.3, 0.5]"), "cold.toml")
    assert rows[2]["q_stretch"] == pytest.approx(rows_of(make_replay(cold))[0]["q_stretch"], rel=5e-3)
    assert rows[3]["q_stretch"] == pytest.approx(rows[0]["q_stretch"], rel=5e-3)


def test_a_thin_ligament(tmp_path):
    # The hole stops 2 mm from the edge, in a mesh of 80 mm.
    path = [*across((0.5, 0.5), (0.5, 0.8), 10), (0.5, 0.84), (0.5, 0.848)]
    events = drag("window", (0.5, 0.5), path)
    rows = checked(make_replay(write_scene(tmp_path, plate(0.08)), write_script(tmp_path, events)))
    assert not any(row["refused"] for row in rows)
    assert all(np.isfinite(row["q_energy"]) and row["residual"] < 2e-6 for row in rows)
    assert all(row["q_wall"] == pytest.approx(-1e6, rel=1e-4) for row in rows)
    # A body that is cut more gives way more.
    assert rows[-2]["q_energy"] > rows[0]["q_energy"]


def test_touching_the_edge_is_refused(tmp_path):
    events = drag("window", (0.5, 0.5), [(0.5, 0.8), (0.5, 0.86), (0.5, 0.7)])
    rows = checked(make_replay(write_scene(tmp_path, plate()), write_script(tmp_path, events)))
    assert [bool(row["refused"]) for row in rows] == [False, False, False, True, False, False]


def material(**values):
    """A material and plane stress."""
    keys = {"E": 2e11, "nu": 0.3, "thickness": 0.01, "model": "plane_stress"} | values
    model = keys.pop("model")
    lines = "".join(f"{key} = {value}\n" for key, value in keys.items())
    return f'[material.m]\n{lines}[effects.solid]\nmodel = "{model}"\n'


@pytest.mark.parametrize("name", ["auto", "thesis"])
def test_a_slender_beam(tmp_path, name):
    # 1:200 under its end load: Euler and Bernoulli's P L^3 / (3 E I); linear triangles are too stiff, not too soft.
    L, H, E, P, t = 2.0, 0.01, 2e11, 1.0, 0.01
    load = f'[loads.end]\non = "right"\nforce = [0, {-P}]\n'
    asked = '[quantities]\ntip = { displacement = "y", at = "right", take = "mean" }\n'
    text = HEAD + block(L, H) + material(E=E, nu=0) + CLAMPED + load + meshed(0.0025) + asked
    events = drag("right", (L, 0.0), [(L + 0.001, 0.0), (L + 0.002, 0.0)])
    rows = checked(make_replay(write_scene(tmp_path, text), write_script(tmp_path, events), name))
    for row, length in ((rows[0], L), (rows[-1], L + 0.002)):
        exact = -P * length**3 / (3 * E * t * H**3 / 12)
        assert 0.7 < row["q_tip"] / exact < 1.0
    assert abs(rows[-1]["q_tip"]) > abs(rows[0]["q_tip"])


def test_nearly_incompressible_of_first_order(tmp_path):
    # Linear triangles lock towards nu = 1/2: finite, too stiff, and the solver copes.
    mesh = meshed(0.1) + "order = 1\n"
    text = HEAD + block(2.0, 1.0) + material(nu=0.499, model="plane_strain") + CLAMPED + PULLED + mesh + STRETCH
    events = drag("right", (2.0, 0.5), across((2.0, 0.5), (2.2, 0.5), 8))
    locked = checked(make_replay(write_scene(tmp_path, text), write_script(tmp_path, events)))
    free = PULLED.replace("100 MPa", "1 Pa") and 1e8 * (1 - 0.499**2) / 2e11 * 2.0
    assert 0.5 * free < locked[0]["q_stretch"] < free
    assert locked[-1]["q_stretch"] == pytest.approx(1.1 * locked[0]["q_stretch"], rel=0.05)


@pytest.mark.parametrize("law", ["", "[effects.large_deformation]\n"])
@pytest.mark.parametrize("name", POLICIES)
def test_nearly_incompressible_under_a_drag(tmp_path, name, law):
    # The plan takes the mean dilatation on second-order triangles, which do not lock.
    solid = material(nu=0.4999, model="plane_strain") + law
    text = HEAD + block(2.0, 1.0) + solid + CLAMPED + PULLED + meshed(0.2) + STRETCH
    events = drag("right", (2.0, 0.5), across((2.0, 0.5), (2.2, 0.5), 8))
    made = make_replay(write_scene(tmp_path, text), write_script(tmp_path, events), name)
    rows = checked(made)
    assert made.analysis.physics.element.name.endswith("dilatation_tri6")
    assert not any(row["refused"] for row in rows)
    # A long strip of no contraction at its ends stretches by (1 - nu^2) / E, a clamped end takes little of it.
    free = 1e8 * (1 - 0.4999**2) / 2e11 * 2.0
    assert 0.85 * free < rows[0]["q_stretch"] < free
    assert rows[-1]["q_stretch"] / rows[0]["q_stretch"] == pytest.approx(1.1, rel=0.02)


def test_a_body_that_becomes_incompressible_and_back(tmp_path):
    # The plan takes another element and a mesh of another order; displacements are carried over as a guess.
    text = HEAD + block(2.0, 1.0) + material(nu=0.3, model="plane_strain") + CLAMPED + PULLED + meshed(0.2) + STRETCH
    values = [{"do": "set", "key": "material.m.nu", "value": nu} for nu in (0.4999, 0.3)]
    events = [{"t": 0.1 * (k + 1), **event} for k, event in enumerate(values)]
    made = make_replay(write_scene(tmp_path, text), write_script(tmp_path, events))
    rows = checked(made)
    assert [row["unknowns"] > 2 * rows[0]["unknowns"] for row in rows] == [False, True, False]
    assert rows[2]["q_stretch"] == pytest.approx(rows[0]["q_stretch"], rel=1e-9)
    assert rows[1]["q_stretch"] == pytest.approx(1e8 * (1 - 0.4999**2) / 2e11 * 2.0, rel=0.15)


@pytest.mark.parametrize("name", ["auto", "thesis"])
def test_contrast_of_a_million(tmp_path, name):
    inside = "[shape.regions]\nsoft = { polygon = [[0.8, 0.3], [1.2, 0.3], [1.2, 0.7], [0.8, 0.7]] }\n"
    soft = '[material.foam]\nE = 2e5\nnu = 0.3\nthickness = 0.01\nregion = ["soft"]\n'
    text = HEAD + block(2.0, 1.0) + inside + soft + material() + CLAMPED + PULLED + meshed(0.1) + STRETCH
    events = drag("soft", (1.0, 0.5), across((1.0, 0.5), (1.2, 0.5), 6))
    rows = checked(make_replay(write_scene(tmp_path, text), write_script(tmp_path, events), name))
    hollow = text.replace("[shape.regions]\nsoft", "[shape.holes]\nsoft").replace(soft, "")
    hole = rows_of(make_replay(write_scene(tmp_path, hollow, "hollow.toml")))
    # As good as a hole; the meshes are not the same.
    assert rows[0]["q_stretch"] == pytest.approx(hole[0]["q_stretch"], rel=1e-2)


def test_a_thousand_frames_without_a_refresh(tmp_path):
    never = replace(Calibration.load(), numeric_nonzero=1.0, ilu_numeric_nonzero=1.0, gamg_refresh_nonzero=1.0)
    path = [(0.5 + 0.25 * np.sin(2 * np.pi * k / 200), 0.5 + 0.1 * np.sin(2 * np.pi * k / 160)) for k in range(1, 1001)]
    scene, script = write_scene(tmp_path, plate()), write_script(tmp_path, drag("window", (0.5, 0.5), path))
    rows = rows_of(make_replay(scene, script, overrides=["mesh.min_quality=0.01"], calibration=never))
    assert not any(row["refused"] for row in rows)
    assert all(row["level"] == 3 for row in rows if row["refreshed"])
    assert max(row["age"] for row in rows) > 300
    assert max(row["residual"] for row in rows) < 1.001e-6
    # The hole is back where it was after 800 frames.
    assert rows[2 + 799]["q_stretch"] == pytest.approx(rows[0]["q_stretch"], rel=2e-3)


@pytest.mark.parametrize("name", POLICIES)
def test_nothing_is_free_but_supports_move(tmp_path, name):
    # The whole outline is displaced linearly and nothing loads the body.
    held = '[supports.round]\non = ["outline", "window"]\nfix = { x = "0.001*x", y = "-0.002*y" }\n'
    text = plate().replace(CLAMPED, held).replace(PULLED, "")
    events = drag("window", (0.5, 0.5), across((0.5, 0.5), (0.6, 0.5), 5))
    made = make_replay(write_scene(tmp_path, text), write_script(tmp_path, events), name, ["solve.tolerance=1e-10"])
    for row in made.frames():
        X = made.analysis.mesh.X
        np.testing.assert_allclose(made.analysis.x, X * [0.001, -0.002], atol=1e-11)
        assert not row["refused"]


@pytest.mark.parametrize("name", POLICIES)
def test_no_load_at_all(tmp_path, name):
    events = drag("window", (0.5, 0.5), [(0.52, 0.5)])
    made = make_replay(write_scene(tmp_path, plate().replace(PULLED, "")), write_script(tmp_path, events), name)
    for row in checked(made):
        assert row["q_energy"] == 0.0 and row["iterations"] <= 1 and not row["refused"]
