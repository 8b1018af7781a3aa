"""`restshape mannequin`: the surface of a body by its measures, for cloth to lie on."""

import argparse
from dataclasses import asdict, replace
from pathlib import Path

from restshape.cli.options import add_json, print_table, write_json
from restshape.errors import UserError, one_line
from restshape.outputs.atomic_files import write_whole
from restshape.outputs.kinds import BodyFile, PictureFile
from restshape.scene.body_sizes import BODIES, Sizes, option
from restshape.scene.units import UnitError, quantity

HELP = {
    "height": "from the floor to the top of the head",
    "bust": "girth",
    "waist": "girth",
    "hip": "girth",
    "shoulder": "width over the roots of both arms",
    "neck": "girth; left out: by height and bust",
    "upper_arm": "girth; left out: by height and bust",
    "thigh": "girth; left out: by hip",
}
FINEST, COARSEST = 400, 60
"""Most and fewest triangles along the height: fewer are not the body any more."""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--out", type=BodyFile, metavar="FILE", help="the surface in metres (.obj)")
    parser.add_argument("--picture", type=PictureFile, metavar="FILE", help="a picture with its measures (.png)")
    parser.add_argument("--body", choices=BODIES, default="standard", help="whose measures those left out are")
    for name, what in HELP.items():
        parser.add_argument(option(name), metavar="LENGTH", help=what)
    parser.add_argument("--size", metavar="LENGTH", help="of triangles (default: a 93rd of the height)")
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Write and draw what is asked for; 0."""
    if not (args.out or args.picture or args.json):
        raise UserError("nothing is asked for", "--out", "--out body.obj, --picture body.png or --json body.json")
    if args.out and args.out.suffix.lower() != ".obj":
        raise UserError(f"{one_line(args.out.name)} is no .obj file", "--out", "--out body.obj")
    given = {name: _length(getattr(args, name), option(name)) for name in HELP if getattr(args, name)}
    sizes = replace(BODIES[args.body], **given).completed()
    size = _triangle_size(args.size, sizes)
    from restshape.physics.cloth.mannequin.mannequin_surface import Mannequin

    body = Mannequin(sizes, size)
    if args.out:
        write_whole(Path(args.out), body.obj_text())
        print(f"wrote {one_line(args.out)}: {len(body.triangles)} triangles")
    if args.picture:
        from restshape_apps.couture.mannequin_picture import draw

        draw([body], args.picture)
        print(f"wrote {one_line(args.picture)}")
    levels = {name: body.level(name) for name in ("shoulder", "bust", "waist", "hip")}
    rows = [
        (name, 100 * value, 100 * levels[name] if name in levels else None) for name, value in asdict(sizes).items()
    ]
    print_table("measures", ["measure", "size [cm]", "level [cm]"], rows)
    write_json(args, {"triangles": len(body.triangles), "sizes": asdict(sizes), "levels": levels})
    return 0


def _length(text: str, where: str) -> float:
    """A length [m] of an option.

    Raises:
        UserError: it is none, or not positive.
    """
    try:
        found = quantity(text, "length")
    except UnitError as error:
        raise UserError(error.what, where, error.do) from error
    if not found > 0.0:
        raise UserError(f"{text!r} is no length of a body", where, 'write one such as "88 cm"')
    return found


def _triangle_size(text: str | None, sizes: Sizes) -> float:
    if text is None:
        from restshape.physics.cloth.mannequin.growth import FINE

        return sizes.height / FINE
    found, least, most = _length(text, "--size"), sizes.height / FINEST, sizes.height / COARSEST
    if not least <= found <= most:
        raise UserError(
            f"triangles of {text} do not suit a body of {100 * sizes.height:.4g} cm",
            "--size",
            f"give a size from {1e3 * least:.2g} to {1e3 * most:.2g} mm",
        )
    return found
