"""What is odd for cloth in a scene: large triangles, a thick layer in which bodies push, weights that none has."""

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
LIGHTEST, HEAVIEST = 1e-3, 10.0
"""Mass by area [kg/m^2] that no cloth has less or more of: the sheerest silk has 0.01, saddle leather 5."""


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
    return [*found, *_odd_masses(scene), *slipping_words(scene)]


def _odd_masses(scene: Scene) -> list[str]:
    """Materials whose mass by area is no cloth's; one without any is meant so."""
    masses = {name: (one.rho or 0.0) * one.thickness for name, one in scene.material.items()}
    return [
        f"material.{name}: {mass:.3g} kg/m^2, which is rho times thickness, is no cloth's, which is between "
        f"{LIGHTEST:g} and {HEAVIEST:g}: are the units of both right?"
        for name, mass in masses.items()
        if mass and not LIGHTEST <= mass <= HEAVIEST
    ]
