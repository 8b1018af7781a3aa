"""How tones of a bar follow its freedoms."""

from __future__ import annotations

import numpy as np
from restshape_apps.metallophone.tuning.bar import Bar
from restshape_apps.metallophone.tuning.followed_modes import FollowedModes
from restshape_apps.metallophone.tuning.motions import Motions

from restshape.sensitivity.frequency_derivative import design_products, nodal_gradient


def tone_rates(bar: Bar, modes: FollowedModes, motions: Motions) -> np.ndarray:
    """Derivatives (m, k) of the logarithms of frequencies by the freedoms of a bar.

    Of a cluster that of the mean of its eigenvalues, a symmetric function of them, which is smooth at crossings. Of few
    freedoms each is a direction; of many, what each node of an element does is cheaper.

    Args:
        bar: that has been solved; modes: in its last solve; motions: of its freedoms.
    """
    velocities = _velocities(bar, motions)
    axes = np.flatnonzero(velocities.any(axis=(0, 1)))
    directions = bar.analysis.state.body.space.cells.shape[1] * len(axes)
    eigen_rates = _by_freedoms if len(velocities) <= directions else _by_nodes
    needed = np.unique(np.concatenate(modes.groups))
    by_mode = dict(zip(needed.tolist(), eigen_rates(bar, needed, velocities, axes)))
    values = bar.analysis.state.modes.values
    rows = [0.5 * sum(by_mode[int(k)] for k in group) / values[group].sum() for group in modes.groups]
    return np.array(rows).reshape(len(modes.groups), len(velocities))


def _velocities(bar: Bar, motions: Motions) -> np.ndarray:
    """Velocities (k, n, d) of the nodes of the body a unit of each freedom."""
    body = bar.analysis.state.body
    found = body.motion(motions.plane)
    for velocity, thicker in zip(found, motions.thickness):
        if thicker.any():
            velocity += body.thickness_motion(thicker)
    return found


def _by_freedoms(bar: Bar, modes: np.ndarray, velocities: np.ndarray, axes: np.ndarray) -> np.ndarray:
    """Derivatives (modes, k) of eigenvalues, a product of the matrices' rates for each freedom."""
    known = bar.analysis.state.modes
    vectors, values, found = known.vectors[modes], known.values[modes], np.empty((len(modes), len(velocities)))
    for k, velocity in enumerate(velocities):
        stiff, mass = design_products(bar.analysis, vectors, velocity)
        found[:, k] = (vectors * (stiff - values[:, None] * mass)).sum(axis=1)
    return found


def _by_nodes(bar: Bar, modes: np.ndarray, velocities: np.ndarray, axes: np.ndarray) -> np.ndarray:
    """The same by the gradient of each eigenvalue by the places of nodes, along the axes that freedoms move them."""
    gradients = [nodal_gradient(bar.analysis, int(mode), axes) for mode in modes]
    return np.array([(velocities * gradient).sum(axis=(1, 2)) for gradient in gradients])
