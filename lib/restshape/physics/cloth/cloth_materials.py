"""Stiffness and mass of cloth, as a scene gives them on one mesh."""

from __future__ import annotations

import numpy as np

from restshape.fem.region_materials import names_by_region, require_value
from restshape.mesh.mesh import Mesh
from restshape.physics.cloth.fabric import Fabric
from restshape.physics.cloth.parameters import HINGE_STIFFNESS
from restshape.physics.elasticity.stiffness import PLANE, isotropic, orthotropic, plane_stress, turned
from restshape.scene.model import Material, Scene
from restshape.scene.plan import Plan


def fabric_of(scene: Scene, plan: Plan, mesh: Mesh) -> Fabric:
    """Stiffness and mass of a scene's cloth.

    Raises:
        UserError: a part of the cloth has no material, or it weighs nothing while gravity is on.
    """
    settings = plan.settings("cloth")
    names = names_by_region(scene, mesh)
    _check_weight(scene, plan)
    used = [name for name in scene.material if name in names]
    sheets = [(membrane(m), bending(m), m.rho * m.thickness) for m in map(scene.material.get, used)]
    row = np.array([used.index(name) if name else -1 for name in names])[mesh.cell_region]
    stretch, bend, density = (column[0] if len(used) == 1 else np.array(column)[row] for column in zip(*sheets))
    return Fabric(
        membrane=stretch,
        bending=bend,
        density=density,
        kind=settings.bending,
        hinge_factor=HINGE_STIFFNESS[settings.hinges],
        law=settings.membrane,
    )


def membrane(material: Material) -> np.ndarray:
    """Tensions (3, 3) [N/m] of xx, yy and xy by strains xx, yy and twice xy: plane stress times thickness."""
    return _in_plane(_along_grain(material) * material.thickness, material.grain)


def bending(material: Material) -> np.ndarray:
    """Moments (3, 3) [N] of xx, yy and xy by curvatures xx, yy and twice xy [N m].

    Of a plate it is plane stress times thickness^3/12. A stiffness of its own scales that: along the grain, or along
    and across it, with the coupling and the twist in between by the geometric mean.
    """
    plate = _along_grain(material) * material.thickness**3 / 12.0
    if material.bending is not None:
        along, across = np.broadcast_to(material.bending, 2)
        if not isinstance(material.bending, tuple):
            across = along * plate[1, 1] / plate[0, 0]
        a, b = np.sqrt(along / plate[0, 0]), np.sqrt(across / plate[1, 1])
        # A congruence: what is positive definite stays so.
        scale = np.array([a, b, np.sqrt(a * b)])
        plate = scale[:, None] * plate * scale
    return _in_plane(plate, material.grain)


def _along_grain(material: Material) -> np.ndarray:
    """Plane stress (3, 3) [Pa] in the axes of the grain."""
    if material.orthotropic is None:
        return plane_stress(isotropic(material.E, material.nu))
    constants = material.orthotropic
    return plane_stress(orthotropic(constants.E, constants.nu, constants.G))


def _in_plane(stiffness: np.ndarray, grain: float) -> np.ndarray:
    """A stiffness (3, 3) in the axes x, y, of that in the axes of the grain, which is turned by an angle [rad]."""
    if grain == 0.0:
        return stiffness
    whole = np.zeros((6, 6), stiffness.dtype)
    whole[np.ix_(PLANE, PLANE)] = stiffness
    return turned(whole, grain)[np.ix_(PLANE, PLANE)]


def _check_weight(scene: Scene, plan: Plan) -> None:
    """Refuse gravity on a material without density."""
    if plan.on("gravity") and np.any(plan.settings("gravity").g):
        do = 'give it one, e.g. rho = "400 kg/m^3", or leave out [effects.gravity]'
        require_value(scene, "rho", "gravity is on, but the material has no density", do)
