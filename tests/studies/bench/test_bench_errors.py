"""`restshape bench effectivity` and `bench jumps`, for people and programs."""

import json

import pytest
from restshape_studies.bench.effectivity import BAD, EXACT, GOOD, SINGULAR, counts, study
from restshape_studies.bench.jumps import study as jumps
from small_scenes import across, drag, plate, write_scene, write_script

from restshape.cli.main import main


@pytest.mark.slow
def test_effectivity_is_estimate_over_error(tmp_path):
    found = study(write_scene(tmp_path, plate(0.12)), (), (1.0,), lambda words: None)
    points = found["points"]
    assert {point["order"] for point in points} == {1, 2} and not found["omitted"]
    for point in points:
        if point["assessment"] in (GOOD, BAD):
            assert point["effectivity"] == point["estimate"] / point["true"]
            assert (point["assessment"] == GOOD) == (0.5 <= point["effectivity"] <= 2.0)
    assessments = {(point["quantity"], point["order"]): point["assessment"] for point in points}
    assert assessments["peak", 1] == SINGULAR and assessments["wall", 2] == EXACT and assessments["stretch", 1] == GOOD
    assert sum(counts(points).values()) == len(points) == 8


@pytest.mark.cli
def test_both_commands_print_tables_and_write_json(tmp_path, command):
    scene = write_scene(tmp_path, plate(0.2), "small.toml")
    edits = write_script(tmp_path, drag("window", (0.5, 0.5), across((0.5, 0.5), (1.4, 0.5), 3)))
    done = command("bench", "jumps", scene, "--edits", edits, "--json", "j.json")
    assert done.returncode == 0, done.stderr
    found = json.loads((tmp_path / "j.json").read_text())["small"]
    assert found == jumps(scene, edits, ()) and found["frames"]["2"] + found["frames"]["3"] > 0
    assert "frames of level 2" in done.stdout and "singular" in done.stdout
    done = command("bench", "effectivity", scene, "--sizes", "1", "--json", "e.json")
    assert done.returncode == 0, done.stderr
    assert "between 0.5 and 2" in done.stdout
    assert len(json.loads((tmp_path / "e.json").read_text())["small"]["points"]) == 8


def test_bad_sizes_are_refused(tmp_path, capsys):
    scene = write_scene(tmp_path, plate(0.2))
    assert main(["bench", "effectivity", str(scene), "--sizes", "0"]) == 2
    assert "positive" in capsys.readouterr().err
