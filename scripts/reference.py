"""Writes docs/reference.md: every key of scenes and edit scripts, as `restshape schema` states them.

python scripts/reference.py            write it
python scripts/reference.py --check    compare; exit code 1 where it differs
"""

import argparse
import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from restshape.application import applications
from restshape.cli.schema import scene_schema, script_schema
from restshape.scene.edit_script import EVENTS

PAGE = Path(__file__).parents[1] / "docs" / "reference.md"
HEAD = """# Reference: every key of scenes and edit scripts

Written by `python scripts/reference.py` from what `restshape schema scene` and `restshape schema script` print, with
the keys of all applications, under their tables as a scene writes them. [Scene format](scene-format.md) and
[script format](script-format.md) explain them with examples. Lengths, angles, forces and the like are numbers in SI
units, or text with a unit such as `"12 mm"`.
"""
Schema = dict[str, Any]
KINDS = {"string": "text", "integer": "whole number", "number": "number", "boolean": "true or false", "object": "table"}


def main() -> int:
    """Writes or compares the page; the exit code."""
    parser = argparse.ArgumentParser(description="Writes docs/reference.md.")
    parser.add_argument("--check", action="store_true", help="compare it with what it should be")
    text = page()
    if parser.parse_args().check:
        current = PAGE.is_file() and PAGE.read_text(encoding="utf-8") == text
        print(
            "docs/reference.md is current" if current else "docs/reference.md is old: run python scripts/reference.py"
        )
        return int(not current)
    PAGE.write_text(text, encoding="utf-8")
    print("wrote docs/reference.md")
    return 0


def page() -> str:
    """The text of the page."""
    scene = scene_schema()
    tables = tables_of(scene)
    parts = [HEAD, "## Scene\n", *keys(scene, tables)]
    parts += ["\n## Tables of scenes\n"]
    for name, table in tables.items():
        schema = scene["$defs"][name]
        parts += [f"\n### {table.title}\n", summary(schema), *keys(schema, tables)]
    return re.sub(r"\n{3,}", "\n\n", "\n".join([*parts, *effects(scene), *events()])).rstrip() + "\n"


def effects(scene: Schema) -> list[str]:
    """The part on the tables of effects."""
    parts = ["\n## Effects\n", "Tables of `[effects]`; where applications differ in keys, each has a list.\n"]
    for name, schema in sorted(scene["properties"]["effects"]["properties"].items()):
        parts += [f"\n### `[effects.{name}]`\n", summary(schema)]
        for one in schema.get("anyOf", [schema]):
            parts += [*(keys(one, {}) or ["No keys.\n"]), ""]
            for inner, table in one.get("$defs", {}).items():
                parts += [f"Keys of `{inner}`:\n", *keys(table, {}), ""]
    return parts


def events() -> list[str]:
    """The part on the lines of edit scripts: the header, events by their word, then those of one application alone."""
    lines = script_schema()["$defs"]
    parts = ["\n## Edit scripts\n", "The first line is the header; each other line is an event.\n"]
    parts += ["\n### Header\n", summary(lines["Header"]), *keys(lines.pop("Header"), {})]
    apps = applications().items()
    own = {one.__name__: name for name, app in apps for one in app.events.values() if one not in EVENTS.values()}
    titled = [(own.get(kind, ""), schema["properties"]["do"]["const"], schema) for kind, schema in lines.items()]
    for app, word, schema in sorted(titled, key=lambda one: one[:2]):
        title = f'Event `"{word}"`' + (f" of {app}" if app else "")
        parts += [f"\n### {title}\n", summary(schema), *keys(schema, {})]
    return parts


@dataclass
class Table:
    """A table of scenes: where it stands, such as ``shape.edges.NAME``, and which of several kinds there it is."""

    places: list[str]
    kind: str

    @property
    def title(self) -> str:
        """Its heading."""
        return ", ".join(f"`[{place}]`" for place in self.places) + (f" {self.kind}" if self.kind else "")

    @property
    def link(self) -> str:
        """A link to its heading, whose anchor is made as GitHub makes it."""
        anchor = re.sub(r"[^\w\- ]", "", self.title.lower()).replace(" ", "-")
        return f"[{self.kind or 'table'}](#{anchor})"


def tables_of(scene: Schema) -> dict[str, Table]:
    """Every table that a scene may have, by the name of its schema, each before those within it."""
    found: dict[str, Table] = {}

    def enter(schema: Schema, place: str) -> None:
        kinds = [one["$ref"].rpartition("/")[2] for one in alternatives(schema) if "$ref" in one]
        for name in kinds:
            inner = scene["$defs"][name]
            table = found.setdefault(name, Table([], inner["required"][0] if len(kinds) > 1 else ""))
            table.places.append(place)
            enter_all(inner, f"{place}.")

    def enter_all(schema: Schema, prefix: str) -> None:
        for key, one in schema.get("properties", {}).items():
            enter(one, prefix + key)
            enter_named(one, f"{prefix}{key}.NAME")
        enter_named(schema, f"{prefix}NAME")

    def enter_named(schema: Schema, place: str) -> None:
        if isinstance(schema.get("additionalProperties"), dict):
            enter(schema["additionalProperties"], place)

    enter_all(scene, "")
    return found


def alternatives(schema: Schema) -> list[Schema]:
    """What a value may be, one by one."""
    return schema.get("anyOf") or schema.get("oneOf") or [schema]


def summary(schema: Schema) -> str:
    """What a table is, in one paragraph."""
    text = " ".join(schema.get("description", "").split()).replace("``", "`")
    # The heading is the table that it is of.
    text = re.sub(r"^(Keys of )?`\[[^]]*\]`: (none; )?", "", text)
    return f"{text[:1].upper()}{text[1:]}{'' if text.endswith('.') or not text else '.'}\n"


def keys(schema: Schema, tables: dict[str, Table]) -> list[str]:
    """A line for each key of a table."""
    required = schema.get("required", [])
    return [line(key, one, key in required, tables) for key, one in schema.get("properties", {}).items()]


def line(key: str, schema: Schema, required: bool, tables: dict[str, Table]) -> str:
    """What a key holds, and what it is."""
    said = [" or ".join(dict.fromkeys(words(schema, tables)))]
    if required:
        said.append("required")
    elif schema.get("default") not in (None, "", {}) and "$ref" not in schema:
        said.append(f"default `{json.dumps(schema['default'], ensure_ascii=False)}`")
    text = " ".join(schema.get("description", "").split()).replace("``", "`")
    # Every number with a unit says that it is one: the head of the page does.
    text = re.sub(r"(; )?a number in SI units or text such as [^;,]*", "", text)
    return f"- `{key}` ({', '.join(said)}): {text}"


def words(schema: Schema, tables: dict[str, Table]) -> Iterator[str]:
    """What a value may be; the same words may come again."""
    if "$ref" in schema:
        name = schema["$ref"].rpartition("/")[2]
        yield tables[name].link if name in tables else f"table `{name}`"
    elif "anyOf" in schema or "oneOf" in schema:
        for one in alternatives(schema):
            yield from words(one, tables)
    elif "enum" in schema or "const" in schema:
        yield from (f"`{json.dumps(one)}`" for one in schema.get("enum", [schema.get("const")]))
    elif schema.get("type") == "array":
        items = schema.get("prefixItems") or [schema.get("items", {})]
        inner = " or ".join(dict.fromkeys(word for one in items for word in words(one, tables)))
        count = f"{len(items)} of " if "prefixItems" in schema else ""
        yield f"list of {count}{inner}" if inner else "list"
    elif isinstance(schema.get("additionalProperties"), dict):
        yield f"by name: {' or '.join(dict.fromkeys(words(schema['additionalProperties'], tables)))}"
    elif schema.get("type") != "null":
        yield KINDS.get(str(schema.get("type")), "any value")


if __name__ == "__main__":
    raise SystemExit(main())
