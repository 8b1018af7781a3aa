"""Hard cases of design derivatives: an old factor, a tangent that is hardly regular, a column that buckles."""

from dataclasses import replace

import numpy as np
import pytest
from small_scenes import (
    CLAMPED,
    HEAD,
    PULLED,
    STEEL,
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
from restshape.sensitivity.static import design_derivative

LARGE = "[effects.large_deformation]\n"
FOLLOWING = PULLED.replace('traction = ["100 MPa", 0]', 'pressure = "-100 MPa"')


@pytest.mark.parametrize("text", [plate(), plate() + LARGE, plate().replace(PULLED, FOLLOWING) + LARGE])
def test_with_an_old_factor_after_a_long_drag(tmp_path, text):
    # CG or GMRES on a factor that is never made anew, against a factor of the very matrix. Of large deformation the
    # factors by which every tenth frame shows that it is stable are kept.
    never = replace(Calibration.load(), numeric_nonzero=1.0, ilu_numeric_nonzero=1.0, gamg_refresh_nonzero=1.0)
    script = write_script(tmp_path, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.62, 0.5), 39))[:2])
    found = []
    for name, calibration in (("auto", never), ("refactor", None)):
        scene = write_scene(tmp_path, text)
        tight = ["solve.tolerance=1e-10", "mesh.min_quality=0.01"]
        made = make_replay(scene, script, name, tight, calibration=calibration)
        rows = rows_of(made)
        assert all(row["level"] < 2 for row in rows[1:])
        found.append((rows, design_derivative(made.analysis, made.moving.field_motion, 1e-10)))
    (rows, stale), (_, fresh) = found
    refreshed = [row["index"] for row in rows if row["refreshed"]]
    assert (rows[-1]["age"], len(refreshed)) == ((9, 4) if LARGE in text else (40, 1))
    np.testing.assert_allclose(stale, fresh, atol=1e-6 * np.abs(fresh).max())


def floating(contrast):
    """A hard block that weighs, in a body that is softer by that factor."""
    stiff = "[shape.regions]\nhard = { polygon = [[0.5, 0.2], [1.8, 0.2], [1.8, 0.8], [0.5, 0.8]] }\n"
    hard = '[material.hard]\nE = 2e11\nnu = 0.3\nthickness = 0.01\nregion = ["hard"]\n'
    weight = '[loads.w]\non = "hard"\nbody = [0, -1]\n'
    soft = STEEL.replace("200e9", str(2e11 * contrast))
    return HEAD + block(2.0, 1.0) + soft + stiff + hard + CLAMPED + weight + meshed(0.12)


def test_a_tangent_that_is_nearly_singular_says_so(tmp_path):
    script = write_script(tmp_path, drag("right", (2.0, 0.5), [(2.01, 0.5)]))
    rows = rows_of(make_replay(write_scene(tmp_path, floating(1e-13)), script, predict="linear"))
    assert "nearly singular" in rows[1]["note"] and not any(row["predicted"] for row in rows)
    rows = rows_of(make_replay(write_scene(tmp_path, floating(1e-6)), script, predict="linear"))
    assert [row["predicted"] for row in rows] == [0, 0, 1, 0] and not any(row["note"] for row in rows)


@pytest.mark.parametrize("share", [0.9, 1.0])
def test_a_column_at_its_buckling_load(tmp_path, share):
    # Euler's load of a clamped column; its length grows by a tenth, which takes a fifth of the load it can bear.
    E, b, h, L = 1e6, 0.05, 0.1, 1.0
    euler = np.pi**2 * E * b * h**3 / 12 / (4 * L**2)
    text = (
        HEAD
        + block(h, L)
        + f'[material.r]\nE = {E}\nnu = 0\nthickness = {b}\n[effects.solid]\nmodel = "plane_stress"\n'
        + LARGE
        + '[supports.foot]\non = "bottom"\nfix = ["x", "y"]\n'
        + f'[loads.w]\non = "top"\nforce = [{0.001 * euler}, {-share * euler}]\n'
        + '[quantities]\ntip = { displacement = "x", at = "top", take = "mean" }\n'
        + meshed(0.04)
        + "order = 2\n"
    )
    scene, script = (
        write_scene(tmp_path, text),
        write_script(tmp_path, drag("top", (0, 1), across((0, 1), (0, 1.1), 5))),
    )
    foretold, solved = (rows_of(make_replay(scene, script, predict=predict)) for predict in ("linear", "none"))
    assert not any(row["refused"] for row in (*foretold, *solved))
    # To first order the tip goes anywhere; what is left over says so, and the release finds the equilibrium.
    assert foretold[6]["predicted"] and foretold[6]["residual"] > 0.1
    assert abs(foretold[6]["q_tip"] / solved[6]["q_tip"] - 1) > 0.5
    assert foretold[-1]["q_tip"] == pytest.approx(solved[-1]["q_tip"], rel=1e-3)
    assert foretold[-1]["residual"] < 1e-6


def test_a_prediction_that_cannot_be_solved_on_release(tmp_path):
    # A guided column under its weight: St. Venant and Kirchhoff's law bears 0.19 E, at L = 0.19 E / (rho g).
    text = (
        HEAD
        + block(1.0, 0.2)
        + '[material.r]\nE = 3e4\nnu = 0\nrho = 1000\nthickness = 0.05\n[effects.solid]\nmodel = "plane_stress"\n'
        + LARGE
        + '[effects.gravity]\ng = [-4, 0]\n[supports.wall]\non = "left"\nfix = ["x", "y"]\n'
        + '[supports.guide]\non = ["top", "bottom"]\nfix = ["y"]\n'
        + '[quantities]\ntip = { displacement = "x", at = "right", take = "mean" }\n'
        + meshed(0.1)
    )
    events = [
        *drag("right", (1.0, 0.1), across((1.0, 0.1), (2.0, 0.1), 5)),
        {"do": "idle"},
        {"do": "undo"},
        *drag("right", (1.0, 0.1), [(1.01, 0.1)]),
    ]
    made = make_replay(write_scene(tmp_path, text), write_script(tmp_path, events), predict="linear")
    rows = rows_of(made)
    assert [row["predicted"] for row in rows] == [0, 0, 1, 1, 1, 1, 1, 1, 1, 0, 0, 1, 0]
    # Refused, still shown as foretold, and asked for again in the pause.
    assert ["no equilibrium" in row["refused"] for row in rows] == [False] * 7 + [True] * 2 + [False] * 4
    assert rows[7]["q_tip"] == rows[8]["q_tip"] == rows[6]["q_tip"]
    assert rows[9]["q_tip"] == pytest.approx(rows[0]["q_tip"], rel=1e-4)
    cold = rows_of(make_replay(write_scene(tmp_path, text.replace("[1.0, 0", "[1.01, 0"), "cold.toml")))
    assert rows[-1]["q_tip"] == pytest.approx(cold[0]["q_tip"], rel=1e-3)
