"""How far eigenvalues are at most from values that have not converged, against LAPACK, in the units of each model."""

import numpy as np
import pytest
from modal import SMALL, solved
from scipy.linalg import eigh

from restshape.algebra.eigenproblems.davidson import Found


@pytest.mark.slow
@pytest.mark.parametrize("model", sorted(SMALL))
def test_an_eigenvalue_lies_within_the_distance(model):
    analysis = solved(model)
    K, M = (m.toarray() for m in analysis.state.matrices.gather())
    free = analysis.state.body.boundary.mask.ravel() == 0
    values = eigh(K[np.ix_(free, free)], M[np.ix_(free, free)], eigvals_only=True)
    rng = np.random.default_rng(5)
    for size in (1e-4, 1e-3, 1e-2, 1e-1):
        noise = np.where(free, rng.standard_normal(analysis.state.modes.vectors.shape), 0.0)
        # Rough and smooth directions alike: noise, and what the stiffness makes smooth of it.
        noise = np.concatenate([noise, analysis.solver.pencil.solve(noise @ M)])
        noise /= np.sqrt(np.einsum("ki,ij,kj->k", noise, M, noise))[:, None]
        rows = np.concatenate([analysis.state.modes.vectors, analysis.state.modes.vectors]) + size * noise
        rows /= np.sqrt(np.einsum("ki,ij,kj->k", rows, M, rows))[:, None]
        quotients = np.einsum("ki,ij,kj->k", rows, K, rows)
        found = Found(quotients, rows, np.ones(len(rows)), 0, False)
        distances = analysis.solver._distances(found)
        nearest = np.abs(values[:, None] - quotients).min(axis=0)
        assert np.all(nearest <= distances * (1.0 + 1e-9))
    modes = analysis.state.modes
    found = Found(modes.values, modes.vectors, np.ones(len(modes.vectors)), 0, True)
    assert np.all(analysis.solver._distances(found)[modes.chosen] < 1e-5 * modes.values[modes.chosen])
