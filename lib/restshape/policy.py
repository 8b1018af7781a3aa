"""Policies of reuse: which results of the frames before a frame may lean on."""

from dataclasses import dataclass

from restshape.errors import UserError


@dataclass(frozen=True)
class Policy:
    """What a replay keeps from frame to frame.

    Args:
        name: as on the command line.
        summary: one line for people.
        regenerate: a new mesh in every frame that moves.
        solver: method of `algebra.linear.LinearSolver`.
        transfer: transfer the solution to a new mesh as a guess.
        extrapolate: guess along the last two solutions of a drag.
        directions: last increments of the solution along which guesses are improved (`algebra.projection`).
        relocation: relocation of nodes in place of the scene's.
        criterion: distortion criterion in place of the scene's.
        flip_everywhere: level 2 makes the whole mesh Delaunay, not only around low-quality triangles.
        backend: assembly backend, None for the default.
        lumped_mass: modes are those of a mass on the diagonal.
    """

    name: str
    summary: str
    regenerate: bool = False
    solver: str = "stale"
    transfer: bool = True
    extrapolate: bool = True
    directions: int = 0
    relocation: str | None = None
    criterion: str | None = None
    flip_everywhere: bool = False
    backend: str | None = None
    lumped_mass: bool = False


POLICIES = {
    policy.name: policy
    for policy in (
        Policy("rebuild", "a new mesh and all from nothing in each frame", True, "direct", False, False),
        Policy("refactor", "the mesh moves, the factor is rebuilt in each frame", False, "direct", False, False),
        Policy(
            "thesis",
            "two spring sweeps, CG with ILU(3) kept until the mesh is rebuilt",
            solver="ilu",
            transfer=False,
            extrapolate=False,
            relocation="laplacian",
            criterion="author",
            flip_everywhere=True,
            lumped_mass=True,
        ),
        Policy(
            "auto",
            "an old preconditioner, chosen and refreshed as counted work says that it pays",
            solver="auto",
            directions=5,
        ),
    )
}


def policy(name: str) -> Policy:
    """The policy of that name.

    Raises:
        UserError: there is none.
    """
    if name not in POLICIES:
        raise UserError(f"no policy is named {name!r}", "--policy", f"use one of: {', '.join(POLICIES)}")
    return POLICIES[name]
