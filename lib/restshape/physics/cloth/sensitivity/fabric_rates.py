"""How stiffness and mass of cloth follow a number of a material: by complex steps, which are exact."""

from __future__ import annotations

import numpy as np

from restshape.errors import ReplayProblem
from restshape.fem.region_materials import names_by_region
from restshape.mesh.mesh import Mesh
from restshape.physics.cloth.cloth_materials import bending, membrane
from restshape.physics.cloth.fabric import FabricRates
from restshape.physics.cloth.sensitivity.scene_numbers import STEP, ChangingNumber


def fabric_rates(number: ChangingNumber, mesh: Mesh) -> FabricRates:
    """The rates on a mesh.

    Raises:
        ReplayProblem: the fabric has no derivative by the number.
    """
    ne, names = len(mesh.cells), names_by_region(number.scene, mesh)
    found = FabricRates(np.zeros((ne, 3, 3)), np.zeros((ne, 3, 3)), np.zeros(ne))
    for name in number.scene.material:
        stepped = number.stepped(name)
        if stepped is None or name not in names:
            continue
        cells = np.array([one == name for one in names])[mesh.cell_region]
        with np.errstate(all="ignore"):
            found.membrane[cells] = membrane(stepped).imag / STEP
            found.bending[cells] = bending(stepped).imag / STEP
        found.density[cells] = complex(stepped.rho * stepped.thickness).imag / STEP
    if not all(np.isfinite(part).all() for part in (found.membrane, found.bending, found.density)):
        raise ReplayProblem(f"the fabric has no derivative by {number.key} at {number.value:g}")
    return found
