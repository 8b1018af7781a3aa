"""The study `restshape bench drape`: Solution strategies of cloth."""

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from restshape_studies.bench.cloth_strategies import BENDING, POLICIES, WAYS

from restshape.cli.options import check_output, print_table
from restshape.errors import UserError


def arguments(studies: Any) -> argparse.ArgumentParser:
    """Declare the study; returns its parser."""
    study = studies.add_parser("drape", help="ways of cloth to rest, kinds of bending, and policies on a script")
    study.add_argument("scene", metavar="SCENE", type=Path, help="scene file of cloth")
    study.add_argument(
        "--edits", type=Path, metavar="FILE", help="edit script for policies (default: the one that names the scene)"
    )
    for name, what, default in (
        ("ways", "ways to rest", WAYS),
        ("bending", "kinds of bending", BENDING),
        ("policies", "policies", POLICIES),
    ):
        study.add_argument(
            f"--{name}",
            default=",".join(default),
            metavar="A,B",
            help=f"{what}, or none of them: '' (default: %(default)s)",
        )
    study.add_argument(
        "--seconds", type=float, default=60.0, metavar="S", help="after which a run is given up (default: %(default)g)"
    )
    study.add_argument(
        "--frames",
        type=int,
        default=0,
        metavar="N",
        help="first N frames of the script, 0 for all (default: %(default)s)",
    )
    study.add_argument("--picture", type=Path, metavar="FILE", help="residuals against time and steps (.png)")
    return study


def drape(args: argparse.Namespace, scene: Any, edits: Path | None, announce: Any) -> dict[str, Any]:
    """Let all ways bring the cloth to equilibrium, print and draw what was found."""
    from restshape_studies.bench.cloth_strategies import Plan, study
    from restshape_studies.bench.job import Job
    from restshape_studies.pictures.residuals import draw_residuals

    if args.seconds <= 0 or args.frames < 0 or args.frames == 1:
        what = f"{args.frames} frames, {args.seconds:g} s a run: this measures nothing"
        raise UserError(what, "--frames, --seconds", "at least 2 frames, some seconds")
    check_output(args.picture, "--picture")
    known = {"ways": WAYS, "bending": BENDING, "policies": POLICIES}
    plan = Plan(
        **{name: chosen(getattr(args, name), name, names) for name, names in known.items()}, seconds=args.seconds
    )
    job = Job(str(args.scene), str(edits or ""), "auto", tuple(args.set), tuple(args.petsc), args.frames or None)
    found = study(job, plan, announce)
    name = scene.title or args.scene.stem
    print_drape(name, found)
    if args.picture:
        draw_residuals(name, found["ways"], args.picture)
        print(f"wrote {args.picture}")
    return found


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


def print_drape(name: str, found: Mapping[str, Any]) -> None:
    """Print the tables of a scene."""
    heads = ("at rest", "residual / weight", "energy [J]", "short of the best [%]", "seconds", "busy [s]", "steps")
    heads += ("factors", "applied", "unknowns", "what is missing")
    for kind, title in (("ways", "ways to rest from the same start"), ("bending", "kinds of bending")):
        rows = [(key, *_cells(entry)) for key, entry in found[kind].items()]
        if rows:
            print_table(f"{name}: {title}", (kind, *heads), rows, heads[1:-1])
    heads = ("frames", "at rest", "first [s]", "p50 [s]", "mean [s]", "longest [s]", "steps a frame", "factors a frame")
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
