"""The command line of the process of a live session that simulates."""

from __future__ import annotations

import json
from argparse import ArgumentParser
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from restshape.scene.permits import allow, trust_scripts

RECORDING = ".vtkhdf"


# More than 15 attributes: each is an option.
@dataclass(frozen=True)
class WorkerOptions:
    """What the command line says: the server has looked at the files that will be written.

    Args:
        link: descriptor of the socket to the server; on other ranks than the first None.
        scene: the scene, or a recording; edits: a script to play.
        out: where the script is written; record: where frames are recorded when they are asked to be.
        resume: the server says what was done before.
        policy, guess: what is reused from frame to frame, and where solves start; None: as the scene says.
        predict: how frames of drags are predicted at first.
        estimate: frames whose errors are estimated; None: as the scene says.
        calibration: file of seconds a unit of work; None: the nominal ones.
        overrides: ``key=value`` of the scene; petsc: words for PETSc's options database.
    """

    link: int | None
    scene: Path
    edits: Path | None
    out: Path | None
    resume: bool
    record: Path | None
    policy: str | None
    guess: str | None
    predict: Literal["none", "linear", "gmls"]
    estimate: str | None
    calibration: Path | None
    overrides: tuple[str, ...]
    petsc: tuple[str, ...]

    @property
    def is_recording(self) -> bool:
        """Whether a recording stands in place of the scene."""
        return self.scene.suffix.lower() == RECORDING

    @property
    def all_overrides(self) -> tuple[str, ...]:
        """Those of the scene, with what `estimate` says."""
        if self.estimate is None:
            return self.overrides
        given = self.estimate if self.estimate.isdecimal() else json.dumps(self.estimate)
        return (*self.overrides, f"solve.estimate={given}")


def options_of(words: Sequence[str]) -> WorkerOptions:
    """The options that a command line has; what it permits scenes is permitted from now on."""
    own, petsc = [*words], list[str]()
    if "--" in own:
        place = own.index("--")
        own, petsc = own[:place], own[place + 1 :]
    parser = ArgumentParser("restshape.live.worker")
    parser.add_argument("scene", type=Path)
    parser.add_argument("--link", type=int)
    for name in ("edits", "out", "record", "calibration"):
        parser.add_argument(f"--{name}", type=Path)
    for name in ("policy", "guess", "estimate"):
        parser.add_argument(f"--{name}")
    parser.add_argument("--resume", action="store_true")
    parser.add_argument("--predict", choices=("none", "linear", "gmls"), default="none")
    parser.add_argument("--set", action="append", default=[], dest="overrides")
    parser.add_argument("--allow-path", action="append", default=[], type=Path)
    parser.add_argument("--trust-geo", action="store_true")
    found = vars(parser.parse_args(own))
    for folder in found.pop("allow_path"):
        allow(folder)
    if found.pop("trust_geo"):
        trust_scripts()
    return WorkerOptions(**found | {"overrides": tuple(found["overrides"]), "petsc": tuple(petsc)})
