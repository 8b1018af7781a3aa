"""A live session of a scene, a script or a recording: its parts, made and ended."""

# More than 15 modules: all parts of a session are put together here.

from __future__ import annotations

import gc
import sys
from contextlib import ExitStack
from dataclasses import dataclass
from typing import TYPE_CHECKING

from petsc4py import PETSc

from restshape.calibration import Calibration
from restshape.errors import UserError, printable
from restshape.live.answering import Worker
from restshape.live.growing_script import GrowingScript
from restshape.live.link import Link
from restshape.live.live_recording import LiveRecording
from restshape.live.live_simulation import SolvedBy
from restshape.live.played_events import played_events
from restshape.live.player_controls import PlayerControls
from restshape.live.script_player import ScriptPlayer
from restshape.live.shared_simulation import follow_first_rank, simulation
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene

if TYPE_CHECKING:
    from restshape.interface.simulation import Predict
    from restshape.live.message_loop import MessageLoop
    from restshape.live.worker_options import WorkerOptions
    from restshape.replay.recording.recorder_start import Begun
    from restshape.scene.edit_script import Script
    from restshape.scene.model import Scene


def session(options: WorkerOptions, process: Begun | None = None) -> int:
    """Simulates, or plays, until the server ends the session.

    Args:
        options: of the command line; process: that waits for a recording to write; None: there is none yet.

    Returns:
        The exit code.

    Raises:
        UserError: scene, script, recording or a file to write is bad.
    """
    first = PETSc.COMM_WORLD.rank == 0
    if first and options.link is None:
        raise UserError("no socket to a server was named", "--link", "start restshape live, which starts this")
    link = Link.of_descriptor(options.link) if first and options.link is not None else None
    parts = _of_recording(options, link) if options.is_recording else _of_scene(options)
    if parts is None:
        return 0
    calibration = Calibration.load(options.calibration) if options.calibration else None
    solved_by = SolvedBy(options.policy or parts.policy, options.guess, calibration, options.petsc)
    live = simulation(parts.scene, solved_by, parts.predict)
    # All that stays is there: cycles are looked for again, among what comes.
    gc.freeze()
    gc.enable()
    if link is None:
        follow_first_rank(live)
        return 0
    recording = LiveRecording(options.record, process)
    worker = Worker(link, live, GrowingScript(options.out), recording)
    with ExitStack() as ending:
        # Each of them is done, whatever becomes of the others: other ranks wait for the end of the simulation.
        ending.callback(link.close)
        ending.callback(worker.file.close)
        ending.callback(live.close)
        ending.callback(recording.end, live)
        _start(worker, parts, options.resume)
        worker.run()
    return 0


@dataclass(frozen=True)
class SessionParts:
    """What is simulated.

    Args:
        scene: where it starts; predict: how frames are predicted.
        script: that is played; None: none is.
        at: number of the frame from which the hand goes on at once; None: the page says when.
        policy: of the recording; None: of none. played: the loop that has played it.
    """

    scene: Scene
    predict: Predict
    script: Script | None = None
    at: int | None = None
    policy: str | None = None
    played: MessageLoop | None = None


def _start(worker: Worker, parts: SessionParts, resumed: bool) -> None:
    """Shows the beginning; where the hand takes over what was played before, the frame that it goes on from."""
    if parts.played is not None:
        worker.follow(parts.played)
    if parts.script is not None:
        player = ScriptPlayer(worker.live, played_events(parts.script), worker.moment)
        worker.player = PlayerControls(player, worker, parts.script.text)
        if parts.at is not None:
            progress = worker.progress("frames are computed again")
            player.show(parts.at, progress, lambda: False)
            player.at = min(parts.at, player.computed)
            player.take(progress)
            worker.take_over()
            return
    if not resumed:
        worker.start()


def _of_scene(options: WorkerOptions) -> SessionParts:
    scene = load_scene(options.scene, options.all_overrides)
    script = load_script(options.edits, scene) if options.edits else None
    if script is not None and script.torn and options.link is not None and not options.resume:
        print(printable(f"note: {script.torn}"), file=sys.stderr)
    return SessionParts(scene, options.predict, script)


def _of_recording(options: WorkerOptions, link: Link | None) -> SessionParts | None:
    """Plays a recording; what is simulated once it is taken over, None where it never is.

    Raises:
        UserError: it is no recording; or there are several ranks, of which all but one would have nothing to do.
    """
    if link is None or PETSc.COMM_WORLD.size > 1:
        raise UserError("a recording is played by one process", str(options.scene), "leave mpiexec out")
    if options.edits is not None:
        raise UserError("a recording has its own script", f"--edits {options.edits}", "leave it out")
    # What reads recordings takes a while to load, in which a scene could be on screen.
    from restshape.live.recording_player import RecordingPlayer
    from restshape.live.recording_session import RecordingSession
    from restshape.replay.recording.recording import Recording

    with Recording(options.scene) as recording:
        played = RecordingSession(link, RecordingPlayer(recording), str(options.out or ""))
        if not options.resume:
            played.start()
        gc.enable()
        played.run()
        if played.taken is None and not played.has_more:
            return None
        found = RecordingPlayer(recording)
        script = found.script if played.taken is not None else None
        return SessionParts(found.scene, found.predict, script, played.taken, found.policy, played)
