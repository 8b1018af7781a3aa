"""`restshape modes`: the modes of a plate, pictures of them, and of where rasping its edge moves a tone."""

import argparse
from itertools import count

from restshape_apps.metallophone.stage import add_frame, analysed

from restshape.cli.options import add_json, print_table, write_json
from restshape.errors import UserError, one_line
from restshape.outputs.kinds import PeriodFile, PictureFile


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    add_frame(parser)
    parser.add_argument(
        "--out", type=PictureFile, metavar="FILE", help="modes, nodal lines, hanging points (.png, .svg)"
    )
    parser.add_argument(
        "--rasp", type=PictureFile, metavar="FILE", help="what rasping the outline does to the first tone (.png, .svg)"
    )
    parser.add_argument(
        "--space", type=PictureFile, metavar="FILE", help="modes in space, shaded and exaggerated (.png, .svg)"
    )
    parser.add_argument("--period", type=PeriodFile, metavar="FILE", help="one mode through a period, moving (.gif)")
    parser.add_argument("--mode", type=int, metavar="K", help="with --period: which mode, 1 is the lowest (default: 1)")
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Print the modes, draw and write what is asked for; 0."""
    if args.mode is not None and not args.period:
        raise UserError("one mode alone is drawn where it moves", "--mode", "add --period mode.gif")
    analysis = analysed(args)
    from restshape_apps.metallophone.hung import hung, hung_data, hung_words
    from restshape_apps.metallophone.picture import draw, draw_rasp, tones

    for path, drawn in ((args.out, draw), (args.rasp, draw_rasp)):
        if path:
            drawn(analysis, path)
            print(f"wrote {one_line(path)}")
    if args.space or args.period:
        from restshape_apps.metallophone.space_picture import draw_in_space, draw_one_period

        if args.space:
            draw_in_space(analysis, args.space)
            print(f"wrote {one_line(args.space)}")
        if args.period:
            draw_one_period(analysis, args.period, 1 if args.mode is None else args.mode)
            print(f"wrote {one_line(args.period)}")
    names, cents = zip(*tones(analysis))
    rows = zip(count(1), [f"{f:.2f}" for f in analysis.frequencies], names, [f"{one:+.1f}" for one in cents])
    print_table("", ("mode", "f [Hz]", "tone", "cents"), rows, right=("mode", "f [Hz]", "cents"))
    shares = analysis.state.modes.participation[analysis.state.modes.chosen].tolist()
    found = {"frequencies": analysis.frequencies.tolist(), "tones": names, "cents": cents, "perpendicular": shares}
    if points := hung(analysis):
        print(hung_words(points))
        found["hanging"] = hung_data(points)
    write_json(args, found)
    return 0
