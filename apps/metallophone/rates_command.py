"""`restshape rates`: how the tones of a plate follow its numbers and its outline."""

import argparse
from typing import Any

from restshape_apps.metallophone.stage import add_frame, analysed

from restshape.cli.options import add_json, print_table, write_json
from restshape.errors import UserError


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    add_frame(parser)
    parser.add_argument("--by", action="append", default=[], metavar="KEY", help="a number of the scene (default: all)")
    parser.add_argument("--outline", action="store_true", help="also by the outline, as a density along each edge")
    parser.add_argument("--underneath", action="store_true", help="also by the thickness at each place")
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Print, and write for programs; 0."""
    analysis = analysed(args)
    from restshape_apps.metallophone.derivative import (
        along_outline,
        keys_of,
        print_outline,
        print_underneath,
        underneath,
    )

    from restshape.sensitivity.parameter_derivative import number_at, parameter_derivatives

    by, left_out = {}, {}
    for key in args.by or keys_of(analysis):
        try:
            by[key] = number_at(analysis, key), parameter_derivatives(analysis, key)
        except UserError as error:
            if args.by:
                raise
            left_out[key] = error.what
    frequencies = analysis.frequencies
    heads = ("p", "value (SI)", *(f"mode {k}: {f:.1f} Hz" for k, f in enumerate(frequencies, 1)))
    rows = [
        (key, f"{p:.6g}", *(f"{p * d / f:+.5f}" for d, f in zip(found, frequencies))) for key, (p, found) in by.items()
    ]
    print_table("relative derivatives: p df/dp / f", heads, rows, right=heads[1:])
    for key, why in left_out.items():
        print(f"left out: {key}: {why}")
    derivatives_found: dict[str, Any] = {
        "frequencies": frequencies.tolist(),
        "by": {key: {"value": p, "derivatives": found.tolist()} for key, (p, found) in by.items()},
    }
    if args.outline:
        derivatives_found["outline"] = along_outline(analysis)
        print_outline(derivatives_found["outline"])
    if args.underneath:
        derivatives_found["underneath"] = underneath(analysis)
        print_underneath(derivatives_found["underneath"])
    write_json(args, derivatives_found)
    return 0
