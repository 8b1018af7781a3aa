"""Lengths of a scene that are too large for its cloth: of triangles, and of the layer in which bodies push."""

from __future__ import annotations

from restshape.bounds import TOLERANCE
from restshape.outputs.si_numbers import si
from restshape.physics.cloth.contact.slides_off import slipping_words
from restshape.physics.cloth.effects import ContactKeys
from restshape.scene.model import Scene
from restshape.shape.outline import Outline

TRIANGLES, FEWEST = 10.0, 4.0
"""Triangles along the longer side of a pattern that show its folds, and fewer than which do not."""
THIN, THICKEST = 0.01, 0.1
"""Distance at which contact begins over the shorter side of a pattern: what is usual, and what is too much."""


def coarse_words(scene: Scene, outline: Outline) -> list[str]:
    """What is too large for the cloth, each with what to set, and whether nothing holds it."""
    low, high = outline.bounds()
    shorter, longer = sorted(float(side) for side in high - low)
    found, size = [], scene.mesh.size
    # More than the whole pattern is a wrong unit, which is warned of in any scene.
    if size is not None and (1.0 + TOLERANCE) * longer / FEWEST < size <= longer:
        found.append(
            f"mesh.size: triangles of {si(size, 'm', 3)} show no folds of cloth {si(longer, 'm', 3)} long: "
            f'set mesh.size to "{si(longer / TRIANGLES, "m", 2)}" or less'
        )
    contact = scene.effects.get("contact")
    thickness = ContactKeys.model_validate(contact).thickness if scene.bodies and contact is not None else 0.0
    if thickness > (1.0 + TOLERANCE) * THICKEST * shorter:
        found.append(
            f"effects.contact.thickness: cloth lies up to {si(thickness, 'm', 3)} above bodies, and is "
            f'{si(shorter, "m", 3)} wide: set it to "{si(THIN * shorter, "m", 2)}" or so'
        )
    return [*found, *slipping_words(scene)]
