"""The pages of formats name all that scenes, scripts, recordings and summaries of furniture hold."""

import json
import re
from pathlib import Path

import pytest
from furniture_scenes import write_bench, write_edits
from restshape_apps.furniture.scene.furniture import Fastening, Floor, JointSpec, PlankSpec, PushSpec, WeightSpec, Wood
from restshape_apps.furniture.scene.plank_events import PLANK_EVENTS
from restshape_apps.furniture.scene.plank_quantities import KINDS

from restshape.application import application
from restshape.cli.main import main
from restshape.scene.load import load_scene

DOCS = Path(__file__).parents[3] / "docs"
COMMANDS = (DOCS / "commands.md").read_text(encoding="utf-8")


def named(text: str) -> set[str]:
    """The words that a text sets as code."""
    return set(re.findall(r"[\w.]+", " ".join(re.findall(r"`([^`\n]+)`", text))))


def furniture_section(page: str) -> str:
    return (DOCS / page).read_text(encoding="utf-8").split("\n## Furniture\n")[1].split("\n## ")[0]


NAMED = named(" ".join(furniture_section(f"{kind}-format.md") for kind in ("scene", "script", "recording")))


def test_the_page_names_every_key_of_a_scene():
    tables = (Wood, Fastening, Floor, PlankSpec, JointSpec, WeightSpec, PushSpec)
    keys = {field.alias or name for table in tables for name, field in table.model_fields.items()}
    keys |= {key for effect in application("furniture").effects.values() for key in effect.model.model_fields}
    assert keys | set(application("furniture").effects) <= NAMED
    assert set(KINDS) <= NAMED


def test_the_page_names_every_event_and_its_keys():
    for name, event in PLANK_EVENTS.items():
        keys = {field.alias or key for key, field in event.model_fields.items()} - {"t", "do", "line", "gesture"}
        assert name in NAMED, name
        # Those that mean the same everywhere stand in the script's schema.
        missing = keys - NAMED - {"key", "value"}
        assert not missing, (name, missing)


def test_the_page_names_every_column(tmp_path):
    assert set(application("furniture").own_columns(load_scene(write_bench(tmp_path)))) <= NAMED


@pytest.mark.parametrize("command", ["replay", "check"])
def test_the_page_names_every_key_of_json(tmp_path, command):
    scene, out = write_bench(tmp_path), tmp_path / "found.json"
    edits = write_edits(
        tmp_path, {"do": "press", "on": "left", "parameter": "move z"}, {"do": "drag", "by": -0.7}, {"do": "release"}
    )
    words = [str(scene), "--edits", str(edits)] if command == "replay" else [str(scene), str(edits)]
    assert main([command, *words, "--json", str(out)]) == 0
    found = json.loads(out.read_text())
    section = COMMANDS.split(f"\n### `{command}`\n")[1].split("\n### ")[0]
    reported = set(found)
    if command == "replay":
        guidance = found["guidance"]
        assert len(guidance["suggestions"]) == 1
        reported |= set(guidance) | set(guidance["frames"][0]) | set(guidance["suggestions"][0])
        assert set(guidance["suggestions"][0]["found"][0]) <= NAMED
    assert reported <= named(section)
