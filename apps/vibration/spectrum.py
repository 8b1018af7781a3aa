"""The response spectrum of a record of ground acceleration.

restshape spectrum RECORD [--damping Z ...] [--csv FILE] [--picture FILE]

For each damping: the largest displacement S_d of oscillators on this ground, the pseudo-velocity w S_d, and the
pseudo-acceleration w^2 S_d. The record is linear between its samples, and the motion exact (Nigam and Jennings).
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from restshape.analysis.motion.response_spectrum import ResponseSpectrum, response_spectrum
from restshape.cli.options import add_json, print_table, write_json
from restshape.errors import UserError
from restshape.outputs.atomic_files import write_whole
from restshape.outputs.kinds import PictureFile, TableFile
from restshape.physics.elasticity.ground_record import GroundRecord, read_record

SHOWN = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0)
"""Periods [s] that are printed, where they are in the range."""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("record", type=Path, metavar="RECORD", help="record of accelerations (.csv, .at2)")
    parser.add_argument(
        "--damping", type=float, nargs="+", default=[0.05], metavar="Z", help="shares of critical damping"
    )
    parser.add_argument("--periods", type=float, nargs=2, default=(0.05, 5.0), metavar=("FROM", "TO"), help="[s]")
    parser.add_argument("--points", type=int, default=200, metavar="N", help="periods (%(default)s)")
    parser.add_argument("--csv", type=TableFile, metavar="FILE", help="write the spectra as a table")
    parser.add_argument("--picture", type=PictureFile, metavar="FILE", help="draw them (.png, .svg)")
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Print the spectrum at some periods, and write all of it; 0."""
    record = read_record(args.record)
    found = _spectra(args, record)
    _print(args, found)
    if args.csv:
        write_whole(args.csv, table(found))
    if args.picture:
        from restshape_apps.vibration.pictures import draw_spectra

        draw_spectra(args.picture, record, found, args.record.name)
    write_json(args, [_plain(one) for one in found])
    return 0


def _spectra(args: argparse.Namespace, record: GroundRecord) -> list[ResponseSpectrum]:
    """The spectrum for each damping."""
    low, high = args.periods
    if not 0.0 < low < high < np.inf:
        raise UserError("the periods are no range", "--periods", "--periods 0.05 5")
    if not 2 <= args.points <= 10_000:
        raise UserError("2 to 10,000 periods can be computed", "--points", "--points 200")
    if not all(0.0 <= z < 1.0 for z in args.damping):
        raise UserError("damping is at least 0 and below 1", "--damping", "--damping 0.02 0.05")
    frequencies = 1.0 / np.geomspace(low, high, args.points)
    return [response_spectrum(record.times, record.accelerations, frequencies, z) for z in args.damping]


def _print(args: argparse.Namespace, found: Sequence[ResponseSpectrum]) -> None:
    heads = ("damping", "period [s]", "S_d [mm]", "pseudo-velocity [m/s]", "pseudo-acceleration [m/s^2]")
    rows = []
    for one in found:
        places = sorted({int(np.argmin(np.abs(np.log(one.periods / shown)))) for shown in SHOWN})
        places = sorted({*places, int(np.argmax(one.pseudo_acceleration))})
        rows += [
            (
                f"{one.damping[k]:.3g}",
                f"{one.periods[k]:.3f}",
                f"{1e3 * one.displacement[k]:.4g}",
                f"{one.pseudo_velocity[k]:.4g}",
                f"{one.pseudo_acceleration[k]:.4g}",
            )
            for k in places
        ]
    print_table(f"response spectrum of {args.record.name}", heads, rows, right=heads)


def table(found: Sequence[ResponseSpectrum]) -> str:
    """The spectra as text: damping, period [s], S_d [m], pseudo-velocity [m/s], pseudo-acceleration [m/s^2]."""
    heads = "damping,period [s],displacement [m],pseudo_velocity [m/s],pseudo_acceleration [m/s^2]"
    lines = [heads]
    for one in found:
        columns = (one.damping, one.periods, one.displacement, one.pseudo_velocity, one.pseudo_acceleration)
        lines += [",".join(f"{value:.9g}" for value in row) for row in zip(*columns)]
    return "\n".join([*lines, ""])


def _plain(one: ResponseSpectrum) -> dict[str, object]:
    """A spectrum for programs, in SI units."""
    return {
        "damping": float(one.damping[0]),
        "period": one.periods.tolist(),
        "displacement": one.displacement.tolist(),
        "pseudo_velocity": one.pseudo_velocity.tolist(),
        "pseudo_acceleration": one.pseudo_acceleration.tolist(),
    }
