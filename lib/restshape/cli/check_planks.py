"""What `restshape check` says of a piece of furniture."""

from typing import Any

import numpy as np

from restshape.cli.quantity_words import quantity_rows
from restshape.guidance.design import Design
from restshape.scene.model import Scene
from restshape.scene.plan import Plan
from restshape.shape.planks import SIDES, Load


def held_piece(scene: Scene, effects: Plan, design: Design) -> dict[str, Any]:
    """What the scene holds, for programs."""
    piece, verdict = design.piece, design.furniture.test()
    names = [plank.name for plank in piece.planks]
    return {
        "scene": str(scene.path),
        "app": scene.app,
        "title": scene.title,
        "planks": {
            plank.name: {"center": plank.centre.tolist(), "size": plank.size.tolist(), "wood": plank.wood}
            for plank in piece.planks
        },
        "joints": [
            {
                "plank": names[joint.i],
                "end": SIDES[joint.side],
                "to": names[joint.j],
                "face": SIDES[joint.face],
                "fastener": joint.fastener,
            }
            for joint in piece.joints
        ],
        "feet": [{"plank": names[foot.plank], "side": SIDES[foot.side]} for foot in piece.feet],
        "mass": float(design.furniture.geometry().mass.sum()),
        "valid": verdict.valid,
        "flaws": list(verdict.words),
        "effects": [{"effect": e.name, "on": e.on, "why": e.why} for e in effects.effects],
        "weights": {load.name: {"on": names[load.plank], "force": list(load.force)} for load in piece.weights},
        "pushes": {load.name: {"on": names[load.plank], "force": list(load.force)} for load in piece.pushes},
        "warnings": list(effects.warnings),
        "quantities": list(scene.quantities),
        "solve": scene.solve.model_dump(),
    }


def described_piece(scene: Scene, effects: Plan, design: Design) -> list[tuple[str, str]]:
    """What the scene holds, for people."""
    piece, verdict = design.piece, design.furniture.test()
    names, geometry = [plank.name for plank in piece.planks], design.furniture.geometry()
    rows = [("planks", f"{len(piece.planks)}: {', '.join(names)}")]
    nails = int(geometry.nails.sum())
    rows.append(("joints", f"{len(piece.joints)}, with {nails} fasteners {scene.fastener.name!r}"))
    rows.append(("feet", ", ".join(f"{names[foot.plank]} {SIDES[foot.side]}" for foot in piece.feet) or "none"))
    rows.append(("mass", f"{geometry.mass.sum():.6g} kg of {scene.wood.name}"))
    rows += [(f"effect {e.name}", f"{'on' if e.on else 'off'}: {e.why}") for e in effects.effects]
    rows += [(f"weight {load.name}", _told(load, names)) for load in piece.weights]
    rows += [(f"push {load.name}", _told(load, names)) for load in piece.pushes]
    rows.append(("floor", f"height {scene.floor.height:g} m, friction {scene.floor.friction:g}"))
    rows += quantity_rows(scene)
    free = len(design.freedoms)
    rows.append(("freedoms", f"{free} of {8 * len(names)} design parameters keep all joints closed"))
    rows.append(("verdict", "; ".join(verdict.words) or "valid"))
    return rows + [("warning", warning) for warning in effects.warnings]


def _told(load: Load, names: list[str]) -> str:
    """How much a load is, and where."""
    return f"{float(np.linalg.norm(load.force)):.6g} N on {names[load.plank]}"
