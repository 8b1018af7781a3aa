"""Tables of the derivative of a drape: by a hand on its pattern, and by the numbers of its scene."""

import math
from collections.abc import Mapping
from typing import Any

from restshape.cli.options import print_table

STATES = {"sticks": "where it sticks", "slides": "slides", "free": "is free"}


def show_drape(name: str, found: Mapping[str, Any]) -> None:
    """Print derivatives of a drape, with their remainders where these are known."""
    if found["remainders"]:
        _show_hand(name, found)
    if found["numbers"]:
        _show_numbers(name, found["numbers"])
    times, (first, second) = found["ms"], found["residuals"]
    print(
        f"both derivatives by hand take {times['least']:.1f} ms (median {times['median']:.1f}), and "
        f"{times['processor']:.1f} ms of the processor, with their factor at hand, at {found['nodes']} nodes: "
        f"{found['iterations']} iterations, residuals {first:.1e} and {second:.1e}"
    )
    print(
        f"{found['sticking']} places stick, {found['sliding']} slide, {found['free']} nodes are free of friction"
        f"{'; ' + found['note'] if found['note'] else ''}"
    )


def _show_hand(name: str, found: Mapping[str, Any]) -> None:
    heads = ("step / size", "remainder along x", "order", "along y", "order")
    rows = []
    for i, step in enumerate(found["steps"]):
        cells = [f"{step:.1e}"]
        for values in found["remainders"]:
            one, before = values[i], values[i - 1] if i else None
            cells += ["no rest" if one is None else f"{one:.2e}", f"{order(before, one, found['steps'], i)}"]
        rows.append(tuple(cells))
    title = f"{name}: {found['edge']} by hand: remainders over the derivative times the step; {found['nodes']} nodes"
    print_table(title, heads, rows, right=heads)


def _show_numbers(name: str, numbers: Mapping[str, Any]) -> None:
    heads = (
        "number",
        "value (SI)",
        "motion [m] a unit",
        "step",
        "remainder",
        "of half of it",
        "order",
        *STATES.values(),
    )
    rows = []
    for one in numbers["rows"]:
        cells = ["no rest" if part is None else f"{part:.1e}" for part in one["remainders"]]
        orders = [one["order"], *(one["orders"][key] for key in STATES)]
        seen = ["" if found is None else f"{found:.2f}" for found in orders]
        rows.append((one["key"], f"{one['value']:.6g}", f"{one['motion']:.3g}", f"{one['step']:.1e}", *cells, *seen))
    title = f"{name}: by numbers of the scene: remainders over the derivative times the step, and their orders"
    print_table(title, heads, rows, right=heads[1:])
    if numbers["idle"]:
        print(f"nothing follows {', '.join(numbers['idle'])}")
    for key, why in numbers["left_out"].items():
        print(f"left out: {key}: {why}")


def order(before: float | None, after: float | None, steps: list[float], i: int) -> str:
    """The order of the whole remainder, from two that are relative to the step; empty where there are none."""
    if before is None or after is None or not after or not before:
        return ""
    return f"{1.0 + math.log(before / after) / math.log(steps[i - 1] / steps[i]):.2f}"
