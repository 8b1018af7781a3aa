"""Stiffness and mass of cloth, as a scene gives them on one mesh."""

from __future__ import annotations

import numpy as np

from restshape.fem.region_materials import names_by_region, require_value
from restshape.mesh.mesh import Mesh
from restshape.physics.cloth.sheet.fabric import Fabric
from restshape.physics.cloth.sheet.parameters import HINGE_STIFFNESS
from restshape.physics.elasticity.stiffness import PLANE, isotropic, orthotropic, plane_stress, turned
from restshape.scene.model import Material, Scene
from restshape.scene.panels import Panel, frames_of, panels_of
from restshape.scene.plan import Plan


def fabric_of(scene: Scene, plan: Plan, mesh: Mesh) -> Fabric:
    """Stiffness and mass of a scene's cloth.

    Raises:
        UserError: a part of the cloth has no material, or it weighs nothing while gravity is on.
    """
    settings = plan.settings("cloth")
    _check_weight(scene, plan)
    used, row = sheets_of(scene, mesh)
    sheets = [(membrane(m), bending(m), m.rho * m.thickness) for m in used]
    stretch, bend, density = (column[0] if len(used) == 1 else np.array(column)[row] for column in zip(*sheets))
    return Fabric(
        membrane=stretch,
        bending=bend,
        density=density,
        kind=settings.bending,
        hinge_factor=HINGE_STIFFNESS[settings.hinges],
        law=settings.membrane,
        frames=tuple(frames_of(scene).values()),
    )


def sheets_of(scene: Scene, mesh: Mesh) -> tuple[list[Material], np.ndarray]:
    """Materials of a scene's cloth as they lie in the pattern plane, and the number (ne,) of each triangle's.

    Those of panels are turned with them, and have their grain.
    """
    sheets, row = _named_sheets(scene, mesh)
    return [in_pattern_plane(scene, scene.material[name], panel) for name, panel in sheets], row


def cells_by_sheet(scene: Scene, mesh: Mesh, name: str) -> list[tuple[str | None, np.ndarray]]:
    """Panels in which there is cloth of a material, and its triangles (ne,) bool there; None in place of one sheet."""
    sheets, row = _named_sheets(scene, mesh)
    return [(panel, row == k) for k, (own, panel) in enumerate(sheets) if own == name]


def in_pattern_plane(scene: Scene, material: Material, panel: str | None) -> Material:
    """A material as it lies in the pattern plane: that of a panel is turned with it, and has its grain."""
    if panel is None:
        return material
    given = panels_of(scene)[panel].grain
    grain = material.grain if given is None else given
    return material.model_copy(update={"grain": grain + frames_of(scene)[panel].angle})


def _named_sheets(scene: Scene, mesh: Mesh) -> tuple[list[tuple[str, str | None]], np.ndarray]:
    """Names of materials, each with the panel that it is of, and the number (ne,) of each triangle's."""
    names = names_by_region(scene, mesh)
    panels = panels_of(scene)
    if not panels:
        used = [name for name in scene.material if name in names]
        row = np.array([used.index(name) if name else -1 for name in names])[mesh.cell_region]
        return [(name, None) for name in used], row
    pairs = np.stack([mesh.cell_region, mesh.cell_piece], axis=1)
    kinds, row = np.unique(pairs, axis=0, return_inverse=True)
    found: list[tuple[str, str | None]] = []
    for region, piece in kinds.tolist():
        panel = mesh.outline.piece_names[piece]
        found.append((_of_panel(scene, panels[panel], names[region]), panel))
    return found, row.ravel()


def _of_panel(scene: Scene, panel: Panel, name: str | None) -> str:
    """The material of triangles of a panel: that of a region of theirs, else the panel's own, else what none names.

    Args:
        scene: of cloth.
        panel: that they are of.
        name: of the material of their region, or of the rest.
    """
    if name is not None and scene.material[name].region:
        return name
    named = {one.material for one in panels_of(scene).values()}
    rest = next((one for one, m in scene.material.items() if not m.region and one not in named), name)
    return str(panel.material or rest)


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
