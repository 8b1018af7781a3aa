"""What is odd in the values of a scene of furniture, though it can be simulated."""

from collections.abc import Iterator, Mapping
from math import acos, degrees, sqrt
from typing import Any

import numpy as np
from restshape_apps.furniture.physics.fasteners import fastener
from restshape_apps.furniture.shape.planks import Piece

from restshape.scene.expressions import Expression
from restshape.scene.model import Scene
from restshape.scene.plain_values import table_in
from restshape.scene.space_values import number
from restshape.scene.units import reads_as_quantity

NEAR = 3.0
"""Diameters from one fastener to the next below which wood may split: the least that EN 1995-1-1:2004 has across the
grain, of dowels (table 8.5) and of nails in drilled holes (table 8.2)."""
SLENDER = 2.0
"""Diameters of a fastener below which the edge that it goes into is thin: joiners take dowels of at most half the
thickness of an edge."""
THICK, LONG = 1.0, 10.0
"""Metres from which on a length without a unit is hardly meant: as a thickness or a spacing, and as what else places a
plank."""
STEEP = 0.3
"""Slope from which on a weight slides off a plank: textbooks have a friction of 0.25 to 0.5 for dry wood on wood."""
UPRIGHT = 0.05
"""Cosine of the slope below which what is on a face is plainly hung there."""
HEAVY = 1000.0
"""Kilograms from which on a mass without a unit is hardly meant."""
PLACES = {"start": "from", "to": "to", "width": "width", "center": "center", "size": "size"}
"""Lengths that place a plank, and their keys."""


def odd_values(scene: Scene, piece: Piece) -> list[str]:
    """What a user may have meant otherwise, a line each, which names the key."""
    values = *_too_thick(scene, piece), *_too_far(scene), *_too_heavy(scene), *_too_near(piece), *_too_thin(piece)
    return [*values, *_too_steep(piece)]


def _too_thick(scene: Scene, piece: Piece) -> Iterator[str]:
    """Thicknesses and spacings without a unit that are long even for a plank."""
    lengths: dict[tuple[str, str], tuple[float, Any]] = {
        ("fastener", "spacing"): (piece.spacing, scene.fastener.spacing)
    }
    for plank in piece.planks:
        own = scene.planks[plank.name].thickness
        place = "wood" if own is None else f"planks.{plank.name}"
        lengths[place, "thickness"] = float(plank.size[2]), scene.wood.thickness if own is None else own
    for (place, key), (size, value) in lengths.items():
        if size > THICK and _without_unit(scene, _written(scene, place).get(key), value):
            yield _in_metres(f"{place}.{key}", size, f"long for a {key}")


def _too_far(scene: Scene) -> Iterator[str]:
    """Places and sizes of planks without a unit that no room has; of each plank the first."""
    for name, plank in scene.planks.items():
        written = _written(scene, f"planks.{name}")
        for field, key in PLACES.items():
            pairs = zip(getattr(plank, field) or (), written.get(key) or ())
            sizes = [number(value, scene.parameters) for value, text in pairs if _without_unit(scene, text, value)]
            if (most := max(map(abs, sizes), default=0.0)) > LONG:
                yield _in_metres(f"planks.{name}.{key}", most, "far for a plank")
                break


def _in_metres(key: str, size: float, odd: str) -> str:
    """The question whether a length is meant in metres."""
    choice = f'"{size:g} mm" or "{size:g} m"'
    return f"{key}: a length without a unit is in metres, and {size:g} m is {odd}: {choice}?"


def _too_heavy(scene: Scene) -> Iterator[str]:
    """Weights without a unit that are those of a car."""
    for name, weight in scene.weights.items():
        mass = number(weight.mass, scene.parameters)
        if mass > HEAVY and _without_unit(scene, _written(scene, f"weights.{name}").get("mass"), weight.mass):
            what = f"a mass without a unit is in kg, and {mass:g} kg is heavy for a weight"
            yield f'weights.{name}.mass: {what}: "{mass:g} g" or "{mass:g} kg"?'


def _written(scene: Scene, place: str) -> Mapping[str, Any]:
    """A table as the scene's file has it."""
    table = scene.raw
    for part in place.split(".", 1):
        table = table_in(table, part)
    return table


def _without_unit(scene: Scene, written: object, value: object) -> bool:
    """Whether a number has no unit: neither its own, nor of all parameters that its formula names."""
    if isinstance(value, Expression):
        given = table_in(scene.raw, "parameters")
        return any(_without_unit(scene, given.get(name), None) for name in value.names)
    return not (isinstance(written, str) and reads_as_quantity(written))


def _too_near(piece: Piece) -> Iterator[str]:
    """Fasteners that are nearer to each other than wood bears."""
    for name in dict.fromkeys(joint.fastener for joint in piece.joints):
        diameter = fastener(name).diameter
        least = NEAR * diameter
        if piece.spacing < least - 1e-9:
            here, thick, do = (f"{1e3 * length:.4g} mm" for length in (piece.spacing, diameter, least))
            yield (
                f"fastener.spacing: {here} from one {name!r} of {thick} to the next is less than {NEAR:g} diameters: "
                f"the wood may split, and strengths do not count that; write {do} or more"
            )


def _too_thin(piece: Piece) -> Iterator[str]:
    """Edges that are too thin for what goes into them; of each fastener the thinnest."""
    for name in dict.fromkeys(joint.fastener for joint in piece.joints):
        thinnest = min(
            (piece.planks[joint.i] for joint in piece.joints if joint.fastener == name), key=lambda one: one.size[2]
        )
        diameter = fastener(name).diameter
        if thinnest.size[2] < SLENDER * diameter - 1e-9:
            here, thick, do = (f"{1e3 * size:.4g} mm" for size in (thinnest.size[2], diameter, SLENDER * diameter))
            yield (
                f"planks.{thinnest.name}: a {name!r} of {thick} goes into an edge of {here}: the wood splits, and "
                f"strengths do not count that; take planks of {do} or more, or thinner fasteners"
            )


def _too_steep(piece: Piece) -> Iterator[str]:
    """Weights on faces from which they would slide."""
    for load in piece.weights:
        plank, along = piece.planks[load.plank], np.array(piece.gravity)
        faces = [np.sign(at) * axis for at, axis in zip(load.place, plank.axes.T) if abs(at) > 0.5 - 1e-9]
        if not faces or not along.any():
            continue
        cosine = max(float(-face @ along) for face in faces) / float(np.linalg.norm(along))
        slope = sqrt(max(1.0 - cosine**2, 0.0))
        if cosine > UPRIGHT and slope > STEEP * cosine:
            what = f"it lies on a slope of {degrees(acos(cosine)):.3g} deg and is taken as held there"
            yield f"weights.{load.name}: {what}: without that it needs friction of {slope / cosine:.2g}"
