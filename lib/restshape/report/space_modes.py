"""Pictures of modes in space: shaded, larger than life, over the outline at rest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize

from restshape.outputs.picture_files import save_picture
from restshape.outputs.si_numbers import length_unit
from restshape.report.bent_plate import FlatBody
from restshape.report.camera import Camera
from restshape.report.fitted_title import fitted
from restshape.report.space_scene import SpaceDrawing, SpaceImage
from restshape.report.style import COLOURS, FAINT, INK, SIGNED, UNTRUSTED, new_figure

AZIMUTH, ELEVATION, FAR = np.radians(-68.0), np.radians(33.0), 6.0
"""Where the camera is, and its distance in sizes of the body."""
ACROSS, WIDTH, WIDEST, MARGIN = 3, 11.0, 6.0, 0.03
"""Most pictures side by side, widths of the figure and of a picture at most [inch], and room around a body in parts of
its width."""
WORDS, TITLE, BAR = 0.5, 0.55, 0.65
"""Height of the words over each picture, of the title, and of the colour bars [inch]."""
SHARP = 50.0
"""Edges that are sharper are drawn as edges [degrees]."""


@dataclass(frozen=True, eq=False)
class SpaceMode:
    """A mode to draw.

    Args:
        shape: (n, 3) displacements of the nodes of the middle surface, of any size.
        normal: share of its kinetic energy that is perpendicular to the plane.
        name: its caption, such as its frequency and tone.
    """

    shape: np.ndarray
    normal: float
    name: str

    @property
    def perpendicular(self) -> bool:
        """Whether it moves out of the plane for the most part."""
        return self.normal > 0.5

    @property
    def kind(self) -> str:
        """What its motion is, in words."""
        return "perpendicular: a blow sounds it" if self.perpendicular else "in the plane: a blow hardly sounds it"

    def colours(self, part: float = 1.0) -> np.ndarray:
        """Colours (n, 3) of the nodes when it has reached a part, -1 to 1, of its largest displacement."""
        shape = part * self.shape / np.linalg.norm(self.shape, axis=1).max()
        if self.perpendicular:
            return colormaps[SIGNED](0.5 + 0.5 * shape[:, 2])[:, :3]
        return colormaps[COLOURS](np.linalg.norm(shape, axis=1))[:, :3]


def draw_space_modes(path: Path, body: FlatBody, modes: Sequence[SpaceMode], title: str) -> None:
    """Draw modes side by side, in one view and at one scale.

    Modes that move in the plane have words and colours of their own: a mallet hardly excites them.

    Args:
        path: picture file.
        body: at rest; modes: of it; title: of the whole.

    Source: figures 4.8, 4.10 and 4.12 of the thesis.
    """
    across = min(ACROSS, len(modes))
    down = -(-len(modes) // across)
    view = ModeView.of(body, modes)
    each = min(WIDTH / across, WIDEST)
    wide = each * across
    tall = each * view.slenderness
    high = TITLE + down * (WORDS + tall) + BAR
    figure = new_figure(wide, high)
    figure.set_layout_engine("none")
    for k, mode in enumerate(modes):
        row, column = divmod(k, across)
        top = high - TITLE - row * (WORDS + tall) - WORDS
        axes = figure.add_axes((column / across, (top - tall) / high, 1.0 / across, tall / high))
        view.frame(axes)
        SpaceImage(axes, view.camera).scene = body_drawing(body, mode)
        words = {"transform": axes.transAxes, "ha": "left", "va": "bottom", "clip_on": False}
        inch = 1.0 / tall
        axes.text(0.03, 1.0 + 0.22 * inch, mode.name, fontsize=9, **words)
        colour = INK if mode.perpendicular else UNTRUSTED
        axes.text(0.03, 1.0 + 0.04 * inch, mode.kind, fontsize=8, color=colour, **words)
    kinds = sorted({mode.perpendicular for mode in modes}, reverse=True)
    for k, perpendicular in enumerate(kinds):
        # Middles of the bars; two stand side by side.
        middle = 0.5 if len(kinds) == 1 else 0.26 + 0.48 * k
        length = min(0.8, 4.0 / wide)
        bar = figure.add_axes((middle - 0.5 * length, 0.42 / high, length, 0.11 / high))
        add_mode_bar(bar, perpendicular)
    figure.text(0.01, 1.0 - 0.08 / high, fitted(title, wide), fontsize=11, va="top")
    figure.text(0.01, 1.0 - 0.33 / high, scale_words(body), fontsize=8, va="top")
    save_picture(figure, path)


def body_drawing(body: FlatBody, mode: SpaceMode, part: float = 1.0) -> SpaceDrawing:
    """The body when a mode has reached a part, -1 to 1, of its largest displacement, with its outline at rest."""
    scene = SpaceDrawing()
    scene.lines(body.outline(), FAINT, 1.1)
    places, faces = body.surface(part * body.drawn(mode.shape))
    colours = np.tile(mode.colours(part), (2, 1))
    scene.surface(places, faces, colours, smooth=SHARP, at_places=True)
    return scene


@dataclass(frozen=True, eq=False)
class ModeView:
    """A camera, and what it has in sight: left, right, bottom and top [m]."""

    camera: Camera
    window: tuple[float, float, float, float]

    @classmethod
    def of(cls, body: FlatBody, modes: Sequence[SpaceMode], parts: Sequence[float] = (1.0,)) -> ModeView:
        """What holds modes when they have reached each of some parts of their largest displacements."""
        drawn = [body.surface(part * body.drawn(mode.shape))[0] for mode in modes for part in parts]
        places = np.concatenate([body.outline().reshape(-1, 3), *drawn])
        low, high = places.min(axis=0), places.max(axis=0)
        camera = Camera.towards(0.5 * (low + high), AZIMUTH, ELEVATION, FAR * float(np.linalg.norm(high - low)))
        seen = camera.project(places)
        (left, bottom), (right, top) = seen.min(axis=0), seen.max(axis=0)
        room = MARGIN * (right - left)
        return cls(camera, (left - room, right + room, bottom - room, top + room))

    @property
    def slenderness(self) -> float:
        """Height over width of the picture."""
        left, right, bottom, top = self.window
        return (top - bottom) / (right - left)

    def frame(self, axes: Axes) -> None:
        """Give axes these limits, and nothing else to see."""
        axes.set(xlim=self.window[:2], ylim=self.window[2:], aspect="equal")
        axes.set_axis_off()


def add_mode_bar(axes: Axes, perpendicular: bool) -> None:
    """Draw the colours of one kind of modes."""
    look = (Normalize(-1.0, 1.0), SIGNED) if perpendicular else (Normalize(0.0, 1.0), COLOURS)
    bar = axes.figure.colorbar(ScalarMappable(*look), cax=axes, orientation="horizontal")
    what = "deflection" if perpendicular else "size of the motion in the plane"
    bar.set_label(f"{what} / its largest, amplitude arbitrary", fontsize=8)
    bar.ax.tick_params(labelsize=7)
    bar.outline.set_visible(False)


def scale_words(body: FlatBody) -> str:
    """How large the body is, and how far it is drawn to move."""
    wide, high = np.ptp(body.X, axis=0)
    factor, unit = length_unit(float(max(wide, high)))
    most = float(np.linalg.norm(body.drawn(np.eye(1, 3)), axis=1).max())
    span = f"{factor * wide:.3g} x {factor * high:.3g} {unit}"
    return f"{span}; motion exaggerated, the largest drawn as {factor * most:.2g} {unit}; grey: outline at rest"
