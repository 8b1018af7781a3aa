"""Pieces of furniture from scenes: planks as they were drawn, joined where they are near, with their loads."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from restshape_apps.furniture.scene.furniture import JointSpec, PlankSpec
from restshape_apps.furniture.shape.face_contacts import kept_contacts
from restshape_apps.furniture.shape.kept_edits import kept_edits
from restshape_apps.furniture.shape.planks import (
    LEAST_SLANT,
    SIDES,
    Joint,
    Load,
    Piece,
    Plane,
    Plank,
    feet_near,
    joints_near,
)

from restshape.errors import UserError
from restshape.scene.model import Scene
from restshape.scene.space_values import number

STANDARD = (0.0, 0.0, -9.80665)
"""Acceleration [m/s^2] of ``[effects.gravity]`` where it names none."""


def piece_of(scene: Scene) -> Piece:
    """The piece that a scene draws; its joints may be as far from closed as they were drawn.

    Weights weigh as much as ``[effects.gravity]`` makes them, nothing without it; pushes are there with
    ``[effects.push]`` only.

    Raises:
        UserError: a plank has no extent, or a joint's end is that of another one.
    """
    planks, planes = drawn_planks(scene), (floor_of(scene),)
    g = _gravity(scene)
    index = {name: k for k, name in enumerate(scene.planks)}
    weights = tuple(
        Load(
            name,
            index[w.on],
            w.at or top_of(planks[index[w.on]]),
            tuple(number(w.mass, scene.parameters) * a for a in g),
        )
        for name, w in scene.weights.items()
    )
    pushes = tuple(
        Load(name, index[p.on], p.at, tuple(number(f, scene.parameters) for f in p.force))
        for name, p in scene.pushes.items()
    )
    joints = _joints(scene, planks, index)
    return Piece(
        planks,
        joints,
        feet_near(planks, scene.joints.reach, planes, joints),
        planes,
        weights,
        pushes if "push" in scene.effects else (),
        g,
        scene.fastener.spacing,
        scene.title or scene.path.stem,
        scene.joints.reach,
        scene.effects.get("nails", {}).get("moments") == "all",
    )


def drawn_planks(scene: Scene) -> tuple[Plank, ...]:
    """The planks as a scene draws them, their ends as far from closed as they were drawn.

    Raises:
        UserError: a plank has no extent.
    """
    return tuple(_plank(name, spec, scene) for name, spec in scene.planks.items())


def floor_of(scene: Scene) -> Plane:
    """The floor of a scene."""
    return Plane((0.0, 0.0, scene.floor.height), (0.0, 0.0, 1.0), scene.floor.friction)


def top_of(plank: Plank) -> tuple[float, float, float]:
    """The middle of the side of a plank that looks up most, a face before ends, in parts of its size."""
    up = plank.axes[2]
    axis = 2 if abs(up[2]) > LEAST_SLANT else int(np.argmax(np.abs(up)))
    place = np.zeros(3)
    place[axis] = 0.5 if up[axis] > 0.0 else -0.5
    return tuple(place.tolist())


def weighing(scene: Scene, name: str, plank: int, mass: float, at: tuple[float, float, float]) -> Load:
    """A mass [kg] on a plank, under the scene's gravity."""
    return Load(name, plank, at, tuple(mass * a for a in _gravity(scene)))


def redrawn(piece: Piece, scene: Scene) -> Piece:
    """A piece that edits have changed, with its planks where its scene draws them, their ends not closed."""
    drawn = {plank.name: plank for plank in drawn_planks(scene)}
    return replace(piece, planks=tuple(drawn.get(plank.name, plank) for plank in piece.planks))


def restated(piece: Piece, before: Scene, after: Scene, drawn: Piece | None = None, itself: str = "") -> Piece:
    """A piece that edits have changed, with what its scene says otherwise after a key was set.

    A plank that the scene draws elsewhere or in another size goes there, and differs from its drawing by what edits
    have changed of it: see `kept_edits`. All others stay where edits have put them.
    Those that edits drew, as thick and of the wood that all are, follow these.
    Where they become thicker, faces that lie on the floor or on each other still do: see `kept_contacts`.

    Args:
        piece: with closed joints.
        before, after: its scene.
        drawn: what `redrawn` gives of the scene before, with closed joints; None: none needs to be closed.
        itself: the plank of which a key was set; empty: of none.

    Raises:
        UserError: a plank has no extent.
    """
    old, new = piece_of(before), piece_of(after)
    numbers = {plank.name: k for k, plank in enumerate(piece.planks)}
    was, wanted = ({plank.name: plank for plank in one.planks} for one in (old, new))
    began = {plank.name: plank for plank in (drawn or redrawn(piece, before)).planks}
    planks = tuple(
        _replanked(plank, (was[plank.name], wanted[plank.name]), began[plank.name], plank.name == itself)
        if plank.name in was and plank.name in wanted
        else _as_usual(plank, before, after)
        for plank in piece.planks
    )
    drawn = {k for k, (now, then) in enumerate(zip(piece.planks, planks)) if not same_place(now, then)}
    planks = kept_contacts(piece.planks, planks, piece.planes, drawn)
    joints = piece.joints
    if before.fastener.name != after.fastener.name:
        joints = tuple(
            replace(joint, fastener=after.fastener.name) if joint.fastener == before.fastener.name else joint
            for joint in joints
        )
    return replace(
        piece,
        planks=planks,
        joints=joints,
        planes=new.planes,
        weights=tuple(_reweighed(load, old, new, numbers) for load in piece.weights),
        pushes=_pushes(piece, old, new),
        gravity=new.gravity,
        spacing=new.spacing,
        reach=new.reach,
        moments=new.moments,
    )


def _pushes(piece: Piece, old: Piece, new: Piece) -> tuple[Load, ...]:
    """The pushes that a scene has now, on the planks of the edited piece; those on planks that are gone are not."""
    numbers = {plank.name: k for k, plank in enumerate(piece.planks)}
    here = {push.name: push for push in piece.pushes}
    had = {push.name: push for push in old.pushes}
    found = []
    for push in new.pushes:
        plank = new.planks[push.plank].name
        # A push that went with its plank stays away.
        if plank in numbers and (push.name in here or push.name not in had):
            found.append(replace(push, plank=numbers[plank]))
    return tuple(found)


def _gravity(scene: Scene) -> tuple[float, float, float]:
    if "gravity" not in scene.effects:
        return (0.0, 0.0, 0.0)
    return tuple(map(float, scene.effects["gravity"].get("g", STANDARD)))


def _plank(name: str, spec: PlankSpec, scene: Scene) -> Plank:
    """One plank as it was drawn."""

    def numbers(values: tuple) -> list[float]:
        return [number(value, scene.parameters) for value in values]

    (thickness,) = numbers((scene.wood.thickness if spec.thickness is None else spec.thickness,))
    wood = spec.wood or scene.wood.name
    if spec.drawn:
        lines = (numbers(values) for values in (spec.start, spec.to, spec.width))
        try:
            return Plank.between(name, *lines, thickness, wood=wood)
        except UserError as error:
            raise UserError(error.what, f"planks.{name}", error.do) from error
    x, y, z = numbers(spec.turn)
    axes = _turn(2, z) @ _turn(1, y) @ _turn(0, x)
    return Plank(name, np.array(numbers(spec.center)), axes, np.array([*numbers(spec.size), thickness]), wood)


def _turn(axis: int, angle: float) -> np.ndarray:
    """The rotation (3, 3) about an axis by an angle [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    turn, (a, b) = np.eye(3), ((axis + 1) % 3, (axis + 2) % 3)
    turn[[a, a, b, b], [a, b, a, b]] = c, -s, s, c
    return turn


def _joints(scene: Scene, planks: tuple[Plank, ...], index: dict[str, int]) -> tuple[Joint, ...]:
    """The joints that have names, then those of ends that are near faces."""
    usual = scene.fastener.name
    found = {}
    for name, spec in scene.joints.named.items():
        joint = _joint(spec, index, usual)
        if (joint.i, joint.side) in found:
            what = f"the end {spec.end} of {spec.plank!r} has a joint already"
            raise UserError(what, f"joints.{name}", "give each end one joint")
        found[joint.i, joint.side] = joint
    joints = tuple(found.values())
    if scene.joints.near:
        return (*joints, *joints_near(planks, scene.joints.reach, fastener=usual, joints=joints))
    return joints


def _joint(spec: JointSpec, index: dict[str, int], usual: str) -> Joint:
    side, face = SIDES.index(spec.end), SIDES.index(spec.face)
    return Joint(index[spec.plank], side, index[spec.to], face, spec.fastener or usual)


def _as_usual(plank: Plank, before: Scene, after: Scene) -> Plank:
    """A plank that an edit drew, with what its scene says otherwise of all planks, where it is as all were."""
    was, wanted = (number(one.wood.thickness, one.parameters) for one in (before, after))
    thickness = wanted if plank.size[2] == was else plank.size[2]
    wood = after.wood.name if plank.wood == before.wood.name else plank.wood
    return replace(plank, size=np.array([*plank.size[:2], thickness]), wood=wood)


def _replanked(plank: Plank, drawings: tuple[Plank, Plank], drawn: Plank, set_itself: bool) -> Plank:
    """A plank with what its scene says otherwise."""
    before, after = drawings
    if before.wood != after.wood:
        plank = replace(plank, wood=after.wood)
    if not same_place(before, after) or not np.array_equal(before.size[:2], after.size[:2]):
        return kept_edits(plank, drawings, drawn, set_itself)
    if before.size[2] != after.size[2]:
        return replace(plank, size=np.array([*plank.size[:2], after.size[2]]))
    return plank


def same_place(one: Plank, other: Plank) -> bool:
    """Whether two planks have the same middle and axes."""
    return np.array_equal(one.centre, other.centre) and np.array_equal(one.axes, other.axes)


def _reweighed(load: Load, old: Piece, new: Piece, numbers: dict[str, int]) -> Load:
    """A weight with what its scene says otherwise of its plank, its mass, its place, and gravity."""
    first, last = ({one.name: one for one in piece.weights}.get(load.name) for piece in (old, new))
    if first and last:
        was, on = old.planks[first.plank].name, new.planks[last.plank].name
        if was != on:
            if on not in numbers:
                raise UserError(f"the plank {on} was deleted", do="name another one")
            load = replace(load, plank=numbers[on])
        if first.place != last.place:
            load = replace(load, place=last.place)
        if first.force != last.force and (old.gravity == new.gravity or load.force == first.force):
            return replace(load, force=last.force)
    size = float(np.dot(old.gravity, old.gravity))
    if old.gravity == new.gravity or size == 0.0:
        return load
    mass = float(np.dot(load.force, old.gravity)) / size
    return replace(load, force=tuple(mass * a for a in new.gravity))
