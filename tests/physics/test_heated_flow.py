"""Heat and buoyancy in fluids: exact temperatures on moving meshes, balances, derivatives, reuse beside cold solves."""

import numpy as np
import pytest
from counted_replays import begin_log, kernels, watched
from restshape_studies.stability.scenery import across, block, drag, make_replay, set_value, write_scene, write_script
from restshape_verification.flow.heated_scenes import (
    BUOYANT,
    CAVITY,
    HEAD,
    SQUARE,
    STEADY,
    in_time,
    warm_everywhere,
)
from thermal_scenes import solved

from restshape.analysis.frame import Frame
from restshape.application import application_of
from restshape.fem.residuals import design_rates, unconstrained_residual
from restshape.physics.heated_flow.heated_flow import HeatedFlow
from restshape.physics.heated_flow.wall_layers import _short, buoyant_layer, is_stirred
from restshape.policy import POLICIES
from restshape.replay.parity import Parity
from restshape.scene.load import load_scene
from restshape.shape.build import outline_from_spec

DRAG = drag("window", (0.4, 0.5), across((0.4, 0.5), (0.6, 0.55), 8))
FAR = drag("window", (0.4, 0.5), across((0.4, 0.5), (0.7, 0.6), 3))
MOVED = drag("c", (1.0, 1.0), across((1.0, 1.0), (1.2, 1.1), 5))
COARSE = "[mesh]\nsize = 0.16\n"
WARM_CHANNEL = (
    HEAD
    + block(0.1, 0.01)
    + """
[parameters]
u = 0.02
[fluid]
name = "water"
reference = 293.15
[boundary]
inlet = { on = "left", velocity = ["u*6*y*(0.01 - y)/1e-4", 0], temperature = 293.15 }
outlet = { on = "right", outflow = true }
walls = { on = ["top", "bottom"], wall = true, temperature = 303.15 }
[effects]
flow = {}
convection = {}
heat = {}
[mesh]
size = 0.002
[quantities]
wall = { heat_flow = true, at = "top" }
"""
)


@pytest.mark.parametrize("script", [DRAG, FAR])
@pytest.mark.parametrize(
    "effects",
    [
        STEADY,
        in_time(),
        in_time(scheme="backward_euler"),
        in_time(steps=3),
        in_time().replace("convection = {}", ""),
        in_time().replace("steps = 1", 'carry = "remap"'),
        in_time(heat='coupling = "split"'),
    ],
)
def test_a_steady_linear_temperature_stays_one_while_a_body_is_dragged(tmp_path, effects, script):
    """u = (y, 0) and T = 300 + 2 y, along which nothing is carried, are no others for any motion of the mesh."""
    text = warm_everywhere('["y", 0]', '"300 + 2*y"', effects)
    made, worst, levels = make_replay(write_scene(tmp_path, text), write_script(tmp_path, script)), 0.0, set()
    for row in made.frames():
        analysis = made.analysis
        X = analysis.space.X
        exact = np.column_stack([X[:, 1], 0 * X[:, 0], 0 * X[:, 0], 300 + 2 * X[:, 1]])
        if row["index"] == 0 and "time_step" in text:
            analysis.begin(exact)
        worst = max(worst, float(np.abs(analysis.x - exact)[:, [0, 1, 3]].max()))
        levels.add(row["level"])
    assert worst < 1e-7 and 3 in levels


@pytest.mark.parametrize("policy", POLICIES)
@pytest.mark.parametrize("effects", [STEADY, in_time(0.02)])
def test_reuse_gives_what_cold_solves_give(tmp_path, effects, policy):
    made = make_replay(
        write_scene(tmp_path, CAVITY + effects + BUOYANT + COARSE), write_script(tmp_path, MOVED), policy
    )
    check = Parity(made)
    for _ in made.frames():
        check()
    assert check.summary()["holds"], check.summary()


def test_rounding_of_a_fluid_that_nothing_moves_is_no_difference(tmp_path):
    made = make_replay(write_scene(tmp_path, CAVITY + STEADY + COARSE), write_script(tmp_path, []))
    check = Parity(made)
    for _ in made.frames():
        check()
    assert np.abs(made.analysis.x[:, :2]).max() < 1e-20 and check.summary()["holds"], check.summary()


def test_a_velocity_that_is_off_is_seen_beside_temperatures_in_kelvins(tmp_path):
    made = make_replay(write_scene(tmp_path, CAVITY + STEADY + BUOYANT + COARSE), write_script(tmp_path, []))
    check = Parity(made)
    for _ in made.frames():
        check()
        analysis = made.analysis
        assert analysis.compare_cold().solution < 1e-6
        analysis.x[5, :2] += 1e-4 * np.abs(analysis.x[:, :2]).max()
        assert analysis.compare_cold().solution > 1e-5


@pytest.mark.parametrize("effects", [STEADY, in_time(0.02, steps=2)])
def test_by_turns_comes_what_comes_together(tmp_path, effects):
    """Flow and heat by turns have the solutions, and the scales of residuals, of both in one system; steady, where
    turns of full length would swing, and in time, on a mesh that moves."""
    found, script = [], write_script(tmp_path, MOVED)
    for coupling in ("monolithic", "split"):
        scene = write_scene(tmp_path, CAVITY + effects + BUOYANT + COARSE)
        made = make_replay(scene, script, overrides=[f'effects.heat.coupling="{coupling}"'])
        found.append([(row["q_hot"], row["q_mean"]) for row in made.frames()])
    np.testing.assert_allclose(found[0], found[1], rtol=2e-6)


def test_turns_that_do_not_agree_end_together(tmp_path):
    text = CAVITY + STEADY.replace("heat = {}", 'heat = { coupling = "split" }') + BUOYANT + COARSE
    row = solved(tmp_path, text, "parameters.Ra=1e5").row
    assert row["q_hot"] == pytest.approx(4.52, rel=0.08)


def test_warm_fluid_rises(tmp_path):
    """Beside the hot wall upwards, beside the cold one downwards; with gravity the other way, the other way."""
    for gravity, sign in (("-1 m/s^2", 1), ("1 m/s^2", -1)):
        analysis = solved(tmp_path, CAVITY + STEADY + BUOYANT.replace("-1 m/s^2", gravity) + COARSE).analysis
        X, v = analysis.space.X, analysis.x[:, 1]
        middle = np.abs(X[:, 1] - 0.5) < 0.2
        assert sign * v[middle & (X[:, 0] < 0.3)].mean() > 1.0
        assert sign * v[middle & (X[:, 0] > 0.7)].mean() < -1.0


@pytest.mark.slow
@pytest.mark.parametrize(("Ra", "nusselt"), [(1e6, 8.82521), (3e6, 11.9)])
def test_a_steady_flow_is_found_from_rest(tmp_path, Ra, nusselt):
    """Also where the linear start is far off. Source: 8.82521: P. Le Quere, Computers and Fluids 20 (1991) 29."""
    row = solved(tmp_path, CAVITY + STEADY + BUOYANT + "[mesh]\nsize = 0.04\n", f"parameters.Ra={Ra!r}").row
    assert row["q_hot"] == pytest.approx(nusselt, rel=0.04)


@pytest.mark.slow
def test_steps_that_pass_hundreds_of_elements_lead_to_the_steady_flow(tmp_path):
    text = CAVITY + in_time(0.1) + BUOYANT + "[mesh]\nsize = 0.06\n"
    script = write_script(tmp_path, [{"do": "idle", "frames": 6}])
    rows = make_replay(write_scene(tmp_path, text), script, overrides=["parameters.Ra=1e6"]).frames()
    found = [(row["q_hot"], row["refused"]) for row in rows]
    assert not any(refused for _, refused in found)
    assert found[-1][0] == pytest.approx(8.82521, rel=0.08)


def test_a_step_that_is_far_from_newtons_method_is_found_by_more_of_picards(tmp_path):
    """With only as many of them as usual the second step is not found."""
    text = CAVITY + in_time(3e-4) + BUOYANT + "[mesh]\nsize = 0.05\n"
    script = write_script(tmp_path, [{"do": "idle", "frames": 2}])
    rows = make_replay(write_scene(tmp_path, text), script, overrides=["parameters.Ra=1e9"]).frames()
    assert not any(row["refused"] for row in rows)


def test_a_check_warns_where_heated_walls_have_turbulent_layers(tmp_path):
    scene = load_scene(write_scene(tmp_path, CAVITY + STEADY + BUOYANT + COARSE), ["parameters.Ra=1e10"])
    *_, seen = [one.inspected(scene, outline_from_spec(scene.shape)) for one in application_of(scene).physics]
    assert "at a Rayleigh number of 1e+10 layers at walls are turbulent" in seen.warnings[0]


def layers_warned_of(folder, text, *overrides):
    """The warnings of a scene that are of layers at walls."""
    scene = load_scene(write_scene(folder, text), overrides)
    *_, seen = [one.inspected(scene, outline_from_spec(scene.shape)) for one in application_of(scene).physics]
    return [warning for warning in seen.warnings if "layer at" in warning]


def test_a_check_warns_of_cells_that_do_not_show_the_layers_at_heated_walls(tmp_path):
    """At Ra = 1e7 tenths of a square of water have a Nusselt number of 28 in place of 17."""
    text, given = CAVITY + STEADY + BUOYANT + "[mesh]\nsize = 0.1\n", ("parameters.Ra=1e7", "parameters.Pr=7")
    assert solved(tmp_path, text, *given).row["q_hot"] > 1.3 * 17.4
    (warning,) = layers_warned_of(tmp_path, text, *given)
    assert "is about 61 mm thick, and cells there are 100 mm" in warning and "heat may be off" in warning
    assert layers_warned_of(tmp_path, text, *given, "mesh.size=0.04") == []
    assert layers_warned_of(tmp_path, text, *given, 'mesh.near={left="4 cm",right="4 cm"}') == []


@pytest.mark.parametrize(
    ("hot", "cold", "rayleigh", "stirred"),
    [
        ("left", "right", 50.0, True),
        ("bottom", "top", 1e4, True),
        ("bottom", "top", 1.5e3, False),
        ("top", "bottom", 1e7, False),
    ],
)
def test_fluid_that_is_warm_above_or_hardly_below_has_no_layers(tmp_path, hot, cold, rayleigh, stirred):
    outline = outline_from_spec(load_scene(write_scene(tmp_path, CAVITY + STEADY + BUOYANT + COARSE)).shape)
    edges = {edge.name: k for k, edge in enumerate(outline.edges)}
    given = {edges[hot]: np.full((3, 1), 310.0), edges[cold]: np.full((3, 1), 300.0)}
    assert is_stirred(outline, given, np.array([0.0, -1.0]), rayleigh) == stirred
    assert is_stirred(outline, {edges[hot]: given[edges[hot]]}, np.array([0.0, -1.0]), rayleigh)


def test_no_layer_is_found_where_heat_is_conducted_alone_and_sizes_have_no_powers_of_ten():
    assert np.isinf(buoyant_layer(1.0, 0.0)) and np.isinf(buoyant_layer(1.0, 100.0))
    assert buoyant_layer(1.0, 1e4) == pytest.approx(1 / 2.9)
    assert [_short(612.3, 2), _short(20.4, 1), _short(0.0351, 1)] == ["610", "20", "0.04"]


def test_a_check_warns_of_cells_that_do_not_show_the_layers_below_a_stream(tmp_path):
    """Water of 20 mm/s between walls that are warm over 10 cm: with cells of 2 mm it takes up a fifth too much."""
    text = WARM_CHANNEL
    (warning,) = layers_warned_of(tmp_path, text)
    assert "about 1.3 mm thick, and cells there are 2 mm" in warning
    found = [solved(tmp_path, text, f"mesh.size={size}").row["q_wall"] for size in (2e-3, 5e-4)]
    assert found[0] / found[1] > 1.15
    assert layers_warned_of(tmp_path, text, "mesh.size=1e-3") == []
    # Ten times as slow, it is warm farther in; and where all is as warm, there are no layers.
    assert layers_warned_of(tmp_path, text, "parameters.u=2e-3") == []
    assert layers_warned_of(tmp_path, text.replace("303.15", "293.15")) == []


def test_a_check_warns_of_what_moves_no_fluid(tmp_path):
    """Velocities where flow is off, and gravity without buoyancy."""
    for lost, words in (
        ("flow = {}\n", "boundary.inlet: flow is off, and the fluid at rest"),
        ("", "it moves no fluid"),
    ):
        text = WARM_CHANNEL.replace("heat = {}\n", "heat = {}\ngravity = {}\n") if not lost else WARM_CHANNEL
        text = text.replace("convection = {}\n", "").replace(lost, "") if lost else text
        scene = load_scene(write_scene(tmp_path, text))
        seen = [one.inspected(scene, outline_from_spec(scene.shape)) for one in application_of(scene).physics]
        assert any(words in warning for one in seen for warning in one.warnings), words


def test_a_check_says_rayleighs_number(tmp_path):
    scene = load_scene(write_scene(tmp_path, CAVITY + STEADY + BUOYANT + COARSE))
    seen = [one.inspected(scene, outline_from_spec(scene.shape)) for one in application_of(scene).physics]
    assert not any(one.warnings for one in seen)
    assert seen[-1].data == {"rayleigh": pytest.approx(1e4), "prandtl": pytest.approx(0.71)}


def test_what_enters_leaves(tmp_path):
    row = solved(tmp_path, CAVITY + STEADY + BUOYANT + "[mesh]\nsize = 0.06\n").row
    assert row["q_hot"] == pytest.approx(row["q_cold"], rel=1e-3) and row["q_hot"] == pytest.approx(2.2448, rel=0.02)
    assert row["q_mean"] == pytest.approx(300.0, abs=0.01)


def test_a_fluid_at_rest_conducts(tmp_path):
    """Across a square of 1 m the Nusselt number is 1, with flow off and with flow that nothing drives."""
    for effects in ("[effects]\nheat = {}\n", STEADY):
        row = solved(tmp_path, CAVITY + effects + COARSE).row
        assert row["q_hot"] == pytest.approx(1.0, abs=1e-9) and row["q_cold"] == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize(("theta", "part"), [(0.5, 2e-3), (1.0, 0.02)])
def test_a_fluid_at_rest_warms_up_as_its_series_says(tmp_path, theta, part):
    """Beside one wall that is made warmer the mean is that of the Fourier series, and heat in is what is stored."""
    text = CAVITY.replace("299.5 K", "300 K").replace("300.5 K", "301 K")
    text = text.replace("diffusivity = 1", "conductivity = 2\nheat_capacity = 4")
    text += 'right = { heat_flow = true, at = "right" }\nleft = { heat_flow = true, at = "left" }\n'
    text += "[effects]\nheat = {}\n[mesh]\nsize = 0.06\n"
    text += f"[effects.storage]\ntime_step = 0.01\ninitial = 300\ntheta = {theta}\n"
    made = make_replay(write_scene(tmp_path, text), write_script(tmp_path, [{"do": "idle", "frames": 40}]))
    check, rows = Parity(made), []
    for row in made.frames():
        rows.append(dict(row))
        check()
    assert check.summary()["holds"]
    k, t = np.arange(1, 400, 2), 0.4
    mean = 0.5 - 4 / np.pi**2 * np.sum(np.exp(-0.5 * (k * np.pi) ** 2 * t) / k**2)
    assert rows[-1]["q_mean"] - 300 == pytest.approx(mean, rel=part)
    if theta == 1.0:
        stored = 4 * (rows[-1]["q_mean"] - rows[-2]["q_mean"]) / 0.01
        assert rows[-1]["q_left"] + rows[-1]["q_right"] == pytest.approx(-stored, rel=1e-6)


def test_both_couplings_have_the_same_pressures(tmp_path):
    text = CAVITY + STEADY + BUOYANT + COARSE + "[solve]\ntolerance = 1e-9\n"
    pressures = []
    for coupling in ("monolithic", "split"):
        one = text.replace("heat = {}", f'heat = {{ coupling = "{coupling}" }}')
        analysis = solved(tmp_path, one, "parameters.Ra=1e3").analysis
        pressures.append(analysis.problem.pressure(analysis.x))
    np.testing.assert_allclose(*pressures, atol=1e-5 * np.ptp(pressures[0]))


def test_a_nusselt_number_is_that_of_a_mean_flux(tmp_path):
    """Of walls that are twice as long as they are apart."""
    row = solved(tmp_path, CAVITY.replace(SQUARE, block(1.0, 2.0)) + "[effects]\nheat = {}\n" + COARSE).row
    assert row["q_hot"] == pytest.approx(1.0, abs=1e-9) and row["q_cold"] == pytest.approx(1.0, abs=1e-9)


def test_without_a_difference_no_heat_is_followed_until_an_edit_brings_one(tmp_path):
    begin_log()
    text = (CAVITY + in_time(0.02) + BUOYANT + COARSE).replace("299.5 K", "300 K")
    even = write_scene(tmp_path, text.replace("300.5 K", "300 K"))
    called = kernels(watched(even, write_script(tmp_path, [{"do": "idle", "frames": 2}]))[0])
    assert {name for name in called if "flow" in name or "heat" in name} == {"unsteady_flow_tri3"}
    events = [{"do": "idle", "frames": 2}, *set_value("boundary.hot.temperature", "301 K"), {"do": "idle", "frames": 3}]
    rows = [dict(row) for row in make_replay(even, write_script(tmp_path, events)).frames()]
    assert [row["q_hot"] for row in rows[:3]] == [0.0] * 3 and rows[0]["q_mean"] == 300.0
    assert all(row["q_hot"] > 1.0 for row in rows[3:])
    assert rows[-1]["q_mean"] > 300.01


@pytest.mark.parametrize("cold", [True, False])
def test_a_fluid_is_as_warm_as_it_was_when_an_edit_makes_a_wall_warmer(tmp_path, cold):
    """Without a reference or a temperature at time 0 it had that of its walls; also where all change at once."""
    text = (CAVITY + in_time(0.002) + COARSE).replace('reference = "300 K"\n', "").replace('expansion = "Ra*Pr"\n', "")
    text = text.replace("299.5 K", "300 K").replace("300.5 K", "300 K")
    text = text.replace("[boundary.hot]", '[boundary.lid]\non = "top"\nvelocity = [1, 0]\n[boundary.hot]')
    if not cold:
        text = text.replace('[boundary.cold]\non = "right"\nwall = true\ntemperature = "300 K"\n', "")
        text = text.replace('on = "left"', 'on = ["left", "right"]', 1)
    events = [{"do": "idle", "frames": 2}, *set_value("boundary.hot.temperature", "310 K"), {"do": "idle", "frames": 2}]
    mean = [row["q_mean"] for row in make_replay(write_scene(tmp_path, text), write_script(tmp_path, events)).frames()]
    assert mean[:3] == [300.0] * 3 and all(300.0 < value < 303.0 for value in mean[3:])
    assert (np.diff(mean[2:]) > 0).all()


def test_without_a_difference_nothing_is_conducted_until_an_edit_brings_one(tmp_path):
    begin_log()
    text = CAVITY.replace("299.5 K", "300.5 K") + "[effects]\nheat = {}\n" + COARSE
    even, idle = write_scene(tmp_path, text), [{"do": "idle", "frames": 2}]
    assert not kernels(watched(even, write_script(tmp_path, idle))[0])
    events = [*idle, *set_value("boundary.cold.temperature", "299.5 K", "300.5 K"), *idle]
    made = make_replay(even, write_script(tmp_path, events))
    check, rows = Parity(made), []
    for row in made.frames():
        rows.append(dict(row))
        check()
    assert check.summary()["holds"]
    np.testing.assert_allclose([row["q_hot"] for row in rows], [0, 0, 0, 1, 0, 0, 0], atol=1e-9)
    np.testing.assert_allclose([row["q_mean"] for row in rows], [300.5] * 3 + [300.0] + [300.5] * 3, atol=1e-6)


def test_a_warm_fluid_cools_though_no_temperature_of_its_scene_differs_any_more(tmp_path):
    text = CAVITY + in_time(0.02) + BUOYANT + COARSE
    events = [{"do": "idle", "frames": 5}]
    events += [*set_value("boundary.hot.temperature", "300 K"), *set_value("boundary.cold.temperature", "300 K")]
    rows = make_replay(
        write_scene(tmp_path, text.replace("299.5 K", "300 K")),
        write_script(tmp_path, [*events, {"do": "idle", "frames": 5}]),
    ).frames()
    mean = np.array([row["q_mean"] for row in rows]) - 300.0
    assert (np.diff(mean[:6]) > 0).all() and (np.diff(mean[6:]) < 0).all() and mean[-1] > 1e-3


def _left(problem, x, rho, span):
    """What momentum, continuity and heat of the cavity leave at x (n, 4), over their usual terms in a node."""
    rest = unconstrained_residual(problem, x)
    problem.boundary.zero(rest)
    size, speed, warmer = problem.size, np.hypot(x[:, 0], x[:, 1]), np.abs(x[:, 3] - 300.0) / span
    momentum = rho * (speed**2 + 0.71 / size * speed + 7100.0 * warmer * size)
    heat = problem.capacity * span * (speed + 1.0 / size)
    terms = (momentum, speed, heat)
    parts = (rest[:, :2], rest[:, 2] / problem.continuity, rest[:, 3] / problem.heat_factor)
    return [np.linalg.norm(part) / (size * np.sqrt(np.mean(term**2))) for part, term in zip(parts, terms, strict=True)]


@pytest.mark.parametrize("factor", [1e-4, 1.0, 1e4])
@pytest.mark.parametrize("effects", [STEADY, in_time(0.02)])
def test_each_equation_is_solved_on_its_own_scale(tmp_path, monkeypatch, effects, factor):
    """Momentum, continuity and heat each leave less than the tolerance of what their terms are, in units of any kind.

    The same cavity with lengths in mm, a heavy fluid and other kelvins has the same numbers. They are no others where
    the equation of heat has a factor that makes it far larger than that of momentum, or far smaller, and a small edit
    of the one equation is not lost beside the other.
    """
    usual = HeatedFlow._heat_factor
    monkeypatch.setattr(HeatedFlow, "_heat_factor", lambda self, span: factor * usual(self, span))
    text, nusselt = CAVITY + effects + BUOYANT + COARSE, []
    scaled = text.replace("rho = 1\n", "rho = 1e6\n").replace('mu = "Pr"', 'mu = "1e6*Pr"')
    scaled = scaled.replace("300.5 K", "300.0005 K").replace("299.5 K", "299.9995 K")
    scaled = scaled.replace('"Ra*Pr"', '"1e3*Ra*Pr"').replace("1 K", "0.001 K")
    for one, rho, span in ((text, 1.0, 1.0), (scaled, 1e6, 1e-3)):
        edits = [*set_value("fluid.diffusivity", 1.0002), *set_value("parameters.Ra", 1.0002e4)]
        made = make_replay(write_scene(tmp_path, one), write_script(tmp_path, [{"do": "idle", "frames": 3}, *edits]))
        for row in made.frames():
            nusselt.append(row["q_hot"])
            begun = row["index"] == 0 and "time_step" in text
            assert begun or max(_left(made.analysis.problem, made.analysis.x, rho, span)) <= 1e-6
    half = len(nusselt) // 2
    np.testing.assert_allclose(nusselt[:half], nusselt[half:], rtol=1e-4)


def test_heat_of_all_edges_and_sources_balances(tmp_path):
    """A stream that enters cold is warmed by a wall with a flux and by a source: what enters leaves."""
    text = (
        f"{HEAD}{SQUARE}[fluid]\nrho = 1\nmu = 0.1\nconductivity = 0.3\nheat_capacity = 2\ndepth = 0.5\n"
        '[boundary.inlet]\non = "left"\nvelocity = ["4*y*(1 - y)", 0]\ntemperature = "290 K"\n'
        '[boundary.wall]\non = "bottom"\nwall = true\nheat_flux = "3 + x"\n'
        '[boundary.out]\non = "right"\noutflow = true\n'
        f'[heat.inside]\non = "all"\nsource = 2\n{STEADY}[mesh]\nsize = 0.05\n[solve]\ntolerance = 1e-10\n'
        "[quantities]\n"
        + "".join(f'{name} = {{ heat_flow = true, at = "{name}" }}\n' for name in ("left", "bottom", "right", "top"))
    )
    row = solved(tmp_path, text).row
    assert row["q_bottom"] == pytest.approx(-0.5 * 3.5, rel=1e-12) and row["q_top"] == pytest.approx(0.0, abs=1e-12)
    assert row["q_left"] + row["q_bottom"] + row["q_right"] == pytest.approx(0.5 * 2.0, rel=0.02)


@pytest.mark.parametrize("wall", ["320 K", "320.000001 K"])
@pytest.mark.parametrize(("reference", "counted"), [('reference = "300 K"\n', 20.0), ("", 5.0)])
def test_heat_that_a_stream_carries_counts_from_the_reference(tmp_path, wall, reference, counted):
    """Else from the temperature at time 0; with and without a difference of temperatures, and without buoyancy."""
    text = (
        f"{HEAD}{SQUARE}[fluid]\nrho = 1\nmu = 0.1\nconductivity = 0.3\nheat_capacity = 2\ndepth = 0.5\n{reference}"
        '[boundary.inlet]\non = "left"\nvelocity = ["4*y*(1 - y)", 0]\ntemperature = "320 K"\n'
        f'[boundary.wall]\non = "bottom"\nwall = true\ntemperature = "{wall}"\n'
        '[boundary.out]\non = "right"\noutflow = true\n'
        f"{STEADY.replace('heat = {}', 'heat = { initial = 315 }')}[mesh]\nsize = 0.1\n"
        '[quantities]\nout = { heat_flow = true, at = "right" }\nleft = { heat_flow = true, at = "left" }\n'
        'flux = { flux = true, at = "right" }\n'
    )
    row = solved(tmp_path, text).row
    assert row["q_flux"] == pytest.approx(0.5 * 2 / 3, rel=0.02)
    assert row["q_out"] == pytest.approx(2 * counted * row["q_flux"], rel=1e-5)
    assert row["q_left"] == pytest.approx(-row["q_out"], rel=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize(("scheme", "order"), [("bdf2", 2.0), ("backward_euler", 1.0)])
def test_a_closed_vessel_keeps_its_heat_on_a_moving_mesh(tmp_path, scheme, order):
    """Insulated, at rest, warm on one side: its heat changes by what the scheme leaves, which falls with its order."""
    found = []
    for steps in (8, 16, 32):
        text = f"{HEAD}{SQUARE}[fluid]\nrho = 1\nmu = 1\nconductivity = 0.05\nheat_capacity = 1\n"
        text += 'expansion = 1\nreference = 301\n[boundary.walls]\non = "outline"\nwall = true\n'
        text += in_time(1.0 / steps, scheme, heat="initial = 300") + "buoyancy = {}\ngravity = { g = [0, 0] }\n"
        analysis = solved(tmp_path, text + "[mesh]\nsize = 0.08\n[solve]\ntolerance = 1e-10\n").analysis
        space, scene = analysis.space, analysis.state.scene
        X = space.X.copy()
        x = np.zeros((len(X), 4))
        x[:, 3] = 300 + np.cos(np.pi * X[:, 0])
        analysis.begin(x)
        before = heat(space, analysis.x[:, 3])
        for k in range(steps):
            bump = np.sin(np.pi * X[:, 0]) * np.sin(np.pi * X[:, 1]) * np.sin(np.pi * (k + 1) / steps) ** 2
            space.X[:] = X + 0.1 * bump[:, None]
            space.geometry += 1
            analysis.solve(Frame(space, np.empty(0, np.int32), None, scene, (None, (0.0, 0.0))))
        found.append(abs(heat(space, analysis.x[:, 3]) - before))
    assert np.log2(found[0] / found[2]) / 2 > order - 0.3


def heat(space, T):
    """The integral of a temperature less 300 K."""
    corners = space.X[space.cells]
    sides = corners[:, 1:] - corners[:, :1]
    return float((0.5 * np.linalg.det(sides) * (T[space.cells].mean(axis=1) - 300)).sum())


HOT = 'temperature = "300.5 K"'
"""Of the cavity's hot wall."""


@pytest.mark.slow
@pytest.mark.parametrize("wall", [HOT, 'temperature = "300.5 + 0.2*y*y"', 'heat_flux = "1 + x + y*y"'])
@pytest.mark.parametrize("effects", [STEADY, "[effects]\nheat = {}\n"])
def test_the_solution_follows_its_derivative_by_the_design(tmp_path, wall, effects):
    """The remainder of first order, when nodes move, is of second order."""
    text = CAVITY.replace(HOT, wall).replace("diffusivity = 1", "conductivity = 1\nheat_capacity = 1")
    text = text.replace('difference = "1 K" }, at = "left"', 'against = "right" }, at = "left"')
    text += effects + (BUOYANT if "flow" in effects else "") + "[solve]\ntolerance = 1e-12\n" + COARSE
    text += '[heat.inside]\non = "all"\nsource = "1 + 9*x*x + y"\n'
    analysis = solved(tmp_path, text).analysis
    problem, space, x = analysis.problem, analysis.space, analysis.x
    X = space.X.copy()
    dX = 0.02 * np.stack([np.sin(np.pi * X[:, 1]) * (X[:, 0] - 0.5), X[:, 1] * (1 + X[:, 0])], axis=1)
    rates, prescribed = design_rates(problem, x, dX)
    problem.boundary.zero(rates)
    dx = prescribed - analysis.linear_solve(rates, 1e-12)
    frame = Frame(space, np.empty(0, np.int32), None, analysis.state.scene, (None, (0.0, 0.0)))
    remainders = []
    for h in (1.0, 0.5):
        space.X[:] = X + h * dX
        space.geometry += 1
        analysis.solve(frame)
        remainders.append(np.linalg.norm(analysis.x - x - h * dx))
    assert np.log2(remainders[0] / remainders[1]) > 1.9
