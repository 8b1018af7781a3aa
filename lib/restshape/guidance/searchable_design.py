"""What a search for combinations needs of a design: freedoms, rows of its force space, the full test."""

from typing import Protocol

import numpy as np

from restshape.guidance.force_space import ForceSpace
from restshape.guidance.full_test import FullTest


class Freedoms(Protocol):
    """What may change of a design: changes of its parameters that keep it whole, made dimensionless."""

    def __len__(self) -> int: ...

    def direction(self, modes: np.ndarray, parts: np.ndarray) -> np.ndarray:
        """The change of the design parameters by a combination: numbers of freedoms and their parts (k,)."""

    def names(self, modes: np.ndarray) -> tuple[str, ...]:
        """What freedoms do, in words."""


class SearchableDesign(Protocol):
    """A design that is searched.

    Attributes:
        test: of the design as it is.
        modes: its freedoms.
        parts: that it is made of; a full test takes longer the more there are.
        forceless: flaws, as bits, that are found without forces.
    """

    test: FullTest
    modes: Freedoms
    parts: int
    forceless: int

    def space(self) -> ForceSpace:
        """The force space of the design as it is."""

    def space_after(self, change: np.ndarray) -> ForceSpace | None:
        """The force space of the changed design with the same freedoms; None where it has no forces."""

    def relinearised(self, modes: np.ndarray, start: np.ndarray, wanted: int) -> np.ndarray | None:
        """A valid change (k,) of freedoms that is reached from one that is not, step by step; None: there is none."""
