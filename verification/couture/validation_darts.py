"""Validation case of darts: a disc with one to its middle, cut out or folded, is a cone."""

import numpy as np
from petsc4py import PETSc
from restshape_studies.validation.case import CLOSED_FORM, Check
from restshape_verification.couture.validation_seams import CLOTH, HEAD, frame_of

RADIUS, WIDTH = 0.2, 0.2
"""Radius of the disc, and width of the dart [m]: a sixth of the disc."""
DISC = f"""
[shape]
outline = ["lower", "upper"]
[shape.vertices]
west = [{-RADIUS}, 0]
east = [{RADIUS}, 0]
[shape.edges]
lower = {{ arc = ["west", "east"], bulge = 1 }}
upper = {{ arc = ["east", "west"], bulge = 1 }}
[darts.cone]
edge = "upper"
length = {RADIUS}
width = {WIDTH}
stitched = "flat"
[supports.leg]
on = "cone.left"
fix = ["x", "y", "z"]
[start]
scatter = "1 mm"
[mesh]
size = "16 mm"
"""


def sewn_dart(comm: PETSc.Comm) -> list[Check]:
    """A disc without weight and a dart of the angle a to its middle, sewn flat: a cone whose half angle has the sine
    1 - a / (2 pi).

    Lines from the tip stay straight and keep their lengths, but for what membrane and bending give to each other there
    and at the edge. The angle is the mean over the nodes of the edge, about the mean of their directions.
    """
    analysis = frame_of(HEAD + CLOTH + DISC, comm)
    problem = analysis.problem
    mesh, x = problem.mesh, problem.corners(analysis.x)
    tip = x[mesh.nodes_of("cone.tip")[0]]
    rays = x[np.union1d(mesh.nodes_of("upper"), mesh.nodes_of("lower"))] - tip
    lengths = np.linalg.norm(rays, axis=1)
    ways = rays / lengths[:, None]
    axis = ways.mean(axis=0)
    angles = np.arccos(ways @ (axis / np.linalg.norm(axis)))
    wanted = np.arcsin(1.0 - 2.0 * np.arcsin(0.5 * WIDTH / RADIUS) / (2.0 * np.pi))
    source = "a cone's development"
    return [
        Check("half angle of the cone [rad]", float(angles.mean()), float(wanted), 1e-2, source, CLOSED_FORM),
        Check("largest half angle [rad]", float(angles.max()), float(wanted), 5e-2, source, CLOSED_FORM),
        Check("distance of its edge from the tip [m]", float(lengths.mean()), RADIUS, 5e-3, source, CLOSED_FORM),
    ]
