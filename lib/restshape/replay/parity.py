"""Reuse equals rebuild: each frame against a cold solve on the mesh that it was computed on."""

from typing import Any

import numpy as np
import scipy.sparse as sp

from restshape.algebra.gather import bury, matrix_difference
from restshape.replay.loop import Replay

ENTRIES = 1e-13


class Parity:
    """Compares the frames of a replay with cold ones: new pattern, new values, new factor, no guess.

    Entries are compared relative to the largest; solutions in the energy norm, relative to that of the displacement;
    of modes, frequencies.
    The iteration ends on the residual, so that the solver tolerance bounds this difference only up to the spread of the
    stiffness: that it stays below is checked, not a theorem.

    Args:
        replay: looked at after each of its frames.
    """

    def __init__(self, replay: Replay) -> None:
        self.replay = replay
        self.entries = self.solution = 0.0
        # Cloth has a measure of rest of its own.
        self.tolerance = getattr(replay.analysis, "tolerance", replay.session.scene.solve.tolerance)

    def __call__(self) -> dict[str, float]:
        """The two differences in the frame just computed; none where there was no solution, or a predicted one."""
        if not self.replay.solved or self.replay.row["predicted"]:
            return {}
        if hasattr(self.replay.analysis, "cold_differences"):
            entries, solution = self.replay.analysis.cold_differences()
            bury(self.replay.comm)
        else:
            hot, cold = self.replay.analysis.system(), self.replay.analysis.cold_system()
            bury(self.replay.comm)
            entries = matrix_difference(hot.matrix, cold.matrix)
            solution = energy_distance(cold.matrix, hot.solution, cold.solution, hot.energy)
        self.entries, self.solution = max(self.entries, entries), max(self.solution, solution)
        return {"parity_entries": entries, "parity_solution": solution}

    def summary(self) -> dict[str, Any]:
        """The largest differences over all frames, and whether they are small enough."""
        holds = self.entries <= ENTRIES and self.solution <= self.tolerance
        return {"entries": self.entries, "solution": self.solution, "tolerance": self.tolerance, "holds": bool(holds)}


def energy_distance(matrix: sp.csr_matrix, x: np.ndarray, reference: np.ndarray, energy: float | None = None) -> float:
    """The energy norm of x - reference over that of reference, or over that of a displacement of strain energy [J]."""

    def norm(v: np.ndarray) -> float:
        return float(np.sqrt(max(0.0, v @ (matrix @ v))))

    scale = norm(reference) if energy is None else np.sqrt(2.0 * energy)
    return float(norm(x - reference) / scale) if scale else norm(x - reference)
