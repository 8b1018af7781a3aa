"""Fields at any place of a mesh, and distances of solutions, beside closed forms."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from restshape_studies.accuracy.distance import Reference, spectral
from restshape_studies.accuracy.grid import Grid
from restshape_studies.accuracy.state import Sampled, State, state_of

from restshape.interface.first_frame import first_frame
from restshape.mesh.generate import generate
from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.scene.model import MeshSpec, ShapeSpec
from restshape.shape.build import outline_from_spec

LAMBDA, MU, THICKNESS, MASS = 3.0, 2.0, 0.5, 7.0
NONE = np.empty(0)


def square(order: int, size: float = 0.23) -> Grid:
    """The unit square."""
    corners = {"a": (0, 0), "b": (1, 0), "c": (1, 1), "d": (0, 1)}
    names = list(corners)
    edges = {f"{a}{b}": {"line": [a, b]} for a, b in zip(names, [*names[1:], names[0]])}
    spec = ShapeSpec.model_validate({"outline": list(edges), "vertices": corners, "edges": edges})
    mesh = generate(outline_from_spec(spec, Path()), MeshSpec(size=size))
    return Grid.of(LagrangeSpace(mesh) if order == 2 else mesh)


def state(grid: Grid, u: np.ndarray, v: np.ndarray | None = None, large: bool = False) -> State:
    """A displacement, and where given a velocity, as a solution."""
    stiffness = np.tile([LAMBDA, MU, THICKNESS, MASS], (len(grid.cells), 1))
    return State(grid, np.zeros((4, 2)), u, v, "", NONE, np.empty((0, len(grid.X), 2)), stiffness, large, {"q_a": 1.0})


@pytest.mark.parametrize("order", [1, 2])
def test_polynomials_of_the_order_are_evaluated_exactly(order):
    grid = square(order)
    points = np.random.default_rng(order).uniform(0.02, 0.98, (40, 2))
    places = grid.locate(points, np.zeros(len(points)))
    x, y = points.T
    if order == 1:
        field, value, slope = (
            (lambda x, y: 1.0 + 2.0 * x - 3.0 * y),
            1.0 + 2.0 * x - 3.0 * y,
            (2.0 + 0 * x, -3.0 + 0 * x),
        )
    else:
        field, value, slope = (lambda x, y: x * y - 2.0 * y**2), x * y - 2.0 * y**2, (y, x - 4.0 * y)
    nodal = field(*grid.X.T)[:, None]
    assert np.allclose(places.field(nodal)[:, 0], value, atol=1e-13)
    assert np.allclose(places.gradient(nodal)[:, 0], np.stack(slope, axis=1), atol=1e-11)
    assert np.allclose(places.points(grid), points, atol=1e-13)


def test_centroids_carry_the_area():
    places = square(2).centroids()
    assert places.area.sum() == pytest.approx(1.0, abs=1e-13)


def test_norms_of_linear_displacements_are_known():
    fine, coarse = square(2, 0.13), square(1)
    ones = np.zeros_like(fine.X)
    stretched = ones + np.column_stack([fine.X[:, 0], 0.0 * fine.X[:, 0]])
    held = Reference.of(state(fine, stretched, np.ones_like(fine.X)))
    # u = (1.1 x + 0.2 y, 0): off by (0.1 x + 0.2 y, 0), whose strains are 0.1 and a shear of 0.1 twice.
    x, y = coarse.X.T
    other = held.sampled(state(coarse, np.column_stack([1.1 * x + 0.2 * y, 0.0 * x]), 1.5 * np.ones_like(coarse.X)))
    found = held.distances(held.solution, other)
    strain = (LAMBDA + 2 * MU) * THICKNESS
    apart = (LAMBDA + 2 * MU) * 0.01 * THICKNESS + 2 * MU * THICKNESS * 2 * 0.01
    assert found["energy"] == pytest.approx(np.sqrt(apart / strain), rel=1e-10)
    # int (0.1 x + 0.2 y)^2 over int x^2, over the unit square.
    assert found["l2"] == pytest.approx(np.sqrt((0.01 / 3 + 0.04 / 3 + 0.04 / 4) * 3.0), rel=2e-3)
    whole = strain + MASS * 2.0
    assert found["motion"] == pytest.approx(np.sqrt((apart + MASS * 0.5) / whole), rel=1e-10)
    assert list(found) == ["motion", "energy", "l2"]


def test_a_problem_without_moduli_has_the_l2_norm_alone():
    bare = [replace(state(square(2), factor * square(2).X), stiffness=None) for factor in (1.0, 1.1)]
    held = Reference.of(bare[0])
    assert held.distances(held.solution, held.sampled(bare[1])) == {"l2": pytest.approx(0.1, rel=1e-10)}


def test_a_turn_of_a_large_deformation_is_no_error_in_energy():
    grid, angle = square(2), 0.7
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    stretched = grid.X * (1.2, 1.0)
    held = Reference.of(state(grid, stretched - grid.X, large=True))
    found = held.distances(held.solution, held.sampled(state(grid, stretched @ turn.T - grid.X, large=True)))
    assert found["energy"] < 1e-12 and found["l2"] > 0.5


def test_parts_in_the_energy_norm_obey_the_triangle_inequality_at_every_state():
    rng, fine, coarse = np.random.default_rng(3), square(2, 0.13), square(1)
    held = Reference.of(state(fine, rng.normal(size=fine.X.shape)))
    places = [held.sampled(state(coarse, rng.normal(size=coarse.X.shape))) for _ in range(3)]
    direct, tight, u = places
    for measure in ("energy", "l2"):
        parts = [held.distances(*pair)[measure] for pair in ((held.solution, direct), (direct, tight), (tight, u))]
        error = held.distances(held.solution, u)[measure]
        assert max(2 * max(parts) - sum(parts), 0.0) - 1e-12 <= error <= sum(parts) + 1e-12


def modes(values, angle: float) -> tuple[Reference, Sampled]:
    """Two modes at places, and the same ones turned among themselves and with a sign of their own."""
    x = np.linspace(0.0, 1.0, 400)
    first, second = np.sin(np.pi * x), np.sin(2 * np.pi * x)
    shapes = np.stack([first, second])[:, :, None]
    turned = np.stack([np.cos(angle) * first + np.sin(angle) * second, np.sin(angle) * first - np.cos(angle) * second])
    empty = np.empty((0, 4))
    whole = Sampled(None, None, None, np.array(values), shapes)
    held = Reference(
        np.empty((400, 2)), np.full(400, 1 / 400), np.zeros(400), empty, np.zeros((1, 2)), "frequencies", whole
    )
    return held, Sampled(None, None, None, np.array(values), -turned[:, :, None])


def test_modes_of_one_frequency_may_turn_and_others_may_not():
    held, turned = modes([100.0, 100.1], 0.3)
    assert held.distances(held.solution, turned)["shapes"] == pytest.approx(0.0, abs=1e-12)
    held, turned = modes([100.0, 200.0], 0.3)
    assert held.distances(held.solution, turned)["shapes"] == pytest.approx(np.sin(0.3), rel=1e-6)


def test_spectra_are_compared_rank_by_rank():
    assert spectral(np.array([1.0, 4.0]), np.array([1.0, 4.0]), np.array([1.01, 4.2])) == pytest.approx(0.05)
    assert spectral(np.array([1.0, 4.0]), np.array([1.0, 4.0]), np.array([1.01])) == 1.0
    assert spectral(NONE, NONE, NONE) == 0.0


def test_a_reference_survives_its_file(tmp_path):
    grid = square(2)
    held = Reference.of(state(grid, grid.X**2, grid.X))
    held.save(tmp_path / "0.npz")
    again = Reference.load(tmp_path / "0.npz")
    assert np.array_equal(again.solution.strain, held.solution.strain) and np.array_equal(
        again.solution.v, held.solution.v
    )
    assert again.solution.quantities == {"a": 1.0} and again.spectrum == ""


RUBBER = """
format = "restshape-scene"
version = 1
app = "plane"
[shape]
outline = ["bottom", "outer", "left", "inner"]
vertices = { a = [1, 0], b = [2, 0], c = [0, 2], d = [0, 1] }
edges.bottom = { line = ["a", "b"] }
edges.outer = { arc = ["b", "c"], bulge = "tan(pi/8)" }
edges.left = { line = ["c", "d"] }
edges.inner = { arc = ["d", "a"], bulge = "-tan(pi/8)" }
[material.rubber]
E = 1e6
nu = 0.4999
thickness = 1
[effects.solid]
model = "plane_strain"
[supports]
below = { on = "bottom", fix = ["y"] }
beside = { on = "left", fix = ["x"] }
[loads.inside]
on = "inner"
pressure = 1e4
[mesh]
size = SIZE
"""


def test_nearly_incompressible_solutions_are_as_far_apart_as_they_are_estimated(tmp_path):
    """Dilatations at points, times a modulus 5,000 times that of shear, would say 40 times as much."""

    def solved(size):
        scene = tmp_path / "scene.toml"
        scene.write_text(RUBBER.replace("SIZE", str(size)))
        found = first_frame(scene)
        return state_of(found.analysis, np.zeros((1, 2)), found.row), found.row["estimate"]

    (coarse, estimate), (fine, _) = solved(0.15), solved(0.03)
    reference = Reference.of(fine)
    error = reference.distances(reference.sampled(coarse), reference.solution)["energy"]
    assert coarse.averaged and 0.7 <= estimate / error <= 1.4
