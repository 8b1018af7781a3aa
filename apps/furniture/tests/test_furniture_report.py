"""The report of a replay of furniture: Characteristic frames, what guidance reported over all of them, and
suggestions."""

import json

import numpy as np
import pytest
from furniture_scenes import BENCH, write_bench, write_edits
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_hex, to_rgb
from PIL import Image
from restshape_apps.furniture.cli.guidance import print_guidance
from restshape_apps.furniture.report import piece_frames, piece_ranges, piece_suggestions
from restshape_apps.furniture.report.guided import grabbed, guidance, only_limits
from restshape_apps.furniture.report.piece_frames import pieces, telling_frames
from restshape_apps.furniture.report.piece_suggestions import searches
from restshape_apps.furniture.report.status_colour import BEYOND

from restshape.cli.main import main
from restshape.errors import UserError
from restshape.replay.recording.recording import Recording
from restshape.report.space_scene import SpaceImage
from restshape.report.style import INK, REFUSED
from restshape.report.tables import rows_of

EVENTS = [
    {"do": "press", "on": "left", "parameter": "move z"},
    {"do": "drag", "by": -0.7, "frames": 14},
    {"do": "drag", "by": -0.6, "frames": 4},
    {"do": "release"},
    {"do": "choose", "number": 1},
    {"do": "rotate", "on": "left", "by": "4 deg", "about": "y", "frames": 4},
]


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """A recording of a bench whose leg goes too far, and what the report says of it."""
    folder = tmp_path_factory.mktemp("report")
    scene, path = write_bench(folder), folder / "bench.vtkhdf"
    assert main(["replay", str(scene), "--edits", str(write_edits(folder, *EVENTS)), "--out", str(path)]) == 0
    printed = folder / "report.json"
    assert main(["report", str(path), "--json", str(printed)]) == 0
    return path, json.loads(printed.read_text())


def figures(monkeypatch, module):
    """The figures that a module makes from now on, none of which is closed."""
    made, new = [], module.new_figure
    monkeypatch.setattr(module, "new_figure", lambda *size: made.append(new(*size)) or made[-1])
    return made


def space(axes) -> SpaceImage:
    """What is drawn in space."""
    (found,) = (artist for artist in axes.get_children() if isinstance(artist, SpaceImage))
    return found


@pytest.mark.slow
def test_pictures_are_those_of_furniture(recorded):
    printed = recorded[1]
    names = [picture.rpartition("/")[2] for picture in printed["pictures"]]
    assert names == [
        "frames.png",
        "guidance.png",
        "suggestions-20.png",
        "animation.gif",
        "timeline.png",
    ]
    for picture in printed["pictures"]:
        with Image.open(picture) as image:
            assert np.asarray(image.convert("RGB"), dtype=float).std() > 5.0


def test_start_worst_and_end_are_among_the_frames(recorded):
    with Recording(recorded[0]) as recording:
        margin = recording.table["stability_margin"]
        # The leg goes on away from under the box for as long as it is dragged there.
        worst = int(np.argmin(margin))
        assert worst == 15
        for count in (3, 6):
            chosen = telling_frames(recording, count)
            assert len(chosen) == count and {0, worst, recording.n - 1} <= set(chosen.tolist())
        first = int(np.flatnonzero(recording.table["constraint_status"] == "fails")[0])
        assert first in telling_frames(recording, 6)


@pytest.mark.slow
def test_a_frame_shows_the_range_in_the_colour_of_the_constraint_status(recorded, tmp_path, monkeypatch):
    made = figures(monkeypatch, piece_frames)
    with Recording(recorded[0]) as recording:
        low = recording.table["range_low"][3]
        piece_frames.draw_piece_frames(recording, np.array([0, 3, 15]), tmp_path / "frames.png")
    start, valid, fallen = made[0].axes[:3]
    assert [
        line.get_color() for axes in (start, valid, fallen) for line in axes.lines if line.get_linewidth() == 3.2
    ] == [
        INK,
        REFUSED,
    ]
    # Numbers at the ends are counted from where the leg was taken, in millimetres.
    for axes in (valid, fallen):
        ends = [
            text.get_text().replace("\N{MINUS SIGN}", "-") for text in axes.texts if text.get_text().endswith(" mm")
        ]
        assert f"{1e3 * low:+.0f} mm" in ends
    colours = [axes.get_title(loc="left") and axes.title.get_color() for axes in (start, valid, fallen)]
    assert len(colours) == 3 and "holds" in valid.get_title(loc="left") and "falls" in fallen.get_title(loc="left")
    assert all(axes.get_xlim() == start.get_xlim() and axes.get_ylim() == start.get_ylim() for axes in (valid, fallen))


@pytest.mark.slow
def test_the_band_is_the_range_and_dots_are_red_where_the_piece_does_not_hold(recorded, tmp_path, monkeypatch):
    made = figures(monkeypatch, piece_ranges)
    with Recording(recorded[0]) as recording:
        piece_ranges.draw_guidance(recording, tmp_path / "guidance.png")
        table = recording.table
    utilisation, margin, lengths, turns = made[0].axes
    assert lengths.get_ylabel().endswith("[mm]") and turns.get_ylabel().endswith("[°]")
    assert margin.get_xlabel() == "" and turns.get_xlabel() == "frame"
    grabbed_frames = np.flatnonzero(table["parameter"] == "left: move z")
    bands = [band for band in lengths.collections if isinstance(band, PolyCollection) and len(band.get_paths()) == 1]
    spans = [band.get_paths()[0].vertices for band in bands]
    spans = [(v[:, 0].mean(), v[:, 1].min(), v[:, 1].max()) for v in spans if np.ptp(v[:, 0]) == pytest.approx(1.0)]
    frames = [(i, grabbed({"valid_ranges": table["valid_ranges"][i]})) for i in grabbed_frames]
    printed = [(i, 1e3 * one.low, 1e3 * one.high) for i, hand in frames for one in hand.ranges]
    assert np.array(spans)[:, 1:] == pytest.approx(np.array(printed)[:, 1:])
    dots = next(c for c in utilisation.collections if len(c.get_offsets()) == len(table["constraint_status"]))
    red = [np.allclose(colour[:3], to_rgb(REFUSED)) for colour in dots.get_facecolors()]
    assert red == [word == "fails" for word in table["constraint_status"]]


@pytest.mark.slow
def test_suggestions_show_arrows_and_end_states(recorded, tmp_path, monkeypatch):
    made = figures(monkeypatch, piece_suggestions)
    with Recording(recorded[0]) as recording:
        assert searches(recording).tolist() == [20]
        printed = json.loads(recording.table["suggestions"][20])
        piece_suggestions.draw_suggestions(recording, 20, tmp_path / "suggestions.png")
    before, *panels = [axes for axes in made[0].axes if axes.get_visible() and axes.get_title(loc="left")]
    assert len(panels) == len(printed)
    for axes, one in zip(panels, printed):
        title = axes.get_title(loc="left").replace("\n", " ")
        assert title.startswith(f"{one['number']}: ") and one["words"].split(";")[0] in title
        assert not space(axes).veil.empty
    assert space(before).veil.empty
    legend = made[0].get_suptitle().replace("\n", " ")
    assert "what each suggestion makes of it" in legend and "Red: a joint that breaks" in legend
    assert ("Amber heading: it holds, but" in legend) is any(
        "holds, but" in axes.get_title(loc="left") for axes in panels
    )


def test_a_recording_has_the_pieces_of_its_frames(recorded):
    with Recording(recorded[0]) as recording:
        for frame in pieces(recording, [0, 9, 20, recording.n - 1]):
            piece = frame.design.furniture.moved(frame.gamma)
            corners = np.concatenate([plank.corners() for plank in piece.planks])
            assert corners == pytest.approx(recording.points(frame.index), abs=1e-12)
        # Another scene than was recorded.
        planks = recording.header["scene_values"]["planks"]
        planks["left"]["from"][0] += 0.1
        planks["left"]["to"][0] += 0.1
        with pytest.raises(UserError, match="another piece in frame 0"):
            list(pieces(recording, [0]))


@pytest.mark.slow
def test_searches_are_bounded(recorded, tmp_path, capsys):
    common = ["report", str(recorded[0]), "--animation", "none", "--out", str(tmp_path / "few")]
    assert main([*common, "--searches", "0", "--json", str(tmp_path / "few.json")]) == 0
    printed = json.loads((tmp_path / "few.json").read_text())
    assert not [picture for picture in printed["pictures"] if "suggestions" in picture]
    assert main([*common, "--searches", "-1"]) == 2
    assert "no fewer than 0" in capsys.readouterr().err


@pytest.mark.slow
def test_a_limit_alone_is_distinguished_from_a_piece_that_does_not_hold(tmp_path, monkeypatch):
    # The bench holds; a limit below what it weighs does not.
    text = BENCH + '[quantities]\nheavy = { mass = true, limit = "1 g" }\n'
    path = tmp_path / "heavy.vtkhdf"
    script = write_edits(tmp_path, *EVENTS[:2])
    assert main(["replay", str(write_bench(tmp_path, text)), "--edits", str(script), "--out", str(path)]) == 0
    sheets, panels = figures(monkeypatch, piece_frames), figures(monkeypatch, piece_ranges)
    with Recording(path) as recording:
        piece_frames.draw_piece_frames(recording, np.array([0, 3, 15]), tmp_path / "frames.png")
        piece_ranges.draw_guidance(recording, tmp_path / "guidance.png")
        falls = np.array([word.startswith("falls") for word in recording.table["violated_constraints"]])
        assert set(recording.table["constraint_status"]) == {"fails"} and 0 < falls.sum() < recording.n
    titles = [axes._left_title for axes in sheets[0].axes[:3]]
    assert [title.get_color() for title in titles] == [BEYOND, BEYOND, REFUSED]
    assert [("holds, but heavy is" in title.get_text()) for title in titles] == [True, True, False]
    assert "Purple heading" in sheets[0].get_suptitle().replace("\n", " ")
    dots = [c for c in panels[0].axes[0].collections if len(c.get_offsets())]
    marked = {to_hex(c.get_facecolors()[0]): c.get_offsets()[:, 0].tolist() for c in dots}
    assert marked == {BEYOND: np.flatnonzero(~falls).tolist(), REFUSED: np.flatnonzero(falls).tolist()}
    assert any("beyond its limit" in text.get_text() for text in panels[0].legends[0].get_texts())


@pytest.mark.parametrize(
    ("status", "flaws", "alone"), [("holds", 0, False), ("fails", 0, True), ("fails", 8, False), ("", -1, False)]
)
def test_limits_alone_fail_where_the_piece_has_no_flaw(status, flaws, alone):
    assert only_limits({"constraint_status": status, "flaws": flaws}) is alone


@pytest.mark.slow
def test_a_recording_without_findings_is_drawn_and_reported_by_its_text(recorded, tmp_path, capsys):
    with Recording(recorded[0]) as recording:
        for name in ("findings", "valid_ranges"):
            del recording.table[name]
        piece_ranges.draw_guidance(recording, tmp_path / "guidance.png")
        piece_frames.draw_piece_frames(recording, telling_frames(recording, 3), tmp_path / "frames.png")
        rows = rows_of(recording)
    print_guidance(rows)
    printed = capsys.readouterr().out
    assert "falls under its weights" in printed and "record it again" in printed and "valid ranges\n" not in printed
    frame = guidance(rows)["frames"][9]
    assert frame["parameter"] == "left: move z" and frame["findings"] is frame["ranges"] is frame["unit"] is None


def test_planks_are_not_exaggerated(recorded, capsys):
    assert main(["report", str(recorded[0]), "--scale", "2"]) == 2
    assert "planks are drawn where they are" in capsys.readouterr().err


@pytest.mark.slow
def test_a_replay_of_one_frame_and_a_lost_joint_are_drawn(tmp_path):
    text = BENCH + '[joints]\nnear = false\n[joints.a]\nplank = "left"\nend = "+x"\nto = "top"\nface = "-z"\n'
    text += '[joints.b]\nplank = "right"\nend = "+x"\nto = "top"\nface = "-z"\n'
    lost = text.replace("from = [0.5, 0, 0]\nto = [0.5, 0, 0.5]", "from = [0.9, 0, 0]\nto = [0.9, 0, 0.5]")
    path = tmp_path / "lost.vtkhdf"
    assert main(["replay", str(write_bench(tmp_path, lost)), "--out", str(path)]) == 0
    assert main(["report", str(path), "--json", str(tmp_path / "lost.json")]) == 0
    printed = json.loads((tmp_path / "lost.json").read_text())
    assert [frame["constraint_status"] for frame in printed["guidance"]["frames"]] == ["fails"]
    assert any(picture.endswith("frames.png") for picture in printed["pictures"])
