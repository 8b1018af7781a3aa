"""The study `restshape bench reuse`: policies side by side on the same edits."""

import argparse
from pathlib import Path
from typing import Any

from restshape_studies.bench.turns import Announce, Case
from restshape_studies.commands.bench_kind import Kind, add_frames, add_repeat, check_runs, read_results

from restshape.cli.options import print_table
from restshape.errors import UserError, one_line
from restshape.outputs.picture_files import drawn_from, fingerprint
from restshape.outputs.si_numbers import counted
from restshape.policy import GUESSES, POLICIES
from restshape.replay.level_names import LEVEL_NAMES, MOVES

EVENTS = (
    "MatCholFctrSym",
    "MatCholFctrNum",
    "KSPSolve",
    "PCApply",
    *(f"Restshape{n}" for n in ("Pattern", "Patch", "Values")),
)
TIMES = {
    "ms": "until the answer; no residual, no estimates, no recorder",
    "whole": "with the residual; no estimates, no recorder",
    "estimated": "with the residual and estimates as solve.estimate says; no recorder",
}
"""What times of a record include."""
STAGES_PICTURE = "bench-stages.png"
"""Beside the picture of the study, where earlier figures are given."""
OVER = ("x rebuild", "x refactor", "x refactor, same guess")
"""Heads of frames a second over those of other policies."""
GUESSED = ("rebuild:zero", "refactor:zero", "refactor:last", "auto:zero", "auto:last", "auto:extrapolated")
"""Policies with other initial guesses than their own: what these alone are worth."""


def declare(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument(
        "--policies",
        default=",".join((*POLICIES, *GUESSED)),
        metavar="A,B",
        help="with another initial guess than its own NAME:GUESS; default: %(default)s",
    )
    add_frames(parser, 200)
    add_repeat(parser, "timed runs a policy")
    what = "of a scene, after which no other turn of its policies begins, and a policy that takes longer is left out"
    parser.add_argument("--seconds", type=float, default=300.0, metavar="S", help=f"{what} (default: %(default)g)")
    parser.add_argument(
        "--before",
        type=Path,
        metavar="FILE",
        help=f"JSON of an earlier run, beside whose stages those of this one are drawn: {STAGES_PICTURE}",
    )


def policies(args: argparse.Namespace) -> tuple[str, ...]:
    """The policies that are asked for, each once."""
    return tuple(dict.fromkeys(name.strip() for name in args.policies.split(",")))


def check(args: argparse.Namespace) -> None:
    """Refuse what measures nothing, and policies that do not exist."""
    check_runs(args)
    if not args.seconds > 0:
        raise UserError(f"{args.seconds:g} s measure nothing", "--seconds", "give more, or leave it out")
    if args.before:
        _earlier(args.before)
    for asked in policies(args):
        name, _, guess = asked.partition(":")
        if name not in POLICIES:
            raise UserError(f"no policy is named {name!r}", "--policies", f"choose from {','.join(POLICIES)}")
        if guess and guess not in GUESSES:
            raise UserError(f"no initial guess is named {guess!r}", "--policies", f"choose from {','.join(GUESSES)}")


def measure(args: argparse.Namespace, case: Case, announce: Announce) -> dict[str, Any]:
    """A record for each policy."""
    from restshape_studies.bench.reuse import Plan, compare

    from restshape.scene.load import load_scene

    given = tuple(args.set), tuple(args.petsc)
    plan = Plan(policies(args), args.repeat, args.frames or None, *given, args.seconds)
    tolerance = load_scene(case.scene, args.set).solve.tolerance
    said = {"tolerance": tolerance, "times": TIMES}
    return {name: {**said, **entry} for name, entry in compare(case, plan, announce).items()}


def draw(found: dict[str, Any], args: argparse.Namespace, path: Path) -> None:
    """Draw the frames a second of all policies, and their stages beside those of an earlier run."""
    from restshape_studies.pictures.policies import draw_policies

    draw_policies(found, path)
    if args.before:
        from restshape_studies.pictures.stages import draw_stages

        before, title = _earlier(args.before)
        stamps = [read_results(path, "--redraw")[1] for path in args.redraw or ()]
        after = ", ".join(dict.fromkeys(stamps)) or "this code"
        with drawn_from(fingerprint({"before": before, "after": found})):
            draw_stages(before, found, (title, after), path.with_name(STAGES_PICTURE))
        print(f"wrote {one_line(path.with_name(STAGES_PICTURE))}")


def _earlier(path: Path) -> tuple[Any, str]:
    """What an earlier run wrote after --json, and what it names as its commit.

    Raises:
        UserError: the file cannot be read, or holds no such results.
    """
    from restshape_studies.pictures.stages import LEVELS, stage_parts

    data, title = read_results(path, "--before")
    try:
        parts = [stage_parts(one, level) for scene in data.values() for one in scene.values() for level in LEVELS]
    except (KeyError, TypeError, AttributeError):
        parts = []
    if not any(parts):
        what = "this holds no results of restshape bench reuse"
        raise UserError(what, f"--before {path}", "name what bench reuse --json wrote")
    return data, title


def show(args: argparse.Namespace, name: str, found: dict[str, Any]) -> None:
    """Print the tables of one scene."""
    one = next(iter(found.values()))
    loads = [run["load"] for entry in found.values() for run in entry["runs"]]
    title = (
        f"{name}: {one['frames']} frames, about {one['unknowns']} unknowns, {one['elements']} elements, one core; "
        f"median of {counted(len(one['runs']), 'run')}; load of the machine {min(loads):.1f} to {max(loads):.1f}"
    )
    heads = ("policy", "frames/s", "p50, ms", "p95, ms", "p99, ms", *OVER, "Python, ms")
    heads += ("iterations", "refreshes", "refused", "preconditioners")
    print_table(title, heads, [_policy_row(key, entry) for key, entry in found.items()], heads[1:-1])
    print("p50, p95, p99, frames/s: until the answer is known")
    _print_left_out(one)
    heads = ("all that a frame costs", "p50, ms", "frames/s", "whole session, s")
    heads += tuple(f"{head}, errors estimated" for head in heads[1:])
    print_table("", heads, [_whole_row(key, entry) for key, entry in found.items()], heads[1:])
    print("with residual, without a recorder; errors are estimated as solve.estimate says, or not at all")
    heads = ("frames: p50, ms", *(LEVEL_NAMES[str(level)] for level in MOVES), "solved at rest", "idle")
    heads += ("mesh moves", *OVER[:2])
    print_table("", heads, [_levels_row(key, entry, found) for key, entry in found.items()], heads[1:])
    stages = [stage for stage in one["stages"] if any(entry["stages"][stage] >= 0.05 for entry in found.values())]
    rows = [[key, *(f"{entry['stages'][stage]:.1f}" for stage in stages)] for key, entry in found.items()]
    print_table("", ("stages in all, ms", *stages), rows, stages)
    events = [event for event in one["events"] if event in EVENTS or any(e["events"][event] for e in found.values())]
    rows = [[event, *(str(entry["events"][event]) for entry in found.values())] for event in events]
    print_table("", ("PETSc events", *found), rows, list(found))
    print()


def _print_left_out(one: dict[str, Any]) -> None:
    """Print what --seconds has left out, of the record of any policy."""
    done, asked = len(one["runs"]), one.get("turns", 0)
    if done < asked:
        print(f"{done} of the {asked} runs that --repeat asks for: the others would take longer than --seconds")
    for name, why in one.get("left_out", {}).items():
        print(f"{name} is left out: {why}; give more --seconds, or fewer --frames")


def _policy_row(name: str, entry: dict[str, Any]) -> list[str]:
    ms, ratios = entry["ms"], entry["ratios"]
    bases = ("rebuild", "refactor", f"refactor:{name.partition(':')[2]}")
    times = [_ratio(ratios[base]["fps"]) if base in ratios else "" for base in bases]
    counts = [str(entry[key]) for key in ("iterations", "refreshes", "refused")]
    python = f"{entry['python_ms']['p50']:.3f}"
    used = ", ".join(f"{kind} {frames}" for kind, frames in entry["preconditioners"].items() if kind)
    middle = [f"{ms[key]:.3f}" for key in ("p50", "p95", "p99")]
    return [name, f"{entry['fps']:.4g}", *middle, *times, python, *counts, used]


def _whole_row(name: str, entry: dict[str, Any]) -> list[str]:
    runs = [entry["whole"], entry.get("estimated")]
    cells = [(f"{run['p50']:.3f}", f"{run['fps']:.4g}", f"{run['session_s']:.3f}") if run else [""] * 3 for run in runs]
    return [name, *cells[0], *cells[1]]


def _ratio(value: float | None) -> str:
    return "" if value is None else f"{value:.2f}"


def _levels_row(name: str, entry: dict[str, Any], found: dict[str, Any]) -> list[str]:
    levels = [
        f"{entry['levels'][k]}: {entry['ms_by_level'][k]['p50']:.3f}" if entry["levels"][k] else "0"
        for k in ("1", "2", "3", "still")
    ]
    moves, bases = entry["moves"], [found[base]["moves"] for base in ("rebuild", "refactor") if base in found]
    middle = f"{moves['frames']}: {moves['p50']:.3f}" if moves["frames"] else "0"
    times = [_ratio(base["p50"] / moves["p50"]) if moves["frames"] else "" for base in bases]
    return [name, *levels, str(entry["idle"]), middle, *times, *[""] * (2 - len(times))]


KINDS = (
    Kind(
        "reuse",
        "policies side by side on the same edits",
        declare,
        check,
        measure,
        show,
        scenes="several",
        picture="bench-reuse.png",
        times="frames on one core, as each table says; the first frame is left out",
        draw=draw,
    ),
)
