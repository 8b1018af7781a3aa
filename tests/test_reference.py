"""Every key of scenes and scripts has a description of its own, and the page of them all is current."""

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from restshape.application import applications
from restshape.cli.schema import scene_schema, script_schema
from restshape.scene.key_descriptions import Described, key_descriptions

ROOT = Path(__file__).parents[1]
SHIPPED = {path.parent.name for path in (ROOT / "apps").glob("*/__init__.py")}
OF_TYPE = re.compile(r"a number in SI units or text such as|metres, or a unit")
"""What types say by themselves, whatever key has them."""


def undescribed(schema: Any, place: str = "") -> Iterator[str]:
    """Keys without a description of their own, anywhere in a schema."""
    if isinstance(schema, list):
        for one in schema:
            yield from undescribed(one, place)
    elif isinstance(schema, dict):
        for key, one in schema.get("properties", {}).items():
            text = one.get("description", "")
            if not text or OF_TYPE.match(text):
                yield f"{place}.{key}"
            yield from undescribed(one, f"{place}.{key}")
        for key, one in schema.get("$defs", {}).items():
            yield from undescribed(one, key)
        for key in ("anyOf", "oneOf", "items", "prefixItems", "additionalProperties"):
            yield from undescribed(schema.get(key), place)


@pytest.mark.parametrize("schema", [scene_schema, script_schema])
def test_no_key_lacks_a_description(schema):
    assert list(undescribed(schema())) == []


def test_a_key_without_a_description_is_found():
    schema = {"properties": {"a": {"description": "of a"}, "b": {"anyOf": [{"properties": {"c": {}}}]}}}
    assert list(undescribed(schema)) == [".b", ".b.c"]


class Outer(Described):
    """A table.

    Args:
        first, second: of two, in
            two lines.
        third: alone.
    """

    first: int
    second: int
    third: int


class Inner(Outer):
    """Another one.

    Args:
        third: differs.
    """


def test_descriptions_come_from_docstrings_the_nearest_first():
    assert key_descriptions(Inner) == {
        "first": "of two, in two lines",
        "second": "of two, in two lines",
        "third": "differs",
    }
    schema = Inner.model_json_schema()
    assert schema["description"] == "Another one."
    assert schema["properties"]["first"]["description"] == "of two, in two lines"


@pytest.mark.cli
@pytest.mark.skipif(not set(applications()) >= SHIPPED, reason="the page has the keys of applications that are absent")
def test_the_page_is_current():
    """In a process of its own, without the applications of tests, which PYTHONPATH leads to."""
    command = [sys.executable, "scripts/reference.py", "--check"]
    around = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    done = subprocess.run(command, cwd=ROOT, env=around, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_headings_of_the_page_are_what_is_written_in_files():
    """Tables and events, not the names of classes; each once, so that links reach them."""
    page = (ROOT / "docs" / "reference.md").read_text(encoding="utf-8")
    headings = re.findall(r"^### (.*)$", page, re.M)
    assert len(set(headings)) == len(headings)
    table, event = r"(`\[[\w.]+\]`(, )?)+( [a-z]+)?", r'Event `"[a-z]+"`( of [a-z]+)?'
    assert not [one for one in headings if not re.fullmatch(f"{table}|{event}|Header", one)]
    assert {"`[solve]`", "`[shape.edges.NAME]`, `[panels.NAME.edges.NAME]` arc", 'Event `"press"`'} <= set(headings)
