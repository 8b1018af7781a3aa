"""The recorder of a replay that is asked for."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from restshape.errors import UserError
from restshape.replay.columns import columns_of
from restshape.replay.recording.recorder import Recorder

if TYPE_CHECKING:
    from restshape.replay.recording.recorder_start import Begun
    from restshape.replay.request import Request

SUFFIX = ".vtkhdf"


def recorder_of(request: Request, path: Path, process: Begun | None = None) -> Recorder:
    """The recorder of a replay; its file is opened while the caller goes on.

    Args:
        request: what is replayed.
        path: of the recording; one that is there is replaced when the first frames are safe.
        process: that has begun to wait for this; None begins one.

    Raises:
        UserError: the file cannot be written, or what is there is no recording.
    """
    refuse_other_names(path)
    columns = columns_of(request.scene, request.application, request.predict)
    return Recorder.start(path, request.header(), columns, wait=False, process=process)


def refuse_other_names(path: Path, option: str = "") -> None:
    """Refuses a file whose name hides what it is; a folder the recorder refuses.

    Args:
        path: of the recording; option: that named it, with a space, for the message.

    Raises:
        UserError: it has another suffix.
    """
    if path.suffix != SUFFIX and not path.is_dir():
        do = f"{option}{path.with_suffix(SUFFIX)}"
        raise UserError("a recording's name ends in .vtkhdf", f"{option}{path}", do)
