"""Which quantities of a replay are taken at singular places, as edits make and remove these."""

from __future__ import annotations

from typing import TYPE_CHECKING

from restshape.analysis.row_values import text, whole
from restshape.errors import ReplayProblem, UserError
from restshape.replay.recorded_places import SINGULAR_PLACES, encode_places, places_wanted

if TYPE_CHECKING:
    from restshape.analysis.analysis import RowValues
    from restshape.application import Application
    from restshape.scene.model import Scene
    from restshape.shape.outline import Outline
    from restshape.shape.protocol import Session
    from restshape.shape.script_frame import ScriptFrame

AT, NO_MORE = "at a singular place from here on", "at no singular place any more"
CAUSES = ("supports", "loads", "material")
"""Tables of a scene that make places of an outline singular."""


class SingularQuantities:
    """Finds the singular places of the first shape, and of those at which an edit begins, ends or is meshed again.

    An edit may also be one of the supports, loads or materials.

    An exponent takes as long as some frames, so that the frames of a drag between keep what was last found, at the
    control points where it was found.

    Args:
        scene: of the replay.
        application: of the scene.
        session: at its first shape.

    Attributes:
        now: quantities without a limit under refinement, with the exponent lambda of displacements; changes in place.
        ever: those of all shapes so far, with the least exponent of each.
    """

    def __init__(self, scene: Scene, application: Application, session: Session) -> None:
        self.application, self.session = application, session
        self._seen, self._moving = (scene, session.outline), False
        self._recorded = places_wanted(scene, application)
        self.now, self._points = self._found(scene, session.outline)
        self.ever = dict(self.now)
        self._encoded: tuple[dict[str, float], list[tuple[float, ...]], str] = ({}, [], "")

    def __call__(self, edit: ScriptFrame, row: RowValues) -> RowValues:
        """Look at the shape of a frame that was solved; its singular places, and the note where they change."""
        note = self._looked(edit, row)
        return note | {SINGULAR_PLACES: self._places()} if self._recorded else note

    def _looked(self, edit: ScriptFrame, row: RowValues) -> RowValues:
        began, self._moving = not self._moving, not edit.edit_ended
        outline, scene = self.session.outline, edit.scene
        # Places are of the shape: flips alone are no reason to look.
        if not (began or edit.edit_ended or whole(row, "level") > 2):
            return {}
        (old, before), self._seen = self._seen, (scene, outline)
        if outline is before and (scene is old or all(getattr(scene, key) == getattr(old, key) for key in CAUSES)):
            return {}
        try:
            found, self._points = self._found(scene, outline)
        except UserError:
            return {}
        come, gone = sorted(found.keys() - self.now.keys()), sorted(self.now.keys() - found.keys())
        self.now.clear()
        self.now.update(found)
        self.ever.update({name: min(value, self.ever.get(name, value)) for name, value in found.items()})
        said = [f"{', '.join(names)} {words}" for names, words in ((come, AT), (gone, NO_MORE)) if names]
        return {"note": "; ".join(filter(None, (text(row, "note"), *said)))} if said else {}

    def _places(self) -> str:
        """What is singular, and where the control points are now, for the row."""
        outline = self.session.outline
        if not self.now or outline is None:
            return ""
        at = [tuple(outline.points[k]) for k in self._points if k < len(outline.points)]
        known, places, encoded = self._encoded
        if places != at or known != self.now:
            encoded = encode_places(self.now, at)
            # Most of them rest while a hand drags one point.
            self._encoded = (dict(self.now), at, encoded)
        return encoded

    def _found(self, scene: Scene, outline: Outline | None) -> tuple[dict[str, float], tuple[int, ...]]:
        """Quantities with their exponents, and control points."""
        found, points = dict[str, float](), tuple[int, ...]()
        for physics in self.application.physics:
            if physics.singular_shape and outline is not None:
                try:
                    singular, places = physics.singular(scene, outline)
                except ReplayProblem:
                    # The frame says what is wrong with the shape.
                    continue
                found, points = found | singular, (*points, *places)
        return found, points
