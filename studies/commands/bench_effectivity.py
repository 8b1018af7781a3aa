"""The study `restshape bench effectivity`: estimated errors of quantities beside true ones."""

import argparse
from typing import Any

from restshape_studies.bench.turns import Announce, Case
from restshape_studies.commands.bench_kind import Kind

from restshape.cli.options import print_table
from restshape.errors import UserError

SIZES = (1.41, 1.0, 0.71)


def declare(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument(
        "--sizes",
        type=lambda text: tuple(map(float, text.split(","))),
        default=SIZES,
        metavar="F,...",
        help="factors of the scene's mesh sizes (default: 1.41,1,0.71)",
    )


def check(args: argparse.Namespace) -> None:
    """Refuse sizes that are none."""
    if not all(0.0 < size < float("inf") for size in args.sizes):
        raise UserError("a factor of a mesh size is positive", "--sizes", "--sizes 1,0.5")


def measure(args: argparse.Namespace, case: Case, announce: Announce) -> dict[str, Any]:
    """The points of a scene; or why there are none."""
    from restshape_studies.bench.effectivity import study

    try:
        return study(case.scene, args.set, args.sizes, announce)
    except UserError as error:
        # Of many scenes some have no estimates.
        if len(args.scenes) == 1:
            raise
        return {"points": [], "omitted": {"all": str(error).split("\n")[0]}}


def show(args: argparse.Namespace, name: str, found: dict[str, Any]) -> None:
    """Print the table of a scene, and how many of its points are good."""
    from restshape_studies.bench.effectivity import BAD, GOOD, counts

    for order, why in found["omitted"].items():
        print(f"{name}: order {order} left out: {why}")
    points = found["points"]
    if not points:
        return
    heads = ("quantity", "order", "size", "value", "true error", "estimate", "effectivity", "")
    cells = [
        (
            one["quantity"],
            one["order"],
            f"{one['size']:g}",
            f"{one['value']:.6g}",
            f"{one['true']:.2g}",
            "-" if one["estimate"] is None else f"{one['estimate']:.2g}",
            f"{one['effectivity']:.2f}" if one["assessment"] in (GOOD, BAD) else "-",
            one["assessment"],
        )
        for one in sorted(points, key=lambda one: (one["quantity"], one["order"], -one["size"]))
    ]
    print_table(f"{name}: errors of quantities on the first shape", heads, cells, right=heads[1:7])
    known = counts(points)
    judged = known[GOOD] + known[BAD]
    print(f"{name}: {known[GOOD]} of {judged} between 0.5 and 2; {known}")


KINDS = (
    Kind(
        "effectivity",
        "estimated errors of quantities beside true ones, at some mesh sizes and both orders",
        declare,
        check,
        measure,
        show,
        scenes="unscripted",
        about="errors of quantities are about one",
    ),
)
