"""Whether all ranks have been given the same: else each would wait for what another one never does."""

import json
from hashlib import sha256

from petsc4py import PETSc

from restshape.errors import UserError
from restshape.replay.request import Request

SAID = {
    "scene_values": "scene",
    "script_text": "script",
    "calibration": "calibration",
    "petsc_options": "set of PETSc options",
    "restshape": "version of restshape",
}
"""What the ranks have, as messages have it; the rest is the command line."""
FREE = ("machine", "title")
"""What may differ."""


def refuse_unlike(request: Request, comm: PETSc.Comm) -> None:
    """Make sure that all ranks replay the same; collective.

    Raises:
        UserError: a rank has been given something else than rank 0; on all of them.
    """
    if comm.size == 1:
        return
    header = request.header()
    own = {key: _digest(value) for key, value in header.items() if key not in FREE}
    first, *others = comm.tompi4py().allgather(own)
    for rank, other in enumerate(others, 1):
        unlike = [key for key in first if other.get(key) != first[key]]
        if unlike:
            what = SAID.get(unlike[0], f"{unlike[0].replace('_', ' ')} of the command line")
            raise UserError(
                f"rank {rank} has been given another {what} than rank 0",
                request.scene.path.name,
                "start all ranks in one folder that all machines see, with one command line and one installation",
            )


def _digest(value: object) -> str:
    return sha256(json.dumps(value, sort_keys=True, default=str).encode()).hexdigest()
