"""Cursor paths of a drag: even, smooth, or as a hand does it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TypeVar, cast

import numpy as np

from restshape.arrays import Reals

TREMOR = 0.004
"""Amplitude of the tremor, as a share of the way."""

TREMOR_HERTZ = (4.0, 11.0)
"""Band of a hand's tremor [Hz]."""

JERK_SHARE = 0.12
JERK_FRAMES = 3
"""A jerk covers this share of the way in this many frames."""


def minimum_jerk(t: Reals) -> Reals:
    """Share of the way at the share t of the time: 10 t^3 - 15 t^4 + 6 t^5.

    Source: Flash and Hogan, The coordination of arm movements, 1985.
    """
    return t**3 * (10.0 + t * (-15.0 + 6.0 * t))


def cursor_path(
    start: tuple[float, ...],
    step: tuple[float, ...],
    frames: int,
    style: str = "straight",
    pause: int = 0,
    seed: int = 0,
    frame_rate: float = 60.0,
) -> list[tuple[float, ...]]:
    """Cursor positions [m], in the plane or in space, one a frame, the last exactly at start + step.

    Args:
        start: where the cursor is before the first frame [m].
        step: the whole displacement [m].
        frames: number of positions, pause included.
        style: "straight" (even speed), "jerk" (minimum-jerk with a sudden fast stretch), or "hand-like" (that, with
            tremor and a pause).
        pause: frames in which the cursor rests half-way; "hand-like" rests one frame in twelve at least.
        seed: of tremor, and of when the hand rests and jerks.
        frame_rate: frames a second.
    """
    random = np.random.default_rng(seed)
    if style == "hand-like":
        pause = max(pause, frames // 12)
    pause = min(pause, frames - 1)
    moving = frames - pause
    t = np.arange(1, moving + 1) / moving
    share = t if style == "straight" else minimum_jerk(t)
    rest = moving // 2
    if style != "straight":
        # Never at once with the pause, so that both can be seen in the recording.
        begin = random.uniform(0.2, 0.35) if random.random() < 0.5 else random.uniform(0.65, 0.8)
        stretch = minimum_jerk(np.clip((t - begin) * moving / JERK_FRAMES, 0.0, 1.0))
        share = (1.0 - JERK_SHARE) * share + JERK_SHARE * stretch
        rest = int(moving * random.uniform(0.42, 0.58))
    way = np.array(step, dtype=float)
    offset = share[:, None] * way
    if style == "hand-like":
        offset += _tremor(t, moving / frame_rate, math.hypot(*step), random, len(step))
    places = np.minimum(
        np.concatenate([np.arange(rest), np.full(pause, rest - 1), np.arange(rest, moving)]), moving - 1
    )
    # Before its first move the hand rests where it took hold.
    xy = np.where(places[:, None] < 0, 0.0, offset[places]) + np.array(start, dtype=float)
    path = [tuple(float(f"{value:.9g}") for value in place) for place in xy.tolist()]
    path[-1] = tuple(a + b for a, b in zip(start, step))
    return path


def _tremor(t: Reals, seconds: float, way: float, random: np.random.Generator, d: int) -> Reals:
    """Smooth displacements (n, d) [m] that vanish at both ends."""
    hertz, phase = random.uniform(*TREMOR_HERTZ, (3, d)), random.uniform(0.0, 2.0 * np.pi, (3, d))
    waves = np.sin(2.0 * np.pi * seconds * hertz * t[:, None, None] + phase).mean(axis=1)
    return TREMOR * way * (16.0 * t**2 * (1.0 - t) ** 2)[:, None] * waves


Place = TypeVar("Place", bound=tuple[float, ...])


def resampled(start: Place, path: Sequence[Place], frames: int) -> list[Place]:
    """As many cursor positions as frames, evenly along start and path by number, the last one exactly."""
    if frames == 1:
        return [path[-1]]
    chain = np.array([start, *path], dtype=float)
    places = np.arange(1, frames + 1) * (len(path) / frames)
    columns = [np.interp(places, np.arange(len(chain)), column) for column in chain.T]
    steps = cast(list[Place], list(zip(*(column.tolist() for column in columns))))
    return [*steps[:-1], path[-1]]
