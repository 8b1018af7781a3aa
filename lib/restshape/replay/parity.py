"""Reuse verification: each frame against a cold solve on the mesh that it was computed on."""

from collections import Counter

from restshape.algebra.factors.gathering import clean_up
from restshape.analysis.row_values import whole
from restshape.errors import ReplayProblem
from restshape.replay.loop import Replay

ENTRIES = 1e-13
COMPARED = {0: "still", 1: "level 1", 2: "level 2", 3: "level 3"}
"""Kinds of frames that are compared, by the level of their mesh."""
UNREACHED = "without a cold solution"


class Parity:
    """Compares the frames of a replay with cold ones: new pattern, new values, new factor, no guess.

    Entries are compared relative to the largest; solutions as each analysis measures its own: in the energy norm, or
    by frequencies.
    The iteration ends on the residual, so that the solver tolerance bounds this difference only up to the spread of the
    stiffness: that it stays below is checked, not a theorem.

    Args:
        replay: looked at after each of its frames.

    Attributes:
        entries, solution: the largest differences so far; prediction: the largest of predicted frames, which are none
            of reuse; None: there was none.
        compared: frames by kind; failed: those of them that differ by too much; left_out: the others, by the reason.
    """

    def __init__(self, replay: Replay) -> None:
        self.replay = replay
        self.entries = self.solution = 0.0
        self.prediction: float | None = None
        self.compared: Counter[str] = Counter()
        self.failed: Counter[str] = Counter()
        self.left_out: Counter[str] = Counter()

    def __call__(self) -> dict[str, float]:
        """The differences in the frame just computed; none where it was refused or not solved."""
        row = self.replay.row
        if row["refused"]:
            self.left_out["refused"] += 1
            return {}
        if row["predicted"]:
            return self._predicted()
        if not self.replay.solver.solved:
            self.left_out["unsolved"] += 1
            return {}
        try:
            found = self.replay.analysis.compare_cold()
        except ReplayProblem:
            # From nothing an equilibrium that edits have led to may be out of reach.
            self.left_out[UNREACHED] += 1
            return {}
        clean_up(self.replay.comm)
        kind = COMPARED[whole(row, "level")]
        self.entries = max(self.entries, found.entries)
        if found.solution is None:
            self.left_out["without a step or a load"] += 1
            self.failed[kind] += not found.entries <= ENTRIES
            return {"parity_entries": found.entries}
        self.solution = max(self.solution, found.solution)
        self.compared[kind] += 1
        # What is not a number does not hold.
        self.failed[kind] += not (found.entries <= ENTRIES and found.solution <= self.replay.analysis.tolerance)
        return {"parity_entries": found.entries, "parity_solution": found.solution}

    def _predicted(self) -> dict[str, float]:
        """The distance of a predicted frame from the solved answer, which the prediction itself does not know."""
        predictor = self.replay.analysis.predictor
        assert predictor is not None, "a frame is predicted by a predictor"
        try:
            distance = predictor.compare_cold()
        except ReplayProblem:
            self.left_out[f"predicted {UNREACHED}"] += 1
            return {}
        clean_up(self.replay.comm)
        self.left_out["predicted"] += 1
        self.prediction = max(self.prediction or 0.0, distance)
        return {"parity_prediction": distance}

    def summary(self) -> dict[str, object]:
        """The largest differences, whether they are small enough in all frames that were compared, and which these are.

        What compared nothing does not hold.
        """
        compared, failed = self.compared.total(), self.failed.total()
        return {
            "entries": self.entries,
            "solution": self.solution,
            "tolerance": self.replay.analysis.tolerance,
            "holds": bool(compared and not failed),
            "frames": compared + self.left_out.total(),
            "compared": dict(sorted(self.compared.items())),
            "failed": dict(sorted((+self.failed).items())),
            "left_out": dict(sorted(self.left_out.items())),
            "prediction": self.prediction,
        }
