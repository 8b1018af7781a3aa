"""The frame loop of what is replayed: it is made here alone, for simulations and for runs."""

from petsc4py import PETSc

from restshape.replay.loop import Replay
from restshape.replay.petsc_options import refusal
from restshape.replay.recording.recorder import Recorder
from restshape.replay.request import Request


def frame_loop(request: Request, recorder: Recorder | None = None, comm: PETSc.Comm | None = None) -> Replay:
    """The frame loop, before the first frame.

    Args:
        request: what is replayed; recorder: takes each frame; on rank 0 only.
        comm: whose ranks share the work; None: PETSc's world.

    Raises:
        UserError: the scene cannot be simulated, or not be predicted.
    """
    try:
        return Replay(request, comm or PETSc.COMM_WORLD, recorder)
    except PETSc.Error as error:
        if not request.petsc:
            raise
        raise refusal(error, request.petsc) from error
