"""What a kind of `restshape bench` is: what it varies, what it measures, and how that is shown."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from restshape_studies.bench.job import Job
from restshape_studies.bench.turns import Announce, Case

from restshape.errors import UserError
from restshape.outputs.picture_files import STAMP
from restshape.policy import POLICIES

if TYPE_CHECKING:
    from restshape.scene.edit_script import Script
    from restshape.scene.model import Scene


@dataclass(frozen=True)
class Kind:
    """One kind; the runner reads scenes and scripts, prepares the picture, and writes the JSON.

    Args:
        name, summary: of the study, as the command line has them.
        declare: its own arguments.
        check: refuses arguments that measure nothing.
        measure: what is found of a scene, as --json writes it; given the arguments, the scene and who announces.
        show: prints the tables of a scene; given the arguments, the scene's name and what was found.
        scenes: "one", "several" (all installed ones by default), "still" (one, by its title, which needs no script),
            "either" (one, of whose script `measure` says whether it is needed), "unscripted"
            (several, whose first shapes are looked at), or the name of an installed scene.
        default: names of installed scenes that are taken where none is named; none: all installed ones.
        about: why the scene must have a mesh.
        sum_up: prints what is said of all scenes together, given what was found by scene.
        picture: file name in the folder after --out; empty: no such picture.
        times: what the times that it prints include; empty where it has none.
        draw: draws the picture; given the scenes' names with what was found, the arguments and the path.
        fits: of several scripts of a scene, the first that fits is taken where none is named; none: the first one.
        own: the cases that a "still" study takes where no scene is named.
    """

    name: str
    summary: str
    declare: Callable[[argparse.ArgumentParser], None]
    check: Callable[[argparse.Namespace], None]
    measure: Callable[[argparse.Namespace, Case, Announce], dict[str, Any]]
    show: Callable[[argparse.Namespace, str, dict[str, Any]], None]
    scenes: str = "one"
    default: tuple[str, ...] = ()
    about: str = "policies of reuse are about one"
    sum_up: Callable[[dict[str, Any]], None] | None = None
    picture: str = ""
    times: str = ""
    draw: Callable[[dict[str, Any], argparse.Namespace, Path], None] | None = None
    fits: Callable[[Script, Scene], bool] | None = None
    own: Callable[[argparse.Namespace], list[Case]] | None = None


FRAMES = "whole frames with their residual, without estimates and without a recorder; the first frame is left out"
"""What times of frames include, where a study says nothing else."""


def add_policy(parser: argparse.ArgumentParser) -> None:
    """Declare --policy."""
    parser.add_argument("--policy", choices=list(POLICIES), default="auto", help="default: %(default)s")


def add_frames(parser: argparse.ArgumentParser, default: int = 0) -> None:
    """Declare --frames."""
    what = "first N frames of the script, 0 for all (default: %(default)s)"
    parser.add_argument("--frames", type=int, default=default, metavar="N", help=what)


def add_repeat(parser: argparse.ArgumentParser, of: str = "timed runs") -> None:
    """Declare --repeat."""
    parser.add_argument("--repeat", type=int, default=3, metavar="R", help=f"{of} (default: %(default)s)")


def check_runs(args: argparse.Namespace) -> None:
    """Refuse --repeat and --frames that measure nothing."""
    if args.repeat < 1 or args.frames < 0 or args.frames == 1:
        what = f"{args.repeat} runs of {args.frames} frames measure nothing"
        raise UserError(what, "--repeat, --frames", "at least 1 run, at least 2 frames")


def read_results(path: Path, option: str) -> tuple[Any, str]:
    """What a study wrote after --json, without the stamp of committed results, and the commit that this names.

    Raises:
        UserError: the file, named after `option`, cannot be read.
    """
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise UserError(f"this cannot be read: {error.strerror}", f"{option} {path}", "name another file") from error
    except ValueError as error:
        raise UserError(f"this is no JSON: {error}", f"{option} {path}", "name another file") from error
    stamp = data.pop(STAMP, "") if isinstance(data, dict) else ""
    return data, stamp.partition(",")[0] or path.name


def unscripted(scene: Path) -> UserError:
    """The error of a scene that has no script."""
    return UserError("no script beside the scene names it", str(scene), "name one: --edits FILE.jsonl")


def unchecked(args: argparse.Namespace) -> None:
    """Nothing about the arguments can be wrong."""


def job_of(args: argparse.Namespace, case: Case, policy: str = "", **more: Any) -> Job:
    """The replay of a scene that the arguments ask for; `more` are other arguments of `Job`."""
    frames, edits = getattr(args, "frames", 0) or None, str(case.edits or "")
    return Job(str(case.scene), edits, policy or args.policy, tuple(args.set), tuple(args.petsc), frames, **more)
