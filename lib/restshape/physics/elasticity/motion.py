"""Quantities of interest of a solid that moves: beside those at rest its energies, and peaks over time steps."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from restshape.errors import UserError
from restshape.physics.elasticity.dynamics import Inertia
from restshape.physics.elasticity.quantities import Observer
from restshape.physics.elasticity.plane_solid import PlaneSolid
from restshape.scene.model import Quantity


@dataclass
class Motion:
    """What moves, kept by reference.

    Args:
        v: (n, 2) velocities relative to the ground [m/s].
        edit: work of all edits so far [J].
        remesh: energy that carrying the motion to new meshes has added so far [J].
    """

    v: np.ndarray
    edit: float = 0.0
    remesh: float = 0.0


class MotionObserver(Observer):
    """Evaluates the quantities of a scene in which a solid moves.

    Args:
        physics: the solid, on the mesh whose nodes are looked at.
        inertia: its mass.
        motion: the velocities, and what the edits did.
        quantities: by name, as in the scene.

    Raises:
        UserError: a quantity names a place where it has no meaning.
    """

    def __init__(self, physics: PlaneSolid, inertia: Inertia, motion: Motion, quantities: dict[str, Quantity]) -> None:
        self.inertia, self.motion = inertia, motion
        super().__init__(physics, quantities)
        self.watched = {name: self.functions[name] for name, q in quantities.items() if q.take == "peak"}
        self.peaks: dict[str, float] = {}
        for name in self.watched:
            self.functions[name] = self._peak(name)

    def begin(self) -> None:
        """Forget the peaks: a new frame begins."""
        self.peaks.clear()

    def step(self, x: np.ndarray) -> None:
        """Take in the displacement x (n, 2) [m] after a time step."""
        self._nodal = None
        for name, function in self.watched.items():
            self.peaks[name] = max(self.peaks.get(name, 0.0), abs(float(function(x))))

    def _peak(self, name: str) -> Callable[[np.ndarray], float]:
        def value(x: np.ndarray) -> float:
            if name not in self.peaks:
                self.peaks[name] = abs(float(self.watched[name](x)))
            return self.peaks[name]

        return value

    def _energy(self, name: str, kind: str, cells: np.ndarray | slice) -> Callable[[np.ndarray], float]:
        """The energy of that kind in the cells; what edits and new meshes did is known of the whole body only."""
        motion, strain, kinetic = self.motion, self.physics.energies, self.inertia.energies
        if kind in ("edit", "remesh") and not isinstance(cells, slice):
            raise UserError(f"{kind!r} energy is that of the whole body", f"quantities.{name}.at", "leave `at` out")
        return {
            "strain": lambda x: strain(x)[cells].sum(),
            "kinetic": lambda x: kinetic(motion.v)[cells].sum(),
            "total": lambda x: strain(x)[cells].sum() + kinetic(motion.v)[cells].sum(),
            "edit": lambda x: motion.edit,
            "remesh": lambda x: motion.remesh,
        }[kind]
