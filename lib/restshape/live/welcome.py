"""What a page is told of a session at first, and what has changed since."""

from __future__ import annotations

from math import inf
from time import monotonic
from typing import TYPE_CHECKING

from restshape.application import ShownColumn, application_of
from restshape.live.frame_header import FrameHeaders
from restshape.live.settable_numbers import SceneNumbers
from restshape.scene.edit_script import events_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from restshape.live.live_simulation import LiveSimulation
    from restshape.scene.model import Scene


NEWS = 0.1
"""Seconds at least between two looks for numbers, limits and things that have changed: nobody reads faster."""


class SessionWords:
    """What a page knows of a session besides the pictures of frames.

    Args:
        live: what is simulated.

    Attributes:
        headers: makes those of frames.
    """

    def __init__(self, live: LiveSimulation) -> None:
        self._live, self._numbers = live, SceneNumbers()
        self._said: dict[str, object] = {}
        self._looked: tuple[object, ...] = ()
        self._forms, self._when = True, -inf
        self.headers = FrameHeaders()

    def welcome(self, more: Mapping[str, object]) -> dict[str, object]:
        """All of it but the schemas of events, which `forms` says, with what the session itself has to say."""
        live, scene = self._live, self._live.scene
        self._looked, self._said, self._forms = self._state(), self._found(), True
        return {
            "type": "welcome",
            "scene": scene.path.name,
            "app": scene.app,
            "dim": 3 if live.picture.in_space else 2,
            "role": "hand",
            "trueScale": true_scale(scene),
            "goals": has_goals(scene),
            "goesOn": application_of(scene).transient(scene),
            "fields": fields_said(live),
            "field": live.picture.field,
            "events": {name: {} for name in events_of(application_of(scene))},
            "predicts": predicts_of(live),
            "predict": live.predict,
            **self._said,
            **more,
        }

    def forms(self) -> dict[str, object] | None:
        """The schemas of events, once after each welcome: to make them takes longer than a frame may wait."""
        due, self._forms = self._forms, False
        return {"type": "known", "events": events_said(self._live.scene)} if due else None

    def due(self) -> float | None:
        """In how many seconds to look for changes, where something may have changed too soon; None: nothing has."""
        early = self._when + NEWS - monotonic()
        return early if early > 0.0 and self._outdated() else None

    def _outdated(self) -> bool:
        """Whether something may not be as it was when it was looked at last."""
        state = self._state()
        return len(state) != len(self._looked) or any(one is not other for one, other in zip(state, self._looked))

    def changed(self) -> dict[str, object] | None:
        """What is not as it was when it was said last; None where all is."""
        if not self._outdated():
            return None
        self._looked, found, self._when = self._state(), self._found(), monotonic()
        new = {key: value for key, value in found.items() if value != self._said.get(key)}
        self._said = found
        return {"type": "known", **new} if new else None

    def _state(self) -> tuple[object, ...]:
        """What numbers, quantities and things follow from."""
        live = self._live
        outline = live.sim.replay.session.outline
        return live.scene, outline.layout if outline is not None else live.sim.replay.solver.space

    def _found(self) -> dict[str, object]:
        scene = self._live.scene
        numbers = [one.said() for one in self._numbers(scene)]
        things = [one.said() for one in self._live.picture.things()]
        return {"numbers": numbers, "things": things, "quantities": quantities_said(scene)}


def fields_said(live: LiveSimulation) -> list[dict[str, object]]:
    """The fields that may be shown."""
    return [
        {"name": name, "label": look.label, "unit": look.unit, "signed": look.signed, "fromZero": look.from_zero}
        for name, look in live.picture.choice.looks.items()
    ]


def quantities_said(scene: Scene) -> list[dict[str, object]]:
    """The quantities of a scene, and the columns shown as such, with their limits as they are now."""
    known = [_quantity_said(name, one.unit, one.min, one.max) for name, one in scene.quantities.items()]
    return known + [columns_said(one) for one in application_of(scene).shown_columns(scene)]


def columns_said(one: ShownColumn) -> dict[str, object]:
    """A column that is shown as a quantity."""
    return _quantity_said(one.name, one.unit, one.least, one.most)


def _quantity_said(name: str, unit: str, least: float | None, most: float | None) -> dict[str, object]:
    limits = {"limitLow": least, "limitHigh": most}
    return {"name": name, "unit": unit} | {key: value for key, value in limits.items() if value is not None}


def events_said(scene: Scene) -> dict[str, object]:
    """The JSON schema of each event that scripts of a scene may have."""
    known = events_of(application_of(scene))
    return {name: model.model_json_schema(by_alias=True) for name, model in known.items()}


def predicts_of(live: LiveSimulation) -> list[str]:
    """The ways in which frames may be predicted, "none" first."""
    return ["none"] if live.sim.replay.analysis.predictor is None else ["none", "linear", "gmls"]


def true_scale(scene: Scene) -> bool:
    """Whether deformations are shown as they are."""
    app = application_of(scene)
    large = any(name in scene.effects for one in app.physics for name in one.true_scale)
    return large or not app.editing.has_mesh or any(one.pictures for one in app.physics)


def has_goals(scene: Scene) -> bool:
    """Whether pictures show where the shape should be, so that deformations are shown as they are to begin with."""
    sections = (item for one in application_of(scene).physics for item in one.sections.items())
    return any(section.curve and scene.sections.get(key) for key, section in sections)
