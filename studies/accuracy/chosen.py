"""A picked setting: the scene with it, and the whole script run again on that scene."""

# More than 15 modules: what was picked is written as a scene, and studied again like any.

import tempfile
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from time import monotonic
from typing import Any

from restshape_studies.accuracy.front import known_error, percent, rates
from restshape_studies.accuracy.kept_points import KeptPoints
from restshape_studies.accuracy.reference import FINER, planned
from restshape_studies.accuracy.sampling import sampled
from restshape_studies.accuracy.setting import Setting
from restshape_studies.accuracy.study import Case, Deadline, Play, Study, one, referred
from restshape_studies.bench.job import run

from restshape.application import application_of
from restshape.errors import UserError
from restshape.outputs.atomic_files import write_whole
from restshape.outputs.claims import refuse_foreign
from restshape.outputs.kinds import SCENE_MARK, SceneFile
from restshape.outputs.si_numbers import counted
from restshape.scene.load import load_scene
from restshape.scene.overrides import parse_override
from restshape.scene.permits import allow
from restshape.scene.rewritten import rewritten

LEAST_RATE = 0.5
"""Power of the mesh size with which the error of a quantity falls at least, or it counts as one that does not converge:
errors of stress at a re-entrant corner fall with the exponent less 1, which is below 0."""
AGREE = 0.03
"""Share of the error on the finest mesh: references that differ by less in a quantity have it settled between them. One
that grows as h^-p, or falls as the root of h, differs by more between references of which one is 1.5 times as fine."""


def write_scene(case: Case, picked: dict[str, Any], path: Path) -> None:
    """Writes the scene with a picked setting; comments and all other keys stay as they are.

    Args:
        case: scene and overrides.
        picked: the record of the setting.
        path: of the new scene.

    Raises:
        UserError: it cannot be written, or would overwrite the scene.
    """
    if path.resolve() == case.scene.resolve():
        raise UserError("the picked scene would overwrite the one that it is made from", "--write", "name another file")
    changes = [parse_override(override) for override in (*case.overrides, *picked["overrides"])]
    changes += [(("solve", "policy"), picked["policy"]), (("solve", "tolerance"), picked["tolerance"])]
    text = rewritten(case.scene, changes, path)
    # The scene that is written is run, and names what the first one may name.
    allow(case.scene.parent)
    try:
        refuse_foreign(SceneFile(path), str(path))
        write_whole(path, SCENE_MARK + text)
    except OSError as error:
        raise UserError(f"{path} cannot be written: {error.strerror}", "--write", "name another file") from error


def rerun(
    study: Study,
    picked: dict[str, Any],
    path: Path,
    within: float | None,
    error: float | None,
    on_run: Callable[[str], None],
    play: Play = run,
) -> dict[str, Any]:
    """What the written scene gives over the whole script: time, error, and whether what was asked for holds.

    Motion is run over as many frames as the study took, for its reference has no others.

    Args:
        study: that the setting was picked from.
        picked: its record.
        path: of the scene with it.
        within: median time of a frame [ms]; error: relative; None where not asked for.
        on_run: called with what is run.
        play: runs jobs.
    """
    case, asked = replace(study.case, scene=path, overrides=()), replace(study.asked, frames=0)
    scene = load_scene(path)
    app, script = application_of(scene), case.script(scene)
    limit = study.total if app.transient(scene) else None
    sampling = sampled(scene, script, limit, study.asked.samples, app.transient(scene))
    setting = Setting(1.0, scene.mesh.order or 1, scene.solve.policy, scene.solve.tolerance)
    play = Deadline(monotonic() - study.seconds, asked.budget, play).play
    # The reference is as fine as the study's was.
    own = replace(setting, factor=study.plan.factor / picked["size_factor"] * FINER)
    with tempfile.TemporaryDirectory(prefix="restshape-accuracy-") as folder:
        kept = KeptPoints(Path(folder) / "kept", {})
        plan = planned(path, (), app, own.factor)
        again = referred(case, asked, scene, plan, [own], sampling, kept, on_run, play)
        on_run(f"{case.name}: the picked setting over {counted(again.total, 'frame')}")
        longer = replace(asked, seconds=10.0 * asked.seconds)
        again.asked = longer
        measured = one(again, setting, kept.folder, play, whole=True)
    ms, found = measured["frame_ms"], measured["error"]
    holds = ms is not None and found is not None
    diverges = not_converging(study)
    holds = (
        holds and not diverges and (within is None or ms <= within) and (error is None or known_error(measured) < error)
    )
    return {
        "name": picked["name"],
        "file": path.name,
        "frame_ms": ms,
        "error": found,
        "uncertainty": measured["uncertainty"],
        "frames": again.total,
        "sampled": again.frames,
        "within": within,
        "below": error,
        "holds": bool(holds),
        "problem": measured["problem"],
        "diverges": diverges,
    }


def not_converging(study: Study) -> str:
    """Why the quantity that a setting was picked for has no error that could hold; empty where it converges."""
    name = study.asked.of
    found = "" if name in (None, "field") else stalled(study.records, name)
    return found and f"{name} does not converge: its error falls as {found}; restshape check says where it is taken"


def stalled(records: Sequence[dict[str, Any]], name: str) -> str:
    """The rates of the error of a quantity that does not converge, in words; empty where it converges.

    Its errors, against a reference that has no limit either, fall more slowly than the root of the mesh size. Errors
    of a smooth quantity may do so by chance, as where they change their sign on the coarse meshes; but of that both
    references know the same value.
    """
    policies = [record["policy"] for record in records if not record["varied"]]
    policy = "auto" if "auto" in policies or not policies else policies[0]
    observed = rates(records, policy).get(f"q_{name}", {})
    if not observed or max(observed.values()) >= LEAST_RATE or _settled(records, policy, name):
        return ""
    return ", ".join(f"h^{p:.2f} (order {order})" for order, p in observed.items())


def _settled(records: Sequence[dict[str, Any]], policy: str, name: str) -> bool:
    """Whether both references agree in a quantity far better than the finest meshes of the grid with them."""
    grid = [r for r in records if not r["varied"] and r["policy"] == policy and r.get("quantities", {}).get(name)]
    finest = min((r["size"] for r in grid), default=0.0)
    known = [r["quantities"][name] for r in grid if r["size"] == finest]
    worst = max((one["worst"] for one in known if one["worst"] is not None), default=0.0)
    return worst > 0.0 and known[0]["uncertainty"] < AGREE * worst


def chosen_line(chosen: dict[str, Any]) -> str:
    """Whether a pick holds, in words."""
    wanted = [f"within {chosen['within']:.4g} ms"] if chosen["within"] is not None else []
    wanted += [f"below {percent(chosen['below'])}"] if chosen["below"] is not None else []
    frames = counted(chosen["frames"], "frame")
    if chosen["frame_ms"] is None or chosen["error"] is None:
        return f"{' and '.join(wanted)}: not known over {frames}: {chosen['problem']}"
    status = "holds" if chosen["holds"] else "DOES NOT HOLD"
    if chosen.get("diverges"):
        status += f": {chosen['diverges']}"
    at = "" if chosen["frames"] == 1 else f" at {len(chosen['sampled'])} of them"
    measured = f"{chosen['frame_ms']:.3g} ms a frame, p50, over {frames}"
    measured += f", and an error of {percent(chosen['error'])}{at}"
    if chosen["below"] is not None and (chosen["uncertainty"] or 0.0) >= chosen["below"]:
        measured += f", where the reference itself is known to {percent(chosen['uncertainty'])} only"
    return f"{' and '.join(wanted)}: {status}: {measured}"


def hopeless(chosen: dict[str, Any]) -> bool:
    """Whether no faster setting can hold either: the time was kept and the error not."""
    if chosen.get("diverges"):
        return True
    ms, within, below = chosen["frame_ms"], chosen["within"], chosen["below"]
    return None not in (ms, within, below) and ms <= within and not chosen["holds"]
