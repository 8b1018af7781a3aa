"""Utilisation of joints over their compliance in rotation: a bench with a stretcher, and all scenes of furniture.

Joints are springs, and where a piece is redundant the ratio of their compliances decides how they share a load.
Utilisations are in parts of a joint's strength, of pull or of shear.
"""

import argparse
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace

import numpy as np
from restshape_apps.furniture.physics.fasteners import fastener, wood
from restshape_apps.furniture.physics.furniture import Compliance, Furniture
from restshape_apps.furniture.pieces import SCENES, drawn
from restshape_apps.furniture.shape.planks import Piece
from restshape_apps.furniture.small_pieces import stretched

from restshape.cli.options import add_json, write_json

RATIOS = (1.0, 10.0, 100.0, 1000.0)
"""Turn of a joint for each N m over its way for each N [1/m^2]; 1 is the thesis's."""
BENCHES = {
    "stretcher, 70 kg over a leg": (0.35, 70.0, 1.0),
    "stretcher, 70 kg over a leg, floor 1000 times as stiff": (0.35, 70.0, 1000.0),
    "stretcher, 200 kg over a leg": (0.35, 200.0, 1.0),
    "stretcher, 70 kg over mid-span": (0.0, 70.0, 1.0),
}
"""Place of the mass from the middle [m], the mass [kg], and the stiffness of the floor in parts of the usual one."""
RAIL = 3
"""The plank that is the stretcher."""
NAILS = 5
"""Of the joint whose slip is reported."""


@dataclass(frozen=True)
class Utilisation:
    """The largest utilisations of joints.

    Args:
        what: whose.
        ratio: of the joints' compliances [1/m^2].
        pull, shear: in parts of the strength; a pull below 0 presses.
    """

    what: str
    ratio: float
    pull: float
    shear: float

    @property
    def largest(self) -> float:
        """Of pull or shear, whichever is more."""
        return max(self.pull, self.shear)


def line_ratio(thickness: float) -> float:
    """The ratio [1/m^2] of a line of fasteners, drawn out as easily as sheared, half a thickness [m] from an edge."""
    return 4.0 / thickness**2


def slip(name: str, kind: str, count: int) -> float:
    """How far a joint of fasteners in drilled holes gives for each N [m/N].

    Args:
        name: of the wood.
        kind: of the fastener.
        count: of fasteners.

    Source: EN 1995-1-1:2004, table 7.1: rho_m^1.5 d / 23 in N/mm, kg/m^3 and mm.
    """
    each = wood(name).density ** 1.5 * (1e3 * fastener(kind).diameter) / 23.0 * 1e3
    return 1.0 / (count * each)


def used(what: str, piece: Piece, ratio: float, stiffer: float = 1.0, plank: int | None = None) -> Utilisation:
    """The largest utilisations of a piece's joints over all cases.

    Args:
        what: what they are called.
        piece: whose joints.
        ratio: of their compliances [1/m^2].
        stiffer: the floor's stiffness, in parts of the usual one.
        plank: only joints of this plank's ends.
    """
    usual = Compliance()
    compliance = replace(usual, joint_r=ratio * usual.joint_t, floor=usual.floor / stiffer)
    furniture = Furniture(piece, compliance)
    furniture.test()
    some = np.array([k for k, joint in enumerate(piece.joints) if plank in (None, joint.i)])
    cases = [furniture.forces(case) for case in range(len(furniture.cases))]
    pull, shear = (
        max(float(utilisation[some].max()) for utilisation in utilisations)
        for utilisations in zip(*((c.pull_utilisation, c.shear_utilisation) for c in cases))
    )
    return Utilisation(what, ratio, pull, shear)


def of_stretchers() -> list[Utilisation]:
    """Utilisations of the stretcher's joints, and of those of `table.toml`, as joints turn more easily."""
    ratios = (*RATIOS, line_ratio(0.018))
    rows = [
        used(what, stretched(place, kilograms), ratio, stiffer, RAIL)
        for what, (place, kilograms, stiffer) in BENCHES.items()
        for ratio in ratios
    ]
    return rows + [used("all joints of table.toml", drawn("table"), ratio) for ratio in ratios]


def of_scenes() -> list[Utilisation]:
    """Utilisations of the joints of all scenes that come with the application, as joints turn more easily."""
    pieces = {path.stem: drawn(path.stem) for path in sorted(SCENES.glob("*.toml"))}
    return [used(name, piece, ratio) for name, piece in pieces.items() for ratio in (*RATIOS, line_ratio(0.012))]


def rounded(ratio: float) -> str:
    """A ratio to three digits."""
    return f"{float(f'{ratio:.3g}'):,.0f}"


def table(rows: Sequence[Utilisation], head: str, of: str) -> list[str]:
    """Lines of Markdown: a row for each name, a column for each ratio."""
    ratios = list(dict.fromkeys(row.ratio for row in rows))
    lines = ["| " + " | ".join([head, *map(rounded, ratios)]) + " |", "| --- |" + " ---: |" * len(ratios)]
    for what in dict.fromkeys(row.what for row in rows):
        values = [f"{getattr(row, of):.3g}" for row in rows if row.what == what]
        lines.append("| " + " | ".join([what, *values]) + " |")
    return lines


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Print the tables; 0."""
    benches, scenes = of_stretchers(), of_scenes()
    print(*table(benches, "utilisation, by turn for each N m over way for each N [1/m²]", "largest"), "", sep="\n")
    for of in ("pull", "shear"):
        print(*table(scenes, f"largest utilisation of {of}, by the same", of), "", sep="\n")
    for thickness in (0.018, 0.012):
        print(f"a line of fasteners in a plank of {1e3 * thickness:g} mm: {rounded(line_ratio(thickness))} 1/m²")
    each, all_of_them = 1e-3 / slip("pine", "nail", 1), 1e9 * slip("pine", "nail", NAILS)
    print(f"a nail in a drilled hole of pine: {each:.3g} N/mm; a joint of {NAILS}: {all_of_them:.3g} nm for each N")
    write_json(args, [asdict(row) for row in (*benches, *scenes)])
    return 0
