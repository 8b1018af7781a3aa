"""Scene files of pieces of furniture: what a piece is, as text."""

from collections.abc import Sequence

import numpy as np
from restshape_apps.furniture.shape.planks import SIDES, Piece, Plank

DIGITS = 9
"""Decimals of a length [m]."""


def scene_text(piece: Piece, title: str, note: str = "", joints: bool = False) -> str:
    """The TOML text of a scene whose piece this is.

    Planks are given by two lines, and weights by their masses; those that are most planks' wood and thickness, and the
    fastener of the first joint, are the scene's.

    Args:
        piece: under gravity alone or beside pushes.
        title: of the scene.
        note: a comment above all.
        joints: name each joint; else those of ends near faces are all there are.
    """
    first = piece.planks[0]
    g = float(np.linalg.norm(piece.gravity))
    lines = [f"# {note}"] if note else []
    lines += ['format = "restshape-scene"', "version = 1", 'app = "furniture"', f'title = "{title}"', ""]
    lines += ["[wood]", f'name = "{first.wood}"', f"thickness = {_number(first.size[2])}", ""]
    usual = piece.joints[0].fastener if piece.joints else "nail-thesis"
    lines += ["[fastener]", f'name = "{usual}"', f"spacing = {_number(piece.spacing)}", ""]
    lines += [
        "[floor]",
        f"height = {_number(piece.planes[0].point[2])}",
        f"friction = {_number(piece.planes[0].mu)}",
        "",
    ]
    for plank in piece.planks:
        lines += _plank(plank, first)
    if joints:
        lines += _joints(piece, usual)
    for load in piece.weights:
        lines += [f"[weights.{named(load.name)}]", f'on = "{named(piece.planks[load.plank].name)}"']
        mass = float(np.dot(load.force, piece.gravity)) / g**2
        lines += [f"mass = {_number(mass)}", f"at = {_vector(load.place)}", ""]
    for load in piece.pushes:
        lines += [f"[pushes.{named(load.name)}]", f'on = "{named(piece.planks[load.plank].name)}"']
        lines += [f"force = {_vector(load.force)}", f"at = {_vector(load.place)}", ""]
    lines += ["[effects.gravity]", f"g = {_vector(piece.gravity)}"]
    lines += ["", "[effects.push]"] if piece.pushes else []
    return "\n".join(lines) + "\n"


def named(name: str) -> str:
    """The name as scenes may have it: letters, digits, - and _."""
    return "".join(c if c.isalnum() or c in "-_" else "-" for c in name)


def _plank(plank: Plank, first: Plank) -> list[str]:
    """The table of a plank."""
    lines = [f"[planks.{named(plank.name)}]"]
    lines += [f"from = {_vector(plank.end(0))}", f"to = {_vector(plank.end(1))}"]
    lines += [f"width = {_vector(plank.axes[:, 1] * plank.size[1])}"]
    lines += [] if plank.size[2] == first.size[2] else [f"thickness = {_number(plank.size[2])}"]
    lines += [] if plank.wood == first.wood else [f'wood = "{plank.wood}"']
    return [*lines, ""]


def _joints(piece: Piece, usual: str) -> list[str]:
    """The tables of all joints."""
    lines = ["[joints]", "near = false", ""]
    for k, joint in enumerate(piece.joints, 1):
        plank, other = (named(piece.planks[i].name) for i in (joint.i, joint.j))
        lines += [f"[joints.joint-{k}]", f'plank = "{plank}"', f'end = "{SIDES[joint.side]}"']
        lines += [f'to = "{other}"', f'face = "{SIDES[joint.face]}"']
        lines += [] if joint.fastener == usual else [f'fastener = "{joint.fastener}"']
        lines += [""]
    return lines


def _number(value: float) -> str:
    """A number without the noise of rounding."""
    return repr(round(float(value), DIGITS) + 0.0)


def _vector(values: Sequence[float]) -> str:
    return f"[{', '.join(map(_number, values))}]"
