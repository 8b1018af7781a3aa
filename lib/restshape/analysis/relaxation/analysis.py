"""Cloth that comes to rest, frame after frame, on pattern, factors and positions that are kept."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import compress
from typing import Any

import numpy as np
from petsc4py import PETSc

from restshape.algebra.gather import matrix_difference, whole_matrix
from restshape.algebra.kinetic_damping import Steps
from restshape.algebra.linear import LinearSolver
from restshape.algebra.linear_report import LinearReport
from restshape.algebra.traits import Traits
from restshape.algebra.stages import Stages
from restshape.analysis.relaxation.cold_start import fall, loosen, stand_in
from restshape.analysis.frame import Frame
from restshape.analysis.relaxation.equilibrium import Arrival, Rest
from restshape.fem.problem import Fields
from restshape.analysis.relaxation.strategies import WAYS
from restshape.application import application
from restshape.calibration import Calibration
from restshape.errors import ReplayProblem, UserError
from restshape.mesh.mesh import Mesh
from restshape.mesh.transfer import transfer
from restshape.physics.cloth.body_motion import carried, placed
from restshape.physics.cloth.error_estimate import ClothEstimate
from restshape.physics.cloth.quantities import ClothObserver
from restshape.physics.cloth.scene import SheetArguments, set_contact, sheet_arguments, sheet_of
from restshape.physics.cloth.initial_placement import Laid
from restshape.physics.cloth.tunnelling import depths, piercing, size_of
from restshape.physics.cloth.sheet import Sheet
from restshape.policy import Policy
from restshape.scene.bodies import Body
from restshape.scene.body_columns import body_columns, body_row
from restshape.scene.model import Scene
from restshape.scene.plan import Plan
from restshape.scene.plan import plan as planned

PASSED = 0.5
"""Part of the smallest size of a body that a node goes in one step: it must not come out on the other side."""
ESCAPES = 5
"""Saddles of the energy that are left in one frame before the cloth is said to rest on one."""
FEWEST = 60
"""Nodes of a mesh that cloth may fall on: on fewer it finds no folds, and past a body no way back."""
SHORT = 300
"""Steps from a saddle after which the membrane is softened for the rest of the way."""
SMALL = 600
"""Nodes up to which motion is solved for with complete factors."""
FARTHER = 0.01
"""Part of the tolerance to which a cold solve goes on."""
FIRST_STEP = 1.0 / 60.0
"""Time step [s] that motion begins with; the thesis's for all of it."""


class DrapeAnalysis:
    """Where cloth comes to rest on bodies and supports while they, or its pattern, are edited.

    The first frame, and every one that starts anew, lets the cloth fall from where the scene lays it, from a soft
    membrane to a stiff one and from coarse meshes to fine ones; others go on from the last positions.

    Args:
        scene: what the user wrote.
        plan: which effects are on.
        comm: PETSc communicator.
        policy: what is reused.
        calibration: seconds a unit of counted work.
        stages: takes the time of each stage.

    Attributes:
        x: (n, 3) positions [m], and with Morley's triangles slopes of edges.
        arrival: how the last way to rest ended.
        watch: called with the way to rest, positions (n, 3) and residual over load at each iterate.

    Source: docs/theory.md, section "Cloth".
    """

    estimated = "strain of the cloth in the energy norm"

    def __init__(
        self, scene: Scene, plan: Plan, comm: PETSc.Comm, policy: Policy, calibration: Calibration, stages: Stages
    ) -> None:
        self.plan, self.comm, self.policy, self.stages = plan, comm, policy, stages
        self.calibration = calibration
        self.scene: Scene | None = None
        self.bound: Scene | None = None
        self.mesh: Mesh | None = None
        self.sheet: Sheet | None = None
        self.rest: Rest | None = None
        self.bodies: list[Body] = []
        self.body_columns = list(body_columns(scene.bodies))
        self.topology = self.geometry = -1
        self.x = np.zeros((0, 3))
        self.arrival = Arrival()
        self.observed: dict[str, float] | None = None
        self._estimator: ClothEstimate | None = None
        self.begun: list[str] = []
        self._others: DrapeAnalysis | None = None
        self.watch: Callable[[Rest, np.ndarray, float], None] = lambda *_: None
        self.age = 0

    @property
    def unknowns(self) -> int:
        """Unknowns of the equations, held ones included."""
        return self.x.size

    @property
    def tolerance(self) -> float:
        """Residual over load at rest."""
        return self.plan.settings("drape").rest

    def solve(self, frame: Frame) -> LinearReport:
        """Bring the positions `x` (n, 3) [m] up to date with a frame.

        Raises:
            ReplayProblem: a step has no solution, or a value no number.
            UserError: the scene's cloth cannot be had. In both cases all stays as it was.
        """
        mesh = frame.mesh
        new_mesh = mesh is not self.mesh or mesh.topology != self.topology
        if not (new_mesh or frame.scene is not self.scene or mesh.geometry != self.geometry):
            self.age += 1
            return LinearReport(0, False, self.age, self._name)
        kept = self.__dict__.copy()
        contact = self.sheet.contact if self.sheet else None
        history = contact.history() if contact else None
        try:
            with self.stages("pattern"):
                cold = self._bind(frame, new_mesh)
            report = self._settle(cold)
        except (ReplayProblem, UserError):
            self.__dict__.update(kept, scene=None)
            if contact:
                contact.restore(history)
            raise
        self.mesh, self.scene = mesh, frame.scene
        self.topology, self.geometry, self.observed = mesh.topology, mesh.geometry, None
        return report

    def begin_from(self, other: DrapeAnalysis) -> None:
        """Let the first frame start where another analysis of the same mesh rests, its friction included."""
        self._others = other

    def observe(self) -> dict[str, float]:
        """The scene's quantities of interest, evaluated once a solution."""
        if self.observed is None:
            self.observed = self.observer(self.x)
        return self.observed

    def residual(self) -> float:
        """The forces out of balance over the weight; norms at free unknowns."""
        return self.rest.residual(self.x)

    def estimate(self) -> float:
        """The estimated relative error of tensions and moments in the energy norm."""
        return self.estimator.relative(self.x)

    @property
    def estimator(self) -> ClothEstimate:
        """The estimate of the present sheet, kept until there is another one."""
        if self._estimator is None or self._estimator.sheet is not self.sheet:
            self._estimator = ClothEstimate(self.sheet)
        self._estimator.follow()
        return self._estimator

    def row(self) -> dict[str, Any]:
        """What the frame's row tells besides."""
        arrival = self.arrival
        scale = "weight" if self.sheet.load > 0.0 else "forces of the supports"
        notes = (
            [] if arrival.at_rest else [f"not at rest: residual {arrival.residual:.2e} of the {scale}; {arrival.why}"]
        )
        if arrival.at_rest and arrival.stable is False:
            notes.append("at rest where it may not stay: the tangent is not positive definite")
        deepest = 0.0
        if self.sheet.contact:
            corners, kernels = self.sheet.corners(self.x), self.sheet.contact.bodies
            through = piercing(self.bodies, kernels, corners[self.mesh.cells])
            notes += [f"bodies.{name} comes through the cloth" for name in compress(self.bound.bodies, through)]
            deep = depths(kernels, corners)
            deepest = max(deep, default=0.0)
            notes += [*self.begun, *self._too_deep("lies", deep)]
        return {
            "at_rest": int(arrival.at_rest),
            "stable": -1 if arrival.stable is None else int(arrival.stable),
            "steps": arrival.steps,
            "factors": arrival.factors,
            "dragged": arrival.dragged,
            "deepest": deepest,
            "note": "; ".join(notes),
            **body_row(dict(zip(self.bound.bodies, self.bodies)), self.body_columns),
        }

    def _too_deep(self, how: str, deep: list[float]) -> list[str]:
        """Bodies in which cloth is deeper than contact begins above their surface, by how deep [m] it is in each."""
        least = self.sheet.contact.thickness
        told = zip(self.bound.bodies, deep)
        return [f"cloth {how} {1e3 * depth:.3g} mm inside bodies.{name}" for name, depth in told if depth > least]

    def fields(self) -> Fields:
        """Displacement [m] of the nodes from the flat pattern, larger principal tension [N/m] of the cells."""
        xx, yy, xy = self.sheet.tensions(self.x).T
        tension = 0.5 * (xx + yy) + np.hypot(0.5 * (xx - yy), xy)
        return {"displacement": self.sheet.corners(self.x) - self.flat}, {"tension": tension}

    def blank_fields(self, mesh: Any) -> Fields:
        """The same fields without any number, on a mesh that has not been solved on."""
        return {"displacement": np.full((len(mesh.X), 3), np.nan)}, {"tension": np.full(len(mesh.cells), np.nan)}

    # --- a frame --------------------------------------------------------------------------------------------------

    def _bind(self, frame: Frame, new_mesh: bool) -> bool:
        """Take in what a frame changes; tells whether the cloth starts anew."""
        mesh, scene = frame.mesh, frame.scene
        if scene is not self.scene:
            self.plan = planned(scene, application(scene.app))
        self.bound = scene
        arguments = sheet_arguments(scene, self.plan, mesh)
        # Cloth that has fallen out of reach is thrown anew, so that an edit, or its undo, brings it back.
        cold = self.sheet is None or self.policy.regenerate or self.arrival.falls
        bodies = [body.settled(scene.parameters) for body in scene.bodies.values()]
        old, kept, before, self.bodies = self.sheet, self.x, self.bodies, bodies
        if new_mesh or self._other_kind(arguments):
            corners = None if cold else self._carried_corners(frame, scene)
            self._make(scene, mesh, arguments)
            self.x = self.sheet.flat(arguments.start if corners is None else corners)
            if corners is not None:
                self._inherit(old, kept, corners)
        else:
            self._follow(mesh, arguments)
            if cold:
                self.x = self.sheet.flat(arguments.start)
        self.begun = []
        if cold and self.sheet.contact:
            self.begun = self._too_deep("begins", depths(self.sheet.contact.bodies, self.sheet.corners(self.x)))
        if self.sheet.contact and old is not None and old.contact and not cold:
            self._carry_anchors(before)
            self._go_along(before)
        if self._others:
            cold = self._take(self._others)
        self.flat = np.column_stack([mesh.X, np.zeros(len(mesh.X))])
        self.observer = ClothObserver(self.sheet, scene.quantities, self.flat)
        self.rest.goal = self.rest.linear.tolerance = self.tolerance
        self.rest.keep_short(self._reach)
        self.rest.begin()
        return cold

    def _take(self, other: DrapeAnalysis) -> bool:
        """Lie as another cloth of the same mesh does; tells that this one does not start anew."""
        self.x = np.where(self.sheet.mask, self.sheet.prescribed, other.x)
        if self.sheet.contact and other.sheet.contact:
            self.sheet.contact.take(other.sheet.contact)
        self._others = None
        return False

    def _make(self, scene: Scene, mesh: Mesh, arguments: SheetArguments) -> None:
        """A sheet and what brings it to rest, on a mesh that is not known."""
        self.sheet = sheet_of(mesh, arguments)
        self.laid = Laid(scene.start, scene.parameters)
        self.rest = self._rest(self.sheet, scene)
        self.age = 0

    def _rest(self, sheet: Sheet, scene: Scene, prefix: str = "drape_") -> Rest:
        settings, complete = self.plan.settings("drape"), "direct"
        if self.policy.name == "auto":
            # A complete factor tells how to leave a rest that is not stable, and on one rank alone there is one.
            complete = "stale" if self.comm.size == 1 else "auto"
        linear = LinearSolver(
            self.comm,
            f"{prefix}linear_",
            complete,
            settings.rest,
            self.calibration,
            self.stages,
            memory=scene.solve.factor_memory,
            traits=Traits(fields=3, dimension=3),
        )
        # A complete factor of a small matrix costs less than the iterations without one.
        small = settings.way == "auto" and sheet.n_nodes <= SMALL
        preconditioner = "ilu" if self.policy.name == "thesis" else "cholesky" if small else "sor"
        steps = Steps(FIRST_STEP, reach=self._reach, most=100, preconditioner=preconditioner)
        rest = Rest(sheet, self.comm, self.stages, linear, settings.rest, steps, self.policy.backend, prefix)
        rest.on_iterate = lambda x, residual: self.watch(rest, x, residual)
        return rest

    @property
    def _reach(self) -> float:
        """The farthest way of a node in one step [m]."""
        return PASSED * min((size_of(body) for body in self.bodies), default=np.inf)

    def _other_kind(self, arguments: SheetArguments) -> bool:
        """Tell whether the sheet's elements are others."""
        fabric, new = self.sheet.fabric, arguments.fabric
        touched = (self.sheet.contact is None) != (not arguments.bodies)
        count = self.sheet.contact is not None and len(self.sheet.contact.bodies) != len(arguments.bodies)
        return (fabric.kind, fabric.law) != (new.kind, new.law) or touched or count

    def _follow(self, mesh: Mesh, arguments: SheetArguments) -> None:
        """Take in moved nodes, other values, supports and bodies on the same topology."""
        sheet = self.sheet
        # Material that has come elsewhere takes the place that the cloth has there.
        stayed = sheet.along(self.x)
        sheet.fabric, sheet.support, sheet.g = arguments.fabric, arguments.held, arguments.g
        sheet.move()
        x = stayed(self.x)
        if sheet.contact:
            set_contact(sheet, arguments)
            # What sticks does so wherever its nodes are in it.
            sheet.contact.anchors += sheet.corners(x) - sheet.corners(self.x)
        self.x = np.where(sheet.mask, sheet.prescribed, x)

    def _carried_corners(self, frame: Frame, scene: Scene) -> np.ndarray:
        """Positions (corners, 3) of the last frame: along the cloth, or, on a new mesh, by their displacements."""
        if frame.mesh is self.mesh:
            return self.sheet.corners_along(self.x)
        laid = Laid(scene.start, scene.parameters)
        with self.stages("map"):
            moved = self.sheet.corners(self.x) - laid.places(self.mesh.X)
            return laid.places(frame.mesh.X) + transfer(self.mesh, frame.mesh, moved)

    def _settle(self, cold: bool) -> LinearReport:
        settings, self.arrival = self.plan.settings("drape"), Arrival()
        way = "kinetic" if self.policy.name == "thesis" else settings.way
        if cold and way == "auto":
            self.x = self._fall(settings.steps)
        WAYS[way](self.rest, self.x, settings.steps, self.arrival)
        if not np.isfinite(self.x).all():
            raise ReplayProblem("the cloth's positions are no numbers")
        if self.arrival.at_rest:
            self._make_stable(way, settings.steps)
        arrival = self.arrival
        return LinearReport(arrival.iterations, arrival.factors > 0, self.age, self._name, arrival.newton)

    def _make_stable(self, way: str, most: int) -> None:
        """See to it that the cloth rests where it stays, by leaving what is a saddle of its energy."""
        for _ in range(ESCAPES):
            self.arrival.stable = self.rest.certify(self.x)
            if self.arrival.stable or way != "auto" or self.arrival.steps >= most:
                return
            if not self.rest.escape(self.x):
                # Nothing but a motion that hardly anything resists, such as turning about a pin.
                return
            self.arrival.at_rest = False
            WAYS[way](self.rest, self.x, min(most, SHORT), self.arrival)
            if not self.arrival.at_rest:
                loosen(self.rest, self.x, most, self.arrival)
                WAYS[way](self.rest, self.x, most, self.arrival)
        self.arrival.stable = self.rest.certify(self.x) if self.arrival.at_rest else None

    def _fall(self, most: int) -> np.ndarray:
        """Positions near rest, from where the scene lays the cloth."""
        hierarchy = getattr(self.sheet.mesh, "hierarchy", None)
        meshes = hierarchy.meshes if hierarchy else [self.sheet.mesh]
        wanted = min(self.plan.settings("drape").levels, sum(len(mesh.X) >= FEWEST for mesh in meshes) or 1)
        meshes = meshes[-wanted:]
        skipped = (len(hierarchy.meshes) if hierarchy else 1) - len(meshes)
        other = self.sheet.space is not None
        ways = [self._stand_in(mesh, level) for level, mesh in enumerate(meshes if other else meshes[:-1])]
        ways += [] if other else [self.rest]

        def carry(level: int, x: np.ndarray) -> np.ndarray:
            corners = hierarchy.prolong(skipped + level, ways[level].sheet.corners(x))
            return ways[level + 1].sheet.flat(corners)

        start = ways[0].sheet.flat(sheet_arguments(self.bound, self.plan, meshes[0]).start)
        try:
            x = fall(ways, carry, start, most, self.arrival, other)
            return self.sheet.flat(ways[-1].sheet.corners(x)) if other else x
        finally:
            for way in ways if other else ways[:-1]:
                way.destroy()

    def _stand_in(self, mesh: Mesh, level: int) -> Rest:
        """What falls on a mesh of the hierarchy in place of the cloth itself."""
        arguments = sheet_arguments(self.bound, self.plan, mesh)
        sheet = sheet_of(mesh, replace(arguments, fabric=stand_in(arguments.fabric)))
        return self._rest(sheet, self.bound, f"drape_level{level}_")

    @property
    def _name(self) -> str:
        return "cholesky" if self.policy.name != "thesis" else "ilu"

    # --- friction -------------------------------------------------------------------------------------------------

    def _inherit(self, old: Sheet, x: np.ndarray, corners: np.ndarray) -> None:
        """Let friction remember on a new sheet with nodes at `corners` (n, 3) what it knew of the old one at x."""
        new, mesh = self.sheet, self.mesh
        if new.contact and old.contact and len(new.contact.bodies) == len(old.contact.bodies):
            same = new.mesh is mesh
            carry = (lambda values: values) if same else (lambda values: transfer(mesh, new.mesh, values))
            new.contact.inherit(old.contact, old.corners(x), corners, carry)

    def _carry_anchors(self, before: list[Body]) -> None:
        """Let anchors go where their bodies have gone."""
        anchors = self.sheet.contact.anchors
        for k, (old, new) in enumerate(zip(before, self.bodies)):
            anchors[k] = carried(old, new, anchors[k])

    def _go_along(self, before: list[Body]) -> None:
        """Guess that cloth which lies on one body alone, and hangs nowhere, goes where this goes."""
        pressed = [k for k in range(len(self.bodies)) if self.sheet.contact.pressed(k)]
        if len(pressed) != 1 or len(self.sheet.held):
            return
        old, new = before[pressed[0]], self.bodies[pressed[0]]
        if old.kind == new.kind:
            self.x[self.sheet.number] += placed(new)[0] - placed(old)[0]

    # --- for comparison with a cold solve -----------------------------------------------------------------------

    def cold_differences(self) -> tuple[float, float]:
        """How far the tangent and the positions are from those of a cold solve; for `replay --parity`.

        Entries by the largest one. Positions from those to which Newton's method goes on, on a new sheet and pattern,
        by the forces over the weight that the difference takes, for that is what rest is measured by.
        """
        cold = self._rest(self._cold_sheet(), self.scene, "drape_cold_")
        cold.begin()
        warm, fresh = (whole_matrix(rest.newton.tangent(self.x), self.comm) for rest in (self.rest, cold))
        x = self.x.copy()
        cold.goal = FARTHER * self.tolerance
        found = cold.polish(x, Arrival())
        # Loose cloth turns on its way; the mean of both tangents is good to third order.
        mean = 0.5 * (fresh + whole_matrix(cold.newton.tangent(x), self.comm))
        forces = (mean @ (self.x - x).ravel()).reshape(x.shape) * self.sheet.free
        distance = float(np.linalg.norm(forces)) / self.rest.scale(self.x) if found else cold.residual(self.x)
        if not self.arrival.at_rest:
            # It says so, and how far it is: no farther it must be.
            distance *= min(1.0, self.tolerance / self.arrival.residual)
        cold.destroy()
        return matrix_difference(warm, fresh), distance

    def _cold_sheet(self) -> Sheet:
        """The sheet of this frame made anew, with the same history of friction."""
        sheet = sheet_of(self.mesh, sheet_arguments(self.scene, self.plan, self.mesh))
        if sheet.contact:
            sheet.contact.take(self.sheet.contact)
        return sheet
