"""The report says what the recording holds, and draws something for every recording."""

import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
import small_scenes
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgba
from PIL import Image
from plates import COLUMNS, record_plate
from small_scenes import across, drag, write_scene, write_script

from restshape.cli.main import main
from restshape.errors import UserError
from restshape.outputs.si_numbers import length_unit, si, three_digits
from restshape.replay.level_names import LEVEL_NAMES
from restshape.replay.recording.recorder import Recorder
from restshape.replay.recording.recording import Recording
from restshape.report import quantity_panels, timeline
from restshape.report.animation import animated_frames
from restshape.report.frames import LEFT, caption, layout
from restshape.report.happenings import _what_it_does, chosen_frames, failure
from restshape.report.levels import stage_shares
from restshape.report.outlines import border
from restshape.report.scenery import scenery
from restshape.report.tables import level_table, quantity_table
from restshape.report.timeline import draw_timeline


@pytest.fixture(scope="module")
def plate(tmp_path_factory):
    path = tmp_path_factory.mktemp("report") / "plate.vtkhdf"
    return path, record_plate(path, frames=24, remesh_every=8)


def report(path: Path, *words: str) -> int:
    return main(["report", str(path), *words])


def test_levels_and_quantities_are_those_recorded(plate):
    path, known = plate
    with Recording(path) as recording:
        levels = {row["level"]: row for row in level_table(recording)}
        for k in (1, 2, 3):
            ms = [row["ms"] for row in known[1:] if row["level"] == k]
            assert levels[str(k)]["frames"] == len(ms)
            for name, share in (("p50", 50), ("p95", 95), ("p99", 99)):
                assert levels[str(k)][name] == pytest.approx(np.percentile(ms, share), rel=1e-14)
        assert levels["all"]["frames"] == sum(row["level"] > 0 for row in known[1:])
        # They all solve.
        assert levels["still"]["frames"] == sum(row["level"] == 0 for row in known[1:]) and not levels["idle"]["frames"]
        tips = [row["q_tip"] for row in known]
        expected = {"first": tips[0], "last": tips[-1], "min": min(tips), "max": max(tips)}
        assert quantity_table(recording) == [{"quantity": "tip", **expected, "unit": ""}]


@pytest.mark.slow
def test_replay_and_report_have_one_name_for_a_level_and_for_a_column(tmp_path, command):
    events = [{"do": "idle"}, {"do": "set", "key": "loads.pull.traction", "value": [2e8, 1e8]}]
    files = write_scene(tmp_path, small_scenes.plate(0.3)), write_script(tmp_path, events)
    replayed = command("replay", *files, "--out", "plate.vtkhdf").stdout
    reported = command("report", "plate.vtkhdf", "--frames", "1", "--animation", "none").stdout

    def named(text: str) -> set[str]:
        return {name for name in LEVEL_NAMES.values() if f"\n{name} " in text}

    moves = {"1 relocation", "2 reconnection", "3 reconstruction"}
    assert named(replayed) == moves | {"0 solved"}
    assert named(reported) - {"1 to 3"} == moves | {"0 idle", "0 values changed"}
    heads = [re.findall(r"^quantity .*$", text, re.M)[0].split()[:5] for text in (replayed, reported)]
    assert heads == [["quantity", "first", "last", "min", "max"]] * 2


def test_stages_share_the_time_of_their_level(plate):
    with Recording(plate[0]) as recording:
        shares = stage_shares(recording, 1)
    # ms = 1 + i, krylov = values = (1 + i) / 2: see plates.py
    assert shares["krylov"] == pytest.approx(0.5) and shares["values"] == pytest.approx(0.5)
    assert sum(shares.values()) == pytest.approx(1.0)


@pytest.mark.slow
def test_the_command_writes_pictures_tables_and_json(plate, tmp_path, capsys):
    path, _ = plate
    data = tmp_path / "report.json"
    assert report(path, "--out", str(tmp_path / "pictures"), "--json", str(data)) == 0
    printed = capsys.readouterr().out
    assert "24 frames, 3 refused" in printed and "tip" in printed
    found = json.loads(data.read_text())
    assert found["frames"] == 24 and found["refused"] == 3 and found["status"] == "done"
    assert [Path(p).name for p in found["pictures"]] == [
        "frames.png",
        "levels.png",
        "quantities.png",
        "timeline.png",
        "animation.gif",
    ]
    for picture in found["pictures"]:
        with Image.open(picture) as image:
            colours = np.asarray(image.convert("RGB")).reshape(-1, 3) @ [1 << 16, 1 << 8, 1]
            assert min(image.size) > 300 and len(np.unique(colours)) > 20
            if picture.endswith("gif"):
                assert image.n_frames == 24


def test_the_deformation_is_exaggerated_to_8_percent(plate):
    path, known = plate
    largest = max(np.hypot(*frame["displacement"].T).max() for frame in known)
    with Recording(path) as recording:
        common = scenery(recording)
        assert common.largest == largest
        assert common.scale * largest == pytest.approx(0.08 * 1.2, rel=0.06)
        assert scenery(recording, 3.0).scale == 3.0
        xmin, xmax, ymin, ymax = common.extent
        for frame in known:
            x = frame["points"] + common.scale * frame["displacement"]
            assert xmin < x[:, 0].min() and x[:, 0].max() < xmax and ymin < x[:, 1].min() and x[:, 1].max() < ymax


def test_frames_shown_hold_the_refused_which_say_so(plate):
    path, known = plate
    with Recording(path) as recording:
        chosen = chosen_frames(recording, 6)
        assert len(chosen) == 6 and chosen[0] == 0 and chosen[-1] == 23
        assert any(known[i]["refused"] for i in chosen) and any(known[i]["level"] == 3 for i in chosen[1:])
        largest = max((i for i in range(24) if not known[i]["refused"]), key=lambda i: abs(known[i]["q_tip"]))
        assert largest in chosen
        common = scenery(recording)
        for i in range(24):
            assert failure(recording, i).startswith("REFUSED") == bool(known[i]["refused"])
            words = caption(recording, i, common, 80)
            assert ("hole outside" in words) == bool(known[i]["refused"])
            # The script dragged in all frames: one that was refused did not rest.
            assert not known[i]["refused"] or ("drag" in words and "idle" not in words)
        assert animated_frames(recording, 10).tolist() == [0, 3, 6, 9, 12, 15, 18, 21, 23]


def test_the_boundary_of_two_triangles_is_their_four_sides():
    edges = border(np.array([[0, 1, 2], [2, 1, 3]]))
    assert {tuple(edge) for edge in edges.tolist()} == {(0, 1), (0, 2), (1, 3), (2, 3)}


CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("frames", "refused", "fields", "columns"),
    [
        (1, "", True, COLUMNS),
        (3, "outline crosses itself", True, COLUMNS),
        (3, "", False, COLUMNS),
        (2, "", True, {"index": "i4"}),
        (1, "no equilibrium", False, {}),
    ],
)
def test_poor_recordings_still_report(tmp_path, frames, refused, fields, columns):
    path = tmp_path / "poor.vtkhdf"
    with Recorder.start(path, {}, columns) as recorder:
        recorder.topology(np.array([[0, 1, 2]]))
        for i in range(frames):
            row = {"index": i, "refused": refused, "level": 0, "ms": 0.0}
            data = ({"displacement": np.zeros((3, 2))}, {"von_mises": np.full(1, np.nan)}) if fields else ({}, {})
            recorder.frame(0.0, CORNERS, *data, {name: row[name] for name in row if name in columns})
    assert report(path) == 0
    # One frame is made from nothing, and no level's; it has no course, and nothing of it moves.
    wanted = {"frames.png"} | ({"animation.gif", "timeline.png", "levels.png"} if frames > 1 else set())
    wanted |= {"quantities.png"} if "q_tip" in columns else set()
    assert {p.name for p in (tmp_path / "poor-report").iterdir()} == wanted


def test_an_empty_recording_and_bad_words_are_bad_input(tmp_path, capsys, plate):
    with Recorder.start(tmp_path / "a.vtkhdf", {}, {}):
        # What a writer leaves that is killed before its first frame.
        (part,) = tmp_path.glob("a.vtkhdf.part-*")
        shutil.copy(part, tmp_path / "a.vtkhdf")
    assert report(tmp_path / "a.vtkhdf") == 2
    assert report(tmp_path / "none.vtkhdf") == 2
    assert report(plate[0], "--frames", "0") == 2
    assert report(plate[0], "--scale", "0") == 2
    assert report(tmp_path) == 2
    assert report(plate[0], "--out", str(plate[0])) == 2
    (tmp_path / "file").write_text("")
    assert report(plate[0], "--out", str(tmp_path / "file" / "x")) == 2
    printed = capsys.readouterr().err
    messages = ("holds no frames", "no such recording", "at least one frame", "cannot be written", "greater than 0")
    for message in (*messages, "this is a folder", "this is a file"):
        assert message in printed


@pytest.mark.slow
def test_predicted_frames_are_hollow_in_the_timeline_and_in_quantities(tmp_path, monkeypatch):
    scene = write_scene(tmp_path, small_scenes.plate(0.2))
    edits = write_script(tmp_path, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.53, 0.5), 5)))
    out, figures = tmp_path / "a.vtkhdf", []
    call = ["replay", str(scene), "--edits", str(edits), "--out", str(out)]
    monkeypatch.setattr("restshape.outputs.picture_files.write_figure", lambda figure, *_: figures.append(figure))
    for words, hollow in (["--predict", "linear"], [2.0, 3.0, 4.0, 5.0, 6.0]), ([], []):
        assert main([*call, *words]) == 0
        with Recording(out) as recording:
            draw_timeline(recording, tmp_path / "a.png")
        figure = figures.pop()
        for axes in figure.axes:
            white = [line for line in axes.lines if line.get_markerfacecolor() == "white"]
            assert sorted(x for line in white for x in line.get_xdata()) == hollow
        names = [text.get_text() for text in figure.legends[0].get_texts()]
        assert ("predicted, not solved (5)" in names) == bool(hollow)
        assert len(names) == len(set(names))
        with Recording(out) as recording:
            quantity_panels.draw_quantities(recording, tmp_path / "b.png")
            value = 1e-6 * recording.table["q_peak"][2:7]
            away = 1e-6 * recording.table["peak_distance"][2:7] if hollow else np.zeros(0)
        figure = figures.pop()
        panel = next(axes for axes in figure.axes if axes.get_title(loc="left").startswith("peak"))
        white = [line for line in panel.lines if line.get_markerfacecolor() == "white"]
        assert sorted(x for line in white for x in line.get_xdata()) == hollow
        # Predicted frames lie side by side: their band is one area.
        colour = to_rgba(quantity_panels.DISTANCE)
        bands = [one for one in panel.collections if isinstance(one, PolyCollection)]
        bands = [
            path.get_extents() for one in bands if tuple(one.get_facecolor()[0]) == colour for path in one.get_paths()
        ]
        sides = [(box.y0, box.y1) for box in bands if np.isfinite(box.y0)]
        assert sides == ([pytest.approx((min(value - away), max(value + away)), rel=1e-9)] if hollow else [])


def test_refused_frames_have_a_mark_and_values_between_them_their_error(tmp_path, monkeypatch):
    """Frames 1 and 3 are refused: in timelines they are no idle ones, and the value between has its whole band."""
    columns = {"level": "i4", "iterations": "i4", "do": str, "ms": "f8", "refused": "str", "q_a": "f8", "a_error": "f8"}
    with Recorder.start(tmp_path / "a.vtkhdf", {}, columns) as recorder:
        recorder.topology(np.array([[0, 1, 2]]))
        for i in range(5):
            row = {"level": 0, "iterations": 2, "do": "idle", "ms": 1.0, "refused": "no" if i in (1, 3) else ""}
            row |= {"q_a": 1.0 + i, "a_error": 0.25}
            recorder.frame(float(i), CORNERS, {}, {}, {name: row[name] for name in columns if name in row})
    figures = []
    for module in (timeline, quantity_panels):
        monkeypatch.setattr(module, "save_picture", lambda figure, path: figures.append(figure))
    with Recording(tmp_path / "a.vtkhdf") as recording:
        draw_timeline(recording, tmp_path / "a.png")
        assert quantity_panels.draw_quantities(recording, tmp_path / "b.png")
    levels = figures[0].axes[0]
    marked = {line.get_marker(): line.get_xdata().tolist() for line in levels.lines if len(line.get_xdata())}
    assert marked == {"o": [0, 2, 4], "P": [1, 3]}
    (panel,) = figures[1].axes
    # The second one is that of the legend.
    band, _ = (one for one in panel.collections if isinstance(one, PolyCollection))
    sides = [path.get_extents() for path in band.get_paths()]
    boxes = [(box.x0, box.x1, box.y0, box.y1) for box in sides]
    assert boxes == [(i - 0.5, i + 0.5, 0.75 + i, 1.25 + i) for i in (0, 2, 4)]
    (alone,) = (line for line in panel.lines if line.get_marker() == "o")
    assert alone.get_xdata().tolist() == [0, 2, 4]


def test_captions_of_narrow_panels_take_lines(plate):
    with Recording(plate[0]) as recording:
        common = scenery(recording)
        whole = caption(recording, 6, common, 300)
        parts = caption(recording, 6, common, 24).split("\n")
    assert "\n" not in whole and " ".join(parts) == whole
    assert len(parts) > 1 and max(map(len, parts)) <= 24


def test_a_sheet_of_tall_parts_has_room_for_captions():
    for count in (1, 6, 12, 40):
        sheet = layout(count, 0.1)
        assert sheet.rows * sheet.columns >= count and sheet.width >= 1.2
        assert LEFT + sheet.columns * sheet.width < 9.5 and sheet.rows * sheet.height < 9.5


def test_frames_that_change_values_are_not_idle(tmp_path):
    columns = {"level": "i4", "iterations": "i4", "do": str, "ms": "f8"}
    events = (("press", 0), ("set", 7), ("set", 0), ("undo", 3), ("idle", 9))
    with Recorder.start(tmp_path / "a.vtkhdf", {}, columns) as recorder:
        recorder.topology(np.array([[0, 1, 2]]))
        for i, (do, iterations) in enumerate(events):
            row = {"level": 0, "iterations": iterations, "do": do, "ms": 1.0}
            recorder.frame(float(i), CORNERS, {}, {}, row)
    with Recording(tmp_path / "a.vtkhdf") as recording:
        frames = {row["level"]: row["frames"] for row in level_table(recording)}
        shown = [_what_it_does(recording, i) for i in range(5)]
    assert shown == ["idle", "values changed", "idle", "values changed", "solved"]
    # The frame 0 is left out. The last one solves though nothing changed, as each does in time.
    assert frames["values"] == 2 and frames["idle"] == 1 and frames["still"] == 1


@pytest.mark.slow
def test_without_ffmpeg_the_animation_is_a_gif(plate, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(shutil, "which", lambda _: None)
    assert report(plate[0], "--out", str(tmp_path), "--animation", "mp4") == 0
    assert "needs ffmpeg" in capsys.readouterr().err
    assert (tmp_path / "animation.gif").stat().st_size > 1000 and (tmp_path / "frames.png").is_file()


def test_shapes_in_space_are_not_drawn(tmp_path):
    with Recorder.start(tmp_path / "a.vtkhdf", {}, {}) as recorder:
        recorder.topology(np.array([[0, 1, 2, 3]]))
        recorder.frame(0.0, np.vstack([np.zeros(3), np.eye(3)]), {}, {}, {})
    with Recording(tmp_path / "a.vtkhdf") as recording, pytest.raises(UserError, match="in the plane only"):
        scenery(recording)
    assert report(tmp_path / "a.vtkhdf") == 0


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (2.1e-4, "m", "210 µm"),
        (210e9, "Pa", "210 GPa"),
        (0.0, "N", "0 N"),
        (-1234.0, "N", "-1.23 kN"),
        (1.5e-5, "m²", "1.5e-05 m²"),
        (999.7, "", "1000"),
        (999.994, "N", "1000 N"),
        (999.996, "N", "1 kN"),
        (2.5e17, "Pa", "2.5e+05 TPa"),
        (2.5e-15, "m", "0.0025 pm"),
        (float("nan"), "m", "–"),
    ],
)
def test_numbers_carry_si_prefixes(value, unit, text):
    assert si(value, unit) == text


def test_lengths_on_axes_suit_the_part():
    assert [length_unit(size)[1] for size in (12.0, 1.2, 0.3, 2e-4)] == ["m", "m", "mm", "µm"]


def test_times_have_three_digits_and_no_exponent():
    found = [three_digits(value) for value in (0.01234, 12.345, 999.4, 999.6, 2843.7, 1e5, 1e9, -4321.0, 0.0)]
    assert found == ["0.0123", "12.3", "999", "1000", "2844", "100000", "1e+09", "-4321", "0"]
