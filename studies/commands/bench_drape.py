"""The study `restshape bench drape`: Solution strategies of cloth."""

import argparse
import atexit
import shutil
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from restshape_studies.bench.cloth_strategies import BENDING, POLICIES, STRATEGIES
from restshape_studies.bench.turns import Announce, Case
from restshape_studies.commands.bench_kind import Kind, add_frames, job_of
from restshape_studies.verification import verifications

from restshape.cli.options import print_table
from restshape.errors import UserError
from restshape.outputs.kinds import PictureFile
from restshape.outputs.si_numbers import counted

ALONE, TOGETHER = 60.0, 20.0
"""Seconds after which a run is given up, of one scene and of all of the study's own."""
NEAR = 0.01
"""Part of the fall of the energy that a way may miss and be as good as the best one."""
KNOWN = {"strategies": STRATEGIES, "bending": BENDING, "policies": POLICIES}


def declare(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    for options, what, default in (
        (("--strategies", "--ways"), "solution strategies", STRATEGIES),
        (("--bending",), "kinds of bending", BENDING),
        (("--policies",), "policies", POLICIES),
    ):
        kept = "" if default is STRATEGIES else ", of a scene that is named"
        what = f"{what}, or none of them: '' (default: {','.join(default)}{kept})"
        parser.add_argument(*options, metavar="A,B", help=what)
    what = f"where no scene is named, those of these names (default: all {len(_known())}: {', '.join(_known())})"
    parser.add_argument("--scenes", dest="among", default="", metavar="A,B", help=what)
    default = f"(default: {ALONE:g} of a scene that is named, else {TOGETHER:g})"
    what = f"of the processor, after which a run is given up {default}"
    parser.add_argument("--seconds", type=float, metavar="S", help=what)
    add_frames(parser)
    parser.add_argument("--picture", type=PictureFile, metavar="FILE", help="residuals against time and steps (.png)")


def check(args: argparse.Namespace) -> None:
    """Refuse what measures nothing, and names that are not known."""
    args.strategies = ",".join(STRATEGIES) if args.strategies is None else args.strategies
    args.bending = (",".join(BENDING) if args.scenes else "") if args.bending is None else args.bending
    args.policies = (",".join(POLICIES) if args.scenes else "") if args.policies is None else args.policies
    args.seconds = (ALONE if args.scenes else TOGETHER) if args.seconds is None else args.seconds
    if args.among and args.scenes:
        raise UserError("one scene is named, and others of the study", "--scenes", "leave out one of both")
    if args.seconds <= 0 or args.frames < 0 or args.frames == 1:
        what = f"{args.frames} frames, {args.seconds:g} s a run: this measures nothing"
        raise UserError(what, "--frames, --seconds", "at least 2 frames, some seconds")
    for name, names in KNOWN.items():
        chosen(getattr(args, name), name, names)


def _known() -> dict[str, str | Path]:
    """The study's own scenes by name."""
    return {name: one for each in verifications().values() for name, one in each.load_drapes().items()}


def own(args: argparse.Namespace) -> list[Case]:
    """The study's own scenes, as files in a folder that goes with this process.

    Raises:
        UserError: a name is not known.
    """
    known, folder = _known(), Path(tempfile.mkdtemp(prefix="restshape-drapes-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    cases = []
    for name in chosen(args.among, "scenes", list(known)) or tuple(known):
        path = known[name]
        if isinstance(path, str):
            path = folder / f"{name}.toml"
            path.write_text(str(known[name]))
        cases.append(Case(name, path, None))
    return cases


def measure(args: argparse.Namespace, case: Case, announce: Announce) -> dict[str, Any]:
    """A record for each way, kind of bending and policy."""
    from restshape_studies.bench.cloth_strategies import Plan, study

    names = {name: chosen(getattr(args, name), name, names) for name, names in KNOWN.items()}
    plan = Plan(**names, seconds=args.seconds)
    return study(job_of(args, case, "auto"), plan, lambda what: announce(f"{case.name}, {what}"))


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
    heads += ("factors", "applied", "unknowns", "strain [%]", "inside [mm]", "crossings", "openings", "what is missing")
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
        return [*("" for _ in range(14)), entry["problem"]]
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
        _times(100.0, entry.get("max_strain")),
        _times(1e3, entry.get("max_penetration")),
        _number(entry.get("crossings")),
        {True: "kept", False: "LOST", None: "-"}[entry.get("kept")],
        entry["why"],
    ]


def _times(factor: float, value: float | None) -> str:
    return "-" if value is None else f"{factor * value:.3g}"


def sum_up(found: Mapping[str, Any]) -> None:
    """Print what each way has done on all of the study's own scenes."""
    ways = dict.fromkeys(way for one in found.values() for way in one["strategies"])
    rows = [(way, *_summed([one["strategies"][way] for one in found.values()])) for way in ways]
    heads = ("at rest", f"within {100 * NEAR:g} % of the best", "openings kept", "uncrossed", "trusted", "busy [s]")
    print_table(counted(len(found), "scene"), ("way", *heads), rows, heads)


def _summed(entries: Sequence[Mapping[str, Any]]) -> list[str]:
    """On how many scenes a way has come to rest, near the best, with what was in openings, and trusted."""
    resting = [entry for entry in entries if entry.get("converged")]
    best = [entry for entry in resting if entry["short"] is not None and entry["short"] <= NEAR]
    asked = [entry for entry in entries if entry.get("kept") is not None]
    counts = [len(resting), sum(entry["kept"] is not False for entry in best)]
    counts.append(f"{sum(bool(entry['kept']) and entry['converged'] for entry in asked)} of {len(asked)}")
    counts += [sum(entry["crossings"] == 0 for entry in resting), sum(not entry["untrusted"] for entry in resting)]
    return [*map(str, counts), f"{sum(entry.get('busy', 0.0) for entry in entries):.1f}"]


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
        own=own,
        sum_up=sum_up,
        about="solution strategies of cloth are about one",
        draw=draw,
        times="first frames, mesh and all, until the cloth is in equilibrium, and of frames of the script as they are",
    ),
)
