"""A bar whose freedoms change: its modes, followed by their shapes on a mesh that is kept as long as it can be."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from petsc4py import PETSc
from restshape_apps.metallophone.tuning.freedoms import Freedom, with_values

from restshape.algebra.clusters import clusters
from restshape.algebra.stages import Stages
from restshape.analysis.modal import ModalAnalysis
from restshape.application import application_of
from restshape.calibration import Calibration
from restshape.errors import ReplayProblem, UserError
from restshape.mesh.moving import MovingMesh
from restshape.policy import policy
from restshape.replay.frame_solver import FrameSolver
from restshape.replay.replay_parts import replay_parts
from restshape.replay.request import Request
from restshape.scene.edit_script import Script
from restshape.scene.model import Scene
from restshape.sensitivity.frequency_derivative import nodal_gradient
from restshape.shape.build import unchecked_outline
from restshape.shape.gesture import other_curves, towards
from restshape.shape.outline import Outline
from restshape.shape.session import EditFrame
from restshape.shape.validity import problem

ALIKE = 0.5
"""Modal assurance criterion (MAC) of the last mode and its next one below which it counts as lost."""
STILL = (0.0, 0.0)


@dataclass(frozen=True, eq=False)
class HeldModes:
    """The modes that are held, at one state of a bar.

    Args:
        indices: of each held mode all modes of its cluster, among those that are known.
        frequencies: (m,) [Hz]; of a cluster the root of the mean of its eigenvalues.
    """

    indices: tuple[np.ndarray, ...]
    frequencies: np.ndarray


class Bar:
    """Solves one bar for values of its freedoms, one after the other.

    Args:
        scene: whose curves are held; freedoms: of it.

    Attributes:
        solves: of eigenproblems so far; level: of reuse of the mesh in the last one.
        analysis: of the last one; outline: its shape.

    Raises:
        UserError: the scene cannot be solved.
    """

    def __init__(self, scene: Scene, freedoms: Sequence[Freedom]) -> None:
        self.scene, self.freedoms = scene, tuple(freedoms)
        chosen = policy(scene.solve.policy)
        request = Request(scene, Script.empty(scene), application_of(scene), chosen, Calibration.load())
        parts = replay_parts(request, PETSc.COMM_WORLD, Stages())
        self._solver = FrameSolver(parts, chosen)
        self.analysis: ModalAnalysis = parts.analysis  # type: ignore[assignment]
        self.moving: MovingMesh = parts.moving  # type: ignore[assignment]
        self.outline: Outline = parts.session.outline  # type: ignore[assignment]
        self.solves, self.level, self._frames = 0, 3, 0
        self._now = scene
        try:
            self._solve(self._frame("start", scene, self.outline))
        except ReplayProblem as failed:
            raise UserError(str(failed), str(scene.path), "mend the scene: its shape has no solution") from failed

    def at(self, values: np.ndarray, anew: bool = False) -> bool:
        """Solve with values (k,) of the freedoms, with `anew` on a new mesh; whether there is a solution.

        Without one the bar is as it was.
        """
        try:
            scene = with_values(self.scene, self.freedoms, values)
            outline = unchecked_outline(scene.shape, scene.folder)
            if problem(outline) is not None:
                return False
            self._solve(self._frame("shape" if anew else "move", scene, outline))
        except (UserError, ReplayProblem):
            return False
        self.outline = outline
        return True

    def _frame(self, change: str, scene: Scene, outline: Outline) -> EditFrame:
        gesture, c = None, STILL
        if change == "move":
            same = np.array_equal(outline.points, self.outline.points) and not other_curves(self.outline, outline)
            change = "values" if same else change
            outline = self.outline.moved(outline.points, outline.bulges)
        if change == "move":
            gesture, c = towards("set", self.outline, outline), (1.0, 0.0)
        ended = change in ("start", "shape")
        index, self._frames = self._frames, self._frames + 1
        do = "start" if change == "start" else "set"
        return EditFrame(index, 0.0, 0, do, change, gesture, c, scene, None, outline=outline, edit_ended=ended)

    def _solve(self, frame: EditFrame) -> None:
        try:
            update = self.moving.update(frame)
            self.solves += 1
            self._solver(frame, update)
        except (UserError, ReplayProblem):
            self._solver.rollback()
            raise
        self.level, self._now = update.level, frame.scene

    # --- modes --------------------------------------------------------------------------------------------------------

    def held(self, ids: Sequence[int], before: np.ndarray | None = None) -> HeldModes | None:
        """The held modes; None where one of them is lost.

        Args:
            ids: of them in the last solve that was kept.
            before: (m, n f) their shapes there: on the same nodes they count, and ids across meshes.
        """
        modes = self.analysis.state.modes
        groups, found = clusters(modes.values), []
        same = before is not None and self.level < 3 and before.shape[1] == modes.mass_products.shape[1]
        for number, mode in zip(ids, ids if before is None else before):
            group = self._like(mode, groups) if same else self._of_id(number, groups)
            if group is None:
                return None
            found.append(group)
        means = np.array([modes.values[group].mean() for group in found])
        return HeldModes(tuple(found), np.sqrt(np.maximum(means, 0.0)) / (2.0 * np.pi))

    def _of_id(self, number: int, groups: list[np.ndarray]) -> np.ndarray | None:
        """The cluster of the mode of an id; first in it that mode."""
        places = np.flatnonzero(self.analysis.state.modes.ids.ids == number)
        if not len(places):
            return None
        return next(_first(group, places[0]) for group in groups if places[0] in group)

    def _like(self, mode: np.ndarray, groups: list[np.ndarray]) -> np.ndarray | None:
        """The cluster that looks most like a mode before; first in it the mode that does."""
        shares = (self.analysis.state.modes.mass_products @ mode) ** 2
        sums = [shares[group].sum() for group in groups]
        best = int(np.argmax(sums))
        if sums[best] < ALIKE:
            return None
        return _first(groups[best], groups[best][np.argmax(shares[groups[best]])])

    def vectors(self, held: HeldModes) -> np.ndarray:
        """The shapes (m, n f) of held modes."""
        return self.analysis.state.modes.vectors[[group[0] for group in held.indices]]

    def ids(self, held: HeldModes) -> list[int]:
        """Their ids."""
        return [int(self.analysis.state.modes.ids.ids[group[0]]) for group in held.indices]

    def gradients(self, held: HeldModes) -> list[np.ndarray]:
        """Of each held mode the gradient (n, d) of the logarithm of its frequency by the places of the body's nodes.

        Of a cluster that of the mean of its eigenvalues, a symmetric function of them, which is smooth at crossings.
        """
        values, found = self.analysis.state.modes.values, []
        for group in held.indices:
            total = sum(nodal_gradient(self.analysis, int(mode)) for mode in group)
            found.append(0.5 * total / values[group].sum())
        return found


def _first(group: np.ndarray, mode: int) -> np.ndarray:
    """A cluster with one of its modes before the others."""
    return np.concatenate([[mode], group[group != mode]])
