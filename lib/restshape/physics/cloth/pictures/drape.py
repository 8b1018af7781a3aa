"""Cloth in space: where it lies, how taut it is, and the bodies that it lies on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from restshape.outputs.si_numbers import length_unit, scaled_unit
from restshape.physics.cloth.contact.body_columns import recorded_bodies
from restshape.physics.cloth.pictures.body_surfaces import Surface, body_surface
from restshape.physics.cloth.pictures.panel_names import panel_names
from restshape.physics.cloth.pictures.pins import pins
from restshape.replay.recording.recording import Recording
from restshape.report.camera import Camera
from restshape.report.tables import column, refused
from restshape.scene.bodies import Body

TENSION = "tension"
COLOURS = "YlGnBu"
"""Light where tension is low, which is nearly everywhere: shades are seen on it."""
AZIMUTH, ELEVATION = np.deg2rad(-58.0), np.deg2rad(24.0)
FAR = 2.2
"""Distance of the camera over the diagonal of what it sees."""
ROOM, MOVING_ROOM = 0.5, 2.0
"""Part of the cloth's diagonal up to which bodies are shown beyond it, at rest and where they move."""
RARE = 0.005
"""Part of the cells whose tension may lie beyond either end of the colour bar: corners that are pinned are singular."""
MARGIN, THINNEST = 0.02, 0.2
"""Margin of the box, and its least height, over its largest size."""


@dataclass(frozen=True)
class DrapeScenery:
    """Common to all pictures of a recording of cloth.

    Args:
        low, high: (3,) corners of the box that is shown [m].
        flat: corners (2,) of the flat pattern [m].
        bottom, top: tensions at the ends of the colour bar [N/m].
        extend: at which ends of it there are others beyond, as matplotlib names them.
        bodies: whether there are any.
        pins: nodes (k,) that supports hold, by frame.
        names: where the names of panels stand in the flat pattern [m], by frame.
    """

    low: np.ndarray
    high: np.ndarray
    flat: tuple[np.ndarray, np.ndarray]
    bottom: float
    top: float
    extend: str
    bodies: bool
    pins: Mapping[int, np.ndarray]
    names: Mapping[int, Mapping[str, np.ndarray]]

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
    resting = [i for i in frames if column(recording, "converged", 1.0)[i] == 1] or list(frames)
    found = [places(recording, int(i)) for i in resting]
    low, high = np.min([x.min(axis=0) for x in found], axis=0), np.max([x.max(axis=0) for x in found], axis=0)
    size = float(np.linalg.norm(high - low))
    inner = low, high
    shown = [pair for i in frames for pair in bodies(recording, int(i)).items()]
    # All are compared with what they are at first.
    first = dict(reversed(shown))
    moving = {name for name, body in shown if body != first[name]}
    for name, body in shown:
        if body.kind == "mesh" and recorded_surface(recording, name) is None:
            continue
        room = (MOVING_ROOM if name in moving else ROOM) * size
        most = inner[0] - room, inner[1] + room
        surface, _ = body_surface(body, *most, recorded_surface(recording, name))
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
        pins(recording, frames),
        panel_names(recording, frames),
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


def recorded_surface(recording: Recording, name: str) -> Surface | None:
    """The triangles of a body in its own coordinates, as the recording holds them; None of one without any."""
    found = recording.header.get("surfaces", {}).get(name)
    return None if found is None else (np.array(found["X"], float), np.array(found["cells"], int))


def bodies(recording: Recording, i: int) -> Mapping[str, Body]:
    """The bodies of frame i, by name; of a refused one those of the last frame that was not."""
    known = np.flatnonzero(~refused(recording)[: i + 1])
    return recorded_bodies(recording.table, int(known[-1]) if len(known) else i)
