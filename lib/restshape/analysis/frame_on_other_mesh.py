"""The answer of a frame on another mesh of its shape; of what goes on in time, from the same state before it."""

from dataclasses import replace

import numpy as np

from restshape.analysis.analysis import Analysis
from restshape.analysis.frame import Frame
from restshape.analysis.transient import TransientAnalysis
from restshape.analysis.transient_state import TransientState
from restshape.analysis.velocity_projection import project_velocity
from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.mesh.mesh import Mesh
from restshape.mesh.transfer import transfer
from restshape.shape.outline import Outline


def observed_on(analysis: Analysis, frame: Frame, kept: Analysis, before: object, earlier: bool) -> dict[str, float]:
    """The quantities of a frame on another mesh; none where that mesh has no state to begin with.

    Args:
        analysis: of the frame's scene, that has solved nothing.
        frame: with the other mesh.
        kept: the analysis that has solved the frame on its own mesh.
        before: the state of that one before it did.
        earlier: the mesh has the shape of the frame before: what goes on in time takes no steps on it.

    Raises:
        ReplayProblem: there is no solution on that mesh.
        UserError: likewise.
    """
    analysis.solve(frame)
    if not isinstance(analysis, TransientAnalysis):
        return analysis.observe()
    if not isinstance(before, TransientState) or before.bound is None:
        return {}
    if earlier:
        return _transferred(analysis, before)
    if before.now.y.shape[0] != len(frame.mesh.X):
        return {}
    now = before.now
    analysis.begin(now.y + analysis.problem.boundary.values, now.v, now.time)
    # As after a frame that failed all is read again, the edit's work is accounted for, and the matrix is made.
    solved = kept.state
    assert isinstance(solved, TransientState), "both analyses are of one kind"
    analysis.state = replace(analysis.state, in_time=solved.integration, account=before.account, interrupted=True)
    analysis.solve(replace(frame, changed_cells=np.empty(0, dtype=np.int32)))
    return analysis.observe()


def _transferred(analysis: TransientAnalysis, before: TransientState) -> dict[str, float]:
    """The quantities of a state brought to the analysis's mesh, of its shape; peaks over time steps have none."""
    old, new, now = before.body, analysis.body, before.now
    if not _same_shape(old.problem.space, new.problem.space):
        return {}
    x = transfer(old.problem.space, new.problem.space, old.unknowns(now.y))
    v = project_velocity(old.mass, new.mass, now.v) if before.integration.scheme.order == 2 else np.zeros_like(x)
    analysis.begin(x, v, now.time)
    account = before.account
    if account.known:
        added = analysis.energy() - old.energy(now.y, now.v)
        account = replace(account, remesh=account.remesh + added)
    analysis.state = replace(analysis.state, account=account)
    watched = analysis.state.observer.watched
    return {name: value for name, value in analysis.observe().items() if name not in watched}


def _same_shape(one: object, other: object) -> bool:
    """Whether two meshes lie on one outline."""
    outlines = [_outline(space) for space in (one, other)]
    return outlines[0] is not None and outlines[0] is outlines[1]


def _outline(space: object) -> Outline | None:
    mesh = space.mesh if isinstance(space, LagrangeSpace) else space
    return mesh.outline if isinstance(mesh, Mesh) else None
