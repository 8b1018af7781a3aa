"""A vibrating body on the mesh and with the values of a frame, and the last modes on its nodes."""

from dataclasses import replace

import numpy as np

from restshape.algebra.eigenproblems.eigen import EigenSolver
from restshape.algebra.stages import Stages
from restshape.analysis.analysis import Context
from restshape.analysis.frame import Frame
from restshape.analysis.modal.modal_matrices import ModalMatrices
from restshape.analysis.modal.modal_output import observer
from restshape.analysis.modal.modal_state import BoundBody, ModalState
from restshape.analysis.settings import modal_settings
from restshape.application import application_of
from restshape.fem.eigenproblem import Eigenproblem, Maker
from restshape.mesh.transfer import transfer
from restshape.scene.plan import plan as planned


def bound(
    state: ModalState, solver: EigenSolver, frame: Frame, context: Context, make: Maker
) -> tuple[ModalState, np.ndarray]:
    """The state with a new body, and the last modes (k, n f) on its nodes; none where they are of another kind.

    Args:
        state: of the last solution.
        solver: begins a new system with these modes.
        frame: with another mesh, or other values.
        context: what all parts of the replay share.
        make: makes the body.

    Raises:
        UserError: the scene makes no sense for a vibrating body.
    """
    old, before = state.bound, state.modes.vectors
    with context.stages("pattern"):
        known = frame.scene is state.scene
        plan = state.plan if known else planned(frame.scene, application_of(frame.scene))
        body = make(frame.scene, plan, frame.mesh, context.policy.lumped_mass)
        # Flips change the cells in place: of the old ones nothing is left to compare with.
        flipped = frame.mesh.topology != state.topology
        same = old if frame.mesh is state.space and not flipped and not state.interrupted else None
        matrices = ModalMatrices(context.comm, body, before=same.matrices if same else None)
    solver.tolerance = frame.scene.solve.tolerance
    mask = body.boundary.mask
    interpolated = np.empty((0, mask.size))
    if old is not None and old.body.axes == body.axes:
        with context.stages("map"):
            interpolated = _on_new_mesh(old.body, before, frame) if frame.mesh is not state.space else before
        if interpolated.shape[1] != mask.size:
            interpolated = np.empty((0, mask.size))
    guess, older = interpolated, solver.history[1:] if same and matrices.operators is same.matrices.operators else []
    if same and len(guess):
        interpolated = body.taken_over(guess, same.body)
    # On the same nodes modes of older frames serve, too: a value that goes on as before moves modes as before. Where
    # the body knows how they go, older ones cost more than they save.
    older = older if interpolated is guess else []
    free = mask.ravel() == 0
    interpolated = np.where(free, interpolated, 0.0)
    share = matrices.share
    solver.restart(share.own(interpolated) if len(interpolated) and context.policy.transfer else None)
    solver.history += [np.where(free[share.unknowns], block, 0.0) for block in older if solver.history]
    settings = modal_settings(plan)
    found = observer(frame.scene.quantities, frame.mesh, settings)
    body_bound = BoundBody(body, matrices, found)
    return replace(state, plan=plan, bound=body_bound, count=max(state.count, settings.modes)), interpolated


def followed(state: ModalState, solver: EigenSolver, frame: Frame, stages: Stages) -> np.ndarray:
    """The last modes (k, n f) on the plane mesh of a frame, whose nodes have moved and whose edges may have flipped.

    Args:
        state: of the last solution, or a prediction; its body and matrices go along.
        solver: its modes of the last frames go along.
        frame: on the same mesh.
        stages: takes the time of each stage.
    """
    body, modes, share = state.body, state.modes.vectors, state.matrices.share
    flipped = frame.mesh.topology != state.topology
    with stages("relocate"):
        changed = body.follow(frame.changed_cells if flipped else np.empty(0, dtype=np.int32))
    if flipped:
        with stages("pattern"):
            state.matrices.patch(changed)
            if frame.interpolations:
                modes = _interpolated(body, modes, frame)
                whole = map(share.whole, solver.history)
                solver.history = [share.own(_interpolated(body, block, frame)) for block in whole]
    if state.predicted:
        solver.history = [share.own(modes), *solver.history]
    return modes


def _interpolated(body: Eigenproblem, modes: np.ndarray, frame: Frame) -> np.ndarray:
    """Modes (k, n f) at the new places of nodes of flipped edges."""
    fields = [body.space.interpolate(mode.reshape(-1, len(body.axes)), frame.interpolations) for mode in modes]
    return np.stack(fields).reshape(modes.shape)


def _on_new_mesh(old: Eigenproblem, modes: np.ndarray, frame: Frame) -> np.ndarray:
    """Modes (k, n f) of an old body on a new mesh, column by column."""
    n, fields = len(old.plane.X), [mode.reshape(-1, len(old.axes)) for mode in modes]
    shapes = [old.by_plane_nodes(old.space.interpolate(field, frame.interpolations)).reshape(n, -1) for field in fields]
    there = transfer(old.plane, frame.mesh, np.concatenate(shapes, axis=1))
    there = there.reshape(len(frame.mesh.X), len(modes), -1)
    return np.ascontiguousarray(there.transpose(1, 0, 2)).reshape(len(modes), -1)
