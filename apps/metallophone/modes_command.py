"""`restshape modes`: the modes of a plate, pictures of them, and of where rasping its edge moves a tone."""

import argparse

from restshape_apps.metallophone.stage import add_frame, analysed

from restshape.cli.options import add_json, write_json
from restshape.errors import UserError, one_line
from restshape.outputs.kinds import PeriodFile, PictureFile


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    add_frame(parser)
    parser.add_argument("--out", type=PictureFile, metavar="FILE", help="modes, nodal lines, hanging points (.png)")
    parser.add_argument(
        "--rasp", type=PictureFile, metavar="FILE", help="what rasping the outline does to the first tone (.png)"
    )
    parser.add_argument(
        "--space", type=PictureFile, metavar="FILE", help="modes in space, shaded and exaggerated (.png)"
    )
    parser.add_argument("--period", type=PeriodFile, metavar="FILE", help="one mode through a period, moving (.gif)")
    parser.add_argument("--mode", type=int, metavar="K", help="with --period: which mode, 1 is the lowest (default: 1)")
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Draw and write what is asked for; 0."""
    if not (args.out or args.rasp or args.space or args.period or args.json):
        do = "--out modes.png, --space space.png, --period mode.gif, --rasp rasp.png, or --json modes.json"
        raise UserError("nothing is asked for", "--out", do)
    if args.period and args.period.suffix != ".gif":
        raise UserError(f"a moving mode is a GIF, not {args.period.suffix!r}", "--period", "--period mode.gif")
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
    shares = analysis.state.modes.participation[analysis.state.modes.chosen].tolist()
    found = {"frequencies": analysis.frequencies.tolist(), "tones": names, "cents": cents, "perpendicular": shares}
    if points := hung(analysis):
        print(hung_words(points))
        found["hanging"] = hung_data(points)
    write_json(args, found)
    return 0
