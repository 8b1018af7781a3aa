"""A piece of furniture as a search for combinations sees it."""

from collections.abc import Callable

import numpy as np
from restshape_apps.furniture.guidance.relinearised import relinearised
from restshape_apps.furniture.physics.furniture import LOST, OVERLAPPING, UNSTABLE, Furniture
from restshape_apps.furniture.shape.design_modes import DesignModes

from restshape.guidance.force_space import ForceSpace


class SearchablePiece:
    """A piece with what may change.

    Args:
        furniture: its model.
        modes: what may change.
        forces: what makes the force space of a piece.
    """

    forceless = LOST | OVERLAPPING | UNSTABLE

    def __init__(
        self, furniture: Furniture, modes: DesignModes, forces: Callable[[Furniture, DesignModes], ForceSpace]
    ) -> None:
        self.furniture, self.modes, self.forces = furniture, modes, forces
        self.test, self.parts = furniture.kernel, furniture.count

    def space(self) -> ForceSpace:
        """The force space of the piece as it is."""
        self.furniture.test()
        return self.forces(self.furniture, self.modes)

    def space_after(self, change: np.ndarray) -> ForceSpace | None:
        """The force space of the moved piece; None where joints are lost or planks overlap."""
        if self.furniture.test(change, LOST | OVERLAPPING).flaws & (LOST | OVERLAPPING):
            return None
        moved = Furniture(self.furniture.moved(change), self.furniture.compliance)
        moved.test()
        return self.forces(moved, self.modes.after(change, moved.piece))

    def relinearised(self, modes: np.ndarray, start: np.ndarray, wanted: int) -> np.ndarray | None:
        """A valid change (k,) of modes from one that is not; None: there is none."""
        return relinearised(self.furniture, self.modes, modes, start, wanted)
