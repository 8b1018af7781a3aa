"""`restshape accuracy`: what accuracy costs in time, for any scene."""

# More than 15 modules: the command joins the study's points, choices, pictures and pages.

import argparse
import sys
from math import inf
from pathlib import Path
from typing import Any

from restshape_studies.bench.job import note_words
from restshape_studies.verification import verification

from restshape.cli.options import add_json, add_set, print_table, require_mesh, write_json
from restshape.cli.ranks import launched
from restshape.cli.script_notes import note_script
from restshape.cli.verbosity import add_verbose
from restshape.errors import UserError, one_line
from restshape.outputs.kinds import PointsFile, SceneFile
from restshape.outputs.si_numbers import counted
from restshape.policy import POLICIES

PLACE = 4
SUMMARY = "what accuracy costs in time: errors of a scene's settings against a far finer reference"


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("scenes", metavar="SCENE", nargs="+", type=Path, help="scene files (.toml)")
    parser.add_argument(
        "--edits",
        type=Path,
        metavar="FILE",
        help="edit script (default: the one that names the scene; without one the first shape is studied)",
    )
    add_set(parser)
    add_json(parser)
    add_verbose(parser)
    parser.add_argument(
        "--out", type=Path, metavar="DIR", default=Path("accuracy"), help="of the pages (default: %(default)s)"
    )
    study_arguments(parser)
    pick_arguments(parser)
    time_arguments(parser)
    parser.add_argument("--csv", type=PointsFile, metavar="FILE", help="a row a point, as soon as it is known")


def study_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what is studied: frames, settings, and the quantity whose error counts."""
    parser.add_argument(
        "--frames",
        type=int,
        metavar="N",
        help="of the script, 0 for all (default: 40 from the first change on, in space 24, of motion 6)",
    )
    parser.add_argument(
        "--samples", type=int, default=5, metavar="K", help="frames at which errors are taken (default: %(default)s)"
    )
    parser.add_argument(
        "--sizes", metavar="A,B", help="factors of the scene's mesh size (default: 2,1.41,1,0.71,0.5, as far as quick)"
    )
    parser.add_argument("--orders", metavar="A,B", help="of the elements (default: all that the application has)")
    parser.add_argument(
        "--tolerances",
        metavar="A,B",
        help="of the solver, tried beside the grid (default: 100 and 1/100 of the scene's)",
    )
    parser.add_argument("--policies", metavar="A,B", help=f"default: {','.join(POLICIES)}")
    parser.add_argument(
        "--of", default="field", metavar="QUANTITY", help="whose error counts (default: that of the field)"
    )


def pick_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what a setting is picked by, and where it is written."""
    parser.add_argument(
        "--within", metavar="TIME", help="pick the most accurate point whose median frame takes no longer, e.g. 16ms"
    )
    parser.add_argument(
        "--error", metavar="ERROR", help="pick the fastest point whose error is below, e.g. 1%%, or 0.01"
    )
    parser.add_argument(
        "--write",
        type=SceneFile,
        metavar="FILE",
        help="of the scene with the picked setting (default: DIR/SCENE-chosen.toml)",
    )


def time_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the time that a point, a reference and a study may take."""
    parser.add_argument(
        "--seconds", type=float, default=30.0, metavar="S", help="that a point may take (default: %(default)g)"
    )
    parser.add_argument(
        "--budget", metavar="TIME", help="that each study may take, such as 5min; the same command goes on from there"
    )
    parser.add_argument(
        "--reference-seconds",
        type=float,
        default=120.0,
        metavar="S",
        help="that a reference may take (default: %(default)g)",
    )


def run(args: argparse.Namespace) -> int:
    """Study each scene; 0 when all is well, 1 where reuse is not below the tolerance or no pick holds.

    Raises:
        UserError: a wish that makes no sense, or ranks of MPI.
    """
    from restshape_studies.accuracy.front import finite
    from restshape_studies.accuracy.page import write_index, write_page
    from restshape_studies.accuracy.study import study

    if launched():
        raise UserError("points are replayed on one rank", "mpiexec", "start it without mpiexec")
    asked, within, error = read(args)
    cases = cases_of(args)
    make_folder(args.out)
    records, studies, meshless, valid = [], [], [], True
    command = command_of(args)
    for case in cases:
        if without_mesh := own_study(case):
            found, title = without_mesh(case, announce, args.out, command)
            records += found
            meshless.append((case.name, title))
            write_json(args, finite(records))
            continue
        before = list(records)

        def on_point(own: list[dict[str, Any]], before: list[dict[str, Any]] = before) -> None:
            write_json(args, finite([*before, *own]))
            write_csv(args.csv, [*before, *own])

        found = study(case, asked, announce, out=args.out, on_point=on_point)
        print_points(found)
        valid = reuse_holds(found) and valid
        records += found.records
        studies.append(found)
        write_json(args, finite(records))
        write_page(found, args.out, command)
        if within is not None or error is not None:
            chosen = choose(args, found, within, error)
            write_page(found, args.out, command, chosen)
            valid = chosen["holds"] and valid
        print(f"wrote {one_line(args.out / case.name)}.md and .png\n", flush=True)
    if len(studies) > 1:
        write_index(studies, args.out, command, meshless)
        print(f"wrote {one_line(args.out / 'README.md')}")
    note_words(args.petsc)
    return 0 if valid else 1


# --- what is asked for ------------------------------------------------------------------------------------------------


def read(args: argparse.Namespace) -> tuple[Any, float | None, float | None]:
    """What the study is asked for, the time [ms] and the error that a pick is bounded by.

    Raises:
        UserError: a value that makes no sense.
    """
    from restshape_studies.accuracy.setting import Choice
    from restshape_studies.accuracy.study import Asked

    if args.frames is not None and (args.frames < 0 or args.frames == 1):
        raise UserError(
            "a single frame holds no edit" if args.frames == 1 else f"{args.frames} frames cannot be",
            "--frames",
            "at least 2, or 0 for all",
        )
    if args.samples < 2:
        raise UserError(
            f"{counted(args.samples, 'frame')} {'is' if args.samples == 1 else 'are'} too few",
            "--samples",
            "at least 2",
        )
    for option in ("seconds", "reference_seconds"):
        if not getattr(args, option) > 0.0:
            raise UserError("there must be time", f"--{option.replace('_', '-')}", "a number above 0")
    sizes, tolerances = (numbers(getattr(args, name), f"--{name}") for name in ("sizes", "tolerances"))
    if tolerances and max(tolerances) >= 1.0:
        raise UserError(f"{max(tolerances):g} is no tolerance", "--tolerances", "numbers between 0 and 1")
    orders = numbers(args.orders, "--orders")
    if orders and any(order != int(order) for order in orders):
        raise UserError(f"{args.orders} are no orders", "--orders", "--orders 1,2")
    policies = words(args.policies)
    for name in policies or ():
        if name not in POLICIES:
            raise UserError(f"no policy is named {name!r}", "--policies", f"choose from {','.join(POLICIES)}")
    budget = bound(args.budget, "time", "--budget", "5min")
    choice = Choice(sizes, orders and tuple(int(order) for order in orders), tolerances, policies)
    within, error = bound(args.within, "time", "--within", "16ms"), share(args.error, "--error")
    if args.write and ((within is None and error is None) or len(args.scenes) > 1):
        raise UserError(
            "nothing is picked that could be written", "--write", "one scene, and --within 16ms or --error 1%"
        )
    within = within and 1e3 * within
    asked = Asked(
        choice, args.frames, args.samples, args.seconds, args.reference_seconds, args.of, budget or inf, within
    )
    return asked, within, error


def numbers(text: str | None, where: str) -> tuple[float, ...] | None:
    """Positive numbers between commas; None where nothing is given.

    Raises:
        UserError: something else is between them.
    """
    if text is None:
        return None
    try:
        found = tuple(dict.fromkeys(float(word) for word in text.split(",")))
    except ValueError:
        found = ()
    if not found or not all(0.0 < value < float("inf") for value in found):
        raise UserError(f"{text!r} are no positive numbers", where, f"numbers with commas between: {where} 2,1,0.5")
    return found


def words(text: str | None) -> tuple[str, ...] | None:
    """Words between commas; None where nothing is given."""
    return None if text is None else tuple(dict.fromkeys(word.strip() for word in text.split(",")))


def bound(text: str | None, dimension: str, where: str, example: str) -> float | None:
    """A positive number with a unit, in SI; a time needs its unit.

    Raises:
        UserError: it cannot be read, or is not positive.
    """
    from restshape.scene.units import UnitError, quantity

    if text is None:
        return None
    try:
        value = quantity(text, dimension)
        if dimension == "time" and text.strip()[-1].isdigit():
            raise UnitError(f"{text!r} has no unit")
    except UnitError as error:
        raise UserError(error.what, where, f"write {where} {example}") from error
    if value <= 0.0:
        raise UserError(f"{text} is not above 0", where, f"write {where} {example}")
    return value


def share(text: str | None, where: str) -> float | None:
    """A positive share, in per cent or as a number below 1, and said again in per cent where it is a number.

    Raises:
        UserError: it cannot be read, is not positive, or is a number of 1 or more, which may be meant in per cent.
    """
    found = bound(text, "number", where, "1%")
    if text is None or found is None or "%" in text:
        return found
    if found >= 1.0:
        raise UserError(
            f"{text} without % is {100.0 * found:g} %", where, f"write {where} {found:g}% or {found / 100:g}"
        )
    announce(f"{where} {text}: below {100.0 * found:g} %")
    return found


def cases_of(args: argparse.Namespace) -> list[Any]:
    """Scenes and scripts, all read before the first run.

    Raises:
        UserError: a bad scene or script, or a motion without a script.
    """
    from restshape_studies.accuracy.study import Case

    from restshape.application import application_of
    from restshape.cli.shipped import refuse_shared_script, script_of
    from restshape.scene.edit_script import load_script
    from restshape.scene.load import load_scene

    refuse_shared_script(args.scenes, args.edits)
    found = []
    for path in args.scenes:
        scene = load_scene(path, args.set)
        refuse_choices(args, scene)
        edits = args.edits or script_of(path)
        if edits is None and application_of(scene).transient(scene):
            raise UserError("no script beside the scene names it", str(path), "name one: --edits FILE.jsonl")
        if args.of not in (None, "field", *scene.quantities):
            known = ", ".join(["field", *scene.quantities])
            raise UserError(f"{path.name} has no quantity {args.of!r}", "--of", f"use one of: {known}")
        if edits:
            note_script(scene, load_script(edits, scene), edits)
        found.append(Case(path.stem, path, edits, tuple(args.set), tuple(args.petsc)))
    names = [case.name for case in found]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice:
        raise UserError(f"two scenes are named {twice!r}, and so would their pages be", "SCENE", "run them one by one")
    return found


CHOICES = ("frames", "sizes", "orders", "tolerances", "policies", "within", "error")
"""Options that are about meshes."""


def refuse_choices(args: argparse.Namespace, scene: Any) -> None:
    """Makes sure that nothing about meshes is asked of a scene that has none.

    Raises:
        UserError: something is.
    """
    if any(getattr(args, name) is not None for name in CHOICES) or args.of != "field":
        require_mesh(scene, "its study takes none of the options about meshes, frames and picks")


def own_study(case: Any) -> Any:
    """The study of a scene without a mesh that its application brings; None where it is studied by its meshes."""
    from restshape.scene.load import load_scene

    return verification(load_scene(case.scene, case.overrides).app).load_study()


def write_csv(path: Path | None, records: list[dict[str, Any]]) -> None:
    """Writes a table of points, if it is asked for.

    Raises:
        UserError: it cannot be written, or another file is there.
    """
    from restshape_studies.accuracy.kept_points import COLUMNS

    from restshape.replay.recording.row_table import table_of_rows

    with table_of_rows(path, list(COLUMNS), PointsFile) as write:
        for record in records if write else ():
            write({name: "" if record.get(name) is None else record[name] for name in COLUMNS})


def make_folder(folder: Path) -> None:
    """Make the folder of the pages, before any work.

    Raises:
        UserError: it cannot be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        probe = folder / ".probe"
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise UserError(f"{folder} cannot be written: {error.strerror}", "--out", "choose another folder") from error


def command_of(args: argparse.Namespace) -> str:
    """The command line, without paths that mean something on this machine only."""
    from restshape.cli.list import relative

    def plain(word: str) -> str:
        if not word.startswith("/"):
            return word
        path = relative(Path(word))
        return Path(word).name if path.startswith("/") else path

    return " ".join(["restshape", *(plain(word) for word in args.words)])


# --- what is reported -------------------------------------------------------------------------------------------------


def announce(text: str) -> None:
    """Reports what comes next, where it does not mix with tables."""
    print(text, file=sys.stderr, flush=True)


def print_points(study: Any) -> None:
    """Print the table of a study, its front, and what was left out."""
    from restshape_studies.accuracy.facts import HEADS, facts, left_out, rows

    title = f"{study.case.name}: {counted(study.total, 'frame')}, errors at frame{'s' * (len(study.frames) > 1)} "
    title += ", ".join(map(str, study.frames))
    print_table(title, HEADS, rows(study), right=HEADS[:8])
    for name, value in facts(study):
        print(f"{name}: {value}")
    for line in left_out(study):
        print(f"left out: {line}")


def reuse_holds(study: Any) -> bool:
    """Whether reuse stays below the tolerance at every point where it is known, and is known at one at least."""
    known = [record["reuse_holds"] for record in study.records if record["reuse_holds"] is not None]
    return bool(known) and all(known)


def choose(args: argparse.Namespace, study: Any, within: float | None, error: float | None) -> dict[str, Any]:
    """The first pick that holds where it is written as a scene and run again over the whole script, or the last one.

    It comes with `holds`, and with what was found of those tried `before` it, in words.
    """
    from restshape_studies.accuracy.chosen import chosen_line, hopeless, not_converging, rerun, write_scene
    from restshape_studies.accuracy.front import percent, picks

    path = args.write or args.out / f"{study.case.name}-chosen.toml"
    found, before = {}, []
    for picked in picks(study.records, within, error, not_converging(study)):
        if found:
            before.append(f"{found['name']}: {chosen_line(found)}")
        at = "" if study.total == 1 else f" at {len(picked['frames'])} of {counted(study.total, 'frame')}"
        error_there = f"error {percent(picked['error'])}{at}"
        print(f"picked: {picked['name']}, {picked['frame_ms']:.3g} ms a frame, {error_there}", flush=True)
        write_scene(study.case, picked, path)
        print(f"wrote {one_line(path)}")
        found = rerun(study, picked, path, within, error, announce) | {"before": before}
        print(chosen_line(found), flush=True)
        if found["holds"] or hopeless(found):
            break
    if not found["holds"]:
        print(f"no point of the study holds over the script; {path} has the last of {len(before) + 1} that were tried")
    return found
