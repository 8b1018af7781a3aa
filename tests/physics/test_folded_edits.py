"""Edits of panels that are cut on the fold: both halves stay mirror images, whatever is done to one of them."""

import numpy as np
import pytest
from small_scenes import write_scene, write_script
from test_pattern_panels import FOLDED, garment

from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene
from restshape.shape.session import EditSession

EDITS = {
    "insert": {"do": "insert", "on": "front.hem", "name": "front.m", "s": 0.25},
    "insert at": {"do": "insert", "on": "front.side", "name": "front.m", "at": [0.07, 0.08]},
    "hole": {"do": "hole", "name": "front.slit", "center": [0.05, 0.03], "radius": 0.005},
    "polygon": {"do": "hole", "name": "front.slit", "polygon": [[0.04, 0.02], [0.05, 0.02], [0.05, 0.04]]},
    "arc": {"do": "arc", "on": "front.hem", "bulge": 0.1, "frames": 2},
    "through": {"do": "arc", "on": "front.neck", "through": [0.04, 0.16]},
    "rotate": {"do": "rotate", "on": "front.eye", "by": 0.3, "about": [0.04, 0.06]},
    "scale": {"do": "scale", "on": "front.eye", "factor": 1.5, "frames": 2},
    "smooth": {"do": "smooth", "on": "front.side", "strength": 0.8},
    "pull": [
        {"do": "pull", "on": "front.side", "at": [0.07, 0.08]},
        {"do": "drag", "to": [0.075, 0.085], "frames": 2},
        {"do": "release"},
    ],
    "delete": {"do": "delete", "on": "front.eye"},
    "image": {"do": "arc", "on": "front.mirror.hem", "bulge": 0.1},
    "all": {"do": "scale", "on": "front.fold", "factor": 1.1, "about": [0, 0]},
}


def session(folder, events):
    """The frames of a script on the folded panel."""
    scene = load_scene(write_scene(folder, garment(FOLDED, size=0.03)))
    return list(EditSession(scene, load_script(write_script(folder, events), scene)).frames())


def loop_points(outline, hole, s):
    """Points (n, 2) of all edges of a hole, at parameters of each."""
    return np.concatenate([outline.point(e, s) for e in outline.entity(hole).edges])


@pytest.mark.parametrize("case", EDITS)
def test_both_halves_stay_mirror_images(tmp_path, case):
    events = EDITS[case] if isinstance(EDITS[case], list) else [EDITS[case]]
    first, *frames = session(tmp_path, events)
    assert not any(frame.refused for frame in frames)
    before, outline = first.outline, frames[-1].outline
    changed = outline.topology != before.topology or not np.array_equal(outline.points, before.points)
    assert changed or not np.array_equal(outline.bulges, before.bulges)
    names = {edge.name for edge in outline.edges if edge.name != "front.fold"}
    own = [name for name in names if ".mirror." not in name]
    assert 2 * len(own) == len(names)
    s = np.linspace(0.0, 1.0, 33)
    for name in own:
        image = name.replace("front.", "front.mirror.")
        assert image in names
        a, b = (outline.point(outline.entity(one).edges[0], s) for one in (name, image))
        # Images of edges may be passed the other way round; those of holes may begin elsewhere, and are compared below.
        off = [np.abs(a * [-1, 1] - other).max() for other in (b, b[::-1])]
        assert min(off) < 1e-12 or "eye" in name or "slit" in name
    holes = [loop for loop in outline.names("hole") if ".mirror." not in loop]
    for hole in holes:
        x, y = outline.centroid(outline.entity(hole))
        assert outline.centroid(outline.entity(hole.replace("front.", "front.mirror."))) == pytest.approx((-x, y))
        a, b = (loop_points(outline, name, s) for name in (hole, hole.replace("front.", "front.mirror.")))
        away = np.linalg.norm(a[:, None] * [-1, 1] - b, axis=2)
        assert max(away.min(axis=0).max(), away.min(axis=1).max()) < 1e-12
    fold = outline.edges[outline.entity("front.fold").edges[0]]
    assert np.abs(outline.points[[fold.start, fold.end], 0]).max() < 1e-15
    areas = [outline.loop_area(k) for k, loop in enumerate(outline.loops) if loop.kind == "hole"]
    assert len(areas) == 2 * len(holes)
    assert sorted(areas)[::2] == pytest.approx(sorted(areas)[1::2], rel=1e-9)


def test_an_undo_takes_both_halves_back(tmp_path):
    first, *_, last = session(tmp_path, [EDITS["insert"], {"do": "undo"}])
    assert last.outline.topology == first.outline.topology


@pytest.mark.parametrize(
    ("event", "what"),
    [
        ({"do": "arc", "on": "front.fold", "bulge": 0.1}, "front.fold lies on the fold of its panel"),
        ({"do": "insert", "on": "front.fold", "name": "front.m", "s": 0.5}, "lies on the fold"),
        ({"do": "hole", "name": "slit", "center": [0.05, 0.03], "radius": 0.005}, "in one half of the panel 'front'"),
        ({"do": "hole", "name": "front.slit", "center": [0.002, 0.03], "radius": 0.005}, "front.fold would cross"),
    ],
)
def test_what_would_bend_or_cut_the_fold_is_refused(tmp_path, event, what):
    first, frame = session(tmp_path, [event])
    assert frame.refused and what in frame.refused
    assert frame.outline.topology == first.outline.topology
