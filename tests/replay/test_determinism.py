"""The same command gives the same recording, bit for bit but for the clock."""

from functools import partial

import numpy as np
import pytest
from small_scenes import across, drag, plate, write_scene, write_script

from restshape.replay.recording.recording import Recording

EVENTS = [
    *drag("window", (0.5, 0.5), across((0.5, 0.5), (1.4, 0.52), 50)),
    {"do": "set", "key": "material.steel.E", "value": "70 GPa"},
    {"do": "hole", "name": "second", "center": [0.5, 0.5], "radius": 0.1},
    {"do": "undo"},
]


@pytest.mark.slow
@pytest.mark.parametrize("ranks", [1, 2])
def test_twice_the_same_bits(tmp_path, restshape, on_ranks, ranks):
    """In a process of its own and in one that has replayed before."""
    scene, script = write_scene(tmp_path, plate(0.09)), write_script(tmp_path, EVENTS)
    for name, run in (("a", partial(restshape, ranks=ranks, fresh=True)), ("b", partial(on_ranks, ranks))):
        done = run("replay", scene, "--edits", script, "--out", f"{name}.vtkhdf")
        assert done.returncode == 0, done.stderr
    with Recording(tmp_path / "a.vtkhdf") as a, Recording(tmp_path / "b.vtkhdf") as b:
        assert a.n == b.n == 56 and a.status == b.status == "done"
        assert a.header["ranks"] == ranks
        for name, column in a.table.items():
            if not name.startswith("ms"):
                assert column.tobytes() == b.table[name].tobytes() or list(column) == list(b.table[name]), name
        for i in range(a.n):
            assert a.cells(i).tobytes() == b.cells(i).tobytes()
            assert a.points(i).tobytes() == b.points(i).tobytes()
            assert a.field(i, "displacement").tobytes() == b.field(i, "displacement").tobytes()
        # The replay has something to repeat: levels, refreshes and more than one mesh.
        assert set(a.table["level"]) == {0, 1, 2, 3} or set(a.table["level"]) == {0, 1, 3}
        assert np.sum(a.table["pc_rebuilt"]) > np.sum(a.table["level"] == 3)
