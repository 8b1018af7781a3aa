"""What heat shows at the hand: isotherms, and where it is hottest."""

from pathlib import Path

import numpy as np
from marked_edits import last_marks, rows_with_and_without

import restshape

PIPE = Path(__file__).parents[1] / "scenes" / "pipe.toml"


def test_isotherms_of_a_pipe_are_circles_about_its_axis():
    with restshape.open(restshape.load(PIPE)) as simulation:
        lines = last_marks(simulation)["isotherms"]
        levels = [k for k, words in enumerate(lines.words) if words]
        assert 3 <= len(levels) <= 8
        ends = np.split(lines.points.reshape(-1, 2, 2), levels[1:])
        radii = [np.hypot(*part.reshape(-1, 2).T) for part in ends]
        assert all(np.ptp(radius) < 0.02 * radius.mean() for radius in radii)
        means = [radius.mean() for radius in radii]
        assert means == sorted(means) or means == sorted(means, reverse=True)
        assert np.ptp(means) > 0.0


def test_marks_change_no_row_of_heat():
    scene = restshape.load(PIPE)
    name = next(iter(scene.material))
    events = [{"do": "set", "key": f"material.{name}.conductivity", "value": 20.0}, {"do": "idle", "frames": 1}]
    marked, plain = rows_with_and_without(scene, events)
    assert len(plain) == 2 and marked == plain
