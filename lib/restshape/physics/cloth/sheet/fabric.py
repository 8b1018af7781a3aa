"""What cloth is made of."""

from dataclasses import dataclass

import numpy as np

from restshape.scene.pattern_packing import PanelFrame


@dataclass(frozen=True)
class Fabric:
    """Stiffness and mass of cloth.

    Args:
        membrane: (3, 3) or (ne, 3, 3) tensions [N/m] by strains xx, yy and twice xy.
        bending: (3, 3) or (ne, 3, 3) moments [N] by curvatures xx, yy and twice xy [N m].
        density: mass by area [kg/m^2], one or (ne,).
        kind: "morley", "hinge", "nonlinear" (hinges) or "none".
        hinge_factor: of the stiffness of hinges, see `restshape.physics.cloth.sheet.parameters.HINGE_STIFFNESS`.
        law: of the membrane, "stvk" or "corotated".
        frames: where the coordinates of each panel lie in the pattern plane; none of one sheet.
    """

    membrane: np.ndarray
    bending: np.ndarray
    density: float | np.ndarray
    kind: str = "morley"
    hinge_factor: float = 1.0 / 3.0
    law: str = "stvk"
    frames: tuple[PanelFrame, ...] = ()


@dataclass(frozen=True, eq=False)
class FabricRates:
    """Rates of what cloth is made of.

    Args:
        membrane: (ne, 3, 3) [N/m]; bending: (ne, 3, 3) [N m]; density: (ne,) [kg/m^2].
    """

    membrane: np.ndarray
    bending: np.ndarray
    density: np.ndarray
