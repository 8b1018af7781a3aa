"""Replays for programs: of scenes and scripts, and of their files."""

from collections.abc import Collection, Sequence
from pathlib import Path

from petsc4py import PETSc

from restshape.interface.run import Run
from restshape.interface.scripts import refuse_names
from restshape.interface.simulation import Predict
from restshape.replay.chosen_frames import ChosenFrames
from restshape.replay.recording.request_recorder import recorder_of
from restshape.replay.request import Measured, Request
from restshape.replay.tally import Summary
from restshape.scene.edit_script import Script, load_script
from restshape.scene.load import load_scene
from restshape.scene.model import Scene


def replay(
    scene: Scene,
    script: Script | None = None,
    policy: str | None = None,
    guess: str | None = None,
    predict: Predict = "none",
    out: str | Path | None = None,
    csv: str | Path | None = None,
    parity: bool = False,
    summed: bool = False,
    measured: Measured = "all",
    only: Collection[int] | None = None,
    counted: bool = False,
) -> Run:
    """The frames of a script, each as soon as it is computed, by the way that `restshape replay` goes.

    Args:
        scene: where it starts; script: its edits; None: the first shape alone.
        policy, guess, predict, measured: as of `Simulation`.
        out: recording that is written (.vtkhdf); one that is there is replaced. csv: file for a row of numbers a frame.
        parity: compare each frame with a cold solve on the same mesh.
        summed: `Run.summary` can be asked for, which takes some time of each frame.
        only: indices of the frames that are solved for, besides the first; others show no answer, and the last of them
            is the end. None: all.
        counted: `ShownFrame.counts` has what each frame has done, such as factorisations and calls of kernels; PETSc's
            log runs for that, and takes a little of each frame.

    Raises:
        UserError: the scene cannot be simulated, not be predicted, or the file cannot be written; `only` is empty.
    """
    refuse_names(scene, "load")
    refuse_names(script, "load_script")
    request = Request.of(scene, script, policy, guess, predict=predict, measured=measured)
    chosen = None if only is None else ChosenFrames.of(only)
    recorder = recorder_of(request, Path(out)) if out and PETSc.COMM_WORLD.rank == 0 else None
    try:
        table = Path(csv) if csv else None
        return Run(request, recorder, True, parity, table, summed, chosen=chosen, counted=counted)
    except BaseException:
        if recorder:
            recorder.close("interrupted")
        raise


def replay_files(scene: Path, edits: Path, name: str, overrides: Sequence[str] = (), predict: str = "none") -> Summary:
    """The summary of a replay of files under the policy `name`, for studies; nothing is recorded.

    Args:
        scene: scene file.
        edits: edit script.
        name: of the policy.
        overrides: ``key=value`` as after --set.
        predict: as after --predict.
    """
    read = load_scene(scene, overrides)
    script = load_script(edits, read)
    return Run(Request.of(read, script, name, predict=predict), keep_rows=True).to_end()
