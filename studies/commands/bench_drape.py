"""The study `restshape bench drape`: Solution strategies of cloth."""

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from restshape_studies.bench.cloth_strategies import BENDING, POLICIES, STRATEGIES
from restshape_studies.bench.turns import Announce, Case
from restshape_studies.commands.bench_kind import Kind, add_frames, job_of

from restshape.cli.options import print_table
from restshape.errors import UserError
from restshape.outputs.kinds import PictureFile

KNOWN = {"strategies": STRATEGIES, "bending": BENDING, "policies": POLICIES}


def declare(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    for name, what, default in (
        ("strategies", "solution strategies", STRATEGIES),
        ("bending", "kinds of bending", BENDING),
        ("policies", "policies", POLICIES),
    ):
        parser.add_argument(
            f"--{name}",
            default=",".join(default),
            metavar="A,B",
            help=f"{what}, or none of them: '' (default: %(default)s)",
        )
    parser.add_argument(
        "--seconds", type=float, default=60.0, metavar="S", help="after which a run is given up (default: %(default)g)"
    )
    add_frames(parser)
    parser.add_argument("--picture", type=PictureFile, metavar="FILE", help="residuals against time and steps (.png)")


def check(args: argparse.Namespace) -> None:
    """Refuse what measures nothing, and names that are not known."""
    if args.seconds <= 0 or args.frames < 0 or args.frames == 1:
        what = f"{args.frames} frames, {args.seconds:g} s a run: this measures nothing"
        raise UserError(what, "--frames, --seconds", "at least 2 frames, some seconds")
    for name, names in KNOWN.items():
        chosen(getattr(args, name), name, names)


def measure(args: argparse.Namespace, case: Case, announce: Announce) -> dict[str, Any]:
    """A record for each way, kind of bending and policy."""
    from restshape_studies.bench.cloth_strategies import Plan, study

    names = {name: chosen(getattr(args, name), name, names) for name, names in KNOWN.items()}
    return study(job_of(args, case, "auto"), Plan(**names, seconds=args.seconds), announce)


def draw(found: dict[str, Any], args: argparse.Namespace, path: Path) -> None:
    """Draw residuals against time and steps."""
    from restshape_studies.pictures.residuals import draw_residuals

    ((name, one),) = found.items()
    draw_residuals(name, one["strategies"], path)


def chosen(text: str, option: str, names: Sequence[str]) -> tuple[str, ...]:
    """The names after an option, each once.

    Raises:
        UserError: one is not known.
    """
    words = tuple(dict.fromkeys(filter(None, (word.strip() for word in text.split(",")))))
    for word in words:
        if word not in names:
            raise UserError(f"{word!r} is none of the {option}", f"--{option}", f"choose from {','.join(names)}")
    return words


def show(args: argparse.Namespace, name: str, found: Mapping[str, Any]) -> None:
    """Print the tables of a scene."""
    heads = ("converged", "residual / weight", "energy [J]", "short of the best [%]", "seconds", "busy [s]", "steps")
    heads += ("factors", "applied", "unknowns", "what is missing")
    for kind, title in (("strategies", "solution strategies from the same start"), ("bending", "kinds of bending")):
        rows = [(key, *_cells(entry)) for key, entry in found[kind].items()]
        if rows:
            print_table(f"{name}: {title}", (kind, *heads), rows, heads[1:-1])
    heads = (
        "frames",
        "converged",
        "first [s]",
        "p50 [s]",
        "mean [s]",
        "longest [s]",
        "steps a frame",
        "factors a frame",
    )
    heads += ("iterations a frame", "problem")
    keys = ("frames", "converged", "first", "p50", "mean", "longest", "steps", "factors", "iterations")
    rows = [(key, *(_number(entry.get(k)) for k in keys), entry["problem"]) for key, entry in found["policies"].items()]
    if rows:
        print_table(f"{name}: policies, frames of the script", ("policy", *heads), rows, heads[:-1])


def _cells(entry: Mapping[str, Any]) -> list[str]:
    if "problem" in entry:
        return [*("" for _ in range(10)), entry["problem"]]
    resting = "yes" if entry["converged"] else "no"
    if entry["converged"] and entry["stable"] is False:
        resting = "on a saddle"
    short = entry.get("short")
    return [
        resting,
        "-" if entry["residual"] is None else f"{entry['residual']:.1e}",
        "-" if entry["energy"] is None else f"{entry['energy']:.6g}",
        "-" if short is None else f"{100.0 * short:.2f}",
        f"{entry['seconds']:.2f}",
        f"{entry['busy']:.2f}",
        *(str(entry[key]) for key in ("steps", "factors", "applications", "unknowns")),
        entry["why"],
    ]


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.3g}" if isinstance(value, float) else str(value)


KINDS = (
    Kind(
        "drape",
        "solution strategies of cloth, kinds of bending, and policies on a script",
        declare,
        check,
        measure,
        show,
        scenes="still",
        about="solution strategies of cloth are about one",
        draw=draw,
        times="first frames, mesh and all, until the cloth is in equilibrium, and of frames of the script as they are",
    ),
)
