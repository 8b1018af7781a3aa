"""The table of counted work: a row a scene."""

import json

import pytest
from petsc4py import PETSc
from small_scenes import across, drag, plate, write_scene, write_script

pytestmark = pytest.mark.skipif(PETSc.COMM_WORLD.size > 1, reason="one rank")


@pytest.mark.slow
def test_the_table_holds_a_scene_beside_the_best(tmp_path, command):
    scene = write_scene(tmp_path, plate(0.3))
    script = write_script(tmp_path, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.6, 0.5), 6)))
    done = command("bench", "regret", scene, "--edits", script, "--json", "a.json")
    assert done.returncode == 0, done.stderr
    one = json.loads((tmp_path / "a.json").read_text())[scene.stem]
    work = {name: entry["seconds"] for name, entry in one["policies"].items()}
    assert work["auto"] == pytest.approx(one["over_policy"] * work[one["best"]])
    row = done.stdout.splitlines()[-2].split()
    assert row[0] == scene.stem and row[-1] == f"{one['over_schedule']:.3f}" and f"{one['over_policy']:.3f}" in row
