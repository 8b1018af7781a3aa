"""`restshape explain`: which effects a scene calls for and why, what each costs, and which solvers it gets."""

import argparse
import tempfile
from pathlib import Path
from typing import Any

from restshape_studies.bench.job import note_words

from restshape.application import application_of
from restshape.cli.options import add_scene, print_table, read_scene, write_json
from restshape.cli.parser import add_edits
from restshape.cli.ranks import launched
from restshape.cli.script_notes import note_scene, note_script
from restshape.cli.shipped import script_of
from restshape.cli.verbosity import add_verbose
from restshape.errors import UserError
from restshape.outputs.si_numbers import counted
from restshape.scene.materials import sources

PLACE = 1
SUMMARY = "print which effects a scene calls for and why, what each costs, and which solvers it gets"
FRAMES, SECONDS = 24, 9.0
COUNTED = ("unknowns", "elements", "entries", "calls")


def arguments(parser: argparse.ArgumentParser) -> None:
    """Adds what this command takes."""
    add_scene(parser)
    add_verbose(parser)
    add_edits(parser, "edit script (default: the one that names the scene)")
    parser.add_argument(
        "--frames",
        metavar="N",
        type=int,
        default=FRAMES,
        help="first N frames of the script in which something moves, 0 for all (default: %(default)s)",
    )
    parser.add_argument(
        "--seconds",
        metavar="S",
        type=float,
        default=SECONDS,
        help="measure again until so many seconds are gone, twice at least (default: %(default)g)",
    )


def run(args: argparse.Namespace) -> int:
    """Prints the plan and its price."""
    if launched():
        raise UserError("effects are priced on one rank", do="start it without mpiexec")
    from restshape_studies.explain.prediction import prediction
    from restshape_studies.explain.reach import reach
    from restshape_studies.explain.study import Asked, explain

    from restshape.scene.edit_script import load_script

    scene = read_scene(args)
    if args.frames < 0:
        raise UserError(f"{args.frames} frames measure nothing", "--frames", "at least 1, or 0 for all")
    edits, script = args.edits or script_of(args.scene), None
    if edits is not None:
        script = load_script(edits, scene)
        if script.error:
            raise script.error
        note_script(scene, script, edits)
    note_scene(scene)
    asked = Asked(args.scene, edits, tuple(args.set), tuple(args.petsc), args.frames or None, args.seconds)
    with tempfile.TemporaryDirectory(prefix="restshape-explain-") as folder:
        rows = explain(asked, scene, application_of(scene), Path(folder))
    first = rows[0]
    total = sum(row["ms"] for row in rows)
    of = f"{counted(first['frames'], 'frame')} of {edits.name}" if edits else "the first frame, for there is no script"
    print_effects(f"{args.scene}: {scene.title}".rstrip(": "), rows)
    measured = f"{counted(first['runs'], 'run')}, policy {scene.solve.policy}"
    print(f"shares of {total:.4g} ms of processor time, the mean of {of}; {measured}\n")
    core = next(row for row in rows if "solver" in row)
    lines = [
        *solvers(core["solver"]),
        *reach(scene, script),
        prediction(scene, script),
        *application_of(scene).command_costs(scene),
    ]
    print_table("solvers", ("what", "choice", "why"), lines)
    if called := kernels(rows):
        print()
        print_table("kernels called, a frame", ("effect", "kernels: calls, elements in each"), called)
    if named := sources({own: material.name for own, material in scene.material.items()}):
        print()
        print_table("materials", ("material", "name", "source of its values"), named)
    note_words(args.petsc)
    write_json(args, rows)
    return 0


def print_effects(title: str, rows: list[dict[str, Any]]) -> None:
    """Prints the table of effects and parts."""
    heads = ("effect", "on", "unknowns", "elements", "entries", "calls a frame", "share", "why")
    print_table(title, heads, [_line(row) for row in rows], right=heads[2:-1])


def _line(row: dict[str, Any]) -> list[str]:
    name, part = row["effect"], row["kind"] == "part"
    if not row["on"]:
        return [name, "off", *["-"] * 5, f"nothing calls for it: {row['why']}"]
    has_share = row["how"].startswith("by difference") or row["how"] == "measured"
    core = "solver" in row
    has_counts = has_share or core or any(row[key] for key in COUNTED)
    counts = [str(row[key]) for key in COUNTED[:-1]] if has_counts and not part else ["-"] * 3
    known = has_share or (core and not row["how"].startswith("not determined"))
    share = f"{100 * row['share']:.1f} ± {100 * row['spread']:.1f} %" if known else "-"
    if row["how"].startswith("by difference of"):
        return [name, "on", *["-"] * 4, share, f"{row['why']} ({row['how']})"]
    why = row["why"] if has_share else f"{row['why']} ({row['how']})"
    return [name, "" if part else "on", *counts, f"{row['calls']:.3g}" if has_counts else "-", share, why]


def solvers(plan: dict[str, Any]) -> list[tuple[str, str, str]]:
    """The plan of solvers, for people: what, which, why."""
    rows = [("equations", plan["equations"], plan["why"])]
    for system in plan["systems"]:
        krylov = " with ".join(filter(None, (system["krylov"].upper(), system["factor"])))
        rows.append((system["of"], f"{system['matrix']}: {krylov}", system["why"]))
    if plan["elements"]:
        rows.append(("elements", f"order {plan['order']}: {', '.join(plan['elements'])}", plan["order_why"]))
    rows += [("model", value, f"effects.{key}") for key, value in plan["models"].items()]
    used = ", ".join(f"{name} in {counted(count, 'frame')}" for name, count in plan["preconditioners"].items() if name)
    expected = ", ".join(f"{name} {ms:.3g}" for name, ms in sorted(plan["expected_ms"].items(), key=lambda at: at[1]))
    why = f"policy {plan['policy']}{', expected ms a solve: ' + expected if expected else ''}"
    rows.append(("preconditioner", used, why))
    done = (
        f"{counted(plan['factorisations'], 'frame')} with a factorisation, {counted(plan['iterations'], 'iteration')}"
    )
    newton = f", {counted(plan['newton'], 'Newton step')}" if plan["newton"] else ""
    rows.append(("work", f"{done}{newton}", "in these frames, the first included"))
    return rows


def kernels(rows: list[dict[str, Any]]) -> list[tuple[str, str]]:
    """Kernels that effects call, for people, and those of another effect that these stand in place of."""
    found = []
    for row in rows:
        made: dict[bool, list[str]] = {False: [], True: []}
        for name, purposes in row["kernels"].items():
            for purpose, (times, elements) in purposes.items():
                if times:
                    words = f"{name} {purpose} {abs(times) / row['frames']:.3g} x {elements / times:.0f}"
                    made[times < 0].append(words)
        words = [f"{'in place of ' if taken else ''}{', '.join(calls)}" for taken, calls in made.items() if calls]
        if words:
            found.append((row["effect"], "; ".join(words)))
    return found
