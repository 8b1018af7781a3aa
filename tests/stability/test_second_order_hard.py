"""Curved sides pulled until their triangles would turn over: a new mesh in time, valid triangles in every frame."""

import numpy as np
import pytest
from small_scenes import (
    CLAMPED,
    HEAD,
    PULLED,
    QUANTITIES,
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

from restshape.mesh.space import quadratic_basis
from restshape.replay.parity import Parity

WAVY = block(2.0, 1.0).replace(
    'top = { line = ["c", "d"] }', 'top = { spline = ["c", "d"], through = [[1.5, 1.08], [1, 0.9], [0.5, 1.05]] }'
)


def jacobians(mesh) -> np.ndarray:
    """Determinants of the maps of all triangles at many points, over twice the area of their corners' triangle."""
    s = np.linspace(0, 1, 7)
    points = np.array([(x, y) for x in s for y in s if x + y <= 1])
    _, slopes = quadratic_basis(points)
    J = np.linalg.det(np.einsum("qia,eib->eqab", slopes, mesh.X[mesh.cells]))
    p, q = (mesh.X[mesh.corners[:, k]] - mesh.X[mesh.corners[:, 0]] for k in (1, 2))
    return J / (p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0])[:, None]


def replayed(folder, text, events, overrides=()):
    """The rows of a replay of second order; triangles are checked in each frame, and solutions against cold ones."""
    made = make_replay(write_scene(folder, text), write_script(folder, events), "auto", ["mesh.order=2", *overrides])
    check = Parity(made)

    def look(row):
        assert jacobians(made.analysis.mesh).min() > 0
        assert np.isfinite(made.analysis.x).all()
        row.update(check())

    rows = rows_of(made, look)
    assert check.summary()["holds"]
    return rows


def test_an_arc_that_bulges_into_the_body(tmp_path):
    events = [{"do": "arc", "on": "window.2", "bulge": 1.4, "frames": 30}, {"do": "undo"}]
    rows = replayed(tmp_path, plate(0.3), events)
    assert {1, 3} <= {row["level"] for row in rows} and not any(row["refused"] for row in rows)


def test_a_corner_of_a_round_hole_pulled_far(tmp_path):
    start = (0.5 + 0.15, 0.5)
    events = drag("window.v1", start, [*across(start, (1.6, 0.55), 25), *across((1.6, 0.55), (0.6, 0.5), 25)])
    rows = replayed(tmp_path, plate(0.25), events)
    assert {1, 3} <= {row["level"] for row in rows}
    assert sum(bool(row["refused"]) for row in rows) <= 25


@pytest.mark.parametrize("size", [0.4, 0.15])
def test_a_wavy_edge_pressed_into_the_plate(tmp_path, size):
    text = HEAD + WAVY + STEEL + CLAMPED + PULLED + meshed(size) + QUANTITIES
    corner = (2.0, 1.0)
    events = drag("c", corner, [*across(corner, (2.0, 0.2), 20), *across((2.0, 0.2), (2.3, 1.3), 20)])
    rows = replayed(tmp_path, text, events)
    assert {1, 3} <= {row["level"] for row in rows}


def test_a_jerk_over_the_whole_plate_and_back(tmp_path):
    events = drag("window", (0.5, 0.5), [(1.5, 0.5), (0.5, 0.5), (1.5, 0.6), (0.45, 0.4)])
    rows = replayed(tmp_path, plate(0.2), events)
    assert not any(row["refused"] for row in rows)
