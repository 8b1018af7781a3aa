"""Where a frame goes, drawn before and after; times here are made up."""

import json

import pytest
from restshape_studies.pictures.stages import BESIDE, COLOURS, draw_stages, stage_parts

from restshape.cli.main import main
from restshape.cli.shipped import named_scenes
from restshape.errors import UserError
from restshape.outputs.picture_files import SOURCE, fingerprint
from restshape.replay.columns import STAGES


def record(ms, python=0.5, record=0.25, levels=("1",), **stages):
    """What a policy measured."""
    found = {**dict.fromkeys(STAGES, 0.0), **stages, "python": python, "record": record}
    return {
        "elements": 1234,
        "levels": {level: 5 * (level in levels) for level in ("1", "2", "3", "still")},
        "ms": {"p50": ms, "p95": ms},
        "fps": 1e3 / ms,
        "ms_by_level": {level: {"p50": ms} for level in levels},
        "stages_by_level": dict.fromkeys(levels, found),
    }


def test_stages_are_parts_of_the_median_frame_and_python_holds_the_edit():
    # Medians of stages need not sum up to that of the frame: 1 + 2 + 0.5 ms against 7.
    parts = stage_parts(record(7.0, edit=0.2, values=1.0, krylov=2.0), "1")
    assert sum(parts.values()) - parts[BESIDE] == pytest.approx(7.0)
    assert parts["values"] == pytest.approx(2.0) and parts["krylov"] == pytest.approx(4.0)
    assert parts["edit"] == pytest.approx(0.4) and parts["other"] == pytest.approx(0.6)
    assert parts[BESIDE] == 0.25 and list(parts) == list(COLOURS)
    assert stage_parts(record(7.0), "2") == {}
    # Files of earlier times have no stage of estimates.
    old = record(7.0, estimate=0.125)
    assert stage_parts(old, "1")[BESIDE] == 0.375
    del old["stages_by_level"]["1"]["estimate"]
    assert stage_parts(old, "1")[BESIDE] == 0.25


@pytest.fixture
def figures(monkeypatch):
    """Figures that are drawn, in place of their files."""
    found = []
    monkeypatch.setattr("restshape.outputs.picture_files.write_figure", lambda figure, *_: found.append(figure))
    return found


def drawn(figures, folder):
    before = {"plate": {"auto": record(2.0, values=1.5)}}
    after = {
        "plate": {"auto": record(1.0, values=0.5), "auto:zero": record(9.0), "rebuild": record(30.0, levels=("3",))},
        "a cloth with quite a long name": {"auto": record(123.456, levels=("still",))},
    }
    draw_stages(before, after, ("commit 0123456789ab", "this code"), folder / "a.png")
    return figures[0]


def test_bars_are_in_parts_of_the_frame_before_and_nothing_is_clipped(tmp_path, figures):
    figure = drawn(figures, tmp_path)
    figure.draw_without_rendering()
    first = figure.axes[0]
    assert [label.get_text() for label in first.get_yticklabels()] == ["auto before", "after"]
    assert {axes.get_xlabel() for axes in figure.axes} == {"", "time over that of the earlier run [%]"}
    # Two bars from the left edge: of 2 ms and of 1 ms in units of the first.
    ends = {}
    for bar in first.patches:
        ends[bar.get_y()] = max(ends.get(bar.get_y(), 0.0), bar.get_x() + bar.get_width())
    assert sorted(ends.values()) == pytest.approx([1.25 / 2.0, 2.25 / 2.0])
    page = figure.bbox
    for axes in figure.axes:
        for text in (*axes.texts, axes.title, axes.xaxis.label, *axes.get_yticklabels()):
            box = text.get_window_extent()
            assert page.x0 <= box.x0 and box.x1 <= page.x1 and page.y0 <= box.y0 and box.y1 <= page.y1, text
        for text in axes.texts:
            assert text.get_window_extent().x1 <= axes.get_window_extent().x1 + 1.0, text


def test_no_texts_overlap(tmp_path, figures):
    figure = drawn(figures, tmp_path)
    figure.draw_without_rendering()
    for axes in figure.axes:
        texts = [text for text in (axes._left_title, *axes.texts) if text.get_text()]
        boxes = [text.get_window_extent() for text in texts]
        assert all(not one.overlaps(other) for one in boxes for other in boxes if one is not other)


def test_a_redrawn_picture_holds_the_hash_of_both_data(tmp_path, capsys):
    from PIL import Image

    before, after = {"plate": {"auto": record(2.0)}}, {"plate": {"auto": record(1.0)}}
    for name, data in (("before", {"stamp": "commit 0123456789ab, code 1, content 2", **before}), ("after", after)):
        (tmp_path / f"{name}.json").write_text(json.dumps(data))
    words = (
        "--redraw",
        str(tmp_path / "after.json"),
        "--before",
        str(tmp_path / "before.json"),
        "--out",
        str(tmp_path),
    )
    assert main(["bench", "reuse", *words]) == 0
    with Image.open(tmp_path / "bench-stages.png") as image:
        assert image.info[SOURCE] == fingerprint({"before": before, "after": after})
    (tmp_path / "before.json").write_text('{"plate": {"auto": 1}}')
    capsys.readouterr()
    assert main(["bench", "reuse", *words]) == 2
    assert "--before" in capsys.readouterr().err


def test_installed_scenes_have_short_names_and_files_come_first(tmp_path, monkeypatch):
    installed = [tmp_path / f"{app}/scenes/{name}.toml" for app, name in (("a", "bar"), ("b", "bar"), ("b", "cup"))]
    names = ["cup", "a/bar", "b/cup", "nowhere.toml"]
    found = named_scenes([type(tmp_path)(name) for name in names], installed)
    assert found == [installed[2], installed[0], installed[2], type(tmp_path)("nowhere.toml")]
    with pytest.raises(UserError, match="2 installed scenes"):
        named_scenes([type(tmp_path)("bar")], installed)
    # A folder of that name is no scene; a file is.
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cup").mkdir()
    assert named_scenes([type(tmp_path)("cup")], installed) == [installed[2]]
