"""Writes docs/python-interface.md: what `import restshape` offers, with the docstrings of the code.

python scripts/interface_page.py            write it
python scripts/interface_page.py --check    compare; exit code 1 where it differs
"""

import argparse
import inspect
from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from typing import Any

import restshape
from restshape.interface import replays
from restshape.live import notebook

PAGE = Path(__file__).parents[1] / "docs" / "python-interface.md"
HEAD = """# Python interface: every name

Written by `python scripts/interface_page.py` from the docstrings of what `import restshape` offers.
[Python](python.md) shows how it is used.
"""
SHOWN = (
    "load",
    "changed",
    "new_scene",
    "save_scene",
    "load_script",
    "new_script",
    "save_script",
    "open",
    "replay",
    "recording",
    "live",
)
KINDS = (
    "Simulation",
    "Hand",
    "Run",
    "ShownFrame",
    "ShownMesh",
    "OpenedRecording",
    "FrameOnFile",
    "LivePage",
    "UserError",
    "RefusedFrame",
)
CALLED = {"replay": replays.replay, "live": notebook.live}
"""Functions whose names are packages, too, which are called in their place."""
ELSEWHERE = {
    "Scene": "the validated model of a scene: its fields are the tables of the [scene format](scene-format.md)",
    "Script": "an edit script: `header`, `events`, `text`; events are models of the [script format](script-format.md)",
}
"""What other pages describe."""


def main() -> int:
    """Writes or compares the page; the exit code."""
    parser = argparse.ArgumentParser(description="Writes docs/python-interface.md.")
    parser.add_argument("--check", action="store_true", help="compare it with what it should be")
    text = page()
    if parser.parse_args().check:
        current = PAGE.is_file() and PAGE.read_text(encoding="utf-8") == text
        print(f"{PAGE.name} is {'current' if current else 'old: run python scripts/interface_page.py'}")
        return int(not current)
    PAGE.write_text(text, encoding="utf-8")
    print(f"wrote docs/{PAGE.name}")
    return 0


def page() -> str:
    """The text of the page."""
    parts = [HEAD, "\n## Functions\n"]
    for name in SHOWN:
        parts += entry(f"restshape.{name}", CALLED.get(name) or getattr(restshape, name))
    for name in KINDS:
        kind = getattr(restshape, name)
        parts += [f"\n## `restshape.{name}`\n", text_of(kind)]
        for member, value in members(kind):
            parts += entry(f"{name}.{member}", value)
    parts += ["\n## Described elsewhere\n", *(f"- `restshape.{name}`: {what}" for name, what in ELSEWHERE.items())]
    return "\n".join(parts).rstrip() + "\n"


def members(kind: type) -> Iterator[tuple[str, Any]]:
    """The public members of a class that have a docstring of their own, with those of its bases among ours."""
    for base in kind.__mro__:
        if not base.__module__.startswith("restshape."):
            continue
        for name, value in vars(base).items():
            here = getattr(kind, name, None) is getattr(base, name, None)
            if not name.startswith("_") and here and getattr(value, "__doc__", None):
                yield name, value


def entry(name: str, value: Any) -> list[str]:
    """Heading and docstring of a function, a method or a property."""
    if isinstance(value, property | cached_property):
        return [f"\n### `{name}`\n", text_of(value)]
    given = [one for one in inspect.signature(value).parameters.values() if one.name != "self"]
    shown = ", ".join(str(one.replace(annotation=one.empty)) for one in given)
    return [f"\n### `{name}({shown})`\n", text_of(value)]


def text_of(value: Any) -> str:
    """A docstring, as it stands in the code."""
    return f"```text\n{inspect.getdoc(value)}\n```"


if __name__ == "__main__":
    raise SystemExit(main())
