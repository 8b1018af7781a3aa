"""Outlines that no drape of a cloth can have, and numbers to fit where none is named."""

from __future__ import annotations

import numpy as np
from restshape_apps.couture.fitting.drapes_by_number import DrapesByNumber
from restshape_apps.couture.fitting.measured_outline import MeasuredOutline
from restshape_apps.couture.fitting.outline_table import EXAMPLE

from restshape.errors import UserError
from restshape.scene.model import Scene

MORE = 1.05
"""Area of an outline over that of the flat cloth that stretch and measuring may give."""
LEAST = 0.02
"""Area of an outline over that of the flat cloth that the smallest shadow may have."""
UNITS = {1e-3: "metres read as millimetres", 1e3: "millimetres read as metres", 0.1: "centimetres read as millimetres"}
UNITS |= {10.0: "millimetres read as centimetres", 25.4: "millimetres read as inches", 1.0 / 25.4: "inches read as mm"}
NEAR = 1.8
"""Factor within which a unit is taken for what is wrong."""


def refuse_size(measured: MeasuredOutline, drapes: DrapesByNumber, where: str) -> None:
    """Refuse an outline of a size that no drape of the cloth has.

    Raises:
        UserError: it is larger than the flat cloth, or smaller than what supports hold.
    """
    flat, found = drapes.mesh.outline.area(), measured.area
    least = max(LEAST * flat, 0.9 * _hull_area(drapes.constrained))
    if least <= found <= MORE * flat:
        return
    than = (
        f"larger than the flat cloth, of {1e4 * flat:.4g} cm^2"
        if found > flat
        else f"smaller than the least shadow of the cloth, of {1e4 * least:.4g} cm^2"
    )
    ratio = float(np.sqrt(found / (0.5 * (flat + least))))
    factor = min(UNITS, key=lambda one: abs(np.log(one / ratio)))
    guess = f": perhaps {UNITS[factor]}" if abs(np.log(factor / ratio)) < np.log(NEAR) else ""
    doubt = f" ({measured.doubt})" if measured.doubt else ""
    what = f"the outline has an area of {1e4 * found:.4g} cm^2, {than}{guess}{doubt}"
    size = (
        f"name the unit in the first row, such as {EXAMPLE}"
        if where.lower().endswith(".csv")
        else "give the drawing its size in mm (width, height, viewBox)"
    )
    raise UserError(what, where, f"{size}, or measure this cloth")


def _hull_area(points: np.ndarray) -> float:
    """Area [m^2] of the convex hull of points (m, 2); 0 of points on a line."""
    from scipy.spatial import ConvexHull, QhullError

    if len(points) < 3:
        return 0.0
    try:
        return float(ConvexHull(points).volume)
    except QhullError:
        return 0.0


def default_keys(scene: Scene) -> list[str]:
    """The bending stiffness of the one fabric of a scene.

    Raises:
        UserError: it has several, or none of its own.
    """
    names = list(scene.material)
    if len(names) != 1:
        what = f"the scene has {len(names)} materials"
        raise UserError(what, "--by", f"name one, such as material.{names[0]}.bending" if names else "give it one")
    name, stiffness = names[0], scene.material[names[0]].bending
    if isinstance(stiffness, int | float):
        return [f"material.{name}.bending"]
    if isinstance(stiffness, tuple):
        return [f"material.{name}.bending.{k}" for k in range(len(stiffness))]
    what = f"material {name} has no bending stiffness of its own: it is that of a plate of its E and thickness"
    raise UserError(what, f"material.{name}.bending", f"--set material.{name}.bending='5e-6 N m', or --by another key")
