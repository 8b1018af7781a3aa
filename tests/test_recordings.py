"""The script that holds recordings to earlier ones finds a changed value, and nothing where nothing changed."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
from small_scenes import drag, plate, write_scene, write_script

ROOT = Path(__file__).resolve().parents[1]
SCRIPT = ROOT / "scripts" / "recordings.py"


@pytest.fixture
def run(tmp_path, outside):
    """Runs the script on a checkout with one scene and one script."""
    scenes, edits = tmp_path / "apps" / "solid" / "scenes", tmp_path / "apps" / "solid" / "edits"
    scenes.mkdir(parents=True)
    edits.mkdir()
    scene = write_scene(scenes, plate(0.3))
    script = write_script(edits, [*drag("window", (0.5, 0.5), [(0.52, 0.5), (0.54, 0.5)]), {"do": "undo"}])
    header, *events = script.read_text().splitlines()
    script.write_text("\n".join([json.dumps(json.loads(header) | {"scene": scene.name}), *events]) + "\n")

    def run(*words):
        command = [sys.executable, SCRIPT, "--root", tmp_path, "--only", " auto", *words]
        return subprocess.run(list(map(str, command)), env=outside, capture_output=True, text=True, timeout=120)

    return run


def packed(values):
    """As the script packs them."""
    sys.path.insert(0, str(SCRIPT.parent))
    try:
        from recordings import packed
    finally:
        sys.path.remove(str(SCRIPT.parent))
    return packed(values)


@pytest.mark.slow
def test_a_changed_value_is_found(tmp_path, run):
    file = tmp_path / "recordings.json"
    done = run("--write", file)
    assert done.returncode == 0, done.stdout + done.stderr
    done = run("--check", file)
    assert done.returncode == 0 and "same" in done.stdout and "1 replays, 0 differ" in done.stdout, done.stdout
    held = json.loads(file.read_text())
    (replay,) = held["replays"].values()
    assert replay["exit"] == 0 and {"points", "cells", "displacement"} <= set(replay["fields"])
    assert "ms" not in replay["columns"] and "residual" in replay["columns"]
    replay["columns"]["unknowns"] = packed([1] * replay["frames"])
    del replay["columns"]["newton"]
    file.write_text(json.dumps(held))
    done = run("--check", file)
    assert done.returncode == 1, done.stdout
    assert f"column unknowns: {replay['frames']} of {replay['frames']} frames, first in frame 0" in done.stdout
    assert "note: new column newton" in done.stdout and "column residual" not in done.stdout


def test_every_application_has_a_script_that_is_quick_and_on_two_ranks():
    sys.path.insert(0, str(SCRIPT.parent))
    try:
        from recordings import QUICK
    finally:
        sys.path.remove(str(SCRIPT.parent))
    shipped = {path.parent.name for path in (ROOT / "apps").glob("*/__init__.py")}
    assert {name.split("/")[0] for name in QUICK} == shipped
    assert all((ROOT / "apps" / name.replace("/", "/edits/")).with_suffix(".jsonl").is_file() for name in QUICK)
