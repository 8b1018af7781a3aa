"""What `restshape check` shows of cloth besides its materials: bodies of triangles, and seams."""

from __future__ import annotations

from restshape.physics.cloth.mesh_bodies import inspect_bodies
from restshape.physics.cloth.seam_lengths import inspect_seams
from restshape.scene.model import Scene
from restshape.scene.physics import Inspection
from restshape.shape.outline import Outline


def inspect_cloth(scene: Scene, outline: Outline) -> Inspection:
    """Both of a scene with its first outline.

    Raises:
        UserError: the file of a body holds no closed surface.
    """
    bodies, seams = inspect_bodies(scene, outline), inspect_seams(scene, outline)
    return Inspection(bodies.data | seams.data, [*bodies.rows, *seams.rows], (*bodies.warnings, *seams.warnings))
