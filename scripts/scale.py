"""Makes the fishes of a scale from that in C5: each by its script's numbers, and `restshape tune` by its length.

    python scripts/scale.py

Writes apps/metallophone/scenes/d5.toml to b5.toml; apps/metallophone/edits/d5.jsonl to b5.jsonl are the ways there.
"""

import json
import sys
from pathlib import Path

from restshape.cli.main import main

FOLDER = Path(__file__).parents[1] / "apps" / "metallophone"
FIRST, OTHERS = "C5", ("D5", "E5", "F5", "G5", "A5", "B5")


def numbers(script: Path) -> list[str]:
    """The numbers that a script leads to, each as KEY=VALUE."""
    events = [json.loads(line) for line in script.read_text(encoding="utf-8").splitlines()]
    last = {event["key"]: event["value"] for event in events if event.get("do") == "set"}
    return [f"{key}={value}" for key, value in last.items()]


def tune(note: str) -> int:
    """Write the scene of a note; the exit code."""
    scenes = FOLDER / "scenes"
    words = ["tune", str(scenes / f"{FIRST.lower()}.toml"), "--to", note, "--by", "parameters.length"]
    for change in [f"title=fish in {note}", *numbers(FOLDER / "edits" / f"{note.lower()}.jsonl")]:
        words += ["--set", change]
    return main([*words, "--out", str(scenes / f"{note.lower()}.toml")])


if __name__ == "__main__":
    sys.exit(max(tune(note) for note in OTHERS))
