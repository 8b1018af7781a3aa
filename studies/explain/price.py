"""What effects cost, from replays side by side: unknowns, entries, calls of kernels and time, by difference."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from restshape_studies.explain.calls import Row, chosen, keys, moved, reach, total
from restshape_studies.explain.filled import Filled
from restshape_studies.explain.variants import Names, Variants

from restshape.replay.frame_counts import Calls, difference
from restshape.replay.tally import beside

MESH = ("ms_relocate", "ms_map", "ms_flip", "ms_mesh")
PARTS = ("edit", "mesh", "observation", "record", "solve")
"""What the time of a frame is made of; `solve` is all that is none of the others."""
TWIN = "twin"
OVERLAP = "not determined: what effects take adds up to more than a frame, for some call for what others do"
ANOTHER_WAY = "not determined: without it another state is found, by a way of other length"
BY_STEP = "by difference of a Newton step: without it another state is found"
STEP_NOISE = 0.15
"""Of a share by Newton steps, by which it may be above 1: steps of two states differ in their iterations."""
OF_EFFECTS = np.array([0.0, 0.0, 1.0, 0.0, 1.0])
"""The parts that effects have a share in: of all others a difference would be noise."""


def parts(row: Row) -> list[float]:
    """Milliseconds of a frame's parts, in the order of `PARTS`."""
    edit, mesh, observed, beside_it = row["ms_edit"], sum(row[key] for key in MESH), row["ms_observe"], beside(row)
    return [edit, mesh, observed, beside_it, row["ms"] - edit - mesh - observed - beside_it]


@dataclass(frozen=True)
class Counts:
    """What an effect, or a whole scene, adds up to.

    Args:
        unknowns, entries: at the end.
        elements: of the mesh at the end; of an effect those that its kernels were last called on.
        calls: of kernels in all frames: calls and elements by kernel and purpose.
        filled: the entries by the kernels that fill them.
    """

    unknowns: int = 0
    elements: int = 0
    entries: int = 0
    calls: Calls = field(default_factory=dict)
    filled: Filled = field(default_factory=dict)

    def less(self, other: "Counts") -> "Counts":
        """What this has more than another."""
        return Counts(
            self.unknowns - other.unknowns,
            self.elements - other.elements,
            self.entries - other.entries,
            difference(self.calls, other.calls),
            {name: number for name in {*self.filled, *other.filled} if (number := self._shared(other, name))},
        )

    def _shared(self, other: "Counts", names: str) -> int:
        """How many entries that these kernels fill this has more than another."""
        return self.filled.get(names, 0) - other.filled.get(names, 0)


@dataclass(frozen=True)
class Prices:
    """The prices of the effects of a scene.

    Args:
        frames: that were measured: those in which something was solved for, the first one left out unless it is the
            only one.
        ms: of such a frame, on average.
        counts: by effect; under "" of what is always there.
        beside: calls of kernels off the frames' time.
        shares, spreads: of a frame's time, by effect and by part but "solve", under "" what is always there.
        problems: by effect, why it has no price.
        by_step: effects whose share is that of their Newton steps, as many as in the whole scene.
        reach: by kernel and purpose, on how many elements the last frame with calls of it called it, on average.
    """

    frames: int
    ms: float
    counts: dict[str, Counts]
    beside: Calls
    shares: dict[str, float]
    spreads: dict[str, float]
    problems: dict[str, str]
    reach: dict[tuple[str, str], int]
    by_step: Names = frozenset()


def prices(runs: Sequence[Sequence[Row]], tried: Variants, nonlinear: bool = False) -> Prices:
    """The prices from several runs of `paired.measure` with these variants, and the first of them once more as a twin.

    Of each frame the least time over all runs counts. A spread is half the range of what comes out without one of the
    runs and, for an effect, no less than the largest difference of the twins in a run; a share below 0 by no more than
    that is none. Of nonlinear equations one farther below 0, or above 1, is no price: they may have another solution
    without the effect, and the time to find that says nothing of the effect. What a Newton step takes with and
    without it does, times the steps of the whole scene; where there are none, or that is no share, there is no price.
    """
    sets = {names: k for k, names in enumerate(tried.sets)}
    count = len(sets) + 1
    tables = [_by_variant(rows, count) for rows in runs]
    failed = {row["variant"]: row["problem"] for row in runs[0] if "problem" in row}
    pairs = {name: (sets[pair.more], sets[pair.less]) for name, pair in (tried.differences | tried.alone).items()}
    reasons = {name: next((failed[k] for k in pair if k in failed), "") for name, pair in pairs.items()}
    problems = {name: f"not determined: without it {why}" for name, why in reasons.items() if why}
    counted = {name: pair for name, pair in pairs.items() if not reasons[name]}
    known = {name: pair for name, pair in counted.items() if name in tried.differences}
    frames = min(len(table[k]) for table in tables for k in range(count) if k not in failed)
    ms = [np.array([[parts(row) for row in table[k][:frames]] for table in tables]) for k in range(count)]
    shares, spreads = _shares(ms, known)
    twins = max(abs(_share(ms, {TWIN: (0, count - 1)}, [k])[TWIN]) for k in range(len(runs)))
    spreads |= {name: max(spreads[name], twins) for name in known}
    stray = {name for name in known if nonlinear and not -spreads[name] <= shares[name] <= 1.0 + spreads[name]}
    steps = [sum(row.get("newton", 0) for row in table[:frames]) for table in tables[0]]
    stepped = {name: share for name in stray if (share := _of_steps(ms, steps, *known[name])) is not None}
    problems |= dict.fromkeys(stray.difference(stepped), ANOTHER_WAY)
    known, counted = ({name: pair for name, pair in of.items() if name not in stray} for of in (known, counted))
    noise = {name for name in known if 0.0 > shares[name] >= -spreads[name]}
    shares, _ = _shares(ms, {name: pair for name, pair in known.items() if name not in noise})
    _level(shares, spreads)
    for name, share in stepped.items():
        # What other effects have, too, is theirs.
        shares[name] = min(share, max(shares[""], 0.0))
        shares[""] -= shares[name]
    spreads |= dict.fromkeys(stepped, twins)
    kept = [table[:frames] for table in tables[0]]
    found = reach(row["calls"] for table in reversed(kept) for row in table)
    counts = _counts(kept, counted, tried.drivers, found)
    average = float(ms[0].min(axis=0).sum(axis=1).mean())
    beside = total(row["calls_beside"] for row in tables[0][0][:frames])
    return Prices(
        frames,
        average,
        counts,
        beside,
        dict.fromkeys(noise, 0.0) | shares,
        spreads,
        problems,
        found,
        frozenset(stepped),
    )


def _by_variant(rows: Sequence[Row], count: int) -> list[list[Row]]:
    """The rows of the frames that are measured, by variant."""
    found: list[list[Row]] = [[] for _ in range(count)]
    for row in rows:
        if "problem" not in row:
            found[row["variant"]].append(row)
    # Where an edit is refused in one replay alone, they do not show the same.
    pairs = [pair for table in found[1:] for pair in zip(table, found[0])]
    odd = {row["index"] for row, whole in pairs if bool(row.get("refused")) != bool(whole.get("refused"))}
    later = [row for row in found[0][1:] if row["index"] not in odd]
    measured = {row["index"] for row in [row for row in later if moved(row)] or later or found[0][:1]}
    return [[row for row in table if row["index"] in measured] for table in found]


def _shares(ms: list[np.ndarray], known: dict[str, tuple[int, int]]) -> tuple[dict[str, float], dict[str, float]]:
    """Shares by name, and their spreads, from times (runs, frames, parts) of the variants."""
    runs = range(len(ms[0]))
    found = _share(ms, known, list(runs))
    others = [_share(ms, known, [k for k in runs if k != out]) for out in runs] if len(runs) > 1 else [found]
    spreads = {name: 0.5 * float(np.ptp([other[name] for other in others])) for name in found}
    return found, spreads


def _share(ms: list[np.ndarray], known: dict[str, tuple[int, int]], runs: list[int]) -> dict[str, float]:
    least = {k: times[runs].min(axis=0).mean(axis=0) for k, times in enumerate(ms) if times.size}
    rest, whole = least[0].copy(), float(least[0].sum())
    shares = {}
    for name, (more, less) in known.items():
        price = OF_EFFECTS * (least[more] - least[less])
        shares[name] = float(price.sum()) / whole
        rest -= price
    named = dict(zip(PARTS, (rest / whole).tolist()))
    return shares | {"": named.pop("solve")} | named


def _level(shares: dict[str, float], spreads: dict[str, float]) -> None:
    """Take what the clock alone has put below 0 of what is observed, and of the rest, off the largest share."""
    for name in ("observation", ""):
        if -spreads.get(name, 0.0) <= shares[name] < 0.0:
            largest = max(shares, key=shares.__getitem__)
            shares[largest], shares[name] = shares[largest] + shares[name], 0.0


def _of_steps(ms: list[np.ndarray], steps: list[int], more: int, less: int) -> float | None:
    """The share of an effect by what a Newton step takes with and without it; None where that is none.

    Args:
        ms: times (runs, frames, parts) of the variants; steps: of them in these frames.
        more, less: variants with and without the effect.
    """
    if not steps[more]:
        return None
    solve = PARTS.index("solve")
    whole, one, other = (ms[k].min(axis=0).sum(axis=0) for k in (0, more, less))
    # Without steps nothing moves: then the effect has all of them.
    without = other[solve] / (steps[less] or steps[more])
    share = float((one[solve] / steps[more] - without) * steps[0] / whole.sum())
    return min(max(share, 0.0), 1.0) if share <= 1.0 + STEP_NOISE else None


def _counts(
    tables: list[list[Row]], known: dict[str, tuple[int, int]], drivers: Names, reached: dict[tuple[str, str], int]
) -> dict[str, Counts]:
    """By name; what no kernel is called for without an effect is this effect's alone, and a driver has nothing else."""
    whole = [_count(rows) for rows in tables]
    found = {name: whole[more].less(whole[less]) for name, (more, less) in known.items()}
    owners = {at: name for name, (_, less) in known.items() for at in keys(whole[0].calls) - keys(whole[less].calls)}
    for name, counts in found.items():
        default = "" if name in drivers else name
        own = {at for at in keys(counts.calls) if owners.get(at, default) == name}
        found[name] = replace(counts, calls=chosen(counts.calls, own))
    rest = whole[0]
    for counts in found.values():
        rest = rest.less(counts)
    widened = {name: replace(counts, elements=widest(counts.calls, reached)) for name, counts in found.items()}
    return widened | {"": rest}


def widest(calls: Calls, reached: dict[tuple[str, str], int]) -> int:
    """The most elements that one of these kernels is called on; those that are taken away from others do not count."""
    return max((reached[name, purpose] for name, purpose in keys(calls) if calls[name][purpose][0] > 0), default=0)


def _count(rows: list[Row]) -> Counts:
    if not rows:
        return Counts()
    last = rows[-1]
    calls = total(row["calls"] for row in rows)
    return Counts(last["unknowns"], last["elements"], last["entries"], calls, last["filled"])
