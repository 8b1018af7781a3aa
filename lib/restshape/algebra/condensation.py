"""The part of a linear system that stays, condensed onto its border: a Schur complement, and what follows the border."""

import numpy as np
import scipy.sparse as sp

from restshape.algebra.interior_factor import interior_factor
from restshape.arrays import Reals
from restshape.errors import ReplayProblem

MOST_DIRECTIONS = 24
"""Directions of the border whose extensions are kept: a drag of one hand has fewer that matter."""
NO_FACTOR = "the part of the body that stays has no factor: part of it is not constrained"


class Condensation:
    """A symmetric, positive definite matrix of unknowns inside, eliminated from those of their border.

    With K = (A C; C^T D), inside first, the border is left with the Schur complement D - C^T A^-1 C. Unknowns inside
    follow those of the border linearly. In a drag these go few ways: what they make of the inside is kept for each, and
    a substitution with the factor is done for ways alone that are new.

    Args:
        matrix: (n + m, n + m), both triangles, the m unknowns of the border last.
        border: m.

    Raises:
        ReplayProblem: A has no factor, or one that memory does not hold.

    Source: R. J. Guyan, AIAA J. 3 (1965) 380; docs/theory/substructures.md.
    """

    def __init__(self, matrix: sp.csr_matrix, border: int) -> None:
        self.count, self.border = matrix.shape[0] - border, border
        own = matrix[self.count :, self.count :].toarray()
        self._beside = sp.csr_matrix(matrix[: self.count, self.count :])
        self._beside_back = sp.csr_matrix(self._beside.T)
        inside = matrix[: self.count, : self.count]
        local = sp.csr_matrix(sp.bmat([[inside, self._beside], [self._beside_back, None]]))
        local.sort_indices()
        self._factor = interior_factor(self.count, border)
        self.complement = own + self._factor.make(local)
        if self._factor.singular or self._factor.negative or not np.isfinite(self.complement).all():
            self.destroy()
            raise ReplayProblem(NO_FACTOR)
        self._ways, self._extensions = np.empty((MOST_DIRECTIONS, border)), np.empty((0, 0))
        self._known = 0

    @property
    def nonzeros(self) -> float:
        """Of the factor."""
        return self._factor.nonzeros

    def alone(self, force: Reals) -> Reals:
        """The unknowns inside (n,) under forces (n,) there, while those of the border are 0."""
        return self._factor.solve(force[None])[0] if self.count else np.zeros(0)

    def on_border(self, alone: Reals) -> Reals:
        """What such unknowns inside (n,) take from the right side (m,) of the border."""
        return np.asarray(self._beside_back @ alone)

    def following(self, at_border: Reals, allowed: float) -> Reals:
        """The unknowns inside (n,) that follow those of the border (m,), without forces.

        Args:
            at_border: of the border.
            allowed: the norm of the forces inside that may be left.
        """
        if not self.count or not np.any(at_border):
            return np.zeros(self.count)
        if self.left(at_border) > allowed:
            rest = self._split(at_border)[1]
            if self._known == MOST_DIRECTIONS:
                self._known, rest = 0, at_border
            self._learn(rest)
        weights = self._split(at_border)[0]
        return weights @ self._extensions[: self._known]

    def left(self, at_border: Reals) -> float:
        """The norm of the forces inside that known ways leave of unknowns (m,) of the border."""
        return float(np.linalg.norm(self._beside @ self._split(at_border)[1]))

    def _split(self, at_border: Reals) -> tuple[Reals, Reals]:
        """The weights (k,) of the known ways in unknowns (m,), and what they leave."""
        ways = self._ways[: self._known]
        weights = ways @ at_border
        rest = at_border - weights @ ways
        # Once more, for what is left may be small.
        again = ways @ rest
        return weights + again, rest - again @ ways

    def _learn(self, way: Reals) -> None:
        """Keep what one more way makes of the inside."""
        if not self._extensions.size:
            self._extensions = np.empty((MOST_DIRECTIONS, self.count))
        k = self._known
        self._ways[k] = way / np.linalg.norm(way)
        self._extensions[k] = -self.alone(self._beside @ self._ways[k])
        self._known += 1

    def destroy(self) -> None:
        """Free the factor."""
        self._factor.destroy()
