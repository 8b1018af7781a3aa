"""The command line of the process of a live session that simulates."""

from __future__ import annotations

from argparse import ArgumentParser
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from restshape.errors import UserError

RECORDING = ".vtkhdf"


@dataclass(frozen=True)
class WorkerOptions:
    """What the command line says.

    Args:
        link: descriptor of the socket to the server; on other ranks than the first None.
        scene: the scene, or a recording; edits: a script to play.
        out: where the script is written; force: a file that is there is replaced.
        resume: the server says what was done before.
        record: where frames are recorded when they are asked to be.
        policy: what is reused from frame to frame; None: as the scene says.
        predict: how frames of drags are predicted at first.
        overrides: ``key=value`` of the scene.
    """

    link: int | None
    scene: Path
    edits: Path | None
    out: Path | None
    force: bool
    resume: bool
    record: Path | None
    policy: str | None
    predict: Literal["none", "linear", "gmls"]
    overrides: tuple[str, ...]

    @property
    def is_recording(self) -> bool:
        """Whether a recording stands in place of the scene."""
        return self.scene.suffix.lower() == RECORDING

    def refuse_files(self) -> None:
        """Makes sure that no file that is there is lost.

        Raises:
            UserError: the script's, or the recording's, is there.
        """
        for option, path in (("--out", self.out), ("--record", self.record)):
            if path is not None and path.exists() and not (self.force or self.resume):
                raise UserError("there is a file of this name already", f"{option} {path}", "add --force to replace it")


def options_of(words: Sequence[str]) -> WorkerOptions:
    """The options that a command line has."""
    parser = ArgumentParser("restshape.live.worker")
    parser.add_argument("scene", type=Path)
    parser.add_argument("--link", type=int)
    parser.add_argument("--edits", type=Path)
    parser.add_argument("--out", type=Path)
    parser.add_argument("--force", action="store_true")
    parser.add_argument("--resume", action="store_true")
    parser.add_argument("--record", type=Path)
    parser.add_argument("--policy")
    parser.add_argument("--predict", choices=("none", "linear", "gmls"), default="none")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", dest="overrides")
    found = vars(parser.parse_args(words))
    return WorkerOptions(**found | {"overrides": tuple(found["overrides"])})
