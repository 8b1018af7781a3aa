"""Residuals that rounding keeps above the tolerance are reported, and measured against the load all the same."""

from pathlib import Path

import numpy as np
import pytest
from large import beam
from small_scenes import across, drag, make_replay, rows_of, write_scene, write_script

from restshape.interface.first_frame import first_frame


@pytest.mark.parametrize(("tolerance", "reached"), [(1e-6, True), (1e-10, False)])
def test_a_tolerance_below_rounding_is_reported(tolerance, reached):
    # Forces along a strip of 1:100 are 10^4 times those that bend it, and so is their rounding.
    scene = Path(__file__).parents[1] / "scenes" / "elastica.toml"
    made = first_frame(scene, ["parameters.load=10", f"solve.tolerance={tolerance}"])
    row, equations = made.row, made.analysis.state.equations
    assert ("out of reach" in row["note"]) == (not reached)
    # What the row reports is the residual over the load itself, whatever could be reached.
    left, load = (np.linalg.norm(equations.full_residual(x)) for x in (made.analysis.x, 0 * made.analysis.x))
    force = 10 * 12e6 * 0.01**3 / 12
    assert equations.full_residual(0 * made.analysis.x)[:, 1].sum() == pytest.approx(force)
    assert row["residual"] == pytest.approx(left / load, rel=0.02) and (row["residual"] <= tolerance) == reached
    # K. Mattiasson, Int. J. Numer. Meth. Engng 17 (1981) 145.
    assert (-row["q_down"], -row["q_back"]) == pytest.approx((0.810609, 0.554996), rel=3e-4)


def test_a_drag_goes_on_where_rounding_ends_each_frame(tmp_path):
    text = beam() + "\n[solve]\ntolerance = 1e-15\n"
    script = write_script(tmp_path, drag("b", (1, 0), across((1, 0), (1.1, -0.05), 5)))
    made = make_replay(write_scene(tmp_path, text), script)
    areas = []

    def look(row):
        X, cells = made.analysis.space.X, made.analysis.space.cells
        a, b = (X[cells[:, k]] - X[cells[:, 0]] for k in (1, 2))
        areas.append(0.5 * np.abs(np.cross(a, b)).sum())

    rows = rows_of(made, look)
    for row, area in zip(rows, areas):
        assert not row["refused"] and row["note"] == "a tolerance of 1e-15 is out of reach of rounding"
        assert 1e-15 < row["residual"] < 1e-11
        assert row["q_wall_y"] == pytest.approx(1000 * 10 * area, rel=1e-11)


@pytest.mark.parametrize("words", [("check", "scene.toml"), ("replay", "scene.toml")])
def test_a_tolerance_that_no_rounding_reaches_is_refused(command, tmp_path, words):
    write_scene(tmp_path, beam() + "\n[solve]\ntolerance = 1e-16\n")
    done = command(*words)
    assert done.returncode == 2
    assert "solve.tolerance (line " in done.stderr
    assert "1e-16 is too small: it must be at least 1e-15" in done.stderr


@pytest.mark.parametrize(("tolerance", "reached"), [(1e-6, True), (1e-12, False)])
def test_residuals_of_load_factors_within_the_tolerance_are_not_said_to_be_above_it(tolerance, reached):
    """Of a slender column rounding could keep them above 1e-6, by its bound; what they come to counts."""
    scene = Path(__file__).parents[1] / "scenes" / "column.toml"
    made = first_frame(
        scene, ["shape.vertices.b.0=0.02", "shape.vertices.c.0=0.02", "mesh.size=0.005", f"solve.tolerance={tolerance}"]
    )
    assert made.analysis.solver.reach > 1e-6
    assert ("rounding keeps residuals" in str(made.row["note"])) == (not reached)
