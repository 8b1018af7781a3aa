"""`restshape live`: a page in a browser in which a hand holds the shape."""

from __future__ import annotations

import argparse
import os
import socket
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

from restshape.cli.options import add_set
from restshape.cli.parser import add_edits
from restshape.cli.ranks import first_rank, launched
from restshape.errors import UserError
from restshape.live.server_process import PARENT, SimulatingProcess, clean_environment
from restshape.outputs.kinds import LiveScriptFile, RecordingFile
from restshape.policy import GUESSES, POLICIES

KINDS = ("none", "linear", "gmls")
SUMMARY = "hold a shape in a browser: the page shows result, cost and error of every frame"
PASSED = ("edits", "out", "record", "policy", "guess", "predict", "estimate", "calibration")
"""Options that the simulating process has, too."""
HIGHEST_PORT = 65535


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("scene", metavar="SCENE", type=Path, help="scene file (.toml), or recording (.vtkhdf) to play")
    add_set(parser)
    add_edits(parser, "edit script (.jsonl) to play, and to take over")
    parser.add_argument("--out", type=LiveScriptFile, metavar="FILE", help="write what is done as a script (.jsonl)")
    parser.add_argument("--record", type=RecordingFile, metavar="FILE", help="recording (.vtkhdf) of the session")
    parser.add_argument("--force", action="store_true", help="replace the files of --out and --record")
    parser.add_argument("--port", type=_port, metavar="N", help="of 127.0.0.1 (default: any that is free)")
    parser.add_argument("--open", action="store_true", help="open the page in the browser")
    parser.add_argument("--policy", choices=list(POLICIES), help="what is reused (default: the scene's)")
    parser.add_argument("--guess", choices=list(GUESSES), help="initial guess of iterative solves")
    parser.add_argument("--predict", choices=KINDS, help="show the frames of a drag by the design derivative")
    parser.add_argument("--estimate", metavar="WHEN", help="frames whose errors are estimated (solve.estimate)")
    parser.add_argument("--calibration", type=Path, metavar="FILE", help="seconds a unit of work (default: nominal)")


def run(args: argparse.Namespace) -> int:
    """Serve until the session ends; 0 after Ctrl-C, 2 on bad input."""
    _check(args)
    words = worker_words(args)
    if launched():
        return _on_ranks(args, words)
    process = SimulatingProcess(words)
    try:
        from restshape.live.server import Serving, serve

        parent = int(os.environ.pop(PARENT, 0)) or None
        return serve(process, Serving(args.port, args.open, args.out, parent))
    except BaseException:
        process.kill()
        raise


def worker_words(args: argparse.Namespace) -> list[str]:
    """The arguments of the simulating process."""
    words = [str(args.scene)]
    for name in PASSED:
        if (value := getattr(args, name)) is not None:
            words += [f"--{name}", str(value)]
    for one in args.set:
        words += ["--set", one]
    for folder in args.allow_path:
        words += ["--allow-path", str(folder)]
    words += ["--trust-geo"] * args.trust_geo
    return [*words, "--", *args.petsc] if args.petsc else words


def _check(args: argparse.Namespace) -> None:
    """Refuses what can be seen before anything is started.

    Raises:
        UserError: there is no such scene, the page was not built, or a file is there that nobody said may go.
    """
    from restshape.live.server_files import page_files

    for path in filter(None, (args.scene, args.edits)):
        if not path.is_file():
            what = "this is a folder" if path.is_dir() else "there is no such file"
            raise UserError(what, str(path), "restshape new APP DIR writes a scene to start from")
    for option, path in (("--out", args.out), ("--record", args.record)):
        if path and path.exists() and not args.force:
            what = "there is a file of this name already"
            raise UserError(what, f"{option} {path}", "name another one, or add --force")
    page_files()


def _on_ranks(args: argparse.Namespace, words: list[str]) -> int:
    """Simulates on all ranks; the first one starts the server, which is no rank."""
    from restshape.live.worker import main

    if not first_rank():
        return main(words)
    here, there = socket.socketpair()
    number = there.fileno()
    given = ["--link", str(number)]
    given += ["--port", str(args.port)] if args.port else []
    given += ["--script", str(args.out)] if args.out else []
    given += ["--open"] * args.open
    command = [sys.executable, "-m", "restshape.live.server_beside", *given]
    with there:
        server = subprocess.Popen(command, pass_fds=[number], env=clean_environment(), stdin=subprocess.DEVNULL)
    try:
        return main(["--link", str(os.dup(here.fileno())), *words])
    finally:
        # However it has ended, the server hears so.
        with suppress(OSError):
            here.shutdown(socket.SHUT_RDWR)
        here.close()
        server.wait()


def _port(text: str) -> int:
    number = int(text) if text.isdecimal() else 0
    if not 0 < number <= HIGHEST_PORT:
        raise argparse.ArgumentTypeError(f"{text} is no port: name one from 1024 to {HIGHEST_PORT}")
    return number
