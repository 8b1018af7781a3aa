"""The mesh of a shape under edit: relocated, reconnected or reconstructed from frame to frame."""

# More than 15 modules: relocation, flips, nesting and remeshing meet here, and know nothing of each other.

import itertools
import logging
from collections.abc import Callable
from dataclasses import replace
from time import perf_counter

import numpy as np

from restshape import _kernels
from restshape.errors import ReplayProblem, UserError
from restshape.first_use import made
from restshape.memory import give_back
from restshape.mesh.advance import CONNECTIVITY, NO_CELLS, MeshUpdate
from restshape.mesh.generate import Shared, alone, generate
from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.mesh.mesh import Mesh
from restshape.mesh.mesh_area import MeshArea
from restshape.mesh.moved_meshes import OtherMesh, compared_meshes
from restshape.mesh.moving_state import Generated, GestureMap, Kept, KeptMesh, MovingState
from restshape.mesh.nested import NestedMesh
from restshape.mesh.quality import areas, thresholds
from restshape.mesh.reach import MovingPart, moving_part, reaching_motion
from restshape.mesh.relocate import BoundaryNodes, Harmonic, HarmonicExtension, extension, motion
from restshape.mesh.sizing import FEWEST_PER_CIRCLE, PER_CIRCLE, refuse_endless, refuse_growth
from restshape.outputs.si_numbers import counted
from restshape.scene.model import MeshSpec, Scene
from restshape.shape.hand.gesture import Gesture
from restshape.shape.outline import Outline
from restshape.shape.session import EditFrame

log = logging.getLogger("restshape.mesh")

SWEEPS = 2
"""Spring sweeps a frame: even, so that they do not swing (thesis, 4.2.3)."""

ROUNDS = 2
"""Flips, each with a relocation, while triangles are of low quality: springs pull better after flips."""

FRESH_SHARE = 0.75
"""A mesh counts as of low quality only below this share of its quality when new: else an awkward shape would be
remeshed in every frame."""

FRESH_AREA = 0.01
"""A triangle counts as invalid only below this share of the smallest area when new: sizes may differ by much."""


REASONS = {
    "start": "the first shape",
    "move": "the policy makes a new mesh of each shape",
    "shape": "another layout of the shape",
    "values": "elements of another order",
    "none": "elements of another order",
}
"""Why there is a new mesh after a change of that kind, for the log."""

NO_TRIANGLES = np.empty((0, 3), dtype=np.int32)

IDLE = {
    "refused": "the edit is refused",
    "none": "the shape stays as it is",
    "values": "values change, and the shape stays as it is",
    "move": "the hand is where it was",
}
"""Why a frame with that kind of change leaves the mesh as it is, for the log."""

# Versions after flips count downwards, so that they never meet those of generated meshes.
_reconnections = itertools.count(-2, -1)
"""Topologies of reconnected meshes; -1 stands for none."""


class MovingMesh:
    """Keeps a mesh on a shape that is being edited, with as little change as its quality allows.

    Positions, and cells after flips, change in the arrays of ``mesh`` and ``space``; a reconstruction replaces them.

    Of second order ``space`` holds the nodes, else it is None. A triangle with a curved side that fails the bound on
    its Jacobian counts as invalid. Of more than one level, of first order, ``nested`` holds the meshes, of which
    ``mesh`` is the coarsest, made so coarse that the finest has the size that is asked for.

    Args:
        outline: the first shape.
        spec: how fine, of which relocation and criterion.
        ranks: number of parts that the nodes are numbered by.
        regenerate: a new mesh in every frame that moves.
        shared: how ranks share the making of a mesh (`restshape.mesh.generate`).
        relocation, criterion: instead of the spec's.
        flip_everywhere: level 2 makes the whole mesh Delaunay, as in the thesis; otherwise it begins at low-quality
            triangles, so that an old factor still fits.
        imported: a mesh of the first shape, used instead of generating one.
        order_of: the order of a scene's elements, asked once a scene; by default what its `mesh.order` says.
        harmonic: makes harmonic maps, which ranks may share.

    Source: docs/theory/levels-of-reuse.md.
    """

    def __init__(
        self,
        outline: Outline,
        spec: MeshSpec,
        ranks: int = 1,
        *,
        regenerate: bool = False,
        shared: Shared = alone,
        relocation: str | None = None,
        criterion: str | None = None,
        flip_everywhere: bool = False,
        imported: Mesh | None = None,
        order_of: Callable[[Scene], int] = lambda scene: scene.mesh.order or 1,
        harmonic: Harmonic = HarmonicExtension,
    ) -> None:
        self.outline, self.ranks, self.regenerate = outline, ranks, regenerate
        self._shared = shared
        self._chosen_relocation, self._chosen_criterion, self._imported = relocation, criterion, imported
        self._flip_everywhere = flip_everywhere
        self._order_of, self._harmonic = order_of, harmonic
        self.state = MovingState(spec)
        self._kept: Kept | None = None
        self._area = MeshArea()

    @property
    def spec(self) -> MeshSpec:
        """How fine the mesh is, of which relocation and criterion."""
        return self.state.spec

    @property
    def mesh(self) -> Mesh:
        """The mesh, of nested ones the coarsest.

        Raises:
            RuntimeError: there is none before the first frame.
        """
        return made(self.state.generated).mesh

    @property
    def space(self) -> LagrangeSpace | None:
        """Nodes of second order over the mesh; None of first order."""
        return made(self.state.generated).space

    @property
    def nested(self) -> NestedMesh | None:
        """The nested meshes; None where there is one level."""
        return self.state.nested

    @property
    def order(self) -> int:
        """Of the elements."""
        return self.state.order

    @property
    def min_quality(self) -> float:
        """Smallest quality of a triangle."""
        return self.state.min_quality

    @property
    def relocation(self) -> str:
        """Kind of relocation in force, one of `relocate.KINDS`."""
        return self._chosen_relocation or self.spec.relocation

    @property
    def gesture(self) -> Gesture | None:
        """The gesture that the map belongs to."""
        return None if self.state.map is None else self.state.map.gesture

    @property
    def dim(self) -> int:
        """Dimension of the cells of the mesh.

        Raises:
            RuntimeError: there is none before the first frame.
        """
        return self.mesh.dim

    @property
    def field_mesh(self) -> Mesh | LagrangeSpace:
        """What fields live on: the mesh, the finest of those nested in it, or the nodes of second order over it."""
        state = self.state
        if state.nested:
            return state.nested.finest
        generated = state.generated or made(state.generated)
        return generated.space or generated.mesh

    def area(self) -> float:
        """Area of `field_mesh` [m^2], curved edges as they are; of solids in space that of the plane mesh."""
        return self._area(self.field_mesh)

    def solved(self) -> None:
        """Take note that `field_mesh` was solved on: what flips have done to its nodes is in the solution."""
        generated = self.state.generated or made(self.state.generated)
        if generated.space and generated.space.interpolations:
            generated.space.interpolations = ()

    def other_meshes(self, old: Mesh | LagrangeSpace | None) -> tuple[OtherMesh, ...]:
        """The mesh beside which the last update's flips, or new mesh, are seen; the best comparison first.

        Args:
            old: of the update.
        """
        kept = self._kept
        if kept is None or kept.versions is None or self.nested:
            return ()
        return compared_meshes(self._generated, kept, old)

    @property
    def Psi(self) -> np.ndarray:
        """Displacements (2, n, d) of the nodes of `mesh` a unit of the gesture's coefficients; made on demand.

        Source: docs/theory/moving-the-mesh.md.
        """
        known = made(self.state.map)
        if known.Psi is not None:
            return known.Psi
        basis = None if known.gesture is None else known.gesture.basis
        if self.space:
            self.space.set_gesture(basis)
        if basis is None:
            Psi = np.zeros((2, *self.mesh.X.shape))
        else:
            boundary = self._boundary
            moved, reach = boundary.basis(self.mesh.outline, basis), self.reach
            if reach is not None:
                known = replace(known, part=self._part_within(reach, moved))
            elif self.spec.reach is not None:
                log.info("Reach %g m: all nodes move, for springs relax them", self.spec.reach)
            if known.part is None:
                Psi = motion(self.mesh, moved, self.relocation, boundary.nodes, self._harmonic)
            else:
                Psi = reaching_motion(self.mesh, moved, known.part, boundary)
        self.state = replace(self.state, map=replace(known, Psi=Psi))
        return Psi

    @property
    def reach(self) -> float | None:
        """The distance [m] within which nodes follow what the hand holds; None: all of them do."""
        return self.spec.reach if self.relocation == "harmonic" else None

    @property
    def part(self) -> MovingPart | None:
        """What alone moves in the gesture in force; None: everything."""
        return None if self.state.map is None else self.state.map.part

    @property
    def _condensed(self) -> MovingPart | None:
        """The same, where it is worth being solved for by itself."""
        part = self.part
        return part if part is not None and part.condensed and not self.nested else None

    def _part_within(self, reach: float, moved: np.ndarray) -> MovingPart:
        """What moves with the displacements (2, nb, d) of the nodes on the outline."""
        generated, boundary = self._generated, self._boundary
        moves = boundary.nodes[moved.any(axis=(0, 2))]
        floors = generated.area_floor, generated.quality_floor
        part = moving_part(self.mesh, moves, boundary.nodes, reach, floors)
        moving = f"{counted(len(part.nodes), 'node')} of {len(self.mesh.X)} ({100 * part.share:.3g} %)"
        log.info("Reach %g m: %s move%s", reach, moving, "" if part.condensed else ": the whole is solved for")
        return part

    @property
    def field_motion(self) -> np.ndarray:
        """The same as `Psi` for the nodes of `field_mesh`."""
        if self.nested:
            return self.nested.motion(self.Psi, None if self.gesture is None else self.gesture.basis)
        return self.space.motion(self.Psi) if self.space else self.Psi

    @property
    def linear_motion(self) -> np.ndarray | None:
        """The same; None where springs relax the nodes, which then do not follow the hand linearly."""
        return None if self.relocation == "laplacian" else self.field_motion

    @property
    def _generated(self) -> Generated:
        return made(self.state.generated)

    @property
    def _boundary(self) -> BoundaryNodes:
        return self._generated.boundary

    def update(self, frame: EditFrame) -> MeshUpdate:
        """What the frame did to the mesh, which now lies on the frame's outline.

        Raises:
            ReplayProblem: no valid mesh for the frame; all is as before it.
            UserError: mesh sizes at entities that are not there; all is as before it.
        """
        self._keep()
        try:
            return self._update(frame)
        except (ReplayProblem, UserError):
            self.rollback()
            raise

    def rollback(self) -> None:
        """Lay the mesh as it was before the last frame, which has no solution."""
        kept = self._kept
        if kept is None:
            return
        self.state = kept.state
        if kept.versions is None:
            return
        mesh = self.mesh
        mesh.outline, mesh.geometry, mesh.topology = kept.versions
        if kept.X is not None:
            mesh.X[...] = kept.X
        if kept.connectivity is not None:
            for name, values in kept.connectivity.items():
                getattr(mesh, name)[...] = values
            # Others may have seen the flips; and what flips edges knows them, so that it is made again.
            mesh.topology = next(_reconnections)
            self.state = replace(self.state, generated=replace(self._generated))
            if self.space:
                self.space.rebuild()
        if kept.X is not None and self.space:
            self.space.rollback()
        if kept.X is not None and self.nested:
            self.nested.follow()

    def kept_mesh(self) -> KeptMesh | None:
        """The mesh as it lies, to return to it later; None where it cannot be, as of second order."""
        return KeptMesh.of(self.state)

    def return_to(self, kept: KeptMesh, outline: Outline) -> MeshUpdate:
        """Lay the mesh as it lay in an earlier frame of the same outline; what that did."""
        self._keep()
        if kept.lies(self.state):
            self.state = replace(self.state, scene=kept.state.scene, order=kept.state.order, spec=kept.state.spec)
            return MeshUpdate.nothing(self.min_quality)
        old, before = self._generated.mesh, made(self._kept)
        mesh = made(kept.state.generated).mesh
        stays = mesh is old and mesh.topology == kept.topology
        before.X = old.X.copy()
        before.connectivity = None if stays else {name: getattr(old, name).copy() for name in CONNECTIVITY}
        former = None if stays else self._former()
        mesh.X[...] = kept.X
        mesh.outline, mesh.geometry = outline, mesh.geometry + 1
        self.state = kept.state
        if mesh.topology != kept.topology:
            for name, values in kept.connectivity.items():
                getattr(mesh, name)[...] = values
            mesh.topology = next(_reconnections)
            self.state = replace(self.state, generated=replace(made(kept.state.generated)))
        self._set_reference(None, (0.0, 0.0))
        if self.nested:
            self.nested.follow()
        return MeshUpdate(1 if stays else 3, 0, NO_CELLS, self.min_quality, former)

    def _keep(self) -> None:
        """Note what `rollback` restores; nodes and connectivity are copied when they are about to change."""
        generated = self.state.generated
        if generated is None:
            self._kept = Kept(self.state, None)
            return
        mesh = generated.mesh
        if generated.space:
            generated.space.begin()
        self._kept = Kept(self.state, (mesh.outline, mesh.geometry, mesh.topology))

    def _update(self, frame: EditFrame) -> MeshUpdate:
        order = self.state.order
        if frame.scene is not self.state.scene:
            self.state = replace(self.state, scene=frame.scene, order=self._order_of(frame.scene))
        if frame.refused is not None or (frame.change in ("none", "values") and self.order == order):
            log.debug(
                "%4d Mesh level 0: %s", frame.index, IDLE["refused" if frame.refused is not None else frame.change]
            )
            return self._rest(frame)
        if frame.change == "move":
            known = self.state.map
            same = known is not None and frame.gesture is known.gesture
            if same and frame.gesture.linear and frame.c == self.state.c:
                log.debug("%4d Mesh level 0: %s", frame.index, IDLE["move"])
                return MeshUpdate.nothing(self.min_quality)
            if not self.regenerate:
                return self._follow(frame)
        else:
            self.state = replace(self.state, spec=frame.scene.mesh)
        return self._reconstruct(frame, {}, REASONS.get(frame.change, "other settings of the mesh"))

    def _rest(self, frame: EditFrame) -> MeshUpdate:
        """A frame in which the shape stays; taking hold makes the map of the gesture that begins."""
        mesh_update = MeshUpdate.nothing(self.min_quality)
        if frame.do in ("press", "pull") and frame.gesture is not None and not self.regenerate:
            self._begin_gesture(frame, mesh_update.stages)
            mesh_update.part = self._condensed
        return mesh_update

    def _follow(self, frame: EditFrame) -> MeshUpdate:
        """Relocate; flip, or reconstruct, where that is not enough."""
        stages: dict[str, float] = {}
        state = self.state
        generated, known = state.generated or made(state.generated), state.map or made(state.map)
        mesh = generated.mesh
        if frame.gesture is not known.gesture or known.Psi is None:
            self._begin_gesture(frame, stages)
        start = perf_counter()
        generated.before[...] = mesh.X
        made(self._kept).X = generated.before
        placement = self._place(frame)
        stages["relocate"] = perf_counter() - start
        flips, changed, why = 0, NO_CELLS, ""
        if placement[1] or placement[2]:
            why = f"{placement[1]} invalid, {placement[2]} low-quality triangles"
            flips, changed, placement = self._mend(frame, placement, stages)
            if flips:
                mesh.topology = next(_reconnections)
            if placement[1]:
                self._restore_positions()
                return self._reconstruct(frame, stages, f"{why}; {placement[1]} invalid after {flips} flips")
        mesh.outline = frame.outline
        mesh.geometry += 1
        if placement[2]:
            return self._reconstruct(frame, stages, f"{why}; {placement[2]} of low quality after {flips} flips")
        if flips:
            log.info(
                "%4d Mesh level 2: %s; %s; least quality %.3g",
                frame.index,
                f"{counted(flips, 'edge')} flipped",
                why,
                placement[0],
            )
        elif log.isEnabledFor(logging.DEBUG):
            reason = "no invalid, no low-quality triangles"
            log.debug("%4d Mesh level 1: nodes relocated; %s; least quality %.3g", frame.index, reason, placement[0])
        self.state = state = self.state.placed(frame.c, placement[0])
        if not state.nested:
            return MeshUpdate(2 if flips else 1, flips, changed, placement[0], None, stages, self._condensed)
        self.nested.stamp()
        old = self._former() if flips else None
        return MeshUpdate(2 if flips else 1, flips, self.nested.cells_in(changed), placement[0], old, stages)

    def _restore_positions(self) -> None:
        """Lay the nodes where the frame before left them."""
        self.mesh.X[...] = self._generated.before
        if self.space:
            self.space.restore_positions()

    def _former(self) -> Mesh | LagrangeSpace:
        """What fields lived on before this frame, where its corners are now if its triangles bear that."""
        kept = made(self._kept)
        nested = kept.state.nested
        if not nested:
            return self.field_mesh
        nested.place(self.mesh.outline)
        if areas(nested.finest.X, nested.finest.cells).min() <= 0.0:
            nested.place(made(kept.versions)[0], kept.X)
        return nested.finest

    def _place(self, frame: EditFrame) -> tuple[float, int, int]:
        """Move the nodes to where the frame wants them; quality, invalid and low-quality triangles there."""
        quality, invalid, low_quality = self._place_corners(frame)
        state = self.state
        if state.nested:
            return quality, invalid + state.nested.place(frame.outline), low_quality
        if not made(state.generated).space:
            return quality, invalid, low_quality
        if frame.gesture.linear:
            start = made(self.state.map).c
            invalid_curved = self.space.place((frame.c[0] - start[0], frame.c[1] - start[1]))
        else:
            self.space.bend(frame.outline)
            invalid_curved = self.space.place()
        return quality, invalid + invalid_curved, low_quality

    def _place_corners(self, frame: EditFrame) -> tuple[float, int, int]:
        """Move the corners; quality, invalid and low-quality triangles there."""
        state = self.state
        generated, known = state.generated or made(state.generated), state.map or made(state.map)
        mesh, Psi, (c0, c1) = generated.mesh, made(known.Psi), frame.c
        if not frame.gesture.linear:
            target = generated.boundary.values(frame.outline, frame.outline.points)
            Psi[0] = made(known.extend)(target - known.reference[generated.boundary.nodes])
            c0, c1 = 1.0, 0.0
        else:
            c0, c1 = c0 - known.c[0], c1 - known.c[1]
        floors = generated.area_floor, generated.quality_floor
        if self.relocation == "laplacian":
            fixed = generated.fixed
            return _kernels.relax_and_check(
                known.reference, Psi, c0, c1, mesh.X, mesh.cells, mesh.edge_nodes, fixed, SWEEPS, *floors
            )
        if known.part is not None:
            _kernels.move_and_check(known.reference, Psi, c0, c1, mesh.X, NO_TRIANGLES, *floors)
            return known.part.check(mesh, *floors)
        return _kernels.move_and_check(known.reference, Psi, c0, c1, mesh.X, mesh.cells, *floors)

    def _mend(
        self, frame: EditFrame, placement: tuple[float, int, int], stages: dict[str, float]
    ) -> tuple[int, np.ndarray, tuple[float, int, int]]:
        """Flips, the cells they changed, and the placement afterwards."""
        start = perf_counter()
        X, flips, changed = self.mesh.X, 0, NO_CELLS
        made(self._kept).connectivity = {name: getattr(self.mesh, name).copy() for name in CONNECTIVITY}
        reconnection = self._generated.reconnection(self.part)
        if placement[1]:
            self._restore_positions()
            flips, changed = reconnection.flip(X)
            if flips:
                self._reconnect(changed)
                placement = self._place(frame)
        for _ in range(ROUNDS):
            if placement[1] or not placement[2]:
                break
            more, cells = reconnection.flip(X, self._generated.flip_floor)
            if not more:
                break
            self._reconnect(cells)
            placement = self._place(frame)
            flips, changed = flips + more, np.union1d(changed, cells) if flips else cells
        stages["flip"] = perf_counter() - start
        return flips, changed, placement

    def _reconnect(self, changed: np.ndarray) -> None:
        """Let finer meshes, and nodes of second order, follow the flips that changed these cells."""
        if self.nested:
            self.state = replace(self.state, nested=self.nested.reconnected())
        if self.space:
            self.space.reconnect(changed)

    def _begin_gesture(self, frame: EditFrame, stages: dict[str, float]) -> None:
        """Take up a gesture: where the nodes lie now becomes its reference, and its map is made."""
        start = perf_counter()
        if frame.gesture is not self.gesture:
            self._set_reference(frame.gesture, (0.0, 0.0))
        if frame.gesture.linear:
            self.Psi  # noqa: B018  made here, so that its time counts as the map's
        else:
            if self.spec.reach is not None:
                log.info("Reach %g m: all nodes move, for an arc bends", self.spec.reach)
            extend = extension(self.mesh, self._boundary.nodes, self.relocation, self._harmonic)
            Psi = np.zeros((2, *self.mesh.X.shape))
            self.state = replace(self.state, map=replace(made(self.state.map), extend=extend, Psi=Psi))
            if self.space:
                self.space.set_gesture(None)
        give_back(len(self.mesh.cells))
        stages["map"] = perf_counter() - start

    def _set_reference(self, gesture: Gesture | None, c: tuple[float, float]) -> None:
        """The nodes as they lie now are the reference of a gesture, at its coefficients c."""
        known, X = self.state.map, self.mesh.X
        # A first gesture takes up the new mesh as it is.
        reference = known.reference if known is not None and np.array_equal(known.reference, X) else X.copy()
        self.state = replace(self.state, map=GestureMap(gesture, reference, c), c=c)
        if self.space:
            self.space.refer()

    def _reconstruct(self, frame: EditFrame, stages: dict[str, float], why: str) -> MeshUpdate:
        """Replace the mesh by a new one of the frame's outline; `why` is for the log."""
        start = perf_counter()
        old = None if frame.change == "start" else self._former()
        gesture, c = (frame.gesture, frame.c) if frame.gesture is not None else (self.gesture, self.state.c)
        if self._imported is not None and frame.change == "start":
            mesh = self._imported
        else:
            if frame.change in ("move", "shape"):
                refuse_growth(frame.outline, self.spec, len(self.field_mesh.cells))
            mesh = self._generate(frame.outline)
        criterion = self._chosen_criterion or self.spec.criterion
        quality_floor, area_floor = thresholds(criterion, self.spec.min_quality, mesh.X, mesh.edge_nodes)
        quality, invalid, _ = _kernels.check_cells(mesh.X, mesh.cells, 0.0, 0.0)
        if invalid or not len(mesh.cells):
            raise ReplayProblem(f"no valid mesh of the shape: {invalid} of {len(mesh.cells)} triangles have no area")
        if area_floor:
            area_floor = min(area_floor, FRESH_AREA * areas(mesh.X, mesh.cells).min())
        self._adopt(mesh, min(quality_floor, FRESH_SHARE * quality), area_floor, quality)
        self._set_reference(gesture, c)
        stages["mesh"] = perf_counter() - start
        log.info("%4d Mesh level 3: %d triangles; %s; least quality %.3g", frame.index, len(mesh.cells), why, quality)
        return MeshUpdate(3, 0, NO_CELLS, quality, old, stages)

    def _generate(self, outline: Outline) -> Mesh:
        """A mesh of an outline, of nested ones the coarsest; without a size it has the usual number of triangles."""
        spec, coarser = self.spec.model_copy(update={"order": self.order}), 2 ** (self.spec.levels - 1)
        if coarser > 1 and spec.size is not None:
            refuse_endless(outline, spec.size, spec.near)
            near = {name: coarser * size for name, size in spec.near.items()}
            curves = max((spec.edges_per_circle or PER_CIRCLE[1]) // coarser, FEWEST_PER_CIRCLE)
            spec = spec.model_copy(update={"size": coarser * spec.size, "near": near, "edges_per_circle": curves})
        return generate(outline, spec, self.ranks, self._shared)

    def _adopt(self, mesh: Mesh, quality_floor: float, area_floor: float, quality: float) -> None:
        """Take a new mesh, whose worst triangle has this quality."""
        levels, flip_floor = self.spec.levels, 1.0 if self._flip_everywhere else quality_floor
        nested = NestedMesh(mesh, levels) if levels > 1 else None
        space = LagrangeSpace(mesh) if self.order == 2 and not nested else None
        generated = Generated(mesh, space, quality_floor, area_floor, flip_floor)
        self.state = replace(self.state, generated=generated, nested=nested, min_quality=quality)
