"""How `--regret` and `bench regret` print counted work beside the best that could have been done."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

from restshape.cli.options import print_table

if TYPE_CHECKING:
    from restshape.variation.regret import Regret, Work

WAYS: tuple[Literal["run"], Literal["best"]] = ("run", "best")
HEADS = ("scene", "auto, ms", "best policy", "ms", "auto over it", "its schedule, ms", "the best, ms", "over it")
"""Heads of a row of a scene."""


def row(name: str, found: Regret) -> list[str]:
    """One scene's row of the table of scenes, from what `variation.regret.measure` found."""
    policies, best, schedule = found["policies"], found["best"], found["hindsight"]
    least = policies[best]["seconds"]
    work = [f"{1e3 * policies['auto']['seconds']:.4g}", best, f"{1e3 * least:.4g}", f"{found['over_policy']:.3f}"]
    return [name, *work, *(f"{1e3 * schedule[way]:.4g}" for way in WAYS), f"{found['over_schedule']:.3f}"]


def total(found: Sequence[Regret]) -> list[str]:
    """The row of all scenes together."""
    auto = sum(one["policies"]["auto"]["seconds"] for one in found)
    least = sum(one["policies"][one["best"]]["seconds"] for one in found)
    run, best = (sum(one["hindsight"][way] for one in found) for way in WAYS)
    work = [f"{1e3 * auto:.4g}", "", f"{1e3 * least:.4g}", _ratio(auto, least)]
    return ["all", *work, f"{1e3 * run:.4g}", f"{1e3 * best:.4g}", _ratio(run, best)]


def print_regret(found: Regret) -> None:
    """Print the table of a replay: what each policy costs, and the best schedule."""
    auto, schedule = found["policies"]["auto"]["seconds"], found["hindsight"]
    rows = [_work_row(name, one, auto) for name, one in found["policies"].items()]
    heads = ("policy", "counted work, ms", "iterations", "factors", "auto over it")
    print_table("counted work of linear solves, by the calibration", heads, rows, right=heads[1:])
    for name, one in found["policies"].items():
        if one["ended"] is not None:
            print(f"{name} was ended after frame {one['ended']}: it cannot be the best any more")
    rows = [
        [label, f"{1e3 * seconds:.4g}", str(schedule["iterations"][key]), str(schedule["refreshes"][key])]
        for label, key, seconds in (
            ("auto's", "run", schedule["run"]),
            ("the best in hindsight", "best", schedule["best"]),
        )
    ]
    heads = ("schedule of refreshes", "counted work, ms", "iterations", "refreshes")
    print_table("", heads, rows, right=heads[1:])
    print(
        f"auto: {found['over_policy']:.3f} times the best policy, {found['best']}; "
        f"{found['over_schedule']:.3f} times the best schedule in hindsight"
    )


def _work_row(name: str, one: Work, auto: float) -> list[str]:
    """A policy's row: of one that was ended, what it had cost by then is a bound."""
    more, less = ("", "") if one["ended"] is None else ("more than ", "less than ")
    work = f"{more}{1e3 * one['seconds']:.4g}"
    return [name, work, str(one["iterations"]), str(one["factors"]), f"{less}{_ratio(auto, one['seconds'])}"]


def _ratio(one: float, other: float) -> str:
    return f"{one / other:.3f}" if other else "-"
