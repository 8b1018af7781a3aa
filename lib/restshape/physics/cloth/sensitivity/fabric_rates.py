"""How stiffness and mass of cloth follow a number of a material: by complex steps, which are exact."""

from __future__ import annotations

import numpy as np

from restshape.errors import ReplayProblem
from restshape.mesh.mesh import Mesh
from restshape.physics.cloth.sensitivity.scene_numbers import STEP, ChangingNumber
from restshape.physics.cloth.sheet.cloth_materials import bending, cells_by_sheet, in_pattern_plane, membrane
from restshape.physics.cloth.sheet.fabric import FabricRates


def fabric_rates(number: ChangingNumber, mesh: Mesh) -> FabricRates:
    """The rates on a mesh.

    Raises:
        ReplayProblem: the fabric has no derivative by the number.
    """
    ne = len(mesh.cells)
    found = FabricRates(np.zeros((ne, 3, 3)), np.zeros((ne, 3, 3)), np.zeros(ne))
    for name in number.scene.material:
        stepped = number.stepped(name)
        if stepped is None:
            continue
        for panel, cells in cells_by_sheet(number.scene, mesh, name):
            sheet = in_pattern_plane(number.scene, stepped, panel)
            with np.errstate(all="ignore"):
                found.membrane[cells] = membrane(sheet).imag / STEP
                found.bending[cells] = bending(sheet).imag / STEP
            found.density[cells] = complex(sheet.rho * sheet.thickness).imag / STEP
    if not all(np.isfinite(part).all() for part in (found.membrane, found.bending, found.density)):
        raise ReplayProblem(f"the fabric has no derivative by {number.key} at {number.value:g}")
    return found
