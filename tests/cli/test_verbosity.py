"""What -v logs of a replay agrees with the columns of its rows; without it there is nothing."""

import csv
import json
import re
from pathlib import Path

import pytest

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


@pytest.fixture
def replayed(tmp_path, edits, restshape):
    """Replays in a process of its own, whose loggers are its own: the rows, and what it has written to stderr."""

    def run(*words):
        done = restshape("replay", DATA / "plate.toml", "--edits", edits, "--csv", "rows.csv", *words)
        assert done.returncode == 0, done.stderr
        with (tmp_path / "rows.csv").open() as file:
            return list(csv.DictReader(file)), done.stderr

    return run


def test_verbose_names_levels_and_rebuilt_preconditioners(replayed):
    rows, log = replayed("-v")
    levels = {(row["index"], row["level"]) for row in rows if int(row["level"]) > 1}
    rebuilt = {row["index"] for row in rows if row["pc_rebuilt"] == "1"}
    assert {level for _, level in levels} == {"2", "3"} and len(rebuilt) > 1
    assert set(MESH.findall(log)) == levels
    frames = FRAME.findall(log)
    assert {(index, level) for index, level, _ in frames if int(level) > 1} == levels
    assert {index for index, _, word in frames if word} == rebuilt
    assert "refactorisation criterion" in log or "no convergence" in log


def test_very_verbose_counts_the_iterations_of_each_frame(replayed):
    rows, log = replayed("-vv", "--set", "solve.jumps=false")
    counted = re.findall(r"^algebra: +Linear \S+ solve .* iterations (\d+)$", log, re.MULTILINE)
    # Before an iteration that takes no step a new factor has been applied once.
    assert sum(max(1, int(one)) for one in counted) == sum(int(row["iterations"]) for row in rows)


def test_nothing_is_logged_unasked(replayed):
    # But for what check warns of.
    assert all(line.startswith("note:") for line in replayed()[1].splitlines())
