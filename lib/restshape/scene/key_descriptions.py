"""What docstrings of models say of their keys, for the JSON schema."""

import inspect
import re

from pydantic import BaseModel, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

KEYS = "Args:"
ITEM = re.compile(r" {4}(\w+(?:, \w+)*): (.*)")


class Described(BaseModel):
    """A model whose JSON schema describes each key as docstrings do."""

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        """The schema with what docstrings say of the keys: before what their types say."""
        found = handler(schema)
        own = handler.resolve_ref_schema(found)
        described = key_descriptions(cls)
        for key, of_key in own.get("properties", {}).items():
            if key in described:
                of_type = of_key.get("description")
                of_key["description"] = f"{described[key]}; {of_type}" if of_type else described[key]
        if "description" in own:
            own["description"] = without_keys(own["description"])
        return found


def key_descriptions(kind: type) -> dict[str, str]:
    """What the docstrings of a class and of those that it is derived from say of each key, the nearest first.

    A docstring has them under ``Args:``, one ``key: text`` or ``key, other: text`` after the other; the text goes on in
    lines that are indented farther.
    """
    found: dict[str, str] = {}
    for one in kind.__mro__:
        found = {**_items(one.__doc__ or ""), **found}
    return found


def without_keys(text: str) -> str:
    """What a docstring says besides its keys."""
    return inspect.cleandoc(text).partition(f"\n{KEYS}")[0].strip()


def _items(text: str) -> dict[str, str]:
    lines = inspect.cleandoc(text).splitlines()
    found: dict[str, str] = {}
    keys: list[str] = []
    for line in lines[lines.index(KEYS) + 1 :] if KEYS in lines else []:
        item = ITEM.fullmatch(line)
        if item:
            keys = item[1].split(", ")
            found |= dict.fromkeys(keys, item[2])
        elif line.startswith(" " * 8):
            found |= {key: f"{found[key]} {line.strip()}" for key in keys}
        else:
            break
    return {key: words.rstrip(".") for key, words in found.items()}
