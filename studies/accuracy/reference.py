"""What a study counts errors from: the same shapes, solved far finer."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import sqrt
from pathlib import Path
from typing import Any

from restshape_studies.accuracy.setting import (
    present,
    refusal,
    scale_of,
    scaled,
    shown,
    study_parameters,
    times,
    unknowns,
)
from restshape_studies.bench.job import STOPPED, Job, Outcome
from restshape_studies.verification import StudyParameter

from restshape.application import Application
from restshape.errors import UserError
from restshape.scene.load import load_scene
from restshape.scene.model import CircleLoop, Scene
from restshape.shape.build import outline_from_spec

Row = dict[str, Any]

FINER = 4.0
"""How many times as fine as the finest point the reference is, where so many unknowns are affordable."""
COARSER = 1.5
"""How many times as coarse as the reference the second one is, from which its own error is reported."""
COARSE_FACTOR = 2.0
"""The same for time steps and other factors, which must leave whole numbers whole."""
MOST_CORNERS = 60
FEWEST = 2
"""Frames that hold an edit, at least."""
MODULE = "restshape_studies.accuracy.replays"


@dataclass
class Plan:
    """How the reference is solved.

    Args:
        factor: of the scene's mesh size; order: of the elements; corners: how many times as fine at corners.
        policy: "rebuild", or "refactor" for motion and folds, which go on from frame to frame.
        tolerances: of the solver, the next where one cannot be reached.
        turned: keys of study parameters and the values that they have in it, for people.
        overrides: ``key=value`` of all but sizes.
        coarse: the same of the coarser reference, whose factors of study parameters are COARSE_FACTOR times as large.
    """

    factor: float
    order: int
    corners: float
    policy: str
    tolerances: tuple[float, ...]
    turned: dict[str, str] = field(default_factory=dict)
    overrides: tuple[str, ...] = ()
    coarse: tuple[str, ...] = ()

    def sizes(self, scene: Scene, coarser: float = 1.0) -> tuple[str, ...]:
        """``key=value`` of the mesh sizes, or of those of a coarser reference."""
        factor = coarser * self.factor
        found = dict(pair.split("=") for pair in scaled(scene, factor)) if factor != 1.0 else {}
        near = factor * scene.mesh.size / self.corners
        for name in corners(scene):
            key = f'mesh.near."{name}"'
            found[key] = repr(min(near, float(found.get(key, near))))
        return tuple(f"{key}={value}" for key, value in found.items())


def corners(scene: Scene) -> list[str]:
    """Vertices of a scene's shape but for those of circles; none where they are too many to be refined one by one."""
    outline = outline_from_spec(scene.shape, scene.folder)
    round_holes = {
        name for name, loop in (scene.shape.holes | scene.shape.regions).items() if isinstance(loop, CircleLoop)
    }
    names = [name for name in outline.vertex_names if name.rpartition(".")[0] not in round_holes]
    return names if len(names) <= MOST_CORNERS else []


def planned(path: Path, given: Sequence[str], application: Application, finest: float) -> Plan:
    """How the reference of a scene is solved.

    Args:
        path: scene file; given: ``key=value`` as after --set.
        application: of the scene.
        finest: factor of the mesh size of the finest point.

    Raises:
        UserError: no reference can be had.
    """
    scene = load_scene(path, given)
    scale = scale_of(scene, application)
    turned, overrides, coarse = {}, (), ()
    for parameter in study_parameters(scene, application):
        if parameter.reference is None:
            continue
        changed = _fine(scene, application, parameter)
        overrides += changed
        coarse += (
            times(scene, application, parameter, COARSE_FACTOR * parameter.reference) if parameter.factors else ()
        ) or changed
        turned |= {key: _plain(value) for key, _, value in (pair.partition("=") for pair in changed)}
    whys = {}
    for order in sorted(application.orders, reverse=True):
        whys[order] = refusal(path, (*given, *overrides, f"mesh.order={order}"))
        if not whys[order]:
            break
    else:
        with_these = f", with {', '.join(overrides)}," if overrides else ""
        what = f"the reference{with_these} cannot be had: {next(iter(whys.values()))}"
        check = " ".join(["restshape check", str(path), *(f"--set {one}" for one in overrides)])
        raise UserError(what, str(path), f"change the scene until it can be solved so, too ({check})")
    overrides, coarse = ((*some, f"mesh.order={order}") for some in (overrides, coarse))
    fine = load_scene(path, (*given, *overrides))
    affordable = sqrt(unknowns(fine, application, 1.0, order) / scale.reference)
    factor = max(finest / FINER, affordable)
    policy = "refactor" if scale.continues else "rebuild"
    return Plan(factor, order, scale.corners, policy, scale.tolerances, turned, overrides, coarse)


def _fine(scene: Scene, application: Application, parameter: StudyParameter) -> tuple[str, ...]:
    """``key=value`` of a parameter in the reference."""
    if parameter.factors:
        return times(scene, application, parameter, parameter.reference)
    own, value = present(scene, application, parameter.key), parameter.reference
    if isinstance(value, int | float) and own is not None:
        value = max(own, value)
    return (f"{parameter.key}={value}",)


def _plain(value: str) -> str:
    try:
        return shown(float(value))
    except ValueError:
        return value


def quicker(plan: Plan, finest: float, total: int, seconds: float) -> list[str]:
    """What makes a reference cheaper, and last what leaves it more time, with options that differ from those given.

    Args:
        plan: of the reference.
        finest: factor of the mesh size of the finest point.
        total: number of frames replayed; seconds: that the reference may take.
    """
    advice = []
    if total > FEWEST:
        advice.append(f"fewer frames (--frames {max(FEWEST, total // 2)})")
    # Other values than the scene's are tried at its own size. The reference is as fine as is affordable, at most.
    if finest < 1.0 and plan.factor < 1.0 / FINER:
        advice.append("coarser sizes (--sizes 2,1)")
    advice.append(f"more time for it (--reference-seconds {3.0 * seconds:.0f})")
    return advice


BUDGET = ", all that is left of --budget"
"""What a stopped job says besides where not its own time was over, but that of the study."""


def solve(
    job: Job,
    scene: Scene,
    plan: Plan,
    folder: Path,
    frames: Sequence[int],
    play: Callable[[Job], Outcome],
    advice: Sequence[str],
) -> tuple[Row, Row]:
    """What the reference in ``folder/fine`` and the coarser one in ``folder/coarse`` took, and how far they differ.

    Args:
        job: scene, edits, overrides, number of frames.
        scene: of the job.
        plan: of the reference.
        folder: for the files.
        frames: wanted.
        play: runs jobs.
        advice: what to do where it cannot be had; the last one where it takes too long.

    Raises:
        UserError: there is no reference.
    """
    solutions = []
    kinds = ("coarse", COARSER, plan.coarse, ""), ("fine", 1.0, plan.overrides, "coarse")
    for name, coarser, turned, other in kinds:
        own = folder / name
        own.mkdir()
        for tolerance in plan.tolerances:
            overrides = (*job.overrides, *turned, *plan.sizes(scene, coarser), f"solve.tolerance={tolerance!r}")
            details = {"kind": "reference", "frames": list(frames), "folder": str(own)}
            details["coarser"] = str(folder / other) if other else ""
            own_job = Job(job.scene, job.edits, plan.policy, overrides, job.petsc, measure=MODULE, details=details)
            try:
                outcome = play(own_job)
            except UserError as error:
                if tolerance == plan.tolerances[-1]:
                    raise
                outcome = Outcome([], error.what)
            out_of_time = outcome.problem.startswith(STOPPED)
            if out_of_time or (outcome.found and not (set(outcome.found["refused"]) & set(map(str, frames)))):
                break
        if not outcome.found:
            if not out_of_time:
                what = f"the reference has no solution: {outcome.problem or 'it reported nothing'}"
                raise UserError(what, job.scene, ", or ".join(advice[:-1]))
            what = f"the reference was not finished{outcome.problem.removeprefix(STOPPED)}"
            if BUDGET in outcome.problem:
                what += "; nothing is kept before the reference"
                advice = (*advice[:-1], "more time for the study (--budget)")
            else:
                what += " (--reference-seconds)"
            raise UserError(what, job.scene, ", or ".join(advice))
        solutions.append(outcome.found | {"tolerance": tolerance})
    return solutions[1], solutions[0]
