"""What a page is told of a session at first, and when it has changed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from restshape.application import application_of
from restshape.scene.edit_script import events_of

if TYPE_CHECKING:
    from restshape.live.frame_picture import FramePicture
    from restshape.scene.model import Scene


def fields_said(picture: FramePicture) -> list[dict[str, object]]:
    """The fields that may be shown."""
    return [
        {"name": name, "label": look.label, "unit": look.unit, "signed": look.signed, "fromZero": look.from_zero}
        for name, look in picture.choice.looks.items()
    ]


def quantities_said(scene: Scene) -> list[dict[str, object]]:
    """The quantities of a scene with their limits as they are now."""
    found = []
    for name, one in scene.quantities.items():
        limits = {"limitLow": one.min, "limitHigh": one.max}
        found.append({"name": name, "unit": one.unit} | {key: v for key, v in limits.items() if v is not None})
    return found


def events_said(scene: Scene) -> dict[str, object]:
    """The JSON schema of each event that scripts of a scene may have."""
    known = events_of(application_of(scene))
    return {name: model.model_json_schema(by_alias=True) for name, model in known.items()}


def true_scale(scene: Scene) -> bool:
    """Whether deformations are shown as they are."""
    physics = application_of(scene).physics
    return any(name in scene.effects for one in physics for name in one.true_scale) or any(
        one.pictures for one in physics
    )
