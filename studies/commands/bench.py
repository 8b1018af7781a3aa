"""`restshape bench`: what reuse gains, and how time grows with size; one runner of all kinds."""

# More than 15 modules: the command joins all studies, their scenes, pictures and files.

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from restshape_studies.bench.job import note_words
from restshape_studies.bench.turns import Case, OutOfTime
from restshape_studies.commands import (
    bench_body,
    bench_design,
    bench_drags,
    bench_drape,
    bench_effectivity,
    bench_eigen,
    bench_jumps,
    bench_large,
    bench_limit,
    bench_live,
    bench_maps,
    bench_nested,
    bench_order,
    bench_peers,
    bench_reach,
    bench_regret,
    bench_reuse,
    bench_scaling,
    bench_size,
)
from restshape_studies.commands.bench_kind import Kind, read_results, unscripted

from restshape.application import applications
from restshape.cli.options import add_json, add_set, require_mesh, write_json
from restshape.cli.ranks import launched
from restshape.cli.shipped import named_scenes, refuse_shared_script, script_of, scripts_of
from restshape.cli.verbosity import add_verbose
from restshape.errors import UserError, one_line
from restshape.outputs.atomic_files import writable
from restshape.outputs.claims import refuse_foreign
from restshape.outputs.kinds import PictureFile
from restshape.outputs.picture_files import drawn_from, fingerprint

if TYPE_CHECKING:
    from restshape.scene.model import Scene

PLACE = 5
OWN = "those of the study"
MANY = ("several", "unscripted")
"""Kinds of studies whose JSON holds a value for each scene."""
SINGLE = ("one", "still", "either")
"""Those of one scene."""
SUMMARY = "measure what reuse and prediction gain, and how the time of a frame grows with size"
PICTURES = Path("results")
"""Where pictures go if neither the command line nor a study says."""
MODULES = (
    bench_reuse,
    bench_limit,
    bench_regret,
    bench_size,
    bench_scaling,
    bench_large,
    bench_order,
    bench_reach,
    bench_eigen,
    bench_drape,
    bench_drags,
    bench_design,
    bench_effectivity,
    bench_jumps,
    bench_maps,
    bench_nested,
    bench_body,
    bench_peers,
    bench_live,
)
KINDS: dict[str, Kind] = {kind.name: kind for module in MODULES for kind in module.KINDS}


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    studies = parser.add_subparsers(dest="study", metavar="STUDY", required=True)
    for kind in KINDS.values():
        study = studies.add_parser(kind.name, help=kind.summary)
        if kind.scenes in ("several", "unscripted"):
            what = f"scene files, or names of installed ones (default: {' '.join(kind.default) or 'all installed'})"
            study.add_argument("scenes", metavar="SCENE", nargs="*", type=Path, help=what)
        elif kind.scenes in SINGLE:
            number, what = ("?", f" (default: {OWN})") if kind.own else (None, "")
            what = f"scene file, or name of an installed one{what}"
            study.add_argument("scenes", metavar="SCENE", nargs=number, action=Only, type=Path, help=what, default=[])
        if kind.scenes in ("several", *SINGLE):
            what = "edit script (default: the one that names the scene)"
            study.add_argument("--edits", type=Path, metavar="FILE", help=what)
        kind.declare(study)
        add_set(study)
        add_json(study)
        add_verbose(study)
        if kind.picture:
            what = "of the picture (default: %(default)s)"
            study.add_argument(
                "--out", type=Path, default=study.get_default("out") or PICTURES, metavar="DIR", help=what
            )
        if kind.draw:
            what = "measure nothing, and draw the picture of an earlier run from what its --json wrote"
            study.add_argument("--redraw", type=Path, metavar="FILE", action="append", help=what)


class Only(argparse.Action):
    """Makes a list of the only scene that is named."""

    def __call__(self, parser: object, namespace: argparse.Namespace, value: Path | None, *_: object) -> None:
        """Takes it; none where it may be left out."""
        namespace.scenes = [value] if isinstance(value, Path) else []


def run(args: argparse.Namespace) -> int:
    """Measure; 0 when it is done, 2 on bad input, or on ranks of MPI, 3 where a scene of several is left out."""
    kind = KINDS[args.study]
    if getattr(args, "redraw", None):
        return redraw(kind, args)
    if launched():
        own = ": it starts the ranks itself, as many as --ranks names" if "ranks" in args else ""
        do = f"start it without mpiexec{own}"
        raise UserError("a study starts the processes that it measures itself", "mpiexec", do)
    kind.check(args)
    own = kind.own is not None and not args.scenes
    several = own or kind.scenes in MANY
    cases = kind.own(args) if own else cases_of(kind, args)
    draws = kind.picture and not getattr(args, "only_times", False)
    picture = _picture(args.out, kind.picture) if draws else getattr(args, "picture", None)
    found: dict[str, Any] = {}
    start, late = time.monotonic(), OutOfTime("")
    for case in cases:
        try:
            found[case.name] = kind.measure(args, case, announce)
        except OutOfTime as problem:
            late = problem
            announce(f"{case.name} is left out: {problem.one_line}")
            continue
        kind.show(args, case.name, found[case.name])
        if kind.times and not own:
            tolerance = tolerance_of(case, args)
            print(f"times are of {kind.times}; systems are solved to {tolerance:g}")
            if not several:
                found[case.name] |= {"times": kind.times, "tolerance": tolerance}
    if not found:
        raise late
    if kind.sum_up and several:
        kind.sum_up(found)
    print(f"took {time.monotonic() - start:.0f} s")
    note_words(args.petsc)
    data = found if several else next(iter(found.values()))
    if picture and kind.draw:
        _draw(picture, lambda: kind.draw(found, args, picture), data)
    write_json(args, data)
    return 3 if len(found) < len(cases) else 0


def tolerance_of(case: Case, args: argparse.Namespace) -> float:
    """The relative residual to which the linear systems of a scene are solved."""
    from restshape.scene.load import load_scene

    return load_scene(case.scene, args.set).solve.tolerance


def redraw(kind: Kind, args: argparse.Namespace) -> int:
    """Draws the picture of an earlier run from its JSON.

    Raises:
        UserError: the file cannot be read, or is of another kind.
    """
    several = [read_results(path, "--redraw")[0] for path in args.redraw]
    if len(several) > 1 and (kind.scenes not in MANY or not all(isinstance(one, dict) for one in several)):
        raise UserError("this study has one file", f"--redraw {args.redraw[1]}", "name one file")
    data = several[0] if len(several) == 1 else {name: found for one in several for name, found in one.items()}
    named = [path.stem for path in getattr(args, "scenes", ())]
    found = data if kind.scenes in MANY else {named[0] if named else kind.scenes: data}
    picture = _picture(args.out, kind.picture) if kind.picture else args.picture
    if picture is None:
        raise UserError("there is nothing to draw into", "--redraw", "name a picture: --picture FILE.png")
    try:
        _draw(picture, lambda: kind.draw and kind.draw(found, args, picture), data)
    except (KeyError, TypeError, AttributeError, IndexError) as error:
        what = f"this holds no results of restshape bench {kind.name}"
        raise UserError(what, f"--redraw {args.redraw[0]}", f"name what bench {kind.name} --json wrote") from error
    return 0


def cases_of(kind: Kind, args: argparse.Namespace) -> list[Case]:
    """The scenes to replay, each with its script, all checked before the first run.

    Raises:
        UserError: a bad scene or script, or a scene without a script.
    """
    from restshape.scene.edit_script import load_script
    from restshape.scene.load import load_scene

    if kind.scenes not in (*MANY, *SINGLE):
        return [Case(kind.scenes, installed_scene(kind.scenes), None)]
    scripted = kind.scenes != "unscripted"
    meshed = [path for app in applications().values() if app.editing.has_mesh for path in app.scenes()]
    args.scenes = named_scenes(args.scenes, meshed) or [installed_scene(name) for name in kind.default]
    refuse_shared_script(args.scenes, args.edits if scripted else None)
    if scripted and args.edits and not args.scenes:
        raise UserError("a script belongs to one scene", "--edits", "name its scene")
    paths = args.scenes or [path for path in meshed if script_of(path) or not scripted]
    stems = [path.stem for path in paths]
    cases = []
    for path in paths:
        scene = load_scene(path, args.set)
        require_mesh(scene, kind.about)
        edits = (args.edits or _script(kind, path, scene)) if scripted else None
        if edits is not None:
            load_script(edits, scene)
        elif scripted and kind.scenes not in ("still", "either"):
            raise unscripted(path)
        name = path.stem if stems.count(path.stem) == 1 else f"{scene.app}/{path.stem}"
        name = str(path) if name in {case.name for case in cases} else name
        if kind.scenes == "still":
            name = scene.title or name
        if edits and not args.edits:
            announce(f"{name}: script {edits}")
        cases.append(Case(name, path, edits))
    return cases


def _script(kind: Kind, path: Path, scene: Scene) -> Path | None:
    """The script of a scene that is taken where none is named; none where there is none."""
    from restshape.scene.edit_script import load_script

    known = scripts_of(path)
    fits = kind.fits
    fitting = known if fits is None else [one for one in known if fits(load_script(one, scene), scene)]
    return next(iter(fitting or known), None)


def installed_scene(stem: str) -> Path:
    """The installed scene of that name.

    Raises:
        UserError: there is none.
    """
    paths = [path for app in applications().values() for path in app.scenes() if path.stem == stem]
    if not paths:
        raise UserError(f"no installed application has a scene {stem!r}", "bench", "restshape list shows all")
    return paths[0]


def _picture(folder: Path, name: str) -> Path:
    """The path of a picture in a folder, which is made, before any work.

    Raises:
        UserError: it cannot be written there.
    """
    path = PictureFile(folder / name)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        refuse_foreign(path, f"--out {folder}")
        writable(path)
    except OSError as error:
        raise UserError(f"{path} cannot be written: {error.strerror}", "--out", "choose another folder") from error
    return path


def announce(words: str) -> None:
    """Reports what comes next, where it does not mix with tables."""
    print(words, file=sys.stderr, flush=True)


def _draw(path: Path, draw: Any, data: Any) -> None:
    """Draw, with the hash of the data in the picture, and show where."""
    try:
        with drawn_from(fingerprint(data)):
            draw()
    except OSError as error:
        raise UserError(f"{path} cannot be written: {error.strerror}", "--out", "choose another folder") from error
    print(f"wrote {one_line(path)}")
