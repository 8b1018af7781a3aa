"""What -v and -vv say of the frames of a replay."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from restshape.outputs.si_numbers import counted

if TYPE_CHECKING:
    from restshape.algebra.linear_report import LinearReport
    from restshape.mesh.advance import MeshUpdate
    from restshape.shape.script_frame import ScriptFrame

log = logging.getLogger("restshape.replay")


def log_refused(edit: ScriptFrame, why: str) -> None:
    """Says that a frame has no solution."""
    log.info("%4d Frame refused: %s", edit.index, why)


def log_frame(edit: ScriptFrame, mesh_update: MeshUpdate, report: LinearReport, predicted: bool) -> None:
    """Says what a frame took, at -vv alone where it kept mesh and preconditioner."""
    level = logging.INFO if report.refreshed or mesh_update.level > 1 else logging.DEBUG
    if log.isEnabledFor(level):
        steps = (counted(report.newton, "Newton step"), counted(report.iterations, "Krylov iteration"))
        done = "predicted" if predicted else ", ".join(steps)
        rebuilt = f"; PC {report.preconditioner} rebuilt" if report.refreshed else ""
        log.log(level, "%4d Frame %s: mesh level %d; %s%s", edit.index, edit.do, mesh_update.level, done, rebuilt)
