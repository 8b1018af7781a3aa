"""Goals of scenes, recorded ones too, as curves that pictures and live sessions show."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, cast

import numpy as np
from pydantic import BaseModel, ValidationError

from restshape.application import application_of
from restshape.report.field import physics_of
from restshape.scene.model import Scene
from restshape.scene.physics import Section
from restshape.scene.plain_values import tables_in
from restshape.scene.scene_parameters import read_parameters
from restshape.scene.source import Source

if TYPE_CHECKING:
    from restshape.replay.recording.recording import Recording


def goals_in(scene: Scene) -> Iterator[tuple[str, np.ndarray]]:
    """The goals of a scene as it is now, by name: points (m, 2) [m]."""
    for one in application_of(scene).physics:
        for key, section in one.sections.items():
            if section.curve and key in scene.sections:
                for name, table in cast("Mapping[str, BaseModel]", scene.sections[key]).items():
                    yield name, section.curve_of(table)


def goals_of(recording: Recording) -> tuple[np.ndarray, ...]:
    """The goals (m, 2) [m] of the recorded scene; those that an edit has set later are not known."""
    sections = [item for one in physics_of(recording) for item in one.sections.items()]
    return tuple(curve for key, section in sections if section.curve for curve in _curves(section, key, recording))


def _curves(section: Section, key: str, recording: Recording) -> list[np.ndarray]:
    scene = recording.header.get("scene_values")
    raw = scene if isinstance(scene, dict) else {}
    known = {"parameters": read_parameters(raw, Source(recording.path, recorded=True))}
    try:
        found = [section.model.model_validate(one, context=known) for one in tables_in(raw, key).values()]
        return [section.curve_of(one) for one in found]
    except ValidationError as error:
        # Live sessions draw goals, and read no recordings.
        from restshape.replay.recording.layout import bad

        raise bad(recording.path, f"[{key}] of its scene: {error.errors(include_url=False)[0]['msg']}") from None
