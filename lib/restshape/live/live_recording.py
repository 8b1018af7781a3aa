"""The recording of a live session: a file that holds the session from its beginning, while it is switched on."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from petsc4py import PETSc

from restshape.errors import UserError
from restshape.replay.recording.request_recorder import recorder_of
from restshape.surroundings import petsc_options

if TYPE_CHECKING:
    from restshape.live.live_simulation import LiveSimulation, Progress
    from restshape.replay.recording.recorder import Recorder
    from restshape.replay.recording.recorder_start import Begun


class LiveRecording:
    """Records the frames of a session.

    Switched on, it begins with the first frame, which is computed again as all the others so far; so the file holds
    what a replay of its script records, whenever it is switched on.

    Args:
        path: of the recording; None: nothing can be recorded.
        process: that has begun to wait for it; None: one is begun when it is needed.
    """

    def __init__(self, path: Path | None, process: Begun | None = None) -> None:
        self._path, self._process = path, process

    @property
    def possible(self) -> bool:
        """Whether a file was named."""
        return self._path is not None

    def switch(self, on: bool, live: LiveSimulation, progress: Progress) -> None:
        """Switches it on or off; in the state in which it is nothing happens.

        Args:
            live: what is recorded; progress: takes how far it is with frames of before.

        Raises:
            UserError: no file was named, or it cannot be written.
        """
        if self._path is None:
            raise UserError("no file was named for a recording", do="start restshape live with --record NAME.vtkhdf")
        if on and live.recorder is None:
            lines, before = live.all_lines(), live.sim
            live.recorder = self._started(self._path, live)
            try:
                live.reopen(lines, live.predict, progress)
                live.recorder.add_header(_surroundings(live))
            except UserError:
                self.give_up(live)
                if live.sim is not before:
                    live.reopen(lines, live.predict, progress)
                raise
        elif not on:
            self.end(live)

    def _started(self, path: Path, live: LiveSimulation) -> Recorder:
        process, self._process = self._process, None
        return recorder_of(live.sim.request, path, process)

    def give_up(self, live: LiveSimulation) -> None:
        """Records no more, where the file cannot be written any further."""
        recorder, live.recorder = live.recorder, None
        live.sim.replay.recorder = None
        if recorder is not None and not recorder.failed:
            with suppress(UserError):
                recorder.close("failed")

    def end(self, live: LiveSimulation) -> None:
        """Ends the file, which has the script so far."""
        recorder, live.recorder = live.recorder, None
        if recorder is not None:
            live.sim.replay.recorder = None
            recorder.add_header({"script_text": live.sim.written.text()})
            recorder.close()
        if self._process is not None:
            self._process.abandon()
            self._process = None


def _surroundings(live: LiveSimulation) -> dict[str, object]:
    """What a header says of ranks and PETSc, as that of a replay."""
    version = [*PETSc.Sys.getVersion()]
    singular = dict(live.sim.replay.errors.singular.ever)
    return {"ranks": PETSc.COMM_WORLD.size, "petsc": version, "petsc_in_effect": petsc_options(), "singular": singular}
