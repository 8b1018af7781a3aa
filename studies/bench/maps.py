"""How far a mesh bears a drag of its shape under each linear map of its nodes (figure 5.10 of the thesis)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from restshape import _kernels
from restshape.errors import UserError
from restshape.mesh.generate import generate
from restshape.mesh.mesh import Mesh
from restshape.mesh.moving import FRESH_SHARE, ROUNDS
from restshape.mesh.reconnect import Reconnection
from restshape.mesh.relocate import BoundaryNodes, motion
from restshape.replay.sessions import session_of
from restshape.scene.edit_script import Script
from restshape.scene.model import MeshSpec, Scene, ShapeSpec
from restshape.shape.build import outline_from_spec
from restshape.shape.hand.gesture import Gesture, drag
from restshape.shape.outline import Outline

KINDS = ("mvc", "pmvc", "harmonic")
"""Linear maps that are compared."""
WAYS = {"alone": False, "with flips": True}
"""What a mesh may do besides moving its nodes."""
CORNERS = {
    "hem_left": (0.0, 0.0),
    "hem_right": (0.6, 0.0),
    "waist_right": (0.55, 0.6),
    "dart_right": (0.33, 0.62),
    "dart_tip": (0.3, 0.35),
    "dart_left": (0.27, 0.62),
    "waist_left": (0.05, 0.6),
}
DIAMOND = ((0.45, 0.15), (0.47, 0.25), (0.45, 0.35), (0.43, 0.25))
PANEL_SIZE, PANEL_WAY, PANEL_FRAMES = 0.028, (-0.09, 0.036), 90
"""Of the panel of a skirt: mesh size [m], the way of the hand that drags its diamond dart [m], and frames of it."""


@dataclass(frozen=True)
class Dragged:
    """A drag of a part of a shape.

    Args:
        outline: the shape at the press.
        gesture: what the hand grabs.
        path: its coefficients in each frame [m].
        spec: of the mesh.
        on: the name of what it grabs.
    """

    outline: Outline
    gesture: Gesture
    path: Sequence[tuple[float, float]]
    spec: MeshSpec
    on: str


def panel() -> Dragged:
    """The panel of a skirt with a dart at its waist, whose diamond dart goes towards the other one."""
    names = list(CORNERS)
    edges = {f"side{i}": {"line": [name, names[(i + 1) % len(names)]]} for i, name in enumerate(names)}
    holes = {"diamond": {"polygon": [list(corner) for corner in DIAMOND]}}
    tables = {"vertices": {name: list(place) for name, place in CORNERS.items()}, "edges": edges, "holes": holes}
    outline = outline_from_spec(ShapeSpec.model_validate({**tables, "outline": list(edges)}))
    parts = np.linspace(0.0, 1.0, PANEL_FRAMES + 1)[1:].tolist()
    path = [(part * PANEL_WAY[0], part * PANEL_WAY[1]) for part in parts]
    return Dragged(outline, drag(outline, outline.entity("diamond")), path, MeshSpec(size=PANEL_SIZE), "diamond")


def scripted(scene: Scene, script: Script) -> Dragged:
    """The first drag of a script.

    Raises:
        UserError: there is none that is linear.
    """
    before, found, path, on = None, None, [], ""
    for frame in session_of(scene, script).frames():
        if found is not None and frame.gesture is not found:
            break
        if found is None and frame.do in ("press", "pull") and frame.gesture is not None and frame.gesture.linear:
            before, found, on = frame.outline, frame.gesture, frame.hand[0] if frame.hand else ""
        elif found is not None and frame.change == "move":
            path.append(frame.c)
    if before is None or found is None or not path:
        raise UserError("no frame of it drags a part of the shape", str(script.path), "name another script: --edits")
    return Dragged(before, found, path, scene.mesh, on)


def compared(dragged: Dragged) -> dict[str, Any]:
    """What becomes of the mesh under each map: a record of the start, and by kind and way one of the end.

    Records of ends have the least `quality` of a triangle, the `inverted` ones, the `flips`, the `way` of the hand [m]
    to where a new mesh would be made (None: not within the drag), the least quality frame by frame (`qualities`), and
    `X`, `cells` for a picture (`table` reads them).
    """
    start = generate(dragged.outline, dragged.spec, 1)
    quality = _kernels.check_cells(start.X, start.cells, 0.0, 0.0)[0]
    floor = min(dragged.spec.min_quality, FRESH_SHARE * quality)
    ways = [float(np.hypot(*c)) for c in dragged.path]
    found: dict[str, Any] = {"on": dragged.on, "ways": ways, "floor": floor, "quality": quality, **_drawn(start)}
    found["kinds"] = {}
    for kind in KINDS:
        Psi = motion(start, BoundaryNodes(start).basis(dragged.outline, dragged.gesture.basis), kind)
        found["kinds"][kind] = {
            name: _followed(generate(dragged.outline, dragged.spec, 1), Psi, dragged.path, floor, flips)
            for name, flips in WAYS.items()
        }
    return found


def _followed(
    mesh: Mesh, Psi: np.ndarray, path: Sequence[tuple[float, float]], floor: float, flips: bool
) -> dict[str, Any]:
    """The record of the end of a path along which nodes follow a map, and edges flip where that is allowed."""
    reference, reconnection = mesh.X.copy(), Reconnection(mesh)
    way, total, qualities, placement = None, 0, [], (0.0, 0, 0)
    for c in path:
        before = mesh.X.copy()
        placement = _kernels.move_and_check(reference, Psi, *c, mesh.X, mesh.cells, 0.0, floor)
        if flips and (placement[1] or placement[2]):
            more, placement = _mended(mesh, reconnection, before, placement, floor)
            total += more
        if way is None and (placement[1] or placement[2]):
            way = float(np.hypot(*c))
        qualities.append(placement[0])
    ends = {"quality": placement[0], "inverted": placement[1], "flips": total, "way": way, "qualities": qualities}
    return {**ends, **_drawn(mesh)}


def _mended(
    mesh: Mesh, reconnection: Reconnection, before: np.ndarray, placement: tuple[float, int, int], floor: float
) -> tuple[int, tuple[float, int, int]]:
    """Flips as of level 2, their number, and what is left: quality, inverted and low-quality triangles."""
    flips = 0
    if placement[1] and not _kernels.check_cells(before, mesh.cells, 0.0, 0.0)[1]:
        flips = reconnection.flip(before)[0]
        placement = _kernels.check_cells(mesh.X, mesh.cells, 0.0, floor)
    for _ in range(ROUNDS):
        if placement[1] or not placement[2]:
            break
        more = reconnection.flip(mesh.X, floor)[0]
        if not more:
            break
        flips, placement = flips + more, _kernels.check_cells(mesh.X, mesh.cells, 0.0, floor)
    return flips, placement


def _drawn(mesh: Mesh) -> dict[str, Any]:
    """What a picture needs: nodes [m], and triangles, as texts: lists of numbers would make long files."""
    return {"X": _text(np.round(mesh.X, 5)), "cells": _text(mesh.cells)}


def _text(array: np.ndarray) -> str:
    """The rows of an array in one line."""
    return " ".join(",".join(f"{value:g}" for value in row) for row in array.tolist())


def table(text: str) -> np.ndarray:
    """The array (n, k) whose rows a text has."""
    return np.array([[float(word) for word in row.split(",")] for row in text.split()])
