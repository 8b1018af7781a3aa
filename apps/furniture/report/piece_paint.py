"""Planks in a picture: their faces, in the light of one lamp, and the edges that nothing hides."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgb
from restshape_apps.furniture.shape.planks import Plank

from restshape.report.raster import FINER, Camera, nearest_faces

SHADES = (0.62, 0.38)
"""Light on a face that is seen from the side, and what is added to it facing the light."""
LIGHT = np.array([0.35, -0.55, 0.76])
FACES = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
"""Corners of a plank's six sides, as `Plank.corners` counts them."""
EDGES = np.array([[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]])
STEPS = 121
"""Places along an edge that are looked at."""
HIDDEN = 0.004
"""How far behind something an edge is hidden, in parts of the piece's size."""

Window = tuple[float, float, float, float]


def paint_planks(
    axes: Axes, camera: Camera, planks: Sequence[Plank], window: Window, columns: int, colour: str, opacity: float
) -> np.ndarray:
    """How near (rows, columns) [m] what is painted is in each pixel; -inf where there is nothing.

    Args:
        axes: to paint in.
        camera: looks at the planks.
        planks: what is nearest of them hides the rest.
        window: left, right, bottom, top of the picture [m].
        columns: pixels across as they are shown; finer ones are painted.
        colour: of a face towards the light.
        opacity: from 0 to 1.
    """
    places = np.concatenate([np.zeros((0, 3)), *(plank.corners() for plank in planks)])
    faces = np.concatenate([np.zeros((0, 4), dtype=int), *(FACES + 8 * k for k in range(len(planks)))])
    face, near = nearest_faces(camera, places, faces, window, FINER * columns)
    a, b, c = (places[faces[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    light = SHADES[0] + SHADES[1] * np.abs(normals @ LIGHT)
    # The last one is of pixels without any: what lies between them and others has the planks' colour too.
    shades = np.append(light, 1.0)[:, None] * np.array(to_rgb(colour))
    shades = np.column_stack([np.clip(shades, 0.0, 1.0), np.append(np.full(len(light), opacity), 0.0)])
    rows, across = face.shape
    there = face >= 0
    up, along = (np.flatnonzero(there.any(axis=k)) for k in (1, 0))
    if not len(up):
        return near
    # All around is free.
    bottom, top, left, right = (
        max(up[0] - 1, 0),
        min(up[-1] + 2, rows),
        max(along[0] - 1, 0),
        min(along[-1] + 2, across),
    )
    image = np.round(255.0 * shades).astype(np.uint8)[face[bottom:top, left:right]]
    pixel = (window[1] - window[0]) / across
    extent = np.array([left, right, bottom, top]) * pixel + np.repeat([window[0], window[2]], 2)
    axes.imshow(image, extent=extent, origin="lower", zorder=2 if opacity == 1.0 else 4)
    return near


def draw_edges(
    axes: Axes, camera: Camera, planks: Sequence[Plank], near: np.ndarray, window: Window, size: float, colour: str
) -> None:
    """Draw the edges of planks where nothing hides them.

    Args:
        axes: to draw in.
        camera: looks at the planks.
        planks: whose edges they are.
        near: (rows, columns) of what is painted, as `paint_planks` returns it.
        window: left, right, bottom, top of the picture [m].
        size: of the piece [m].
        colour: of the lines.
    """
    if not planks:
        return
    left, right, bottom, top = window
    rows, columns = near.shape
    ends = np.concatenate([plank.corners()[EDGES] for plank in planks])
    steps = np.linspace(0.0, 1.0, STEPS)[:, None]
    places = ends[:, None, 0] + steps * (ends[:, 1] - ends[:, 0])[:, None]
    flat, depth = camera.project(places.reshape(-1, 3))
    column = np.clip(((flat[:, 0] - left) / (right - left) * columns).astype(int), 1, columns - 2)
    row = np.clip(((flat[:, 1] - bottom) / (top - bottom) * rows).astype(int), 1, rows - 2)
    # An edge is beside its faces: the farthest of the pixels around tells what hides it.
    around = np.min([near[row + i, column + j] for i in (-1, 0, 1) for j in (-1, 0, 1)], axis=0)
    shown = (depth >= around - HIDDEN * size).reshape(-1, STEPS)
    flat = flat.reshape(-1, STEPS, 2)
    # Straight edges are straight in the picture: a line from where each is seen to where it no longer is.
    turns = np.diff(np.pad(shown, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    (edge, first), last = np.nonzero(turns == 1), np.nonzero(turns == -1)[1] - 1
    lines = np.stack([flat[edge, first], flat[edge, last]], axis=1)[last > first]
    axes.add_collection(LineCollection(lines, colors=colour, linewidths=0.7, zorder=3), autolim=False)
