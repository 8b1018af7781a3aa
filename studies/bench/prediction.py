"""How fast predicted frames are, and how far from the solved answer."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from statistics import median

from restshape_studies.bench.job import Job, Row, run
from restshape_studies.bench.prediction_ways import compare_ways, difference
from restshape_studies.bench.turns import Announce, Play, found_of, in_turns, median_ratio

from restshape.analysis.analysis import Analysis
from restshape.errors import UserError
from restshape.interface.run import Run
from restshape.replay.request import Request

SHARES = (0.25, 0.5, 0.75, 1.0)
"""Parts of the farthest way of the hand, at which the error is reported."""


def study(name: str, job: Job, repeat: int, announce: Announce, play: Play = run) -> Row:
    """The record of a scene, as `bench predict --json` writes it.

    The frames are timed in processes of their own, predicted and solved in turns; the errors are found in another one.

    Raises:
        UserError: the scene or the script cannot be replayed, or no frame is predicted.
    """
    ahead = replace(job, predict="linear")
    several = replace(job, predict="gmls")
    turns = in_turns(name, {"gmls": several, "predicted": ahead, "solved": job}, repeat, announce, play)
    sampled = [run.rows for run in turns.pop("gmls")]
    runs = {key: [run.rows for run in found] for key, found in turns.items()}
    rows = {key: found[-1] for key, found in runs.items()}
    chosen = [row["index"] for row in rows["predicted"] if row["predicted"] and row["level"]]
    if not chosen:
        raise UserError("no frame of the script is predicted", job.edits, "let it drag, and look at the notes")
    announce(f"{name}: errors")
    errors = found_of(play(replace(ahead, measure="prediction")), ahead)
    return {
        "elements": rows["predicted"][-1]["elements"],
        "unknowns": rows["predicted"][-1]["unknowns"],
        "frames": len(rows["predicted"]),
        "predicted": len(chosen),
        "fps": {key: median(pace(found, chosen) for found in runs[key]) for key in runs},
        "ms": {key: median(spread(found, chosen) for found in runs[key]) for key in runs},
        "session_s": {key: median(session(found) for found in runs[key]) for key in runs},
        "ratios": {
            "frames": median_ratio(*([pace(found, chosen) for found in runs[key]] for key in ("predicted", "solved"))),
            "session": median_ratio(*([session(found) for found in runs[key]] for key in ("solved", "predicted"))),
        },
        "stages": {
            key: median(rows["predicted"][i][f"ms_{key}"] for i in chosen)
            for key in ("edit", "relocate", "observe", "python")
        },
        "iterations": {key: sum(row["iterations"] for row in rows[key]) for key in rows},
        "anchors": anchors(rows["predicted"]),
        **errors,
        "ways": along_drags({"none": runs["solved"], "linear": runs["predicted"], "gmls": sampled}, errors["ways"]),
    }


def pace(rows: Sequence[Row], chosen: Sequence[int]) -> float:
    """Frames a second over the chosen frames."""
    return 1e3 * len(chosen) / sum(rows[i]["ms"] for i in chosen)


def session(rows: Sequence[Row]) -> float:
    """Seconds of a whole session but for its first frame: predicted frames, the solved ones between, corrections."""
    return sum(row["ms"] for row in rows[1:]) / 1e3


def spread(rows: Sequence[Row], chosen: Sequence[int]) -> float:
    """The median time [ms] of the chosen frames."""
    return median(rows[i]["ms"] for i in chosen)


def along_drags(runs: dict[str, list[list[Row]]], errors: Row) -> Row:
    """What each way of prediction costs and gives in the frames of drags.

    Args:
        runs: rows of each run, by way.
        errors: of `measure`, by way.
    """
    found: Row = {}
    for way, several in runs.items():
        dragged = [[row for row in rows if row["event"] == "drag" and row["level"]] for rows in several]
        last = dragged[-1]
        found[way] = {
            "ms": median(median(row["ms"] for row in rows) for rows in dragged),
            "session_s": median(session(rows) for rows in several),
            "frames": len(last),
            "predicted": sum(bool(row["predicted"]) for row in last),
            "samples": max((row.get("samples", 0) for row in last), default=0),
            "idle_spent": sum(row.get("idle_spent", 0.0) for row in several[-1]),
        }
    return {way: found.get(way, {}) | errors.get(way, {}) for way in (*found, *(set(errors) - set(found)))}


def anchors(rows: Sequence[Row]) -> int:
    """Frames that others are predicted from: solved, with a predicted one next."""
    return sum(not a["predicted"] and bool(b["predicted"]) for a, b in pairwise(rows))


def measure(request: Request) -> Row:
    """The errors of predicted frames against the same frames solved, replayed side by side on the same meshes.

    Args:
        request: with prediction.

    Returns: way: distance of the hand from where its prediction starts [m, or what the gesture's coefficients are];
        of: what the error is of; error: the norm of that of a field over its own, or the largest of values such as
        frequencies, each over its own; quantities: name -> error over the solved value of the same frame; each for all
        predicted frames; at: part of the farthest way -> largest error up to there; ways: of `compare_ways`.
    """
    both = [Run(replace(request, predict=kind), summed=False) for kind in ("linear", "none")]
    ahead, behind = (one.replay for one in both)
    way, error = [], []
    names = [f"q_{name}" for name in request.scene.quantities]
    quantities: dict[str, list[tuple[float, float]]] = {name: [] for name in names}
    for found, true in zip(*(one.rows() for one in both)):
        if not (found["predicted"] and found["level"]) or true["refused"]:
            continue
        way.append(ahead.prediction.distance)
        error.append(difference(ahead.analysis, behind.analysis))
        for name in names:
            quantities[name].append((found[name] - true[name], abs(true[name])))
    farthest = max(way, default=0.0)
    return {
        "way": way,
        "of": subject(ahead.analysis),
        "error": error,
        "quantities": {name[2:]: _relative(pairs) for name, pairs in quantities.items()},
        "ways": compare_ways(request),
        "at": {str(s): max((e for w, e in zip(way, error) if w <= s * farthest), default=0.0) for s in SHARES},
    }


def subject(analysis: Analysis) -> str:
    """What `difference` is of: a field, or frequencies of modes, whose own size means nothing."""
    found = analysis.solution()
    if found.field is None:
        return f"{found.spectrum}, the largest of them"
    return f"{found.name}, norm over all nodes"


def _relative(pairs: Sequence[tuple[float, float]]) -> list[float]:
    """Errors, each over its own value; where that is 0 over the largest of the same quantity, as they are without."""
    largest = max((size for _, size in pairs), default=0.0) or 1.0
    return [error / (size or largest) for error, size in pairs]
