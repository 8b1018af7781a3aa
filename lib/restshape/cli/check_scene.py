"""What a scene and an edit script hold, for people and for programs."""

import argparse
import math
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from restshape.application import application
from restshape.cli.options import print_table, read_scene, write_json
from restshape.cli.quantity_words import quantity_rows
from restshape.errors import ReplayProblem, UserError
from restshape.mesh.regions import contains, loop_polygon
from restshape.mesh.sizing import refuse_endless
from restshape.mesh.thickness import Thickness
from restshape.physics.elasticity.rigid_body_modes import check_rigid_body_modes
from restshape.scene.bodies import Body, Start
from restshape.scene.expressions import Expression, Value
from restshape.scene.model import Load, Material, Scene, Support
from restshape.scene.plan import Plan, plan
from restshape.scene.script import Script, load_script
from restshape.shape.build import outline_from_spec
from restshape.shape.outline import Outline

LOAD_UNITS = {"force": "N", "traction": "Pa", "pressure": "Pa", "body": "N/m^3"}

GRID = 60
"""Places in each direction at which a thickness is looked at."""


def check(args: argparse.Namespace) -> int:
    """Prints what the scene holds and which edits would be refused; 1 if any would be."""
    scene = read_scene(args)
    app = application(scene.app)
    effects = plan(scene, app)
    title = f"{scene.path}: {scene.title}".rstrip(": ")
    if app.session:
        data, rows = app.checked(scene, effects)
        print_table(title, ("what", "held"), rows)
        return finish(args, scene, data)
    outline = starting_outline(scene)
    check_supports(scene, outline)
    check_thickness(scene, outline)
    if scene.mesh.size and not scene.mesh.file:
        try:
            refuse_endless(outline, scene.mesh.size, scene.mesh.near)
        except UserError as error:
            raise scene.located(error) from error
    data = held(scene, effects, outline)
    print_table(title, ("what", "held"), described(scene, effects, outline))
    return finish(args, scene, data, outline)


def finish(args: argparse.Namespace, scene: Scene, data: dict[str, Any], outline: Outline | None = None) -> int:
    """Replays the script, if there is one, on paper, writes what programs want, and gives the exit code."""
    refused: list[dict[str, Any]] = []
    if args.edits is not None:
        script = load_script(args.edits, scene)
        if script.error:
            raise script.error
        data["edits"] = edits = replayed(scene, script, outline)
        refused = edits["refused"]
        print_edits(args.edits, edits, script)
    write_json(args, data)
    return 1 if refused else 0


def starting_outline(scene: Scene) -> Outline:
    """The shape before any edit, with every name that the scene uses found in it.

    Raises:
        UserError: the outline is open, crosses itself, has an edge without length, or lacks a name.
    """
    if scene.mesh.file:
        from restshape.mesh.importer import read_mesh

        outline = read_mesh(scene.folder / scene.mesh.file, scene.mesh.unit)[1]
    else:
        try:
            outline = outline_from_spec(scene.shape, scene.folder)
        except UserError as error:
            raise scene.located(error) from error
    for key, name in used_names(scene):
        try:
            outline.entity(name)
        except UserError as error:
            raise scene.located(UserError(error.what, key, error.do)) from error
    return outline


def check_supports(scene: Scene, outline: Outline) -> None:
    """Makes sure that the supports hold the body, as far as the outline shows.

    Raises:
        UserError: they leave it free to move, and its application is not one for free bodies, or for cloth that falls.
    """
    app = application(scene.app)
    if app.layered or app.cloth:
        return
    points, masks = [np.zeros((0, 2))], [np.zeros((0, 2))]
    for support in scene.supports.values():
        for entity in map(outline.entity, support.on):
            edges = {*entity.edges, *(edge for loop in entity.loops for edge, _ in outline.loops[loop].edges)}
            found = np.concatenate([outline.points[list(entity.vertices)], *map(outline.polyline, edges)])
            points.append(found)
            masks.append(np.tile([axis in support.fix for axis in "xy"], (len(found), 1)))
    body = np.concatenate([outline.points, *points])
    check_rigid_body_modes(body, np.concatenate([np.zeros_like(outline.points), *masks]), scene)


def check_thickness(scene: Scene, outline: Outline) -> None:
    """Makes sure that thicknesses given by formulas are positive all over the outline.

    Raises:
        UserError: one is not, or is not a number, somewhere.
    """
    formulas = {name: m.thickness for name, m in scene.material.items() if isinstance(m.thickness, Expression)}
    if not formulas:
        return
    low, high = outline.bounds()
    axes = (np.linspace(a, b, GRID) for a, b in zip(low, high))
    places = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
    border = loop_polygon(outline, outline.loops[0])
    places = np.concatenate([border, places[contains(border, places)]])
    for name, formula in formulas.items():
        try:
            Thickness(formula, scene.parameters).at(places)
        except ReplayProblem as problem:
            do = "change the formula, so that the body has a thickness everywhere"
            raise scene.located(UserError(str(problem), f"material.{name}.thickness", do)) from problem


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


def held(scene: Scene, effects: Plan, outline: Outline) -> dict[str, Any]:
    """What the scene holds, for programs."""
    return {
        "scene": str(scene.path),
        "app": scene.app,
        "title": scene.title,
        "entities": names_of(outline),
        "area": float(outline.area()),
        "materials": list(scene.material),
        **heft(scene, effects, outline),
        "effects": [{"effect": e.name, "on": e.on, "why": e.why} for e in effects.effects],
        "supports": {name: support.on for name, support in scene.supports.items()},
        "loads": {name: {"kind": load.kind, "on": load.on} for name, load in scene.loads.items()},
        "bodies": {name: body.model_dump(exclude_none=True) for name, body in scene.bodies.items()},
        "start": scene.start.model_dump() if scene.start else None,
        "warnings": list(effects.warnings),
        "goals": list(scene.goal),
        "quantities": list(scene.quantities),
        "mesh": scene.mesh.model_dump(),
        "solve": scene.solve.model_dump(),
    }


def made_of(material: Material) -> str:
    """Stiffness, density and thickness of a material, for people."""
    grain = material.orthotropic
    if grain is None:
        stiff = f"E {material.E:.6g} Pa, nu {material.nu:g}"
    else:
        moduli = ", ".join(f"{E:.4g}" for E in grain.E)
        stiff = f"E {moduli} Pa along and across a grain at {math.degrees(material.grain):g} deg"
    thickness = material.thickness
    thick = f"thickness {thickness.text}" if isinstance(thickness, Expression) else f"{thickness:g} m thick"
    known = f"{material.name}: " if material.name else ""
    bends = "" if material.bending is None else f", bending {listing(material.bending)} N m"
    return f"{known}{stiff}, rho {material.rho:g} kg/m^3, {thick}{bends}"


def heft(scene: Scene, effects: Plan, outline: Outline) -> dict[str, float]:
    """Mass by area [kg/m^2] of cloth of one material, its ``mass`` [kg] and ``weight`` [N]; nothing of what is none."""
    if not application(scene.app).cloth or len(scene.material) != 1:
        return {}
    (material,) = scene.material.values()
    if isinstance(material.thickness, Expression) or material.region:
        return {}
    by_area = material.rho * material.thickness
    mass = by_area * float(outline.area())
    gravity = effects.settings("gravity")
    return {"mass_by_area": by_area, "mass": mass, "weight": mass * (gravity.size if gravity else 0.0)}


def weighed(scene: Scene, effects: Plan, outline: Outline) -> str:
    """Mass and weight of cloth, for people; empty where they are not known."""
    found = heft(scene, effects, outline)
    if not found:
        return ""
    by_area = f"{1e3 * found['mass_by_area']:.4g} g/m^2, which is rho times thickness"
    return f"mass {found['mass']:.4g} kg, weight {found['weight']:.4g} N; {by_area}"


def described(scene: Scene, effects: Plan, outline: Outline) -> list[tuple[str, str]]:
    """What the scene holds, for people."""
    names = names_of(outline)
    plurals = {"vertex": "vertices", "edge": "edges", "hole": "holes", "region": "regions", "group": "groups"}
    rows = [(plurals[kind], listed(found)) for kind, found in names.items() if found or kind in ("vertex", "edge")]
    rows.append(("area", f"{outline.area():.6g} m^2"))
    rows += [(f"material {name}", made_of(m)) for name, m in scene.material.items()]
    rows += [("cloth", words)] if (words := weighed(scene, effects, outline)) else []
    rows += [(f"effect {e.name}", f"{'on' if e.on else 'off'}: {e.why}") for e in effects.effects]
    rows += [(f"support {name}", f"{fixed(s)} on {', '.join(s.on)}") for name, s in scene.supports.items()]
    rows += [(f"load {name}", f"{loaded(load)} on {', '.join(load.on)}") for name, load in scene.loads.items()]
    rows += [(f"body {name}", touched(body)) for name, body in scene.bodies.items()]
    rows += [("start", laid(scene.start))] if scene.start else []
    rows += [
        (f"goal {name}", f"a curve through {len(g.spline or g.polyline)} points") for name, g in scene.goal.items()
    ]
    rows += quantity_rows(scene)
    mesh, solve = scene.mesh, scene.solve
    rows.append(("mesh", mesh.file or f"size {mesh.size:g} m, order {mesh.order}, {mesh.relocation} relocation"))
    rows.append(("solve", f"tolerance {solve.tolerance:g}, policy {solve.policy}"))
    return rows + [("warning", warning) for warning in effects.warnings]


def fixed(support: Support) -> str:
    """What a support prescribes."""
    if support.symmetry:
        return f"plane of symmetry with the normal {support.symmetry}"
    parts = [f"{axis} = {said(value)}{'' if value == 0 else ' m'}" for axis, value in support.fix.items()]
    return " and ".join(parts)


def touched(body: Body) -> str:
    """Kind, keys and friction of a body."""
    form = body.form
    keys = [f"{key} {listing(getattr(form, key))}" for key in type(form).model_fields]
    return f"{body.kind}, {', '.join(keys)}, friction {said(body.friction)}"


def laid(start: Start) -> str:
    """Where cloth starts."""
    moved = f"turned by {listing(start.turn)} rad about {listing(start.about)} m, moved by {listing(start.move)} m"
    return moved + (f", scattered by {start.scatter:g} m with the seed {start.seed}" if start.scatter else "")


def listing(value: Any) -> str:
    """A number, a formula, or several of them in parentheses."""
    return f"({', '.join(map(said, value))})" if isinstance(value, tuple) else said(value)


def loaded(load: Load) -> str:
    """Kind and value of a load with its unit."""
    value = getattr(load, load.kind)
    return f"{load.kind} {listing(value)} {LOAD_UNITS[load.kind]}"


def said(value: Value) -> str:
    """A number, or the text of a formula."""
    return value.text if isinstance(value, Expression) else f"{value:.6g}"


def listed(names: list[str], most: int = 12) -> str:
    """How many there are, and the first of them."""
    more = f", ... {len(names) - most} more" if len(names) > most else ""
    return f"{len(names)}: {', '.join(names[:most])}{more}" if names else "0"


def replayed(scene: Scene, script: Script, outline: Outline | None = None) -> dict[str, Any]:
    """What the script does to the shape: frames, what changes in them, and the edits that are refused."""
    from restshape.replay.sessions import session_of

    frames, seconds = 0, 0.0
    changes: Counter[str] = Counter()
    refused = []
    for frame in session_of(scene, script, outline).frames():
        frames += 1
        seconds = frame.t
        changes[frame.change] += 1
        if frame.refused:
            refused.append({"line": frame.line, "frame": frame.index, "do": frame.do, "why": frame.refused})
    return {"frames": frames, "seconds": seconds, "changes": dict(changes), "refused": refused}


def print_edits(path: Path, edits: dict[str, Any], script: Script) -> None:
    """Prints the tables of the script."""
    rows = [("events", len(script.events)), ("frames", edits["frames"]), ("edit time", f"{edits['seconds']:g} s")]
    rows += [(f"frames with change {change!r}", count) for change, count in edits["changes"].items()]
    rows.append(("refused frames", len(edits["refused"])))
    print()
    print_table(str(path), ("what", "held"), rows)
    for warning in script.warnings:
        print(f"warning: {warning}", file=sys.stderr)
    if edits["refused"]:
        print()
        heads = ("line", "frame", "frames", "event", "why")
        print_table("refused edits", heads, told_once(edits["refused"]), right=heads[:3])


def told_once(refused: list[dict[str, Any]]) -> list[tuple[int, int, int, str, str]]:
    """Line, first frame, number of frames, event and why of refused frames, a row for those of one event and reason."""
    alike: dict[tuple[int, str, str], list[int]] = {}
    for frame in refused:
        alike.setdefault((frame["line"], frame["do"], frame["why"]), []).append(frame["frame"])
    return [(line, frames[0], len(frames), do, why) for (line, do, why), frames in alike.items()]
