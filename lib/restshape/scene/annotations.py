"""Annotations and models that are made at run time, for pydantic: to a type checker they are objects like others.

This is the border to pydantic, whose `create_model` takes annotations that no type of Python describes.
"""

import operator
from collections.abc import Mapping
from functools import reduce
from typing import Annotated, Any, TypeVar

from pydantic import BaseModel, ConfigDict, create_model
from typing_extensions import TypedDict

Model = TypeVar("Model", bound=BaseModel)
Definition = tuple[object, object]
"""The annotation of a key, and its default or `pydantic.Field`."""


def union_of(first: object, *others: object) -> object:
    """The annotation of what is one of several."""
    return reduce(operator.or_, others, first)


def annotated(annotation: object, *said: object) -> object:
    """The annotation with what is said of it besides."""
    return Annotated[(annotation, *said)] if said else annotation


def optional(annotation: object) -> object:
    """The annotation of what may be None besides."""
    return union_of(annotation, None)


def extended(
    base: type[Model], keys: Mapping[str, Definition], *others: type[BaseModel], name: str = "", doc: str | None = None
) -> type[Model]:
    """A model with further keys, under the name and with the docstring of its base.

    Args:
        base: the model.
        keys: annotation and default of each that is new or another one.
        others: models of which it has the keys too, after those of the base.
        name, doc: in place of the base's.
    """
    definitions: dict[str, Any] = dict(keys)
    bases: Any = (base, *others) if others else base
    made: type[Model] = create_model(name or base.__name__, __base__=bases, __doc__=doc or base.__doc__, **definitions)
    return made


def table_of(name: str, keys: Mapping[str, object]) -> object:
    """The annotation of a table that may hold some of these keys, each by its annotation, and no others."""
    make: Any = TypedDict
    table = make(name, keys, total=False)
    table.__pydantic_config__ = ConfigDict(extra="forbid", arbitrary_types_allowed=True)
    return table
