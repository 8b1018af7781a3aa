"""Stiffness from the outline of a drape: recovered, by derivatives that differences confirm, and what is refused."""

import json
from pathlib import Path

import numpy as np
import pytest
from restshape_apps.couture import application
from restshape_apps.couture.fit_command import STARTS
from restshape_apps.couture.fitting.alignment import aligned
from restshape_apps.couture.fitting.confidence import confidence, correlation_length
from restshape_apps.couture.fitting.drapes_by_number import Drape, DrapesByNumber
from restshape_apps.couture.fitting.fit import OutlineFit
from restshape_apps.couture.fitting.measured_outline import MeasuredOutline, read_outline
from restshape_apps.couture.fitting.outline_distance import MEASURED, Place, distances, from_middle

from restshape.cli.main import main
from restshape.scene.load import load_scene

SCENE = application.folder / "scenes" / "cusick.toml"
KEY = "material.cotton.bending"
SIZE = "24mm"
COARSE = [f"mesh.size={SIZE}"]
TRUE = 5e-6


def drapes(value: float = TRUE, keys: tuple[str, ...] = (KEY,), size: str = SIZE) -> DrapesByNumber:
    return DrapesByNumber(load_scene(SCENE, [f"mesh.size={size}", f"{KEY}={value}"]), keys)


@pytest.fixture(scope="module")
def known() -> tuple[DrapesByNumber, Drape]:
    """Drapes of a coarse cloth, and that with the stiffness which is looked for."""
    found = drapes()
    return found, found.cold(found.start)


def outline_of(drape: Drape, noise: float = 0.0, seed: int = 0, turn: float = 0.7) -> MeasuredOutline:
    """The outline of a drape, turned, moved and with noise [m]."""
    points = drape.edge.points()[::4]
    points = points + np.random.default_rng(seed).normal(0.0, noise, points.shape)
    return MeasuredOutline(Place(turn, 0.3, -0.1).lay(points))


def svg_of(points: np.ndarray, path: Path, closed: bool = True, size: str = 'width="400mm" height="400mm"') -> Path:
    words = " ".join(f"{1e3 * x:.4f},{-1e3 * y:.4f}" for x, y in points)
    head = f'<svg xmlns="http://www.w3.org/2000/svg" {size} viewBox="-200 -200 400 400">'
    path.write_text(f'{head}<path d="M {words}{" Z" * closed}"/></svg>')
    return path


def test_the_radii_of_a_shadow_follow_the_stiffness_as_differences_say(known):
    own, drape = known
    rates, step = own.rates(drape)[:, 0], 1e-4 * TRUE
    ahead, behind = (own.near(drape, np.array([TRUE + sign * step])) for sign in (1, -1))
    differences = (ahead.edge.radii - behind.edge.radii) / (2.0 * step)
    # A direction in which another edge of the mesh comes to be the farthest jumps.
    assert np.quantile(np.abs(differences - rates), 0.98) < 1e-3 * np.abs(rates).max()


def test_distances_follow_radii_and_places_as_differences_say(known):
    _, drape = known
    measured, place = from_middle(outline_of(drape, 2e-3)), aligned(from_middle(outline_of(drape, 2e-3)), drape.edge)[0]
    place = Place(place.turn + 0.05, place.x + 2e-3, place.y - 1e-3)
    here, step = distances(measured, place, drape.edge), 1e-7
    for column, moved in enumerate(
        (Place(place.turn + step, place.x, place.y), Place(place.turn, place.x + step, place.y))
    ):
        slopes = (distances(measured, moved, drape.edge).values - here.values) / step
        assert np.quantile(np.abs(slopes - here.by_place[:, column]), 0.95) < 1e-3
    longer = np.cos(3.0 * np.linspace(0.0, 2.0 * np.pi, len(drape.edge.radii), endpoint=False))
    other = type(drape.edge)(**{**vars(drape.edge), "radii": drape.edge.radii + step * longer})
    slopes = (distances(measured, place, other).values - here.values) / step
    assert np.quantile(np.abs(slopes - here.by_radii(longer[::2])), 0.95) < 1e-3


def test_a_turned_outline_is_placed_where_it_was(known):
    _, drape = known
    _, found = aligned(from_middle(outline_of(drape, turn=2.1)), drape.edge)
    assert found.rms < 3e-4
    _, without = aligned(from_middle(MeasuredOutline(0.9 * outline_of(drape).points)), drape.edge)
    assert without.rms > 5e-3


@pytest.mark.parametrize("factor", [2.0, 0.6])
def test_a_descent_on_the_measured_folds_recovers_the_stiffness(known, factor):
    own, drape = known
    measured = outline_of(drape, 1e-3)
    fit = OutlineFit(own, measured, drape.folds, lambda step: None)
    start = fit.step(own.near(drape, np.array([factor * TRUE])))
    best, J = fit.descend(start)
    assert best.drape.values[0] == pytest.approx(TRUE, rel=0.05)
    assert best.misfit < 1e-3 < start.misfit
    trust = confidence(best, J, len(measured.points))
    assert trust.low[0] < TRUE < trust.high[0] < 1.1 * trust.low[0]


@pytest.mark.weekly
@pytest.mark.parametrize("factor", [3.0, 2.0, 0.5, 1.0 / 3.0])
@pytest.mark.parametrize("seed", [1, 2])
def test_a_stiffness_is_recovered_on_the_mesh_of_the_scene(factor, seed):
    start = drapes(size="12mm")
    drape = start.cold(start.start)
    measured, own = outline_of(drape, 1e-3, seed), drapes(factor * TRUE, size="12mm")
    found = OutlineFit(own, measured, drape.folds, lambda step: None).run(own.cold(own.start), STARTS)
    assert found.best.drape.values[0] == pytest.approx(TRUE, rel=0.05)


def test_the_length_of_correlation_is_that_of_neighbours():
    noise = np.random.default_rng(0).normal(size=MEASURED)
    assert correlation_length(noise) == pytest.approx(1.0, abs=0.4)
    assert correlation_length(np.repeat(noise[::9], 9)) == pytest.approx(9.0, rel=0.3)


def test_shadow_and_fit_by_command(tmp_path, capsys):
    recording, outline, fitted = (tmp_path / name for name in ("cloth.vtkhdf", "drape.svg", "fitted.toml"))
    assert main(["replay", str(SCENE), "--set", *COARSE, "--out", str(recording)]) == 0
    assert main(["shadow", str(recording), "--out", str(outline), "--noise", "1mm"]) == 0
    words = ["--set", *COARSE, "--set", f"{KEY}=4.7e-6", "--outline", str(outline)]
    files = ["--out", str(fitted), "--picture", str(tmp_path / "fit.png"), "--json", str(tmp_path / "fit.json")]
    assert main(["fit", str(SCENE), *words, *files]) == 0
    found = json.loads((tmp_path / "fit.json").read_text())
    value = load_scene(fitted).material["cotton"].bending
    assert value == pytest.approx(TRUE, rel=0.05)
    assert value == pytest.approx(found["numbers"][KEY]["fitted"], rel=1e-5)
    assert "# Cusick's drapemeter" in fitted.read_text()
    assert found["measured"]["folds"] == found["fitted"]["folds"]
    assert (tmp_path / "fit.png").stat().st_size > 10_000
    printed = capsys.readouterr().out
    assert "drape coefficient" in printed and "misfit [mm]" in printed


@pytest.mark.weekly
def test_intervals_contain_the_stiffness_nearly_as_often_as_they_say(known):
    own, drape = known
    start, hits = own.near(drape, np.array([1.3 * TRUE])), 0
    for seed in range(100, 160):
        measured = outline_of(drape, 1e-3, seed)
        fit = OutlineFit(own, measured, drape.folds, lambda step: None)
        best, J = fit.descend(fit.step(start))
        trust = confidence(best, J, len(measured.points))
        hits += bool(trust.low[0] < TRUE < trust.high[0])
    assert hits >= 0.85 * 60


SIZED = 'width="400mm" height="400mm"'


@pytest.mark.parametrize(
    ("scale", "closed", "size", "words", "message"),
    [
        (1.0, False, SIZED, [], "not closed: its ends are"),
        (1.0, True, "", [], "96 units an inch"),
        (0.1, True, SIZED, [], "smaller than the least shadow of the cloth"),
        (10.0, True, SIZED, [], "perhaps millimetres read as centimetres"),
        (1.0, True, SIZED, ["--by", "seams.side.stiffness"], "no number of this scene"),
        (1.0, True, SIZED, ["--by", "parameters.idle"], "parameters.idle = 1 hardly moves the outline"),
        (1.0, True, SIZED, ["--starts", "0"], "0 starts find nothing"),
    ],
)
def test_what_is_wrong_is_reported(tmp_path, known, capsys, scale, closed, size, words, message):
    points = scale * known[1].edge.points()[: 1440 if closed else 1200 : 8]
    path, scene = svg_of(points, tmp_path / "drape.svg", closed, size), tmp_path / "scene.toml"
    scene.write_text(SCENE.read_text() + "\n[parameters]\nidle = 1\n")
    assert main(["fit", str(scene), "--set", *COARSE, "--outline", str(path), *words]) == 2
    assert message in " ".join(capsys.readouterr().err.split())


def test_a_table_is_an_outline(tmp_path, known):
    points = known[1].edge.points()[::8]
    path = tmp_path / "drape.csv"
    path.write_text("x [cm],y [cm]\n" + "\n".join(f"{100 * x},{100 * y}" for x, y in points))
    read = read_outline(path)
    assert read.area == pytest.approx(MeasuredOutline(points).area, rel=1e-9) and not read.doubt
    path.write_text("\n".join(f"{1e3 * x};{1e3 * y}" for x, y in points))
    assert "millimetres" in read_outline(path).doubt
