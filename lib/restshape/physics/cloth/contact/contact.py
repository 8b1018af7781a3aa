"""Contact of cloth with bodies: penalty along the gradient of the distance, friction by anchors."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from operator import is_

import numpy as np

from restshape import _kernels
from restshape.physics.cloth.contact.contact_points import CLOSE, ContactPoints
from restshape.physics.cloth.sheet.turned_ways import turned_with

POTENTIAL = 12
"""Parameters of the element potential_point1: a place, the gradient there, the second derivatives xx yy zz yz xz xy."""
PERMITTED, DEEPER = 0.5, 0.25
"""How deep a step may take triangles into a body, over the thickness of contact, and over the depth of its middle where
that is less."""
MIDDLE = 0.9
"""Part of the depth of a body's middle below which no step leads."""
STAYS = 0.1
"""How far a triangle may go while cloth moves until it is looked at again, over the thickness of contact."""
LEAST_SHARE = 1e-6
"""Share of a step that is gone in any case: none would be no step."""


@dataclass(frozen=True, eq=False)
class FrameBegin:
    """Where a frame has begun, as each body sees it.

    Args:
        anchors: (bodies, n, 3) [m] of friction; corners: (bodies, corners, 3) [m] where they were.
    """

    anchors: np.ndarray
    corners: np.ndarray

    def anchors_at(
        self, body: int, x: np.ndarray, cells: np.ndarray | None, points: ContactPoints | None, least: float
    ) -> np.ndarray:
        """Anchors (n, 3) [m] of friction of a body with corners and points at x (n, 3) [m].

        Ways from them of more than a least length turn as the triangles (ne, 3) beside have turned since: the straight
        way around a bend would point backwards past 90 degrees of it.
        """
        ways = x - self.anchors[body]
        length = np.linalg.norm(ways, axis=1)
        if cells is None or not (length > least).any():
            return self.anchors[body]
        of, triangles = cells.ravel(), np.repeat(cells, 3, axis=0)
        if points is not None and len(points.nodes):
            of = np.concatenate([of, len(self.corners[body]) + np.arange(len(points.nodes))])
            triangles = np.concatenate([triangles, points.nodes])
        far = length[of] > least
        of, triangles = of[far], triangles[far]
        parts = turned_with(self.corners[body][triangles], x[triangles], ways[of])
        turned = np.column_stack([np.bincount(of, parts[:, a], len(x)) for a in range(3)])
        total = np.linalg.norm(turned, axis=1)
        known = (length > least) & (total > 0.0)
        anchors = self.anchors[body].copy()
        anchors[known] = x[known] - turned[known] * (length[known] / total[known])[:, None]
        return anchors


@dataclass(frozen=True, eq=False)
class FrictionHistory:
    """What friction remembers; each update makes another one.

    Args:
        anchors: (bodies, n, 3) [m] of the corners, and of the points of triangles where there are any.
        normals: (bodies, n, 3) of the surfaces at the last update.
        limits: (bodies, n) largest forces of friction [N].
        points: of the triangles that touch with more than their corners; None: corners alone touch.
        begin: of a frame, through which friction acts against the way from there, see `begun`; None: updates drag
            anchors.
    """

    anchors: np.ndarray
    normals: np.ndarray
    limits: np.ndarray
    points: ContactPoints | None = None
    begin: FrameBegin | None = None

    @classmethod
    def none(cls, bodies: int, nodes: int, points: ContactPoints | None = None) -> FrictionHistory:
        """The history of nodes that have touched nothing."""
        shape = (bodies, nodes)
        return cls(np.zeros((*shape, 3)), np.zeros((*shape, 3)), np.zeros(shape), points)

    def begun(self, place: np.ndarray, corners: int) -> FrictionHistory:
        """The history at the beginning of a frame, with so many corners, and points, at their places (n, 3) [m].

        Through the frame friction acts against the way of each node from here, whatever iterates are on it: what
        nothing presses yet has its anchor where it is.
        """
        anchors = np.where(self.limits[..., None] > 0.0, self.anchors, place)
        return replace(self, anchors=anchors, begin=FrameBegin(anchors, np.array([place[:corners]] * len(anchors))))

    def at_corners(self, n: int) -> FrictionHistory:
        """The history of the n corners alone."""
        points = self.points and ContactPoints.none(self.points.cells)
        return FrictionHistory(self.anchors[:, :n], self.normals[:, :n], self.limits[:, :n], points)

    def on(self, points: ContactPoints, x: np.ndarray) -> FrictionHistory:
        """The history on other points of the same triangles, with corners at x (n, 3) [m].

        A new point is as far from its anchor as the pressed ones of its triangle's corners are from theirs; through a
        frame it has one between theirs.
        """
        n, place = len(x), points.place(x)
        source = points.sources_in(self.points, n)
        found = FrictionHistory.none(len(self.anchors), len(place), points)
        kept, new = source >= 0, np.flatnonzero(source[n:] < 0)
        nodes, weights = points.nodes[new], points.weights[new]
        for k in range(len(self.anchors)):
            for own, old in zip(
                (found.anchors, found.normals, found.limits), (self.anchors, self.normals, self.limits)
            ):
                own[k, kept] = old[k, source[kept]]
            pressed = weights * (self.limits[k, nodes] > 0.0)
            total = pressed.sum(axis=1)
            ways = np.einsum("pk,pka->pa", pressed, (x - self.anchors[k, :n])[nodes])
            ways /= np.where(total > 0.0, total, 1.0)[:, None]
            found.anchors[k, n + new] = place[n + new] - ways
            # Any limit says that it is pressed; the next update gives it its own.
            found.limits[k, n + new] = np.einsum("pk,pk->p", pressed, self.limits[k, nodes])
        if self.begin is None:
            return found
        anchors = np.zeros_like(found.anchors)
        anchors[:, kept] = self.begin.anchors[:, source[kept]]
        anchors[:, n + new] = np.einsum("pk,bpka->bpa", weights, self.begin.anchors[:, nodes])
        return replace(found, begin=replace(self.begin, anchors=anchors))

    def mapped(
        self, before: np.ndarray, after: np.ndarray, interpolate: Callable[[np.ndarray], np.ndarray]
    ) -> FrictionHistory:
        """The history on other nodes: the ways from anchors, and which nodes are pressed.

        Args:
            before, after: (m, 3) and (n, 3) where the nodes of both are [m].
            interpolate: takes values (m, f) at the nodes of before to the others (n, f).
        """
        found = FrictionHistory.none(len(self.anchors), len(after))
        for k, (anchors, limits) in enumerate(zip(self.anchors, self.limits)):
            values = interpolate(np.column_stack([before - anchors, limits]))
            found.anchors[k], found.limits[k] = after - values[:, :3], np.maximum(values[:, 3], 0.0)
        return found

    def pressed(self, body: int) -> bool:
        """Whether a body with friction pressed any node at the last update."""
        return bool(self.limits[body].any())


@dataclass(frozen=True, eq=False)
class KnownPotential:
    """The potential where it was evaluated last.

    Args:
        dependencies: of the contact.
        x: (n, 3) positions [m].
        curved: as of `Contact.potential`; energy, table: what that returns.
    """

    dependencies: tuple[tuple[object, ...], tuple[float, ...]]
    x: np.ndarray
    curved: bool
    energy: float
    table: np.ndarray

    def holds(self, contact: Contact, x: np.ndarray, curved: bool) -> bool:
        """Whether it is that of a contact at x (n, 3)."""
        if self.curved != curved or not _kernels.same_values(self.x, x):
            return False
        objects, numbers = contact.dependencies
        known, values = self.dependencies
        return len(known) == len(objects) and all(map(is_, known, objects)) and values == numbers


@dataclass(frozen=True, eq=False)
class KnownPenalty:
    """The penalties of bodies where they were evaluated last.

    Args:
        dependencies: areas and bodies, none of which changes; numbers: stiffness [N/m^3] and thickness [m].
        x: (n, 3) positions [m].
        curved: as of `Contact.potential`; parts: what `Contact._pushed` returns.
    """

    dependencies: tuple[object, ...]
    numbers: tuple[float, float]
    x: np.ndarray
    curved: bool
    parts: Sequence[tuple[float, np.ndarray]]

    @classmethod
    def of(cls, contact: Contact, x: np.ndarray, curved: bool) -> KnownPenalty:
        """That of a contact at x (n, 3)."""
        areas, numbers, parts = contact.areas, (contact.stiffness, contact.thickness), []
        for room in contact.point_rooms(len(x)):
            table = np.zeros((len(x), POTENTIAL))
            parts.append((room.add_contact(x, areas, *numbers, table, curved), table))
        return cls((areas, *contact.bodies), numbers, x.copy(), curved, parts)

    def holds(self, contact: Contact, x: np.ndarray, curved: bool | None) -> bool:
        """Whether it is that of a contact at x (n, 3); `curved` as of `Contact._pushed`."""
        if curved not in (None, self.curved) or not _kernels.same_values(self.x, x):
            return False
        objects, numbers = (contact.areas, *contact.bodies), (contact.stiffness, contact.thickness)
        same = len(self.dependencies) == len(objects) and all(map(is_, self.dependencies, objects))
        return same and self.numbers == numbers


class Contact:
    """What bodies do to nodes. With one history of friction it is a potential of the positions.

    Where triangles are given, positions are those of their corners, followed by those of `points` between them, see
    `place`.

    Args:
        bodies: of `restshape._kernels.Body`; they may be replaced as they move.
        area: (n,) that each node stands for alone [m^2].
        stiffness: of the penalty [N/m^3]; thickness: distance at which it begins [m].
        friction: coefficient, of all bodies or one of each; slip: way along the surface at which it is all there [m].
        cells: (ne, 3) int32 triangles; None: nodes alone touch.
        cell_area: (ne,) of them [m^2].

    Attributes:
        history: of friction, with the points of triangles; it changes in `update_friction` and `cut` only.

    Source: docs/theory/cloth.md.
    """

    def __init__(
        self,
        bodies: Sequence[_kernels.Body],
        area: np.ndarray,
        stiffness: float,
        thickness: float,
        friction: float | Sequence[float] = 0.0,
        slip: float = 1e-4,
        cells: np.ndarray | None = None,
        cell_area: np.ndarray | None = None,
    ) -> None:
        self.bodies = list(bodies)
        self.area, self.stiffness, self.thickness = area, stiffness, thickness
        self.friction, self.slip = np.broadcast_to(friction, len(self.bodies)), slip
        self.cells, self.cell_area = cells, cell_area
        points = None if cells is None else ContactPoints.none(cells)
        self.history = FrictionHistory.none(len(self.bodies), len(area), points)
        self._areas: tuple[object, ...] = ()
        self._known: KnownPotential | None = None
        self._penalty: KnownPenalty | None = None
        self._kept_distances: tuple[list[_kernels.PointRoom], ContactPoints | None, tuple[_kernels.Body, ...]]
        self._kept_distances = [], None, ()
        self._looked: tuple[tuple[_kernels.Body, ...], np.ndarray] | None = None
        self._kept_rooms: tuple[list[_kernels.TriangleRoom], tuple[_kernels.Body, ...], float] = [], (), 0.0

    @property
    def points(self) -> ContactPoints | None:
        """Points of triangles that touch with more than their corners; None without triangles."""
        return self.history.points

    @property
    def areas(self) -> np.ndarray:
        """What corners and points stand for (n + m,) [m^2]."""
        points = self.points
        if points is None or not len(points.cut):
            return self.area
        known = (points, self.area, self.cell_area)
        if not (self._areas and all(map(is_, self._areas, known))):
            self._areas = (*known, points.areas(self.area, self.cell_area))
        return self._areas[3]

    def place(self, x: np.ndarray) -> np.ndarray:
        """Positions (n + m, 3) [m] of the corners at x (n, 3) and of the points."""
        return x if self.points is None else self.points.place(x)

    def cut(self, x: np.ndarray, moving: bool = False) -> None:
        """Let triangles touch with more than their corners where these at x (n, 3) [m] do not suffice.

        Args:
            x: corners.
            moving: triangles that have hardly moved since they were looked at stay as they are.
        """
        if self.points is None:
            return
        bodies, asked = tuple(self.bodies), None
        known = self._looked
        if known is None or len(known[0]) != len(bodies) or not all(map(is_, known[0], bodies)):
            known = self._looked = bodies, np.full((len(self.points.cells), 3, 3), np.inf)
        if moving:
            asked = np.zeros(len(self.points.cells), dtype=bool)
            asked[_kernels.moved_cells(x, self.points.cells, STAYS * self.thickness, known[1])] = True
        else:
            known[1][:] = x[self.points.cells]
        points = self.points.on(self.bodies, x, self.thickness, asked)
        if points is not self.points:
            self.history = self.history.on(points, x)

    def step_share(self, x: np.ndarray, d: np.ndarray) -> float:
        """The largest share, in (0, 1], of a step d (n, 3) from x (n, 3) [m] that lets no triangle through a body.

        A triangle may get as deep into one as contact bears, or somewhat deeper than it is, but never past its middle.
        """
        share = 1.0
        for room in self._rooms if self.cells is not None else ():
            share *= room.step_share(x, share * d, self.cells)
        return max(share, LEAST_SHARE)

    @property
    def _rooms(self) -> list[_kernels.TriangleRoom]:
        """What is known of how far the triangles may go beside each body, while that is where it is."""
        known, bodies, thickness = self._kept_rooms
        if thickness == self.thickness and len(bodies) == len(self.bodies) and all(map(is_, bodies, self.bodies)):
            return known
        known = []
        for body in self.bodies:
            depth = min(PERMITTED * self.thickness, DEEPER * body.inner_radius)
            close, bottom = min(CLOSE * self.thickness, 0.1 * depth), -MIDDLE * body.inner_radius
            known.append(_kernels.TriangleRoom(body, len(self.cells), -depth, depth, close, bottom))
        self._kept_rooms = known, tuple(self.bodies), self.thickness
        return known

    def point_rooms(self, count: int) -> list[_kernels.PointRoom]:
        """What is known of how far corners and points, so many in all, are from each body where it is."""
        known, points, bodies = self._kept_distances
        alike = points is self.points and len(bodies) == len(self.bodies) and all(map(is_, bodies, self.bodies))
        if not (alike and all(room.count == count for room in known)):
            known = [_kernels.PointRoom(body, count) for body in self.bodies]
            self._kept_distances = known, self.points, tuple(self.bodies)
        return known

    def update_friction(self, x: np.ndarray) -> float:
        """Take normals and normal forces from x (n, 3), and drag the anchors; returns the largest slip distance [m].

        Through a frame anchors are as far as it has led, and 0 is returned.
        """
        before, slipped = self.history, 0.0
        anchors, normals, limits = before.anchors.copy(), before.normals.copy(), before.limits.copy()
        for k, (_, pushed) in enumerate(self._pushed(x, None)):
            memory = anchors[k], normals[k], limits[k]
            slipped = max(slipped, _kernels.update_friction(x, pushed, self.friction[k], self.slip, *memory))
            if before.begin:
                anchors[k] = before.begin.anchors_at(k, x, self.cells, self.points, self.thickness)
        slipped = 0.0 if before.begin else slipped
        self.history = replace(before, anchors=anchors, normals=normals, limits=limits)
        return slipped

    def begin_frame(self, x: np.ndarray) -> None:
        """Let friction act against the way from corners at x (n, 3) [m] until `end_frame`."""
        self.history = self.history.begun(self.place(x), len(x))

    def end_frame(self, x: np.ndarray) -> float:
        """Drag the anchors to corners at x (n, 3) [m], where the frame has led: forces stay as they are.

        Returns: how far the farthest goes [m]; 0 where the frame has not begun at a rest.
        """
        if not self.history.begin:
            return 0.0
        self.history = replace(self.history, begin=None)
        return self.update_friction(self.place(x))

    def passed(self, x: np.ndarray, way: np.ndarray) -> bool:
        """Whether points (n, 3) that go on along a way (3,) touch no body any more.

        A convex body is not touched again once all go away from it; of another one that holds for the box around it.
        Points all around a body with friction may still be held by it, as long as it is no farther than they reach.
        """
        reach = float(np.linalg.norm(np.ptp(x, axis=0)))
        for body, friction in zip(self.bodies, self.friction):
            distance, gradient, _ = body.hull.distance(x)
            if distance.min() <= self.thickness or (gradient @ way).min() < 0.0:
                return False
            if friction > 0.0 and distance.min() <= reach and _all_around(gradient, way):
                return False
        return True

    def force_rates(self, x: np.ndarray, rates: np.ndarray) -> np.ndarray:
        """Rates (n, 3) of forces at constant x (n, 3) when areas change with rates (n,): the penalty is linear in them.

        Friction has none, for its limits are those of the last update.
        """
        out = np.zeros((len(x), POTENTIAL))
        for body in self.bodies:
            body.add_contact(x, rates, self.stiffness, self.thickness, out, False)
        return out[:, 3:6]

    def forces(self, x: np.ndarray) -> np.ndarray:
        """The gradient (n, 3) [N] of the potential at x (n, 3) [m]."""
        return self._either(x)[1][:, 3:6]

    def energy(self, x: np.ndarray) -> float:
        """The potential [J] at x (n, 3) [m]."""
        return self._either(x)[0]

    def _either(self, x: np.ndarray) -> tuple[float, np.ndarray]:
        """The potential at x (n, 3), with or without the curvature of the surfaces, as is known."""
        return self.potential(x, bool(self._known) and self._known.curved and self._known.holds(self, x, True))

    def potential(self, x: np.ndarray, curved: bool = True) -> tuple[float, np.ndarray]:
        """Energy [J], and the parameters (n, 12) of potential_point1 whose residual and tangent at x are its own.

        Energy, forces and tangent are wanted at the same place one after the other: the last ones are kept.

        Args:
            x: (n, 3) positions [m].
            curved: with the force times the curvature of the surface; without it the tangent is semidefinite.

        Returns: both, to be read only.
        """
        if not (self._known and self._known.holds(self, x, curved)):
            energy, table = self._evaluated(x, curved)
            self._known = KnownPotential(self.dependencies, x.copy(), curved, energy, table)
        return self._known.energy, self._known.table

    @property
    def dependencies(self) -> tuple[tuple[object, ...], tuple[float, ...]]:
        """What the potential depends on besides positions: objects, none of which changes, and numbers."""
        return (self.history, self.areas, *self.bodies), (self.stiffness, self.thickness, self.slip)

    def _evaluated(self, x: np.ndarray, curved: bool) -> tuple[float, np.ndarray]:
        out = np.zeros((len(x), POTENTIAL))
        out[:, :3] = x
        energy, history, known = 0.0, self.history, self._penalty
        parts = known.parts if known and known.holds(self, x, curved) else ()
        areas, numbers = self.areas, (self.stiffness, self.thickness)
        for k, room in enumerate(self.point_rooms(len(x))):
            if parts:
                energy += parts[k][0]
                out += parts[k][1]
            else:
                energy += room.add_contact(x, areas, *numbers, out, curved)
            anchors, normals, limits = history.anchors[k], history.normals[k], history.limits[k]
            energy += _kernels.add_friction(x, anchors, normals, limits, self.slip, out)
        return energy, out

    def _pushed(self, x: np.ndarray, curved: bool | None) -> Sequence[tuple[float, np.ndarray]]:
        """Energy [J] of each body's penalty, and its parameters (n, 12) of potential_point1, at x (n, 3) [m].

        Friction has no part in it: what it does at the same place needs no other distances.

        Args:
            x: positions.
            curved: with the curvature of the surfaces or without; None: as is known.
        """
        known = self._penalty
        if not (known and known.holds(self, x, curved)):
            known = self._penalty = KnownPenalty.of(self, x, bool(curved))
        return known.parts


def _all_around(normals: np.ndarray, way: np.ndarray) -> bool:
    """Whether directions (n, 3), seen along a way (3,), leave no half of the plane free."""
    along = way / np.linalg.norm(way)
    first = np.cross(along, np.eye(3)[np.abs(along).argmin()])
    across = normals @ np.stack([first, np.cross(along, first)], axis=1)
    across = across[np.linalg.norm(across, axis=1) > 1e-9]
    angles = np.sort(np.arctan2(across[:, 1], across[:, 0]))
    return len(angles) > 2 and np.diff(angles, append=angles[:1] + 2.0 * np.pi).max() < np.pi
