"""How the words of a command are read: options may stand before, between and after what needs no option."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any


class Parser(argparse.ArgumentParser):
    """A parser of one command."""

    def parse_args(self, args: Sequence[str] | None = None, namespace: argparse.Namespace | None = None) -> Any:
        """The arguments of these words; ends the process with 2 and a message where they make no sense."""
        if any(action.nargs == argparse.PARSER for action in self._actions):
            # Words after the name of a study belong to it.
            return super().parse_args(args, namespace)
        return self.parse_intermixed_args(args, namespace)


class EditsFile(argparse.Action):
    """Takes the edit script, named as a word of its own or after --edits, once."""

    def __call__(
        self, parser: argparse.ArgumentParser, namespace: argparse.Namespace, values: Any, option: str | None = None
    ) -> None:
        """Keeps the script; what is not there leaves the one that --edits has named."""
        known = getattr(namespace, self.dest, None)
        if values is not None and known is not None:
            parser.error(f"two edit scripts are named, {known} and {values}: name one")
        setattr(namespace, self.dest, values if known is None else known)


def add_edits(parser: argparse.ArgumentParser, what: str) -> None:
    """Adds EDITS, which may be left out, and the same as ``--edits FILE``.

    Args:
        parser: of the command; its scene is declared already.
        what: the script is, or what is done without one.
    """
    parser.add_argument("edits", metavar="EDITS", type=Path, nargs="?", action=EditsFile, help=what)
    parser.add_argument("--edits", metavar="FILE", type=Path, action=EditsFile, help="the same as EDITS")
