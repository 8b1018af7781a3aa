"""What happened in the frames of a recording: which ones a sheet shows, and what it says of them."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from restshape.outputs.si_numbers import si
from restshape.replay.columns import quantity_names
from restshape.replay.constraints import FAILS, UNCERTAIN
from restshape.replay.recording.recording import Recording
from restshape.replay.rounding import cleared
from restshape.report.field import shown_field
from restshape.report.recorded_quantities import limit_series, quantity_units
from restshape.report.style import LEVEL_LABELS, SOLVED, VALUES
from restshape.report.tables import column, predicted, refused, solved_at_rest, untrusted, with_values

LEAST_ERROR = 0.01
"""Percent below which an error is only said to be smaller."""
LONGEST = 90
"""Letters of a reason at most."""


def texts(recording: Recording, name: str) -> list[str]:
    """A column of texts (n,); empty ones where the recording lacks it."""
    return [str(text) for text in recording.table.get(name, [""] * recording.n)]


def violated(recording: Recording) -> np.ndarray:
    """Whether a quantity is beyond its limit in each frame (n,)."""
    return np.array([status == FAILS for status in texts(recording, "constraint_status")], dtype=bool)


def uncertain(recording: Recording) -> np.ndarray:
    """Whether a quantity of each frame (n,) is nearer to its limit than the error of its value."""
    return np.array([status == UNCERTAIN for status in texts(recording, "constraint_status")], dtype=bool)


def utilisations(recording: Recording) -> dict[str, np.ndarray]:
    """By quantity with a limit, how far it is used in each frame (n,): 1 at the limit, above it beyond.

    It is 1 + (value - limit) / |limit|, for a lower limit with the opposite sign; a limit of 0 is measured in the
    largest size of the values.
    """
    found = {}
    for name, limit in limit_series(recording).items():
        values = column(recording, f"q_{name}")
        size = np.abs(values[np.isfinite(values)]).max(initial=0.0) or 1.0
        used = np.full(recording.n, -np.inf)
        for key, sign in (("max", 1.0), ("min", -1.0)):
            if key in limit:
                used = np.maximum(
                    used, 1.0 + sign * (values - limit[key]) / np.where(limit[key], np.abs(limit[key]), size)
                )
        found[name] = used
    return found


def worst_frame(recording: Recording) -> tuple[int, str] | None:
    """The frame in which a limit is used most, or a quantity is largest in size, and what that is, for people.

    Without limits the quantity is that of the shown field, else the first one; None where no frame has any.
    """
    used = {name: values for name, values in utilisations(recording).items() if np.isfinite(values).any()}
    if used:
        name = max(used, key=lambda key: float(np.nanmax(used[key])))
        i = int(np.nanargmax(used[name]))
        return i, f"worst: {name} {_margin(recording, name, i)}"
    field, names = shown_field(recording), quantity_names(recording.table)
    own = [q for q in names if field and field.quantity_of(recording, q)]
    for name in [*own, *names]:
        sizes = np.abs(column(recording, f"q_{name}"))
        if np.isfinite(sizes).any():
            i = int(np.where(np.isfinite(sizes), sizes, -1.0).argmax())
            return i, f"worst: largest {name}"
    return None


def _margin(recording: Recording, name: str, i: int) -> str:
    """How far a quantity is from the limit that it uses most in a frame, for people.

    It is the share of an upper limit where 0 is no use at all, else the distance in the unit of the quantity: a share
    of a lower limit, or of an absolute temperature, means nothing.
    """
    limit = {key: float(bounds[i]) for key, bounds in limit_series(recording)[name].items()}
    value = float(column(recording, f"q_{name}")[i])
    left = {key: sign * (limit[key] - value) for key, sign in (("max", 1.0), ("min", -1.0)) if key in limit}
    key, unit = min(left, key=lambda one: left[one]), quantity_units(recording.header).get(name, "")
    if key == "max" and limit[key] > 0.0 and value >= 0.0 and unit != "K":
        return f"at {100.0 * value / limit[key]:.4g} % of its limit"
    far = si(abs(left[key]), unit, 3)
    return f"{far} within its limit" if left[key] >= 0.0 else f"{far} beyond its limit"


def events(recording: Recording) -> list[list[int]]:
    """Frames in which something happens, a list a kind.

    These are refused, limits violated, not to be trusted, uncertain, level 3, remarks, level 2. Of neighbours of one
    kind the first stands for all.
    """
    level = column(recording, "level")
    remarks = np.array([bool(text) for text in texts(recording, "note")], dtype=bool)
    later = np.arange(recording.n) > 0
    wrong = [refused(recording), violated(recording), untrusted(recording), uncertain(recording)]
    kinds = [*wrong, (level == 3) & later, remarks, level == 2]
    return [_starts(kind) for kind in kinds]


def _starts(chosen: np.ndarray) -> list[int]:
    """The first of each run of frames, spread ones first."""
    first = np.flatnonzero(chosen & ~np.concatenate([[False], chosen[:-1]])).tolist()
    return spread(first)


def spread(frames: Sequence[int]) -> list[int]:
    """Frames in an order in which the first ones of the list lie far apart: first, last, then middles of gaps."""
    left, order = list(frames[1:-1]), list(dict.fromkeys([*frames[:1], *frames[-1:]]))
    while left and len(order) < 40:
        order.append(max(left, key=lambda i: min(abs(i - other) for other in order)))
        left.remove(order[-1])
    return order + left


def chosen_frames(recording: Recording, count: int) -> np.ndarray:
    """Indices of at most `count` frames: the first, the last, the worst, those in which something happens, others."""
    worst = worst_frame(recording)
    chosen = [0, recording.n - 1, *([worst[0]] if worst else [])]
    kinds = events(recording)
    while any(kinds):
        chosen += [kind.pop(0) for kind in kinds if kind]
    chosen = list(dict.fromkeys(chosen))[:count]
    while len(chosen) < min(count, recording.n):
        chosen.append(_farthest(chosen, recording.n))
    return np.array(sorted(chosen))


def _farthest(chosen: Sequence[int], n: int) -> int:
    """The frame in the middle of the largest gap between chosen ones."""
    at = sorted(chosen)
    ends = [*pairwise(at)] or [(at[0], n)]
    first, last = max(ends, key=lambda pair: pair[1] - pair[0])
    if last - first < 2:
        return next(i for i in range(n) if i not in chosen)
    return (first + last) // 2


def frame_words(recording: Recording, i: int) -> Iterator[str]:
    """What a frame is: its number, moment and level, and the estimated relative error of its solution."""
    yield f"frame {recording.number(i)}"
    yield from recording.moments(i)
    if "level" in recording.table:
        yield _what_it_does(recording, i)
    if predicted(recording)[i]:
        yield "predicted"
    estimate = float(column(recording, "estimate")[i])
    if np.isfinite(estimate):
        share = 100.0 * cleared(estimate, 1.0)
        yield f"error {share:.2g} %" if share == 0.0 or share >= LEAST_ERROR else f"error below {LEAST_ERROR:g} %"
    if uncertain(recording)[i]:
        yield "limit uncertain"
    worst = worst_frame(recording)
    if worst and worst[0] == i:
        yield worst[1]


def _what_it_does(recording: Recording, i: int) -> str:
    """The level of a frame, and whether it rests; of a refused one what was to be done."""
    level, event = int(recording.table["level"][i]), texts(recording, "event")[i]
    if refused(recording)[i] and event:
        return event
    if not level and with_values(recording)[i]:
        level = VALUES
    elif not level and solved_at_rest(recording)[i]:
        level = SOLVED
    return LEVEL_LABELS[level]


def failure(recording: Recording, i: int, solved: bool = True) -> str:
    """Why a frame is no good, for people: refused, not analysed, or a limit violated; empty where nothing is."""
    reason = texts(recording, "refused")[i]
    if reason:
        return f"REFUSED, last solution shown: {_short(reason)}"
    if not solved:
        return "NOT ANALYSED: the shape alone"
    if violated(recording)[i]:
        return f"LIMIT VIOLATED: {_short(texts(recording, 'violated_constraints')[i])}"
    return ""


def _short(text: str) -> str:
    text = " ".join(text.split())
    return text if len(text) <= LONGEST else text[: LONGEST - 2] + " …"
