"""Cloth that has converged and is not to be trusted says so: stretched edges, bodies inside, a way that softened it."""

import json
from types import SimpleNamespace

import numpy as np
import pytest
from cloths import HEAD
from rich.console import Console
from scipy.optimize import brentq

from restshape.cli import console, doubtful
from restshape.cli.doubtful import print_doubtful
from restshape.cli.main import main
from restshape.physics.cloth.trust import penetration_notes
from restshape.replay.recording.recording import Recording

STRIP = f"""
{HEAD}[shape]
outline = ["bottom", "right", "top", "left"]
[shape.vertices]
a = [0, 0]
b = [0.2, 0]
c = [0.2, 1.0]
d = [0, 1.0]
[shape.edges]
bottom = {{ line = ["a", "b"] }}
right = {{ line = ["b", "c"] }}
top = {{ line = ["c", "d"] }}
left = {{ line = ["d", "a"] }}
[material.rubber]
E = "0.1 MPa"
nu = 0
rho = "1000 kg/m^3"
thickness = "1 mm"
[supports.rail]
on = "top"
fix = ["x", "y", "z"]
[effects.cloth]
bending = "none"
[effects.gravity]
g = [0, -9.81, 0]
[effects.drape]
strategy = "newton"
[mesh]
size = 0.05
"""
"""A strip of rubber that hangs in its plane from its upper end."""
BALL = """[bodies.ball]
sphere = { center = [0.1, -0.2, 0], radius = "50 mm" }
[effects.contact]
stiffness = 1e6
"""


@pytest.fixture
def rows(tmp_path):
    """The rows of a replay of the strip."""

    def replayed(*overrides: str, more: str = "") -> dict[str, np.ndarray]:
        (tmp_path / "strip.toml").write_text(STRIP + more)
        path = tmp_path / "strip.vtkhdf"
        words = [word for one in overrides for word in ("--set", one)]
        assert main(["replay", str(tmp_path / "strip.toml"), "--out", str(path), *words]) == 0
        with Recording(path) as recording:
            return dict(recording.table)

    return replayed


def test_the_largest_strain_is_that_of_a_strip_under_its_own_weight(rows):
    found = rows()
    stress = 1000.0 * 9.81 / 1e5
    # St. Venant and Kirchhoff: the tension by the width and thickness of the flat strip is E times this.
    stretch = brentq(lambda s: 0.5 * s * (s**2 - 1.0) - stress, 1.0, 2.0)
    assert found["converged"][0] == 1
    # The uppermost edges are of the length at which 2.5 % of the weight hang beside their middle.
    assert found["max_strain"][0] == pytest.approx(stretch - 1.0, rel=0.05)


def test_a_stretched_edge_is_not_trusted_unless_the_scene_says_so(rows):
    (why,) = rows()["untrusted"]
    assert why.startswith("an edge is stretched by 8.") and why.endswith("trusted are 5 %")
    (x, y) = why[why.index("(") + 1 : why.index(")")].split(",")
    assert 0 <= float(x) <= 200 and 900 <= float(y) <= 1000
    assert list(rows("effects.cloth.trusted_strain=0.2")["untrusted"]) == [""]


def test_a_way_that_softens_the_membrane_is_not_trusted(rows):
    trusted = "effects.cloth.trusted_strain=0.2"
    from restshape.physics.cloth.relaxation import strategies

    def softened(solver, x, most, report):
        solver.problem.soften(0.5)
        solver.descend(x, 0.05, 100, report)
        solver.problem.soften(1.0)
        return strategies.descended(solver, x, most, report, "newton", stabilised=False)

    known = strategies.STRATEGIES["newton"]
    strategies.STRATEGIES["newton"] = softened
    try:
        assert list(rows(trusted)["untrusted"]) == ["the way to rest softened the membrane, to 50 % of its stiffness"]
    finally:
        strategies.STRATEGIES["newton"] = known
    assert list(rows(trusted)["untrusted"]) == [""]


def test_one_method_alone_leaves_to_its_rounds_how_far_cloth_slides(rows, monkeypatch):
    """Descents of other strategies bound that by what is pressed; it has changed since, and may be fewer places."""
    from restshape.physics.cloth.relaxation import cloth_slide

    def reached(*_):
        raise AssertionError("the bound of another descent was asked")

    monkeypatch.setattr(cloth_slide.ClothSlide, "reached", reached)
    found = rows("effects.cloth.trusted_strain=0.2", more=BALL)
    assert found["converged"][0] == 1 and found["relaxation_steps"][0] > 0


def test_all_reasons_and_notes_are_in_replay_and_report(tmp_path, capsys):
    (tmp_path / "strip.toml").write_text(STRIP)
    lines = [{"format": "restshape-edits", "version": 1, "scene": "strip.toml", "units": "m"}]
    values = [8e4, 6e4, 1e6]
    lines += [{"t": 0.1 * k, "do": "set", "key": "material.rubber.E", "value": E} for k, E in enumerate(values)]
    lines.append({"t": 0.5, "do": "set", "key": "effects.drape.steps", "value": 1})
    lines.append({"t": 0.6, "do": "set", "key": "material.rubber.E", "value": 1e5})
    (tmp_path / "strip.jsonl").write_text("\n".join(map(json.dumps, lines)))
    recording, data = tmp_path / "strip.vtkhdf", tmp_path / "strip.json"
    call = ["replay", str(tmp_path / "strip.toml"), "--edits", str(tmp_path / "strip.jsonl")]
    assert main([*call, "--out", str(recording), "--json", str(data)]) == 0
    said = capsys.readouterr().out
    assert "untrusted, line 0, frame 0 (4 frames up to 5, worst in 2): an edge is stretched by 13." in said
    summary = json.loads(data.read_text())
    rest, first = summary["rest"], summary["first_ms"]
    # All other times leave it out.
    assert "first frame: " in said and first > 1.0
    assert rest["untrusted"] == 3 and f"{rest['converged']} of 6 frames" in said and ", 3 not to be trusted;" in said
    assert main(["report", str(recording), "--animation", "none", "--json", str(data)]) == 0
    said, reported = capsys.readouterr().out, json.loads(data.read_text())
    notes = reported["notes"]
    assert "first frame: " in said and reported["first_ms"] == pytest.approx(first, rel=0.5)
    assert "frames that are not to be trusted" in said and ", 3 not to be trusted;" in said
    with Recording(recording) as found:
        for name in ("untrusted", "note"):
            texts = [str(text) for text in found.table[name]]
            listed = {one["text"] for one in notes[name]}
            assert listed and all(text in said for text in listed) and listed <= set(texts)
    assert any("not converged" in one["text"] for one in notes["note"])


def test_of_bodies_with_cloth_inside_one_is_named_and_others_counted():
    problem = SimpleNamespace(contact=SimpleNamespace(thickness=2e-3))
    scene = SimpleNamespace(bodies={"one": 0, "two": 0, "three": 0})
    for depths, words in (
        ((0.0, 2e-3, 0.0), "2 mm inside bodies.two"),
        ((3e-3, 2e-3, 0.0), "3 mm inside bodies.one, and less in 1 other body"),
        ((3e-3, 2e-3, 4e-3), "4 mm inside bodies.three, and less in 2 other bodies"),
    ):
        assert penetration_notes("lies", problem, scene, depths) == [f"cloth lies {words}"]


def test_what_is_not_to_be_trusted_is_orange_on_a_terminal_alone(monkeypatch, capsys):
    print_doubtful("doubtful")
    assert capsys.readouterr().out == "doubtful\n"

    def terminal() -> Console:
        return Console(force_terminal=True, color_system="truecolor", highlight=False)

    monkeypatch.setattr(doubtful, "on_terminal", lambda: True)
    monkeypatch.setattr(console, "console", terminal)
    print_doubtful("doubtful")
    print_doubtful("sound", doubtful=False)
    said = capsys.readouterr().out
    assert "\x1b[38;2;230;159;0mdoubtful\x1b[0m" in said and "\nsound\n" in said


def test_cloth_deeper_than_half_of_the_thickness_is_inside(rows):
    # It hangs beside the ball, whose surface its plane cuts: at the start it is inside, and 1 step leaves it there.
    found = rows(
        "effects.drape.steps=1", "effects.cloth.trusted_strain=9", "bodies.ball.sphere.center=[0.1,0.3,0.04]", more=BALL
    )
    depth = found["max_penetration"][0]
    assert depth > 1e-3 and list(found["untrusted"]) == [f"cloth lies {1e3 * depth:.3g} mm inside bodies.ball"]
