"""The steady motion of a shape on ground that moves at one frequency, over a range of frequencies.

restshape harmonic SCENE [EDITS] [--frame N] --range FROM TO [--csv FILE] [--picture FILE]

Of each displacement along x or y among the scene's quantities: its amplitude relative to the ground under a ground
acceleration of amplitude A, its phase against the acceleration, and the ratio of its amplitude in space to that of the
ground's displacement. Damping is the scene's. Each frequency is a direct solve of (K - w^2 M + i w C) U = -M 1 A.
The frequencies are evenly spaced, with more of them within the half-power bandwidth of each resonance of the lowest
modes; it says where the range has more modes than those.
"""

import argparse

import numpy as np
from restshape_apps.vibration.harmonic_sweep import MOST_MODES, Sweep, resonant_sweep
from restshape_apps.vibration.stage import add_structure, structure

from restshape.cli.options import print_table, write_json
from restshape.errors import UserError
from restshape.outputs.atomic_files import write_whole
from restshape.outputs.kinds import PictureFile, TableFile


def table(found: Sweep) -> str:
    """A sweep as text: of each quantity amplitude [m], phase [deg] and transmissibility."""
    heads, columns = ["frequency [Hz]"], [found.frequencies]
    for name, values in found.relative.items():
        heads += [f"{name} [m]", f"{name}_phase [deg]", f"{name}_transmissibility"]
        columns += [np.abs(values), np.angle(values, deg=True), found.transmissibility[name]]
    lines = [",".join(f"{value:.9g}" for value in row) for row in zip(*columns)]
    return "\n".join([",".join(heads), *lines, ""])


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    add_structure(parser)
    parser.add_argument("--range", type=float, nargs=2, required=True, metavar=("FROM", "TO"), help="frequencies [Hz]")
    parser.add_argument("--points", type=int, default=200, metavar="N", help="evenly spaced frequencies (%(default)s)")
    parser.add_argument("--acceleration", type=float, default=1.0, metavar="A", help="of the ground [m/s^2] (1)")
    parser.add_argument("--csv", type=TableFile, metavar="FILE", help="write the sweep as a table")
    parser.add_argument("--picture", type=PictureFile, metavar="FILE", help="draw it (.png, .svg)")


def run(args: argparse.Namespace) -> int:
    """Print where each quantity is largest, and write the sweep; 0."""
    low, high = args.range
    if not 0.0 < low < high < np.inf:
        raise UserError("the frequencies are no range", "--range", "--range 0.5 10")
    if not 2 <= args.points <= 10_000:
        raise UserError("2 to 10,000 frequencies can be computed", "--points", "--points 200")
    if not 0.0 < args.acceleration < np.inf:
        raise UserError("the amplitude of the ground is positive", "--acceleration", "leave it out")
    shape = structure(args)
    found = resonant_sweep(shape, low, high, args.points, args.acceleration)
    _print(found)
    if not shape.damped:
        print("the scene has no damping: amplitudes at resonance are not bounded, and no peak is looked for")
    elif found.resolved < high:
        print(
            f"resonances up to {found.resolved:.4g} Hz have points of their own (the lowest {MOST_MODES} modes); "
            "above, only --points finds peaks: take more of them"
        )
    if args.csv:
        write_whole(args.csv, table(found))
    if args.picture:
        from restshape_apps.vibration.pictures import draw_sweep

        draw_sweep(args.picture, found, args.scene.name)
    write_json(args, _plain(found))
    return 0


def _print(found: Sweep) -> None:
    heads = ("quantity", "largest at [Hz]", "amplitude [mm]", "phase [deg]", "transmissibility")
    rows = []
    for name, values in found.relative.items():
        k = int(np.argmax(np.abs(values)))
        numbers = (1e3 * abs(values[k]), np.angle(values[k], deg=True), found.transmissibility[name][k])
        rows.append((name, f"{found.frequencies[k]:.4g}", *(f"{number:.4g}" for number in numbers)))
    title = f"harmonic response, ground acceleration of {found.acceleration:g} m/s^2"
    print_table(title, heads, rows, right=heads[1:])


def _plain(found: Sweep) -> dict[str, object]:
    """A sweep for programs, in SI units and degrees."""
    quantities = {
        name: {
            "amplitude": np.abs(values).tolist(),
            "phase_deg": np.angle(values, deg=True).tolist(),
            "transmissibility": found.transmissibility[name].tolist(),
        }
        for name, values in found.relative.items()
    }
    return {
        "frequency": found.frequencies.tolist(),
        "acceleration": found.acceleration,
        "resolved_to": found.resolved if np.isfinite(found.resolved) else None,
        "quantities": quantities,
    }
