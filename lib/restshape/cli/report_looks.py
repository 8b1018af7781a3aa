"""How pictures of a report look: options of `restshape report`."""

import argparse
from dataclasses import dataclass

from restshape.errors import UserError

DPI, LEAST_DPI, MOST_DPI = 150, 30, 1200
THINGS = ("mesh", "goal", "vectors", "supports", "loads", "hand", "names")
"""What frames may show besides the field."""
USUAL = "mesh,goal"


@dataclass(frozen=True)
class Looks:
    """What the options say.

    Args:
        field: name of the field that gives the colours; None: see `report.field.shown_field`.
        ends: values at the ends of the colours in SI units; None: those of all frames.
        view: xmin, xmax, ymin, ymax [m] of the part that is shown; None: all.
        things: what frames show besides the field.
        dpi: pixels an inch of still pictures; suffix: of their files.
        of_plane: options that were given and count for shapes in the plane alone.
    """

    field: str | None
    ends: tuple[float, float] | None
    view: tuple[float, float, float, float] | None
    things: tuple[str, ...]
    dpi: int
    suffix: str
    of_plane: tuple[str, ...]


def add_looks(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    what = "field that gives the colours, such as stress_xx or displacement (default: that of the quantities)"
    parser.add_argument("--field", metavar="NAME", help=what)
    what = "values at the ends of the colours in the field's SI unit, such as 0,250e6 (default: those of all frames)"
    parser.add_argument("--range", metavar="LOW,HIGH", help=what)
    what = "the part that frames show, in metres (default: all)"
    parser.add_argument("--view", metavar="X,X,Y,Y", help=what)
    what = f"what frames show besides the field: of {', '.join(THINGS)} some, with commas; or none (default {USUAL})"
    parser.add_argument("--show", metavar="WHAT", help=what)
    parser.add_argument("--dpi", metavar="N", type=int, default=DPI, help=f"of still pictures (default {DPI})")
    parser.add_argument("--format", choices=("png", "svg"), default="png", help="of still pictures (default png)")


def read_looks(args: argparse.Namespace) -> Looks:
    """What the options say.

    Raises:
        UserError: one makes no sense.
    """
    if not LEAST_DPI <= args.dpi <= MOST_DPI:
        raise UserError(f"pixels an inch must be between {LEAST_DPI} and {MOST_DPI}", f"--dpi {args.dpi}", "--dpi 300")
    given = tuple(f"--{name}" for name in ("field", "range", "view", "show", "at") if getattr(args, name, None))
    ends = None if args.range is None else _ends(args.range)
    view = None if args.view is None else _view(args.view)
    return Looks(args.field, ends, view, _things(args.show or USUAL), args.dpi, f".{args.format}", given)


def _ends(text: str) -> tuple[float, float]:
    try:
        low, high = map(float, text.split(","))
    except ValueError:
        low = high = float("nan")
    if not -float("inf") < low < high < float("inf"):
        raise UserError("a range is two numbers, the smaller one first", f"--range {text}", "--range 0,250e6")
    return low, high


def _view(text: str) -> tuple[float, float, float, float]:
    try:
        left, right, below, above = map(float, text.split(","))
    except ValueError:
        left = right = below = above = float("nan")
    if not (left < right and below < above):
        what, do = "a view is four numbers: x from and to, y from and to", "--view -0.03,0.17,-0.045,0.045"
        raise UserError(what, f"--view {text}", do)
    return left, right, below, above


def _things(text: str) -> tuple[str, ...]:
    found = tuple(filter(None, (word.strip() for word in text.split(",")))) if text != "none" else ()
    for word in found:
        if word not in THINGS:
            raise UserError(
                f"frames cannot show {word!r}", f"--show {text}", f"use some of {','.join(THINGS)}, or none"
            )
    return found
