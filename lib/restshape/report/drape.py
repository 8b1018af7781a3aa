"""Cloth in space: where it lies, shaded and in the colours of its tension, with the bodies that it lies on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import to_rgb

from restshape.replay.recording import Recording
from restshape.report.body_surfaces import body_surface
from restshape.report.outlines import border
from restshape.report.raster import FINER, Camera, Hits, hits
from restshape.report.style import INK, length_unit, scaled_unit
from restshape.report.tables import column
from restshape.scene.bodies import Body
from restshape.physics.cloth.body_columns import recorded_bodies

TENSION = "tension"
COLOURS = "YlGnBu"
"""Light where tension is low, which is nearly everywhere: shades are seen on it."""
AZIMUTH, ELEVATION = np.deg2rad(-58.0), np.deg2rad(24.0)
FAR = 2.2
"""Distance of the camera over the diagonal of what it sees."""
ROOM = 0.5
"""Part of the cloth's diagonal up to which bodies are shown beyond it."""
RARE = 0.005
"""Part of the cells whose tension may lie beyond either end of the colour bar: corners that are pinned are singular."""
MARGIN, THINNEST = 0.02, 0.2
"""Margin of the box, and its least height, over its largest size."""
AMBIENT = 0.45
"""Light that comes from everywhere."""
LIGHT = np.array([-0.35, 0.45, 0.82])
"""Where the rest of the light comes from, as the camera sees it: left, up, near."""
BODY = np.array(to_rgb("#c2b6a3"))
BEHIND = 0.008
"""Part of the box's diagonal by which bodies are drawn farther away: flat cells cut a little into what is round."""
OPAQUE = 0.62
"""Part of what lies behind a body that it hides."""
EDGE = 1.5
"""Width of the cloth's border [pixels]."""
DASH = 10
"""Length of the dashes, and of the gaps between them, of what cloth hides [pixels]."""


@dataclass(frozen=True)
class DrapeScenery:
    """Common to all pictures of a recording of cloth.

    Args:
        low, high: (3,) corners of the box that is shown [m].
        flat: corners (2,) of the flat pattern [m].
        bottom, top: tensions at the ends of the colour bar [N/m].
        extend: at which ends of it there are others beyond, as matplotlib names them.
        bodies: whether there are any.
    """

    low: np.ndarray
    high: np.ndarray
    flat: tuple[np.ndarray, np.ndarray]
    bottom: float
    top: float
    extend: str
    bodies: bool

    @property
    def unit(self) -> tuple[float, str]:
        """Factor and unit of lengths."""
        return length_unit(float(max(self.high - self.low)))

    @property
    def colour(self) -> tuple[float, str]:
        """Factor of tensions and the label of their colour bar."""
        factor, unit = scaled_unit(max(abs(self.bottom), abs(self.top)), "N/m")
        return factor, f"larger principal tension [{unit}]"

    @property
    def from_aside(self) -> Camera:
        """The camera of the view in perspective."""
        size = float(np.linalg.norm(self.high - self.low))
        return Camera.towards(0.5 * (self.low + self.high), AZIMUTH, ELEVATION, FAR * size)

    @property
    def from_above(self) -> Camera:
        """The camera that sees x and y as they are."""
        return Camera(np.zeros(3), np.eye(3))


def shows_cloth(recording: Recording) -> bool:
    """Whether a recording holds cloth: a flat pattern, displaced in space, and its tension."""
    place = recording.fields.get("displacement")
    return recording.dimension == 2 and place is not None and place.components == 3 and TENSION in recording.fields


def places(recording: Recording, i: int) -> np.ndarray:
    """Places (n, 3) [m] of the nodes in frame i; where none is known, on the flat pattern."""
    X = recording.points(i)
    return np.column_stack([X, np.zeros(len(X))]) + np.nan_to_num(recording.field(i, "displacement"))


def drape_scenery(recording: Recording, frames: np.ndarray) -> DrapeScenery:
    """What the pictures of these frames have in common.

    Args:
        recording: of cloth.
        frames: indices that are looked at.
    """
    # Cloth that falls for ever is shown on its way out of the box.
    resting = [i for i in frames if column(recording, "at_rest", 1.0)[i] == 1] or list(frames)
    found = [places(recording, int(i)) for i in resting]
    low, high = np.min([x.min(axis=0) for x in found], axis=0), np.max([x.max(axis=0) for x in found], axis=0)
    size = float(np.linalg.norm(high - low))
    most = low - ROOM * size, high + ROOM * size
    shown = [body for i in frames for body in bodies(recording, int(i)).values()]
    for body in shown:
        surface, _ = body_surface(body, *most)
        ends = np.clip((surface.min(axis=0), surface.max(axis=0)), *most) if body.kind != "plane" else (low, high)
        low, high = np.minimum(low, ends[0]), np.maximum(high, ends[1])
    thin = np.maximum(0.0, THINNEST * max(high - low) - (high - low))
    margin = MARGIN * max(high - low)
    X = np.vstack([recording.points(int(i)) for i in frames])
    values = [recording.field(int(i), TENSION) for i in resting]
    return DrapeScenery(
        low - 0.5 * thin - margin,
        high + 0.5 * thin + margin,
        (X.min(axis=0), X.max(axis=0)),
        *_colour_range(np.concatenate(values)),
        bool(shown),
    )


def _colour_range(values: np.ndarray) -> tuple[float, float, str]:
    """Ends of a colour bar for most of the values, and which of its ends have others beyond them."""
    values = values[np.isfinite(values)]
    if not len(values) or values.max() == values.min() == 0.0:
        return 0.0, 1.0, "neither"
    low, high = np.percentile(values, (100.0 * RARE, 100.0 * (1.0 - RARE)))
    bottom, top = min(0.0, float(low)), float(high)
    top = top if top > bottom else bottom + 1.0
    beyond = {(True, True): "both", (True, False): "min", (False, True): "max", (False, False): "neither"}
    return bottom, top, beyond[bool(values.min() < bottom), bool(values.max() > top)]


def bodies(recording: Recording, i: int) -> Mapping[str, Body]:
    """The bodies of frame i, by name."""
    return recorded_bodies(recording.table, i)


class Picture:
    """Cloth and bodies of one frame, as seen by a camera.

    Args:
        scenery: box, colours.
        camera: looks at them.
        window: left, right, bottom, top of the picture, as the camera has them [m].
        columns: pixels across.
    """

    def __init__(
        self, scenery: DrapeScenery, camera: Camera, window: tuple[float, float, float, float], columns: int
    ) -> None:
        self.scenery, self.camera, self.window, self.columns = scenery, camera, window, columns

    def pixels(self, recording: Recording, i: int) -> np.ndarray:
        """Red, green, blue and opacity (rows, columns, 4) of frame i, from 0 to 1; the first row is the lowest."""
        x, cells = places(recording, i), recording.cells(i)
        cloth = self._hits(x, cells)
        picture = np.ones((*cloth.triangle.shape, 4))
        picture[..., 3] = cloth.there
        picture[cloth.there, :3] = self._cloth_colours(cloth, x, cells, recording.field(i, TENSION))
        surface, triangles = self._bodies(recording, i)
        if len(triangles):
            away = BEHIND * float(np.linalg.norm(self.scenery.high - self.scenery.low))
            box = self.scenery.low - away, self.scenery.high + away
            body = self._hits(surface - away * self.camera.axes[2], triangles, box)
            _lay(picture, body, cloth, BODY * self._light(body, surface, triangles)[:, None])
        return _coarser(picture)

    def _hits(self, x: np.ndarray, triangles: np.ndarray, box: tuple | None = None) -> Hits:
        return hits(self.camera, x, triangles, self.window, FINER * self.columns, box)

    def _bodies(self, recording: Recording, i: int) -> tuple[np.ndarray, np.ndarray]:
        """All bodies as one surface."""
        scenery, start, parts = self.scenery, 0, []
        for body in bodies(recording, i).values():
            x, triangles = body_surface(body, scenery.low, scenery.high)
            parts.append((x, triangles + start))
            start += len(x)
        if not parts:
            return np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64)
        return np.vstack([x for x, _ in parts]), np.vstack([triangles for _, triangles in parts])

    def _cloth_colours(self, cloth: Hits, x: np.ndarray, cells: np.ndarray, tension: np.ndarray) -> np.ndarray:
        scenery = self.scenery
        share = (tension - scenery.bottom) / (scenery.top - scenery.bottom)
        colours = colormaps[COLOURS](np.clip(np.nan_to_num(share), 0.0, 1.0))[:, :3]
        owner = cloth.triangle[cloth.there]
        lit = colours[owner] * self._light(cloth, x, cells)[:, None]
        rim = _on_border(cells)
        near = (cloth.weights[cloth.there] * cloth.heights[owner] < EDGE) & rim[owner]
        lit[near.any(axis=1)] = to_rgb(INK)
        return lit

    def _light(self, found: Hits, x: np.ndarray, triangles: np.ndarray) -> np.ndarray:
        """How bright (k,) each pixel of a surface is, by the mean normals of its nodes; both sides are alike."""
        a, b, c = (x[triangles[:, k]] for k in range(3))
        faces, normals = np.cross(b - a, c - a), np.zeros_like(x)
        for k in range(3):
            np.add.at(normals, triangles[:, k], faces)
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
        there = found.there
        n = np.einsum("pk,pkc->pc", found.weights[there], normals[triangles][found.triangle[there]])
        n /= np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-30)
        towards = LIGHT / np.linalg.norm(LIGHT) @ self.camera.axes
        return AMBIENT + (1.0 - AMBIENT) * np.abs(n @ towards)


def _on_border(cells: np.ndarray) -> np.ndarray:
    """Whether the side opposite to each corner (ne, 3) belongs to one cell only."""
    n = int(cells.max()) + 1
    sides = np.sort(np.stack([cells[:, [(k + 1) % 3, (k + 2) % 3]] for k in range(3)], axis=1), axis=2)
    return np.isin(sides[..., 0] * np.int64(n) + sides[..., 1], border(cells) @ np.array([n, 1], dtype=np.int64))


def _lay(picture: np.ndarray, body: Hits, cloth: Hits, colours: np.ndarray) -> None:
    """Lay translucent bodies over a picture of cloth, and the outline of what cloth hides as dashes."""
    seen = body.there & (body.near > cloth.near)
    shade = np.zeros_like(picture[..., :3])
    shade[body.there] = colours
    behind = picture[..., 3] * (1.0 - OPAQUE)
    opacity = OPAQUE + behind
    mixed = (OPAQUE * shade + behind[..., None] * picture[..., :3]) / opacity[..., None]
    picture[seen, :3], picture[seen, 3] = mixed[seen], opacity[seen]
    there = np.pad(body.there, 1)
    inner = there[2:, 1:-1] & there[:-2, 1:-1] & there[1:-1, 2:] & there[1:-1, :-2]
    line = body.there & ~inner
    rows, columns = np.indices(line.shape)
    dashed = (rows + columns) // DASH % 2 == 0
    picture[line & (seen | dashed)] = (*(0.45 * BODY), 1.0)


def _coarser(picture: np.ndarray) -> np.ndarray:
    """The means of squares of pixels, each pixel counted by its opacity."""
    rows, columns = (size // FINER * FINER for size in picture.shape[:2])
    whole = picture[:rows, :columns].copy()
    whole[..., :3] *= whole[..., 3:]
    mean = whole.reshape(rows // FINER, FINER, columns // FINER, FINER, 4).mean(axis=(1, 3))
    colours = mean[..., :3] / np.maximum(mean[..., 3:], 1e-9)
    return np.dstack([np.where(mean[..., 3:] > 0.0, colours, 1.0), mean[..., 3]])
