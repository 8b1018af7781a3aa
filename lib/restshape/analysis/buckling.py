"""Solids at rest under a load, and the multiples of it at which they buckle, frame after frame."""

from dataclasses import replace

import numpy as np
from petsc4py import PETSc

from restshape.algebra.buckling import BucklingSolver
from restshape.algebra.eigen import EigenReport
from restshape.algebra.linear import LinearSolver
from restshape.algebra.linear_report import LinearReport
from restshape.algebra.operator import Operator
from restshape.algebra.stages import Stages
from restshape.analysis.cold_buckling import cold_differences
from restshape.analysis.correction import correction, largest_values, preconditioner
from restshape.analysis.verified_shape import Counted
from restshape.analysis.mode_tracking import Following, upright
from restshape.analysis.frame import Frame
from restshape.analysis.frequencies import largest_difference
from restshape.fem.problem import Fields
from restshape.analysis.steady import StaticAnalysis
from restshape.calibration import Calibration
from restshape.errors import ReplayProblem, UserError
from restshape.mesh.mesh import Mesh
from restshape.mesh.transfer import transfer
from restshape.physics.elasticity.geometric_stiffness import GeometricStiffness
from restshape.physics.elasticity.quantities import Observer, area
from restshape.policy import Policy
from restshape.scene.model import Quantity, Scene
from restshape.scene.plan import Plan

AT_REST = 0.1
"""The displacement at rest is solved for with this share of the tolerance: bending of slender bodies, on which load
factors depend, hardly shows in a residual."""

CARRIED = 1e-10
"""Strains below this share of the displacement over the body's size are none."""

SIGNS = {"given": 1.0, "reversed": -1.0}


class BucklingAnalysis(StaticAnalysis):
    """The equilibrium of a linear solid, and its lowest critical load factors: K phi = -mu G phi, mu > 0.

    G is the geometric stiffness of the stress at rest, which grows in proportion to the load. Factors at which the mean
    strain would reach 1 are none. Each rank computes the whole eigenproblem by itself, with the same result.

    Arguments as in `StaticAnalysis`.

    Attributes:
        load_factors: (k,) ascending, as many as there are up to those that the scene asks for.
        modes: (k, 2 n) with phi K phi = 1; heavy: (k, 2 n) their products K phi.
        sign: of the load that is meant, -1 where it is turned round.
        following: numbers of the modes.

    Source: docs/theory.md, section 8.
    """

    estimated = "load factors"

    def __init__(
        self, scene: Scene, plan: Plan, comm: PETSc.Comm, policy: Policy, calibration: Calibration, stages: Stages
    ) -> None:
        super().__init__(scene, plan, comm, policy, calibration, stages)
        follows = policy.solver in ("auto", "stale")
        self.critical = BucklingSolver(follows, scene.solve.tolerance, calibration, stages)
        self.load_factors = np.empty(0)
        self.modes = self.heavy = np.empty((0, 0))
        self.following = Following()
        self.counted = Counted()
        self.sign, self.most = 1.0, np.inf
        # A recording has the columns that it began with.
        self.shown = plan.settings("buckling").modes
        self.predicted = False
        self.eigen = EigenReport(0, False, 0, "")

    def solve(self, frame: Frame) -> LinearReport:
        """Bring displacement and load factors up to date with a frame; as `StaticAnalysis.solve`."""
        try:
            report = super().solve(frame)
            if not report.iterations:
                self.eigen = replace(self.eigen, missed=0)
            return self._confirm(report) if frame.settled and self.critical.uncounted else report
        except (ReplayProblem, UserError):
            # What was solved for at rest may be of a mesh that is gone.
            self.guess.restart()
            raise

    def observe(self) -> dict[str, float]:
        """The scene's quantities of interest at the last solution; a load factor that there is not is infinite."""
        if self.observed is None:
            found = {name: self._load_factor(q.load_factor) for name, q in self.wanted.items()}
            self.observed = self.observer(self.x) | found
        return self.observed

    def row(self) -> dict[str, object]:
        """Columns of a frame's row that only buckling has."""
        row: dict[str, object] = {f"mu_{k}": self._load_factor(k) for k in range(1, self.shown + 1)}
        row["track"] = " ".join(map(str, self.following.numbers[: len(self.load_factors)]))
        row["counted"], row["missed"] = int(self.eigen.counted), self.eigen.missed
        if not len(self.load_factors) and not self.predicted:
            reach = f"up to {self.most:.3g}, where the mean strain is 1" if np.isfinite(self.most) else "without a load"
            row["note"] = f"nothing buckles: no load factor {reach}"
        elif self.critical.reach > self.critical.tolerance:
            row["note"] = f"rounding keeps residuals of modes above a tolerance of {self.critical.tolerance:g}"
        return row

    def fields(self) -> Fields:
        """Displacement and equivalent stress, and the modes, the largest displacement of each 1."""
        points, cells = super().fields()
        for k in range(1, self.shown + 1):
            shape = np.full_like(self.x, np.nan)
            if k <= len(self.modes):
                shape = self.modes[k - 1].reshape(-1, 2)
                shape = shape / np.linalg.norm(shape, axis=1).max()
            points[f"buckling_mode_{k}"] = shape
        return points, cells

    def blank_fields(self, mesh: Mesh) -> Fields:
        """The same fields without any number, on a mesh that has not been solved on."""
        points, cells = super().blank_fields(mesh)
        for k in range(1, self.shown + 1):
            points[f"buckling_mode_{k}"] = np.full((len(mesh.X), 2), np.nan)
        return points, cells

    def residual(self) -> float:
        """The true residual at rest or, where larger, |K phi + mu G phi| / |K phi| of a mode, element by element."""
        worst = super().residual()
        if self.predicted:
            return worst
        params, physics = self.geometric.params(self.x), self.physics
        for factor, mode in zip(self.load_factors, self.modes):
            phi = mode.reshape(-1, 2)
            force = self.stiffness_product(phi)
            error = force + factor * self.sign * self.geometric.product(params, phi)
            error.ravel()[physics.constrained] = 0.0
            worst = max(worst, float(np.linalg.norm(error) / np.linalg.norm(force)))
        return worst

    def estimate(self) -> float:
        """The largest estimated relative error of the load factors: that of the mesh in their modes, recovery-based.

        What the mesh does to the stress at rest is not in it. Of a prediction its distance from the solution on the
        same mesh, by a correction of displacement and modes with the kept preconditioner.
        """
        if not len(self.load_factors):
            return float("nan")
        if self.predicted:
            return largest_difference(self.load_factors, self._corrected())
        estimator = self.estimator_of(self.physics)
        return max(estimator.relative(mode.reshape(-1, 2)) ** 2 for mode in self.modes)

    @property
    def foretold(self) -> np.ndarray | None:
        """The predicted load factors, for `prediction_error` after the next solve; None where there are none."""
        return self.load_factors if self.predicted else None

    def prediction_error(self, foretold: np.ndarray) -> float:
        """The largest relative difference of predicted load factors (k,) from the solved ones of the same rank."""
        return largest_difference(foretold, self.load_factors)

    def _corrected(self) -> np.ndarray:
        """Load factors (k,) that modes and what they lack give together, at the corrected displacement."""
        physics, rows = self.physics, self.operator.rows
        params = self.geometric.params(self.x + correction(physics, self.x, self.solver, rows))

        def products(modes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            """K phi and -G phi (k, 2 n) of modes (k, 2 n)."""
            shapes = [mode.reshape(-1, 2) for mode in modes]
            stiff = np.stack([self.stiffness_product(phi).ravel() for phi in shapes])
            loaded = np.stack([-self.sign * self.geometric.product(params, phi).ravel() for phi in shapes])
            loaded[:, physics.constrained] = 0.0
            return stiff, loaded

        stiff, loaded = products(self.modes)
        values = np.einsum("ki,ki->k", self.modes, loaded) / np.einsum("ki,ki->k", self.modes, stiff)
        lacking = loaded - values[:, None] * stiff
        basis = np.concatenate([self.modes, list(map(preconditioner(self.solver, rows), lacking))])
        stiff, loaded = products(basis)
        found = largest_values(basis @ loaded.T, basis @ stiff.T, len(self.load_factors))
        return np.sort(1.0 / found[found > 0.0])

    def stiffness_product(self, phi: np.ndarray) -> np.ndarray:
        """K phi (n, 2) at free unknowns, without a matrix."""
        physics, out = self.physics, np.zeros_like(phi)
        physics.element.residual(physics.mesh.X, phi, physics.mesh.cells, physics.stiffness_params, out)
        out.ravel()[physics.constrained] = 0.0
        return out

    # --- prediction ---------------------------------------------------------------------------------------------------

    @property
    def state(self) -> np.ndarray:
        """What is predicted, (2 n + k k,): the displacement, and a matrix whose eigenvalues are the load factors."""
        return np.concatenate([self.x.ravel(), np.diag(self.load_factors).ravel()])

    def accept(self, state: np.ndarray) -> None:
        """Take a `state` for that of the mesh as it lies now, without a solve; modes stay those of the last one."""
        n = self.x.size
        super().accept(state[:n].reshape(-1, 2))
        count = int(np.sqrt(len(state) - n))
        small = state[n:].reshape(count, count)
        # Beyond where the line meets 0 it means nothing.
        self.load_factors = np.maximum(0.0, np.linalg.eigvalsh(0.5 * (small + small.T)))
        self.predicted, self.eigen = True, EigenReport(0, False, self.eigen.age, "")

    # --- a frame ------------------------------------------------------------------------------------------------------

    def _make_solver(self, scene: Scene) -> LinearSolver:
        solver = super()._make_solver(scene)
        solver.tolerance *= AT_REST
        return solver

    def _bind(self, frame: Frame, new_mesh: bool) -> None:
        super()._bind(frame, new_mesh)
        settings, mesh, mask = self.plan.settings("buckling"), frame.mesh, self.physics.mask
        self.sign = SIGNS[settings.load]
        quantities = frame.scene.quantities
        self.wanted = {name: q for name, q in quantities.items() if q.load_factor is not None}
        for name, quantity in self.wanted.items():
            _require_computed(name, quantity, settings.modes)
        self.critical.tolerance = frame.scene.solve.tolerance
        with self.stages("pattern"):
            self.geometric = GeometricStiffness(self.physics)
            if new_mesh:
                offsets = np.array([0, len(mesh.X)], dtype=np.int32)
                count = 1 if self.comm.size == 1 else 2
                self.whole = [
                    Operator(PETSc.COMM_SELF, 2, offsets, self.policy.backend, symmetric=False) for _ in range(count)
                ]
                for operator in self.whole:
                    operator.set_topology([mesh.cells], mask)
            else:
                for operator in self.whole:
                    operator.set_constraints(mask)
        if len(self.modes):
            with self.stages("map"):
                modes = self._carried(frame) if new_mesh else self.modes
            self.modes = np.where(mask.ravel() == 0, modes, 0.0)
        self.critical.restart(self.modes if self.policy.transfer else None)

    def _make_observer(self, quantities: dict[str, Quantity]) -> Observer:
        return super()._make_observer({name: q for name, q in quantities.items() if q.load_factor is None})

    def _carried(self, frame: Frame) -> np.ndarray:
        """The last modes on a new mesh."""
        count = len(self.modes)
        columns = np.concatenate([frame.reseat(mode.reshape(-1, 2)) for mode in self.modes], axis=1)
        there = transfer(self.mesh, frame.mesh, columns).reshape(-1, count, 2)
        return there.transpose(1, 0, 2).reshape(count, -1)

    def _flip(self, frame: Frame) -> None:
        super()._flip(frame)
        for operator in self.whole:
            operator.patch(0, frame.changed_cells)
        if frame.reseats:

            def reseat(modes: np.ndarray) -> np.ndarray:
                return np.stack([frame.reseat(mode.reshape(-1, 2)).ravel() for mode in modes])

            self.modes = reseat(self.modes) if len(self.modes) else self.modes
            self.critical.history = [reseat(block) for block in self.critical.history]

    def _solve(self, frame: Frame, new_mesh: bool) -> LinearReport:
        report = super()._solve(frame, new_mesh)
        physics, before = self.physics, self.modes
        with self.stages("values"):
            params, rest = self.geometric.params(self.x), np.zeros_like(self.x)
            X = physics.mesh.X
            geometric = self.whole[0].assemble([(0, self.geometric.element, X, rest, params, self.sign)], None)
            stiffness = self.mat
            if self.comm.size > 1:
                terms = [(0, physics.element, X, rest, physics.stiffness_params, 1.0)]
                stiffness = self.whole[1].assemble(terms, None)
        self.most = self._most()
        new_system = new_mesh or self.failed or frame.scene is not self.scene
        certain = frame.settled or self.counted.due(frame.mesh)
        self._find(stiffness, geometric, before, new_system, certain)
        if self.eigen.counted:
            self.counted.take(frame.mesh)
        return self._told(report)

    def _find(
        self, stiffness: PETSc.Mat, geometric: PETSc.Mat, before: np.ndarray, new_system: bool, certain: bool
    ) -> None:
        """Solve for the load factors; modes are numbered after those before."""
        held, count = self.physics.constrained, self.plan.settings("buckling").modes
        found, self.eigen = self.critical.solve(stiffness, geometric, held, count, self.most, new_system, certain)
        self.load_factors, self.modes, self.predicted = -1.0 / found.values, found.modes.copy(), False
        with self.stages("observe"):
            self._number(before)

    def _confirm(self, report: LinearReport) -> LinearReport:
        """Count the load factors of the last solution, now that the hand rests, and find those that are missing."""
        pencil = self.critical.pencil
        self._find(pencil.mass, pencil.stiffness, self.modes, False, True)
        # The same modes twice say nothing of where the next ones lie.
        self.critical.history = self.critical.history[:1]
        self.observed = None
        self.counted.take(self.mesh)
        return self._told(report)

    def _told(self, report: LinearReport) -> LinearReport:
        """The report of a solve at rest and of what was found for it."""
        return LinearReport(
            report.iterations + self.eigen.iterations,
            report.refreshed or self.eigen.refreshed,
            report.age,
            report.preconditioner,
        )

    def _number(self, before: np.ndarray) -> None:
        """Number the modes as those before that they look like; those of the first frame in their order."""
        self.heavy = np.empty_like(self.modes)
        pencil = self.critical.pencil
        pencil.apply(pencil.mass, self.modes, self.heavy)
        if len(before) and len(self.modes):
            self.following(before, self.modes, self.heavy, pencil.norms(before))
        elif len(self.modes):
            upright(self.modes, self.heavy)
            self.following.begin(len(self.modes), np.arange(len(self.modes)))

    def _most(self) -> float:
        """The load factor at which the mean strain is 1: linear elasticity knows nothing beyond; infinite without load.

        The square of the mean strain is twice the strain energy over the stiffness of the body.
        """
        physics, size = self.physics, area(self.physics.mesh)
        strain = float(np.sqrt(2.0 * physics.energies(self.x).sum() / (physics.stiffest * size)))
        # Supports may only carry the body somewhere else: what strain it then has is rounding.
        carried = float(np.abs(self.x).max()) / np.sqrt(size)
        return 1.0 / strain if strain > CARRIED * carried else np.inf

    def _load_factor(self, k: int) -> float:
        """The k-th load factor, from 1; infinite where there is none, not a number where it is not computed."""
        if k > self.plan.settings("buckling").modes:
            return float("nan")
        return float(self.load_factors[k - 1]) if k <= len(self.load_factors) else float("inf")

    # --- for comparison with a cold solve -----------------------------------------------------------------------------

    def cold_differences(self) -> tuple[float, float]:
        """Largest differences of the matrices' entries, and of displacement and load factors, from a cold solve."""
        return cold_differences(self)


def _require_computed(name: str, quantity: Quantity, modes: int) -> None:
    """Refuse a load factor that is not computed."""
    if quantity.load_factor > modes:
        raise UserError(
            f"only {modes} load factors are computed",
            f"quantities.{name}.load_factor",
            f"set effects.buckling.modes to {quantity.load_factor} or more",
        )
