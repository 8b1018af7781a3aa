"""Eigenfrequencies beside a motion: of a clamped column, against beam theory and the metallophone's own modes."""

import numpy as np
import pytest
from small_scenes import make_replay, rows_of, write_script

from restshape.application import application
from restshape.errors import UserError
from restshape.scene.load import load_scene

COLUMN = application("vibration").folder / "scenes" / "column.toml"
MODAL = ["effects.modal={modes=4}", "mesh.order=2"]


@pytest.fixture(scope="module")
def row():
    (row,) = rows_of(make_replay(COLUMN, overrides=[*MODAL, "quantities.second={frequency=2}"]))
    return row


def test_bending_modes_of_a_slender_column_are_those_of_a_beam():
    """f = (1.8751^2 / 2 pi) sqrt(E I / (rho A)) / L^2 of Euler and Bernoulli, 1.5 % above for a column 1:16."""
    overrides = [*MODAL, "shape.vertices.b=[0.25,0]", "shape.vertices.c=[0.25,4]", "mesh.size=0.125"]
    (row,) = rows_of(make_replay(COLUMN, overrides=overrides))
    beam = 1.875104**2 / (2 * np.pi) * np.sqrt(70e9 * 0.25**2 / 12 / 2700) / 16
    assert row["f_1"] == pytest.approx(beam, rel=0.015)
    # Of a uniform cantilever 61.31 % and 18.83 % of the mass move with the first two bending modes.
    assert row["effective_mass_1"] == pytest.approx(0.6131, abs=0.01)
    assert row["effective_mass_2"] == pytest.approx(0.1883, abs=0.01)


def test_an_axial_mode_moves_no_mass_sideways(row):
    """The first axial frequency of a column is sqrt(E/rho) / (4 L); as it is plane stress, nearly so."""
    axial = np.sqrt(70e9 / 2700) / 16
    k = int(np.argmin([abs(row[f"f_{j}"] - axial) for j in range(1, 5)])) + 1
    assert row[f"f_{k}"] == pytest.approx(axial, rel=0.02)
    assert row[f"effective_mass_{k}"] < 1e-6


def test_a_quantity_is_the_frequency_of_its_rank(row):
    assert row["q_second"] == row["f_2"] > row["f_1"]


def test_frequencies_follow_the_edit(tmp_path):
    """A column that is dragged a quarter taller has about (4/5)^2 of its lowest frequency."""
    events = [
        {"do": "press", "on": "top", "at": [0.25, 4.0]},
        {"do": "drag", "to": [0.25, 5.0], "frames": 8},
        {"do": "release"},
    ]
    rows = rows_of(make_replay(COLUMN, write_script(tmp_path, events), overrides=MODAL))
    found = np.array([row["f_1"] for row in rows])
    assert found[-1] / found[0] == pytest.approx(0.64, rel=0.02)
    (again,) = rows_of(make_replay(COLUMN, overrides=[*MODAL, "shape.vertices.c=[0.5,5]", "shape.vertices.d=[0,5]"]))
    assert found[-1] == pytest.approx(again["f_1"], rel=2e-3)


@pytest.mark.parametrize(
    ("overrides", "says"),
    [
        (["quantities.f={frequency=1}"], r"quantities\.f\.frequency|effects\.modal"),
        (["effects.modal={modes=2}", "quantities.f={frequency=3}"], "only 2 modes are computed"),
        (["effects.modal={}", "effects.large_deformation={}"], "eigenfrequencies are those of a linear solid"),
    ],
)
def test_what_makes_no_sense_is_refused(overrides, says):
    with pytest.raises(UserError, match=says):
        load_scene(COLUMN, overrides)
