"""The rows of frames: what all applications report of each, and what one of them adds."""

from __future__ import annotations

from math import nan
from typing import TYPE_CHECKING

import numpy as np

from restshape.analysis.row_values import findings_in
from restshape.fem.observer import areas
from restshape.findings import encode_findings
from restshape.replay.columns import SIMULATED, limit_column
from restshape.replay.constraints import (
    MovingLimits,
    constraint_status,
    formatted_constraint,
    joined,
    moving_limits,
    violated_constraints,
)

if TYPE_CHECKING:
    from restshape.algebra.linear_report import LinearReport
    from restshape.analysis.row_values import RowValue, RowValues
    from restshape.mesh.advance import MeshUpdate
    from restshape.replay.frame_solver import FrameSolver
    from restshape.scene.model import Scene
    from restshape.shape.script_frame import ScriptFrame


class FrameRows:
    """Makes the row of each frame, but for its times and what is measured off its time.

    Args:
        solver: of the frames.
        scene: whose quantities have limits.

    Attributes:
        edit: the frame of the session that the last row is of; None before the first.
    """

    def __init__(self, solver: FrameSolver, scene: Scene) -> None:
        self.solver, self.analysis, self.prediction = solver, solver.analysis, solver.prediction
        self.limits, self._moving = MovingLimits(), moving_limits(scene)
        self.edit: ScriptFrame | None = None
        self._columns = Columns()

    def observed(self, scene: Scene, refused: str) -> dict[str, float]:
        """The quantities of a frame; no numbers in a refused one, whose last solution is of another shape."""
        if refused:
            return dict.fromkeys(scene.quantities, nan)
        if self.solver.known:
            return self.analysis.observe()
        return areas(self.solver.moving.field_mesh, scene.quantities)

    def __call__(
        self,
        edit: ScriptFrame,
        mesh_update: MeshUpdate,
        report: LinearReport,
        quantities: dict[str, float],
        refused: str,
    ) -> RowValues:
        """The row of a frame.

        Args:
            edit: the frame; mesh_update: what it did to the mesh; report: what its solve did.
            quantities: of `observed`.
            refused: why it shows the last solution; empty where it has one.
        """
        self.edit, solver, limits = edit, self.solver, self.limits(edit.scene.quantities)
        violated = violated_constraints(limits, quantities) if limits and quantities else ()
        row: RowValues = {
            "index": edit.index,
            "t": edit.t,
            "line": edit.line,
            "event": edit.do,
            "level": mesh_update.level,
            "flips": mesh_update.flips,
            "min_quality": mesh_update.min_quality,
            "pc_age": report.age,
            "pc_rebuilt": int(report.refreshed),
            "iterations": report.iterations,
            "newton": report.newton,
            "preconditioner": report.preconditioner,
            "unknowns": self.analysis.unknowns,
            "elements": len(solver.space.cells if solver.known else solver.moving.mesh.cells),
            "note": self.prediction.note if self.prediction and not refused else "",
            "constraint_status": constraint_status(limits, quantities) if limits else "",
            "violated_constraints": "; ".join(map(formatted_constraint, violated)) if violated else "",
            "findings": violated,
        }
        columns = self._columns
        for name, value in quantities.items():
            row[columns[name]] = value
        if self._moving:
            row.update(self._moved(edit.scene))
        row["predicted"], row["refused"], row["stale"] = int(solver.predicted), refused, int(bool(refused))
        if self.prediction:
            row.update(self.prediction.row())
        if solver.known and (own := self.analysis.row()):
            row.update(joined(row, without_values(own) if refused else own))
        row["findings"] = encode_findings(findings_in(row)) if row["findings"] else ""
        return row

    def _moved(self, scene: Scene) -> dict[str, float]:
        """The limits of a frame that follow parameters."""
        return {limit_column(name, key): getattr(scene.quantities[name], key) for name, key in self._moving}


class Columns(dict[str, str]):
    """The columns of quantities by name, each made once."""

    def __missing__(self, name: str) -> str:
        column = self[name] = f"q_{name}"
        return column


def without_values(own: RowValues) -> RowValues:
    """The columns of an analysis in a frame that was refused: no numbers, no texts.

    The simulated time stands still, and the mesh is that of the last solution.
    """
    return {name: value if name in (SIMULATED, "elements") else _no_value(value) for name, value in own.items()}


def _no_value(value: RowValue) -> RowValue:
    if isinstance(value, str | tuple):
        return "" if isinstance(value, str) else ()
    return -1 if isinstance(value, int | np.integer) else float("nan")
