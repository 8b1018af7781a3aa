"""The tables of a replay's quantities: values, estimated errors, jumps of the mesh, and what is to be said of them."""

from __future__ import annotations

from typing import Any

from restshape.cli.options import print_table
from restshape.cli.quantity_cells import MISSING, cells
from restshape.outputs.si_numbers import si

SINGULAR = "singular"
LARGEST, OF_SOLVED = "largest estimated error", ", solved frames"
AHEAD = "largest distance, predicted"
PREDICTED_NOTE = "values of predicted frames are further off: see the estimated distance from the solution above"


def print_quantities(summary: dict[str, Any]) -> None:
    """Prints what a summary of a replay says of quantities; what is rounding alone is shown as 0."""
    from restshape.replay.singular_notes import ESTIMATES_NOTE, singular_notes

    quantities, errors, sizes = summary["quantities"], summary["quantity_errors"], summary["scales"]
    units, beside = summary.get("units", {}), summary.get("beside", {})
    distances = summary.get("predicted_distances", {})
    said = any(map(any, beside.values()))
    head = LARGEST + (OF_SOLVED if summary["predicted"] else "")
    heads = ("quantity", "first", "last", "min", "max") + ((head,) if errors else ())
    rows = []
    for name, values in quantities.items():
        unit, size = units.get(name, ""), sizes[name]
        row = [name, *cells(_ends(values, size), unit)]
        row += [_largest(errors.get(name, []), size, unit)] if errors else []
        row += [_largest([distances[name]] if name in distances else [], size, unit)] if distances else []
        rows.append([*row, *(beside.get(name, ()) if said else ())])
    heads += (AHEAD,) if distances else ()
    heads += ("first note", "last note") if said else ()
    print_table("quantities", heads, rows, right=heads[1:])
    if any(isinstance(error, float) for known in errors.values() for error in known):
        print(ESTIMATES_NOTE)
        if summary["predicted"]:
            print(PREDICTED_NOTE)
    _print_jumps(summary["jumps"], sizes, units)
    for note in singular_notes(summary["singular"]):
        print(note)


def _print_jumps(jumps: dict[str, Any], sizes: dict[str, float], units: dict[str, str]) -> None:
    """Prints the table of jumps, without quantities that are zero."""
    from restshape.replay.rounding import cleared

    heads, rows = ("quantity", "largest jump", "share of the largest value", "frame"), []
    for name, one in jumps.items():
        if one["share"] is not None:
            size = cleared(one["largest"], sizes[name])
            share = percent(one["share"] if size else 0.0)
            rows.append((name, si(size, units.get(name, ""), 2), share, one["frame"] if size else "-"))
    if rows:
        print_table("jumps where the mesh changed", heads, rows, right=heads[1:])


def _largest(errors: list[float | str | None], size: float, unit: str) -> str:
    """The largest error of a quantity; a dash where there is none."""
    from restshape.replay.rounding import cleared

    if any(error == SINGULAR for error in errors):
        return SINGULAR
    known = [error for error in errors if isinstance(error, float)]
    return about(cleared(max(known), size), unit) if known else MISSING


def _ends(values: list[float | None], size: float) -> list[float | None]:
    """First, last, smallest and largest of the values of a quantity; None where there is no number."""
    from restshape.replay.rounding import cleared

    finite = [value for value in values if value is not None]
    found = (values[0], values[-1], min(finite, default=None), max(finite, default=None))
    return [None if value is None else cleared(value, size) for value in found]


def percent(share: float) -> str:
    """A share in per cent, with two digits; 0 where it is rounding alone."""
    from restshape.replay.rounding import cleared

    share = cleared(share, 1.0)
    return f"{100 * share:.2g} %" if share < 0.995 else f"{100 * share:.0f} %"


def about(error: float, unit: str = "") -> str:
    """An estimated error in words: it is no bound."""
    return f"about {si(error, unit, 2)}" if error else "0"
