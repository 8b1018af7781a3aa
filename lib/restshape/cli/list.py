"""`restshape list`: what is installed."""

import argparse
import json
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from restshape.application import Application, Command, applications, brought_commands
from restshape.cli.options import add_json, print_table, write_json

SUMMARY = "list the applications with their commands, scenes and edit scripts"


def arguments(parser: argparse.ArgumentParser) -> None:
    """Adds what this command takes."""
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Prints applications, what they add to `restshape`, scenes and scripts."""
    brought = brought_commands()
    found = {name: contents(app, brought[name]) for name, app in applications().items()}
    print_table("applications", ("name", "summary"), ((name, app["summary"]) for name, app in found.items()))
    print()
    commands = [(name, f"restshape {one.name}", one.summary) for name, many in brought.items() for one in many]
    print_table("commands of applications", ("application", "command", "summary"), commands)
    print()
    rows = [
        (name, s["path"], ", ".join(s["scripts"]), s["title"]) for name, app in found.items() for s in app["scenes"]
    ]
    print_table("scenes", ("application", "scene", "scripts", "title"), rows)
    if args.json:
        # Effects are the physics', whose import takes longer than all else here.
        effects = {
            name: {n: e.summary for seen in app.as_seen for n, e in seen.effects.items()}
            for name, app in applications().items()
        }
        write_json(args, {name: {**app, "effects": effects[name]} for name, app in found.items()})
    return 0


def contents(app: Application, brought: Sequence[Command]) -> dict[str, Any]:
    """Summary, commands, scenes and scripts of an application."""
    scripts: dict[str, list[str]] = {}
    for path in sorted((app.folder / "edits").glob("*.jsonl")):
        scripts.setdefault(scene_of(path), []).append(path.name)
    scenes = [
        {"path": relative(path), "title": title_of(path), "scripts": scripts.get(path.name, [])}
        for path in app.scenes()
    ]
    return {"summary": app.summary, "commands": {one.name: one.summary for one in brought}, "scenes": scenes}


def relative(path: Path) -> str:
    """The path as a user here would type it."""
    here = Path.cwd()
    return str(path.relative_to(here) if path.is_relative_to(here) else path)


def title_of(path: Path) -> str:
    """The title in a scene file."""
    try:
        return str(tomllib.loads(path.read_text(encoding="utf-8")).get("title", ""))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError):
        return "(cannot be read: see restshape check)"


def scene_of(path: Path) -> str:
    """The scene that an edit script's header names."""
    try:
        with path.open(encoding="utf-8") as lines:
            return str(json.loads(lines.readline()).get("scene", ""))
    except (OSError, UnicodeDecodeError, json.JSONDecodeError, AttributeError):
        return ""
