"""The artists of one shape in the plane: a smooth field on the deformed body, its mesh, outlines, and marks."""

from collections.abc import Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, TriMesh
from matplotlib.colors import to_rgba
from matplotlib.lines import Line2D
from matplotlib.tri import Triangulation

from restshape.replay.recording.recording import Recording
from restshape.report.marks import CROSS, SYMBOLS, Mark, marks, singular_points
from restshape.report.outlines import border, chains, lines, sides
from restshape.report.scenery import Scenery
from restshape.report.segments import Segments
from restshape.report.smooth import smooth_triangles
from restshape.report.style import FAINT, GOAL, INK, MARK, MESH
from restshape.report.survey import known_displacement

CORNERS = Triangulation([0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [[0, 1, 2]])


class SmoothBody(TriMesh):
    """Triangles with colours that go smoothly from corner to corner, put in place again from frame to frame."""

    def __init__(self, scenery: Scenery) -> None:
        super().__init__(CORNERS)
        bar = scenery.bar
        self.set_norm(bar.norm)
        self.set_cmap(bar.cmap)
        # A vector picture holds it as pixels: renderers of such have no smooth triangles.
        self.set_rasterized(True)

    def show(self, places: np.ndarray, triangles: np.ndarray, values: np.ndarray) -> None:
        """Puts triangles (k, 3) between places (m, 2) with values (m,)."""
        self._triangulation = Triangulation(*places.T, triangles)
        self.set_array(np.ma.masked_invalid(values))


class Drawing:
    """The artists of one panel, used again from frame to frame.

    Args:
        axes: where they are drawn.
        scenery: common to all panels.
        mesh: the sides of the cells are drawn.
        goal: goals are.
    """

    def __init__(self, axes: Axes, scenery: Scenery, mesh: bool = True, goal: bool = True) -> None:
        self.axes, self.scenery = axes, scenery
        factor, _ = scenery.unit
        self.body = SmoothBody(scenery)
        self.mesh = Segments(edgecolors=[to_rgba(MESH, 0.35)], linewidths=0.25, visible=mesh)
        self.rest = Segments(edgecolors=FAINT, linewidths=0.7, linestyles=(0, (4, 2)))
        self.outline = Segments(edgecolors=INK, linewidths=0.6)
        self.artists: list[Artist] = [self.body, self.mesh, self.rest, self.outline]
        for artist in (self.body, self.mesh, self.rest, self.outline):
            axes.add_collection(artist, autolim=False)
        goals = [factor * curve for curve in scenery.goals if goal]
        axes.add_collection(LineCollection(goals, colors=GOAL, linewidths=1.3), autolim=False)
        self.marks = [_ring(axes, marker) for marker, _ in SYMBOLS]
        # Singular places.
        self.crosses = _ring(axes, CROSS)
        self.artists += [*self.marks, self.crosses]
        xmin, xmax, ymin, ymax = (value * factor for value in scenery.extent)
        axes.set(xlim=(xmin, xmax), ylim=(ymin, ymax), aspect="equal")

    def show(self, recording: Recording, i: int) -> None:
        """Puts frame i into the artists."""
        scenery, (X, cells) = self.scenery, recording.mesh(i)
        factor, _ = scenery.unit
        x = factor * (X + scenery.scale * known_displacement(recording, i))
        values = np.full(cells.shape, np.nan)
        if scenery.field:
            values = scenery.colour[0] * scenery.field.values(recording, i, cells)
        self.body.show(*smooth_triangles(x, cells, values))
        if self.mesh.get_visible():
            self.mesh.show(lines(x, sides(cells)))
        around = border(cells)
        self.outline.show(lines(x, around))
        moved = bool(scenery.scale * scenery.seen.largest[i] > 0.0)
        self.rest.trace(chains(factor * X, around) if moved else ())
        found = marks(recording, i, scenery.field, cells) if scenery.field and scenery.seen.solved[i] else []
        self._put(found, x)
        self._cross(singular_points(recording, i) if scenery.seen.solved[i] else np.empty((0, 2)), X, x)

    def _cross(self, points: np.ndarray, X: np.ndarray, x: np.ndarray) -> None:
        """Crosses singular places (k, 2) of the shape at rest, where their nodes are drawn."""
        nodes = [int(((X - point) ** 2).sum(axis=1).argmin()) for point in points]
        shown = x[nodes]
        self.crosses.set_data(*shown[self._inside(shown)].T)

    def _inside(self, places: np.ndarray) -> np.ndarray:
        """Whether places (..., 2) on the axes are in the part that is shown."""
        xmin, xmax, ymin, ymax = (value * self.scenery.unit[0] for value in self.scenery.extent)
        x, y = places[..., 0], places[..., 1]
        return (xmin <= x) & (x <= xmax) & (ymin <= y) & (y <= ymax)

    def _put(self, found: Sequence[Mark], x: np.ndarray) -> None:
        at = {mark.marker: x[mark.node] for mark in found}
        for ring in self.marks:
            place = at.get(str(ring.get_marker()))
            ring.set_data(([], []) if place is None or not self._inside(place) else ([place[0]], [place[1]]))


def _ring(axes: Axes, marker: str) -> Line2D:
    """A hollow marker that is seen on dark and on light."""
    (ring,) = axes.plot([], [], ls="", marker=marker, ms=7, mfc="none", mec=MARK, mew=1.2, clip_on=False, zorder=5)
    return ring
