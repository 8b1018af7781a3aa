"""Policies of reuse: which results of the frames before a frame may lean on, and from where its solves start."""

from dataclasses import dataclass, replace

from restshape.errors import UserError

GUESSES = {
    "zero": "a cold start: unknowns 0, modes and cloth from nothing",
    "same-mesh": "the last solution; a cold start on a new mesh",
    "last": "the last solution, transferred to a new mesh",
    "extrapolated": "along the last solutions of a drag; elsewhere as `last`",
    "projected": "extrapolated, then improved along the last increments where counted work says that it pays",
}
"""Initial guesses of iterative solves, from the plainest to the best: names and what they are."""
DIRECTIONS = 5
"""Last increments of the solution along which a projected guess is improved (`algebra.projection`)."""


@dataclass(frozen=True)
class Policy:
    """What a replay keeps from frame to frame, and the initial guess of its solves.

    Args:
        name: as on the command line.
        summary: one line for people.
        regenerate: a new mesh in every frame that moves.
        solver: method of `algebra.linear.LinearSolver`.
        guess: one of `GUESSES`. A complete factor of a linear problem's own matrix needs none.
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
    guess: str = "projected"
    relocation: str | None = None
    criterion: str | None = None
    flip_everywhere: bool = False
    backend: str | None = None
    lumped_mass: bool = False

    @property
    def warm(self) -> bool:
        """Whether a solve starts from the last solution at all."""
        return self.guess != "zero"

    @property
    def transfer(self) -> bool:
        """Whether the last solution is transferred to a new mesh as a guess."""
        return self.guess in ("last", "extrapolated", "projected")

    @property
    def extrapolate(self) -> bool:
        """Whether the guess goes along the last solutions of a drag."""
        return self.guess in ("extrapolated", "projected")

    @property
    def directions(self) -> int:
        """Increments of the solution along which the guess is improved."""
        return DIRECTIONS if self.guess == "projected" else 0


POLICIES = {
    policy.name: policy
    for policy in (
        Policy("rebuild", "a new mesh, pattern and factor in each frame", True, "direct", "last"),
        Policy("refactor", "the mesh moves, the factor is rebuilt in each frame", False, "direct", "extrapolated"),
        Policy(
            "thesis",
            "two spring sweeps, CG with ILU(3) (flow: Bi-CGSTAB, ILU(0)) kept until the mesh is rebuilt",
            solver="ilu",
            guess="same-mesh",
            relocation="laplacian",
            criterion="author",
            flip_everywhere=True,
            lumped_mass=True,
        ),
        Policy(
            "auto",
            "an old preconditioner, chosen and refreshed as counted work says that it pays",
            solver="auto",
        ),
    )
}


def policy(name: str, guess: str | None = None) -> Policy:
    """The policy of that name, with another initial guess where one is named.

    Raises:
        UserError: there is none.
    """
    if name not in POLICIES:
        raise UserError(f"no policy is named {name!r}", "--policy", f"use one of: {', '.join(POLICIES)}")
    if guess is None:
        return POLICIES[name]
    if guess not in GUESSES:
        raise UserError(f"no initial guess is named {guess!r}", "--guess", f"use one of: {', '.join(GUESSES)}")
    return replace(POLICIES[name], guess=guess)
