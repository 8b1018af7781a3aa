"""A live session of a scene, a script or a recording: its parts, made and ended."""

# More than 15 modules: all parts of a session are put together here.

from __future__ import annotations

from typing import TYPE_CHECKING

from petsc4py import PETSc

from restshape.calibration import Calibration
from restshape.errors import UserError
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
    from restshape.live.worker_options import WorkerOptions
    from restshape.replay.recorder_start import Begun


def session(options: WorkerOptions, process: Begun | None = None) -> int:
    """Simulates until the server ends the session.

    Args:
        options: of the command line; process: that waits for a recording to write; None: there is none yet.

    Returns:
        The exit code.

    Raises:
        UserError: scene, script, recording or a file to write is bad.
    """
    scene = load_scene(options.scene, options.all_overrides)
    script = load_script(options.edits, scene) if options.edits else None
    calibration = Calibration.load(options.calibration) if options.calibration else None
    live = simulation(scene, SolvedBy(options.policy, options.guess, calibration, options.petsc), options.predict)
    if PETSc.COMM_WORLD.rank > 0:
        follow_first_rank(live)
        return 0
    if options.link is None:
        raise UserError("no socket to a server was named", "--link", "start restshape live, which starts this")
    recording = LiveRecording(options.record, process)
    link = Link.of_descriptor(options.link)
    worker = Worker(link, live, GrowingScript(options.out), recording)
    if script is not None:
        player = ScriptPlayer(live, played_events(script), worker.moment)
        worker.player = PlayerControls(player, worker, script.text)
    try:
        if not options.resume:
            worker.start()
        worker.run()
    finally:
        recording.end(live)
        live.close()
        worker.file.close()
        link.close()
    return 0
