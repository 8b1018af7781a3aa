"""How far a mesh bears a drag under each map: what the study finds is what a replay does, and its picture shows it."""

import json
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from restshape_studies.bench.maps import KINDS, compared, panel, table
from restshape_studies.pictures.maps import draw_maps, qualities
from small_scenes import across, drag, plate, write_scene, write_script

from restshape.mesh.moving import MovingMesh
from restshape.shape.session import EditFrame


@pytest.fixture(scope="module")
def found():
    return compared(panel())


@pytest.mark.slow
def test_the_way_with_flips_is_the_way_of_a_replay_to_its_new_mesh(found):
    dragged = panel()
    scene = SimpleNamespace(mesh=dragged.spec.model_copy(update={"order": 1}))
    for kind in KINDS:
        moving = MovingMesh(dragged.outline, dragged.spec, relocation=kind)
        moving.update(EditFrame(0, 0.0, 0, "start", "start", None, (0.0, 0.0), scene, None, dragged.outline))
        until = None
        for c in dragged.path:
            outline = dragged.outline.moved(dragged.gesture.points(c))
            frame = EditFrame(1, 0.0, 1, "drag", "move", dragged.gesture, c, scene, None, outline)
            if moving.update(frame).level == 3:
                until = float(np.hypot(*c))
                break
        assert found["kinds"][kind]["with flips"]["way"] == until


@pytest.mark.slow
def test_each_map_goes_farther_than_the_one_before_and_flips_lengthen_the_way(found):
    ways = [
        [np.inf if (way := found["kinds"][kind][how]["way"]) is None else way for kind in KINDS]
        for how in ("alone", "with flips")
    ]
    assert all(one < other for row in ways for one, other in pairwise(row))
    assert all(alone < flipped for alone, flipped in zip(*ways))
    assert found["kinds"]["mvc"]["alone"]["inverted"] > found["kinds"]["pmvc"]["alone"]["inverted"] > 0
    for ends in found["kinds"].values():
        for one in ends.values():
            corners = table(one["X"])[table(one["cells"]).astype(int)]
            assert qualities(corners).min() == pytest.approx(one["quality"], abs=5e-3)
            assert (qualities(corners) <= 0).sum() == one["inverted"]


@pytest.mark.slow
def test_nothing_in_the_picture_is_clipped_or_covered(found, tmp_path, monkeypatch):
    figures = []
    monkeypatch.setattr("restshape.outputs.picture_files.write_figure", lambda figure, *_: figures.append(figure))
    draw_maps("panel", found, tmp_path / "a.png")
    (figure,) = figures
    figure.draw_without_rendering()
    boxes = [axes._left_title.get_window_extent() for axes in figure.axes]
    assert len(boxes) == 8 and not any(one.overlaps(other) for one, other in pairwise(boxes))
    for box in (*boxes, *(text.get_window_extent() for axes in figure.axes for text in (axes.xaxis.label,))):
        assert figure.bbox.x0 <= box.x0 and box.x1 <= figure.bbox.x1
        assert figure.bbox.y0 <= box.y0 and box.y1 <= figure.bbox.y1


@pytest.mark.slow
@pytest.mark.cli
def test_the_study_for_programs_and_people(tmp_path, command):
    done = command("bench", "maps", "--json", "a.json", "--picture", "a.png")
    assert done.returncode == 0, done.stderr
    (one,) = json.loads((tmp_path / "a.json").read_text()).values()
    assert list(one["kinds"]) == list(KINDS) and "way of the hand until level 3 [mm]" in done.stdout
    assert (tmp_path / "a.png").is_file()
    assert command("bench", "maps", "--redraw", "a.json", "--picture", "b.png").returncode == 0
    assert (tmp_path / "b.png").is_file()


@pytest.mark.slow
@pytest.mark.cli
def test_the_first_drag_of_a_script(tmp_path, command):
    path = write_scene(tmp_path, plate(0.2), "small.toml")
    events = [*drag("window", (0.5, 0.5), across((0.5, 0.5), (0.53, 0.5), 3)), {"do": "idle"}]
    edits = write_script(tmp_path, events, "small.jsonl")
    done = command("bench", "maps", path, "--edits", edits, "--json", "a.json")
    assert done.returncode == 0, done.stderr
    one = json.loads((tmp_path / "a.json").read_text())
    one = one.get("small", one)
    assert one["on"] == "window" and np.allclose(one["ways"], [0.01, 0.02, 0.03], rtol=0, atol=1e-12)
    idle = write_script(tmp_path, [{"do": "idle"}], "idle.jsonl")
    done = command("bench", "maps", path, "--edits", idle)
    assert done.returncode == 2 and "no frame of it drags a part of the shape" in done.stderr
