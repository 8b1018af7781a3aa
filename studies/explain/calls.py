"""Rows of replays side by side, and the calls of kernels in them."""

from collections.abc import Iterable
from typing import Any

from restshape.replay.frame_counts import Calls

Row = dict[str, Any]


def keys(calls: Calls) -> set[tuple[str, str]]:
    """The kernels that are called, each with what for."""
    return {(name, purpose) for name, purposes in calls.items() for purpose in purposes}


def chosen(calls: Calls, wanted: set[tuple[str, str]]) -> Calls:
    """The calls of some kernels, each for some purpose."""
    found: Calls = {}
    for name, purpose in sorted(wanted):
        found.setdefault(name, {})[purpose] = calls[name][purpose]
    return found


def total(frames: Iterable[Calls]) -> Calls:
    """The calls of several frames together."""
    found: Calls = {}
    for calls in frames:
        for name, purposes in calls.items():
            for purpose, (times, elements) in purposes.items():
                here = found.setdefault(name, {}).setdefault(purpose, [0, 0])
                here[0] += times
                here[1] += elements
    return found


def reach(frames: Iterable[Calls]) -> dict[tuple[str, str], int]:
    """By kernel and purpose, how many elements a call has on average in the last of the frames that have one."""
    found = {}
    for calls in frames:
        for name, purposes in calls.items():
            found |= {(name, purpose): round(elements / times) for purpose, (times, elements) in purposes.items()}
    return found


def moved(row: Row) -> bool:
    """Whether something was solved or searched for in a frame, or would have been if there were a load."""
    return row["level"] > 0 or row["iterations"] > 0 or row.get("tried", 0) > 0
