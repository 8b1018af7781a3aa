"""Recordings that tests know by heart: a plate with a moving hole, its fields given by formulas."""

from pathlib import Path

import numpy as np
from scipy.spatial import Delaunay

from restshape.replay.recording.recorder import Recorder

COLUMNS = {
    "index": "i4",
    "t": "f8",
    "line": "i4",
    "event": "str",
    "level": "i4",
    "flips": "i4",
    "min_quality": "f8",
    "iterations": "i4",
    "ms": "f8",
    "ms_relocate": "f8",
    "ms_values": "f8",
    "ms_krylov": "f8",
    "ms_mesh": "f8",
    "refused": "str",
    "q_tip": "f8",
}


def plate(centre: tuple[float, float], size: float = 0.04, radius: float = 0.12) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 2) and triangles of a 1.2 x 0.6 plate with a round hole."""
    across, up = int(1.2 / size), int(0.6 / size)
    x, y = np.meshgrid(np.linspace(0, 1.2, across + 1), np.linspace(0, 0.6, up + 1))
    grid = np.column_stack([x.ravel(), y.ravel()])
    away = np.hypot(*(grid - centre).T)
    angle = np.linspace(0, 2 * np.pi, 32, endpoint=False)
    ring = np.array(centre) + radius * np.column_stack([np.cos(angle), np.sin(angle)])
    points = np.vstack([grid[away > radius + 0.4 * size], ring])
    cells = Delaunay(points).simplices
    middle = points[cells].mean(axis=1)
    a, b = (points[cells[:, i]] - points[cells[:, 0]] for i in (1, 2))
    solid = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) > 1e-9
    return points, cells[solid & (np.hypot(*(middle - centre).T) > 0.98 * radius)].astype(np.int32)


def fields(points: np.ndarray, cells: np.ndarray, load: float) -> tuple[np.ndarray, np.ndarray]:
    """A bent cantilever's displacement (n, 2) [m], and a stress (ne,) [Pa] that is highest near the hole."""
    x, y = points.T
    displacement = 1e-4 * load * np.column_stack([-(y - 0.3) * x, x * x / 2])
    middle = points[cells].mean(axis=1)
    return displacement, 40e6 * load * (1.2 - middle[:, 0]) * (0.1 + np.abs(middle[:, 1] - 0.3))


def record_plate(path: Path, frames: int = 12, remesh_every: int = 4) -> list[dict]:
    """Records a drag of the hole; returns what was recorded, frame by frame."""
    known = []
    with Recorder.start(path, {"scene": {"title": "plate"}, "options": {"policy": "auto"}}, COLUMNS) as recorder:
        for i in range(frames):
            centre = (0.3 + 0.6 * i / max(frames - 1, 1), 0.3)
            level = 3 if i % remesh_every == 0 else (0 if i % remesh_every == 3 else 1 + i % 2)
            if level == 3:
                points, cells = plate(centre)
                recorder.topology(cells)
            elif level:
                points = points + 1e-4 * np.sin(points[:, ::-1])
            displacement, stress = fields(points, cells, 1 + i / frames)
            row = {
                "index": i,
                "t": i / 60,
                "event": "drag",
                "level": level,
                "iterations": 2 + i % 5,
                "ms": 1.0 + i,
                "ms_krylov": 0.5 + i / 2,
                "ms_values": 0.5 + i / 2,
                "refused": "hole outside" if i % 7 == 6 else "",
                "q_tip": float(displacement[:, 1].max()),
            }
            recorder.frame(i / 60, points, {"displacement": displacement}, {"von_mises": stress}, row)
            known.append({"points": points, "cells": cells, "displacement": displacement, "von_mises": stress, **row})
    return known
