"""What one fastener bears in the end of a plank, by its kind, the wood and the thickness."""

import argparse
from collections.abc import Sequence
from dataclasses import asdict, dataclass

from restshape_apps.furniture.physics.fasteners import FASTENERS, WOODS, fastener, wood

from restshape.cli.options import add_json, write_json
from restshape.errors import UserError

THICK = 0.018
"""Of both planks [m]."""
NAILED = (0.012, 0.014, 0.016, 0.018)
"""Thicknesses through which the thesis's nail is driven [m]."""
HEADED = (0.012, 0.016, 0.020)
"""Thicknesses of MDF through which the head of a screw may pass [m]."""


@dataclass(frozen=True)
class Strength:
    """What one fastener bears.

    Args:
        fastener, wood: which, and the wood of both planks.
        pull, shear: [N]; None where nothing is known of it.
    """

    fastener: str
    wood: str
    pull: float | None
    shear: float | None


def strength(kind: str, name: str) -> Strength:
    """What one fastener bears through a plank into the end of another, both of one wood and thickness."""
    one, timber = fastener(kind), wood(name)
    try:
        pull = one.pull_strength(timber, timber, THICK, THICK)
    except UserError:
        return Strength(kind, name, None, None)
    return Strength(kind, name, pull, one.shear_strength(timber, timber, THICK))


def strengths() -> list[Strength]:
    """What one of each kind bears in each wood."""
    return [strength(kind, name) for kind in FASTENERS for name in WOODS]


def moment(thickness: float) -> float:
    """The moment [N m] that one nail of the thesis bears, drawn out over half of its plank's thickness [m]."""
    timber = wood("mdf")
    return 0.5 * thickness * fastener("nail-thesis").pull_strength(timber, timber, thickness, thickness)


def head_pull(thickness: float) -> float:
    """The pull [N] at which a screw's head passes through MDF of that thickness [m]; oak holds its thread."""
    return fastener("screw").pull_strength(wood("oak"), wood("mdf"), thickness, THICK)


def table(rows: Sequence[Strength]) -> list[str]:
    """Lines of Markdown: a row for each fastener, columns for pull and shear in each wood."""
    woods = list(dict.fromkeys(row.wood for row in rows))
    heads = [f"{of}, {name}" for of in ("pull", "shear") for name in woods]
    lines = [f"| planks of {1e3 * THICK:g} mm | " + " | ".join(heads) + " |", "| --- |" + " ---: |" * len(heads)]
    for kind in dict.fromkeys(row.fastener for row in rows):
        mine = [row for row in rows if row.fastener == kind]
        values = [*(row.pull for row in mine), *(row.shear for row in mine)]
        lines.append(f"| `{kind}` | " + " | ".join("-" if v is None else f"{v:.0f}" for v in values) + " |")
    return lines


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Print the tables; 0."""
    rows = strengths()
    print("one fastener bears [N]; -: not known")
    print(*table(rows), "", sep="\n")
    for thickness in NAILED:
        print(f"moment that one nail-thesis bears through {1e3 * thickness:g} mm: {moment(thickness):.3g} N m")
    for thickness in HEADED:
        print(
            f"pull at which a screw's head passes through {1e3 * thickness:g} mm of MDF: {head_pull(thickness):.0f} N"
        )
    write_json(args, [asdict(row) for row in rows])
    return 0
