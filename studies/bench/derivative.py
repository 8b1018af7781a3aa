"""The design derivative by dual numbers beside its two approximations by differences, over their step."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from time import perf_counter
from typing import Any

import numpy as np
from restshape_studies.bench.drape_derivative import is_drape, measure_drape

from restshape import _kernels
from restshape.analysis.frame import Frame
from restshape.errors import ReplayProblem, UserError
from restshape.fem.residuals import unconstrained_residual
from restshape.interface.run import Run
from restshape.replay.request import Request
from restshape.replay.sessions import session_of
from restshape.sensitivity.steady_derivative import design_derivative

STEPS = tuple(10.0 ** (-0.5 * k) for k in range(3, 29))
"""Steps of the differences, in sizes of the shape."""
EXACT = 1e-12
"""Tolerance of all solves here: `solve.tolerance` must be as small."""
NO_CELLS = np.empty(0, dtype=np.int32)


class LinearisedScene:
    """A replay that has stopped where a hand takes hold of the shape, and lays its nodes where a study wants them.

    Args:
        request: of a static problem, with a script that drags.

    Raises:
        UserError: the analysis has no design derivative; nothing is dragged that moves the mesh linearly.
    """

    def __init__(self, request: Request) -> None:
        run = Run(replace(request, predict="linear"), summed=False)
        replay = run.replay
        self.replay, self.analysis = replay, replay.analysis
        self.scene, self.script = request.scene, request.script
        if not any(replay.prediction.made for _ in run):
            raise UserError("the script drags nothing that moves the mesh linearly", str(request.scene.path), "--edits")
        self.Psi, self.mesh = replay.moving.field_motion, self.analysis.space
        self.X, self.x = self.mesh.X.copy(), self.analysis.x.copy()

    def farthest(self) -> np.ndarray:
        """Where (2,) the hand is farthest from where it took hold in this drag, in its coefficients."""
        taken, places = self.replay.row["line"], [(0.0, 0.0)]
        for edit in session_of(self.scene, self.script, self.replay.moving.outline).frames():
            if edit.line > taken and edit.do == "release":
                break
            if edit.line > taken and edit.change == "move":
                places.append(edit.c)
        return np.array(max(places, key=lambda c: c[0] ** 2 + c[1] ** 2))

    def lay(self, dX: np.ndarray) -> bool:
        """Lay the nodes dX (n, 2) [m] from where they were grabbed; returns whether no triangle is inverted."""
        self.mesh.X[...] = self.X + dX
        corners = np.ascontiguousarray(self.mesh.cells[:, :3])
        return _kernels.check_cells(self.mesh.X, corners, 0.0, 0.0)[1] == 0

    def solve(self, start: np.ndarray) -> Any:
        """Solve where the nodes lie, from a displacement (n, 2) [m]; the analysis's report."""
        self.analysis.predictor.set_values(start)
        return self.analysis.solve(Frame(self.mesh, NO_CELLS, None, self.scene, (None, (0.0, 0.0))))

    def derivative(self, Psi: np.ndarray) -> np.ndarray:
        """s (2, n, 2) where the nodes were grabbed."""
        self.lay(np.zeros_like(self.X))
        self.solve(self.x)
        self.x = self.analysis.x.copy()
        return design_derivative(self.analysis, Psi, EXACT)


def measure(request: Request, by: Sequence[str] = (), only_times: bool = False) -> dict[str, Any]:
    """Differences from the derivative by dual numbers, relative to it, a step each; and what each way costs.

    Args:
        request: as for `LinearisedScene`, with `solve.tolerance` at `EXACT`.
        by, only_times: of cloth alone, as of `measure_drape`.

    Raises:
        UserError: as `LinearisedScene`; a derivative cannot be had.

    Returns: steps (of the size of the shape), forward, central (5.13 of the thesis) and semi (5.14): None where
        there is no answer; ms of one derivative each way; triangles, unknowns. Of cloth as `measure_drape`.
    """
    if is_drape(request.scene):
        return measure_drape(request, by, only_times)
    linearised = LinearisedScene(request)
    both = linearised.derivative(linearised.Psi)
    direction = int(np.linalg.norm(both[1]) > np.linalg.norm(both[0]))
    dX, s = linearised.Psi[direction], both[direction]
    scale, size = np.linalg.norm(s), linearised.replay.session.outline.size
    if not scale > 0.0:
        raise UserError("the drag does not change the answer", str(request.scene.path), "load the body")
    ways = {"forward": _forward, "central": _central, "semi": _semi}
    found: dict[str, Any] = {name: [] for name in ways}
    for name, way in ways.items():
        for step in STEPS:
            try:
                found[name].append(float(np.linalg.norm(way(linearised, dX, step * size) - s) / scale))
            except ReplayProblem:
                found[name].append(None)
    times = {name: _milliseconds(lambda way=way: way(linearised, dX, 1e-6 * size)) for name, way in ways.items()}
    one = np.stack([dX, np.zeros_like(dX)])
    linearised.derivative(one)
    times["dual"] = _milliseconds(lambda: design_derivative(linearised.analysis, one, EXACT))
    return {
        "steps": list(STEPS),
        **found,
        "ms": times,
        "elements": len(linearised.mesh.cells),
        "unknowns": int(linearised.x.size),
    }


def _answer(linearised: LinearisedScene, dX: np.ndarray) -> np.ndarray:
    """The displacement (n, 2) [m] with the nodes moved by dX (n, 2) [m], from the one before."""
    if not linearised.lay(dX):
        raise ReplayProblem("a triangle is inverted")
    linearised.solve(linearised.x)
    return linearised.analysis.x.copy()


def _forward(linearised: LinearisedScene, dX: np.ndarray, h: float) -> np.ndarray:
    return (_answer(linearised, h * dX) - linearised.x) / h


def _central(linearised: LinearisedScene, dX: np.ndarray, h: float) -> np.ndarray:
    return (_answer(linearised, 0.5 * h * dX) - _answer(linearised, -0.5 * h * dX)) / h


def _semi(linearised: LinearisedScene, dX: np.ndarray, h: float) -> np.ndarray:
    """Forces by differences at constant displacement, then one solve with the tangent."""
    physics = linearised.analysis.problem
    forces, places = [], []
    for part in (h, 0.0):
        if not linearised.lay(part * dX):
            raise ReplayProblem("a triangle is inverted")
        physics.update()
        x = linearised.x.copy()
        physics.boundary.apply(x)
        forces.append(unconstrained_residual(physics, x))
        places.append(physics.boundary.values.copy())
    linearised.solve(linearised.x)
    return linearised.analysis.linear_solve((forces[1] - forces[0]) / h, EXACT) + (places[0] - places[1]) / h


def _milliseconds(run: Callable[[], Any], times: int = 5) -> float:
    """The median time [ms] of a few calls."""

    def once() -> Iterator[float]:
        for _ in range(times):
            start = perf_counter()
            run()
            yield 1e3 * (perf_counter() - start)

    return float(np.median(list(once())))
