"""Reuse equals rebuild: each frame against a cold solve on the mesh that it was computed on."""

from restshape.algebra.gathering import clean_up
from restshape.replay.loop import Replay

ENTRIES = 1e-13


class Parity:
    """Compares the frames of a replay with cold ones: new pattern, new values, new factor, no guess.

    Entries are compared relative to the largest; solutions as each analysis measures its own: in the energy norm, or
    by frequencies.
    The iteration ends on the residual, so that the solver tolerance bounds this difference only up to the spread of the
    stiffness: that it stays below is checked, not a theorem.

    Args:
        replay: looked at after each of its frames.
    """

    def __init__(self, replay: Replay) -> None:
        self.replay = replay
        self.entries = self.solution = 0.0

    def __call__(self) -> dict[str, float]:
        """The two differences in the frame just computed; none where there was no solution, or a predicted one."""
        if not self.replay.solved or self.replay.row["predicted"]:
            return {}
        found = self.replay.analysis.compare_cold()
        clean_up(self.replay.comm)
        self.entries, self.solution = max(self.entries, found.entries), max(self.solution, found.solution)
        return {"parity_entries": found.entries, "parity_solution": found.solution}

    def summary(self) -> dict[str, object]:
        """The largest differences over all frames, and whether they are small enough."""
        tolerance = self.replay.analysis.tolerance
        holds = self.entries <= ENTRIES and self.solution <= tolerance
        return {"entries": self.entries, "solution": self.solution, "tolerance": tolerance, "holds": bool(holds)}
