"""Bodies of triangles: their grids of distances, and where their triangles are."""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from restshape import _kernels
from restshape.errors import UserError
from restshape.mesh.surface_distance import DistanceFacts, SurfaceDistance, distance_of_file
from restshape.physics.cloth.mannequin.growth import mannequin_distance
from restshape.scene.bodies import MannequinBody, MeshBody
from restshape.scene.model import Scene
from restshape.scene.physics import Inspection
from restshape.shape.placement import rotation

ERROR = 0.5e-3
"""Error of a distance above which `restshape check` warns [m]."""


def distance_of(form: MeshBody | MannequinBody) -> SurfaceDistance:
    """The distance from a body's surface in its own coordinates.

    Raises:
        UserError: its file holds no closed surface, or no body has its sizes.
    """
    if isinstance(form, MannequinBody):
        return mannequin_distance(form.sizes, form.size, form.spacing, form.band)
    return distance_of_file(form.file.path, form.unit, form.spacing, form.band)


def located_distance(scene: Scene, name: str) -> SurfaceDistance:
    """The same of a body of a scene; an error names its key.

    Raises:
        UserError: its file holds no closed surface.
    """
    body = scene.bodies[name]
    try:
        return distance_of(body.evaluated(scene.parameters).form)
    except UserError as error:
        key, of = ("mesh.file", f"{body.form.file}: ") if body.kind == "mesh" else ("mannequin", "")
        raise scene.located(UserError(f"{of}{error.what}", f"bodies.{name}.{key}", error.do)) from error


def kernel_mesh(form: MeshBody | MannequinBody) -> _kernels.Body:
    """The body of numbers as the kernels take it."""
    return _kernels.Body.mesh(distance_of(form).grid, form.move, rotation(form.turn).T, form.scale)


def placed_surface(form: MeshBody | MannequinBody, X: np.ndarray) -> np.ndarray:
    """Corners (n, 3) [m] of a body of numbers where it is; X (n, 3) are those of its own coordinates [m]."""
    return form.scale * X @ rotation(form.turn).T + form.move


def recorded_surfaces(scene: Scene) -> dict[str, object]:
    """The surfaces of bodies, by name, that the header of a recording holds: a report reads no other file."""
    found = {}
    for name, body in scene.bodies.items():
        if body.kind == "mesh":
            own = located_distance(scene, name)
            found[name] = {"X": own.X.round(6).tolist(), "cells": own.cells.tolist()}
    return {"surfaces": found} if found else {}


def reach_of(form: MeshBody | MannequinBody) -> float:
    """How far the body reaches from its file's origin, before it is made larger [m]."""
    return float(np.linalg.norm(distance_of(form).X, axis=1).max())


def refuse_narrow(scene: Scene, thickness: float) -> None:
    """Refuses contact that begins beyond the band of a body [m].

    Raises:
        UserError: which body's.
    """
    for name, body in scene.bodies.items():
        if not body.form_on_grid:
            continue
        form = body.evaluated(scene.parameters).form
        band = form.scale * located_distance(scene, name).facts.band
        if thickness > band:
            what = (
                f"contact begins {1e3 * thickness:.3g} mm from a body whose distance is known within {1e3 * band:.3g}"
            )
            do = f'write band = "{1e3 * 2.0 * thickness / form.scale:.3g} mm", or a smaller effects.contact.thickness'
            raise scene.located(UserError(f"{what} mm", f"bodies.{name}.{body.kind}", do))


@dataclass(frozen=True)
class MeshWords:
    """A body's surface for people.

    Args:
        facts: of its grid; scale: of the body; from_file: it is one of a file.
    """

    facts: DistanceFacts
    scale: float
    from_file: bool = True

    def __str__(self) -> str:
        facts, scale = self.facts, 1e3 * self.scale
        guessed = ", guessed from its size" if facts.guessed else ""
        unit = f" in units of {facts.unit:g} m{guessed}" if self.from_file else ""
        parts = [f"{facts.triangles} triangles{unit}", self._holes()]
        parts += ["triangles that look inwards are turned over"] if facts.turned else []
        parts += [
            f"distance on {scale * facts.spacing:.3g} mm in a band of {scale * facts.band:.3g} mm, wrong by "
            f"{scale * facts.error:.2g} mm at most away from the medial axis, {facts.stored / 1e6:.3g} MB"
        ]
        return ", ".join(parts)

    def _holes(self) -> str:
        holes = self.facts.holes
        if not holes:
            return "no holes"
        where = ", ".join(f"{self.scale * value:.3g}" for value in holes[0].center)
        widest = f"the widest of {1e3 * self.scale * holes[0].width:.3g} mm about ({where}) m of its own"
        return f"{len(holes)} hole{'s' * (len(holes) > 1)} closed, {widest}"


def inspect_bodies(scene: Scene, _: object) -> Inspection:
    """What `restshape check` shows of bodies of triangles, whose grids are made now if they were not.

    Raises:
        UserError: a file holds no closed surface.
    """
    data, rows, warnings = {}, [], []
    for name, body in scene.bodies.items():
        if not body.form_on_grid:
            continue
        facts, scale = located_distance(scene, name).facts, body.evaluated(scene.parameters).form.scale
        data[name] = asdict(facts)
        rows.append((f"body {name}", str(MeshWords(facts, scale, body.kind == "mesh"))))
        if not scale * facts.error <= ERROR:
            what = f"bodies.{name}.{body.kind}: the distance is wrong by {1e3 * scale * facts.error:.2g} mm"
            warnings.append(f"{what}: write a smaller spacing than {1e3 * facts.spacing:.3g} mm there")
    return Inspection({"surfaces": data} if data else {}, rows, tuple(warnings))
