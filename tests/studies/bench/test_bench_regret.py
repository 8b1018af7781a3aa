"""The table of counted work: a row a scene."""

import json

import pytest
from petsc4py import PETSc
from restshape_studies.commands.bench_regret import sum_up
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


def test_several_scenes_have_a_total(capsys):
    """Of work and schedules alike; scenes without a linear solver are none of it."""
    known = [
        {
            "policies": {"auto": {"seconds": auto}, "refactor": {"seconds": least}},
            "best": "refactor",
            "over_policy": auto / least,
            "hindsight": {"run": auto, "best": best},
            "over_schedule": auto / best,
        }
        for auto, least, best in ((0.3, 0.2, 0.1), (0.5, 0.5, 0.4))
    ]
    sum_up({"one": known[0], "none": {"problem": "no solver"}, "two": known[1]})
    *_, last = capsys.readouterr().out.split("\n\n")
    assert ["all", "800", "700", "1.143", "800", "500", "1.600"] in [line.split() for line in last.splitlines()]
