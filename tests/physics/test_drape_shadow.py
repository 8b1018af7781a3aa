"""Areas of shadows by closed forms, and folds counted; Cusick's coefficient of a cloth on a disc."""

import numpy as np
import pytest
from cloths import HEAD

from restshape.errors import UserError
from restshape.interface.first_frame import first_frame
from restshape.physics.cloth.drape_shadow import DIRECTIONS, DrapeShadow, count_folds

ANGLES = 2.0 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS


def fan(border: np.ndarray) -> tuple[DrapeShadow, np.ndarray]:
    """Triangles from the middle of a border (k, 3), and their nodes."""
    k = len(border)
    ring = np.arange(k)
    cells = np.column_stack([np.full(k, k), ring, (ring + 1) % k])
    return DrapeShadow(cells, np.column_stack([ring, (ring + 1) % k])), np.vstack([border, border.mean(axis=0)])


def rim(radius: np.ndarray, angles: np.ndarray) -> np.ndarray:
    return np.column_stack([radius * np.cos(angles), radius * np.sin(angles), np.zeros(len(angles))])


def test_the_shadow_of_a_round_cloth_is_a_circle():
    shadow, places = fan(rim(np.full(DIRECTIONS, 0.15), ANGLES))
    assert shadow.area(places) == pytest.approx(np.pi * 0.15**2, rel=1e-5)
    assert shadow.folds(places) == 0


def test_the_shadow_of_a_square_is_where_it_lies():
    square = np.array([[5, -2, 0.3], [6, -2, 0], [6, -1, 0.2], [5, -1, 0]], dtype=float)
    shadow, places = fan(square)
    assert shadow.area(places) == pytest.approx(1.0, rel=1e-4)


def test_cloth_on_cloth_counts_once():
    """A cloth of 1 m by 0.5 m that is folded in two has the shadow of its half."""
    upper = [(0, 0, 0), (0.5, 0, 0), (1, 0, 0), (0, 0.5, 0), (0.5, 0.5, 0), (1, 0.5, 0)]
    lower = [(x, y, -0.01) for x, y, _ in upper[:3]]
    places = np.array([*upper, *lower], dtype=float)
    half = [(0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4)]
    cells = np.array([*half, *(tuple(v + 6 if v < 3 else v for v in cell) for cell in half)])
    shadow = DrapeShadow(cells, np.array([[0, 1], [1, 2], [2, 5], [5, 8], [8, 7], [7, 6], [6, 3], [3, 0]]))
    assert shadow.area(places) == pytest.approx(0.5, rel=1e-3)


@pytest.mark.parametrize("folds", [1, 4, 7, 12])
@pytest.mark.parametrize("turn", [0.0, 0.3])
def test_folds_are_counted(folds, turn):
    assert count_folds(1.0 + 0.1 * np.cos(folds * (ANGLES - turn))) == folds


def test_ripples_of_less_than_a_fold_are_none():
    assert count_folds(1.0 + 0.1 * np.cos(5 * ANGLES) + 0.004 * np.cos(60 * ANGLES)) == 5
    assert count_folds(np.ones(DIRECTIONS)) == 0


@pytest.mark.parametrize(("height", "folds"), [(0.2, 6), (0.0, 0)])
def test_folds_do_not_hang_on_how_fine_the_border_is(height, folds):
    """A quarter of the border has ten times as many nodes: its middle stays that of the curve."""
    angles = np.concatenate([np.linspace(0.0, 0.5, 200, endpoint=False), np.linspace(0.5, 2.0, 60, endpoint=False)])
    shadow, places = fan(rim(1.0 + height * np.cos(6.0 * np.pi * angles), np.pi * angles))
    places[-1] = 0.0
    assert shadow.folds(places) == folds


def test_holes_and_regions_do_not_shift_the_middle(tmp_path):
    """A flat disc has no folds, also with a fine hole on one side."""
    path = tmp_path / "holed.toml"
    hole = '[shape.holes]\neye = { circle = { center = ["5 cm", 0], radius = "3.5 cm" } }\n[shape.regions]'
    path.write_text(CUSICK.replace("[shape.regions]", hole).replace('center = [0, 0], radius = "9 cm"', PLATE))
    assert first_frame(path, ['material.cloth.bending="1 N m"']).analysis.observe()["folds"] == 0


PLATE = 'center = ["-8 cm", 0], radius = "4 cm"'
CUSICK = f"""
{HEAD}[shape]
outline = ["lower", "upper"]
[shape.vertices]
west = ["-15 cm", 0]
east = ["15 cm", 0]
[shape.edges]
lower = {{ arc = ["west", "east"], bulge = 1 }}
upper = {{ arc = ["east", "west"], bulge = 1 }}
[shape.regions]
plate = {{ circle = {{ center = [0, 0], radius = "9 cm" }} }}
[material.cloth]
name = "dress cloth"
[bodies.disc]
cylinder = {{ start = [0, 0, -0.5], end = [0, 0, -0.001], radius = "9 cm", rounded = "4 mm" }}
friction = 0.4
[effects.gravity]
[effects.contact]
[mesh]
size = "25 mm"
[quantities]
drape = {{ drape_coefficient = true, at = "plate" }}
shadow = {{ drape_coefficient = true }}
folds = {{ folds = true }}
"""


def first_values(tmp_path, *overrides: str) -> dict[str, float]:
    path = tmp_path / "cusick.toml"
    path.write_text(CUSICK)
    return first_frame(path, list(overrides)).analysis.observe()


def test_limp_cloth_drapes_more_than_stiff_cloth(tmp_path):
    limp = first_values(tmp_path)
    stiff = first_values(tmp_path, 'material.cloth.bending="1e-2 N m"')
    assert 0.0 < limp["drape"] < 0.8 and 0.9 < stiff["drape"] < 1.001
    assert limp["folds"] >= 3 and stiff["folds"] == 0
    # Of the same shadow: by the areas of a disc of 9 cm and a cloth of 15 cm.
    share = (9 / 15) ** 2
    assert limp["shadow"] == pytest.approx(share + limp["drape"] * (1 - share), rel=1e-6)


@pytest.mark.parametrize(
    ("quantity", "message"),
    [
        ("{ folds = true, at = 'plate' }", "leave it out"),
        ("{ drape_coefficient = true, at = 'lower' }", "name a region"),
    ],
)
def test_where_they_are_taken_is_checked(tmp_path, quantity, message):
    with pytest.raises(UserError, match=message):
        first_values(tmp_path, f"quantities.drape={quantity}")
