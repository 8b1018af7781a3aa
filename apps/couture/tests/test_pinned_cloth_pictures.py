"""Pictures of cloth mark where supports hold it."""

import numpy as np
import pytest

from restshape.application import application
from restshape.cli.main import main
from restshape.physics.cloth.pictures.drape import drape_scenery
from restshape.physics.cloth.pictures.drape_frames import draw_drape_frames
from restshape.replay.recording.recording import Recording

PINS = application("couture").folder / "scenes" / "pins.toml"


@pytest.mark.slow
@pytest.mark.parametrize(("on", "also"), [("d", 0), ("left", 5)])
def test_marks_are_on_the_nodes_that_supports_hold(tmp_path, monkeypatch, on, also):
    """Two corners of a square of 0.5 m, or one and all nodes of its left side."""
    figures, out = [], tmp_path / "cloth.vtkhdf"
    monkeypatch.setattr("restshape.outputs.picture_files.write_figure", lambda figure, *_: figures.append(figure))
    words = ["--set", "mesh.size=0.1", "--set", f'supports.left.on="{on}"']
    assert main(["replay", str(PINS), "--out", str(out), *words]) == 0
    with Recording(out) as cloth:
        scenery = drape_scenery(cloth, np.array([0]))
        X, nodes = cloth.points(0), scenery.pins[0]
        corner = np.hypot(*(X - [0.5, 0.5]).T) < 1e-9
        other = np.hypot(*(X - [0.0, 0.5]).T) < 1e-9 if on == "d" else np.abs(X[:, 0]) < 1e-9
        np.testing.assert_array_equal(nodes, np.flatnonzero(corner | other))
        assert len(nodes) >= 2 + also
        draw_drape_frames(cloth, np.array([0]), scenery, tmp_path / "a.png")
    (figure,) = figures
    assert "circles: supports" in figure.get_suptitle()
    pattern = figure.axes[2]
    (marks,) = [line for line in pattern.lines if line.get_marker() == "o"]
    np.testing.assert_allclose(np.column_stack(marks.get_data()), X[nodes])
