"""Replays six hundred edits and prints the memory in use [bytes] after each hundred.

usage: edit_many_times.py FOLDER POLICY
"""

import gc
import os
import sys
from pathlib import Path

import petsc4py

petsc4py.init(["restshape"])
sys.path.insert(0, str(Path(__file__).parents[1]))
from small_scenes import drag, make_replay, plate, write_scene, write_script  # noqa: E402

EDITS = 600


def round_of_edits() -> list[dict]:
    """Ten edits of every kind, after which the shape is as before."""
    there = [(0.5 + 0.05 * k, 0.5) for k in range(1, 9)]
    back = [(0.9 - 0.05 * k, 0.5) for k in range(1, 9)]
    return [
        *drag("window", (0.5, 0.5), there),
        {"do": "undo"},
        {"do": "redo"},
        *drag("window", (0.9, 0.5), back),
        {"do": "insert", "on": "top", "name": "m", "s": 0.5},
        {"do": "delete", "on": "m"},
        {"do": "hole", "name": "second", "center": [1.4, 0.5], "radius": 0.1},
        {"do": "delete", "on": "second"},
        {"do": "set", "key": "material.steel.E", "value": "100 GPa"},
        {"do": "set", "key": "material.steel.E", "value": "200 GPa"},
    ]


def in_use() -> int:
    """Resident memory [bytes] that no garbage holds."""
    gc.collect()
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def main(folder: Path, name: str) -> None:
    """Prints a number for each hundred edits."""
    rounds = round_of_edits()
    script = write_script(folder, rounds * (EDITS // 10))
    made = make_replay(write_scene(folder, plate(0.3)), script, name)
    edits, line = 0, 0
    for row in made.frames():
        if row["refused"]:
            raise SystemExit(row["refused"])
        if row["line"] != line:
            line = row["line"]
            edits += row["event"] not in ("drag", "release")
            if edits % 100 == 1 and row["event"] not in ("drag", "release"):
                print(edits - 1, in_use(), flush=True)
    print(edits, in_use(), flush=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2])
