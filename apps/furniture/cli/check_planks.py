"""What `restshape check` says of a piece of furniture."""

# More than 15 modules: each row is of another part of a piece.

# More than 15 modules: a check looks at a piece in every way that a replay does.

from collections.abc import Iterable
from typing import Any

import numpy as np
from restshape_apps.furniture.cli.plank_doubts import odd_values
from restshape_apps.furniture.guidance.design import Design
from restshape_apps.furniture.guidance.doubts import judged
from restshape_apps.furniture.guidance.lengthening import free_end_warnings
from restshape_apps.furniture.guidance.overlap_advice import overlap_advice
from restshape_apps.furniture.physics.joint_compliance import recorded_utilisations, utilisation_range
from restshape_apps.furniture.physics.joint_label import utilisation_words
from restshape_apps.furniture.physics.plank_phrases import phrases
from restshape_apps.furniture.physics.plank_quantities import require_places
from restshape_apps.furniture.session.plank_session import PlankSession
from restshape_apps.furniture.shape.planks import SIDES, Joint, Load, Piece, Plank

from restshape.cli.quantity_descriptions import quantity_rows
from restshape.errors import UserError
from restshape.outputs.si_numbers import counted
from restshape.scene.edit_script import Script
from restshape.scene.model import Scene
from restshape.scene.plan import Plan

SHOWN = 12
"""Redundant joints that are printed at most, those with the largest utilisation."""


def checked(scene: Scene, effects: Plan) -> tuple[dict[str, Any], list[tuple[str, str]], None]:
    """What the scene holds: for programs, as rows for people, and no outline.

    Raises:
        UserError: planks make no piece, or a quantity is of an end that nothing joins.
    """
    design = PlankSession(scene, Script.empty(scene)).design
    try:
        require_places(scene.quantities, design.piece)
    except UserError as error:
        raise scene.located(error) from error
    return piece_data(scene, effects, design), described_piece(scene, effects, design), None


def piece_data(scene: Scene, effects: Plan, design: Design) -> dict[str, Any]:
    """What the scene holds, for programs."""
    piece, result = design.piece, design.furniture.test()
    names, geometry = [plank.name for plank in piece.planks], design.furniture.geometry()
    known = utilisation_range(piece, design.furniture.compliance)
    return {
        "scene": str(scene.path),
        "app": scene.app,
        "title": scene.title,
        "planks": {
            plank.name: {
                "center": plank.centre.tolist(),
                "size": plank.size.tolist(),
                "axes": plank.axes.T.tolist(),
                "wood": plank.wood,
            }
            for plank in piece.planks
        },
        "joints": [
            {
                "plank": names[joint.i],
                "end": SIDES[joint.side],
                "to": names[joint.j],
                "face": SIDES[joint.face],
                "fastener": joint.fastener,
                "length": float(length),
                "fasteners": int(count),
            }
            for joint, length, count in zip(piece.joints, geometry.length, geometry.nails)
        ],
        "feet": [{"plank": names[foot.plank], "side": SIDES[foot.side]} for foot in piece.feet],
        "mass": float(geometry.mass.sum()),
        "valid": result.valid,
        "flaws": [] if result.valid else list(result.words),
        "doubts": list(phrases(judged(piece, scene.quantities, effects.on("bending")))) if result.valid else [],
        "redundant_joints": recorded_utilisations(piece, known, len(piece.joints)) if known else [],
        "overlaps": list(overlap_advice(piece, geometry.overlaps)),
        "free_ends": list(free_end_warnings(piece, result.valid)),
        "effects": [{"effect": e.name, "on": e.on, "why": e.why} for e in effects.effects],
        "weights": {load.name: {"on": names[load.plank], "force": list(load.force)} for load in piece.weights},
        "pushes": {load.name: {"on": names[load.plank], "force": list(load.force)} for load in piece.pushes},
        "warnings": [*odd_values(scene, piece), *effects.warnings],
        "quantities": list(scene.quantities),
        "solve": scene.solve.model_dump(),
    }


def _by_kind(kinds: Iterable[str], values: Iterable[float]) -> dict[str, float]:
    """The sum of the values of each kind, in the order in which kinds come."""
    found: dict[str, float] = {}
    for kind, value in zip(kinds, values):
        found[kind] = found.get(kind, 0.0) + float(value)
    return found


def described_piece(scene: Scene, effects: Plan, design: Design) -> list[tuple[str, str]]:
    """What the scene holds, for people."""
    piece, result = design.piece, design.furniture.test()
    names, geometry = [plank.name for plank in piece.planks], design.furniture.geometry()
    rows = [("planks", f"{len(piece.planks)}: {', '.join(names)}")]
    rows += [(f"plank {plank.name}", _board(plank)) for plank in piece.planks]
    nails = _by_kind([joint.fastener for joint in piece.joints], geometry.nails) or {scene.fastener.name: 0.0}
    each = [f"{counted(int(number), 'fastener')} {kind!r}" for kind, number in nails.items()]
    rows.append(("joints", f"{len(piece.joints)}, with {' and '.join(each)}"))
    rows += [
        (f"joint {names[joint.i]} {SIDES[joint.side]}", _joint(joint, names, length, int(count)))
        for joint, length, count in zip(piece.joints, geometry.length, geometry.nails)
    ]
    rows.append(("feet", ", ".join(f"{names[foot.plank]} {SIDES[foot.side]}" for foot in piece.feet) or "none"))
    masses = _by_kind([plank.wood for plank in piece.planks], geometry.mass)
    woods = [f"{mass:.6g} kg of {wood}" for wood, mass in masses.items()]
    rows.append(("mass", woods[0] if len(woods) == 1 else f"{geometry.mass.sum():.6g} kg, {' and '.join(woods)}"))
    rows += [(f"effect {e.name}", f"{'on' if e.on else 'off'}: {e.why}") for e in effects.effects]
    rows += [(f"weight {load.name}", _reported(load, piece)) for load in piece.weights]
    rows += [(f"push {load.name}", _reported(load, piece)) for load in piece.pushes]
    rows.append(("floor", f"height {scene.floor.height:g} m, friction {scene.floor.friction:g}"))
    rows += quantity_rows(scene)
    free = len(design.freedoms)
    rows.append(("freedoms", f"{free} of {8 * len(names)} design parameters keep all joints closed"))
    known = utilisation_range(piece, design.furniture.compliance)
    rows += [
        ("redundant joint", f"{name}: utilisation from {low:g} to {high} over the ratios of compliance")
        for name, low, most in (recorded_utilisations(piece, known, SHOWN) if known else ())
        for high in (utilisation_words(most, "g"),)
    ]
    more = len(known.redundant) - SHOWN if known else 0
    rows += [("redundant joint", f"and {more} more")] if more > 0 else []
    words = "; ".join(phrases(judged(piece, scene.quantities, effects.on("bending"))))
    rows.append(("constraint status", f"holds, but {words}" if words and result.valid else words or "valid"))
    rows += [("warning", words) for words in overlap_advice(piece, geometry.overlaps)]
    rows += [("warning", words) for words in free_end_warnings(piece, result.valid)]
    return rows + [("warning", warning) for warning in (*odd_values(scene, piece), *effects.warnings)]


def _board(plank: Plank) -> str:
    """Length, width and thickness of a plank, and where its axes point."""
    length, width, thickness = (f"{1e3 * size:.4g}" for size in plank.size)
    axes = ", ".join(f"{name} {_direction(axis)}" for name, axis in zip("xyz", plank.axes.T))
    return f"{length} x {width} x {thickness} mm of {plank.wood}, middle at {_place(plank.centre)}; {axes}"


def _joint(joint: Joint, names: list[str], length: float, count: int) -> str:
    """What a joint holds, how long it is, and by how many fasteners."""
    by = f"{count} {joint.fastener!r}"
    return f"on {names[joint.j]} {SIDES[joint.face]}, {1e3 * length:.4g} mm long, {by}"


def _reported(load: Load, piece: Piece) -> str:
    """How much a load is, and where."""
    plank = piece.planks[load.plank]
    place = plank.centre + plank.axes @ (np.array(load.place) * plank.size)
    return f"{float(np.linalg.norm(load.force)):.6g} N on {plank.name} at {_place(place)}"


def _place(place: np.ndarray) -> str:
    """A place in space in metres."""
    return f"({', '.join(_short(value) for value in place)}) m"


def _direction(axis: np.ndarray) -> str:
    """Where an axis points: along one of space, or its three components."""
    k = int(np.argmax(np.abs(axis)))
    if abs(axis[k]) > 1.0 - 1e-9:
        return f"along {'+' if axis[k] > 0.0 else '-'}{'xyz'[k]}"
    return f"along ({', '.join(_short(value) for value in axis)})"


def _short(value: float) -> str:
    """A number to a tenth of a thousandth, without a minus sign before nought."""
    return f"{round(float(value), 4) + 0.0:g}"
