"""The Pareto front of error and time, its slope, and the choice of a point on it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from restshape.errors import UserError

Row = dict[str, Any]

CLEAR = 10.0
"""How many times as large as what the solver leaves an error is that shows the mesh."""


def pareto(pairs: Sequence[tuple[float, float]]) -> list[bool]:
    """For each pair of costs whether no other pair is at least as small in both and smaller in one."""
    order = sorted(range(len(pairs)), key=lambda i: pairs[i])
    best, front = np.inf, [False] * len(pairs)
    last: tuple[float, float] | None = None
    for i in order:
        # Equal pairs stand or fall together.
        front[i] = pairs[i][1] < best or pairs[i] == last
        if front[i]:
            best, last = pairs[i][1], pairs[i]
    return front


def usable(records: Sequence[Row]) -> list[Row]:
    """The records that have a time and an error."""
    return [record for record in records if record["error"] is not None and record["frame_ms"]]


def mark_pareto(records: Sequence[Row]) -> None:
    """Set `pareto` in every record; errors that read alike in three digits count as equal."""
    good = usable(records)
    marks = pareto([(record["frame_ms"], float(f"{record['error']:.3g}")) for record in good])
    for record in records:
        record["pareto"] = False
    for record, mark in zip(good, marks):
        record["pareto"] = mark


def front_of(records: Sequence[Row]) -> list[Row]:
    """The records on the front, fastest first."""
    return sorted((record for record in records if record["pareto"]), key=lambda record: record["frame_ms"])


def exponent(x: Sequence[float], y: Sequence[float]) -> float | None:
    """The p of y ~ x^p by least squares of logarithms; None with fewer than two different x, or where a y is 0."""
    if len(set(x)) < 2 or min(y) <= 0.0:
        return None
    return float(np.polyfit(np.log(x), np.log(y), 1)[0])


def slope(records: Sequence[Row]) -> float | None:
    """The p of error ~ time^p along the front, without points that the reference cannot distinguish from itself."""
    known = [record for record in front_of(records) if not record["below_reference"]]
    return exponent([r["frame_ms"] for r in known], [r["error"] for r in known]) if len(known) > 2 else None


def rates(records: Sequence[Row], policy: str) -> dict[str, dict[str, float]]:
    """Measure or quantity -> order -> p of error ~ (mesh size)^p, over the points of the grid with a policy.

    Points are left out whose error is below the reference's own uncertainty, or owed to the solver.
    """
    found: dict[str, dict[str, float]] = {}
    grid = [r for r in usable(records) if not r["varied"] and r["policy"] == policy]
    names = [*(grid[0]["errors"] if grid else {}), *(f"q_{name}" for name in (grid[0]["quantities"] if grid else {}))]
    for name in names:
        for order in sorted({record["order"] for record in grid}):
            points = []
            for record in (r for r in grid if r["order"] == order):
                entry = record["quantities"].get(name[2:]) if name.startswith("q_") else record["errors"].get(name)
                known = entry and entry["worst"] and entry["worst"] > max(entry["uncertainty"], CLEAR * entry["solver"])
                if known:
                    points.append((record["size"], entry["worst"]))
            if len(points) > 1:
                p = exponent(*zip(*points))
                if p is not None:
                    found.setdefault(name, {})[str(order)] = p
    return found


@dataclass(frozen=True)
class Rivals:
    """How the values of a key compare; None stands for the scene's own.

    Args:
        ms: a time of a frame in the middle of what all values span [ms].
        then: the error of each at that time; both empty where they have no time in common.
        finest: of each with its finest mesh the error, and the p of error ~ (mesh size)^p over its two finest.
    """

    ms: float
    then: dict[Any, float]
    finest: dict[Any, tuple[float, float]]


def rivals(records: Sequence[Row]) -> dict[str, Rivals]:
    """The values of each key that was tried with several mesh sizes, in two sizes at least."""
    found, good = {}, usable(records)
    for key in dict.fromkeys(r["varied"] for r in good if r["varied"]):
        own = [r for r in good if r["varied"] == key]
        like = {"varied": "", "policy": own[0]["policy"], "order": own[0]["order"]}
        lines = {None: [r for r in good if like.items() <= r.items()]}
        for record in own:
            lines.setdefault(record["given"], []).append(record)
        if min(len({r["size"] for r in line}) for line in lines.values()) < 2 or not all(r["error"] for r in own):
            continue
        points = {value: sorted((r["frame_ms"], r["error"]) for r in line) for value, line in lines.items()}
        start, end = (pick(line[k][0] for line in points.values()) for pick, k in ((max, 0), (min, -1)))
        ms = float(np.sqrt(start * end)) if start < end else 0.0
        then = {value: _at(line, ms) for value, line in points.items()} if ms else {}
        found[key] = Rivals(ms, then, {value: _finest(line) for value, line in lines.items()})
    return found


def _finest(line: list[Row]) -> tuple[float, float]:
    """The error with the finest mesh, and the p of error ~ (mesh size)^p over the two finest."""
    fine, coarse = sorted(line, key=lambda record: record["size"])[:2]
    return fine["error"], exponent([fine["size"], coarse["size"]], [fine["error"], coarse["error"]]) or 0.0


def _at(line: list[tuple[float, float]], ms: float) -> float:
    """The error at a time: points (time, error), sorted by time, are joined by straight lines of logarithms.

    It is no more than any faster point has.
    """
    times, errors = np.log(np.array(line)).T
    return float(np.exp(np.interp(np.log(ms), times, np.minimum.accumulate(errors))))


def known_error(record: Row) -> float:
    """The error that a record is known to be below: its own, but none that the reference cannot resolve."""
    return max(record["error"], record["uncertainty"] or 0.0)


def picks(records: Sequence[Row], within: float | None, error: float | None, diverges: str = "") -> list[Row]:
    """The most accurate record within a time, or the fastest below an error; then those to try where it does not hold.

    With both bounds the most accurate comes first. After it each record is faster than all before where a time is
    asked for, else more accurate.

    Args:
        records: of a study.
        within: median time of a frame [ms].
        error: relative.
        diverges: why no finer point can be below an error; empty where one can.

    Raises:
        UserError: there is none.
    """
    good = usable(records)
    if not good:
        raise UserError("no point of the study has both a time and an error", "--within, --error", "see what failed")
    kept = [r for r in good if within is None or r["frame_ms"] <= within]
    if not kept:
        nearest = min(good, key=lambda r: r["frame_ms"])
        raise UserError(
            f"no point is within {within:.4g} ms: the fastest, {nearest['name']}, takes {nearest['frame_ms']:.4g} ms "
            f"with an error of {percent(nearest['error'])}",
            "--within",
            "allow that time, or try coarser ones: --sizes 4,2,1",
        )
    below = [r for r in kept if error is None or known_error(r) < error]
    vague = [r for r in kept if error is not None and r["error"] < error]
    if diverges and not below:
        nearest = min(kept, key=lambda r: r["error"])
        raise UserError(
            f"no point has an error below {percent(error)}, and no finer one will: {diverges}; the most accurate, "
            f"{nearest['name']}, has {percent(nearest['error'])}",
            "--error",
            "study another quantity: the stress elsewhere or averaged, a displacement, an energy",
        )
    if vague and not below:
        raise UserError(
            f"no point is known to have an error below {percent(error)}: the reference itself is known to "
            f"{percent(vague[0]['uncertainty'])} only, though {vague[0]['name']} is {percent(vague[0]['error'])} off",
            "--error",
            "allow that error, or have a finer reference by finer points: --sizes 1,0.5,0.25",
        )
    if not below:
        nearest = min(kept, key=lambda r: r["error"])
        raise UserError(
            f"no point{'' if within is None else ' within the time'} has an error below {percent(error)}: the most "
            f"accurate, {nearest['name']}, has {percent(nearest['error'])} and takes {nearest['frame_ms']:.4g} ms",
            "--error",
            "allow that error, or try finer ones: --sizes 1,0.5,0.25",
        )
    return _in_turn(below, by_time=within is None)


def _in_turn(records: Sequence[Row], by_time: bool) -> list[Row]:
    """Records by time, each more accurate than all before, or by error, each faster than all before."""
    if by_time:
        ranked = sorted(records, key=lambda record: (record["frame_ms"], record["error"]))
    else:
        # Errors that read alike are one, as on the front.
        ranked = sorted(records, key=lambda record: (float(f"{known_error(record):.3g}"), record["frame_ms"]))
    gain, kept = "error" if by_time else "frame_ms", []
    for record in ranked:
        if not kept or record[gain] < kept[-1][gain]:
            kept.append(record)
    return kept


def percent(error: float | None) -> str:
    """A relative error for people."""
    return "–" if error is None else f"{100.0 * error:.3g} %"


def finite(value: Any) -> Any:
    """The same data with None for what is no finite number, as JSON wants it."""
    if isinstance(value, Mapping):
        return {key: finite(part) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [finite(part) for part in value]
    if isinstance(value, float):
        return value if np.isfinite(value) else None
    return value
