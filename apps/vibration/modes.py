"""The modes of a shape on moving ground, and the peaks of its motion by a response spectrum.

restshape participation SCENE [EDITS] [--frame N] [--modes K] [--record FILE] [--csv FILE] [--picture FILE]

Each mode has its frequency, the scene's damping as a share of critical damping, its participation and the share of the
mass that moves with it. With a record (the scene's, or --record) each displacement among the quantities has its peak by
the record's response spectrum, modes combined by SRSS and CQC, and by adding the motions of the modes in time.
"""

import argparse
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from restshape_apps.vibration.stage import Structure, add_structure, structure

from restshape.analysis.modal.base_modes import BaseModes, cqc, srss
from restshape.analysis.motion.modes_beside import present_modes
from restshape.analysis.motion.response_spectrum import spectrum_and_sums
from restshape.cli.options import print_table, write_json
from restshape.errors import UserError
from restshape.outputs.atomic_files import write_whole
from restshape.outputs.kinds import PictureFile, TableFile
from restshape.physics.elasticity.ground_record import GroundRecord, read_record

ROUNDING = 1e-9
"""Share of the root of the mass up to which a participation is rounding, which the table shows as 0."""


@dataclass(frozen=True)
class Peaks:
    """The largest displacement [m] of one quantity, three ways: by two combinations, and in time."""

    srss: float
    cqc: float
    in_time: float


def factors(shape: Structure, modes: BaseModes) -> dict[str, np.ndarray]:
    """What a unit motion of each oscillator (k,) adds to each quantity, by name: participation times mode there."""
    looked = [shape.looked(modes.shapes[:, k]) for k in range(len(modes.omega))]
    return {name: modes.participation * np.array([one[name].real for one in looked]) for name in shape.looks}


def peaks(shape: Structure, modes: BaseModes, record: GroundRecord, scale: float = 1.0) -> dict[str, Peaks]:
    """The peaks of each quantity under a record.

    Args:
        shape: with the scene's damping.
        modes: of it.
        record: of the ground along its direction.
        scale: of the record's accelerations.

    Raises:
        UserError: a mode is damped beyond what vibrates.
    """
    damping = modes.damping(shape.analysis.state.integration.damping)
    if damping.max() >= 1.0:
        what = f"mode {int(np.argmax(damping)) + 1} has {damping.max():.3g} of critical damping, and does not vibrate"
        raise UserError(what, "effects.damping", "ask for fewer modes, or less damping")
    accelerations, added = scale * record.accelerations, factors(shape, modes)
    by_mode = np.array(list(added.values())).reshape(len(added), -1).T
    spectrum, sums = spectrum_and_sums(record.times, accelerations, modes.frequencies, damping, by_mode)
    found = {}
    for (name, factor), in_time in zip(added.items(), sums):
        single = factor * spectrum.displacement
        combined = float(srss(single)), float(cqc(single, modes.omega, damping))
        found[name] = Peaks(*combined, float(in_time))
    return found


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    add_structure(parser)
    parser.add_argument("--modes", type=int, default=6, metavar="K", help="how many (%(default)s)")
    parser.add_argument("--record", type=Path, metavar="FILE", help="record of the ground (.csv, .at2)")
    parser.add_argument("--csv", type=TableFile, metavar="FILE", help="write the modes as a table")
    parser.add_argument("--picture", type=PictureFile, metavar="FILE", help="draw modes and peaks (.png, .svg)")


def run(args: argparse.Namespace) -> int:
    """Print modes and peaks; 0."""
    if not 1 <= args.modes <= 40:
        raise UserError("1 to 40 modes can be computed", "--modes", "--modes 6")
    given = read_record(args.record) if args.record else None
    shape = structure(args)
    modes = present_modes(shape.analysis, args.modes)
    ground = shape.analysis.state.plan.settings("ground")
    scale = 1.0
    if given is None and ground is not None and ground.file is not None:
        given, scale = read_record(Path(ground.file)), ground.scale
    found = peaks(shape, modes, given, scale) if given is not None else {}
    _print(shape, modes, found)
    damping = modes.damping(shape.analysis.state.integration.damping)
    if args.csv:
        write_whole(args.csv, table(modes, damping))
    if args.picture:
        from restshape_apps.vibration.pictures import draw_participation

        draw_participation(args.picture, modes, damping, {name: vars(one) for name, one in found.items()}, _name(args))
    write_json(args, _plain(modes, damping, found))
    return 0


def table(modes: BaseModes, damping: np.ndarray) -> str:
    """Modes as text: frequency [Hz], share of critical damping, participation [kg^1/2], shares of the mass."""
    heads = "mode,frequency [Hz],damping,participation [kg^1/2],effective_mass,effective_mass_so_far"
    so_far = np.cumsum(modes.effective_mass)
    columns = (modes.frequencies, damping, modes.participation, modes.effective_mass, so_far)
    lines = [",".join([str(k), *(f"{value:.9g}" for value in row)]) for k, row in enumerate(zip(*columns), 1)]
    return "\n".join([heads, *lines, ""])


def _name(args: argparse.Namespace) -> str:
    """What the picture says it is of."""
    return f"{args.scene.name}, {args.record.name}" if args.record else args.scene.name


def _print(shape: Structure, modes: BaseModes, found: dict[str, Peaks]) -> None:
    damping = modes.damping(shape.analysis.state.integration.damping)
    heads = ("mode", "frequency [Hz]", "damping [%]", "participation [kg^1/2]", "mass [%]", "mass so far [%]")
    moved = modes.effective_mass > ROUNDING**2
    participation, mass = (np.where(moved, one, 0.0) for one in (modes.participation, 100 * modes.effective_mass))
    columns = (modes.frequencies, 100 * damping, participation, mass)
    rows = [
        (k + 1, *(f"{value:.5g}" for value in values), f"{mass[: k + 1].sum():.4g}")
        for k, values in enumerate(zip(*columns))
    ]
    print_table(f"modes, of a mass of {modes.mass:.6g} kg", heads, rows, right=heads)
    if found:
        heads = ("quantity", "SRSS [mm]", "CQC [mm]", "in time [mm]")
        cells = [
            (name, *(f"{1e3 * value:.4g}" for value in (one.srss, one.cqc, one.in_time))) for name, one in found.items()
        ]
        print_table("largest displacements under the record", heads, cells, right=heads[1:])


def _plain(modes: BaseModes, damping: np.ndarray, found: dict[str, Peaks]) -> dict[str, object]:
    """Modes and peaks for programs, in SI units."""
    return {
        "frequency": modes.frequencies.tolist(),
        "damping": damping.tolist(),
        "participation": modes.participation.tolist(),
        "effective_mass": modes.effective_mass.tolist(),
        "mass": modes.mass,
        "peaks": {name: vars(one) for name, one in found.items()},
    }
