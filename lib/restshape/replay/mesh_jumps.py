"""By how much quantities jump where the mesh changes: the part of a step that is no answer to the edit."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np

from restshape.algebra.stages import Stages
from restshape.analysis.analysis import Analysis, Context, State
from restshape.analysis.frame import Frame
from restshape.analysis.made_analysis import made_analysis
from restshape.analysis.row_values import number, text
from restshape.errors import ReplayProblem, UserError
from restshape.fem.problem import Problem
from restshape.replay.columns import jump_column, jumps_wanted, refuse_asked_jumps

if TYPE_CHECKING:
    from restshape.analysis.analysis import RowValues
    from restshape.application import Application
    from restshape.mesh.advance import MeshUpdate
    from restshape.mesh.follower import Follower
    from restshape.mesh.moved_meshes import OtherMesh
    from restshape.scene.model import Scene
    from restshape.shape.script_frame import ScriptFrame

log = logging.getLogger(__name__)

OTHER_EDGES = "no jumps of the mesh: the shape before has other edges"
"""Note of a frame with a new mesh that has no shape in common with the old one."""


@contextmanager
def quiet_solvers() -> Iterator[None]:
    """What is decided within is not of the frame: it is logged at -vv alone."""
    logger = logging.getLogger("restshape")
    level = logger.level
    if logger.getEffectiveLevel() == logging.INFO:
        logger.setLevel(logging.WARNING)
    try:
        yield
    finally:
        logger.setLevel(level)


class MeshJumps:
    """Solves once more in frames of level 2 or 3, on the other mesh of the same shape, as if nothing were kept.

    That is the old mesh on the new shape; where its triangles do not bear that, the new mesh on the shape before, whose
    quantities are known. What goes on in time takes the steps of the frame once more, on the old mesh, from the state
    before them; or that state is brought to the new mesh.

    Args:
        scene: of the replay.
        application: of the scene.
        analysis: that gives the quantities.
        context: of the replay.

    Raises:
        UserError: the scene asks for jumps, which cannot be estimated in it.
    """

    def __init__(self, scene: Scene, application: Application, analysis: Analysis[Problem], context: Context) -> None:
        self.application, self.context, self.analysis = application, context, analysis
        self.wanted = jumps_wanted(scene, application)
        refuse_asked_jumps(scene, application)
        self._last: tuple[Scene | None, RowValues] = (None, {})
        self._blank: tuple[Scene | None, RowValues] = (None, {})
        self._before: State[Problem] | None = None
        self._changed: tuple[Follower, MeshUpdate] | None = None
        self._topology: tuple[int, ...] = ()
        self._layout: object = None
        self._incomparable = self._rebuilt = False

    def note(self, moving: Follower, mesh_update: MeshUpdate) -> None:
        """Keep what a frame's mesh is to be compared with, before the frame is solved."""
        self._changed = (moving, mesh_update) if self.wanted and mesh_update.level > 1 else None
        self._before = self.analysis.state if self._changed else None
        self._rebuilt = mesh_update.old_mesh is not None
        known = self._topology
        if self.wanted and moving.mesh.outline.layout is not self._layout:
            self._layout, self._topology = moving.mesh.outline.layout, _topology(moving)
        self._incomparable = mesh_update.level > 2 and bool(known) and known != self._topology

    def _none(self, scene: Scene) -> RowValues:
        """The columns of a frame without numbers."""
        if scene is not self._blank[0]:
            self._blank = scene, {jump_column(name): np.nan for name in scene.quantities}
        return self._blank[1]

    def __call__(self, edit: ScriptFrame, row: RowValues, compare: bool) -> RowValues:
        """The columns of a frame that was solved; not numbers where the mesh stayed, or cannot be compared.

        Args:
            edit: the frame; row: its row.
            compare: whether meshes are compared; else there are no numbers either.
        """
        if not self.wanted:
            return {}
        if not compare:
            self._changed = None
        last, self._last = self._last, (edit.scene, row)
        if self._changed is None and not self._incomparable:
            return self._none(edit.scene)
        found = dict.fromkeys(edit.scene.quantities, np.nan)
        values = _quantities(edit.scene, row)
        others = self._others()
        if others:
            log.info("%4d Mesh jump: the same shape is solved on the other mesh, with nothing kept", edit.index)
        for other in others:
            before = _quantities(edit.scene, last[1]) if last[0] is edit.scene else {}
            if not other.before or before:
                found |= self._jumps(edit.scene, other, before if other.before else values)
        self._changed = None
        jumps: RowValues = {jump_column(name): value for name, value in found.items()}
        if self._incomparable and np.isnan(list(found.values())).all():
            jumps["note"] = "; ".join(filter(None, (text(row, "note"), OTHER_EDGES)))
        return jumps

    def _others(self) -> tuple[OtherMesh, ...]:
        """The meshes beside which the frame's is seen; made of what the next frame will have changed."""
        if self._changed is None:
            return ()
        moving, mesh_update = self._changed
        return moving.other_meshes(mesh_update.old_mesh)

    def _jumps(self, scene: Scene, other: OtherMesh, known: dict[str, float]) -> dict[str, float]:
        """Quantities on the new mesh less those on the old one, of the same shape."""
        context = Context(self.context.comm, self.context.policy, self.context.calibration, Stages())
        cells = np.arange(len(other.mesh.cells), dtype=np.int32)
        frame = Frame(other.mesh, cells, None, scene, (None, (0.0, 0.0)))
        try:
            # After flips the nodes are the same: the preconditioner serves, and the answer is near the other one.
            beside = None if other.before or self._rebuilt else self.analysis.observed_beside(frame, self._before)
            if beside is not None:
                return self._differences(known, beside, -1.0)
            analysis = made_analysis(scene, self.application, context)
            with quiet_solvers():
                found = analysis.observed_on(frame, self._before, self.analysis.state, other.before)
        except (ReplayProblem, UserError):
            return {}
        return self._differences(known, found, 1.0 if other.before else -1.0)

    @staticmethod
    def _differences(known: dict[str, float], found: dict[str, float], sign: float) -> dict[str, float]:
        """What quantities that were found have more than known ones, times a sign, as far as that is a number."""
        # A load factor is infinite where nothing buckles.
        jumps = {name: sign * (found[name] - value) for name, value in known.items() if name in found}
        return {name: jump for name, jump in jumps.items() if np.isfinite(jump)}


def _quantities(scene: Scene, row: RowValues) -> dict[str, float]:
    """The quantities of a frame by their names."""
    return {name: number(row, f"q_{name}") for name in scene.quantities}


def _topology(moving: Follower) -> tuple[int, ...]:
    """How many edges the loops of the shape have, and how many points there are."""
    outline = moving.mesh.outline
    return (len(outline.points), *(len(loop.edges) for loop in outline.loops))
