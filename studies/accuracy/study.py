"""A work-precision study of a scene: every setting's error and time, against one reference."""

import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from math import inf
from pathlib import Path
from time import monotonic
from typing import Any

from restshape_studies.accuracy.front import mark_pareto
from restshape_studies.accuracy.kept_points import KeptPoints
from restshape_studies.accuracy.record import Truth, record, truth_of
from restshape_studies.accuracy.reference import BUDGET, COARSER, MODULE, Plan, planned, quicker, solve
from restshape_studies.accuracy.sampling import begun, sampled
from restshape_studies.accuracy.setting import Choice, Omission, Setting, scale_of, settings
from restshape_studies.bench.job import STOPPED, Job, Outcome, run

from restshape.application import Application, application_of
from restshape.errors import UserError
from restshape.outputs.si_numbers import counted
from restshape.scene.edit_script import Script, load_script
from restshape.scene.load import load_scene
from restshape.scene.model import Scene

SECONDS = 30.0
REFERENCE_SECONDS = 120.0
Play = Callable[[Job, float], Outcome]


@dataclass(frozen=True)
class Case:
    """A scene with its script.

    Args:
        name: for people.
        scene, edits: files; without edits the first shape alone is studied.
        overrides: ``key=value`` as after --set; petsc: words for PETSc's options database.
    """

    name: str
    scene: Path
    edits: Path | None
    overrides: tuple[str, ...] = ()
    petsc: tuple[str, ...] = ()

    def script(self, scene: Scene) -> Script:
        """The edits of the scene; none where there is no file of them."""
        return load_script(self.edits, scene) if self.edits else Script.empty(scene)

    def job(self, policy: str, more: tuple[str, ...], details: dict[str, Any]) -> Job:
        """A job of a process of the study."""
        overrides = (*self.overrides, *more)
        edits = str(self.edits) if self.edits else ""
        return Job(str(self.scene), edits, policy, overrides, self.petsc, measure=MODULE, details=details)


@dataclass(frozen=True)
class Asked:
    """What a user asks a study for.

    Args:
        choice: what is tried.
        frames: of the script, the first included; None for as many as suit the application, 0 for all.
        samples: frames at which errors are taken.
        seconds: that a point may take; reference_seconds: that a reference may take.
        of: "field", or the name of the quantity whose error counts.
        budget: seconds that the study may take as a whole.
        within: time of a frame [ms] beyond which points are of no use; None: all are.
    """

    choice: Choice = field(default_factory=Choice)
    frames: int | None = None
    samples: int = 5
    seconds: float = SECONDS
    reference_seconds: float = REFERENCE_SECONDS
    of: str = "field"
    budget: float = inf
    within: float | None = None

    def most(self, points: int, references: int = 2) -> float:
        """Seconds that so many points and references take at most."""
        return min(self.budget, points * self.seconds + references * self.reference_seconds)

    def limit(self, scene: Scene, app: Application, script: Script) -> int | None:
        """Number of frames that are replayed; None for all."""
        if self.frames is not None:
            return self.frames or None
        return begun(scene, script, scale_of(scene, app).frames)


@dataclass
class Study:
    """What a study found.

    Args:
        case: scene and script; title: of the scene.
        asked: by the user.
        frames: at which errors were taken; total: number of frames replayed.
        plan: of the reference; reference, coarser: what its processes reported, without the quantities.
        truth: that errors are counted from.
        records: of the points; omissions: what never ran.
        seconds: that the study took.
    """

    case: Case
    scene: Scene
    asked: Asked
    frames: list[int]
    total: int
    plan: Plan
    reference: dict[str, Any]
    coarser: dict[str, Any]
    truth: Truth
    records: list[dict[str, Any]] = field(default_factory=list)
    omissions: list[Omission] = field(default_factory=list)
    seconds: float = 0.0

    @property
    def transient(self) -> bool:
        """Whether it is of motion."""
        return application_of(self.scene).transient(self.scene)

    @property
    def measure(self) -> str:
        """What `error` is of: a measure of the field, or q_NAME."""
        return next((r["measure"] for r in self.records if "measure" in r), "")

    @property
    def uncertainty(self) -> float:
        """The reference's own, in that measure."""
        name = self.measure
        return self.truth.doubt(name[2:]) if name.startswith("q_") else self.truth.uncertainty.get(name, 0.0)


def study(
    case: Case,
    asked: Asked,
    on_run: Callable[[str], None],
    play: Play = run,
    out: Path | None = None,
    on_point: Callable[[list[dict[str, Any]]], None] = lambda records: None,
) -> Study:
    """Every setting's error and time.

    Args:
        case: scene and script; asked: by the user.
        on_run: called with what comes next; on_point: given all points whenever there is one more.
        play: runs jobs.
        out: folder in which a study that is stopped keeps what it has, and goes on; None: it keeps nothing.

    Raises:
        UserError: the scene or the script is of no use for a study, or its reference has no solution.
    """
    start = monotonic()
    scene = load_scene(case.scene, case.overrides)
    app, script = application_of(scene), case.script(scene)
    _refuse_senseless(case, asked, scene, app, script)
    tried, omitted = settings(case.scene, case.overrides, app, asked.choice)
    frames, total = sampled(scene, script, asked.limit(scene, app, script), asked.samples, app.transient(scene))
    plan = planned(case.scene, case.overrides, app, min(setting.factor for setting in tried))
    deadline = Deadline(start, asked.budget, play)
    with tempfile.TemporaryDirectory(prefix="restshape-accuracy-") as folder:
        kept = KeptPoints((out or Path(folder)) / f".{case.name}-points", _question(case, asked, scene, script, total))
        try:
            for line in expected(asked, tried, kept, kept.reference(plan) is not None):
                on_run(f"{case.name}: {line}")
            found = referred(case, asked, scene, plan, tried, (frames, total), kept, on_run, deadline.play)
            found.omissions = omitted
            _run_points(found, tried, kept, deadline, on_run, on_point)
        except KeyboardInterrupt:
            on_run(f"{case.name}: {kept.words()}" if out else f"{case.name}: interrupted: nothing is kept")
            kept.stopped()
            raise
        except UserError:
            kept.stopped()
            raise
    mark_pareto(found.records)
    found.seconds = monotonic() - start
    return found


def expected(asked: Asked, tried: list[Setting], kept: KeptPoints, referred: bool) -> list[str]:
    """What is kept of a study that was stopped, how long the rest may take, and whether the budget may be too short.

    Args:
        asked: by the user.
        tried: all settings.
        kept: points that are known.
        referred: so are both references.
    """
    known = [setting.name for setting in tried if setting.name in kept.records]
    left, lines, references = len(tried) - len(known), [], 0 if referred else 2
    if known or referred:
        what = ["the reference"] * referred + [f"{counted(len(known), 'point')}: {'; '.join(known)}"] * bool(known)
        lines.append(f"kept: {' and '.join(what)}")
    work = f"{counted(left, 'point')}{' left' * bool(lines)} of at most {asked.seconds:g} s"
    work += f", two references of at most {asked.reference_seconds:g} s" * (not referred)
    lines.append(f"{work}: at most {asked.most(left, references):.0f} s in all (--budget, --seconds)")
    if asked.budget < (longest := references * asked.reference_seconds):
        lines.append(
            f"note: --budget of {asked.budget:g} s may end before both references are known, of which nothing is kept: "
            f"they may take {longest:g} s; give more time, or a shorter --reference-seconds"
        )
    return lines


def _run_points(
    found: Study,
    tried: list[Setting],
    kept: KeptPoints,
    deadline: "Deadline",
    on_run: Callable[[str], None],
    on_point: Callable[[list[dict[str, Any]]], None],
) -> None:
    """Gives a study the records of all settings; other arguments as in `study`."""
    waiting = 0
    for k, setting in enumerate(tried, 1):
        record = kept.records.get(setting.name)
        if record is None and (why := too_slow(found.records, setting, found.asked.within)):
            found.omissions.append(Omission(setting.name, why))
            continue
        if record is None and deadline.left > 0.0:
            on_run(f"{found.case.name}: {k} of {len(tried)}: {setting.name}")
            record = deadline.whole(one(found, setting, kept.folder, deadline.play))
            if record:
                kept.add(record)
        if record is None:
            found.omissions.append(Omission(setting.name, SPENT))
            waiting += 1
            continue
        found.records.append(record)
        mark_pareto(found.records)
        on_point(found.records)
    if not waiting:
        kept.done()


SPENT = "the time of --budget is spent: the same command goes on from here"


class Deadline:
    """Runs jobs for no longer than is left of a study's time.

    Args:
        start: of the study, on the monotonic clock.
        budget: seconds that it may take.
        play: runs jobs.
    """

    def __init__(self, start: float, budget: float, play: Play) -> None:
        self.end, self._play = start + budget, play

    @property
    def left(self) -> float:
        """Seconds."""
        return self.end - monotonic()

    def whole(self, record: dict[str, Any]) -> dict[str, Any] | None:
        """A point; None where it was stopped because nothing was left."""
        return None if self.left <= 0.0 and str(record["problem"]).startswith(STOPPED) else record

    def play(self, job: Job, seconds: float) -> Outcome:
        """What a job gives in the time that it may take, and that is left."""
        left = self.left
        outcome = self._play(job, max(min(seconds, left), 0.1))
        cut = left < seconds and outcome.problem.startswith(STOPPED)
        return replace(outcome, problem=outcome.problem + BUDGET) if cut else outcome


def too_slow(records: list[dict[str, Any]], setting: Setting, within: float | None) -> str:
    """Why a setting cannot be picked within a time of a frame [ms]: a coarser mesh takes longer; empty where it may."""
    if within is None or setting.varied:
        return ""
    same = {"order": setting.order, "policy": setting.policy, "varied": ""}
    coarser = [r for r in records if same.items() <= r.items() and r["size_factor"] > setting.factor and r["frame_ms"]]
    slow = next((r for r in coarser if r["frame_ms"] > within), None)
    return f"{slow['name']} takes {slow['frame_ms']:.3g} ms a frame already (--within)" if slow else ""


def _question(case: Case, asked: Asked, scene: Scene, script: Script, total: int) -> dict[str, Any]:
    """All that the points of a study depend on, but for the time that they may take."""
    return {
        "scene": scene.raw,
        "script": script.path.read_text(errors="replace") if script.path else "",
        "overrides": [*case.overrides, *case.petsc],
        "frames": [total, asked.samples],
        "of": asked.of,
    }


def referred(
    case: Case,
    asked: Asked,
    scene: Scene,
    plan: Plan,
    tried: list[Setting],
    sampling: tuple[list[int], int],
    kept: KeptPoints,
    on_run: Callable[[str], None],
    play: Play,
) -> Study:
    """A study with its reference in the folder of what is kept, and no points yet."""
    frames, total = sampling
    finest = min(setting.factor for setting in tried)
    known = kept.reference(plan)
    if not known:
        own = f"reference, size x {plan.factor:.3g}, order {plan.order}"
        on_run(f"{case.name}: {own}, and one {COARSER:g} times as coarse")
    job = case.job(plan.policy, (), {})
    advice = quicker(plan, finest, total, asked.reference_seconds)
    fine, coarse = known or solve(
        job, scene, plan, kept.folder, frames, lambda job: play(job, asked.reference_seconds), advice
    )
    if not known:
        kept.keep_reference(plan, fine, coarse)
    truth = truth_of(scene, fine, coarse)
    return Study(case, scene, asked, frames, total, plan, fine, coarse, truth)


def one(study: Study, setting: Setting, folder: Path, play: Play, whole: bool = False) -> dict[str, Any]:
    """The record of a setting.

    Args:
        study: with its reference.
        setting: to be run.
        folder: of the reference.
        play: runs jobs.
        whole: time every frame.
    """
    details = {"kind": "point", "frames": study.frames, "folder": str(folder / "fine"), "total": study.total}
    job = study.case.job(setting.policy, setting.overrides, details | {"whole": whole})
    try:
        outcome = play(job, study.asked.seconds)
    except UserError as error:
        outcome = Outcome([], error.what)
    return record(study.case.name, study.scene, setting, outcome, study.truth, study.asked.of)


def _refuse_senseless(case: Case, asked: Asked, scene: Scene, app: Application, script: Script) -> None:
    """Refuse what a study cannot answer.

    Raises:
        UserError: naming it.
    """
    if asked.of != "field" and asked.of not in scene.quantities:
        raise UserError(
            f"the scene has no quantity {asked.of!r}", "--of", f"use one of: {', '.join(['field', *scene.quantities])}"
        )
    sets = [event for event in script.events if event.do == "set" and event.key.startswith("mesh.")]
    if sets:
        raise UserError(
            f"the script sets {sets[0].key} itself, which the study varies",
            f"{case.edits}, line {sets[0].line}",
            "name a script that leaves the mesh alone: --edits FILE",
        )
    for order in asked.choice.orders or ():
        if order not in app.orders:
            known = ", ".join(str(order) for order in sorted(app.orders))
            raise UserError(f"{app.name!r} has no elements of order {order}", "--orders", f"use some of: {known}")
