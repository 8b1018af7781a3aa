"""`restshape new`: a commented scene and edit script to start from."""

import argparse
from pathlib import Path

from restshape.application import application
from restshape.errors import UserError, one_line

SUMMARY = "write a commented scene and edit script to start from"
FILES = ("scene.toml", "edits.jsonl")


def arguments(parser: argparse.ArgumentParser) -> None:
    """Adds what this command takes."""
    parser.add_argument("app", metavar="APP", help="application, as `restshape list` names it")
    what = "of scene, where an application has several, such as fluid of thermal"
    parser.add_argument("--kind", metavar="KIND", help=what)
    parser.add_argument("dir", metavar="DIR", type=Path, help="folder to write into; made if it is not there")


def run(args: argparse.Namespace) -> int:
    """Writes the two files, never over others."""
    template = _template(application(args.app, "APP").folder / "template", args.kind)
    lacking = [name for name in FILES if not (template / name).is_file()]
    if lacking:
        what = f"the application {args.app!r} has no template: {template / lacking[0]} is not there"
        raise UserError(what, "APP", "begin with a scene of it, which `restshape list` names")
    texts = {name: (template / name).read_text(encoding="utf-8") for name in FILES}
    for name in FILES:
        if (args.dir / name).exists():
            raise UserError("this file is there already", str(args.dir / name), "name another folder")
    try:
        args.dir.mkdir(parents=True, exist_ok=True)
        for name, text in texts.items():
            with (args.dir / name).open("x", encoding="utf-8") as file:
                file.write(text)
    except OSError as error:
        raise UserError(f"cannot write here: {error.strerror}", str(args.dir), "name another folder") from error
    scene, edits = (args.dir / name for name in FILES)
    print(f"wrote {one_line(scene)} and {one_line(edits)}; next:")
    print(f"  restshape check {scene} {edits}")
    print(f"  restshape replay {scene} {edits}")
    return 0


def _template(folder: Path, kind: str | None) -> Path:
    """The folder of the template, of a kind where one is named.

    Raises:
        UserError: there is no such kind.
    """
    kinds = sorted(path.parent.name for path in folder.glob(f"*/{FILES[0]}"))
    if kind is None or kind in kinds:
        return folder / (kind or "")
    do = f"use one of: {', '.join(kinds)}" if kinds else "leave it out: its scenes are all of one kind"
    raise UserError(f"there is no template of the kind {kind!r}", "--kind", do)
