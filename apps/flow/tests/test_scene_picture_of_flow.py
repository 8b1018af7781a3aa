"""The picture of a scene of a fluid before any solve."""

from matplotlib.collections import LineCollection
from small_scenes import BLOCK, HEAD, meshed, write_scene

from restshape.cli.main import main


def test_conditions_of_fluids_are_drawn_and_written(tmp_path, monkeypatch):
    figures = []
    monkeypatch.setattr("restshape.outputs.picture_files.write_figure", lambda figure, *_: figures.append(figure))
    fluid = """
[fluid]
name = "water"
[boundary]
inlet = { on = "left", velocity = ["1 m/s", 0] }
outlet = { on = "right", outflow = true }
[effects]
flow = {}
"""
    text = BLOCK.format(width=2, height=1) + fluid + meshed(0.2)
    scene = write_scene(tmp_path, HEAD.replace('app = "plane"', 'app = "flow"') + text)
    assert main(["check", str(scene), "--picture", str(tmp_path / "scene.png")]) == 0
    words = [text.get_text() for text in figures[0].texts]
    assert "boundary inlet on left: velocity (1, 0) m/s" in words and "boundary outlet on right: outflow" in words
    lines = [one for one in figures[0].axes[0].collections if isinstance(one, LineCollection)]
    drawn = [one.get_segments()[0] for one in lines if one.get_zorder() == 4.5]
    assert [set(segment[:, 0]) for segment in drawn] == [{0.0}, {2.0}]
