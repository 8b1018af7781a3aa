"""Errors of a body of two materials with a round interface, beside Lame's closed form."""

import numpy as np
import pytest
from restshape_studies.accuracy.distance import Reference
from restshape_studies.accuracy.grid import Places
from restshape_studies.accuracy.state import State, state_of
from restshape_studies.stability.scenery import write_scene

from restshape.interface.first_frame import first_frame

INNER, BETWEEN, OUTER, WIDER = 0.1, 0.2, 0.3, 1e-3
LAME = np.array([[1.2e10, 0.8e10], [1.2e6, 0.8e6]])
"""Moduli lambda and mu [Pa] of the inner ring, which is stiff, and of the outer one."""
RINGS = """
format = "restshape-scene"
version = 1
app = "plane"
[shape]
outline = ["upper", "lower"]
vertices = { a = [0.3, 0], b = [-0.3, 0] }
edges = { upper = { arc = ["a", "b"], through = [0, 0.3] }, lower = { arc = ["b", "a"], through = [0, -0.3] } }
holes = { bore = { circle = { center = [0, 0], radius = 0.1 } } }
regions = { stiff = { circle = { center = [0, 0], radius = 0.2 } } }
[material.hard]
region = "stiff"
E = 2.08e10
nu = 0.3
[material.soft]
E = 2.08e6
nu = 0.3
[effects.solid]
model = "plane_strain"
[supports.bore]
on = "bore"
fix = { x = "1e-3*x/0.1", y = "1e-3*y/0.1" }
[supports.rim]
on = "outline"
fix = { x = 0, y = 0 }
[mesh]
size = 0.05
order = 1
[quantities]
energy = { energy = "strain" }
"""


def solved(folder, *given: str) -> State:
    """The rings, whose bore is widened by 1 mm."""
    replay = first_frame(write_scene(folder, RINGS), ["solve.tolerance=1e-10", *given])
    return state_of(replay.analysis, np.zeros((2, 2)), replay.row)


def exact() -> np.ndarray:
    """A and B of u = A r + B/r in both rings (2, 2): displacements at the rims, displacement and stress between."""

    def rows(r, lame, mu):
        return [r, 1 / r], [2 * (lame + mu), -2 * mu / r**2]

    none = [0.0, 0.0]
    (inner, _), (u1, s1) = rows(INNER, *LAME[0]), rows(BETWEEN, *LAME[0])
    (outer, _), (u2, s2) = rows(OUTER, *LAME[1]), rows(BETWEEN, *LAME[1])
    matrix = np.array([inner + none, none + outer, u1 + [-one for one in u2], s1 + [-one for one in s2]])
    return np.linalg.solve(matrix, [WIDER, 0.0, 0.0, 0.0]).reshape(2, 2)


def strain(X: np.ndarray, ring: np.ndarray) -> np.ndarray:
    """The closed form's strain (m, 2, 2) at places X (m, 2) of rings (m,), 0 the inner one."""
    A, B = exact()[ring].T
    r = np.hypot(*X.T)
    n = X / r[:, None]
    radial, hoop = A - B / r**2, A + B / r**2
    outward = np.einsum("mi,mj->mij", n, n)
    return radial[:, None, None] * outward + hoop[:, None, None] * (np.eye(2) - outward)


def energy_error(state: State) -> float:
    """Relative error in the energy norm, by three points in each of the mesh's own cells, each of its own ring."""
    points, count = np.array([[1, 1], [4, 1], [1, 4]]) / 6, len(state.grid.cells)
    places = Places(state.grid, np.repeat(np.arange(count), 3), np.tile(points, (count, 1)))
    ring = np.repeat((state.grid.regions == 0).astype(int), 3)
    truth = strain(places.points(state.grid), ring)
    gradient = places.gradient(state.displacement)
    found = 0.5 * (gradient + gradient.transpose(0, 2, 1))
    lame, mu = LAME[ring].T

    def energy(e):
        return places.area @ (lame * np.trace(e, axis1=1, axis2=2) ** 2 + 2 * mu * (e**2).sum(axis=(1, 2)))

    return float(np.sqrt(energy(found - truth) / energy(truth)))


@pytest.mark.slow
def test_errors_beside_a_round_interface_are_those_of_the_closed_form(tmp_path):
    held = Reference.of(solved(tmp_path, "mesh.order=2", "mesh.near.stiff=0.005"))
    state = solved(tmp_path)
    place = state.grid.locate(held.points, np.full(len(held.points), -1))
    assert (state.grid.regions[place.cells] != held.regions).sum() > 50, "no point between chord and arc"
    found = held.distances(held.solution, held.sampled(state))["energy"]
    assert found == pytest.approx(energy_error(state), rel=0.02)
