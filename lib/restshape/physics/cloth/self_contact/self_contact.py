"""Contact of cloth with itself: a barrier between its parts, from IPC Toolkit, and friction between layers."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from restshape import _kernels
from restshape.physics.cloth.contact.collision_surface import CollisionSurface, columns
from restshape.physics.cloth.self_contact.barrier_by_pattern import barrier_by_pattern
from restshape.physics.cloth.self_contact.layer_friction import LayerFriction, Touching
from restshape.physics.cloth.self_contact.near_pairs import NearPairs
from restshape.physics.cloth.self_contact.touching_pairs import node_lists, touching

ROOM = 2.0
"""Distance within which nodes are coupled in the pattern of matrices, over that at which contact begins."""
FIRST, SECOND = (list(which) for which in zip(*((i, j) for i in range(4) for j in range(i))))
"""Of lists of four nodes, both columns of each pair."""
LEAST_SHARE = 1e-12
"""The share of a step that is gone where parts touch already."""
MET = 1e-6
"""Distance below which parts lie in each other, over that at which contact begins: folded over in their own plane."""
FULL, DIAGONAL = 9, 6
"""Numbers of a block of second derivatives of two nodes, and of one."""
VOIGT = np.array([[0, 5, 4], [5, 1, 3], [4, 3, 2]])
"""Place of xx yy zz yz xz xy in a block of one node."""


@dataclass(frozen=True)
class SelfContactValues:
    """How parts of cloth push each other away.

    Args:
        thickness: distance at which contact begins [m].
        stiffness: pressure of the barrier [Pa].
        friction: coefficient between layers; slip: way at which it is all there [m].
    """

    thickness: float
    stiffness: float
    friction: float = 0.0
    slip: float = 1e-4


class Encounter:
    """What is near at one place, evaluated as far as it is asked for.

    Args:
        owner: of candidates and values.
        x: (n, 3) [m]; a copy is kept.

    Attributes:
        second: second derivatives, with or without negative ones, with what they depend on.
    """

    def __init__(self, owner: SelfContact, x: np.ndarray) -> None:
        self.owner, self.x = owner, x.copy()
        self.collisions = owner.collisions(x, owner.values.thickness) if owner.active else ()
        self.second: dict[bool, tuple[object, tuple[np.ndarray, np.ndarray]]] = {}

    @cached_property
    def places(self) -> np.ndarray:
        """The positions by columns."""
        return columns(self.x)

    @cached_property
    def energy(self) -> float:
        """Of the barrier [J]."""
        return float(self.owner.potential(self.collisions, self.owner.mesh, self.places)) if self.near else 0.0

    @cached_property
    def forces(self) -> np.ndarray:
        """The gradient (n, 3) [N] of the barrier."""
        if not self.near:
            return np.zeros_like(self.x)
        return self.owner.potential.gradient(self.collisions, self.owner.mesh, self.places).reshape(-1, 3)

    @property
    def near(self) -> bool:
        """Whether anything is near."""
        return len(self.collisions) > 0

    @property
    def met(self) -> bool:
        """Whether parts lie in each other, as where cloth is folded over in its own plane: the barrier is infinite."""
        owner = self.owner
        least = self.near and self.collisions.compute_minimum_distance(owner.mesh, self.places)
        return self.near and not least > (MET * owner.values.thickness) ** 2

    @cached_property
    def by_pattern(self) -> Any:
        """Derivatives (3 n, 3 n) [N/m] of the barrier's forces by the places of nodes in the flat pattern."""
        owner, mesh, values = self.owner, self.owner.mesh, self.owner.values
        if not mesh.are_area_jacobians_initialized():
            mesh.init_area_jacobians()
        collisions = owner.collisions(self.x, values.thickness, differentiable=True)
        library = owner.surface.library
        numbers = owner.potential, values.thickness, values.stiffness
        return barrier_by_pattern(library, collisions, mesh, self.x, *numbers)

    def hessian(self, curved: bool) -> Any:
        """Second derivatives (3 n, 3 n) [N/m] of the barrier in columns; each pair's without negative ones or not."""
        method = self.owner.surface.library.PSDProjectionMethod
        kind = method.NONE if curved else method.CLAMP
        return self.owner.potential.hessian(self.collisions, self.owner.mesh, self.places, kind)


class SelfContact:
    """What cloth does to itself. With one history of friction it is a potential of the positions.

    Args:
        surface: of the cloth; its material coordinates are those of the last `place`.
        values: of contact; others may be set.

    Attributes:
        active: whether it does anything: cloth that begins across itself must come apart first.
        history: of friction between layers; it changes in `update_friction` only.
        pairs: (m, 2) int32 nodes that may be coupled, the smaller one first; coverings: of which set it is.

    Source: docs/theory/cloth.md; Li and others, ACM TOG 39(4), 2020, 49.
    """

    def __init__(self, surface: CollisionSurface, values: SelfContactValues) -> None:
        self.surface = surface
        self.active, self.history = True, LayerFriction.none(len(surface.flat))
        self.pairs, self.coverings = np.zeros((0, 2), np.int32), 0
        self._keys = np.zeros(0, np.int64)
        self.set_values(values)

    def begin(self, x: np.ndarray) -> bool:
        """Let it act unless the cloth crosses itself at x (n, 3); returns whether it acts."""
        self._act(not self.surface.crosses(x), len(x))
        if self.active and self.at(x).met:
            self._act(False, len(x))
        return self.active

    def _act(self, active: bool, n: int) -> None:
        """Let it act on n nodes, or not."""
        if active != self.active:
            self.active, self._encounter, self.history = active, None, LayerFriction.none(n)

    def set_values(self, values: SelfContactValues) -> None:
        """Take other values; what is near is looked for again."""
        self.values, self._encounter = values, None
        self._candidates = NearPairs(self.surface, values.thickness, ROOM * values.thickness)

    def place(self, X: np.ndarray) -> None:
        """Take in where the nodes are in the material (n, 2) [m]: areas are those of the flat pattern."""
        if not np.array_equal(self.surface.flat[:, :2], X):
            self.surface.place(X)
            self._encounter = None

    @property
    def rough(self) -> bool:
        """Whether there is friction between layers."""
        return self.values.friction > 0.0

    @property
    def mesh(self) -> Any:
        """The library's mesh of the surface."""
        return self.surface.mesh

    @property
    def potential(self) -> Any:
        """The library's barrier."""
        return self.surface.library.BarrierPotential(self.values.thickness, self.values.stiffness, True)

    def collisions(self, x: np.ndarray, distance: float, differentiable: bool = False) -> Any:
        """The library's collisions at x (n, 3), nearer than a distance [m] of up to twice the thickness.

        They are `differentiable` by the pattern where that is asked for.
        """
        candidates, found = self._candidates.at(x), self.surface.library.NormalCollisions()
        found.use_area_weighting, found.enable_shape_derivatives = True, differentiable
        if not self._candidates.none:
            found.build(candidates, self.mesh, columns(x), distance)
        return found

    def at(self, x: np.ndarray) -> Encounter:
        """What is near at x (n, 3); the last place is kept."""
        known = self._encounter
        if known is None or not _kernels.same_values(known.x, x):
            known = self._encounter = Encounter(self, x)
        return known

    def step_share(self, x: np.ndarray, d: np.ndarray) -> float:
        """The largest share, in (0, 1], of a step d (n, 3) from x (n, 3) [m] on which no parts meet."""
        if not self.active or not d.any() or not np.isfinite(d).all():
            return 1.0
        return max(self._candidates.step_share(x, d), LEAST_SHARE)

    def update_friction(self, x: np.ndarray) -> float:
        """Let friction follow to x (n, 3); returns the largest way [m] that layers have slid on, 0 through a frame."""
        if not self.rough:
            return 0.0
        near = self.at(x)
        if not near.near and not len(self.history.offsets):
            return 0.0
        self.history, slid = self.history.updated(x, self._touching(near), self.values.slip)
        return slid

    def begin_frame(self, x: np.ndarray) -> None:
        """Let friction act against the way from x (n, 3) [m] until `end_frame`."""
        if self.rough and self.active:
            self.history = self.history.begun(x, self.surface.cells, self.values.thickness)

    def end_frame(self, x: np.ndarray) -> float:
        """Let go of what has slid on until x (n, 3) [m], where a frame has led: forces stay as they are.

        Returns: the largest way [m]; 0 where the frame has not begun at a rest.
        """
        if not self.history.begin:
            return 0.0
        self.history, slid = self.history.ended(x, self.values.slip)
        return slid

    def hold(self, x: np.ndarray, slides: np.ndarray) -> None:
        """Let friction begin at x (n, 3) with what holds the nodes (n, 4), of another mesh: `LayerFriction.mapped`."""
        if self.rough:
            self.history = LayerFriction.of_nodes(x, self._touching(self.at(x)), slides)

    def _touching(self, near: Encounter) -> Touching:
        """The pairs that press each other apart at a place."""
        if not near.near:
            return Touching.none()
        return touching(self.surface, near.collisions, near.x, self.values.thickness, self.values.stiffness)

    # --- the potential --------------------------------------------------------------------------------------------

    def energy(self, x: np.ndarray) -> float:
        """The potential [J] at x (n, 3) [m]."""
        energy = self.at(x).energy
        if not len(self.history.offsets):
            return energy
        return energy + self.history.energy(x, self.values.friction, self.values.slip)

    def forces(self, x: np.ndarray) -> np.ndarray:
        """The gradient (n, 3) [N] of the potential at x (n, 3) [m]."""
        forces = self.at(x).forces
        if not len(self.history.offsets):
            return forces
        forces = forces.copy()
        self.history.add_forces(x, self.values.friction, self.values.slip, forces)
        return forces

    def force_rates(self, x: np.ndarray, dX: np.ndarray) -> np.ndarray:
        """Rates (n, 3) of the barrier's forces at constant x (n, 3) when the pattern's nodes move with rates dX (n, 2).

        Friction has none, for its limits are those of the last update.
        """
        near = self.at(x)
        if not near.near or not dX.any():
            return np.zeros_like(x)
        return (near.by_pattern @ np.column_stack([dX, np.zeros(len(dX))]).ravel()).reshape(x.shape)

    def barrier_forces(self, x: np.ndarray) -> np.ndarray:
        """The gradient (n, 3) [N] of the barrier alone, which is proportional to its stiffness, at x (n, 3) [m]."""
        return self.at(x).forces

    def place_rates(self, x: np.ndarray, way: np.ndarray) -> np.ndarray:
        """Rates (n, 3) of the forces of friction at x (n, 3) when its material goes a `way` (n, 3) under its nodes."""
        values, pairs, out = self.values, self.history.touching, np.zeros_like(x)
        blocks = self.history.hessians(x, values.friction, values.slip)
        forces = np.einsum("mab,mb->ma", blocks, -pairs.between(way))
        np.add.at(out, pairs.nodes, pairs.shares[:, :, None] * forces[:, None, :])
        return out

    # --- second derivatives ---------------------------------------------------------------------------------------

    def cover(self, x: np.ndarray) -> bool:
        """Let `pairs` hold all nodes that are coupled at x (n, 3), with room; returns whether they are others now."""
        near = self.at(x)
        lists = node_lists(near.collisions, self.surface) if near.near else np.zeros((0, 4), np.int64)
        needed = self._keys_of(np.concatenate([lists, self.history.touching.nodes]))
        if self._places(needed)[1].all():
            return False
        wide = node_lists(self.collisions(x, ROOM * self.values.thickness), self.surface)
        self._keys = np.union1d(needed, self._keys_of(wide))
        n = len(self.surface.flat)
        self.pairs = np.ascontiguousarray(np.column_stack([self._keys // n, self._keys % n]).astype(np.int32))
        self.coverings += 1
        return True

    def _keys_of(self, nodes: np.ndarray) -> np.ndarray:
        """The pairs of different nodes in lists (m, 4), the smaller one times their number plus the other."""
        first, second = nodes[:, FIRST].ravel(), nodes[:, SECOND].ravel()
        low, high = np.minimum(first, second), np.maximum(first, second)
        different = (low != high) & (low >= 0)
        return low[different] * np.int64(len(self.surface.flat)) + high[different]

    def _places(self, keys: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Where keys (m,) are among those of `pairs`, and whether they are there (m,)."""
        at = np.searchsorted(self._keys, keys)
        return at, np.append(self._keys, -1)[at] == keys

    def second_derivatives(self, x: np.ndarray, curved: bool) -> tuple[np.ndarray, np.ndarray]:
        """Second derivatives at x (n, 3): of nodes (n, 6) xx yy zz yz xz xy, and of `pairs` (m, 9) row by row [N/m].

        Args:
            x: positions [m].
            curved: all of the barrier's; without it those of each pair of parts are positive semidefinite.
        """
        near = self.at(x)
        key = curved, self.coverings, self.history
        known = near.second.get(curved)
        if known is None or known[0] != key:
            known = near.second[curved] = key, self._second_derivatives(near, curved)
        return known[1]

    def _second_derivatives(self, near: Encounter, curved: bool) -> tuple[np.ndarray, np.ndarray]:
        n = len(near.x)
        single, coupled = np.zeros((n, DIAGONAL)), np.zeros((len(self.pairs), FULL))
        if near.near:
            matrix = near.hessian(curved)
            counts = np.diff(matrix.indptr)
            # Of the columns, by far most are empty: nodes that nothing is near to.
            filled = np.flatnonzero(counts)
            rows, cols = matrix.indices, np.repeat(filled, counts[filled])
            self._add(single, coupled, rows // 3, cols // 3, rows % 3, cols % 3, matrix.data)
        if len(self.history.offsets):
            self._add_friction(near.x, single, coupled)
        return single, coupled

    def _add_friction(self, x: np.ndarray, single: np.ndarray, coupled: np.ndarray) -> None:
        pairs, values = self.history.touching, self.values
        blocks = self.history.hessians(x, values.friction, values.slip)
        shares = np.einsum("mi,mj->mij", pairs.shares, pairs.shares)
        entries = shares[:, :, :, None, None] * blocks[:, None, None]
        m, i, j, a, b = np.indices(entries.shape).reshape(5, -1)
        self._add(single, coupled, pairs.nodes[m, i], pairs.nodes[m, j], a, b, entries.ravel())

    def _add(
        self,
        single: np.ndarray,
        coupled: np.ndarray,
        row: np.ndarray,
        col: np.ndarray,
        a: np.ndarray,
        b: np.ndarray,
        values: np.ndarray,
    ) -> None:
        """Add entries of rows and columns of nodes, with their components a and b."""
        own = (row == col) & (a <= b)
        _add_at(single, row[own], VOIGT[a[own], b[own]], values[own])
        above = (row < col) & (values != 0.0)
        keys = row[above] * np.int64(len(self.surface.flat)) + col[above]
        at, known = self._places(keys)
        _add_at(coupled, at[known], (3 * a[above] + b[above])[known], values[above][known])


def _add_at(table: np.ndarray, row: np.ndarray, column: np.ndarray, values: np.ndarray) -> None:
    """Add values (m,) to entries of a table (n, k), one after the other where they meet."""
    table += np.bincount(row * table.shape[1] + column, values, table.size).reshape(table.shape)
