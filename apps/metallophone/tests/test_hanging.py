"""Where plates are hung: places, weights, named pairs, columns, words, and what a user can get wrong."""

import csv
import json
import re

import numpy as np
import pytest
from restshape_apps.metallophone import application
from restshape_apps.metallophone.hung import hung_words

from restshape.analysis.modal.border_distance import BorderDistance
from restshape.analysis.modal.hanging import Hanging, HangingPoints, hanging_of, hanging_points
from restshape.analysis.modal.nodal_lines import linear_triangles
from restshape.cli.main import main
from restshape.errors import UserError
from restshape.interface.first_frame import first_frame
from restshape.scene.load import load_scene

SCENES = application.folder / "scenes"
PLATE = ("effects.modal.model=plate", "effects.modal.modes=4", 'mesh.size="6 mm"')
CORDS = (
    "shape.holes={nose={circle={center=[0.045,0.02],radius=0.002}},tail={circle={center=[0.155,0.02],radius=0.002}}}"
)


def bar(*overrides):
    return first_frame(SCENES / "bar_200.toml", [*PLATE, *overrides]).analysis


def test_plates_and_solids_are_hung_at_the_same_places():
    plate = hanging_points(bar())
    solid = hanging_points(
        first_frame(
            SCENES / "bar_200.toml",
            ["effects.modal.modes=4", "mesh.order=2", "mesh.layers=1", 'mesh.size="12 mm"'],
        ).analysis
    )
    np.testing.assert_allclose(plate.places, solid.places, atol=4e-4)
    np.testing.assert_allclose(plate.places[:, 1], 0.015, atol=1e-4)
    np.testing.assert_allclose(plate.losses, solid.losses, atol=0.02)
    assert plate.offset < 1e-4 and plate.losses[2] < 1e-4


def test_weights_say_which_modes_are_spared():
    """Mode 2 of a free square, still along diagonals, draws places to the middle of the cross, mode 3 to a ring."""
    square = first_frame(SCENES / "square.toml", ["mesh.size=0.6", "effects.modal.modes=3"]).analysis
    middle, ring = hanging_points(square, [0, 1]), hanging_points(square, [0, 0, 1])
    for found in (middle, ring):
        assert np.abs(found.places - 5.0).min(axis=1).max() < 0.05 and found.offset < 0.2
    apart = [float(np.hypot(*(found.places[1] - found.places[0]))) for found in (middle, ring)]
    # No closer than the radius of gyration, side / sqrt(6).
    assert 10.0 / np.sqrt(6.0) <= apart[0] < 4.5 and apart[1] == pytest.approx(8.5, abs=0.1)
    assert ring.losses[2] < 1e-3 < middle.losses[2] and middle.losses[1] < ring.losses[1]


@pytest.mark.parametrize(
    ("scene", "overrides", "mode"),
    [
        ("disc.toml", ("supports={}", "mesh.size=0.22", "effects.modal.model=solid", "mesh.order=1"), 1),
        ("square.toml", ("mesh.size=2",), 4),
    ],
)
def test_a_pair_that_a_coarse_mesh_parts_is_one(scene, overrides, mode):
    analysis = first_frame(SCENES / scene, overrides).analysis
    values = analysis.state.modes.values
    assert values[mode] / values[mode - 1] > 1.005
    why = hanging_of(analysis.state, Hanging(mode=mode)).why
    assert "2 modes" in why and "as far as this mesh shows" in why


def test_modes_that_a_shape_parts_are_none():
    """Lengths that differ by 0.5 % part the pair of a square by 0.7 %, twice what this mesh errs by."""
    sides = ("shape.vertices.b=[10.05,0]", "shape.vertices.c=[10.05,10]")
    state = first_frame(SCENES / "square.toml", ["mesh.size=0.6", "effects.modal.modes=5", *sides]).analysis.state
    assert state.modes.values[4] / state.modes.values[3] < 1.01 and hanging_of(state, Hanging(mode=4)).found


def test_what_supports_hold_is_not_hung():
    """A clamped disc is still along its rim, which is no nodal line."""
    found = hanging_points(first_frame(SCENES / "disc.toml", ["mesh.size=0.3"]).analysis)
    assert found.why == "what supports hold is not hung" and np.isnan(found.places).all()


def test_a_named_pair_is_judged_by_points_and_by_rims():
    found = hanging_of(bar(CORDS).state, Hanging(at=("nose", "tail")))
    np.testing.assert_allclose(found.places, [[0.045, 0.02], [0.155, 0.02]], atol=1e-5)
    # 5 mm off the axis torsion moves; the lines of bending go through both holes.
    assert found.losses[0] < 0.02 < found.losses[2]
    points = 'shape.points={p=["45 mm","15 mm"],q=["100 mm","15 mm"]}'
    middle = hanging_of(bar(points).state, Hanging(at=("p", "q")))
    # The middle of a free beam moves by 1.2156 times the root of its mean square.
    assert middle.losses[0] == pytest.approx(0.5 * 1.2156**2, rel=0.03)


def test_a_bar_is_not_hung_closer_than_asked():
    made = bar()
    far = hanging_of(made.state, Hanging(apart=0.112))
    assert np.hypot(*(far.places[1] - far.places[0])) >= 0.112
    none = hanging_of(made.state, Hanging(apart=1.0))
    assert not none.found and "centre of mass between" in none.why and np.isnan(none.places).all()


def test_places_keep_a_margin_from_the_border():
    """A bar with a slit is hung at the rim of the slit; with a margin no nearer to any side than that."""
    slit = "shape.holes={slit={polygon=[[0.03,0.012],[0.06,0.012],[0.06,0.018],[0.03,0.018]]}}"
    state = bar(slit).state
    triangles = linear_triangles(state.body.plane.cells)
    border = BorderDistance(state.body.plane.X, triangles)
    free, kept = (hanging_of(state, Hanging(margin=margin)) for margin in (0.0, 4e-3))
    assert border(free.places).min() < 2e-3 < 4e-3 * (1.0 - 1e-9) <= border(kept.places).min() < 6e-3
    # Still on the lines of mode 1, at a place that takes more from the others.
    assert kept.losses[0] < 1e-3 and kept.losses.sum() > free.losses.sum()
    assert "20 mm off the border" in hanging_of(state, Hanging(margin=0.02)).why


def test_distances_from_a_border_are_those_of_a_square():
    X = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.5]])
    border = BorderDistance(X, np.array([[k, (k + 1) % 4, 4] for k in range(4)]))
    np.testing.assert_allclose(border(np.array([[0.5, 0.5], [0.2, 0.7], [1.0, 0.3]])), [0.5, 0.2, 0.0], atol=1e-15)
    at = np.array([[[0.0, 0.5], [0.5, 0.5]], [[0.5, 0.5], [0.5, 1.0]], [[0.0, 0.1], [0.1, 0.1]]])
    found = border.kept(at, np.array([0.2, 0.3, 0.5]), 0.25)
    np.testing.assert_allclose(found, [0.5, 0.3, np.nan], atol=1e-9)


DRAGGED = (
    {"format": "restshape-edits", "version": 1, "units": "mm"},
    {"t": 0.0, "do": "press", "on": "right", "at": [200, 15]},
    {"t": 0.1, "do": "drag", "path": [[220, 15]], "frames": 5},
    {"t": 0.6, "do": "release"},
)


@pytest.mark.parametrize("predict", ["none", "linear"])
def test_frames_have_columns_of_places_and_predicted_ones_too(tmp_path, predict):
    edits, table = tmp_path / "longer.jsonl", tmp_path / "frames.csv"
    edits.write_text("".join(json.dumps(event) + "\n" for event in DRAGGED))
    words = [word for one in (*PLATE, "effects.modal.hanging={weights=[1,1]}") for word in ("--set", one)]
    command = ["replay", str(SCENES / "bar_200.toml"), str(edits), *words, "--predict", predict, "--csv", str(table)]
    assert main(command) == 0
    with table.open() as lines:
        rows = list(csv.DictReader(lines))
    assert sum(int(row["predicted"]) for row in rows) == (0 if predict == "none" else 5)
    lengths = np.array([float(row["q_area"]) / 0.03 for row in rows])
    shares = np.array([[float(row[f"hang_{k}_x"]) for row in rows] for k in (1, 2)]) / lengths
    # In the middle of its width the lines of a bar of 30 mm are bent inwards a little.
    np.testing.assert_allclose(shares[0], 0.2247, atol=5e-4)
    np.testing.assert_allclose(shares[1], 0.7753, atol=5e-4)
    assert lengths[-1] == pytest.approx(0.22) and not any(row["hang_note"] for row in rows)
    assert {"hang_loss_4", "tone_4", "cents_4"} <= rows[0].keys() and "hang_loss_5" not in rows[0]


def test_words_and_data_of_the_command(tmp_path, capsys):
    found = tmp_path / "a.json"
    words = [word for one in PLATE for word in ("--set", one)]
    assert main(["modes", str(SCENES / "bar_200.toml"), *words, "--json", str(found)]) == 0
    said, hanging = capsys.readouterr().out, json.loads(found.read_text())["hanging"]
    assert re.search(r"1   523\.3\d  C5     \+0\.\d", said) and "hang at (4" in said and "mm" in said
    assert hanging["places"][0][0] == pytest.approx(0.045, abs=5e-4) and len(hanging["losses"]) == 4
    assert main(["modes", str(SCENES / "disc.toml"), "--set", "supports={}", "--json", str(found)]) == 0
    assert "lines not fixed" in capsys.readouterr().out and "2 modes" in json.loads(found.read_text())["hanging"]["why"]
    assert main(["modes", str(SCENES / "disc.toml"), "--set", "mesh.size=0.3", "--json", str(found)]) == 0
    assert "hanging" not in json.loads(found.read_text())


def test_coordinates_that_are_0_but_for_rounding_are_0_in_words():
    places = np.array([[0.0264, 0.008], [0.132, -7.2e-20]])
    assert "(132, 0) mm" in hung_words(HangingPoints(places, np.zeros(2), 0.0))


@pytest.mark.parametrize(
    ("scene", "overrides", "what"),
    [
        ("bar_200.toml", ["effects.modal.model=plane_stress"], "no nodal lines"),
        ("disc.toml", [], "what supports hold is not hung"),
        ("bar_200.toml", ["effects.modal.hanging.mode=3"], "only 1 mode is computed"),
        ("bar_200.toml", ["effects.modal.hanging.weights=[1,1,1]"], "only 1 mode is computed"),
        ("bar_200.toml", ["effects.modal.hanging.weights=[-1]"], "too small"),
        ("bar_200.toml", ['effects.modal.hanging.at=["left","nose"]'], "there is no entity 'nose'"),
        ("bar_200.toml", ['effects.modal.hanging.at=["p"]'], "two places"),
        ("bar_200.toml", ['effects.modal.hanging.at=["p","p"]'], "two places"),
        ("bar_200.toml", ['effects.modal.hanging.apart="-1 mm"'], "too small"),
    ],
)
def test_what_makes_no_sense_is_refused(scene, overrides, what):
    with pytest.raises(UserError, match=what) as caught:
        load_scene(SCENES / scene, ["effects.modal.hanging={}", *overrides])
    assert "hanging" in caught.value.where
