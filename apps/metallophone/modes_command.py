"""`restshape modes`: the modes of a plate, pictures of them, and of where rasping its edge moves a tone."""

import argparse

from restshape_apps.metallophone.stage import add_frame, analysed

from restshape.cli.options import add_json, write_json
from restshape.errors import UserError, one_line
from restshape.outputs.kinds import PictureFile


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    add_frame(parser)
    parser.add_argument("--out", type=PictureFile, metavar="FILE", help="modes, nodal lines, hanging points (.png)")
    parser.add_argument(
        "--rasp", type=PictureFile, metavar="FILE", help="what rasping the outline does to the first tone (.png)"
    )
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Draw and write what is asked for; 0."""
    if not (args.out or args.rasp or args.json):
        raise UserError("nothing is asked for", "--out", "--out modes.png, --rasp rasp.png, or --json modes.json")
    analysis = analysed(args)
    from restshape_apps.metallophone.hung import hung, hung_data, hung_words
    from restshape_apps.metallophone.picture import draw, draw_rasp, tones

    for path, drawn in ((args.out, draw), (args.rasp, draw_rasp)):
        if path:
            drawn(analysis, path)
            print(f"wrote {one_line(path)}")
    names, cents = zip(*tones(analysis))
    found = {"frequencies": analysis.frequencies.tolist(), "tones": names, "cents": cents}
    if points := hung(analysis):
        print(hung_words(points))
        found["hanging"] = hung_data(points)
    write_json(args, found)
    return 0
