"""What is odd in the values of a scene of furniture, though it can be simulated."""

from collections.abc import Iterator

from restshape_apps.furniture.physics.fasteners import fastener
from restshape_apps.furniture.shape.planks import Piece

from restshape.scene.model import Scene
from restshape.scene.plain_values import table_in
from restshape.scene.units import reads_as_quantity

NEAR = 3.0
"""Diameters from one fastener to the next below which wood may split: the least that EN 1995-1-1:2004 has across the
grain, of dowels (table 8.5) and of nails in drilled holes (table 8.2)."""
THICK = 1.0
"""Metres from which on a length without a unit is hardly meant as a thickness, or a spacing."""


def odd_values(scene: Scene, piece: Piece) -> list[str]:
    """What a user may have meant otherwise, a line each, which names the key."""
    return [*_too_long(scene, piece), *_too_near(piece)]


def _too_long(scene: Scene, piece: Piece) -> Iterator[str]:
    """Thicknesses and spacings without a unit that are long even for a plank."""
    lengths = {("fastener", "spacing"): piece.spacing}
    for plank in piece.planks:
        own = scene.planks[plank.name].thickness is not None
        lengths["planks." + plank.name if own else "wood", "thickness"] = float(plank.size[2])
    for (place, key), value in lengths.items():
        table = scene.raw
        for part in place.split(".", 1):
            table = table_in(table, part)
        written = table.get(key)
        if value > THICK and not (isinstance(written, str) and reads_as_quantity(written)):
            choice = f'"{value:g} mm" or "{value:g} m"'
            yield f"{place}.{key}: a length without a unit is in metres, and {value:g} m is long for a {key}: {choice}?"


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
