"""What -v logs of a replay agrees with the columns of its rows; without it there is nothing."""

import csv
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.cli

DATA = Path(__file__).parents[1] / "data"
FRAME = re.compile(r"^replay: +(\d+) Frame \w+: mesh level (\d);.*?(rebuilt)?$", re.MULTILINE)
MESH = re.compile(r"^mesh: +(\d+) Mesh level (\d):", re.MULTILINE)


@pytest.fixture
def edits(tmp_path):
    """A drag so far that edges flip and the mesh is made again."""
    head, press, *_ = (DATA / "plate.jsonl").read_text().splitlines()
    way = {"t": 0.1, "do": "drag", "path": [[500 + 20 * k, 500] for k in range(1, 41)]}
    lines = [head, press, json.dumps(way), json.dumps({"t": 1.0, "do": "release"})]
    path = tmp_path / "far.jsonl"
    path.write_text("\n".join(lines) + "\n")
    return path


def replayed(tmp_path, edits, *words):
    """The rows of a replay, and what it has written to stderr."""
    table = tmp_path / "rows.csv"
    command = [sys.executable, "-m", "restshape.cli.main", "replay", str(DATA / "plate.toml"), "--edits", str(edits)]
    done = subprocess.run([*command, "--csv", str(table), *words], capture_output=True, text=True, check=True)
    with table.open() as file:
        return list(csv.DictReader(file)), done.stderr


@pytest.mark.slow
def test_verbose_names_levels_and_rebuilt_preconditioners(tmp_path, edits):
    rows, log = replayed(tmp_path, edits, "-v")
    levels = {(row["index"], row["level"]) for row in rows if int(row["level"]) > 1}
    rebuilt = {row["index"] for row in rows if row["pc_rebuilt"] == "1"}
    assert {level for _, level in levels} == {"2", "3"} and len(rebuilt) > 1
    assert set(MESH.findall(log)) == levels
    frames = FRAME.findall(log)
    assert {(index, level) for index, level, _ in frames if int(level) > 1} == levels
    assert {index for index, _, word in frames if word} == rebuilt
    assert "refactorisation criterion" in log or "no convergence" in log


@pytest.mark.slow
def test_very_verbose_counts_the_iterations_of_each_frame(tmp_path, edits):
    rows, log = replayed(tmp_path, edits, "-vv", "--set", "solve.jumps=false")
    counted = re.findall(r"^algebra: +Linear \S+ solve .* iterations (\d+)$", log, re.MULTILINE)
    assert sum(map(int, counted)) == sum(int(row["iterations"]) for row in rows)


@pytest.mark.slow
def test_nothing_is_logged_unasked(tmp_path, edits):
    # But for what check warns of.
    assert all(line.startswith("note:") for line in replayed(tmp_path, edits)[1].splitlines())
