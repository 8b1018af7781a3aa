"""How fast predicted frames are, and how far from the solved answer."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from statistics import median

import numpy as np
from petsc4py import PETSc
from restshape_studies.bench.job import Job, Outcome, Row, run

from restshape.analysis.analysis import Analysis
from restshape.errors import UserError
from restshape.replay.loop import Replay
from restshape.replay.request import Request

SHARES = (0.25, 0.5, 0.75, 1.0)
"""Parts of the farthest way of the hand, at which the error is reported."""


@dataclass(frozen=True)
class Case:
    """One scene with one script under one policy.

    Args:
        name: of the scene, for people.
        job: without prediction.
    """

    name: str
    job: Job


def study(case: Case, repeat: int, on_run: Callable[[str], None], play: Callable[[Job], Outcome] = run) -> Row:
    """The record of a scene, as `bench predict --json` writes it.

    The frames are timed in processes of their own, predicted and solved in turns; the errors are found in another one.

    Raises:
        UserError: the scene or the script cannot be replayed, or no frame is predicted.
    """
    ahead = replace(case.job, predict="linear")
    runs: dict[str, list[Row]] = {"predicted": [], "solved": []}
    rows: dict[str, list[Row]] = {}
    for turn in range(repeat):
        for name, job in (("predicted", ahead), ("solved", case.job)):
            on_run(f"{case.name}: {name}, run {turn + 1} of {repeat}")
            rows[name] = checked(play(job), case)
            runs[name].append(rows[name])
    chosen = [row["index"] for row in rows["predicted"] if row["predicted"] and row["level"]]
    if not chosen:
        raise UserError("no frame of the script is predicted", case.job.edits, "let it drag, and look at the notes")
    on_run(f"{case.name}: errors")
    errors = checked_found(play(replace(ahead, measure="prediction")), case)
    return {
        "elements": rows["predicted"][-1]["elements"],
        "unknowns": rows["predicted"][-1]["unknowns"],
        "frames": len(rows["predicted"]),
        "predicted": len(chosen),
        "fps": {name: median(pace(found, chosen) for found in runs[name]) for name in runs},
        "ms": {name: median(spread(found, chosen) for found in runs[name]) for name in runs},
        "stages": {
            name: median(rows["predicted"][i][f"ms_{name}"] for i in chosen)
            for name in ("edit", "relocate", "observe", "python")
        },
        "iterations": {name: sum(row["iterations"] for row in rows[name]) for name in rows},
        "anchors": anchors(rows["predicted"]),
        **errors,
    }


def pace(rows: Sequence[Row], chosen: Sequence[int]) -> float:
    """Frames a second over the chosen frames."""
    return 1e3 * len(chosen) / sum(rows[i]["ms"] for i in chosen)


def spread(rows: Sequence[Row], chosen: Sequence[int]) -> float:
    """The median time [ms] of the chosen frames."""
    return median(rows[i]["ms"] for i in chosen)


def anchors(rows: Sequence[Row]) -> int:
    """Frames that others are predicted from: solved, with a predicted one next."""
    return sum(not a["predicted"] and bool(b["predicted"]) for a, b in pairwise(rows))


def checked(outcome: Outcome, case: Case) -> list[Row]:
    """The rows of a run that came to its end.

    Raises:
        UserError: it did not.
    """
    if outcome.problem or not outcome.rows:
        raise UserError(
            f"the replay {outcome.problem or 'gave no frames'}", case.job.scene, "see restshape replay on it"
        )
    return outcome.rows


def checked_found(outcome: Outcome, case: Case) -> Row:
    """What a run has measured.

    Raises:
        UserError: nothing.
    """
    if outcome.found is None:
        raise UserError(outcome.problem or "nothing was measured", case.job.scene, "see restshape replay on it")
    return outcome.found


def measure(request: Request) -> Row:
    """The errors of predicted frames against the same frames solved, replayed side by side on the same meshes.

    Args:
        request: with prediction.

    Returns: way: distance of the hand from where its prediction starts [m, or what the gesture's coefficients are];
        of: what the error is of; error: the norm of that of the displacement, or of the frequencies of modes, over its
        own; quantities: name -> error over the largest value; each for
        all predicted frames; at: part of the farthest way -> largest error up to there.
    """
    ahead, behind = (Replay.of(replace(request, predict=kind), PETSc.COMM_WORLD) for kind in ("linear", "none"))
    way, error = [], []
    names = [f"q_{name}" for name in request.scene.quantities]
    quantities: dict[str, list[tuple[float, float]]] = {name: [] for name in names}
    for found, true in zip(ahead.frames(), behind.frames()):
        if not (found["predicted"] and found["level"]) or true["refused"]:
            continue
        x, exact = (answer(replay.analysis)[1] for replay in (ahead, behind))
        way.append(ahead.prediction.distance)
        size = float(np.linalg.norm(exact))
        error.append(float(np.linalg.norm(x - exact)) / size if size > 0.0 else 0.0)
        for name in names:
            quantities[name].append((found[name] - true[name], abs(true[name])))
    farthest = max(way, default=0.0)
    return {
        "way": way,
        "of": answer(ahead.analysis)[0],
        "error": error,
        "quantities": {name[2:]: _relative(pairs) for name, pairs in quantities.items()},
        "at": {str(s): max((e for w, e in zip(way, error) if w <= s * farthest), default=0.0) for s in SHARES},
    }


def answer(analysis: Analysis) -> tuple[str, np.ndarray]:
    """What is predicted, and what it is: a field, or frequencies [Hz] of modes, whose own size means nothing."""
    found = analysis.solution()
    if found.field is None:
        return f"{found.spectrum}, norm over all", found.values
    return f"{found.name}, norm over all nodes", found.field


def _relative(pairs: Sequence[tuple[float, float]]) -> list[float]:
    """Errors over the largest value; as they are where that is 0."""
    scale = max((size for _, size in pairs), default=0.0) or 1.0
    return [error / scale for error, _ in pairs]
