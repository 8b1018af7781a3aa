"""Measures of mannequins as the parameters of garments have them."""

from pathlib import Path

from restshape.physics.cloth.mannequin.body_shape import LEVELS
from restshape.scene.body_sizes import BODIES
from restshape.scene.model import Scene

NECK, CROTCH = 0.84, 0.446
"""Levels of the neck's root and of where the legs meet, over the height."""


def measures(body: str) -> dict[str, float]:
    """Measures and levels [m] of a mannequin, by the names that garments have for them."""
    sizes = BODIES[body].completed()
    levels = {**LEVELS, "neck": NECK, "crotch": CROTCH}
    return {name: getattr(sizes, name) for name in sizes.names} | {
        f"{name}_level": share * sizes.height for name, share in levels.items()
    }


def parameters_for(scene: Scene, body: str) -> list[str]:
    """The measures of a body among the parameters of a garment, as `--set` takes them."""
    return [f"parameters.{name}={value:.6g}" for name, value in measures(body).items() if name in scene.parameters]


def dressed(scene: Scene, body: str) -> list[str]:
    """A garment's parameters and its body's file, which lies beside the one that it names, as `--set` takes them."""
    file = Path(str(scene.bodies["body"].mesh.file)).with_name(f"{body}.obj")
    return [*parameters_for(scene, body), f"bodies.body.mesh.file={file}"]
