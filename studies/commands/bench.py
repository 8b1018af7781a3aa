"""`restshape bench`: what reuse gains, and how time grows with size."""

import argparse
import sys
import tempfile
import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from restshape_studies.commands import bench_design, bench_drape, bench_eigen, bench_order

from restshape.application import applications
from restshape.cli.options import add_json, add_set, open_json, print_table, require_mesh, write_json
from restshape.cli.shipped import script_of
from restshape.cli.verbosity import add_verbose
from restshape.errors import UserError
from restshape.policy import POLICIES

PLACE = 5
SUMMARY = "measure what reuse and prediction gain, and how the time of a frame grows with size"
PICTURES = Path("results")
SIZE_SCENE = "plate"
EVENTS = (
    "MatCholFctrSym",
    "MatCholFctrNum",
    "KSPSolve",
    "PCApply",
    *(f"Restshape{n}" for n in ("Pattern", "Patch", "Values")),
)


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    studies = parser.add_subparsers(dest="study", metavar="STUDY", required=True)
    reuse = studies.add_parser("reuse", help="policies side by side on the same edits")
    reuse.add_argument("scenes", metavar="SCENE", nargs="*", type=Path, help="scene files (default: all installed)")
    reuse.add_argument("--policies", default=",".join(POLICIES), metavar="A,B", help="default: %(default)s")
    reuse.add_argument("--edits", type=Path, metavar="FILE", help="edit script (default: the one that names the scene)")
    reuse.add_argument(
        "--frames",
        type=int,
        default=200,
        metavar="N",
        help="first N frames of a script, 0 for all (default: %(default)s)",
    )
    reuse.add_argument("--repeat", type=int, default=3, metavar="R", help="timed runs a policy (default: %(default)s)")
    reuse.add_argument(
        "--hindsight",
        "--regret",
        dest="hindsight_cost",
        action="store_true",
        help="measure the regret of auto's refreshes in hindsight",
    )
    size = studies.add_parser("size", help="time of a frame of each level against the number of unknowns")
    size.add_argument("--from", dest="least", type=float, default=1e3, metavar="N", help="unknowns (default: 1e3)")
    size.add_argument("--to", dest="most", type=float, default=1e6, metavar="N", help="unknowns (default: 1e6)")
    size.add_argument("--points", type=int, default=7, metavar="K", help="sizes (default: %(default)s)")
    size.add_argument("--policy", choices=list(POLICIES), default="auto", help="default: %(default)s")
    size.add_argument(
        "--seconds", type=float, default=330.0, metavar="S", help="for all sizes together (default: %(default)g)"
    )
    plain = tuple(part.arguments(studies) for part in (bench_order, bench_eigen, bench_drape))
    for study in (*plain, *(drawing := (reuse, size, *bench_design.arguments(studies)))):
        add_set(study)
        add_json(study)
        add_verbose(study)
    for study in drawing:
        study.add_argument(
            "--out", type=Path, default=PICTURES, metavar="DIR", help="of the picture (default: %(default)s)"
        )


def run(args: argparse.Namespace) -> int:
    """Measure; 0 when it is done, 2 on bad input."""
    open_json(args)
    studies = {"reuse": _reuse, "size": _size, "predict": _predict, "derivative": _derivative}
    studies |= {"order": _order, "eigen": _eigen, "drape": _drape}
    return studies[args.study](args)


def _reuse(args: argparse.Namespace) -> int:
    """Compare policies, and report each scene as soon as it is done."""
    from restshape_studies.bench.reuse import Plan, compare
    from restshape_studies.pictures.policies import draw_policies

    if args.repeat < 1 or args.frames < 0 or args.frames == 1:
        what = f"{args.repeat} runs of {args.frames} frames measure nothing"
        raise UserError(what, "--repeat, --frames", "at least 1 run, at least 2 frames")
    names = tuple(dict.fromkeys(name.strip() for name in args.policies.split(",")))
    for name in names:
        if name not in POLICIES:
            raise UserError(f"no policy is named {name!r}", "--policies", f"choose from {','.join(POLICIES)}")
    cases = _cases(args)
    picture = _picture(args.out, "bench-reuse.png")
    plan = Plan(names, args.repeat, args.frames or None, tuple(args.set), tuple(args.petsc), args.hindsight_cost)
    found = {}
    for case in cases:
        found[case.name] = compare(case, plan, announce)
        print_reuse(case.name, found[case.name])
    _draw(picture, lambda: draw_policies(found, picture))
    write_json(args, found)
    return 0


def _predict(args: argparse.Namespace) -> int:
    """Time predicted frames and find their errors."""
    from restshape_studies.pictures.design import draw_prediction

    return _one(args, "bench-predict.png", bench_design.predict, draw_prediction)


def _derivative(args: argparse.Namespace) -> int:
    """Compare the design derivative with differences."""
    from restshape_studies.pictures.design import draw_derivative

    return _one(args, "sensitivity-epsilon.png", bench_design.derivative, draw_derivative)


def _order(args: argparse.Namespace) -> int:
    """Compare elements of first and second order."""
    args.scenes = [args.scene]
    (case,) = _cases(args)
    write_json(args, bench_order.order(args, case, announce))
    return 0


def _eigen(args: argparse.Namespace) -> int:
    """Compare eigensolvers."""
    args.scenes = [args.scene]
    (case,) = _cases(args)
    write_json(args, bench_eigen.eigen(args, case, announce))
    return 0


def _drape(args: argparse.Namespace) -> int:
    """Compare Solution strategies of cloth."""
    from restshape.scene.load import load_scene
    from restshape.scene.script import load_script

    scene = load_scene(args.scene, args.set)
    require_mesh(scene, "ways of cloth to rest are about one")
    edits = args.edits or script_of(args.scene)
    if edits and args.policies:
        load_script(edits, scene)
    write_json(args, bench_drape.drape(args, scene, edits, announce))
    return 0


def _one(args: argparse.Namespace, name: str, measure: Any, draw: Any) -> int:
    """Measure one scene, draw, and write what was found."""
    args.scenes = [args.scene]
    (case,) = _cases(args)
    picture = _picture(args.out, name)
    found = measure(args, case, announce)
    _draw(picture, lambda: draw(case.name, found, picture))
    write_json(args, found)
    return 0


def _cases(args: argparse.Namespace) -> list[Any]:
    """The scenes to replay, each with its script, all checked before the first run.

    Raises:
        UserError: a bad scene or script, or a scene without a script.
    """
    from restshape_studies.bench.reuse import Case

    from restshape.scene.load import load_scene
    from restshape.scene.script import load_script

    if args.edits and len(args.scenes) != 1:
        raise UserError("a script belongs to one scene", "--edits", "name one scene")
    meshed = [app for app in applications().values() if app.editing.meshed]
    installed = [path for app in meshed for path in app.scenes() if script_of(path)]
    paths = args.scenes or installed
    stems = [path.stem for path in paths]
    cases = []
    for path in paths:
        scene = load_scene(path, args.set)
        require_mesh(scene, "policies of reuse are about one")
        edits = args.edits or script_of(path)
        if edits is None:
            raise UserError("no script beside the scene names it", str(path), "name one: --edits FILE.jsonl")
        load_script(edits, scene)
        name = path.stem if stems.count(path.stem) == 1 else f"{scene.app}/{path.stem}"
        if not args.edits:
            announce(f"{name}: script {edits}")
        cases.append(Case(name, path, edits))
    return cases


def print_reuse(name: str, found: dict[str, dict[str, Any]]) -> None:
    """Print the tables of one scene."""
    one = next(iter(found.values()))
    loads = [run["load"] for entry in found.values() for run in entry["runs"]]
    title = (
        f"{name}: {one['frames']} frames, about {one['unknowns']} unknowns, {one['elements']} elements, one core; "
        f"median of {len(one['runs'])} runs; load of the machine {min(loads):.1f} to {max(loads):.1f}"
    )
    heads = ("policy", "frames/s", "p50, ms", "p95, ms", "p99, ms", "x rebuild", "x refactor", "Python, ms")
    heads += ("iterations", "refreshes", "refused", "preconditioners")
    print_table(title, heads, [_policy_row(key, entry) for key, entry in found.items()], heads[1:-1])
    heads = ("frames: p50, ms", "1 relocation", "2 reconnection", "3 reconstruction", "idle")
    print_table("", heads, [_levels_row(key, entry) for key, entry in found.items()], heads[1:])
    stages = [stage for stage in one["stages"] if any(entry["stages"][stage] >= 0.05 for entry in found.values())]
    rows = [[key, *(f"{entry['stages'][stage]:.1f}" for stage in stages)] for key, entry in found.items()]
    print_table("", ("stages in all, ms", *stages), rows, stages)
    events = [event for event in one["events"] if event in EVENTS or any(e["events"][event] for e in found.values())]
    rows = [[event, *(str(entry["events"][event]) for entry in found.values())] for event in events]
    print_table("", ("PETSc events", *found), rows, list(found))
    hindsight_cost = found.get("auto", {}).get("regret")
    if hindsight_cost:
        print(hindsight_line(hindsight_cost))
    print()


def hindsight_line(hindsight_cost: dict[str, Any]) -> str:
    """The cost over the best schedule in hindsight, as a line."""
    if "problem" in hindsight_cost:
        return f"regret of auto's refreshes: not measured, {hindsight_cost['problem']}"
    refreshes, iterations = hindsight_cost["refreshes"], hindsight_cost["iterations"]
    spent = {
        which: f"{1e3 * hindsight_cost[which]:.4g} ms ({refreshes[which]} refreshes, {iterations[which]} iterations)"
        for which in ("run", "best")
    }
    ratio = f"{hindsight_cost['ratio']:.3f} times the best schedule in hindsight"
    return f"regret of auto's refreshes: {ratio}; by the calibration {spent['run']} against {spent['best']}"


def _policy_row(name: str, entry: dict[str, Any]) -> list[str]:
    ms, ratios = entry["ms"], entry["ratios"]
    times = [_ratio(ratios[base]["fps"]) if base in ratios else "" for base in ("rebuild", "refactor")]
    counts = [str(entry[key]) for key in ("iterations", "refreshes", "refused")]
    python = f"{entry['python_ms']['p50']:.3f}"
    used = ", ".join(f"{kind} {frames}" for kind, frames in entry["preconditioners"].items() if kind)
    middle = [f"{ms[key]:.3f}" for key in ("p50", "p95", "p99")]
    return [name, f"{entry['fps']:.4g}", *middle, *times, python, *counts, used]


def _ratio(value: float | None) -> str:
    return "" if value is None else f"{value:.2f}"


def _levels_row(name: str, entry: dict[str, Any]) -> list[str]:
    levels = [
        f"{entry['levels'][k]}: {entry['ms_by_level'][k]['p50']:.3f}" if entry["levels"][k] else "0"
        for k in ("1", "2", "3")
    ]
    return [name, *levels, str(entry["idle"])]


def _size(args: argparse.Namespace) -> int:
    """Measure growing sizes, and show what was not reached."""
    from restshape_studies.bench.size import exponents, measure, sizes
    from restshape_studies.pictures.scaling import draw_scaling

    if not 100 <= args.least <= args.most:
        raise UserError(
            f"{args.least:g} to {args.most:g} is no range of unknowns", "--from, --to", "--from 1e3 --to 1e6"
        )
    if args.points < 1 or args.seconds <= 0:
        raise UserError("there must be a size and time for it", "--points, --seconds", "leave them out")
    scene = installed_scene(SIZE_SCENE)
    picture = _picture(args.out, "bench-size.png")
    start = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="restshape-bench-") as folder:
        wanted = sizes(args.least, args.most, args.points if args.most > args.least else 1)
        given = (args.seconds, args.policy, tuple(args.set), tuple(args.petsc), announce)
        records = measure(scene, wanted, Path(folder), *given)
    fits = exponents(records)
    print_size(records, fits, args.policy)
    print(f"took {time.monotonic() - start:.0f} s")
    _draw(picture, lambda: draw_scaling(records, fits, args.policy, picture))
    write_json(args, {"policy": args.policy, "sizes": records, "exponents": fits})
    return 0


def installed_scene(stem: str) -> Path:
    """The installed scene of that name.

    Raises:
        UserError: there is none.
    """
    paths = [path for app in applications().values() for path in app.scenes() if path.stem == stem]
    if not paths:
        raise UserError(f"no installed application has a scene {stem!r}", "bench size", "restshape list shows all")
    return paths[0]


def print_size(records: Iterable[dict[str, Any]], fits: dict[str, Any], name: str) -> None:
    """Print the tables of all sizes."""
    heads = (
        "unknowns",
        "triangles",
        "level 1",
        "iterations",
        "level 1, old factor",
        "iterations",
        "level 2",
        "iterations",
    )
    heads += ("2 / 1", "level 3", "memory, MB", "what is missing, and why")
    rows = [_size_row(record) for record in records]
    powers = ["fitted power", "", *("" for _ in heads[2:])]
    for level, place in (("1", 2), ("2", 6), ("3", 9)):
        powers[place] = f"n^{fits[level]['exponent']:.2f}" if fits[level] else ""
    print_table(f"time a frame, p50 in ms, one core, policy {name}", heads, [*rows, powers], heads[:-1])
    if any(record["first_frame_serves_as_level_3"] for record in records):
        print("* the first frame of the replay: a new mesh, pattern and factor, without the way from an old mesh")
    stages = ("edit", "relocate", "flip", "pattern", "values", "factor", "krylov", "observe", "python")
    shown = [(record, level) for level in ("1", "2") for record in records if record["levels"][level]]
    rows = [
        [level, f"{record['unknowns']}", *(f"{record['levels'][level]['stages'][stage]:.3f}" for stage in stages)]
        for record, level in shown
    ]
    print_table("stages of a frame, p50 in ms", ("level", "unknowns", *stages), rows, ("unknowns", *stages))


def _size_row(record: dict[str, Any]) -> list[str]:
    levels = record["levels"]
    cells = [str(record["unknowns"] or f"about {record['wanted']:.0f}"), str(record["elements"] or "")]
    for level in ("1", "1_old", "2"):
        found = levels[level]
        cells += [f"{found['ms']['p50']:.3f}", f"{found['iterations']:.1f}"] if found else ["", ""]
    # Of frames with the same old factor: a fresh one takes fewer iterations.
    both = levels["2"] and levels["1_old"]
    cells.append(f"{levels['2']['ms']['p50'] / levels['1_old']['ms']['p50']:.2f}" if both else "")
    star = " *" if record["first_frame_serves_as_level_3"] else ""
    cells.append(f"{levels['3']['ms']['p50']:.1f}{star}" if levels["3"] else "")
    cells.append(f"{record['memory_mb']:.0f}" if record["memory_mb"] else "")
    return [*cells, record["problem"]]


def _picture(folder: Path, name: str) -> Path:
    """The path of a picture in a folder, which is made, before any work.

    Raises:
        UserError: it cannot be written there.
    """
    path = folder / name
    try:
        folder.mkdir(parents=True, exist_ok=True)
        existed = path.exists()
        path.open("ab").close()
        if not existed:
            path.unlink()
    except OSError as error:
        raise UserError(f"{path} cannot be written: {error.strerror}", "--out", "choose another folder") from error
    return path


def announce(words: str) -> None:
    """Reports what comes next, where it does not mix with tables."""
    print(words, file=sys.stderr, flush=True)


def _draw(path: Path, draw: Any) -> None:
    """Draw, and show where."""
    try:
        draw()
    except OSError as error:
        raise UserError(f"{path} cannot be written: {error.strerror}", "--out", "choose another folder") from error
    print(f"wrote {path}")
