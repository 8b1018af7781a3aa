"""Positions on a finer mesh from those at rest on a coarser one."""

from __future__ import annotations

import numpy as np

from restshape.mesh.nested import Refined
from restshape.physics.cloth.cloth_problem import ClothProblem

FLAT = 0.25
"""Square of the gradient of a distance, at least: it vanishes at the medial axis of a body of triangles."""


def finer_places(problem: ClothProblem, step: Refined, coarse: np.ndarray) -> np.ndarray:
    """Places (n, 3) [m] of the nodes of a finer mesh, as far from bodies as the coarse cloth is where it touches them.

    The middle of an edge that lies on a round body is deeper than its ends, where contact would throw it off. It is
    taken out as far as they are in the mean, and no farther than contact reaches.

    Args:
        problem: on the finer mesh.
        step: to it.
        coarse: (n_coarse, 3) places of the coarse nodes [m].
    """
    places = step.prolonged(coarse)
    found = places.copy()
    for body in problem.contact.bodies if problem.contact else ():
        wanted = np.minimum(step.prolonged(body.distances(coarse)[:, None])[:, 0], problem.contact.thickness)
        near = np.flatnonzero(body.distances(found) < wanted)
        distance, outward = (np.asarray(part) for part in body.distance(found[near])[:2])
        # The gradient of a body of triangles is not of length one.
        square = np.maximum(np.einsum("ij,ij->i", outward, outward), FLAT)
        found[near] += (np.maximum(wanted[near] - distance, 0.0) / square)[:, None] * outward
    if problem.self_contact and problem.begin(problem.flat(places)):
        way = found - places
        return places + problem.self_contact.step_share(places, way) * way
    return found
