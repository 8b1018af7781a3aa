"""Replays of files that must end in rows, refusals with a message, or a message: whatever else happens is a fault."""

import json
import math
import traceback
import warnings
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from restshape_studies.stability.commanded import command_problem, overwriting_problem
from restshape_studies.stability.example import (
    BYSTANDER,
    EDITS,
    LINK,
    MOST_ELEMENTS,
    RECORDING,
    SCENE,
    SUMMARY,
    TABLE,
    Example,
)
from restshape_studies.verification import FrameCheck, verification

import restshape
from restshape.application import application_of
from restshape.errors import UserError
from restshape.replay.columns import columns_of
from restshape.replay.loop import Replay
from restshape.replay.summary import summarise
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene

ENDLESS = ("mu_", "q_critical")
"""Beginnings of columns that may be infinite: nothing buckles."""
OWN = {"restshape", "apps", "restshape_apps", "studies", "restshape_studies"}
"""Folders of our own code, in a checkout and installed."""
UNDEFINED = ("mode", "cents", "ratio", "strouhal", "nusselt", "bulk_temperature")
"""Kinds of quantities that may have no number: of a mode that is gone, without a swing, a difference, or a stream."""
BLANK = "buckling_mode"
"""Beginning of fields that have no numbers where there are fewer modes than wanted."""


class Fault(AssertionError):
    """What a replay must never do."""


@dataclass
class Played:
    """How a replay ended.

    Args:
        message: of the refusal of the whole, empty where there are frames.
        frames, refused: numbers of frames, and of those refused.
        elements: of the first mesh.
        written: the command replayed it too.
        warned: first words of numpy's warnings.
    """

    message: str = ""
    frames: int = 0
    refused: int = 0
    elements: int = 0
    written: bool = False
    warned: list[str] = field(default_factory=list)

    @property
    def outcome(self) -> str:
        """The exit code of the command, with what a code 0 may mean."""
        if self.elements > MOST_ELEMENTS:
            return "0, too large"
        if self.message:
            return "2, after frames" if self.frames else "2"
        return "0, refused frames" if self.refused else "0"


OUTPUTS = {RECORDING, TABLE, SUMMARY, f"{RECORDING}.lock"}


def play(folder: Path, example: Example) -> Played:
    """How the replay of an example's files ended.

    Raises:
        Fault: a shown number is not finite, a refusal has no message, the command reports or writes something else, or
            a file was changed that is no output.
        BaseException: whatever a user would see a traceback of.
    """
    played = Played()
    before = {**example.inputs(), BYSTANDER: b"mine"}
    (folder / BYSTANDER).write_bytes(before[BYSTANDER])
    (folder / LINK).unlink(missing_ok=True)
    (folder / LINK).symlink_to(BYSTANDER)
    others = {path.name for path in folder.iterdir()}
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            _play(folder, example, played)
        except UserError as error:
            if not error.what.strip():
                raise Fault("a message without words") from error
            played.message = str(error)
        # The command would go on with a mesh that is too large.
        if example.written and played.elements <= MOST_ELEMENTS:
            played.written = True
            if wrong := command_problem(folder, example, played.message, played.frames, played.refused):
                raise Fault(f"restshape replay: {wrong}")
    if example.onto and (wrong := overwriting_problem(folder, example)):
        raise Fault(f"restshape replay: {wrong}")
    if not (folder / LINK).is_symlink():
        raise Fault(f"written over: {LINK}")
    if changed := [name for name, data in before.items() if (folder / name).read_bytes() != data]:
        raise Fault(f"written over: {changed}")
    if new := sorted({path.name for path in folder.iterdir()} - others - OUTPUTS):
        raise Fault(f"left behind: {new}")
    played.warned = sorted({f"{w.category.__name__}: {w.message} ({Path(w.filename).name}:{w.lineno})" for w in caught})
    return played


def _play(folder: Path, example: Example, played: Played) -> None:
    scene = load_scene(folder / SCENE)
    app = application_of(scene)
    script = load_script(folder / EDITS, scene, keep_good=True)
    run = restshape.replay(scene, script, example.policy, predict=example.predict)
    replay = run.replay
    check = verification(app.name).load_frame_check()
    names = set(columns_of(scene, app, example.predict))
    rows = []
    for row in run.rows():
        rows.append(dict(row))
        played.frames, played.elements = len(rows), rows[0]["elements"]
        played.refused += bool(row["refused"])
        if played.elements > MOST_ELEMENTS:
            return
        if unknown := set(row) - names:
            raise Fault(f"frame {row['index']}: no column is known for {sorted(unknown)}")
        if replay.solver.known and not row["refused"]:
            _check(check, replay, row)
    summary = summarise(rows, example.policy, 1)
    json.dumps({key: value for key, value in summary.items() if key != "rows"}, allow_nan=False)
    if script.error:
        played.message = str(script.error)


def _check(check: FrameCheck | None, replay: Replay, row: dict[str, Any]) -> None:
    """Refuse what a frame must not say: what its application's own check finds, or numbers that are none."""
    if check is None:
        _check_numbers(replay, row)
    elif wrong := check(replay.analysis, row):
        raise Fault(f"frame {row['index']} ({row['event']}): {wrong}")


def _check_numbers(replay: Replay, row: dict[str, Any]) -> None:
    """Refuse shown numbers that are none."""
    scene = replay.session.scene
    gone = {f"q_{name}" for name, quantity in scene.quantities.items() if quantity.kind in UNDEFINED}
    # An edit may ask for fewer modes than the columns have room for.
    asked = next((scene.effects[name]["modes"] for name in ("modal", "buckling") if name in scene.effects), 0)
    gone |= {name for name in row if name.startswith(("f_", "mu_")) and int(name.partition("_")[2]) > asked}
    for name, value in row.items():
        if name in gone and math.isnan(value):
            continue
        shown = name.startswith(("q_", "f_", "mu_")) or name in ("residual", "ms", "t")
        endless = name.startswith(ENDLESS) and value == math.inf
        if shown and not (endless or math.isfinite(value)):
            raise Fault(f"frame {row['index']} ({row['event']}): {name} = {value}")
    point, cell = replay.analysis.fields()
    for name, values in {**point, **cell}.items():
        if not (np.isfinite(values).all() or name.startswith(BLANK)):
            raise Fault(f"frame {row['index']} ({row['event']}): the field {name} is not finite")


def signature(error: BaseException) -> str:
    """What distinguishes one fault from another: its kind and the innermost line of restshape's own code."""
    if isinstance(error, Fault):
        return str(error).partition(": ")[2].partition(" = ")[0]
    frames = [f for f in traceback.extract_tb(error.__traceback__) if set(Path(f.filename).parts) & OWN]
    last = frames[-1] if frames else None
    return f"{type(error).__name__} at {Path(last.filename).name}:{last.lineno}" if last else type(error).__name__
