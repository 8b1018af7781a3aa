"""Errors of quantities that are frequencies or load factors, against finer meshes."""

import numpy as np
import pytest
from modal import SCENES as METALLOPHONE

from restshape.interface.first_frame import first_frame

COLUMN = METALLOPHONE / "column.toml"


def spectrum(scene, names, *overrides):
    """Values and errors of quantities of a scene file."""
    asked = [f"quantities.{name}.error=true" for name in names]
    row = first_frame(scene, [*asked, *overrides]).row
    return {name: (row[f"q_{name}"], row[f"{name}_error"]) for name in names}


@pytest.mark.slow
def test_frequencies(tmp_path):
    """Of the second order, which meets its error: by rank, and by the number of a mode; in hertz."""
    scene = tmp_path / "bar.toml"
    scene.write_text((METALLOPHONE / "bar_100.toml").read_text() + "\nagain = { mode = 1 }\n")
    both = ["mesh.layers=1", "mesh.order=2"]
    found = spectrum(scene, ["pitch", "again"], *both, "mesh.size=0.012")
    fine = spectrum(scene, ["pitch"], "mesh.layers=2", "mesh.order=2", "mesh.size=0.006")
    value, error = found["pitch"]
    assert found["again"] == found["pitch"]
    assert 0.5 <= error / abs(value - fine["pitch"][0]) <= 2.0


@pytest.mark.parametrize(("order", "size"), [(1, 0.015), (2, 0.03)])
def test_load_factors_and_the_equilibrium_below(order, size):
    sizes = [f"mesh.order={order}", f"mesh.size={size}"]
    names = ["first", "second", "sinks"]
    found, fine = spectrum(COLUMN, names, *sizes), spectrum(COLUMN, names, "mesh.order=2", "mesh.size=0.01")
    for name in ("first", "second"):
        value, error = found[name]
        assert 0.5 <= error / abs(value - fine[name][0]) <= 2.0, name
    # Uniform compression is exact.
    assert found["sinks"][1] <= 1e-9 * abs(found["sinks"][0])


def test_a_load_factor_that_there_is_not_has_no_error():
    found = spectrum(COLUMN, ["first"], "effects.buckling.load=reversed")
    assert found["first"][0] == np.inf and np.isnan(found["first"][1])
