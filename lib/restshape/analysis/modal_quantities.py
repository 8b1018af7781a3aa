"""What a scene asks of modes: frequencies by rank or by number, and the area."""

import numpy as np

from restshape.errors import UserError
from restshape.mesh.mesh import Mesh
from restshape.mesh.space import LagrangeSpace
from restshape.fem.quantity import area
from restshape.scene.model import Quantity


def modal_quantity(
    name: str, quantity: Quantity, mesh: Mesh | LagrangeSpace, frequencies: np.ndarray, numbers: np.ndarray
) -> float:
    """The value of a quantity of interest; not a number of a mode that is not among those computed.

    Args:
        name: of the quantity in the scene.
        quantity: what is asked for.
        mesh: the plane mesh.
        frequencies: (modes,) [Hz], ascending.
        numbers: (modes,) by which they are followed.

    Raises:
        UserError: so many modes are not computed, or modes have no such quantity.
    """
    if quantity.area:
        return area(mesh, mesh.cells_of(quantity.at) if quantity.at else slice(None))
    if quantity.frequency is not None:
        if quantity.frequency > len(frequencies):
            raise UserError(
                f"only {len(frequencies)} modes are computed",
                f"quantities.{name}.frequency",
                f"set effects.modal.modes to {quantity.frequency} or more",
            )
        return float(frequencies[quantity.frequency - 1])
    if quantity.mode is not None:
        at = np.flatnonzero(numbers == quantity.mode)
        return float(frequencies[at[0]]) if len(at) else float("nan")
    raise UserError(
        f"modes have no {quantity.kind}: their size means nothing",
        f"quantities.{name}.{quantity.kind}",
        "ask for frequency = 1, mode = 1 or area = true",
    )
