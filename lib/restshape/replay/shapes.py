"""Replays of scripts that edit an outline: the session, and the mesh that follows it."""

from collections.abc import Callable
from typing import cast

from mpi4py.util.pkl5 import Intracomm as ArraysApart
from petsc4py import PETSc

from restshape.application import Application
from restshape.errors import ReplayProblem, UserError
from restshape.mesh.mesh import Mesh
from restshape.mesh.moving import MovingMesh
from restshape.mesh.relocate import Harmonic, HarmonicExtension
from restshape.policy import Policy
from restshape.scene.edit_script import Script
from restshape.scene.model import Scene
from restshape.scene.plan import plan
from restshape.shape.session import EditSession


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

    def from_first_rank(make: Callable[[], Mesh]) -> Mesh:
        return _broadcast(comm, make)

    moving = MovingMesh(
        session.outline,
        scene.mesh,
        ranks=comm.size,
        regenerate=policy.regenerate,
        broadcast=from_first_rank if comm.size > 1 else None,
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


def _broadcast(comm: PETSc.Comm, make: Callable[[], Mesh]) -> Mesh:
    """What `make` gives on rank 0, on every rank; its problem, if it has one, is raised on every rank."""
    ranks = ArraysApart(comm.tompi4py())
    outcome: Mesh | ReplayProblem | UserError | None = None
    if ranks.rank == 0:
        try:
            outcome = make()
        except (ReplayProblem, UserError) as problem:
            outcome = problem
    outcome = ranks.bcast(outcome)
    if isinstance(outcome, (ReplayProblem, UserError)):
        raise outcome
    return cast(Mesh, outcome)
