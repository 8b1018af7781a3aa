"""What `restshape explain` says of flow: each effect, whether it is on, why, and which elements it calls."""

import json

import pytest
from restshape_apps.flow import application

SCENE = application.folder / "scenes" / "flow.toml"


@pytest.fixture
def explained(command, tmp_path):
    """Rows by effect, of two frames in which the tail moves, with settings that differ from the scene's."""

    def run(*settings):
        lines = [{"format": "restshape-edits", "version": 1, "units": "mm"}]
        lines += [{"t": 0.0, "do": "press", "on": "tail", "at": [5, 0]}]
        lines += [{"t": 0.1, "do": "drag", "path": [[7, 0], [9, 0]]}, {"t": 0.3, "do": "release"}]
        (tmp_path / "e.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
        words = ["--edits", "e.jsonl", "--frames", "2", "--seconds", "0", "--json", "out.json"]
        done = command("explain", SCENE, *words, *(word for one in settings for word in ("--set", one)))
        assert done.returncode == 0, done.stderr
        found = json.loads((tmp_path / "out.json").read_text())
        return {row["effect"]: row for row in found}

    return run


@pytest.mark.slow
def test_flow_in_time_with_an_outflow(explained):
    rows = explained()
    assert rows["flow"]["on"] and rows["flow"]["how"].startswith("all that is left, with mesh_velocity")
    assert rows["mesh_velocity"]["on"] and "relative to the mesh" in rows["mesh_velocity"]["why"]
    assert not rows["pressure_datum"]["on"] and rows["pressure_datum"]["calls"] == 0
    assert rows["convection"]["on"] and rows["convection"]["calls"] > 0
    # The outlet may draw fluid in, and does not in these frames: its element is not called.
    assert rows["backflow"]["on"] and not any(
        kernel.startswith("backflow") for row in rows.values() for kernel in row["kernels"]
    )
    assert rows["flow"]["solver"]["equations"] == "nonlinear"
    assert "unsteady_flow_on_moving_mesh_tri3" in rows["flow"]["solver"]["elements"]


@pytest.mark.slow
def test_steady_slow_flow_in_a_closed_vessel_is_linear(explained):
    """Without convection the equations are those of Stokes, and no element knows inertia or time."""
    wind = 'boundary.wind.velocity=["0.1 m/s", 0]'
    rows = explained("effects={flow={steady=true}}", wind, "boundary.end={on='outlet', velocity=['0.1 m/s', 0]}")
    assert not rows["convection"]["on"] and not rows["mesh_velocity"]["on"] and rows["pressure_datum"]["on"]
    assert not rows["backflow"]["on"]
    solver = next(row["solver"] for row in rows.values() if "solver" in row)
    assert solver["equations"] == "linear" and solver["elements"] == ["slow_flow_tri3"]
