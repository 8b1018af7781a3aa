"""Steps with an old factor alone beside Newton's: how many residuals each equilibrium of a replay takes.

python scripts/chords.py SCENE EDITS [AGE]

Each moved frame of the replay, of large deformation, is also solved with the complete factor of a frame up to AGE (10)
frames before, from the guess that Newton's method starts from, until the same residual is met: by chord steps; by the
same accelerated by Anderson's method; and by that with the differences of the last frames kept. Printed are residuals
a frame (mean, median), beside Newton's steps and iterations with an old factor.
"""

import sys
from collections.abc import Callable
from statistics import mean, median

import numpy as np
from petsc4py import PETSc

from restshape.analysis.static.equilibrium_search import EquilibriumSearch
from restshape.interface.run import Run
from restshape.replay.request import Request
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene

MOST = 40
"""Residuals after which a way is given up."""
KEPT = 10
"""Differences of the last frames that are kept."""
Pairs = list[tuple[np.ndarray, np.ndarray]]


def factor(mat: PETSc.Mat) -> Callable[[np.ndarray], np.ndarray]:
    """The function that solves with a complete factor of a matrix."""
    ksp = PETSc.KSP().create(PETSc.COMM_SELF)
    ksp.setType("preonly")
    ksp.getPC().setType("lu")
    ksp.setOperators(mat.copy())
    b, x = mat.createVecRight(), mat.createVecRight()

    def solve(right: np.ndarray) -> np.ndarray:
        b.setArray(right)
        ksp.solve(b, x)
        return x.getArray().copy()

    return solve


def residuals(
    residual: Callable[[np.ndarray], np.ndarray],
    solve: Callable[[np.ndarray], np.ndarray],
    x: np.ndarray,
    goal: float,
    pairs: Pairs,
    accelerated: bool,
) -> tuple[int, Pairs]:
    """Residuals until one has the norm `goal`, and the differences of unknowns and residuals of all steps."""
    r, count, pairs = residual(x), 1, list(pairs)
    while np.linalg.norm(r) > goal and count < MOST:
        step = np.zeros_like(r)
        left = r
        if accelerated and pairs:
            steps, changes = (np.array(part).T for part in zip(*pairs))
            weights = np.linalg.lstsq(changes, r, rcond=1e-8)[0]
            step, left = -steps @ weights, r - changes @ weights
        step = step - solve(left)
        x = x + step
        after = residual(x)
        pairs.append((step, after - r))
        r, count = after, count + 1
        if not np.isfinite(r).all():
            return MOST, pairs
    return count, pairs


class Watched(EquilibriumSearch):
    """A search whose equilibria are found in the other ways first."""

    age, oldest = 0, 10
    solve: Callable[[np.ndarray], np.ndarray] | None = None
    kept: Pairs = []
    rows: list[tuple[int, ...]] = []

    def find(self, guess, start, near):  # type: ignore[no-untyped-def]
        """As `EquilibriumSearch.find`."""
        x, cls = guess.copy(), type(self)
        self.problem.boundary.apply(x)
        goal, counts = self.goal() * self._scale(x), []

        def residual(flat: np.ndarray) -> np.ndarray:
            out = np.empty_like(x)
            self.equations.residual(flat.reshape(x.shape), out)
            return out.ravel()

        if near and cls.solve:
            for pairs, accelerated in (([], False), ([], True), (cls.kept, True)):
                count, found = residuals(residual, cls.solve, x.ravel(), goal, pairs, accelerated)
                counts.append(count)
            cls.kept = found[-KEPT:]
        outcome, x = super().find(guess, start, near)
        if counts:
            cls.rows.append((*counts, outcome.newton, outcome.iterations))
        if not near or cls.solve is None or cls.age >= cls.oldest:
            cls.solve, cls.age = factor(self.newton.tangent(x)), 0
        cls.age += 1
        return outcome, x


def main(words: list[str]) -> None:
    """Replay and print."""
    import restshape.analysis.static.nonlinear as nonlinear

    nonlinear.EquilibriumSearch = Watched  # type: ignore[misc]
    Watched.oldest = int(words[2]) if len(words) > 2 else Watched.oldest
    scene = load_scene(words[0], ("solve.jumps=false",))
    asked = Request.of(scene, load_script(words[1], scene), "auto")
    for _ in Run(asked, summed=False):
        pass
    names = ("chord", "Anderson", "Anderson, kept differences", "Newton's steps", "iterations of these")
    print(f"{len(Watched.rows)} frames")
    for name, column in zip(names, zip(*Watched.rows)):
        lost = column.count(MOST)
        print(f"{name:28} mean {mean(column):5.1f}, median {median(column):4.0f}" + (f", {lost} lost" if lost else ""))


if __name__ == "__main__":
    main(sys.argv[1:])
