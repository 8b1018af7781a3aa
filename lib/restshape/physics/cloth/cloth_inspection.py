"""What `restshape check` shows of cloth besides its materials: bodies of triangles, panels, and seams."""

from __future__ import annotations

from restshape.physics.cloth.contact.mesh_bodies import inspect_bodies
from restshape.physics.cloth.panel_inspection import inspect_panels
from restshape.physics.cloth.seams.seam_lengths import inspect_seams
from restshape.scene.model import Scene
from restshape.scene.physics import Inspection
from restshape.shape.outline import Outline


def inspect_cloth(scene: Scene, outline: Outline) -> Inspection:
    """All of a scene with its first outline.

    Raises:
        UserError: the file of a body holds no closed surface.
    """
    parts = inspect_bodies(scene, outline), inspect_panels(scene), inspect_seams(scene, outline)
    data = {key: value for part in parts for key, value in part.data.items()}
    rows = [row for part in parts for row in part.rows]
    return Inspection(data, rows, tuple(warning for part in parts for warning in part.warnings))
