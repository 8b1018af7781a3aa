"""The server as a process beside the first of several ranks: `python -m restshape.live.server_beside --link FD`."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from restshape.errors import UserError
from restshape.live.server import Serving, serve
from restshape.live.server_process import GivenProcess


def main(words: list[str] | None = None) -> int:
    """Serves until the link closes, or the session is ended; 2 where it cannot."""
    parser = argparse.ArgumentParser(prog="restshape live")
    parser.add_argument("--link", type=int, required=True)
    parser.add_argument("--port", type=int)
    parser.add_argument("--script", type=Path)
    parser.add_argument("--open", action="store_true")
    args = parser.parse_args(words)
    try:
        return serve(GivenProcess(args.link), Serving(args.port, args.open, args.script))
    except UserError as error:
        print(f"restshape live: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    raise SystemExit(main())
