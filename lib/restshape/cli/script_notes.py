"""What is odd about a scene and a script, reported before they are replayed many times."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

from restshape.outputs.si_numbers import counted

if TYPE_CHECKING:
    from restshape.scene.edit_script import Script
    from restshape.scene.model import Scene


def note_scene(scene: Scene) -> None:
    """Prints what `restshape check` warns of in a scene; nothing where its shape makes no sense."""
    from restshape.application import application_of
    from restshape.errors import ReplayProblem, UserError
    from restshape.scene.plan import plan

    app = application_of(scene)
    try:
        data, _, _ = app.editing.checked(scene, plan(scene, app))
    except (ReplayProblem, UserError):
        return
    for warning in data.get("warnings", ()):
        print(f"note: {warning}", file=sys.stderr)


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
