"""The thesis's times of edits of cloth beside ours: rows of table 5.1 on new meshes, derivatives and predictions."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np

from restshape.application import application
from restshape.interface.first_frame import first_frame
from restshape.mesh.moving import MovingMesh
from restshape.mesh.relocate import BoundaryNodes, motion
from restshape.physics.cloth.sensitivity.drape_derivative import hand_derivative
from restshape.scene.load import load_scene
from restshape.scene.model import Scene
from restshape.sensitivity.projected_samples import LeftSamples
from restshape.sensitivity.samples import DragSamples, SamplePlace
from restshape.shape.build import outline_from_spec
from restshape.shape.hand.gesture import Gesture, drag
from restshape.shape.outline import Outline
from restshape.shape.session import EditFrame

TABLE = "5.1"
SCENE = application("couture").folder / "scenes" / "sphere.toml"
HAND, SAMPLES, EPSILON = "right", 10, 10.0**-1.5
"""The side that is dragged, the samples of the drag, and what keeps their weights finite."""
MESHES = {("20.5 mm", 1): "coarse mesh of {} nodes", ("7.83 mm", 3): "coarse mesh of {} nodes, fine one of {}"}
TURNS, STEP = 15, 0.004
"""Frames of which the median is taken, and the way of the hand between them [m]."""
DERIVED, TOLERANCE = "20.5 mm", 1e-6


class Positions:
    """Values that are nodal fields as they are: `projected_samples.NodalValues`."""

    def nodal_fields(self, rows: np.ndarray, nodes: int) -> np.ndarray:
        """The rows (count, nodes, 3)."""
        return rows

    def with_nodal_fields(self, rows: np.ndarray, fields: np.ndarray) -> np.ndarray:
        """The fields (count, m, 3)."""
        return fields


def edit_rows() -> list[dict[str, Any]]:
    """Rows of `restshape tables` on edits; all of them are times."""
    return [*remeshing_rows(), *prediction_rows(), derivative_row()]


def remeshing_rows() -> Iterator[dict[str, Any]]:
    """A new mesh in a drag, the map of its nodes by the hand, and the samples of the drag on its nodes."""
    for (size, levels), words in MESHES.items():
        moving, seconds = _remeshed(size, levels)
        nodes = dict.fromkeys(f"{len(mesh.X):,}" for mesh in (moving.mesh, moving.field_mesh))
        quantity = f"new mesh, map of the hand, {SAMPLES} samples projected"
        yield _row(words.format(*nodes), f"remeshing: {quantity}", "123 to 233", 1e3 * median(seconds))


def prediction_rows() -> Iterator[dict[str, Any]]:
    """Positions of all nodes from samples with both derivatives."""
    gesture, generator = _dragged(load_scene(SCENE))[1], np.random.default_rng(1)
    for nodes in (1_650, 10_000):
        samples = _filled(DragSamples(gesture, 1.0, EPSILON, SAMPLES), nodes, generator)
        seconds = [_timed(lambda samples=samples, k=k: samples((0.01 * k, 0.02))) for k in range(200)]
        yield _row(f"{nodes:,} nodes, {SAMPLES} samples", "GMLS interpolation", "0.36 to 0.40", 1e3 * median(seconds))


def derivative_row() -> dict[str, Any]:
    """Both derivatives of a drape on a ball by the hand."""
    analysis = first_frame(SCENE, ("effects.cloth.bending=hinge", f'mesh.size="{DERIVED}"')).analysis
    mesh = analysis.state.problem.mesh
    gesture = drag(mesh.outline, mesh.outline.entity(HAND))
    way = motion(mesh, BoundaryNodes(mesh).basis(mesh.outline, gesture.basis), "harmonic")
    seconds = [_timed(lambda: hand_derivative(analysis.state, way, TOLERANCE)) for _ in range(TURNS)]
    row = f"coarse mesh of {len(mesh.X):,} nodes, hinges, on a ball with friction"
    return _row(row, f"sensitivity analysis, to {TOLERANCE:g}", "82 to 767", 1e3 * median(seconds))


def _remeshed(size: str, levels: int) -> tuple[MovingMesh, list[float]]:
    """A mesh that is made again in each frame of a drag, and the seconds of the frames."""
    scene = load_scene(SCENE, [f'mesh.size="{size}"', f"mesh.levels={levels}"])
    outline, gesture = _dragged(scene)
    moving = MovingMesh(outline, scene.mesh, regenerate=True, order_of=lambda _: 1)
    moving.update(_frame(scene, "start", outline, gesture, 0.0))
    former = _frame(scene, "none", outline, gesture, 0.0)
    seconds, generator = [], np.random.default_rng(1)
    for k in range(1, TURNS + 1):
        frame = _frame(scene, "move", outline, gesture, k * STEP)
        empty = DragSamples(gesture, outline.size, EPSILON, SAMPLES)
        left = moving.field_mesh, _filled(empty, len(moving.field_mesh.X), generator)
        seconds.append(_timed(lambda left=left, frame=frame, former=former: _projected(moving, *left, frame, former)))
        former = frame
    return moving, seconds


def _projected(moving: MovingMesh, space: Any, samples: DragSamples, frame: EditFrame, former: EditFrame) -> None:
    """Do what a frame of level 3 does for the frames after it."""
    moving.update(frame)
    aligned = np.zeros((len(space.X), 3))
    LeftSamples(samples, Positions(), aligned, space, frame, former).projected(moving.field_mesh, moving.field_motion)


def _filled(samples: DragSamples, nodes: int, generator: np.random.Generator) -> DragSamples:
    """Samples of any positions of so many nodes, in a row along the drag."""
    for k in range(SAMPLES):
        place = SamplePlace((0.05 * (k - SAMPLES), 0.0), k, "mesh")
        samples.add(place, generator.random((nodes, 3)), generator.random((2, nodes, 3)))
    return samples


def _dragged(scene: Scene) -> tuple[Outline, Gesture]:
    """The pattern, and the drag of its side."""
    outline = outline_from_spec(scene.shape, scene.folder)
    return outline, drag(outline, outline.entity(HAND))


def _frame(scene: Scene, change: str, outline: Outline, gesture: Gesture, way: float) -> EditFrame:
    """A frame of a drag by a way [m]."""
    moved = outline.moved(gesture.points((way, 0.0)))
    return EditFrame(0, 0.0, 1, "drag", change, gesture, (way, 0.0), scene, None, moved)


def _timed(work: Callable[[], object]) -> float:
    """Seconds that it takes."""
    start = perf_counter()
    work()
    return perf_counter() - start


def _row(row: str, quantity: str, thesis: str, ms: float) -> dict[str, Any]:
    return {
        "table": TABLE,
        "row": row,
        "quantity": quantity,
        "thesis": thesis,
        "ours": ms,
        "unit": "ms",
        "timing": True,
    }
