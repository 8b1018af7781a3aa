"""Outflows that draw fluid in: what holds it there, when its element is called, and that energy does not grow."""

import numpy as np
import pytest
from counted_replays import begin_log, kernels, watched
from restshape_studies.stability.scenery import across, drag, make_replay, write_scene, write_script
from restshape_verification.flow.scenes import STEADY, channel, disc, in_time
from thermal_scenes import solved

from restshape.application import application
from restshape.fem.residuals import tangent_product
from restshape.replay.parity import Parity
from restshape.scene.load import load_scene
from restshape.scene.plan import plan

MESH = '[mesh]\nsize = 0.15\n[quantities]\nkinetic = { kinetic = true }\nout = { flux = true, at = "outlet" }\n'
SUCKED = "-4*y*(1 - y)"
FLUID = "rho = 1\nmu = 0.01\n"


def idle(frames):
    return [{"do": "idle", "frames": frames}]


def called(folder, text, events):
    begin_log()
    rows = watched(write_scene(folder, text), write_script(folder, events))[0]
    return {name for name in kernels(rows) if "backflow" in name}


def test_its_element_is_called_where_an_outflow_draws_in_only(tmp_path):
    leaving = channel(2, 1, FLUID, holes=disc("body", (0.7, 0.5), 0.15)) + MESH
    drawn_in = channel(2, 1, FLUID, SUCKED, disc("body", (0.7, 0.5), 0.15)) + MESH
    moving = drag("body", (0.7, 0.5), [(0.72, 0.5)])
    for effects in (STEADY, in_time(0.1)):
        assert called(tmp_path, leaving + effects, moving) == set()
    assert called(tmp_path, drawn_in + in_time(0.1, convection=False), moving) == set()
    assert called(tmp_path, drawn_in + STEADY, moving) == {"backflow_edge2"}
    assert called(tmp_path, drawn_in + in_time(0.1), idle(2)) == {"backflow_edge2"}
    assert called(tmp_path, drawn_in + in_time(0.1), [*idle(2), *moving]) == {"backflow_edge2"}
    outlet = drag("outlet", (2, 0.5), [(1.95, 0.5)])
    assert "backflow_on_moving_mesh_edge2" in called(tmp_path, drawn_in + in_time(0.1), [*idle(2), *outlet])
    # An outlet that goes downstream faster than the fluid draws in, relative to the mesh.
    ahead = drag("outlet", (2, 0.5), [(2.3, 0.5)])
    assert "backflow_on_moving_mesh_edge2" in called(tmp_path, leaving + in_time(0.1), [*idle(2), *ahead])


def test_it_follows_from_the_scene(tmp_path):
    for effects, on in ((STEADY, True), (in_time(convection=False), False)):
        scene = load_scene(write_scene(tmp_path, channel(2, 1, FLUID) + effects + MESH))
        assert plan(scene, application(scene.app)).on("backflow") is on


@pytest.mark.parametrize("mu", [1e-3, 1e-4])
def test_a_fluid_that_is_drawn_in_stays_bounded(tmp_path, mu):
    """Without what holds it, it has infinite energy within six seconds."""
    text = channel(3, 1, f"rho = 1\nmu = {mu!r}\n", SUCKED) + in_time(0.1) + MESH
    made = make_replay(write_scene(tmp_path, text), write_script(tmp_path, idle(80)))
    energies = [row["q_kinetic"] for row in made.frames()]
    assert np.isfinite(energies).all() and max(energies) < 1.0


def test_energy_never_grows_where_nothing_drives_the_fluid(tmp_path):
    """A vortex across the outflow of a channel that is closed elsewhere: in through one half, out through the other."""
    text = channel(2, 1, "rho = 1\nmu = 1e-4\n", "0*y") + in_time(0.02) + MESH
    made, energies = make_replay(write_scene(tmp_path, text), write_script(tmp_path, idle(60))), []
    for row in made.frames():
        analysis = made.analysis
        if row["index"] == 0:
            d = analysis.space.X - [1.9, 0.5]
            x = np.zeros((len(d), 3))
            x[:, :2] = np.exp(-10 * (d**2).sum(axis=1))[:, None] * np.column_stack([-d[:, 1], d[:, 0]]) * 10
            analysis.problem.boundary.apply(x)
            analysis.begin(x)
        energies.append(row["q_kinetic"])
    assert max(np.diff(energies[2:])) < 1e-6 * energies[2] and energies[-1] < 0.5 * energies[2]


def test_its_tangent_is_the_derivative_of_the_residual(tmp_path):
    analysis = solved(tmp_path, channel(2, 1, FLUID, SUCKED) + STEADY + MESH).analysis
    problem, x = analysis.problem, analysis.x
    assert problem.drawing_in
    (term,) = problem.integrals("internal")[1:]
    d = np.random.default_rng(3).normal(size=x.shape)

    def residual(x):
        out = np.zeros_like(x)
        term.add_residual(x, out)
        return out

    h, out = 1e-6, np.zeros_like(x)
    term.add_tangent_product(x, d, out)
    np.testing.assert_allclose(out, (residual(x + h * d) - residual(x - h * d)) / (2 * h), atol=1e-7)
    assert np.abs(tangent_product(problem, x, d)).max() > np.abs(out).max() > 0.01


def test_what_is_reused_agrees_with_cold_solves(tmp_path):
    text = channel(2, 1, FLUID, SUCKED, disc("body", (0.7, 0.5), 0.15)) + in_time(0.1) + MESH
    script = write_script(tmp_path, [*idle(3), *drag("body", (0.7, 0.5), across((0.7, 0.5), (0.8, 0.5), 3))])
    made = make_replay(write_scene(tmp_path, text), script)
    check = Parity(made)
    for _ in made.frames():
        check()
    assert check.summary()["holds"], check.summary()
