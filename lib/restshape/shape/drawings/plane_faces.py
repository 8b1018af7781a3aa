"""The plane faces of a STEP file's bodies that are the shape, and their curves in the plane."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from restshape.arrays import Reals
from restshape.errors import UserError
from restshape.outputs.si_numbers import length_unit
from restshape.shape.drawings.geo_model import curves_between, surface_regions
from restshape.shape.drawings.layer_names import name_of
from restshape.shape.drawings.loose_curve import LooseCurves
from restshape.shape.drawings.step_names import knots_in, names_in

FLAT = 1e-6
"""Distance from the plane, over the size of all bodies, and difference of normals, that still count as none."""
UNNAMED = "Open CASCADE STEP translator"
"""How the names of products begin that had none when OpenCASCADE wrote them."""
MM = 1e-3
"""Metres in a unit of OpenCASCADE, which converts by the header of a file."""


@dataclass(frozen=True)
class FacePlane:
    """A plane in space with its own axes.

    Args:
        origin: (3,) what the coordinates in the plane are counted from [mm].
        axes: (2, 3) along x and y in the plane.
        height: of the plane over the origin along its normal [mm].
        words: for a note.
    """

    origin: Reals
    axes: Reals
    height: float
    words: str

    @property
    def normal(self) -> Reals:
        """Unit normal (3,)."""
        return np.cross(self.axes[0], self.axes[1])

    def place(self, xyz: Reals) -> Reals:
        """Coordinates (n, 2) in the plane [m] of points (n, 3) [mm]."""
        return np.ascontiguousarray(MM * (xyz - self.origin) @ self.axes.T)


def step_curves(gmsh: ModuleType, path: Path) -> LooseCurves:
    """The curves around the largest plane face of a STEP file, and around those that lie in its plane, in metres.

    Raises:
        UserError: OpenCASCADE cannot read it, or there is no plane face.
    """
    model = gmsh.model
    try:
        model.occ.importShapes(str(path), highestDimOnly=False)
        model.occ.synchronize()
    # gmsh reports every failure as a bare Exception, so nothing narrower can be caught.
    except Exception as error:
        what = f"OpenCASCADE cannot read it: {str(error).strip() or 'no reason is given'}"
        raise UserError(what, path.name, "save it as STEP AP203, AP214 or AP242 once more") from error
    count = len(model.getEntities(2))
    flat = [s for _, s in model.getEntities(2) if model.getType(2, s) == "Plane"]
    if not flat:
        what = "the file has no plane face" if model.getEntities() else "the file has no body and no face"
        raise UserError(what, path.name, "export a flat part, or one of its faces, from your CAD program")
    size = float(np.ptp(np.reshape(model.getBoundingBox(-1, -1), (2, 3)), axis=0).max())
    plane = _plane(model, _largest(model, flat, size), size)
    chosen = [s for s in flat if _lies_in(model, s, plane, FLAT * size)]
    # A file that has been read is at least mostly ASCII.
    text = path.read_text(encoding="ascii", errors="replace")
    names = _labels(model, chosen) | _labelled(names_in(model, _borders(model, chosen), text))
    if len(chosen) > 1:
        chosen, names = _joined(model, chosen, names)
        names |= _labelled(names_in(model, _borders(model, chosen), text), 1)
    names = {(2, s): f"region{number}" for number, s in enumerate(chosen, start=1)} | names
    faces = _borders(model, chosen)
    knots = knots_in(model, {curve for own in faces.values() for curve in own}, text)
    found = curves_between(model, _outermost(faces), plane.place, names, surface_regions(faces, names), knots)
    note = f"{path.name}: {len(chosen)} of {count} faces, in the plane {plane.words}"
    return LooseCurves(found, notes=(note,))


def _largest(model: Any, flat: list[int], size: float) -> int:
    """The largest of plane faces; of several, as those of a plate, the lowest, whatever rounding says."""
    areas = {s: model.occ.getMass(2, s) for s in flat}
    large = [s for s in flat if areas[s] >= (1.0 - FLAT) * max(areas.values())]
    places = {s: np.rint(_normal_and_point(model, s)[1] / (FLAT * size)) for s in large}
    return min(large, key=lambda s: tuple(places[s][::-1]))


def _joined(
    model: Any, faces: list[int], names: dict[tuple[int, int], str]
) -> tuple[list[int], dict[tuple[int, int], str]]:
    """Copies of faces of one plane that share the curves between them, and their names."""
    copies = model.occ.copy([(2, s) for s in faces])
    _, became = model.occ.fragment(copies[:1], copies[1:])
    model.occ.synchronize()
    found = dict.fromkeys(part for parts in became for part in parts)
    named = {part: names[2, s] for s, parts in zip(faces, became) if (2, s) in names for part in parts}
    return [s for _, s in found], named


def _outermost(faces: dict[int, set[int]]) -> dict[int, set[int]]:
    """Faces without the curves between two of them that no region keeps: those of faces that lie side by side."""
    count: dict[int, int] = {}
    for own in faces.values():
        for curve in own:
            count[curve] = count.get(curve, 0) + 1
    inside = {s for s, own in faces.items() if any(own < other for other in faces.values())}
    kept = {c for s in inside for c in faces[s]}
    return {s: {c for c in own if count[c] == 1 or c in kept} for s, own in faces.items()}


def _normal_and_point(model: Any, surface: int) -> tuple[Reals, Reals]:
    low, high = (np.array(bound) for bound in model.getParametrizationBounds(2, surface))
    middle = (0.5 * (low + high)).tolist()
    return np.array(model.getNormal(surface, middle)), np.array(model.getValue(2, surface, middle))


def _plane(model: Any, surface: int, size: float) -> FacePlane:
    """The plane of a face: x and y are those of space where it is parallel to them, else two of the axes of space.

    Args:
        model: of gmsh; surface: the face.
        size: of all bodies [mm], whose unit words have; places nearer to 0 than `FLAT` of it are 0 in words.
    """
    normal, point = _normal_and_point(model, surface)
    factor, unit = length_unit(MM * size)
    at = [f"{factor * MM * c:.6g}" for c in np.where(np.abs(point) < FLAT * size, 0.0, point)]
    across = int(np.abs(normal).argmax())
    if abs(normal[across]) > 1.0 - FLAT**2:
        first, second = (axis for axis in range(3) if axis != across)
        axes = np.eye(3)[[first, second]]
        return FacePlane(np.zeros(3), axes, float(point @ np.cross(*axes)), f"{'xyz'[across]} = {at[across]} {unit}")
    along = np.cross(np.eye(3)[2], normal)
    along /= np.hypot(*along[:2])
    axes = np.array([along, np.cross(normal, along)])
    towards = [f"{c:.6g}" for c in np.where(np.abs(normal) < FLAT, 0.0, normal)]
    words = f"through ({', '.join(at)}) {unit}, normal ({', '.join(towards)})"
    return FacePlane(point, axes, 0.0, words)


def _lies_in(model: Any, surface: int, plane: FacePlane, near: float) -> bool:
    normal, point = _normal_and_point(model, surface)
    parallel = np.abs(np.cross(normal, plane.normal)).max() < FLAT
    return bool(parallel and abs((point - plane.origin) @ plane.normal - plane.height) < near)


def _borders(model: Any, faces: list[int]) -> dict[int, set[int]]:
    """The curves around each face."""
    return {s: {abs(c) for _, c in model.getBoundary([(2, s)], oriented=False)} for s in faces}


def _labelled(names: dict[tuple[int, int], str], dimension: int | None = None) -> dict[tuple[int, int], str]:
    """Names of a file as those of a scene, of entities of one dimension alone where it is given."""
    found = {entity: name_of(name) for entity, name in names.items() if dimension in (None, entity[0])}
    return {entity: name for entity, name in found.items() if name}


def _labels(model: Any, faces: list[int]) -> dict[tuple[int, int], str]:
    """Names of the products that faces are, by (dimension, entity)."""
    labels = {(2, s): str(model.getEntityName(2, s)).rpartition("/")[2].strip() for s in faces}
    return {entity: name_of(label) for entity, label in labels.items() if label and not label.startswith(UNNAMED)}
