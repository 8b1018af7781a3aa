"""Cloth on one mesh as a problem of finite elements: membrane, bending, weight and contact, with positions unknown."""

# More than 15 modules: the parts of cloth, each in a module of its own, make one problem here.

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import cached_property
from typing import Protocol

import numpy as np

from restshape.algebra.operator import Block
from restshape.algebra.reuse.traits import Traits
from restshape.fem.assembled import Assembled
from restshape.fem.integral import Integral, Term
from restshape.fem.observer import Observer
from restshape.fem.problem import INTERNAL, STIFFNESS, Fields, SteadyProblem, Unknown
from restshape.mesh.mesh import Mesh
from restshape.mesh.morley import MorleySpace
from restshape.physics.cloth.cloth_quantities import observer
from restshape.physics.cloth.contact.collision_surface import CollisionSurface
from restshape.physics.cloth.contact.contact import Contact
from restshape.physics.cloth.free_pieces import falling_pieces, why_it_falls
from restshape.physics.cloth.point_forces import PointForces, TriangleForces
from restshape.physics.cloth.seams.seam_bending import SeamBending
from restshape.physics.cloth.seams.seams import SeamForces, Seams
from restshape.physics.cloth.self_contact.layer_order import LayerOrder, Layers
from restshape.physics.cloth.self_contact.self_contact import SelfContact
from restshape.physics.cloth.self_contact.self_forces import SelfCoupling, SelfForces, coupled_nodes
from restshape.physics.cloth.sheet.bending import QUADRATIC, bending_of
from restshape.physics.cloth.sheet.cloth_boundary import ClothDirichlet, ClothSupports
from restshape.physics.cloth.sheet.cloth_error_estimate import ClothEstimate
from restshape.physics.cloth.sheet.fabric import Fabric
from restshape.physics.cloth.sheet.material_motion import MaterialPlace
from restshape.physics.cloth.sheet.membrane import Membrane
from restshape.physics.cloth.sheet.parameters import Lumped, lumped_rates, triangle_rates
from restshape.physics.cloth.sheet.sheet_forces import SheetForces
from restshape.scene.model import Quantity
from restshape.scene.plan import Plan


class Obstacle(Protocol):
    """What cloth must not pass."""

    def step_share(self, x: np.ndarray, d: np.ndarray) -> float:
        """The largest share, in (0, 1], of a step d (corners, 3) from x (corners, 3) [m] that lets nothing pass."""


# More than 15 attributes: a problem holds what its integrals, contact and quantities share.
class ClothProblem(SteadyProblem):
    """Cloth in space, with three unknowns a node.

    With one history of friction all of it is the gradient of a potential.

    Args:
        mesh: kept by reference; its nodes may move.
        fabric: stiffness and mass.
        supports: where it is constrained.
        g: (3,) acceleration [m/s^2].
        contact: with bodies, over the nodes of the mesh; None: nothing touches.

    Attributes:
        morley: the space of Morley's triangles; None where the nodes are those of the mesh.
        corner_number: (corners,) node of each node of the mesh.
        place: where the nodes were in the material at the last `update`.
        boundary: prescribed unknowns; lumped: areas and masses of the nodes.
        softness: part of the membrane's stiffness that there is.
        falling: names of pieces that `falls` has found to fall.
        seams: what sews edges together; None: nothing does. seam_bending: across those that are sewn flat.
        self_contact: of the cloth with itself; None: it passes through itself.
        order: which panels lie outside of which; None: there are no layers.

    Source: docs/theory/cloth.md.
    """

    name = "drape"
    unknowns = (Unknown("position", "m", ("x", "y", "z")),)
    cell_scalars = ("tension",)
    symmetric, definite, linear, rigid_motions = True, True, False, True

    def __init__(
        self, mesh: Mesh, fabric: Fabric, supports: ClothSupports, g: np.ndarray, contact: Contact | None = None
    ) -> None:
        self.mesh, self.contact = mesh, contact
        self.self_contact: SelfContact | None = None
        self.seams: Seams | None = None
        self.falling: tuple[str, ...] = ()
        self.seam_bending: SeamBending | None = None
        self.order: LayerOrder | None = None
        self.morley = MorleySpace(mesh) if fabric.kind == "morley" else None
        nodes = np.arange(len(mesh.X), dtype=np.int32)
        self.corner_number = self.morley.corner_number if self.morley else nodes
        # Of one rank the corners are the first nodes.
        self._first = np.array_equal(self.corner_number, nodes)
        # A copy, as the place is: flips change the mesh's own.
        self.membrane = Membrane(fabric.law, self.morley.corners if self.morley else mesh.cells.copy())
        self.bending = bending_of(fabric, mesh, self.morley, supports, block=2)
        self._sheet = SheetForces(self.membrane, self.bending) if SheetForces.serves(self.membrane) else None
        self.softness, self._weight, self._changes = 1.0, 1.0, 0
        self.set_values(fabric, supports, g)

    @property
    def space(self) -> MorleySpace | Mesh:
        """Nodes and cells of the unknowns."""
        return self.morley or self.mesh

    @cached_property
    def surface(self) -> CollisionSurface:
        """The triangles as what may cross itself, at the places of their corners when it is first asked for."""
        return CollisionSurface(self.mesh.X, self.mesh.cells)

    @property
    def X(self) -> np.ndarray:
        """Material coordinates (n, 2) [m] of the nodes, corners and, of Morley's triangles, edges."""
        return self.place.X

    @property
    def n_nodes(self) -> int:
        """Number of nodes, of corners and edges."""
        return len(self.X)

    @property
    def version(self) -> tuple[object, ...]:
        """Another one whenever forces or tangent may be others at the same positions."""
        return self._changes, *(part.history for part in (self.contact, self.self_contact) if part)

    @property
    def coverings(self) -> int:
        """Another one whenever contact of the cloth with itself, or seams, may couple other nodes."""
        sewn = sum(part.changes for part in (self.seams, self.seam_bending) if part)
        return (self.self_contact.coverings if self.self_contact else 0) + sewn

    @property
    def stiffness_version(self) -> int:
        """Another one whenever stiffness, mass or supports may be others; contact does not count."""
        return self._changes

    @property
    def varies(self) -> bool:
        """Whether `update` has anything to do when nodes move."""
        return True

    @property
    def stiffest(self) -> float:
        """The largest tension [N/m] by strain."""
        return float(self.fabric.membrane.max())

    @property
    def size(self) -> float:
        """The longer side of the box around the flat cloth [m], or of the largest of those around its panels."""
        return self.place.size

    @property
    def swing_time(self) -> float:
        """The time [s] that the cloth's motion is measured by.

        That of a pendulum as long as the cloth, without 2 pi; without weight that of a wave along it, and 1 s without
        mass too.
        """
        if self.g.any():
            return float(np.sqrt(self.size / np.linalg.norm(self.g)))
        density = float(np.max(self.fabric.density))
        return self.size * float(np.sqrt(density / self.stiffest)) or 1.0

    @property
    def loaded_inside(self) -> bool:
        """Whether it has weight, or bodies push: there are no other loads."""
        return bool(np.any(self.g)) or self.contact is not None

    @property
    def quadratic_bending(self) -> bool:
        """Whether the bending stiffness is the same at all positions, or there is none of another kind."""
        return self.fabric.kind in QUADRATIC

    # --- values ---------------------------------------------------------------------------------------------------

    def set_values(self, fabric: Fabric, supports: ClothSupports, g: np.ndarray) -> None:
        """Take fabric of the same kind, supports and acceleration (3,) [m/s^2], and the mesh as it lies now."""
        self.fabric, self.supports, self.g = fabric, supports, np.asarray(g, float)
        self.update()

    def update(self) -> None:
        """Take in where the nodes of the mesh are now."""
        mesh, morley = self.mesh, self.morley
        if morley:
            morley.place()
        self.place = MaterialPlace.of(mesh, morley, self.fabric.frames)
        density = np.broadcast_to(self.fabric.density, len(mesh.cells))
        self.boundary = ClothDirichlet(self.supports, mesh, self.corner_number, len(self.X), morley)
        self.lumped = Lumped.of(self.X, self.membrane.corners, density, self.g * self.boundary.free)
        self.soften(self.softness)
        if self.seams:
            self._place_seams(self.seams)
        if self.self_contact:
            self.self_contact.place(mesh.X)
        if self.bending:
            self.bending.update(self.fabric, self.supports)

    def soften(self, part: float) -> None:
        """Give the membrane a part of its stiffness, or 1 for all of it; weight and bending stay."""
        self.softness, self._changes = part, self._changes + 1
        self.membrane.update(self.fabric, self.lumped.density, self._weight * self.g, part)

    def sew(self, seams: Seams) -> None:
        """Have seams from now on; those that are sewn flat bend where anything does."""
        self.seams = seams
        if self.bending and seams.flat_lines:
            self.seam_bending = SeamBending(seams, self.mesh, self.morley)
        self._place_seams(seams)

    def _place_seams(self, seams: Seams) -> None:
        """Let seams join what they join where the nodes are now: neighbours across them touch no more than others."""
        seams.place(self.mesh.X)
        if self.seam_bending:
            self.seam_bending.place(self.fabric)
        if self.surface.sew(*seams.sewing()) and self.self_contact:
            self.self_contact.set_values(self.self_contact.values)

    def pull_seams(self, part: float) -> None:
        """Give seams a part of their stiffness, or 1 for all of it."""
        self.seams.pull, self._changes = part, self._changes + 1

    @contextmanager
    def lightened(self, part: float) -> Iterator[None]:
        """Within it the cloth has a part of its weight; what residuals are measured against stays."""
        self._weight = part
        try:
            self.soften(self.softness)
            yield
        finally:
            self._weight = 1.0
            self.soften(self.softness)

    @contextmanager
    def stiffened(self, share: float) -> Iterator[None]:
        """Within it the cloth bends like a plate of its membrane that is a share of its size thick, at least."""
        fabric, changes = self.fabric, self._changes
        thick = fabric.membrane * (share * self.size) ** 2 / 12.0
        softer = np.trace(fabric.bending, axis1=-2, axis2=-1) < np.trace(thick, axis1=-2, axis2=-1)
        self.fabric = replace(fabric, bending=np.where(np.asarray(softer)[..., None, None], thick, fabric.bending))
        try:
            self._changes += 1
            if self.bending:
                self.bending.update(self.fabric, self.supports)
            yield
        finally:
            # What has changed within keeps its version: steps were made there with the stiff sheet.
            self.fabric, self._changes = fabric, changes if self._changes == changes + 1 else self._changes + 1
            if self.bending:
                self.bending.update(fabric, self.supports)

    # --- unknowns -------------------------------------------------------------------------------------------------

    def flat(self, corners: np.ndarray) -> np.ndarray:
        """Unknowns (n, 3) of flat triangles between corners (corners, 3) [m], prescribed ones as they are given."""
        return self.constrain(self.morley.spanned(corners) if self.morley else corners.copy())

    def constrain(self, x: np.ndarray) -> np.ndarray:
        """Unknowns x (n, 3), prescribed ones as they are given."""
        return np.where(self.boundary.mask, self.boundary.values, x)

    def corners(self, x: np.ndarray) -> np.ndarray:
        """Positions (corners, 3) [m] of the mesh's nodes, a copy."""
        return x[: len(self.corner_number)].copy() if self._first else x[self.corner_number]

    def update_friction(self, x: np.ndarray, moving: bool = False) -> float:
        """Let friction, and the points that touch, follow to x (n, 3); returns the largest slip distance [m].

        Where the cloth is `moving`, points follow once it has gone some way.
        """
        corners = self.corners(x)
        slid = self.self_contact.update_friction(corners) if self.self_contact else 0.0
        if not self.contact:
            return slid
        self.contact.cut(corners, moving)
        return max(slid, self.contact.update_friction(self.contact.place(corners)))

    def begin_frame(self, x: np.ndarray) -> None:
        """Let friction act against the way of a frame from x (n, 3) [m] until `end_frame`."""
        for part in filter(None, (self.contact, self.self_contact)):
            part.begin_frame(self.corners(x))

    def end_frame(self, x: np.ndarray) -> float:
        """Let friction follow to x (n, 3) [m], where a frame has led; returns how far [m]. Forces stay as they are."""
        parts = filter(None, (self.contact, self.self_contact))
        return max((part.end_frame(self.corners(x)) for part in parts), default=0.0)

    def next_part(self, x: np.ndarray) -> None:
        """Let another frame begin at x (n, 3) [m] for friction that acts in one: its way until there is over."""
        for part in filter(None, (self.contact, self.self_contact)):
            if part.history.begin:
                part.end_frame(self.corners(x))
                part.begin_frame(self.corners(x))

    @property
    def frame_begun(self) -> bool:
        """Whether friction acts against the way of a frame."""
        return any(part.history.begin for part in filter(None, (self.contact, self.self_contact)))

    def follow_friction(self, x: np.ndarray) -> bool:
        """Let friction follow to x (n, 3); returns whether there is contact, whose energy it changes."""
        self.update_friction(x, moving=True)
        return self.contact is not None or (self.self_contact is not None and self.self_contact.rough)

    def begin(self, x: np.ndarray) -> bool:
        """Begin at x (n, 3), across itself or not; returns whether contact with itself acts, or there is none."""
        return self.self_contact is None or self.self_contact.begin(self.corners(x))

    def cover(self, x: np.ndarray) -> None:
        """Let what the blocks hold be all that contact of the cloth with itself couples at x (n, 3)."""
        if self.self_contact:
            self.self_contact.cover(self.corners(x))

    def falls(self, x: np.ndarray) -> bool:
        """Whether cloth at x (n, 3), or a piece of it, falls without end: `falling` names it then."""
        self.falling = falling_pieces(self, self.corners(x))
        return bool(self.falling)

    @property
    def why_it_falls(self) -> str:
        """Why cloth that `falls` does not converge."""
        return why_it_falls(self.falling, len(self.mesh.outline.piece_names))

    def step_share(self, x: np.ndarray, d: np.ndarray) -> float:
        """The largest share, in (0, 1], of a step d (n, 3) [m] from x (n, 3) [m] that lets nothing pass."""
        corners, way, share = self.corners(x), self.corners(d), 1.0
        for part in self.obstacles:
            # The next one needs to look at what is left of the step alone.
            share *= part.step_share(corners, share * way)
        return share

    @property
    def ordered_layers(self) -> Layers | None:
        """The cloth as layers that have an order; None where they have none."""
        bodies = self.contact.bodies if self.contact else ()
        return Layers(self.order, self.surface, bodies) if self.order else None

    @property
    def obstacles(self) -> Sequence[Obstacle]:
        """What corners must not pass."""
        return [part for part in (self.contact, self.self_contact) if part]

    # --- integrals ------------------------------------------------------------------------------------------------

    def blocks(self) -> list[Block]:
        """Nodes of what has a tangent: membrane, points, bending, seams, and pairs that contact with itself couples."""
        bent = self.bending.blocks() if self.bending else []
        sewn = [(part.own_nodes, part.dofs) for part in self._seam_parts]
        pairs = [coupled_nodes(self.self_contact, self.corner_number)] if self.self_contact else []
        return [self.membrane.corners, np.ascontiguousarray(self.corner_number[:, None]), *bent, *sewn, *pairs]

    def integrals(self, kind: str, part: float = 1.0) -> Sequence[Term]:
        """The integrals of a kind, see `fem.problem`; no load has steps."""
        if kind == STIFFNESS:
            return [self.membrane.integral(self.X, weighs=False), *self.bending_integrals(), *self.seam_integrals()]
        if kind != INTERNAL:
            return []
        return [self.membrane.integral(self.X), *self.bending_integrals(), *self.seam_integrals(), *self._contact()]

    def material_integrals(self) -> list[Term]:
        """Those of the cloth by itself: membrane, weight, bending, seams, and contact with itself."""
        own = self._own_contact()
        return [self.membrane.integral(self.X), *self.bending_integrals(), *self.seam_integrals(), *own]

    def seam_integrals(self) -> list[SeamForces]:
        """Those of seams: springs, and what bends across them."""
        first = self._first_free_block
        return [part.integral(first + k) for k, part in enumerate(self._seam_parts)]

    @property
    def _seam_parts(self) -> list[Seams | SeamBending]:
        return [part for part in (self.seams, self.seam_bending) if part]

    @property
    def _first_free_block(self) -> int:
        """The block of the operator after those of membrane, points and bending."""
        return 2 + len(self.bending.blocks() if self.bending else [])

    def bending_integrals(self) -> list[Integral]:
        """Those of bending."""
        return self.bending.integrals(self.X) if self.bending else []

    def bending_rates(self, x: np.ndarray, dX: np.ndarray, turn: np.ndarray) -> np.ndarray:
        """Rates (n, 3) [N] of what bends at constant x (n, 3), from its parameters alone; see `HingeBending.rates`."""
        return self.bending.rates(self.X, x, dX, turn) if self.bending else np.zeros_like(x)

    def turned_clamps(self, x: np.ndarray, turn: np.ndarray) -> np.ndarray:
        """Rates (n, 3) [N] of what bends at x (n, 3) as all clamps turn with a rate (3,) [rad]."""
        return self.bending.turned_clamps(self.X, x, turn) if self.bending else np.zeros_like(x)

    def tangent_integrals(self, stabilised: bool, inertia: float) -> list[Term]:
        """Those of a tangent but for quadratic bending.

        Args:
            stabilised: without what is compressed, positive semidefinite.
            inertia: [1/s^2] times the mass on the diagonal.
        """
        found: list[Term] = [self.membrane.integral(self.X, stabilised)]
        if self.contact or inertia:
            found += self._points(inertia, curved=not stabilised)
        found += self.seam_integrals()
        found += self._own_contact(curved=not stabilised)
        return found if self.quadratic_bending else found + self.bending_integrals()

    def _contact(self) -> list[Term]:
        return [*(self._points() if self.contact else []), *self._own_contact()]

    def _own_contact(self, curved: bool = True) -> list[Term]:
        """Those of contact with itself."""
        if not self.self_contact:
            return []
        forces = SelfForces(self.X, np.ascontiguousarray(self.corner_number[:, None]), self.self_contact, curved)
        if not len(self.self_contact.pairs):
            return [forces]
        return [forces, SelfCoupling(forces, self._first_free_block + len(self._seam_parts))]

    def _points(self, inertia: float = 0.0, curved: bool = True) -> list[PointForces | TriangleForces]:
        numbers, contact = self.corner_number, self.contact
        entities = np.ascontiguousarray(numbers[:, None])
        mass = self.lumped.mass[numbers]
        nodes = PointForces(self.X, entities, contact, mass, self.area_rates, inertia, curved)
        if not (contact and contact.points and len(contact.points.cut)):
            return [nodes]
        return [nodes, self._triangles(contact, curved)]

    def _triangles(self, contact: Contact, curved: bool = True) -> TriangleForces:
        entities = np.ascontiguousarray(self.corner_number[:, None])
        return TriangleForces(self.X, entities, contact, self.area_rates, curved)

    def area_rates(self, dX: np.ndarray) -> np.ndarray:
        """Rates (corners + points,) of the areas that both stand for when nodes move with dX (n, 2)."""
        corners = self.membrane.corners
        triangles = triangle_rates(self.X, corners, dX)
        rates = lumped_rates(corners, triangles, len(self.X))[self.corner_number]
        points = self.contact.points
        return rates if points is None else points.areas(rates, triangles)

    # --- energies and forces --------------------------------------------------------------------------------------

    def energy(self, x: np.ndarray) -> float:
        """Potential energy [J] at x (n, 3), of weight too."""
        if self._sheet:
            total = self._sheet.at(self.X, x, self._changes)[0]
        else:
            total = Assembled([self.membrane.integral(self.X)]).energy(x) + self.bending_energy(x)
        return total + self.seam_energy(x) + self._contact_energy(x)

    def _contact_energy(self, x: np.ndarray) -> float:
        """Energy [J] of contact at x (n, 3), with bodies and of the cloth with itself."""
        corners, contact, own = self.corners(x), self.contact, self.self_contact
        energy = contact.energy(contact.place(corners)) if contact else 0.0
        return energy + own.energy(corners) if own else energy

    def seam_energy(self, x: np.ndarray) -> float:
        """Energy [J] of seams at x (n, 3), of bending across them too."""
        return Assembled(self.seam_integrals()).energy(x)

    def bending_energy(self, x: np.ndarray) -> float:
        """Energy [J] of bending at x (n, 3)."""
        return Assembled(self.bending_integrals()).energy(x)

    def bending_energies(self, x: np.ndarray) -> np.ndarray:
        """Energy (ne,) [J] of bending of each triangle at x (n, 3)."""
        return self.bending.cell_energies(self.X, x) if self.bending else np.zeros(len(self.mesh.cells))

    def membrane_energy(self, x: np.ndarray) -> float:
        """Energy [J] of stretching at x (n, 3)."""
        return Assembled([self.membrane.integral(self.X, weighs=False)]).energy(x)

    def tensions(self, x: np.ndarray) -> np.ndarray:
        """Second Piola-Kirchhoff tensions (ne, 3) xx, yy, xy [N/m] of the triangles at x (n, 3)."""
        return self.membrane.tensions(self.X, x)

    def residual(self, x: np.ndarray, out: np.ndarray) -> None:
        """Set `out` (n, 3) [N] to the residual at x (n, 3), 0 where prescribed."""
        self.unconstrained_residual(x, out)
        out *= self.boundary.free

    def unconstrained_residual(self, x: np.ndarray, out: np.ndarray) -> None:
        """Set `out` (n, 3) [N] to the residual at x (n, 3) without supports: their reactions where they constrain."""
        self.internal_forces(x, out)
        self._add_contact(x, out)

    def _add_contact(self, x: np.ndarray, out: np.ndarray) -> None:
        """Add to `out` (n, 3) [N] the forces of contact at x (n, 3), with bodies and of the cloth with itself."""
        corners, contact, own = self.corners(x), self.contact, self.self_contact
        if contact:
            forces = contact.forces(contact.place(corners))
            self._add_at_corners(forces[: len(corners)], out)
            if len(forces) > len(corners):
                self._triangles(contact).spread(forces[len(corners) :], out)
        if own:
            self._add_at_corners(own.forces(corners), out)

    def _add_at_corners(self, forces: np.ndarray, out: np.ndarray) -> None:
        """Add forces (corners, 3) to those `out` (n, 3) of the nodes."""
        if self._first:
            out[: len(forces)] += forces
        else:
            out[self.corner_number] += forces

    def bending_forces(self, x: np.ndarray, out: np.ndarray) -> None:
        """Set `out` (n, 3) [N] to the forces of bending alone."""
        if self._sheet:
            self._sheet.bend(self.X, x, self._changes, out)
            return
        out[:] = 0.0
        Assembled(self.bending_integrals()).residual(x, out)

    def internal_forces(self, x: np.ndarray, out: np.ndarray) -> None:
        """Set `out` (n, 3) [N] to the forces of membrane, bending, weight and seams, also where prescribed."""
        own: list[Term] = []
        if self._sheet:
            out[:] = self._sheet.at(self.X, x, self._changes)[1]
        else:
            out[:], own = 0.0, [self.membrane.integral(self.X), *self.bending_integrals()]
        Assembled([*own, *self.seam_integrals()]).residual(x, out)

    # --- what is shown --------------------------------------------------------------------------------------------

    def fields(self, x: np.ndarray) -> Fields:
        """Displacement [m] of the nodes from the flat pattern, larger principal tension [N/m] of the cells."""
        xx, yy, xy = self.tensions(x).T
        tension = 0.5 * (xx + yy) + np.hypot(0.5 * (xx - yy), xy)
        flat = np.column_stack([self.mesh.X, np.zeros(len(self.mesh.X))])
        return {"displacement": self.corners(x) - flat}, {"tension": tension}

    def observer(self, quantities: Mapping[str, Quantity]) -> Observer:
        """What evaluates quantities of positions x (n, 3) [m].

        Raises:
            UserError: a quantity has no meaning for cloth, or names a place that is not there.
        """
        return observer(self, quantities)

    def error_estimate(self) -> ClothEstimate:
        """The recovery-based estimate of tensions and moments in the energy norm."""
        return ClothEstimate(self)

    @staticmethod
    def traits(plan: Plan) -> Traits:
        """What it declares of its linear systems, under any plan."""
        return Traits(fields=3, dimension=3, sheet=True, rigid_motions=ClothProblem.rigid_motions)

    @staticmethod
    def blank_fields(space: Mesh) -> Fields:
        """The same fields, all NaN, on a mesh that has not been solved on."""
        return {"displacement": np.full((len(space.X), 3), np.nan)}, {"tension": np.full(len(space.cells), np.nan)}
