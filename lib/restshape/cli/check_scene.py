"""What a scene and an edit script hold, for people and for programs."""

# More than 15 modules: whatever a scene may hold is checked and printed here.

import argparse
import sys
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel

from restshape.application import application_of, applications
from restshape.cli.asked_columns import refuse_columns
from restshape.cli.doubts import doubts, script_doubts
from restshape.cli.options import print_table, read_scene, write_json
from restshape.cli.placed_formulas import refuse_without_number
from restshape.cli.quantity_descriptions import quantity_rows
from restshape.errors import UserError, one_line
from restshape.mesh.curve_edges import CurveEdges, curve_edges
from restshape.mesh.entity_area import signed_loops
from restshape.mesh.sizing import refuse_endless
from restshape.outputs.si_numbers import scaled_unit, si, unit_of
from restshape.replay.rounding import cleared
from restshape.scene.application_registry import clashes_with
from restshape.scene.bare_lengths import with_bare_lengths
from restshape.scene.condition_words import load_words, support_words
from restshape.scene.descriptions import but_rounding, keys_in_words, listing
from restshape.scene.edit_script import Script, load_script
from restshape.scene.given_numbers import GivenNumber, Key, given_numbers
from restshape.scene.key_aliases import notes
from restshape.scene.model import Material, Scene
from restshape.scene.physics import Rows
from restshape.scene.plain_values import table_in
from restshape.scene.plan import Plan, as_written, plan
from restshape.scene.scene_type import joined_sections
from restshape.scene.units import SYMBOLS
from restshape.shape.build import outline_of
from restshape.shape.drawings.imported_shape import imported_shape
from restshape.shape.outline import Outline
from restshape.shape.script_frame import ScriptFrame

LISTED = 12
"""Gaps, and curves, that are printed one by one."""
OF_CELLS = ("area", "energy", "drape_coefficient")
"""Kinds of quantities that are of what is inside of their entity."""
VALUES = ("min", "max", "reference")
"""Keys of a quantity that have its unit."""


def check(args: argparse.Namespace, begin_frame: Callable[[], None]) -> int:
    """Prints what the scene holds and which edits would be refused; 1 if any would be.

    Args:
        args: of the command line.
        begin_frame: called after each frame of the script.
    """
    scene = read_scene(args)
    app = application_of(scene)
    effects = plan(scene, app)
    data, rows, outline = app.editing.checked(scene, effects)
    refuse_columns(scene, app)
    warnings = [] if outline is None else start_warnings(scene, effects, outline)
    if warnings:
        data["warnings"] += warnings
        rows += [("warning", warning) for warning in warnings]
    given = given_numbers(scene)
    data["formulas"] = {".".join(one.key): {"formula": one.formula.text, "value": one.value} for one in given}
    print_table(f"{scene.path}: {scene.title}".rstrip(": "), ("what", "content"), rows)
    if given:
        print_table("formulas", ("key", "formula", "value"), formula_rows(scene, given))
    for clash in clashes_with(app, applications().values()):
        print(f"note: {clash}; this scene's application decides")
    if args.picture:
        _draw(args.picture, scene, outline)
    return finish(args, scene, data, begin_frame, outline)


def start_warnings(scene: Scene, effects: Plan, outline: Outline) -> list[str]:
    """What there is to warn of where a scene starts, on the mesh of its first frame.

    Raises:
        UserError: that frame would be refused.
    """
    try:
        physics = application_of(scene).physics
        return [warning for one in physics for warning in one.checked_start(scene, effects, outline)]
    except UserError as error:
        raise with_bare_lengths(scene.located(error), scene) from error


def _draw(path: Path, scene: Scene, outline: Outline | None) -> None:
    """Draws the scene before any solve.

    Raises:
        UserError: nothing draws it, or the picture cannot be written.
    """
    editing = application_of(scene).editing
    if outline is None and not editing.drawn:
        what = f"a scene of {scene.app!r} has no outline to draw"
        raise UserError(what, "--picture", "leave --picture out; restshape report draws its recordings")
    from restshape.report.scene_picture import draw_scene

    try:
        if outline is None:
            editing.draw(scene, path)
        else:
            draw_scene(scene, outline, {name for _, name in used_names(scene)}, path)
    except OSError as error:
        raise UserError(f"the picture cannot be written: {error.strerror}", str(path), "choose another name") from error
    print(f"wrote {one_line(path)}")


def checked_shape(scene: Scene, effects: Plan) -> tuple[dict[str, Any], Rows, Outline]:
    """What a scene with an outline holds: for programs, as rows for people, and the outline.

    Raises:
        UserError: the outline or the mesh makes no sense.
    """
    outline = starting_outline(scene)
    for physics in application_of(scene).physics:
        physics.checked_shape(scene, outline)
    try:
        refuse_without_number(scene, outline)
    except UserError as error:
        raise scene.located(error) from error
    if scene.mesh.size and not scene.mesh.file:
        try:
            refuse_endless(outline, scene.mesh.size, scene.mesh.near)
        except UserError as error:
            raise with_bare_lengths(scene.located(error), scene) from error
    found = [physics.inspected(scene, outline) for physics in application_of(scene).physics]
    seen = [warning for one in found for warning in one.warnings]
    effects = replace(effects, warnings=(*effects.warnings, *doubts(scene, outline), *seen))
    data, rows = scene_contents(scene, effects, outline), described(scene, effects, outline)
    add_drawing(scene, data, rows)
    for one in found:
        data |= one.data
        rows[len(rows) - len(effects.warnings) : len(rows) - len(effects.warnings)] = one.rows
    return data, rows, outline


def add_drawing(scene: Scene, data: dict[str, Any], rows: Rows) -> None:
    """Adds what was chosen of the file that the shape comes from, and the gaps that were closed in it."""
    drawing = None if scene.mesh.file else imported_shape(scene.shape, scene.folder)
    if drawing is None:
        return
    data["gaps"] = [asdict(gap) for gap in drawing.gaps]
    data["drawing"] = list(drawing.notes)
    own = [("drawing", note) for note in drawing.notes]
    if scene.shape.tolerance:
        many = f"{len(drawing.gaps)} of at most {si(scene.shape.tolerance, 'm', 6)}"
        own.append(("gaps closed", many))
        own += [("gap", str(gap)) for gap in drawing.gaps[:LISTED]]
        if len(drawing.gaps) > LISTED:
            own.append(("gap", f"{len(drawing.gaps) - LISTED} smaller ones"))
    rows[:0] = own


def finish(
    args: argparse.Namespace,
    scene: Scene,
    data: dict[str, Any],
    begin_frame: Callable[[], None],
    outline: Outline | None = None,
) -> int:
    """Replays the script, if there is one, on paper, writes what programs want, and gives the exit code."""
    refused: list[dict[str, Any]] = []
    if args.edits is not None:
        script = load_script(args.edits, scene)
        if script.error:
            raise script.error
        data["edits"] = edits = replayed(scene, script, outline, begin_frame)
        if outline is not None:
            script = replace(script, warnings=(*script.warnings, *script_doubts(scene, outline, script)))
        refused = edits["refused"]
        print_edits(args.edits, edits, script)
    write_json(args, data)
    return 1 if refused else 0


def starting_outline(scene: Scene) -> Outline:
    """The shape before any edit, with every name that the scene uses found in it.

    Raises:
        UserError: the outline is open, crosses itself, has an edge without length, lacks a name, or has an
            entity without an inside where a quantity wants one.
    """
    if scene.mesh.file:
        from restshape.mesh.importer import read_mesh

        outline = read_mesh(scene.folder / scene.mesh.file, scene.mesh.unit)[1]
    else:
        outline = outline_of(scene)
    for key, name in used_names(scene):
        try:
            outline.entity(name)
        except UserError as error:
            raise scene.located(UserError(error.what, key, error.do)) from error
    for name, quantity in scene.quantities.items():
        if quantity.kind in OF_CELLS and quantity.at and not signed_loops(outline, quantity.at):
            what = f"{quantity.at!r} holds no cell of the mesh"
            raise scene.located(UserError(what, f"quantities.{name}.at", "name a region"))
    return outline


def used_names(scene: Scene) -> list[tuple[str, str]]:
    """Every entity that the scene names, with the key that names it."""
    used = [(f"supports.{key}.on", name) for key, support in scene.supports.items() for name in support.on]
    used += [(f"loads.{key}.on", name) for key, load in scene.loads.items() for name in load.on]
    used += [(f"quantities.{key}.at", q.at) for key, q in scene.quantities.items() if q.at is not None]
    used += [(f"material.{key}.region", name) for key, m in scene.material.items() for name in m.region or []]
    return used + [(f"mesh.near.{name}", name) for name in scene.mesh.near]


def names_of(outline: Outline) -> dict[str, list[str]]:
    """Names of the outline's entities by kind."""
    return {kind: outline.names(kind) for kind in ("vertex", "edge", "hole", "region", "group")}


def scene_contents(scene: Scene, effects: Plan, outline: Outline) -> dict[str, Any]:
    """What the scene holds, for programs."""
    return {
        "scene": str(scene.path),
        "app": scene.app,
        "title": scene.title,
        "entities": names_of(outline),
        "area": float(outline.area()),
        "bounds": [corner.tolist() for corner in outline.bounds()],
        "materials": list(scene.material),
        **summed(scene, effects, outline)[0],
        "effects": [{"effect": e.name, "on": e.on, "why": e.why} for e in effects.effects],
        "supports": {name: support.on for name, support in scene.supports.items()},
        "loads": {name: {"kind": load.kind, "on": load.on} for name, load in scene.loads.items()},
        **{key: plain(value) for key, value in scene.sections.items()},
        "warnings": list(effects.warnings),
        "quantities": list(scene.quantities),
        "mesh": scene.mesh.model_dump(),
        "order_why": plan(as_written(scene), application_of(scene)).order_why,
        "curves": [asdict(one) for one in scene_curves(scene, outline)],
        "solve": scene.solve.model_dump(),
    }


def plain(value: Any) -> Any:
    """A table as a scene would hold it."""
    if isinstance(value, BaseModel):
        return value.model_dump(exclude_none=True, by_alias=True)
    return {name: plain(one) for name, one in value.items()} if isinstance(value, dict) else value


def summed(scene: Scene, effects: Plan, outline: Outline) -> tuple[dict[str, Any], Rows]:
    """What the physics of a scene say besides: for programs, and as rows for people."""
    data, rows = {}, []
    for physics in application_of(scene).physics:
        if physics.summed:
            more, summed_rows = physics.summed(scene, effects, float(outline.area()))
            data, rows = data | more, rows + summed_rows
    return data, rows


def described(scene: Scene, effects: Plan, outline: Outline) -> list[tuple[str, str]]:
    """What the scene holds, for people."""
    names = names_of(outline)
    plurals = {"vertex": "vertices", "edge": "edges", "hole": "holes", "region": "regions", "group": "groups"}
    rows = [(plurals[kind], listed(found)) for kind, found in names.items() if found or kind in ("vertex", "edge")]
    rows.append(("area", f"{outline.area():.6g} m^2"))
    (x, y), (width, height) = outline.bounds()[0], np.subtract(*outline.bounds()[::-1])
    factor, unit = scaled_unit(max(width, height), "m")
    corner = f"{listing([factor * cleared(float(one), max(width, height)) for one in (x, y)])} {unit}"
    rows.append(("bounding box", f"{si(width, 'm', 6)} x {si(height, 'm', 6)}, lower left corner {corner}"))
    known = scene.parameters
    rows += [(f"parameter {name}", _parameter(scene, name)) for name in known]
    rows += [(f"material {name}", _material(m, effects, known)) for name, m in scene.material.items()]
    rows += summed(scene, effects, outline)[1]
    rows += [(f"effect {e.name}", f"{'on' if e.on else 'off'}: {e.why}") for e in effects.effects]
    rows += [
        (f"support {name}", f"{support_words(s, known)} on {', '.join(s.on)}") for name, s in scene.supports.items()
    ]
    rows += [
        (f"load {name}", f"{load_words(load, known)} on {', '.join(load.on)}") for name, load in scene.loads.items()
    ]
    rows += section_rows(scene)
    rows += quantity_rows(scene)
    mesh, solve = scene.mesh, scene.solve
    rows.append(("mesh", mesh.file or f"size {si(mesh.size, 'm', 6)}, {mesh.relocation} relocation"))
    rows.append(("elements", element_words(scene)))
    for one in scene_curves(scene, outline)[:LISTED]:
        turn = cleared(float(np.degrees(one.turn)), 1.0)
        edges = f"{one.count} mesh edges of at most {si(one.length, 'm')}"
        rows.append((f"curves of {one.name}", f"{edges}, {turn:.3g} degrees each at most"))
    rows.append(("solve", f"tolerance {solve.tolerance:g}, policy {solve.policy}"))
    rows += [("note", note) for note in notes(scene.raw)]
    return rows + [("warning", warning) for warning in effects.warnings]


def formula_rows(scene: Scene, given: Sequence[GivenNumber]) -> list[tuple[str, str, str]]:
    """A row for each number that a formula of the parameters gives: its key, the formula, and the value."""
    rows = []
    for one in given:
        value, symbol = but_rounding(one.formula, one.value, scene.parameters), one.symbol or _symbol(scene, one.key)
        text = f"{value:.6g} {symbol}".rstrip()
        rows.append((".".join(one.key), one.formula.text, si(value, symbol, 6) if "e" in text.split()[0] else text))
    return rows


def _symbol(scene: Scene, key: Key) -> str:
    """The SI unit of a number whose key does not give it: of a limit, a closed form, or a fixed direction."""
    if len(key) == 3 and key[0] == "quantities" and key[2] in VALUES:
        return unit_of(scene.quantities[key[1]].unit)
    if len(key) == 4 and key[0] == "supports" and key[2] == "fix":
        dimensions = (one.boundary.get(key[3]) for one in application_of(scene).physics)
        return next((SYMBOLS[dimension] for dimension in dimensions if dimension), "")
    return ""


def _material(material: Material, effects: Plan, parameters: Mapping[str, float]) -> str:
    """The values of a material; of plane strain without a thickness the depth that forces and energies are of."""
    without = () if getattr(material, "orthotropic", None) else ("grain",)
    models = (getattr(effects.settings(name), "model", "") for name in ("solid", "modal"))
    if "plane_strain" in models and "thickness" not in material.model_fields_set:
        return f"{keys_in_words(material, (*without, 'thickness'), parameters)}, in plane strain: 1 m of depth"
    return keys_in_words(material, without, parameters)


def _parameter(scene: Scene, name: str) -> str:
    """A parameter as it is written, and its value in SI units where that is another one."""
    value = listing(scene.parameters[name])
    written = str(table_in(scene.raw, "parameters").get(name, value))
    return value if written == value else f"{written} = {value} in SI units"


def element_words(scene: Scene) -> str:
    """The order of the elements, the reason, and how to get another."""
    app = application_of(scene)
    planned = plan(as_written(scene), app)
    names = {1: "first", 2: "second"}
    others = app.orders[1:] if planned.order_why == app.order_why else ()
    do = "".join(f"; mesh.order = {order} asks for {names[order]} order" for order in others)
    return f"{names[planned.order]} order, {planned.order_why}{do}"


def scene_curves(scene: Scene, outline: Outline) -> list[CurveEdges]:
    """The mesh edges that holes and other loops with curves get; none where the mesh comes from a file."""
    return [] if scene.mesh.file else curve_edges(outline, scene.mesh)


def section_rows(scene: Scene) -> list[tuple[str, str]]:
    """A row for each table that the physics of a scene add, and that it has."""
    rows = []
    for key, section in joined_sections(application_of(scene).physics).items():
        value, words = getattr(scene, key), section.words or keys_in_words
        if section.named:
            rows += [(f"{key} {name}", words(one)) for name, one in value.items()]
        elif value is not None:
            rows.append((key, words(value)))
    return rows


def listed(names: list[str], most: int = 12) -> str:
    """How many there are, and the first of them."""
    more = f", ... {len(names) - most} more" if len(names) > most else ""
    return f"{len(names)}: {', '.join(names[:most])}{more}" if names else "0"


def replayed(
    scene: Scene, script: Script, outline: Outline | None = None, begin_frame: Callable[[], None] = lambda: None
) -> dict[str, Any]:
    """What the script does to the shape: frames, what changes in them, and the edits that are refused."""
    from restshape.replay.sessions import session_of

    frames, seconds = 0, 0.0
    changes: Counter[str] = Counter()
    refused = []
    session = session_of(scene, script, outline)
    for frame in session.frames():
        frames += 1
        begin_frame()
        seconds = frame.t
        changes[frame.change] += 1
        why = frame.refused
        if not why and frame.change != "none" and (why := _without_answer(frame)):
            session.rollback()
        if why:
            refused.append({"line": frame.line, "frame": frame.index, "do": frame.do, "why": why})
    return {"frames": frames, "seconds": seconds, "changes": dict(changes), "refused": refused}


def _without_answer(frame: ScriptFrame) -> str | None:
    """Why a frame would have no answer, as far as its values and its outline show; None where it may have one."""
    if frame.outline is None:
        return None
    try:
        if frame.change == "values":
            for physics in application_of(frame.scene).physics:
                physics.checked_shape(frame.scene, frame.outline)
        refuse_without_number(frame.scene, frame.outline)
    except UserError as error:
        return error.one_line
    return None


def print_edits(path: Path, edits: dict[str, Any], script: Script) -> None:
    """Prints the tables of the script."""
    rows = [("events", len(script.events)), ("frames", edits["frames"]), ("edit time", f"{edits['seconds']:g} s")]
    rows += [(f"frames with change {change!r}", count) for change, count in edits["changes"].items()]
    rows.append(("refused frames", len(edits["refused"])))
    print()
    print_table(str(path), ("what", "content"), rows)
    for warning in script.warnings:
        print(f"warning: {warning}", file=sys.stderr)
    if edits["refused"]:
        print()
        heads = ("line", "frame", "frames", "event", "why")
        print_table("refused edits", heads, grouped_refusals(edits["refused"]), right=heads[:3])


def grouped_refusals(refused: list[dict[str, Any]]) -> list[tuple[int, int, int, str, str]]:
    """Line, first frame, number of frames, event and why of refused frames, a row for those of one event and reason."""
    alike: dict[tuple[int, str, str], list[int]] = {}
    for frame in refused:
        alike.setdefault((frame["line"], frame["do"], frame["why"]), []).append(frame["frame"])
    return [(line, frames[0], len(frames), do, why) for (line, do, why), frames in alike.items()]
