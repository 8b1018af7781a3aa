"""One frame of cloth with the bodies that it lies on, as seen by a camera."""

from __future__ import annotations

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb

from restshape.physics.cloth.pictures.body_surfaces import body_surface
from restshape.physics.cloth.pictures.drape import COLOURS, TENSION, DrapeScenery, bodies, places, recorded_surface
from restshape.replay.recording.recording import Recording
from restshape.report.camera import Camera
from restshape.report.outlines import border, lines
from restshape.report.space_scene import SpaceDrawing, SpaceImage
from restshape.report.style import INK

BODY = np.array(to_rgb("#c2b6a3"))
BEHIND = 0.008
"""Part of the box's diagonal by which bodies are drawn farther away: flat cells cut a little into what is round."""
OPAQUE = 0.62
"""Part of what lies behind a body that it hides."""
SHARP = 40.0
"""Angle from which edges of bodies are seen [degrees]."""
EDGE = 0.5
"""Width of the cloth's border [points]."""


class DrapeImage(SpaceImage):
    """Cloth and translucent bodies of one frame, as seen by a camera.

    Args:
        axes: to draw in.
        camera: looks at them.
        scenery: box, colours.
        factor: of the axes' coordinates over metres.
    """

    def __init__(self, axes: Axes, camera: Camera, scenery: DrapeScenery, factor: float = 1.0) -> None:
        super().__init__(axes, camera, factor, OPAQUE, 0.45 * BODY)
        self.scenery, self.still = scenery, SpaceDrawing()

    def show(self, recording: Recording, i: int) -> None:
        """Take cloth and bodies of frame i."""
        scenery = self.scenery
        x, cells = places(recording, i), recording.cells(i)
        self.scene, self.veil = SpaceDrawing(self.still), SpaceDrawing()
        self.scene.surface(x, cells[:, :3], self.colours(recording, i), smooth=180.0)
        self.scene.lines(lines(x, border(cells)), INK, EDGE)
        self.mark(x)
        away = BEHIND * float(np.linalg.norm(scenery.high - scenery.low))
        for name, body in bodies(recording, i).items():
            surface, triangles = body_surface(body, scenery.low, scenery.high, recorded_surface(recording, name))
            box = scenery.low - away, scenery.high + away
            self.veil.surface(surface - away * self.camera.axes[2], triangles, BODY, smooth=SHARP, within=box)

    def colours(self, recording: Recording, i: int) -> np.ndarray:
        """Colours (ne, 3) of the triangles in frame i: those of their tension."""
        share = (recording.field(i, TENSION) - self.scenery.bottom) / (self.scenery.top - self.scenery.bottom)
        return colormaps[COLOURS](np.clip(np.nan_to_num(share), 0.0, 1.0))[:, :3]

    def mark(self, x: np.ndarray) -> None:
        """Draws what lies on the cloth, whose nodes are at x (n, 3) [m]: nothing here."""
