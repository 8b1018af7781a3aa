"""Line segments that show a field of vectors, such as a velocity, over the colours of another one."""

from collections.abc import Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.tri import LinearTriInterpolator, Triangulation

from restshape.errors import UserError
from restshape.outputs.si_numbers import si
from restshape.replay.recording.recording import Recording
from restshape.report.field import physics_of
from restshape.report.scenery import Scenery
from restshape.report.segments import Segments
from restshape.report.style import INK

COUNT = 44
"""Segments along the longer side of a picture."""
LONGEST = 1.4
"""Length of the longest over the distance between two."""
DARK = 0.5
"""Luminance of a colour below which segments on it are white."""
ROUND = (1.0, 2.0, 5.0, 10.0)
"""First digits of the value of the segment that is explained."""
MOST = 1.6
"""Of that value over the largest one."""


class VectorSegments:
    """The segments of all frames of a picture, of one scale, in the middle of which is the place they are of.

    Args:
        recording: of a shape in the plane.
        scenery: common to all frames.
        wanted: frames that will be drawn.

    Raises:
        UserError: the recording has no field of vectors that its physics shows.
    """

    def __init__(self, recording: Recording, scenery: Scenery, wanted: Sequence[int]) -> None:
        looks = {name: look for one in physics_of(recording) for name, look in one.vectors.items()}
        shown = [name for name in looks if name in recording.fields]
        if not shown:
            raise UserError("the recording has no field of vectors to show", "--show vectors", "leave vectors out")
        self.recording, self.scenery, self.name, self.look = recording, scenery, shown[0], looks[shown[0]]
        xmin, xmax, ymin, ymax = scenery.extent
        self.spacing = max(xmax - xmin, ymax - ymin) / COUNT
        # None leaves the picture.
        room = 0.5 * LONGEST * self.spacing
        x, y = (np.arange(low + room, high - room, self.spacing) for low, high in ((xmin, xmax), (ymin, ymax)))
        self._places = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
        # Of what is drawn: a jet between two nodes would make points of all segments.
        sizes = [np.linalg.norm(self._vectors(i)[1], axis=1) for i in wanted if scenery.seen.solved[i]]
        self.largest = max((float(size.max(initial=0.0)) for size in sizes), default=0.0)

    @property
    def stretch(self) -> float:
        """Length of a segment [m] over the size of its vector."""
        return LONGEST * self.spacing / self.largest if self.largest else 0.0

    def lines(self, i: int) -> np.ndarray:
        """The segments (k, 2, 2) [m] of frame i: start and end."""
        places, vectors = self._vectors(i)
        half = 0.5 * self.stretch * vectors
        return np.stack([places - half, places + half], axis=1)

    def _vectors(self, i: int) -> tuple[np.ndarray, np.ndarray]:
        """The places (k, 2) [m] of the segments of frame i, and the vectors (k, 2) there."""
        plane = self._plane(i)
        field = np.nan_to_num(self.recording.field(i, self.name))
        vectors = np.ma.stack([LinearTriInterpolator(plane, part)(*self._places.T) for part in field.T[:2]], axis=-1)
        inside = ~np.ma.getmaskarray(vectors).any(axis=1)
        return self._places[inside], np.ma.getdata(vectors)[inside]

    def on_dark(self, lines: np.ndarray, i: int) -> np.ndarray:
        """Which of the segments (k, 2, 2) [m] of frame i lie on dark colours of the field."""
        scenery, plane = self.scenery, self._plane(i)
        if scenery.field is None:
            return np.zeros(len(lines), dtype=bool)
        values = scenery.field.values(self.recording, i)[:, :3].mean(axis=1)
        at = plane.get_trifinder()(*lines.mean(axis=1).T)
        red, green, blue = scenery.bar.to_rgba(scenery.colour[0] * values[at])[:, :3].T
        return 0.3 * red + 0.59 * green + 0.11 * blue < DARK

    def draw(self, axes: Axes, i: int) -> list[Artist]:
        """Draws the segments of frame i over its field, each with a dot where it starts; returns the artists."""
        lines, found = self.lines(i), list[Artist]()
        dark = self.on_dark(lines, i)
        for chosen, colour in ((dark, "white"), (~dark, INK)):
            shown = self.scenery.unit[0] * lines[chosen]
            segments = Segments(edgecolors=[colour], linewidths=0.5)
            segments.show(shown)
            axes.add_collection(segments, autolim=False)
            found += [segments, *axes.plot(*shown[:, 0].T, ls="", marker="o", ms=0.9, mec="none", mfc=colour)]
        return found

    def _plane(self, i: int) -> Triangulation:
        X, cells = self.recording.mesh(i)
        return Triangulation(*X.T, cells[:, :3])

    def explain(self, figure: Figure, left: float, below: float, inches: float) -> None:
        """Puts into a figure a segment of a round value, with its meaning below.

        Args:
            figure: as large as it will be.
            left, below: place of the segment in it [inch].
            inches: length of a metre of the shape in it [inch].
        """
        if not self.largest:
            return
        power = 10.0 ** np.floor(np.log10(self.largest))
        value = power * max(digit for digit in ROUND if digit * power <= MOST * self.largest)
        wide, high = figure.get_size_inches()
        length = inches * self.stretch * value
        ends = [left / wide, (left + length) / wide], [below / high] * 2
        figure.add_artist(Line2D(*ends, color=INK, lw=0.9, marker="o", ms=2.0, markevery=[0]))
        words = f"{self.look.label}\n{si(value, self.look.unit)}"
        figure.text(left / wide, (below - 0.06) / high, words, color=INK, fontsize=7, va="top", linespacing=1.2)
