"""Outlines, numbers and recordings that a fit of a drape refuses, or reads in one way only."""

from argparse import Namespace
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from restshape_apps.couture import application
from restshape_apps.couture.fit_command import write_scene
from restshape_apps.couture.fitting.confidence import Confidence
from restshape_apps.couture.fitting.drapes_by_number import Drape, DrapesByNumber, SetByEdits
from restshape_apps.couture.fitting.fit import Fit, OutlineFit
from restshape_apps.couture.fitting.measured_outline import MeasuredOutline, read_outline
from restshape_apps.couture.fitting.recorded_shadow import outer_border, shadow_of
from restshape_apps.couture.fitting.report import FitReport, MeasuredShadow

from restshape.cli.main import main
from restshape.errors import UserError
from restshape.outputs.kinds import FITTED_MARK
from restshape.scene.load import load_scene
from restshape.scene.rewritten import rewritten

SCENE = application.folder / "scenes" / "cusick.toml"
KEY = "material.cotton.bending"
COARSE = "mesh.size=40mm"
ROUND = 0.12 * np.exp(2j * np.pi * np.arange(90) / 90)
CIRCLE = np.stack([ROUND.real, ROUND.imag], axis=1)


def table(tmp_path: Path, head: str, points: np.ndarray = CIRCLE, scale: float = 1e3, row: str = "{},{}") -> Path:
    path = tmp_path / "drape.csv"
    path.write_text(head + "\n".join(row.format(*(scale * p)) for p in points))
    return path


def test_decimal_commas_are_read(tmp_path):
    path = table(tmp_path, "x (mm);y (mm)\n")
    path.write_text("x (mm);y (mm)\n" + "\n".join(f"{x:.6f};{y:.6f}".replace(".", ",") for x, y in 1e3 * CIRCLE))
    read = read_outline(path)
    np.testing.assert_allclose(read.points, CIRCLE, atol=1e-9)
    assert not read.doubt


def test_a_first_row_with_an_exponent_is_a_point(tmp_path):
    read = read_outline(table(tmp_path, "", row="{:.9e},{:.9e}"))
    assert len(read.points) == 90 and read.doubt


@pytest.mark.parametrize(
    ("head", "row", "message"),
    [
        ("x [in],y [in]\n", "{},{}", "'in' is no unit"),
        ("x [cm],y [mm]\n", "{},{}", "unlike units: cm and mm"),
        ("x [mm],y [mm]\n\n\n1,2,3\n", "{},{}", "line 4"),
        ("x [mm],y [mm]\n12,5,3,2\n", "{},{}", "not of two numbers"),
    ],
)
def test_tables_that_are_in_doubt_are_refused(tmp_path, head, row, message):
    with pytest.raises(UserError) as refused:
        read_outline(table(tmp_path, head, row=row))
    assert message in str(refused.value)


def test_a_unit_in_parentheses_is_read(tmp_path):
    np.testing.assert_allclose(read_outline(table(tmp_path, "x (cm),y (cm)\n", scale=100.0)).points, CIRCLE)


TWICE = np.concatenate([CIRCLE, CIRCLE])
EIGHT = np.stack([CIRCLE[:, 0], 0.7 * CIRCLE[:, 0] * CIRCLE[:, 1] / 0.12 + 0.02 * CIRCLE[:, 1]], axis=1)


@pytest.mark.parametrize("points", [TWICE, TWICE * np.linspace(1.0, 0.9, 180)[:, None], EIGHT])
def test_outlines_that_cross_themselves_are_refused(tmp_path, points):
    with pytest.raises(UserError, match="crosses itself near"):
        read_outline(table(tmp_path, "x [mm],y [mm]\n", points))


def test_crossings_of_noise_are_none(tmp_path):
    fine = 0.12 * np.exp(2j * np.pi * np.arange(360) / 360)
    noisy = np.stack([fine.real, fine.imag], axis=1) + np.random.default_rng(0).normal(0.0, 2e-3, (360, 2))
    assert read_outline(table(tmp_path, "x [mm],y [mm]\n", noisy)).area == pytest.approx(np.pi * 0.12**2, rel=0.02)


def test_a_table_of_the_wrong_size_is_asked_to_name_its_unit(tmp_path, capsys):
    path = table(tmp_path, "x [cm],y [cm]\n")
    assert main(["fit", str(SCENE), "--set", COARSE, "--outline", str(path)]) == 2
    assert "name the unit in the first row" in " ".join(capsys.readouterr().err.split())


def test_a_number_that_edits_set_is_refused(tmp_path):
    edits = tmp_path / "edits.jsonl"
    head = '{"format": "restshape-edits", "version": 1, "scene": "cusick.toml", "units": "m"}'
    edits.write_text(f'{head}\n{{"t": 0.5, "do": "set", "key": "{KEY}", "value": 1e-5}}\n')
    own = DrapesByNumber(load_scene(SCENE, [COARSE]), [KEY], edits)
    with pytest.raises(SetByEdits, match=r"the edits set material\.cotton\.bending"):
        own.cold(own.start)


def test_a_value_that_does_not_suit_is_no_drape():
    own = DrapesByNumber(load_scene(SCENE, [COARSE]), ["material.cotton.nu"])
    assert own.near(own.cold(own.start), np.array([0.7])) is None


def test_a_number_is_named_once():
    with pytest.raises(UserError, match="named twice"):
        DrapesByNumber(load_scene(SCENE, [COARSE]), [KEY, KEY])


def test_a_number_of_zero_hardly_moves_the_outline(tmp_path, capsys):
    path = table(tmp_path, "x [mm],y [mm]\n")
    words = ["--set", COARSE, "--set", f"{KEY}=0", "--outline", str(path)]
    assert main(["fit", str(SCENE), *words]) == 2
    assert f"{KEY} = 0 hardly moves the outline" in " ".join(capsys.readouterr().err.split())


def grid(left_out: tuple[tuple[int, int], ...]) -> tuple[np.ndarray, np.ndarray]:
    """Corners (16, 2) and triangles of three by three squares, some of which are left out."""
    X = np.stack(np.meshgrid(np.arange(4.0), np.arange(4.0)), axis=-1).reshape(-1, 2)
    low = np.array([4 * k + j for k in range(3) for j in range(3) if (k, j) not in left_out])
    return X, np.concatenate([np.stack([low, low + 1, low + 5], axis=1), np.stack([low, low + 4, low + 5], axis=1)])


def test_holes_are_no_border():
    border = outer_border(*grid(((1, 1),)))
    assert len(border) == 12 and set(border.ravel()).isdisjoint({5, 6, 9, 10})


def test_cloth_that_has_no_shadow_around_its_middle_is_refused():
    X, cells = grid(())
    flat = np.column_stack([X, np.zeros(16)])
    assert shadow_of(X, cells, flat, "here")[1] == pytest.approx(9.0, rel=1e-3)
    with pytest.raises(UserError, match="of the flat cloth"):
        shadow_of(X, cells, flat[:, [0, 2, 1]] + 1e-3 * flat, "here")
    X, cells = grid(((0, 1), (0, 2), (1, 1), (1, 2)))
    with pytest.raises(UserError, match="of the directions"):
        shadow_of(X, cells, np.column_stack([X, np.zeros(16)]), "here")


def test_a_named_fabric_has_numbers_of_its_lists(tmp_path):
    text = SCENE.read_text()
    own = text.index("[material.cotton]"), text.index("[supports.discs]")
    scene = tmp_path / "denim.toml"
    scene.write_text(f'{text[: own[0]]}[material.cotton]\nname = "denim"\n\n{text[own[1] :]}')
    drapes = DrapesByNumber(load_scene(scene, [COARSE]), [f"{KEY}.0", f"{KEY}.1"])
    np.testing.assert_allclose(drapes.start, 78.2e-6)
    after = drapes.with_values(drapes.scene, [1e-5, 2e-5])
    assert after.material["cotton"].bending == (1e-5, 2e-5)
    changes = drapes.changes([1e-5, 78.2e-6])
    written = tmp_path / "fitted.toml"
    written.write_text(rewritten(scene, changes, written))
    assert load_scene(written).material["cotton"].bending == (1e-5, 78.2e-6)


@pytest.fixture(scope="module")
def coarse() -> tuple[DrapesByNumber, Drape]:
    """Drapes of a scene without drape coefficient, and one of them."""
    scene = load_scene(SCENE, [COARSE])
    found = DrapesByNumber(scene.model_copy(update={"quantities": {}}), [KEY])
    return found, found.cold(found.start)


def report_of(coarse: tuple[DrapesByNumber, Drape], folds: int = 0, again: float | None = 1.0) -> FitReport:
    """A report on a drape and its own outline that has more folds, or whose replay is off by a factor."""
    drapes, drape = coarse
    outline = MeasuredOutline(drape.edge.points()[::4] * 1.001)
    step = OutlineFit(drapes, outline, drape.folds, print).step(drape)
    off = replace(step.distances, values=(again or 1.0) * step.distances.values)
    found = Fit([step], step, drape.values, step, np.ones((1, 1)), again and replace(step, distances=off), not folds)
    trust = Confidence(drape.values, drape.values, 9.0, 0.0, np.zeros(1, bool))
    measured = MeasuredShadow(outline.area, drape.folds + folds, None)
    return FitReport(drapes, outline, measured, found, trust, None, drapes.mesh.outline.area())


def test_a_scene_without_drape_coefficient_has_none(coarse):
    report = report_of(coarse)
    assert not report.notes()
    assert report.plain()["measured"]["drape_coefficient"] is None
    for heads, rows in (report.steps(), report.outlines()):
        assert "drape coefficient" not in heads and {len(row) for row in rows} == {len(heads)}


@pytest.mark.parametrize(
    ("folds", "again", "note"),
    [(2, 1.0, "cloth has several rests"), (0, 1.5, "finds another rest"), (0, None, "does not come to rest")],
)
def test_notes_say_where_a_drape_has_other_rests(coarse, folds, again, note):
    (found,) = report_of(coarse, folds, again).notes()
    assert note in found


def test_a_scene_that_is_fitted_again_has_one_mark(tmp_path, coarse):
    scene, out = tmp_path / "scene.toml", tmp_path / "fitted.toml"
    scene.write_text(FITTED_MARK + SCENE.read_text())
    write_scene(Namespace(set=[], out=out), load_scene(scene), report_of(coarse))
    assert out.read_text().count(FITTED_MARK) == 1
