"""What is odd about a script, reported before it is replayed many times: refused edits, another scene's name."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

from restshape.outputs.si_numbers import counted

if TYPE_CHECKING:
    from restshape.scene.edit_script import Script
    from restshape.scene.model import Scene


def note_script(scene: Scene, script: Script, path: Path) -> None:
    """Prints what is odd about a script for a scene; nothing where all is well."""
    for warning in script.warnings:
        print(f"note: {warning}", file=sys.stderr)
    if scene.mesh.file:
        # The outline is that of the mesh, which is not read here.
        return
    from restshape.replay.sessions import session_of

    refused = [frame for frame in session_of(scene, script).frames() if frame.refused]
    if refused:
        are = "is" if len(refused) == 1 else "are"
        first, why = refused[0], str(refused[0].refused).splitlines()[0]
        print(
            f"note: {counted(len(refused), 'frame')} of {path} {are} refused, "
            f"the first in line {first.line}: {why}; see restshape check",
            file=sys.stderr,
        )
