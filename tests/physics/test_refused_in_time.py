"""A refused edit takes no time step: all goes on as without its line."""

import numpy as np
import pytest
from restshape_studies.stability.scenery import drag, make_replay, plate, rows_of, write_scene, write_script
from thermal_scenes import COOLING

MOVING = plate("vibration") + "[effects.dynamics]\ntime_step = 1e-4\nsteps = 3\n"
LARGE = MOVING + "[effects.large_deformation]\n"
COOLED = COOLING.replace("initial = 0", "initial = 300").replace("size = 0.05", "size = 0.25") + (
    '[quantities]\nmean = { temperature = true, at = "all" }\n'
)
REFUSED = [
    {"do": "set", "key": "mesh.order", "value": 7},
    {"do": "set", "key": "effects.none.at_all", "value": 1, "frames": 2},
    {"do": "undo"},
    {"do": "delete", "on": "left"},
]


@pytest.mark.parametrize("text", [COOLED, MOVING, LARGE], ids=["heat", "motion", "large motion"])
def test_a_refused_line_takes_no_time_step(tmp_path, text):
    scene = write_scene(tmp_path, text)
    idle = {"do": "idle", "frames": 2}
    script = write_script(tmp_path, [idle, *REFUSED, idle])
    rows = rows_of(make_replay(scene, script))
    alone = rows_of(make_replay(scene, write_script(tmp_path, [idle, idle], "alone.jsonl")))
    refused = [row for row in rows if row["refused"]]
    assert [row["index"] for row in refused] == [3, 4, 5, 6, 7]
    names = ["time", *(name for name in rows[0] if name.startswith("q_"))]
    assert {row["time"] for row in refused} == {rows[2]["time"]} and rows[2]["time"] > rows[1]["time"] > 0
    assert all(row["stale"] and not row["newton"] and np.isnan([row[n] for n in names[1:]]).all() for row in refused)
    found, wanted = ([[row[n] for n in names] for row in kept] for kept in (rows[:3] + rows[8:], alone))
    assert len({values[-1] for values in wanted}) == len(wanted) == 5
    np.testing.assert_array_equal(found, wanted)


def test_a_refused_part_of_a_drag_takes_none(tmp_path):
    scene = write_scene(tmp_path, MOVING)
    paths = [(0.52, 0.5), (5.0, 0.5), (0.54, 0.5)], [(0.52, 0.5), (0.54, 0.5)]
    kept, alone = (
        [
            row
            for row in rows_of(make_replay(scene, write_script(tmp_path, drag("window", (0.5, 0.5), path))))
            if not row["refused"]
        ]
        for path in paths
    )
    assert len(kept) == len(alone) == 5 and kept[-1]["time"] == alone[-1]["time"]
    assert [row["q_stretch"] for row in kept] == pytest.approx([row["q_stretch"] for row in alone], rel=1e-6)
