"""Recordings of cloth that tests know by heart: a square sheet over or under a ball, places given by formulas."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from restshape.replay.recording.recorder import Recorder

BALL = {"sphere": {"center": [0.5, 0.5, -0.5], "radius": 0.3}, "friction": 0.3}
COLUMNS = {
    "index": "i4",
    "t": "f8",
    "do": "str",
    "level": "i4",
    "iterations": "i4",
    "ms": "f8",
    "residual": "f8",
    "converged": "i8",
    "tangent_positive_definite": "i8",
    "refused": "str",
    **dict.fromkeys((f"bodies.ball.sphere.center.{k}" for k in range(3)), "f8"),
    "bodies.ball.sphere.radius": "f8",
    "bodies.ball.friction": "f8",
}


def grid(pieces: int = 10) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 2) and triangles of the unit square."""
    line = np.linspace(0.0, 1.0, pieces + 1)
    X = np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)
    a = (np.arange(pieces)[:, None] * (pieces + 1) + np.arange(pieces)).ravel()
    b, c, d = a + 1, a + pieces + 2, a + pieces + 1
    return X, np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])]).astype(np.int32)


def record_cloth(path: Path, heights: Sequence[float], rests: Sequence[int] = (), ball: float = -0.5) -> None:
    """Records frames of the square, flat at a height, of one tension, over a ball that goes along x.

    Args:
        path: of the recording.
        heights: of the cloth in each frame [m].
        rests: `at_rest` of each frame; default 1.
        ball: height of the ball [m].
    """
    X, cells = grid()
    with Recorder.start(path, {"title": "square", "app": "cloth"}, COLUMNS) as recorder:
        recorder.topology(cells)
        for i, height in enumerate(heights):
            displacement = np.column_stack([np.zeros_like(X), np.full(len(X), height)])
            row = {
                "index": i,
                "t": 0.1 * i,
                "do": "drag",
                "level": 3 if i == 0 else 0,
                "iterations": 7,
                "ms": 1.0,
                "residual": 5e-5,
                "converged": rests[i] if rests else 1,
                "tangent_positive_definite": 1,
                "bodies.ball.sphere.center.0": 0.5 + 0.1 * i,
                "bodies.ball.sphere.center.1": 0.5,
                "bodies.ball.sphere.center.2": ball,
                "bodies.ball.sphere.radius": 0.3,
                "bodies.ball.friction": 0.3,
            }
            recorder.frame(0.1 * i, X, {"displacement": displacement}, {"tension": np.ones(len(cells))}, row)
