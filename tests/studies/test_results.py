"""What is committed under results/ is what its commands print."""

import json
import re
from pathlib import Path

import pytest
from PIL import Image
from restshape_studies.each_week import daily_values
from restshape_studies.pictures.policies import draw_policies
from restshape_studies.thesis import thesis_table
from restshape_studies.verification import Verification, verifications

from restshape.cli.main import main
from restshape.outputs.picture_files import SOURCE, fingerprint

ROOT = Path(__file__).parents[2]
THESIS = ROOT / "results" / "THESIS.md"


def measured():
    """Applications that measure numbers of the thesis."""
    for app, known in verifications().items():
        if measure := known.load_thesis():
            yield pytest.param(app, marks=[pytest.mark.weekly] if daily_values(measure) == {} else [])


@pytest.mark.slow
@pytest.mark.usefixtures("jobs_here")
@pytest.mark.parametrize("app", list(measured()))
def test_the_committed_table_holds(capsys, monkeypatch, app):
    alone = {app: verifications()[app]}
    monkeypatch.setattr("restshape_studies.verification.verifications", lambda: alone)
    assert main(["tables", "--check", "--out", str(THESIS)]) == 0, capsys.readouterr().out


def test_a_changed_count_is_noticed(tmp_path, capsys, monkeypatch):
    row = {"table": "4.2", "row": "level 1", "quantity": "frames", "thesis": 117, "unit": "frames", "timing": False}
    monkeypatch.setattr(Verification, "thesis_rows", lambda known, timed: [{**row, "ours": 155}])
    path = tmp_path / "THESIS.md"
    assert main(["tables", "--out", str(path)]) == main(["tables", "--check", "--out", str(path)]) == 0
    capsys.readouterr()
    path.write_text(path.read_text(encoding="utf-8").replace("155", "156"), encoding="utf-8")
    assert main(["tables", "--check", "--out", str(path)]) == 1
    assert "not there" in capsys.readouterr().out


def test_what_the_readme_shows_is_there():
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    named = re.findall(r"""(?:\]\(|src=")((?:results|docs)/[^)"]+)""", readme)
    assert len(named) >= 5
    assert [name for name in named if not (ROOT / name.partition("#")[0]).is_file()] == []


def test_thesis_tables_are_markdown():
    rows = [
        {"table": "4.2", "row": "level 1", "quantity": "frames", "thesis": 117, "ours": 120, "unit": ""},
        {"table": "4.2", "row": "level 3", "quantity": "frames", "thesis": 3, "ours": None, "unit": ""},
        {"table": "4.3", "row": "a|b", "quantity": "rate", "thesis": 105.0, "ours": 2345.678, "unit": "1/s"},
    ]
    assert thesis_table(rows) == (
        "## Table 4.2\n\n"
        "| row | quantity | thesis | ours | unit |\n| --- | --- | ---: | ---: | --- |\n"
        "| level 1 | frames | 117 | 120 |  |\n| level 3 | frames | 3 |  |  |\n\n"
        "## Table 4.3\n\n"
        "| row | quantity | thesis | ours | unit |\n| --- | --- | ---: | ---: | --- |\n"
        "| a\\|b | rate | 105 | 2346 | 1/s |\n"
    )


def test_a_redrawn_picture_says_which_data_it_shows_and_other_data_say_otherwise(tmp_path, capsys):
    data = json.loads((ROOT / "results" / "bench-reuse.json").read_text(encoding="utf-8"))
    del data["cantilever"]
    (tmp_path / "found.json").write_text(json.dumps(data))
    redraw = ["bench", "reuse", "--redraw", str(tmp_path / "found.json"), "--out", str(tmp_path)]
    assert main(redraw) == 0
    with Image.open(tmp_path / "bench-reuse.png") as image:
        assert image.info[SOURCE] == fingerprint(data)
    data["plate"]["auto"]["fps"] += 1.0
    assert fingerprint(data) != image.info[SOURCE]
    assert fingerprint({2: 1.0, 10: (1, 2)}) == fingerprint({"10": [1, 2], "2": 1.0})
    (tmp_path / "found.json").write_text('{"a": {"b": 1}}')
    assert main(redraw) == 2
    assert "no results of restshape bench reuse" in capsys.readouterr().err


def test_rows_of_policies_have_dots_on_their_axis_and_no_bars(tmp_path, monkeypatch):
    figures = []
    monkeypatch.setattr("restshape.outputs.picture_files.write_figure", lambda figure, *_: figures.append(figure))
    data = json.loads((ROOT / "results" / "bench-reuse.json").read_text(encoding="utf-8"))
    data.pop("stamp", None)
    draw_policies(data, tmp_path / "a.png")
    (axes,) = figures[0].axes
    assert axes.get_xscale() == "log" and not axes.patches
    dots = sorted(float(line.get_xdata()[0]) for line in axes.lines if line.get_marker() == "o")
    assert dots == sorted(entry["ms"]["p50"] for scene in data.values() for entry in scene.values())
