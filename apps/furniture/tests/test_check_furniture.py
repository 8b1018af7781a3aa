"""What `restshape check` reports of a piece of furniture."""

import json
import re

import pytest
from furniture_scenes import BENCH, write_bench

from restshape.cli.main import main


def check(*words: object) -> int:
    """The exit code of `check`."""
    return main(["check", *(str(word) for word in words)])


def test_check_shows_planks_joints_and_loads_of_furniture_in_space(tmp_path, capsys):
    # Drawn against x: its z points down.
    drawn = BENCH.replace("from = [-0.6, 0, 0.51]\nto = [0.6, 0, 0.51]", "from = [0.6, 0, 0.51]\nto = [-0.6, 0, 0.51]")
    text = drawn.replace('mass = "20 kg"', 'mass = "20 kg"\nat = [0.5, 0, 0.5]')
    limit = '[quantities]\nlong = { length = "x", at = "top", limit = "90 cm" }\n'
    assert check(write_bench(tmp_path, text + limit), "--json", tmp_path / "check.json") == 0
    reported = [" ".join(line.split()) for line in capsys.readouterr().out.splitlines()]
    board = "1200 x 300 x 20 mm of pine, middle at (0, 0, 0.51) m; x along -x, y along +y, z along -z"
    assert f"plank top {board}" in reported and "weight box 200 N on top at (-0.6, 0, 0.5) m" in reported
    # A fastener each 20 mm along the 300 mm.
    assert any(line.startswith("joint left +x on top +z, 300 mm long, 15 'screw'") for line in reported)
    assert "quantity long sum of length x at top, holds up to 900 mm" in reported
    (status,) = [line for line in reported if line.startswith("constraint status")]
    assert status == "constraint status holds, but long is 1.2 m, at most 900 mm"
    found = json.loads((tmp_path / "check.json").read_text())
    assert found["planks"]["top"]["axes"] == [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]]


def test_check_names_each_wood_and_each_fastener(tmp_path, capsys):
    text = BENCH.replace("[planks.left]", '[planks.left]\nwood = "oak"')
    assert text != BENCH
    text += '[joints.other]\nplank = "right"\nend = "+x"\nto = "top"\nface = "-z"\nfastener = "dowel"\n'
    assert check(write_bench(tmp_path, text), "--json", tmp_path / "check.json") == 0
    reported = [" ".join(line.split()) for line in capsys.readouterr().out.splitlines()]
    found = json.loads((tmp_path / "check.json").read_text())
    (mass,) = [line for line in reported if line.startswith("mass ")]
    whole, of_pine, of_oak = (float(word) for word in re.findall(r"[\d.]+", mass))
    assert whole == pytest.approx(found["mass"], rel=1e-5) and of_pine + of_oak == pytest.approx(whole, rel=1e-5)
    assert re.fullmatch(r"mass \S+ kg, \S+ kg of pine and \S+ kg of oak", mass)
    (joints,) = [line for line in reported if line.startswith("joints ")]
    each = [(int(number), kind) for number, kind in re.findall(r"(\d+) fasteners '(\w+)'", joints)]
    assert sorted(each) == sorted((one["fasteners"], one["fastener"]) for one in found["joints"])
    assert {kind for _, kind in each} == {"screw", "dowel"}


def test_check_refuses_quantities_of_joints_that_are_not_there(tmp_path, capsys):
    text = '[quantities]\nfree = { utilisation = "pull", at = "top +x" }\n'
    assert check(write_bench(tmp_path, BENCH + text)) == 2
    reported = capsys.readouterr().err
    assert "quantities.free.at (line" in reported and "no joint at 'top +x'" in reported


@pytest.mark.slow
def test_check_draws_a_piece_with_its_names_forces_and_status(tmp_path, capsys):
    path = tmp_path / "piece.svg"
    assert check(write_bench(tmp_path), "--picture", path) == 0
    assert f"wrote {path}" in capsys.readouterr().out
    drawn = path.read_text()
    # Words of an SVG picture are comments above their paths.
    for words in ("top", "left", "right", "holds", "z [m]"):
        assert f"<!-- {words} -->" in drawn
    heavy = BENCH.replace('mass = "20 kg"', 'mass = "90 kg"\nat = [-0.49, 0, 0.5]')
    assert check(write_bench(tmp_path, heavy), "--picture", path) == 0
    assert "<!-- falls" in path.read_text() and "<!-- 90 kg -->" in path.read_text()
    thin = BENCH.replace("[effects.gravity]", "[effects.bending]\n[effects.gravity]").replace('"20 kg"', '"60 kg"')
    assert check(write_bench(tmp_path, thin.replace("thickness = 0.02", "thickness = 0.004")), "--picture", path) == 0
    assert "of its bending strength" in path.read_text()
