"""Scenes in which one table is another one: that table is validated again, and no other one."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import TYPE_CHECKING, cast

from pydantic import TypeAdapter, ValidationError

from restshape.scene.values import annotation_of

if TYPE_CHECKING:
    from restshape.scene.model import Scene
    from restshape.scene.plain_values import Table

OF_ALL = ("format", "version", "app", "parameters")
"""Keys on which it hangs how others are read."""


def with_changed_table(before: Scene, raw: Table, kind: type[Scene], known: Mapping[str, object]) -> Scene | None:
    """The validated model of plain tables of which all but one are the very tables of a scene before.

    Args:
        before: that scene.
        raw: tables, those of `before.raw` but one.
        kind: model of the scene.
        known: context of the validation.

    Returns:
        What validating all of them gives, but for tables that are shared with the scene before; None where more has
        changed, or the table is not valid: then all have to be validated, which gives the error.
    """
    read, old = before.as_read, before.raw
    changed = [key for key in {**old, **raw} if key not in old or key not in raw or old[key] is not raw[key]]
    if read is None or type(read) is not kind or len(changed) != 1:
        return None
    (key,) = changed
    if key in OF_ALL or key not in old or key not in raw or key not in kind.model_fields:
        return None
    try:
        value = _adapter(kind, key).validate_python(raw[key], context=known)
    except ValidationError:
        return None
    return read.model_copy(update={key: value})


@cache
def _adapter(kind: type[Scene], key: str) -> TypeAdapter[object]:
    """What validates the values of a key."""
    return TypeAdapter(cast("type[object]", annotation_of(kind.model_fields[key])))
