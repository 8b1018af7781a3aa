"""How many layers of tetrahedra a body gets over its thickness, where the scene names none."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from restshape.physics.elasticity.modal_effect import modal_keys
from restshape.physics.elasticity.stiffness import SHEAR_FACTOR, plane_stress, stiffness_of
from restshape.physics.elasticity.vibrating_materials import common_thickness
from restshape.scene.expressions import Expression
from restshape.scene.model import Scene, ShapeSpec
from restshape.shape.build import outline_from_spec
from restshape.shape.outline import Outline

FLOOR = 0.01
"""Largest share by which the layers may make the highest frequency of bending too high, however fine the triangles."""
PER_WAVE = 4.0
"""Layers over a thickness of one bending wavelength."""
GRID = 24
"""Places in each direction at which a thickness that varies is sampled."""


@dataclass(frozen=True)
class ThicknessLayers:
    """The layers of tetrahedra of a body, and the reason.

    Args:
        count: the number.
        thickness: largest one of the body [m]; wavelength: shortest one of bending that the scene asks for [m].
        shear: share of shear in the compliance of that wave.
    """

    count: int
    thickness: float
    wavelength: float
    shear: float

    @property
    def why(self) -> str:
        """The reason, for people."""
        return (
            f"the thickness is {self.thickness:.3g} m, and the shortest bending wavelength of these modes about "
            f"{self.wavelength:.3g} m"
        )

    def floor(self, layers: int) -> float:
        """By what share so many layers of second order make the highest frequency too high at most."""
        return self.shear * (1.0 - SHEAR_FACTOR) / 2.0 / layers**4


def layers_of(scene: Scene) -> int:
    """The layers that a body of tetrahedra has: those of ``mesh.layers``, or enough for the modes that are asked for.

    It is a matter of the scene alone, not of the shape in a frame: bodies of all frames have the same. Plates, and
    solids in the plane, have one.

    Raises:
        UserError: the shape cannot be read.
    """
    return (scene.mesh.layers or usual_layers(scene).count) if modal_keys(scene).model == "solid" else 1


def usual_layers(scene: Scene, outline: Outline | None = None) -> ThicknessLayers:
    """The layers where the scene names none, on its first outline.

    In one layer of second order the transverse shear strain is linear over the thickness where it should be parabolic:
    bending is as stiff as that of a plate whose shear factor is 1, not 5/6. What that adds to a frequency falls with
    the fourth power of the number of layers.

    Args:
        scene: thickness, materials and modes.
        outline: the first one, where it is known.

    Raises:
        UserError: the shape cannot be read.

    Source: docs/theory/free-vibrations.md.
    """
    outline = outline or _outline(scene)
    area, perimeter = _size(outline)
    modes = modal_keys(scene).modes
    # Weyl's law with its second term, of free sides: the modes below a wave number k are A k^2 / 4 pi + P k / 4 pi.
    k = (math.hypot(perimeter, 4.0 * math.sqrt(math.pi * area * (modes + 1))) - perimeter) / (2.0 * area)
    if scene.supports:
        k = math.sqrt(4.0 * math.pi * (modes + 1) / area)
    thickness = _largest_thickness(scene, outline)
    share = max(_compliance(stiffness_of(one)) for one in scene.material.values()) * (k * thickness) ** 2
    found = ThicknessLayers(1, thickness, 2.0 * math.pi / k, share / (1.0 + share))
    count = max(1, math.ceil(PER_WAVE * thickness / found.wavelength))
    while found.floor(count) > FLOOR:
        count += 1
    return ThicknessLayers(count, thickness, found.wavelength, found.shear)


def _compliance(C: np.ndarray) -> float:
    """Of shear over that of bending, for a wave number and a thickness of 1, of a stiffness C (6, 6) [Pa]."""
    shear = float(np.linalg.eigvalsh(C[3:5, 3:5])[0])
    return float(np.diag(plane_stress(C))[:2].max()) / (12.0 * SHEAR_FACTOR * shear)


def _largest_thickness(scene: Scene, outline: Outline) -> float:
    """The largest thickness [m] on an outline."""
    value = common_thickness(scene)
    if not isinstance(value, Expression):
        return float(value)
    low, high = outline.bounds()
    x, y = np.meshgrid(*np.linspace(low, high, GRID).T)
    found = np.broadcast_to(value.evaluate(x, y, scene.parameters), x.shape)
    return float(found[np.isfinite(found)].max(initial=0.0))


def _size(outline: Outline) -> tuple[float, float]:
    """Area [m^2] and length of all sides [m]."""
    free = {edge for loop in outline.loops if loop.kind != "region" for edge, _ in loop.edges}
    return float(outline.area()), float(sum(outline.length(edge) for edge in free))


def _outline(scene: Scene) -> Outline:
    """The first outline of a scene."""
    file = scene.mesh.file or scene.shape.file
    written = (scene.folder / file).stat().st_mtime_ns if file and (scene.folder / file).is_file() else 0
    shape = json.dumps(scene.shape.model_dump(exclude_unset=True))
    return _read(str(scene.folder), shape, scene.mesh.file or "", scene.mesh.unit, written)


@lru_cache(maxsize=16)
def _read(folder: str, shape: str, mesh_file: str, unit: float, _written: int) -> Outline:
    """The outline of the tables of a shape, or of a mesh file, that were written at a time."""
    if mesh_file:
        from restshape.mesh.importer import read_mesh

        return read_mesh(Path(folder) / mesh_file, unit)[1]
    return outline_from_spec(ShapeSpec.model_validate(json.loads(shape)), folder)
