"""Plane stress under large deformation: the thickness changes, and Cauchy's stress with it."""

import numpy as np
import pytest
from large import LARGE, solid
from small_scenes import HEAD, block, make_replay, meshed, rows_of, write_scene

from restshape.physics.elasticity.thickness_stretch import thickness_stretch

E, NU = 1e6, 0.3


def pulled(stretch, order):
    """A block that is free to contract, pulled to a stretch: S_xx = E (l^2 - 1)/2, per area at rest l S_xx."""
    load = 0.5 * E * stretch * (stretch**2 - 1)
    return (
        HEAD
        + block()
        + f"[material.m]\nE = {E}\nnu = {NU}\n"
        + LARGE
        + solid("plane_stress")
        + '[supports.l]\non = "left"\nfix = { x = 0 }\n[supports.a]\non = "a"\nfix = { y = 0 }\n'
        + f'[loads.p]\non = "right"\ntraction = [{load}, 0]\n[solve]\ntolerance = 1e-11\n'
        + meshed(0.3, order)
        + '[quantities]\nu = { displacement = "x", at = "c" }\ns = { stress = "von_mises" }\n'
        + 'xx = { stress = "xx", reduce = "min" }\n'
    )


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("stretch", [0.9, 1.25, 1.6])
def test_stress_of_a_block_is_its_load_over_the_deformed_section(tmp_path, stretch, order):
    made = make_replay(write_scene(tmp_path, pulled(stretch, order)))
    (row,) = rows_of(made)
    assert row["q_u"] == pytest.approx(stretch - 1, rel=1e-9)
    # Both sides of the section contract alike: l2 = l3, with E22 = -nu E11.
    section = 1 - NU * (stretch**2 - 1)
    exact = 0.5 * E * stretch * (stretch**2 - 1) / section
    assert row["q_xx"] == pytest.approx(exact, rel=1e-9)
    assert row["q_s"] == pytest.approx(abs(exact), rel=1e-9)
    np.testing.assert_allclose(made.analysis.fields()[0]["von_mises"], abs(exact), rtol=1e-9)


def test_thickness_of_curved_triangles_is_that_of_their_gradient():
    rng = np.random.default_rng(3)
    corners = np.array([[0.0, 0], [1, 0], [0, 1], [0.5, 0], [0.5, 0.5], [0, 0.5]])
    X, A = corners + 0.03 * rng.standard_normal(corners.shape), np.array([[0.2, 0.1], [-0.15, 0.1]])
    C = (np.eye(2) + A).T @ (np.eye(2) + A)
    exact = np.sqrt(1 - 0.4 * (np.trace(C) - 2))
    points = np.array([[0.2, 0.2], [0.6, 0.2], [0.2, 0.6]])
    found = thickness_stretch(X, X @ A.T, np.arange(6, dtype=np.int32)[None], np.array([0.4]), points)
    np.testing.assert_allclose(found, np.full((1, 3), exact), rtol=1e-12)


def test_a_body_that_is_pulled_to_no_thickness_has_no_stress():
    X, cells = np.array([[0.0, 0], [1, 0], [0, 1]]), np.array([[0, 1, 2]], dtype=np.int32)
    assert np.isnan(thickness_stretch(X, 1.5 * X, cells, np.array(0.4))).all()
