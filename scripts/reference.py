"""Writes docs/reference.md: every key of scenes and edit scripts, as `restshape schema` states them.

python scripts/reference.py            write it
python scripts/reference.py --check    compare; exit code 1 where it differs
"""

import argparse
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from restshape.cli.schema import scene_schema, script_schema

PAGE = Path(__file__).parents[1] / "docs" / "reference.md"
HEAD = """# Reference: every key of scenes and edit scripts

Written by `python scripts/reference.py` from what `restshape schema scene` and `restshape schema script` print, with
the keys of all applications. [Scene format](scene-format.md) and [script format](script-format.md) explain them with
examples. Lengths, angles, forces and the like are numbers in SI units, or text with a unit such as `"12 mm"`.
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
    scene, script = scene_schema(), script_schema()
    effects = scene["properties"]["effects"]["properties"]
    parts = [HEAD, "## Scene\n", *keys(scene)]
    parts += ["\n## Tables of scenes\n"]
    for name, schema in sorted(scene["$defs"].items()):
        parts += [f"\n### {name}\n", summary(schema), *keys(schema)]
    parts += ["\n## Effects\n", "Tables of `[effects]`; where applications differ in keys, each has a list.\n"]
    for name, schema in sorted(effects.items()):
        parts += [f"\n### effects.{name}\n", summary(schema)]
        for one in schema.get("anyOf", [schema]):
            parts += [*(keys(one) or ["No keys.\n"]), ""]
    parts += ["\n## Edit scripts\n", "The first line is a Header; each other line is an event.\n"]
    for name, schema in sorted(script["$defs"].items(), key=lambda item: (item[0] != "Header", item[0])):
        parts += [f"\n### Line {name}\n", summary(schema), *keys(schema)]
    return re.sub(r"\n{3,}", "\n\n", "\n".join(parts)).rstrip() + "\n"


def summary(schema: Schema) -> str:
    """What a table is, in one paragraph."""
    text = " ".join(schema.get("description", "").split()).replace("``", "`")
    return f"{text[:1].upper()}{text[1:]}{'' if text.endswith('.') or not text else '.'}\n"


def keys(schema: Schema) -> list[str]:
    """A line for each key of a table."""
    required = schema.get("required", [])
    return [line(key, one, key in required) for key, one in schema.get("properties", {}).items()]


def line(key: str, schema: Schema, required: bool) -> str:
    """What a key holds, and what it is."""
    said = [" or ".join(dict.fromkeys(words(schema)))]
    if required:
        said.append("required")
    elif schema.get("default") not in (None, "", {}) and "$ref" not in schema:
        said.append(f"default `{json.dumps(schema['default'], ensure_ascii=False)}`")
    text = " ".join(schema.get("description", "").split()).replace("``", "`")
    # Every number with a unit says that it is one: the head of the page does.
    text = re.sub(r"(; )?a number in SI units or text such as [^;,]*", "", text)
    return f"- `{key}` ({', '.join(said)}): {text}"


def words(schema: Schema) -> Iterator[str]:
    """What a value may be; the same words may come again."""
    if "$ref" in schema:
        name = schema["$ref"].rpartition("/")[2]
        yield f"[{name}](#{name.lower()})"
    elif "anyOf" in schema or "oneOf" in schema:
        for one in schema.get("anyOf", schema.get("oneOf", [])):
            yield from words(one)
    elif "enum" in schema or "const" in schema:
        yield from (f"`{json.dumps(one)}`" for one in schema.get("enum", [schema.get("const")]))
    elif schema.get("type") == "array":
        items = schema.get("prefixItems") or [schema.get("items", {})]
        inner = " or ".join(dict.fromkeys(word for one in items for word in words(one)))
        count = f"{len(items)} of " if "prefixItems" in schema else ""
        yield f"list of {count}{inner}" if inner else "list"
    elif isinstance(schema.get("additionalProperties"), dict):
        yield f"by name: {' or '.join(dict.fromkeys(words(schema['additionalProperties'])))}"
    elif schema.get("type") != "null":
        yield KINDS.get(str(schema.get("type")), "any value")


if __name__ == "__main__":
    raise SystemExit(main())
