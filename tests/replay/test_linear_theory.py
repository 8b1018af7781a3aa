"""Displacements that linear theory gives, and is not made for: a bar under tension lengthens by sigma L / E."""

import json

import pytest
from small_scenes import block, head, write_scene, write_script

BAR = block(0.2, 0.1) + (
    '[material.m]\nE = {E}\nnu = 0.0\nthickness = 0.01\n[supports.left]\non = "left"\nfix = {{ x = 0, y = 0 }}\n'
    '[loads.pull]\non = "right"\ntraction = [1e6, 0]\n[mesh]\nsize = 0.05\n'
)


@pytest.mark.parametrize(
    ("E", "effect", "says"), [(2e7, "", False), (2e6, "", True), (2e6, "large_deformation", False)]
)
def test_a_bar_that_lengthens_by_half(tmp_path, command, E, effect, says):
    text = BAR.replace("{E}", f"{E:g}").replace("{{", "{").replace("}}", "}")
    scene = write_scene(tmp_path, head("solid") + text + (f"[effects.{effect}]\n" if effect else ""))
    run = command("replay", scene, "--json", "out.json", "--out", "out.vtkhdf")
    assert run.returncode == 0, run.stderr
    assert run.stdout.count("beyond linear theory") == says
    found = json.loads((tmp_path / "out.json").read_text()).get("beyond_linear_theory")
    if says:
        assert found["displacement_over_size"] == pytest.approx(1e6 / E, rel=1e-6) and found["frame"] == 0
        assert "beyond linear theory" in command("report", "out.vtkhdf", "--frames", "1").stdout
    else:
        assert found is None


def test_it_is_said_once_where_a_script_softens_the_body(tmp_path, command):
    text = BAR.replace("{E}", "2e9").replace("{{", "{").replace("}}", "}")
    scene = write_scene(tmp_path, head("solid") + text)
    soft = [{"t": 0.1 * k, "do": "set", "key": "material.m.E", "value": E} for k, E in enumerate((2e6, 1e6))]
    run = command("replay", scene, write_script(tmp_path, soft), "--json", "out.json")
    assert run.returncode == 0, run.stderr
    assert run.stdout.count("beyond linear theory") == 1 and "line 2, frame 1: beyond" in run.stdout
    found = json.loads((tmp_path / "out.json").read_text())["beyond_linear_theory"]
    assert found == {"displacement_over_size": pytest.approx(1.0, rel=1e-6), "frame": 2}
