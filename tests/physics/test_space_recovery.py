"""Stresses recovered at the nodes of tetrahedra: exact where they must be, and no patch magnifies what is rough."""

import numpy as np
import pytest
from modal import SCENES

from restshape import _kernels
from restshape.interface.first_frame import first_frame

FISH = np.array([614.35, 1154.05, 1676.04, 2382.29, 3191.95])
"""Frequencies [Hz] of mesh.order=2, mesh.layers=2, mesh.size="2.5 mm"."""

BAR = np.array([2089.49, 4013.35, 5738.64, 8370.54, 11133.82])
"""The same of the bar, mesh.size="2 mm"."""

SIDES = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
MOST = 16.0
"""Sum of squared weights that the recovery allows: see field_recovery_space.hpp."""


def body_of(scene: str, order: int, size: float, layers: int = 1):
    """Modes of a scene whose mesh has cells of that size [mm]."""
    overrides = [f"mesh.order={order}", f'mesh.size="{size} mm"', f"mesh.layers={layers}", "effects.modal.modes=5"]
    return first_frame(SCENES / scene, [*overrides, "solve.tolerance=1e-4"]).analysis


def recovered(mesh, samples: np.ndarray) -> np.ndarray:
    """Nodal values (k, n, 6) of samples (k, ne, ..., 6)."""
    out = np.empty((len(samples), len(mesh.X), 6))
    _kernels.recover_space(mesh.X, mesh.cells, np.ascontiguousarray(samples), out)
    return out


def sample_places(mesh) -> np.ndarray:
    """Where cells are sampled: (ne, 3) at their centres, or (ne, 4, 3) of second order, whose sides may be curved."""
    if mesh.cells.shape[1] == 4:
        return mesh.X[mesh.cells].mean(axis=1)
    points = _kernels.space_recovery_points()
    own = np.column_stack([1.0 - points.sum(axis=1), points])
    shapes = [own * (2.0 * own - 1.0), *(4.0 * own[:, [i]] * own[:, [j]] for i, j in SIDES)]
    return np.einsum("si,eia->esa", np.hstack(shapes), mesh.X[mesh.cells])


def polynomial(X: np.ndarray, degree: int) -> np.ndarray:
    """Six polynomials (..., 6) of all terms, of places (..., 3) in metres of a body of decimetres."""
    x, y, z = np.moveaxis(X / 0.05, -1, 0)
    terms = [np.ones_like(x), x, y, z, x * x, y * y, z * z, x * y, y * z, z * x][: 4 if degree == 1 else 10]
    return np.stack(terms, axis=-1) @ np.random.default_rng(2).normal(size=(len(terms), 6))


@pytest.mark.slow
@pytest.mark.parametrize(("order", "size"), [(1, 14.0), (1, 4.95), (1, 4.949), (2, 14.0), (2, 9.9), (2, 5.88)])
def test_polynomials_of_the_cells_order_are_exact_at_all_nodes(order, size):
    """At corners with few cells too, which take what their neighbours know."""
    mesh = body_of("fish.toml", order, size).state.body.space
    samples = polynomial(sample_places(mesh), order)
    found, exact = recovered(mesh, samples[None])[0], polynomial(mesh.X, order)
    assert np.abs(found - exact).max() < 1e-7 * np.abs(exact).max()


@pytest.mark.slow
@pytest.mark.parametrize(("order", "size"), [(1, 14.0), (1, 7.0), (1, 4.95), (1, 4.949), (2, 14.0), (2, 9.9), (2, 7.0)])
def test_weights_of_samples_are_bounded_at_all_nodes(order, size):
    """Corners whose cells lie nearly in a plane, or have their samples nearly on a quadric, had weights of hundreds."""
    mesh = body_of("fish.toml", order, size).state.body.space
    count = len(mesh.cells) * (1 if order == 1 else 4)
    unit = np.zeros((-(-count // 6) * 6, count))
    unit[:count] = np.eye(count)
    samples = unit.reshape(-1, 6, count).swapaxes(1, 2)
    shape = (len(samples), len(mesh.cells), 6) if order == 1 else (len(samples), len(mesh.cells), 4, 6)
    weights = recovered(mesh, samples.reshape(shape))
    np.testing.assert_allclose(weights.sum(axis=(0, 2)), 1.0, atol=1e-8)
    assert (weights**2).sum(axis=(0, 2)).max() <= MOST * (1 + 1e-9)


def test_one_cell_by_itself():
    """Nothing but its mean is known of first order, a linear stress of second order."""
    corners = np.vstack([np.zeros(3), np.eye(3)])
    X = np.vstack([corners, [0.5 * (corners[i] + corners[j]) for i, j in SIDES]])
    out = np.empty((1, 4, 6))
    _kernels.recover_space(corners, np.arange(4, dtype=np.int32)[None], np.full((1, 1, 6), 3.0), out)
    assert out == pytest.approx(3.0)
    places = _kernels.space_recovery_points()
    out = np.empty((1, 10, 6))
    samples = np.ascontiguousarray(polynomial(places, 1)[None, None])
    _kernels.recover_space(X, np.arange(10, dtype=np.int32)[None], samples, out)
    np.testing.assert_allclose(out[0], polynomial(X, 1), rtol=1e-10, atol=1e-10)


SWEEPS = {
    "fish, first order": ("fish.toml", 1, 1, (14.0, 11.9, 9.87, 8.33, 7.0, 5.88, 4.949, 4.2, 3.5), FISH),
    "fish, second order": ("fish.toml", 2, 1, (14.0, 11.9, 9.87, 8.33, 7.0, 5.88), FISH),
    "bar, first order": ("bar_100.toml", 1, 2, (16.0, 12.0, 10.0, 8.0, 6.5, 5.5, 4.45), BAR),
    "bar, second order": ("bar_100.toml", 2, 1, (16.0, 12.0, 10.0, 8.0, 6.5), BAR),
    "bar, second order, two layers": ("bar_100.toml", 2, 2, (16.0, 12.0, 10.0, 8.0), BAR),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", SWEEPS)
def test_effectivity_does_not_jump_with_the_mesh(name):
    """Of each of five modes neighbours differ by less than a factor 1.9; none is estimated as much more than twice."""
    scene, order, layers, sizes, exact = SWEEPS[name]
    found = []
    for size in sizes:
        analysis = body_of(scene, order, size, layers)
        state, chosen = analysis.state, analysis.state.modes.chosen
        estimated = 0.5 * state.body.error_estimate()(state.modes.vectors[chosen]) / state.modes.values[chosen]
        found.append(estimated / (analysis.frequencies / exact - 1.0))
    found = np.array(found)
    jumps = np.exp(np.abs(np.diff(np.log(found), axis=0)))
    assert jumps.max() < 1.9, found.round(2)
    assert found.max() < 2.3 and found.min() > 0.1, found.round(2)
