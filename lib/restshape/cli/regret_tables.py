"""How `--regret` and `bench regret` print counted work beside the best that could have been done."""

from __future__ import annotations

from typing import TYPE_CHECKING

from restshape.cli.options import print_table

if TYPE_CHECKING:
    from restshape.replay.regret import Regret

HEADS = ("scene", "auto, ms", "best policy", "ms", "auto over it", "best schedule, ms", "auto's over it")
"""Heads of a row of a scene."""


def row(name: str, found: Regret) -> list[str]:
    """One scene's row of the table of scenes, from what `replay.regret.measure` found."""
    policies, best, schedule = found["policies"], found["best"], found["hindsight"]
    least, ahead = policies[best]["seconds"], schedule["best"]
    work = [f"{1e3 * policies['auto']['seconds']:.4g}", best, f"{1e3 * least:.4g}", f"{found['over_policy']:.3f}"]
    return [name, *work, f"{1e3 * ahead:.4g}", f"{found['over_schedule']:.3f}"]


def print_regret(found: Regret) -> None:
    """Print the table of a replay: what each policy costs, and the best schedule."""
    auto, schedule = found["policies"]["auto"]["seconds"], found["hindsight"]
    rows = [
        [name, f"{1e3 * one['seconds']:.4g}", str(one["iterations"]), str(one["factors"]), _ratio(auto, one["seconds"])]
        for name, one in found["policies"].items()
    ]
    heads = ("policy", "counted work, ms", "iterations", "factors", "auto over it")
    print_table("counted work of linear solves, by the calibration", heads, rows, right=heads[1:])
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


def _ratio(one: float, other: float) -> str:
    return f"{one / other:.3f}" if other else "-"
