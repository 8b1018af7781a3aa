"""A model of frames on more ranks: counted work over measured rates, and messages; checked on what was run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import log2, sqrt
from typing import Any

Row = dict[str, Any]
LEVEL = "1"
SHARED, OBSERVED = ("values", "factor", "krylov"), ("observe", "estimate")
"""Stages whose work is shared among ranks, and those that are so where ranks share what is observed; the others are
whole on each of them (docs/parallel.md)."""
DOUBLINGS = 6
"""Times that the largest number of ranks is doubled beyond what was run."""
SCHWARZ = 0.25
"""Power of the number of ranks with which iterations grow that subdomains of a shape in the plane cause, without a
coarse space. Source: A. Toselli and O. Widlund, Domain Decomposition Methods (2005), section 3: the condition number
goes as one over the width of a subdomain."""
GROWN = 1.5
"""Iterations over those of one rank from which on they are taken to grow so."""
ASSUMED = (
    "stages that are whole on each rank stay as they are, shared ones go with the rank's cells, or with bytes an "
    "iteration, over bandwidth; messages of a solve cost the latency and bandwidth measured here; beyond what was run "
    "machines are like this one with all cores at work, messages cost there what they do here, and iterations grow as "
    "subdomains make them, or stay"
)


@dataclass(frozen=True)
class Load:
    """What the busiest rank does in a frame.

    Args:
        cells: that touch its nodes, of all.
        observed: cells whose stresses it recovers.
        whole: cells of the whole mesh.
        iterations: of the solve.
        iteration_bytes: that it passes in each.
        rate: bytes a second that it has for itself while all work.
        reductions, messages, message_bytes: of the solve.
        latency, message_s: seconds of a sum over the ranks and of a message; message_rate: bytes a second of one.
    """

    cells: float
    observed: float
    whole: float
    iterations: float
    iteration_bytes: float
    rate: float
    reductions: float
    messages: float
    message_bytes: float
    latency: float
    message_s: float
    message_rate: float

    @property
    def exchange_ms(self) -> float:
        """Milliseconds of sums and messages."""
        moved = self.message_bytes / self.message_rate if self.message_rate else 0.0
        return 1e3 * (self.reductions * self.latency + self.messages * self.message_s + moved)


def frame_ms(stages: Mapping[str, float], first: Load, load: Load) -> dict[str, float]:
    """Milliseconds of each stage of a frame on other ranks, and of `messages`.

    Args:
        stages: measured on the first number of ranks.
        first: the load there.
        load: the load there that is asked for.
    """
    slower = first.rate / load.rate
    shares = dict.fromkeys(stages, load.whole / first.whole)
    for name in SHARED:
        shares[name] = load.cells / first.cells * slower
    if load.observed < load.whole:
        shares |= dict.fromkeys(OBSERVED, load.observed / first.observed * slower)
    if first.iterations * first.iteration_bytes > 0.0:
        bytes_moved = load.iterations * load.iteration_bytes
        shares["krylov"] = bytes_moved / (first.iterations * first.iteration_bytes) * slower
    found = {name: ms * shares[name] for name, ms in stages.items()}
    return found | {"messages": max(0.0, load.exchange_ms - first.exchange_ms)}


def model(entries: Sequence[Row], machine: Mapping[str, Row], mode: str) -> Row | None:
    """The model of a level-1 frame beside what was measured, and beyond it.

    Args:
        entries: of `restshape_studies.bench.scaling`, ascending.
        machine: ranks -> bandwidth and latencies.
        mode: "strong" or "weak".

    Returns: assumed (words), level, checked and beyond: lists of ranks, ms, measured_ms, error (relative) and stages;
        None with one number of ranks, or without frames that move nodes.
    """
    known = [one for one in entries if one["levels"][LEVEL]]
    if len(known) < 2 or known[0] is not entries[0]:
        return None
    loads = [_load(one, machine[str(one["ranks"])]) for one in known]
    stages = known[0]["levels"][LEVEL]["stages"]
    checked = []
    for one, load in zip(known[1:], loads[1:]):
        modelled = frame_ms(stages, loads[0], load)
        measured, ms = one["levels"][LEVEL]["ms"], sum(modelled.values())
        found = {"ranks": one["ranks"], "ms": ms, "measured_ms": measured, "error": ms / measured - 1.0}
        checked.append(found | {"stages": modelled})
    last, beyond = known[-1]["ranks"], []
    for doubling in range(1, DOUBLINGS + 1):
        modelled = frame_ms(stages, loads[0], _beyond(loads[0], loads[-1], last, 2**doubling, mode))
        beyond.append({"ranks": last * 2**doubling, "ms": sum(modelled.values()), "stages": modelled})
    return {"assumed": ASSUMED, "level": int(LEVEL), "checked": checked, "beyond": beyond}


def _load(one: Row, machine: Row) -> Load:
    level, ranks = one["levels"][LEVEL], one["ranks"]
    return Load(
        cells=max(one["cells"]),
        observed=max(one["observed"]),
        whole=one["all_cells"],
        iterations=level["iterations"],
        iteration_bytes=one["iteration_bytes"],
        rate=(one["bandwidth"] or machine["bandwidth"]) / ranks,
        reductions=level["reductions"],
        messages=level["messages"],
        message_bytes=level["message_bytes"],
        latency=machine["latency_s"],
        message_s=machine["message_s"],
        message_rate=machine["message_bandwidth"],
    )


def _beyond(first: Load, last: Load, ranks: int, times: int, mode: str) -> Load:
    """The load on `times` as many ranks as were run; parts of a shape in the plane, of which a border is a line."""
    grown = last.iterations > GROWN * first.iterations
    growth = times**SCHWARZ if grown else 1.0
    share = 1.0 if mode == "weak" else 1.0 / times
    even, whole = last.whole / ranks, last.whole * (times if mode == "weak" else 1.0)
    around = max(0.0, last.observed - even)
    # A part inside the shape has about four neighbours; one of two has one.
    neighbours = 4.0 if ranks < 4 else 1.0
    return Load(
        cells=even * share + max(0.0, last.cells - even) * sqrt(share),
        observed=even * share + around * sqrt(share) if last.observed < last.whole else whole,
        whole=whole,
        iterations=last.iterations * growth,
        iteration_bytes=last.iteration_bytes * share,
        rate=last.rate,
        reductions=last.reductions * growth,
        messages=last.messages * growth * neighbours,
        message_bytes=last.message_bytes * growth * neighbours * sqrt(share),
        latency=last.latency * log2(ranks * times) / max(1.0, log2(ranks)),
        message_s=last.message_s,
        message_rate=last.message_rate,
    )
