"""What the processes of a study run: the replays of one point, and those of the reference.

`restshape_studies.bench.job.run` calls `measure` of this module in a process of its own.
"""

# More than 15 modules: a point of a study is a whole replay, which all parts of it set up.

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np
from restshape_studies.accuracy.distance import Reference
from restshape_studies.accuracy.sampling import changing, spread
from restshape_studies.accuracy.setting import scale_of
from restshape_studies.accuracy.state import Sampled, State, state_of

from restshape.algebra.factors.gathering import clean_up
from restshape.algebra.stages import Stages
from restshape.analysis.analysis import Context
from restshape.analysis.frame import Frame
from restshape.analysis.made_analysis import made_analysis
from restshape.errors import ReplayProblem, UserError
from restshape.interface.run import Run
from restshape.policy import Policy
from restshape.replay.chosen_frames import ChosenFrames
from restshape.replay.loop import Replay
from restshape.replay.request import Request
from restshape.scene.load import revise

Row = dict[str, Any]

TIGHT = (1e-3, 1e-2, 1e-1)
"""Shares of a point's tolerance that its tight replays are tried with, the next where a frame has no solution."""

FOLLOWED = ("mode", "cents", "ratio")
"""Kinds of quantities of modes by their ids."""

FARTHER = 0.1
"""Share of the tolerance to which what is solved from where it is goes on."""

TIMED = 12
"""Frames, about, that are timed of a replay that keeps nothing from frame to frame, and is slow for that."""

HASTE = 0.02
"""Seconds of a frame below which such a replay is timed in all its frames."""


def measure(request: Request, kind: str, frames: Sequence[int], **details: Any) -> Row:
    """What a process reports: "reference" writes files, "point" reports times and errors.

    Args:
        request: scene, script, policy.
        kind: "reference" or "point".
        frames: indices of the sampled frames, ascending, the first one 0.
        details: as `reference` or `point` take them.
    """
    return {"reference": reference, "point": point}[kind](request, list(frames), **details)


# --- the reference ----------------------------------------------------------------------------------------------------


def reference(request: Request, frames: list[int], folder: str, coarser: str = "") -> Row:
    """Writes a reference for each frame into a folder; returns what it took, and its distance from a coarser one.

    Args:
        request: of the fine scene.
        frames: wanted.
        folder: for the files, ``FRAME.npz``.
        coarser: folder of another reference, of which the distances are reported.
    """
    start = perf_counter()
    transient = request.application.transient(request.scene)
    chosen = _chosen(frames, leap=request.policy.regenerate, every=transient)
    states, refused = _look(Run(request, summed=False, chosen=chosen), chosen, frames)[:2]
    found: Row = {"unknowns": 0, "elements": 0, "refused": refused, "distances": {}, "quantities": {}}
    for index, state in states.items():
        own = Reference.of(state)
        own.save(Path(folder) / f"{index}.npz")
        found["unknowns"], found["elements"] = (max(found[key], state.row[key]) for key in ("unknowns", "elements"))
        found["quantities"][str(index)] = state.quantities
    if coarser:
        for index, state in states.items():
            path = Path(coarser) / f"{index}.npz"
            if path.is_file():
                other = Reference.load(path)
                there = other.sampled(state)
                found["distances"][str(index)] = other.distances(other.solution, there)
    found["seconds"] = perf_counter() - start
    return found


# --- a point ----------------------------------------------------------------------------------------------------------


def point(request: Request, frames: list[int], folder: str, total: int, whole: bool = False) -> Row:
    """Times and errors of one setting.

    Three solutions on the same meshes: that of the setting's own replay, which is timed; that of the same replay at a
    tolerance near rounding; and one from nothing, by a new analysis on the mesh of each sampled frame. Motion, where
    all that came before counts, has for the last a whole replay with a complete factor rebuilt in each solve.

    Args:
        request: of the setting.
        frames: at which errors are taken.
        folder: of the reference.
        total: number of frames of the script that are replayed.
        whole: time all frames, even of replays that keep nothing.
    """
    own, refused, timed = _timed(request, frames, total, whole)
    tight, direct, tolerance, lost = _tight(request, request.policy, frames, refused)
    if request.application.transient(request.scene):
        direct = tight
        if request.policy.solver != "direct":
            policy = replace(request.policy, solver="direct")
            direct, _, _, more = _tight(request, policy, frames, refused, tolerance)
            lost = more | lost
    found = [_frame(Path(folder), index, own.get(index), tight.get(index), direct.get(index)) for index in frames]
    for entry, index in zip(found, frames):
        if index in refused:
            entry["problem"] = f"refused: {refused[index]}"
    return {**timed, "refused": refused, "lost": lost, "tight_tolerance": tolerance, "frames": found}


def _frame(folder: Path, index: int, own: State | None, tight: State | None, direct: State | None) -> Row:
    """Errors of one frame by measure, split into their parts, with the quantities."""
    path = folder / f"{index}.npz"
    if own is None or not path.is_file():
        return {"index": index, "problem": "no solution" if own is None else "no reference"}
    known = Reference.load(path)
    if not known.same_shape(own):
        return {"index": index, "problem": "another shape than the reference has: edits before were refused"}
    u = known.sampled(own)
    estimate = own.row.get("estimate", np.nan)
    entry: Row = {"index": index, "errors": known.distances(known.solution, u), "quantities": own.quantities}
    entry["estimate"] = float(estimate) if np.isfinite(estimate) else None
    others = [state for state in (tight, direct) if state is not None]
    if len(others) == 2 and all(other.grid.same(own.grid) for other in others):
        a, b = (known.sampled(other) for other in others)
        entry["parts"] = split(known, u, a, b)
        entry["quantity_parts"] = quantity_parts(known.solution, u, a, b)
    return entry


def split(known: Reference, u: Sampled, tight: Sampled, direct: Sampled) -> dict[str, dict[str, float]]:
    """Sizes by measure of reference - direct (discretisation), direct - tight (reuse), tight - u (algebraic)."""
    parts = {
        "discretisation": known.distances(known.solution, direct),
        "reuse": known.distances(direct, tight),
        "algebraic": known.distances(tight, u),
    }
    return {measure: {name: part[measure] for name, part in parts.items()} for measure in parts["reuse"]}


def quantity_parts(whole: Sampled, u: Sampled, tight: Sampled, direct: Sampled) -> dict[str, dict[str, float]]:
    """The same of each quantity, with their signs: the three sum to reference - u."""
    return {
        name: {
            "discretisation": value - direct.quantities[name],
            "reuse": direct.quantities[name] - tight.quantities[name],
            "algebraic": tight.quantities[name] - u.quantities[name],
        }
        for name, value in whole.quantities.items()
        if name in u.quantities and name in direct.quantities
    }


# --- replays ----------------------------------------------------------------------------------------------------------


def _timed(request: Request, frames: list[int], total: int, whole: bool) -> tuple[dict[int, State], dict, Row]:
    """States of the sampled frames of the setting's own replay, its refusals, and its times."""
    moving, _ = changing(request.scene, request.script, total)
    some = spread(moving, frames, TIMED)
    alike = request.policy.solver == "direct" and not request.application.transient(request.scene) and not whole
    sparse: list[bool] = []

    def solved(index: int) -> bool:
        if index == 1:
            # Its frames are all alike, for it keeps nothing: some of them show the time of all.
            row = run.replay.row
            sparse.append(alike and row["ms"] > 1e3 * HASTE and not row["newton"])
            chosen.leap = sparse[0] and request.policy.regenerate
        return not (index and sparse[0]) or index in some

    chosen = ChosenFrames(solved, total - 1)
    run = Run(request, summed=False, chosen=chosen)
    states, refused, rows = _look(run, chosen, frames)
    sparse = sparse or [False]
    later = [row for row in rows[1:] if not sparse[0] or row["index"] in some]
    moved = [row["ms"] for row in later if row["level"]] or [row["ms"] for row in later if row["iterations"]]
    if total == 1:
        # Without edits the first frame is all that there is to time.
        moved = [rows[0]["ms"]]
    seconds = (rows[0]["ms"] + sum(row["ms"] for row in later)) / 1e3
    if sparse[0] and moved:
        seconds += (len(moving) - len(moved)) * sum(moved) / len(moved) / 1e3
    timed = {
        "frame_ms": median(moved) if moved else None,
        "total_s": seconds,
        "timed_frames": len(moved),
        "replayed": total,
        "unknowns": max(row["unknowns"] for row in rows),
        "elements": max(row["elements"] for row in rows),
    }
    return states, refused, timed


def _tight(
    request: Request, policy: Policy, frames: list[int], refused: dict[int, str], tolerance: float | None = None
) -> tuple[dict[int, State], dict[int, State], float, dict[int, str]]:
    """States of the sampled frames with a policy at a tolerance near rounding, and from nothing; that tolerance, lost.

    Args:
        request: of the setting.
        policy: in place of the request's.
        frames: wanted.
        refused: frames that have no solution anyway.
        tolerance: in place of shares of the setting's.
    """
    own = request.scene.solve.tolerance
    least = scale_of(request.scene, request.application).tightest
    chosen = [tolerance] if tolerance else [max(least, share * own) for share in TIGHT]
    states: dict[int, State] = {}
    fresh: dict[int, State] = {}
    lost: dict[int, str] = {}
    for chosen_tolerance in chosen:
        scene = revise(request.scene, "solve.tolerance", chosen_tolerance)
        keeps = request.application.transient(request.scene) or policy.solver != "direct"
        leap = policy.regenerate and not request.application.transient(request.scene)
        try:
            asked, wanted = replace(request, scene=scene, policy=policy), _chosen(frames, leap, every=keeps)
            fresh = {}
            again = None if request.application.transient(request.scene) else Afresh(request, fresh)
            states, now, _ = _look(Run(asked, summed=False, chosen=wanted), wanted, frames, again)
        except (ReplayProblem, UserError) as problem:
            # Rounding does not let the first frame get there.
            lost = {0: str(problem)}
            continue
        lost = {index: why for index, why in now.items() if index not in refused}
        if not lost:
            break
    return states, fresh, chosen_tolerance, lost


class Afresh:
    """Solves frames of a replay once more from nothing: new pattern, values and factor, and no guess.

    What has folds begins where it is, for from nothing it may find others, which are as right; and goes on from there.

    Args:
        request: of the replay.
        states: takes the solutions, by frame.
    """

    def __init__(self, request: Request, states: dict[int, State]) -> None:
        self.request, self.states = request, states

    def __call__(self, replay: Replay) -> None:
        """Solve the frame just computed, on the mesh that it was computed on.

        Raises:
            ReplayProblem: it has no solution from nothing.
        """
        scene, kept = replay.session.scene, replay.analysis
        scale = scale_of(scene, self.request.application)
        if scale.continues:
            scene = revise(scene, "solve.tolerance", max(scale.tightest, FARTHER * scene.solve.tolerance))
        policy = replace(replay.policy, solver="direct")
        context = Context(replay.comm, policy, self.request.calibration, Stages())
        analysis = made_analysis(scene, self.request.application, context)
        if scale.continues:
            analysis.start_from(kept)
        none = np.empty(0, dtype=np.int32)
        analysis.solve(Frame(replay.moving.field_mesh, none, None, scene, (None, (0.0, 0.0)), edit_ended=True))
        row = {f"q_{name}": value for name, value in analysis.observe().items()}
        before, now = kept.solution(), analysis.solution()
        for name, quantity in scene.quantities.items():
            if quantity.kind in FOLLOWED:
                # The number that a mode was followed by is not known from nothing, its place among the others is.
                count = min(len(now.values), len(before.ids))
                row[f"q_{name}"] = kept.state.observer.functions[name](now.values[:count], before.ids[:count])
        self.states[replay.row["index"]] = state_of(analysis, replay.session.outline.points, row)
        del analysis
        clean_up(replay.comm)


def _chosen(frames: list[int], leap: bool, every: bool) -> ChosenFrames:
    """What a replay solves for.

    Args:
        frames: wanted.
        leap: leave out all other frames, meshes and all.
        every: solve for all frames, for each one hangs on those before.
    """
    wanted: Callable[[int], bool] = (lambda index: True) if every else set(frames).__contains__
    return ChosenFrames(wanted, frames[-1], leap and not every)


def _look(
    run: Run, chosen: ChosenFrames, frames: list[int], also: Callable[[Replay], None] | None = None
) -> tuple[dict[int, State], dict[int, str], list[Row]]:
    """States of some frames of a run, why other frames have no solution, and rows.

    Args:
        run: not begun yet; chosen: what it solves for.
        frames: wanted.
        also: called at each of these; where it has a problem, the frame counts as one without a solution.
    """
    replay = run.replay
    states: dict[int, State] = {}
    refused: dict[int, str] = {}
    rows, wanted = [], set(frames)
    for row in run.rows():
        rows.append(dict(row))
        if row["refused"]:
            if row["index"] not in chosen.refused:
                refused[row["index"]] = row["refused"]
        elif row["index"] in wanted:
            states[row["index"]] = state_of(replay.analysis, replay.session.outline.points, replay.row)
            if also:
                try:
                    also(replay)
                except (ReplayProblem, UserError) as problem:
                    refused[row["index"]] = f"from nothing: {problem}"
    if not states:
        raise ReplayProblem("no sampled frame has a solution")
    return states, refused, rows
