"""Replays of scripts that edit an outline: the session, and the mesh that follows it."""

from collections.abc import Callable, Sequence
from typing import TypeVar, cast

from mpi4py.util.pkl5 import Intracomm as ArraysApart
from petsc4py import PETSc

from restshape.application import Application
from restshape.errors import ReplayProblem, UserError
from restshape.mesh.generate import alone
from restshape.mesh.moving import MovingMesh
from restshape.mesh.relocate import Harmonic, HarmonicExtension
from restshape.policy import Policy
from restshape.scene.edit_script import Script
from restshape.scene.model import Scene
from restshape.scene.plan import plan
from restshape.shape.session import EditSession

T = TypeVar("T")


def replayed_shape(
    scene: Scene, script: Script, application: Application, policy: Policy, comm: PETSc.Comm
) -> tuple[EditSession, MovingMesh]:
    """The session of a script, and the mesh that follows its shapes.

    Args:
        scene: where it starts; script: its edits; application: of the scene.
        policy: what is reused from mesh to mesh.
        comm: whose ranks share the mesh, which the first one generates.

    Raises:
        UserError: the scene's shape, or the mesh that it imports, is not valid.
    """
    imported, outline = None, None
    if scene.mesh.file is not None:
        from restshape.mesh.importer import read_mesh

        imported, outline = read_mesh(scene.folder / scene.mesh.file, scene.mesh.unit, ranks=comm.size)
    session = EditSession(scene, script, application, outline)

    def shared(*makes: Callable[[], T]) -> list[T]:
        return _shared(comm, makes)

    moving = MovingMesh(
        session.outline,
        scene.mesh,
        ranks=comm.size,
        regenerate=policy.regenerate,
        shared=shared if comm.size > 1 else alone,
        relocation=policy.relocation,
        criterion=policy.criterion,
        flip_everywhere=policy.flip_everywhere,
        imported=imported,
        order_of=lambda scene: plan(scene, application).order,
        harmonic=_harmonic_on(comm) if comm.size > 1 else HarmonicExtension,
    )
    return session, moving


def _harmonic_on(comm: PETSc.Comm) -> Harmonic:
    """What makes harmonic maps on several ranks."""
    from restshape.mesh.shared_extension import harmonic_on

    return harmonic_on(comm.tompi4py())


def _shared(comm: PETSc.Comm, makes: Sequence[Callable[[], T]]) -> list[T]:
    """What each function gives on a rank of its own, as far as there are, on every rank; likewise the first problem."""
    ranks = ArraysApart(comm.tompi4py())
    outcomes: list[object] = [None] * len(makes)
    for k in range(ranks.rank, len(makes), ranks.size):
        try:
            outcomes[k] = makes[k]()
        except (ReplayProblem, UserError) as problem:
            outcomes[k] = problem
    outcomes = [ranks.bcast(outcome, k % ranks.size) for k, outcome in enumerate(outcomes)]
    for outcome in outcomes:
        if isinstance(outcome, (ReplayProblem, UserError)):
            raise outcome
    return cast("list[T]", outcomes)
