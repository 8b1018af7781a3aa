"""Free vibrations of a body whose shape is edited: its lowest modes, frame after frame."""

from dataclasses import replace

import numpy as np
import scipy.sparse as sp
from petsc4py import PETSc

from restshape.algebra.eigen import EigenReport, EigenSolver
from restshape.algebra.gather import whole_matrix
from restshape.algebra.linear_report import LinearReport
from restshape.algebra.stages import Stages
from restshape.analysis.correction import largest_values
from restshape.analysis.verified_shape import Counted
from restshape.analysis.eigen_matrices import assembled, cold_differences, operators_of
from restshape.analysis.mode_tracking import Following, upright
from restshape.analysis.frame import Frame
from restshape.analysis.frequencies import largest_difference
from restshape.analysis.modal_quantities import modal_quantity
from restshape.fem.problem import Fields
from restshape.application import application
from restshape.calibration import Calibration
from restshape.errors import ReplayProblem, UserError
from restshape.mesh.mesh import Mesh
from restshape.mesh.space import LagrangeSpace
from restshape.mesh.transfer import transfer
from restshape.physics.vibrating_bodies import oscillator
from restshape.physics.elasticity.mode_estimate import ModeEstimate, estimate_of
from restshape.physics.elasticity.vibrating_body import Oscillator
from restshape.physics.elasticity.pitch import note
from restshape.policy import Policy
from restshape.scene.model import Quantity, Scene
from restshape.scene.plan import Plan
from restshape.scene.plan import plan as planned

NORMAL = 0.5
"""Share of the kinetic energy beyond which a mode counts as out of the plane."""

MOST_BESIDE = 24
"""Modes in the plane that may lie below the last one out of the plane that is wanted."""

CLUSTER = 1e-3
"""Eigenvalues that differ by less than this share of themselves belong together: they are solved for, and followed
along a change of the shape, all or none."""


class ModalAnalysis:
    """The lowest eigenfrequencies and modes of a body, frame after frame.

    Each rank computes the whole eigenproblem by itself, with the same result.

    Args:
        scene: what the user wrote.
        plan: which effects are on.
        comm: PETSc communicator.
        policy: what is reused.
        calibration: seconds a unit of counted work.
        stages: takes the time of each stage.

    Attributes:
        mesh: the plane mesh of the last solution.
        body: what vibrates.
        values: (k,) eigenvalues [1/s^2] of all modes that are carried along, ascending.
        heavy: (k, n f) products M phi of the last solution.
        shares: (k,) parts of the kinetic energy normal to the plane.
        chosen: (modes,) indices of those that the scene asks for.
        following: numbers of the modes.

    Source: docs/theory.md, section 7.
    """

    estimated = "frequencies"

    def __init__(
        self, scene: Scene, plan: Plan, comm: PETSc.Comm, policy: Policy, calibration: Calibration, stages: Stages
    ) -> None:
        self.plan, self.comm, self.policy, self.stages = plan, comm, policy, stages
        self.scene: Scene | None = None
        self.mesh: Mesh | LagrangeSpace | None = None
        self.body: Oscillator | None = None
        self.topology = self.geometry = -1
        self.solver = EigenSolver(policy.solver, scene.solve.tolerance, calibration, stages)
        self.following = Following()
        self.counted = Counted()
        self.values = self.shares = np.empty(0)
        self.heavy = self._modes = np.empty((0, 0))
        self._mixed: tuple[np.ndarray, np.ndarray] | None = None
        self.chosen = np.empty(0, dtype=int)
        self.quantities: dict[str, Quantity] = {}
        self.count = 0
        self.failed = self.predicted = False
        self._solved = (self.following.numbers, self.shares)
        self.report = EigenReport(0, False, 0, "")
        self._estimator: ModeEstimate | None = None

    def solve(self, frame: Frame) -> LinearReport:
        """Bring frequencies and modes up to date with a frame.

        Raises:
            ReplayProblem: the eigenproblem has no solution that can be found.
            UserError: the scene makes no sense for a vibrating body. In both cases all stays as it was.
        """
        mesh = frame.mesh
        new_mesh, new_scene = mesh is not self.mesh, frame.scene is not self.scene
        if not (new_mesh or new_scene or mesh.topology != self.topology or mesh.geometry != self.geometry):
            if frame.settled and self.solver.uncounted:
                return self._confirm()
            self.report = replace(self.report, age=self.report.age + 1, missed=0)
            return LinearReport(0, False, self.report.age, self.report.method)
        kept = self.__dict__.copy()
        try:
            self._solve(frame, new_mesh, new_scene or self.failed)
        except (ReplayProblem, UserError):
            # Without a scene the next frame binds anew: what was patched belongs to a mesh that is taken back.
            self.__dict__.update(kept, scene=None, failed=True)
            self.solver.restart(self.modes if len(self.modes) else None)
            raise
        self.failed = self.predicted = False
        self.mesh, self.scene, self.topology, self.geometry = mesh, frame.scene, mesh.topology, mesh.geometry
        report = self.report
        if report.counted:
            self.counted.take(mesh)
        return LinearReport(report.iterations, report.refreshed, report.age, report.method)

    @property
    def modes(self) -> np.ndarray:
        """Modes (k, n f) of the eigenvalues, with phi M phi = 1."""
        if self._mixed is not None:
            turn, basis = self._mixed
            self._modes, self._mixed = turn.T @ basis, None
        return self._modes

    @modes.setter
    def modes(self, modes: np.ndarray) -> None:
        self._modes, self._mixed = modes, None

    @property
    def unknowns(self) -> int:
        """Unknowns of the eigenproblem, held ones included."""
        return self.body.mask.size

    @property
    def frequencies(self) -> np.ndarray:
        """Frequencies (modes,) [Hz] of the modes that the scene asks for, ascending."""
        return np.sqrt(np.maximum(self.values[self.chosen], 0.0)) / (2.0 * np.pi)

    @property
    def numbers(self) -> np.ndarray:
        """The numbers (modes,) by which these modes are followed."""
        return self.following.numbers[self.chosen]

    @property
    def x(self) -> np.ndarray:
        """What is solved for, (k, k + n f): the stiffness that the modes see, which is diagonal, beside the modes."""
        return np.column_stack([np.diag(self.values), self.modes])

    def accept(self, x: np.ndarray) -> None:
        """Take what `x` gives for the state of the mesh as it lies now, without a solve.

        Args:
            x: (k, k + n f) a stiffness H (k, k), symmetric, beside modes: its eigenvectors mix them.
        """
        count = len(x)
        small = x[:, :count]
        self.values, turn = np.linalg.eigh(0.5 * (small + small.T))
        numbers = np.argmax(np.abs(turn), axis=0)
        turn = turn * np.sign(turn[numbers, np.arange(count)])
        # Frames shown in passing never look at their modes.
        self._mixed = (turn, x[:, count:])
        self._renumber(numbers)
        self.geometry, self.predicted = -1, True
        self.report = EigenReport(0, False, self.report.age, self.report.method)

    def _renumber(self, order: np.ndarray) -> None:
        """Let modes that have changed places keep their numbers: now k was order[k] at the last solution.

        Where the prediction leaves and comes back, the order is that of the solution again.
        """
        if not self.predicted:
            self._solved = (self.following.numbers, self.shares)
        numbers, shares = self._solved
        if len(set(order)) == len(order):
            self.following.numbers, self.shares = numbers[order], shares[order]
            # By rank, as a solve chooses; what had not converged is not foretold.
            self.chosen = self._choose(self.shares, order < self.count)

    def observe(self) -> dict[str, float]:
        """The scene's quantities of interest at the last solution."""
        found = self.mesh, self.frequencies, self.numbers
        return {name: modal_quantity(name, quantity, *found) for name, quantity in self.quantities.items()}

    def row(self) -> dict[str, object]:
        """Columns of a frame's row that only modes have."""
        frequencies, settings = self.frequencies, self.plan.settings("modal")
        tone, cents = note(float(frequencies[0]), settings.a4)
        return {
            **{f"f_{k + 1}": float(f) for k, f in enumerate(frequencies)},
            "tone": tone,
            "cents": cents,
            "track": " ".join(map(str, self.numbers)),
            "counted": int(self.report.counted),
            "missed": self.report.missed,
            "elements": len(self.body.mesh.cells),
        }

    def fields(self) -> Fields:
        """Displacements of the middle surface in each mode, the largest 1; of the cells the size of the first one."""
        shapes = self.body.shapes(self.modes[self.chosen])
        sizes = np.linalg.norm(shapes, axis=2)
        shapes /= sizes.max(axis=1)[:, None, None]
        size = np.linalg.norm(shapes[0], axis=1)
        names = {f"mode_{k + 1}": shape for k, shape in enumerate(shapes)}
        return names, {"size_of_mode_1": size[self.mesh.cells].mean(axis=1)}

    def blank_fields(self, mesh: Mesh | LagrangeSpace) -> Fields:
        """The same fields without any number, on a mesh that has not been solved on."""
        count = self.plan.settings("modal").modes
        blank = {f"mode_{k + 1}": np.full((len(mesh.X), 3), np.nan) for k in range(count)}
        return blank, {"size_of_mode_1": np.full(len(mesh.cells), np.nan)}

    def residual(self) -> float:
        """The largest |K phi - lambda M phi| / |lambda M phi| of the modes that the scene asks for, element by element.

        Not a number after a frame without a solution: the body has moved with it, its modes have not.
        """
        body = self.body
        if self.failed:
            return float("nan")
        if self.predicted:
            body.follow(np.empty(0, dtype=np.int32))
        worst = 0.0
        for k in self.chosen:
            force, weight = self.products(self.modes[k])
            free = body.mask == 0
            error = np.linalg.norm((force - self.values[k] * weight)[free])
            worst = max(worst, float(error / (abs(self.values[k]) * np.linalg.norm(weight[free]))))
        return worst

    def estimate(self) -> float:
        """The largest estimated relative error of the frequencies that the scene asks for: that of the mesh.

        Of a prediction its distance from the solution on the same mesh: from the frequencies that the matrices of this
        shape give in the space of the predicted modes and what these lack, by the kept factor.
        """
        if self.predicted:
            return largest_difference(self.frequencies, self._corrected())
        if self._estimator is None or self._estimator.body is not self.body:
            self._estimator = estimate_of(self.body)
        return float(np.max(0.5 * self._estimator(self.modes[self.chosen]) / self.values[self.chosen]))

    @property
    def foretold(self) -> np.ndarray | None:
        """The predicted frequencies, for `prediction_error` after the next solve; None where there are none."""
        return self.frequencies if self.predicted else None

    def prediction_error(self, foretold: np.ndarray) -> float:
        """The largest relative difference of predicted frequencies (modes,) from the solved ones."""
        return largest_difference(foretold, self.frequencies)

    def _corrected(self) -> np.ndarray:
        """Frequencies (modes,) [Hz] of this shape in the space of the predicted modes and what these lack."""
        body, modes = self.body, self.modes
        body.follow(np.empty(0, dtype=np.int32))
        free = body.mask.ravel() == 0

        def weighed(rows: np.ndarray) -> np.ndarray:
            """K phi and M phi (2, k, n f) of rows (k, n f), at free unknowns."""
            products = np.array([self.products(row) for row in rows]).reshape(len(rows), 2, -1)
            return np.where(free, products, 0.0).swapaxes(0, 1)

        stiff, heavy = weighed(modes)
        values = np.einsum("ki,ki->k", modes, stiff) / np.einsum("ki,ki->k", modes, heavy)
        missing = self.solver.pencil.solve_aside(np.ascontiguousarray(values[:, None] * heavy - stiff))
        # The rigid motions are those of the last solve: what is left of them is of higher order.
        self.solver.deflation.clean(missing)
        space = np.concatenate([modes, missing])
        stiff, heavy = (np.concatenate(pair) for pair in zip((stiff, heavy), weighed(missing)))
        values = np.sort(1.0 / largest_values(space @ heavy.T, space @ stiff.T, len(modes)))
        return np.sqrt(np.maximum(values[self.chosen], 0.0)) / (2.0 * np.pi)

    def products(self, mode: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """K phi and M phi (n, f) of a mode (n f,), without matrices."""
        body = self.body
        phi = np.ascontiguousarray(mode.reshape(-1, body.fields))
        force, weight = np.zeros_like(phi), np.zeros_like(phi)
        body.stiffness.residual(body.mesh.X, phi, body.mesh.cells, body.stiffness_params, force)
        body.mass.residual(body.mesh.X, phi, body.mesh.cells, body.mass_params, weight)
        return force, weight

    # --- a frame --------------------------------------------------------------------------------------------------

    def _solve(self, frame: Frame, new_mesh: bool, new_scene: bool) -> None:
        before = self.modes
        if new_mesh or new_scene:
            before = self._bind(frame, new_mesh)
        else:
            self._move(frame)
            before = self.modes
            if self.predicted:
                self.solver.history = [self.modes, *self.solver.history]
        with self.stages("values"):
            stiffness, mass = assembled(self.operators, self.body, self.held)
            rigid = self.body.rigid()
        certain = frame.settled or self.counted.due(frame.mesh)
        self._find(stiffness, mass, rigid, new_mesh or new_scene, certain)
        with self.stages("observe"):
            if len(before):
                # In a frame of a drag the mass changes little.
                another = new_mesh or new_scene
                sizes = self.solver.pencil.norms(before) if another else np.ones(len(before))
                self.following(before, self.modes, self.heavy, sizes)
            else:
                upright(self.modes, self.heavy)
                self.following.begin(len(self.modes), self.chosen)

    def _confirm(self) -> LinearReport:
        """Count the modes of the last solution, now that the hand rests, and find those that are missing."""
        before, pencil = self.modes, self.solver.pencil
        self._find(pencil.stiffness, pencil.mass, self.body.rigid(), False, True)
        # The same modes twice say nothing of where the next ones lie.
        self.solver.history = self.solver.history[:1]
        with self.stages("observe"):
            self.following(before, self.modes, self.heavy, np.ones(len(before)))
        self.counted.take(self.mesh)
        report = self.report
        return LinearReport(report.iterations, report.refreshed, report.age, report.method)

    def _bind(self, frame: Frame, new_mesh: bool) -> np.ndarray:
        """Set up what depends on the mesh topology or on the scene's values; the modes before, on the new nodes."""
        old = self.body
        with self.stages("pattern"):
            self.plan = planned(frame.scene, application(frame.scene.app))
            self.body = body = oscillator(frame.scene, self.plan, frame.mesh, self.policy.lumped_mass)
            self.operators = operators_of(body)
            self.held = np.flatnonzero(body.mask)
        self.solver.tolerance, self.quantities = frame.scene.solve.tolerance, frame.scene.quantities
        self.count = max(self.count, self.plan.settings("modal").modes)
        carried = np.empty((0, body.mask.size))
        if old is not None and type(old) is type(body):
            with self.stages("map"):
                carried = self._carried(old, frame) if new_mesh else self.modes
            if carried.shape[1] != body.mask.size:
                carried = np.empty((0, body.mask.size))
        carried = np.where(body.mask.ravel() == 0, carried, 0.0)
        self.solver.restart(carried if len(carried) and self.policy.transfer else None)
        return carried

    def _carried(self, old: Oscillator, frame: Frame) -> np.ndarray:
        """The last modes on a new mesh, column by column."""
        modes = np.stack([old.reseated(mode.reshape(-1, old.fields), frame.reseats) for mode in self.modes])
        columns = np.concatenate([old.over_plane(mode).reshape(len(self.mesh.X), -1) for mode in modes], axis=1)
        there = transfer(self.mesh, frame.mesh, columns).reshape(len(frame.mesh.X), len(modes), -1)
        return np.ascontiguousarray(there.transpose(1, 0, 2)).reshape(len(modes), -1)

    def _move(self, frame: Frame) -> None:
        """Follow the plane mesh, whose nodes have moved and whose edges may have flipped."""
        flipped = frame.mesh.topology != self.topology
        with self.stages("relocate"):
            changed = self.body.follow(frame.changed_cells if flipped else np.empty(0, dtype=np.int32))
        if not flipped:
            return
        with self.stages("pattern"):
            for operator in self.operators:
                operator.patch(0, changed)
            if frame.reseats:
                fields = self.body.fields

                def reseat(modes: np.ndarray) -> np.ndarray:
                    moved = [self.body.reseated(mode.reshape(-1, fields), frame.reseats) for mode in modes]
                    return np.stack(moved).reshape(modes.shape)

                self.modes = reseat(self.modes)
                self.solver.history = [reseat(block) for block in self.solver.history]

    def _find(self, stiffness: PETSc.Mat, mass: PETSc.Mat, rigid: np.ndarray, new_system: bool, certain: bool) -> None:
        """Solve for as many modes as it takes to have those that the scene asks for."""
        settings = self.plan.settings("modal")
        total = None
        while True:
            found, report = self.solver.solve(stiffness, mass, rigid, self.count, new_system and total is None, certain)
            total = report if total is None else total.followed_by(report)
            heavy = np.empty_like(found.modes)
            self.solver.pencil.apply(mass, found.modes, heavy)
            shares = self.body.normal_shares(found.modes, heavy)
            chosen = self._choose(shares, np.arange(len(shares)) < self.count)
            if len(chosen) == settings.modes:
                whole = cluster_end(found.values, int(chosen[-1]))
                if whole <= self.count or self.count >= settings.modes + MOST_BESIDE:
                    break
                self.count = whole
                continue
            if self.count >= settings.modes + MOST_BESIDE:
                raise ReplayProblem(
                    f"only {len(chosen)} of the {self.count} lowest modes are out of the plane, not {settings.modes}"
                )
            self.count += max(1, settings.modes - len(chosen))
        self.values, self.modes, self.heavy = found.values, found.modes, heavy
        self.shares, self.chosen, self.report = shares, chosen, total

    def _choose(self, shares: np.ndarray, known: np.ndarray) -> np.ndarray:
        """Indices of the lowest modes that the scene asks for, among known (k,) ones with shares (k,)."""
        settings = self.plan.settings("modal")
        if "z" in self.body.axes and not settings.in_plane:
            known = known & (shares >= NORMAL)
        return np.flatnonzero(known)[: settings.modes]

    # --- for comparison with a cold solve ---------------------------------------------------------------------------

    def matrices(self) -> tuple[sp.csr_matrix, sp.csr_matrix]:
        """K and M as they stand, with the rows of held unknowns."""
        return tuple(whole_matrix(m, PETSc.COMM_SELF) for m in (self.solver.pencil.stiffness, self.solver.pencil.mass))

    def cold_differences(self) -> tuple[float, float]:
        """Largest differences of the matrices' entries and of frequencies from a solve with nothing kept; relative."""
        return cold_differences(self)


def cluster_end(values: np.ndarray, k: int) -> int:
    """How many of values (m,), ascending, there are up to the last one of the cluster of the k-th, from 0."""
    gaps = np.flatnonzero(np.diff(values[k:]) > CLUSTER * np.abs(values[k + 1 :]))
    return k + 1 + int(gaps[0]) if len(gaps) else len(values)
