"""What a physics is to the analyses: unknowns on a space, integrals, Dirichlet conditions, quantities."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from restshape.fem.dirichlet import Dirichlet
from restshape.fem.integral import Integral
from restshape.fem.space import Space

INTERNAL, LOADS, MASS, DAMPING = "internal", "loads", "mass", "damping"
"""Kinds of integrals: internal forces (or fluxes) with body loads; dead loads; inertia (or capacity); damping."""


@dataclass(frozen=True)
class Unknown:
    """A field that is solved for.

    Args:
        name: such as "displacement"; recordings show it by this name.
        unit: of its values.
        components: names of the columns, as supports prescribe them.
    """

    name: str
    unit: str
    components: tuple[str, ...]


Fields = tuple[dict[str, np.ndarray], dict[str, np.ndarray]]
"""By name: fields (n, c) of the nodes, fields (ne, c) of the cells."""


class Problem(Protocol):
    """One physics of one scene on one space, from which analyses derive all else.

    Attributes:
        space: nodes and cells of the unknowns, by reference; its nodes may move.
        unknowns: fields of each node, in the order of the columns.
        boundary: prescribed unknowns.
        symmetric: whether every tangent is symmetric; definite: and positive definite where the problem is stable.
        linear: whether the internal integrals are linear in the unknowns.
    """

    space: Space
    unknowns: tuple[Unknown, ...]
    boundary: Dirichlet
    symmetric: bool
    definite: bool
    linear: bool

    def update(self) -> None:
        """Evaluate again what depends on the place of the nodes; nothing where all values are constant."""

    def blocks(self) -> list[np.ndarray]:
        """Entities (m, k) int32 that have a tangent, one array a block of the operator."""

    def integrals(self, kind: str) -> Sequence[Integral]:
        """The integrals of a kind at the present places of the nodes; none where the problem has none of it."""

    def loads(self, out: np.ndarray) -> None:
        """Set `out` (n, f) to the dead loads on points and facets; 0 at prescribed unknowns."""

    def near_null_space(self) -> np.ndarray:
        """A basis (r, n f) of what the internal integrals hardly resist, such as rigid motions; (0, n f) for none."""

    def fields(self, x: np.ndarray) -> Fields:
        """What a recording shows of the unknowns x (n, f)."""
