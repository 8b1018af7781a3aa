"""Displacements that linear theory gives, and is not made for: a bar under tension lengthens by sigma L / E."""

import json
from types import SimpleNamespace

import numpy as np
import pytest
from small_scenes import block, head, make_replay, plate, rows_of, write_scene, write_script

from restshape.physics.elasticity.nodal_stress import NodalStress
from restshape.replay.linear_theory import LARGEST, LinearTheory

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
    assert run.stdout.count("beyond linear theory") == 1 and "line 2, frame 1 (2 frames up to 2): beyond" in run.stdout
    found = json.loads((tmp_path / "out.json").read_text())["beyond_linear_theory"]
    assert found == {"displacement_over_size": pytest.approx(1.0, rel=1e-6), "frame": 2}


def test_bounds_decide_as_the_extents_of_all_nodes_do():
    """Of bodies that turn, shrink and get other nodes, with displacements around the largest share."""
    random, analysis = np.random.default_rng(3), SimpleNamespace()
    theory, says = LinearTheory(analysis), []
    analysis.linear_displacement = lambda: u
    for k in range(300):
        X = random.standard_normal((random.integers(2, 40), 2)) * random.uniform(0.01, 1.0, 2)
        u = random.standard_normal(X.shape) * LARGEST * random.uniform(0.01, 0.6) * np.ptp(X, axis=0).max()
        analysis.space = SimpleNamespace(X=X)
        row = {"index": k}
        theory.note(row)
        share = np.hypot(*np.ptp(u, axis=0)) / np.ptp(X, axis=0).max()
        assert ("note" in row) == (share > LARGEST)
        says.append(share)
    assert 50 < sum(share > LARGEST for share in says) < 250
    assert (theory.largest, theory.frame) == (max(says), int(np.argmax(says)))


def test_small_displacements_take_no_extents(monkeypatch):
    X = np.random.default_rng(1).random((50, 2))
    analysis = SimpleNamespace(linear_displacement=lambda: 1e-3 * X, space=SimpleNamespace(X=X))
    theory, seen, ptp = LinearTheory(analysis), [], np.ptp
    monkeypatch.setattr(np, "ptp", lambda *given, **named: seen.append(1) or ptp(*given, **named))
    for index in range(5):
        theory.note({"index": index})
    assert len(seen) == 1


def test_stress_of_a_state_is_computed_once_for_all_quantities(tmp_path, monkeypatch):
    seen, recovered = [], NodalStress._recover_triangles
    monkeypatch.setattr(NodalStress, "_recover_triangles", lambda self: seen.append(1) or recovered(self))
    # The second asks for stresses that are left out where nobody looks at more than the first.
    text = (
        plate(0.3) + 'lowest = { stress = "von_mises", reduce = "min" }\nacross = { stress = "yy", reduce = "max" }\n'
    )
    (row,) = rows_of(make_replay(write_scene(tmp_path, text)))
    assert row["q_peak"] > row["q_lowest"] > 0.0 and np.isfinite(row["q_across"]) and len(seen) == 1
