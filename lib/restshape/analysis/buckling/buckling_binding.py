"""The eigenproblem of buckling on the mesh and with the values of a frame, and the last modes on its nodes."""

from dataclasses import replace

import numpy as np

from restshape.algebra.eigenproblems.buckling_solver import BucklingSolver
from restshape.analysis.analysis import Context
from restshape.analysis.buckling.buckling_matrices import BucklingMatrices
from restshape.analysis.buckling.buckling_state import BucklingState
from restshape.analysis.frame import Frame
from restshape.analysis.settings import buckling_settings
from restshape.analysis.static.steady import SteadyState
from restshape.errors import UserError
from restshape.fem.problem import PrestressedProblem
from restshape.first_use import made
from restshape.mesh.transfer import transfer
from restshape.scene.model import Scene


def bound(
    state: BucklingState,
    prebuckling: SteadyState[PrestressedProblem],
    solver: BucklingSolver,
    frame: Frame,
    context: Context,
) -> BucklingState:
    """The state before with matrices and modes on the nodes, and with the supports, of an equilibrium.

    Args:
        state: of the last solution.
        prebuckling: solved on another mesh, or with other values.
        solver: begins a new system with these modes.
        frame: that it was solved for.
        context: what all parts of the replay share.

    Raises:
        UserError: a quantity is a load factor that is not computed.
    """
    new_mesh, mask = prebuckling.space is not state.prebuckling.space, prebuckling.problem.boundary.mask
    _require_computed(frame.scene, buckling_settings(prebuckling.plan).modes)
    solver.tolerance = frame.scene.solve.tolerance
    with context.stages("pattern"):
        if new_mesh:
            matrices = BucklingMatrices(context.comm, prebuckling.problem, context.policy.backend)
        else:
            matrices = made(state.matrices)
            matrices.set_constraints(mask)
    modes = state.modes
    if len(modes.vectors):
        with context.stages("map"):
            vectors = _on_new_mesh(state, frame) if new_mesh else modes.vectors
        modes = replace(modes, vectors=np.where(mask.ravel() == 0, vectors, 0.0))
    known = len(modes.vectors) and context.policy.transfer
    solver.restart(matrices.share.own(modes.vectors) if known else None)
    return replace(state, matrices=matrices, modes=modes)


def flipped(state: BucklingState, solver: BucklingSolver, frame: Frame, context: Context) -> BucklingState:
    """The state before with matrices and modes after flips; arguments as in `bound`."""
    with context.stages("pattern"):
        share = made(state.matrices).share
        made(state.matrices).patch(frame.changed_cells)
        if not frame.interpolations:
            return state

        def interpolated(modes: np.ndarray) -> np.ndarray:
            return np.stack([frame.interpolate(mode.reshape(-1, 2)).ravel() for mode in modes])

        solver.history = [share.own(interpolated(share.whole(block))) for block in solver.history]
        vectors = state.modes.vectors
        vectors = interpolated(vectors) if len(vectors) else vectors
        return replace(state, modes=replace(state.modes, vectors=vectors))


def _on_new_mesh(state: BucklingState, frame: Frame) -> np.ndarray:
    """The last modes (k, 2 n) on a new mesh."""
    modes = state.modes.vectors
    columns = np.concatenate([frame.interpolate(mode.reshape(-1, 2)) for mode in modes], axis=1)
    there = transfer(state.prebuckling.problem.space, frame.mesh, columns).reshape(-1, len(modes), 2)
    return there.transpose(1, 0, 2).reshape(len(modes), -1)


def _require_computed(scene: Scene, modes: int) -> None:
    """Refuse load factors that are not computed."""
    for name, quantity in scene.quantities.items():
        rank = quantity.number("load_factor")
        if rank is not None and rank > modes:
            raise UserError(
                f"only {modes} load factors are computed",
                f"quantities.{name}.load_factor",
                f"set effects.buckling.modes to {rank} or more",
            )
