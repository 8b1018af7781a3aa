"""Options of pictures: fields, ranges, formats, and what frames show besides the field."""

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.quiver import Quiver
from matplotlib.text import Annotation
from PIL import Image
from small_scenes import BLOCK, CLAMPED, HEAD, HOLE, PULLED, STEEL, across, drag, meshed, write_scene, write_script

from restshape.cli.main import main
from restshape.errors import UserError
from restshape.outputs.picture_files import SOURCE
from restshape.replay.recording.recording import Recording
from restshape.report.scene_overlay import Overlay, follow, rebuilt_frames
from restshape.report.scenery import scenery
from restshape.report.survey import known_displacement

PLATE = HEAD + BLOCK.format(width=2, height=1) + HOLE + STEEL + CLAMPED + PULLED + meshed(0.2)
PLATE += '[quantities]\npeak = { stress = "von_mises" }\n'
EVENTS = [
    *drag("window", (0.5, 0.5), across((0.5, 0.5), (0.7, 0.5), 4)),
    {"do": "set", "key": "loads.pull.traction", "value": [0, "-50 MPa"]},
]


@pytest.fixture(scope="module", params=[1, 2])
def recorded(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp("looks")
    out = folder / "out.vtkhdf"
    words = ["--edits", str(write_script(folder, EVENTS)), "--out", str(out), "--set", f"mesh.order={request.param}"]
    assert main(["replay", str(write_scene(folder, PLATE)), *words]) == 0
    return out


def overlaid(recorded, *things):
    """The recording, its scenery, and what draws these things, of all frames."""
    recording = Recording(recorded)
    common = scenery(recording, scale=100.0)
    return recording, common, Overlay(recording, common, range(recording.n), things)


@pytest.mark.slow
def test_the_hand_is_where_the_script_has_it(recorded):
    with Recording(recorded) as recording:
        frames = rebuilt_frames(recording, range(recording.n))
        held = {i: frame.hand for i, frame in frames.items()}
        events = list(recording.table["event"])
        for i, event in enumerate(events):
            assert (held[i] is not None) == (event in ("press", "drag"))
        last = max(i for i, event in enumerate(events) if event == "drag")
        assert held[last] == ("window", (0.7, 0.5))
        # The hole was moved with it.
        ring = recording.points(last)
        assert np.abs(np.hypot(*(ring - (0.7, 0.5)).T) - 0.15).min() < 1e-9


def test_supports_loads_and_the_hand_move_with_the_deformed_shape(recorded):
    recording, common, over = overlaid(recorded, "supports", "loads", "hand")
    with recording:
        axes = Figure().subplots()
        axes.set(xlim=(-1, 3), ylim=(-1, 2))
        found = over.draw(axes, 3)
        (arrows,) = (one for one in found if isinstance(one, Quiver))
        right = recording.points(3)[:, 0] == 2.0
        x = (recording.points(3) + 100.0 * recording.field(3, "displacement"))[right] * common.unit[0]
        assert (arrows.XY[:, 0] >= x[:, 0].min() - 1e-9).all() and (arrows.XY[:, 0] <= x[:, 0].max() + 1e-9).all()
        assert x[:, 0].min() > 2.0 and (arrows.U > 0).all() and not arrows.V.any()
        assert any(getattr(one, "get_text", lambda: "")() == "hand on window" for one in found)
        # The load that an edit has set.
        (arrows,) = (one for one in over.draw(axes, recording.n - 1) if isinstance(one, Quiver))
        assert (arrows.V < 0).all() and not arrows.U.any()


def test_places_follow_the_nodes_exactly_and_between_them_nearly(recorded):
    with Recording(recorded) as recording:
        common = scenery(recording, scale=100.0)
        X, u = recording.points(2), known_displacement(recording, 2)
        moved = follow(recording, 2, common)
        np.testing.assert_allclose(moved(X), common.unit[0] * (X + 100.0 * u), atol=1e-12)


def test_names_stand_at_what_they_name(recorded):
    recording, _, over = overlaid(recorded, "names")
    with recording:
        figure = Figure(figsize=(6, 4))
        axes = figure.add_axes((0.1, 0.1, 0.8, 0.8))
        axes.set(xlim=(-0.5, 2.5), ylim=(-0.5, 1.5))
        found = {one.get_text(): one.xy for one in over.draw(axes, 0) if hasattr(one, "xy")}
        assert set(found) == {"a", "b", "c", "d", "bottom", "right", "top", "left", "window"}
        assert found["a"] == pytest.approx((0.0, 0.0)) and found["window"] == pytest.approx((0.5, 0.5), abs=0.1)


@pytest.mark.parametrize("recorded", [1], indirect=True)
def test_the_name_of_the_hand_lies_on_no_other_and_within_the_axes(recorded):
    """The hand stands in the middle of the hole, where the hole's name is without it, and at the edge of the axes."""
    recording, _, over = overlaid(recorded, "hand", "names")
    with recording:
        for limits in ((-0.5, 2.5), (-1.4, 0.72)):
            figure = Figure(figsize=(4, 3))
            axes = figure.add_axes((0.1, 0.1, 0.8, 0.8))
            axes.set(xlim=limits, ylim=(-0.5, 1.5))
            texts = [one for one in over.draw(axes, 3) if isinstance(one, Annotation)]
            FigureCanvasAgg(figure).draw()
            boxes = {text.get_text(): text.get_bbox_patch().get_window_extent() for text in texts}
            hand = boxes.pop("hand on window")
            assert hand.x1 <= axes.bbox.x1 + 8 and hand.x0 >= axes.bbox.x0 - 8
            inside = [box for box in boxes.values() if axes.bbox.contains(*box.p0)]
            assert inside and not any(hand.overlaps(box) for box in inside)


def test_another_scene_in_the_header_is_refused(recorded):
    with Recording(recorded) as recording:
        recording.header["scene_values"]["shape"]["vertices"]["c"] = [2.5, 1]
        with pytest.raises(UserError, match="other shapes now"):
            rebuilt_frames(recording, [0])
        recording.header["scene_values"]["shape"] = {"file": "x.dxf"}
        with pytest.raises(UserError, match="from a file"):
            rebuilt_frames(recording, [0])


@pytest.mark.slow
@pytest.mark.parametrize("recorded", [2], indirect=True)
def test_pictures_have_the_resolution_and_the_format_that_are_asked_for(recorded, tmp_path):
    few = ["--frames", "1", "--animation", "none", "--out"]
    assert main(["report", str(recorded), *few, str(tmp_path / "a")]) == 0
    looks = ["--field", "displacement", "--range", "0,1e-3", "--show", "none"]
    assert main(["report", str(recorded), *few, str(tmp_path / "b"), "--dpi", "75", *looks]) == 0
    for name in ("frames", "quantities", "timeline"):
        sizes = [np.array(Image.open(tmp_path / folder / f"{name}.png").size) for folder in "ab"]
        assert np.abs(sizes[0] - 2 * sizes[1]).max() <= 2
    for _ in range(2):
        assert main(["report", str(recorded), *few, str(tmp_path / "c"), "--format", "svg"]) == 0
    assert {path.name for path in (tmp_path / "c").iterdir()} >= {"frames.svg", "quantities.svg", "timeline.svg"}
    # Words are words; the body and the colour bar are pictures in it.
    text = (tmp_path / "c" / "frames.svg").read_text()
    assert text.count("<image") == 2 and "von Mises stress" in text


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--range", "3,1"], "smaller one first"),
        (["--range", "a"], "two numbers"),
        (["--show", "mesh,cats"], "'cats'"),
        (["--dpi", "1"], "pixels an inch"),
        (["--field", "cats"], "no field 'cats'"),
    ],
)
def test_options_without_sense_are_bad_input(recorded, tmp_path, capsys, words, message):
    assert main(["report", str(recorded), "--animation", "none", "--out", str(tmp_path), *words]) == 2
    assert message in capsys.readouterr().err


@pytest.mark.slow
def test_pictures_hold_the_hash_of_their_recording(recorded, tmp_path):
    words = ["--frames", "1", "--animation", "none", "--out", str(tmp_path), "--dpi", "50"]
    assert main(["report", str(recorded), *words]) == 0
    with Recording(recorded) as recording:
        own = recording.fingerprint
        recording.rows["q_peak"][0] += 1.0
        assert recording.fingerprint != own
    for path in tmp_path.glob("*.png"):
        with Image.open(path) as image:
            assert image.info[SOURCE] == own
