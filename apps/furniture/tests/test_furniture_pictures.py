"""Pictures of furniture: what is overloaded is red, what hides is in front, what is drawn stays in sight."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib import image
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from restshape_apps.furniture.guidance.suggestions import suggest
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_apps.furniture.pieces import cantilever, scales, table
from restshape_apps.furniture.regions import RANGES, joint_rays, linearised_and_true, tipping_rays
from restshape_apps.furniture.report.force_space import draw_region
from restshape_apps.furniture.report.furniture import (
    FOOT,
    LOAD,
    MOVED,
    WAY,
    DesignDirectionView,
    bounds,
    draw_piece,
    utilisation_colours,
    vector_words,
)
from restshape_apps.furniture.small_pieces import toppling

from restshape.cli.main import main
from restshape.report.space_scene import SpaceDrawing, SpaceImage
from restshape.report.style import REFUSED, new_figure


def drawn(furniture: Furniture, direction_view: DesignDirectionView | None = None, numbers: bool = True):
    """The axes of one picture, laid out, and its pixels, the lowest row first."""
    figure = new_figure(4.0, 3.5)
    axes = figure.subplots()
    draw_piece(axes, furniture, "a piece", direction_view, numbers=numbers)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return axes, np.asarray(canvas.buffer_rgba())[::-1, :, :3]


@pytest.fixture
def arrows(monkeypatch):
    """Start, end and colour of all arrows that are drawn."""
    made, arrow = [], SpaceDrawing.arrow

    def log(scene, start, end, colour, *others):
        made.append((start, end, colour))
        arrow(scene, start, end, colour, *others)

    monkeypatch.setattr(SpaceDrawing, "arrow", log)
    return made


def space(axes) -> SpaceImage:
    """What is drawn in space."""
    (found,) = (artist for artist in axes.get_children() if isinstance(artist, SpaceImage))
    return found


def at(axes, pixels: np.ndarray, places: np.ndarray) -> np.ndarray:
    """The colours (n, 3) at places (n, 3) [m] of a picture, from 0 to 1."""
    column, row = axes.transData.transform(space(axes).camera.project(places)).astype(int).T
    return pixels[row, column] / 255.0


def model(piece) -> Furniture:
    """A tested model."""
    furniture = Furniture(piece)
    furniture.test()
    return furniture


def near(pixels: np.ndarray, colour: str) -> int:
    """How many pixels have a colour."""
    return int((np.abs(pixels / 255.0 - to_rgb(colour)).max(axis=2) < 0.02).sum())


def test_colours_of_use_end_at_what_a_joint_bears() -> None:
    cmap, norm = utilisation_colours()
    assert cmap(norm(1.001))[:3] == pytest.approx(to_rgb(REFUSED))
    assert cmap(norm(0.999))[:3] != pytest.approx(to_rgb(REFUSED), abs=0.1)


@pytest.mark.parametrize(("kilograms", "overloaded"), [(30.0, 0), (50.0, 1)])
def test_an_overloaded_joint_is_red(kilograms: float, overloaded: int) -> None:
    furniture = model(table(kilograms=kilograms))
    axes, pixels = drawn(furniture, numbers=False)
    forces, (cmap, norm) = furniture.forces(0), utilisation_colours()
    utilisation = np.maximum(forces.pull_utilisation, forces.shear_utilisation)
    seen = at(axes, pixels, furniture.geometry().p)
    assert seen == pytest.approx(cmap(norm(utilisation))[:, :3], abs=0.02)
    assert np.isclose(seen, to_rgb(REFUSED), atol=0.02).all(axis=1).sum() == overloaded
    assert (near(pixels, REFUSED) > 0) is bool(overloaded)


def test_what_is_nearer_hides_the_rest() -> None:
    furniture = model(table())
    axes, pixels = drawn(furniture, numbers=False)
    top = next(plank for plank in furniture.piece.planks if plank.name == "top")
    corners = top.corners()
    # Beside joints and load; above legs and grid.
    upper = top.centre + np.array([[0.1 * top.size[0], y, 0.5 * top.size[2]] for y in (-0.1, 0.0, 0.1)])
    assert np.ptp(at(axes, pixels, upper), axis=0).max() < 0.02
    assert corners[:, 2].max() == pytest.approx(upper[0, 2])


def test_everything_drawn_is_in_sight(arrows) -> None:
    axes, pixels = drawn(model(table()))
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    # Four feet and a weight.
    assert sorted(colour for *_, colour in arrows) == sorted([FOOT] * 4 + [LOAD])
    for start, end, _ in arrows:
        for x, y in space(axes).camera.project(np.array([start, end])):
            assert left < x < right
            assert bottom < y < top
    assert at(axes, pixels, np.array([0.5 * (a + b) for a, b, colour in arrows if colour == FOOT])) == pytest.approx(
        np.array([to_rgb(FOOT)] * 4), abs=0.1
    )
    box = axes.figure.bbox
    renderer = axes.figure.canvas.get_renderer()
    for text in axes.texts:
        if text.get_text():
            extent = text.get_window_extent(renderer)
            assert box.x0 <= extent.x0 and extent.x1 <= box.x1
            assert box.y0 <= extent.y0 and extent.y1 <= box.y1


def test_written_forces_of_feet_bear_the_weight() -> None:
    furniture = model(table())
    axes, _ = drawn(furniture)
    reported = [float(t.get_text()[:-2]) for t in axes.texts if t.get_text().endswith(" N")]
    weight = (furniture.geometry().mass.sum() + 50.0) * 9.80665
    # Friction takes part in what is written, which is rounded.
    assert sum(reported) == pytest.approx(weight, rel=0.03)
    assert [t.get_text() for t in axes.texts if t.get_text().endswith("kg")] == ["50 kg"]


def test_an_end_state_is_translucent_and_has_arrows(arrows) -> None:
    furniture = model(table())
    one = next(s for s in suggest(furniture).found if s.words == ("leg-4: turn y",))
    axes, pixels = drawn(furniture, DesignDirectionView(one.direction, one.t))
    assert not space(axes).veil.empty
    assert 0.0 < space(axes).opacity < 0.5
    assert len(moves(arrows)) == 1 and near(pixels, MOVED) > 0


def test_a_push_straight_down_is_a_force_not_a_mass() -> None:
    piece = table()
    furniture = model(replace(piece, pushes=(replace(piece.weights[0], name="sit", force=(0.0, 0.0, -600.0)),)))
    axes = new_figure(4.0, 3.5).subplots()
    draw_piece(axes, furniture, case=1)
    written = [text.get_text() for text in axes.texts]
    assert "50 kg" in written and "600 N along \N{MINUS SIGN}z" in written


def test_a_suggestion_has_the_utilisation_of_the_piece_that_it_makes() -> None:
    furniture = model(table(kilograms=50.0))
    one = next(s for s in suggest(furniture).found if s.valid)
    made = model(furniture.moved(one.gamma))
    furniture.test()
    axes, pixels = drawn(furniture, DesignDirectionView(one.direction, one.t), numbers=False)
    (cmap, norm), forces = utilisation_colours(), made.forces(0)
    assert near(drawn(furniture, numbers=False)[1], REFUSED) > 0 and near(pixels, REFUSED) == 0
    seen = at(axes, pixels, made.geometry().p)
    assert seen == pytest.approx(cmap(norm(forces.utilisation))[:, :3], abs=0.02)


def moves(arrows) -> list[tuple[np.ndarray, np.ndarray]]:
    """Start and end of the arrows of what moves."""
    return [(start, end) for start, end, colour in arrows if colour == MOVED]


def test_another_piece_has_an_arrow_for_what_goes_and_none_for_what_is_added(arrows) -> None:
    furniture = model(table())
    piece = furniture.moved()
    still = np.zeros((len(piece.planks), 8))
    (*others, last), along = piece.planks, np.array([0.3, 0.0, 0.0])
    gone = replace(piece, planks=(*others, replace(last, centre=last.centre + along)))
    drawn(furniture, DesignDirectionView(still, piece=gone))
    ((start, end),) = moves(arrows)
    assert end - start == pytest.approx(along)
    arrows.clear()
    added = replace(piece, planks=(*piece.planks, replace(last, name="new", centre=last.centre + along)))
    axes, _ = drawn(furniture, DesignDirectionView(still, piece=added))
    assert moves(arrows) == []
    assert not space(axes).veil.empty


def test_a_short_way_has_an_arrow_that_can_be_seen(arrows) -> None:
    furniture = model(table())
    piece = furniture.moved()
    still = np.zeros((len(piece.planks), 8))
    (*others, last), along = piece.planks, np.array([0.002, 0.0, 0.0])
    near = replace(piece, planks=(*others, replace(last, centre=last.centre + along)))
    axes, _ = drawn(furniture, DesignDirectionView(still, piece=near))
    ((start, end),) = moves(arrows)
    low, high = bounds(piece, near)
    seen = np.diff(space(axes).camera.project(np.array([start, end])), axis=0)
    assert np.linalg.norm(seen) == pytest.approx(WAY * (high - low).max(), rel=0.05)
    assert seen[0, 0] > 0.0


def test_the_arrow_of_a_load_ends_below_what_lies_above_it(arrows) -> None:
    piece = table()
    top = next(plank for plank in piece.planks if plank.name == "top")
    cover = replace(top, name="cover", centre=top.centre + np.array([0.0, 0.0, 0.06]))
    spans = []
    for planks in (piece.planks, (*piece.planks, cover)):
        arrows.clear()
        drawn(model(replace(piece, planks=planks)))
        ((start, end),) = [(start, end) for start, end, colour in arrows if colour == LOAD]
        spans.append(start[2] - end[2])
    free = 0.06 - top.size[2]
    assert spans[0] > free > spans[1] > 0.0


def test_a_range_is_black_where_the_piece_is_valid_and_red_where_not() -> None:
    shown = {}
    for words, make in RANGES.items():
        furniture, direction_view = make()
        axes, _ = drawn(furniture, direction_view)
        shown[words] = {line.get_color() for line in axes.lines if line.get_linewidth() == 3.2}
        # Numbers at both ends are those of the range, in millimetres.
        low, high = direction_view.ranges.intervals[0] * furniture.piece.size * 1e3
        reported = [t.get_text().replace("\N{MINUS SIGN}", "-") for t in axes.texts if t.get_text().endswith(" mm")]
        assert sorted(float(text.removeprefix("beyond ")[:-3]) for text in reported) == pytest.approx(
            [low, high], abs=0.6
        )
    assert [REFUSED in colours for colours in shown.values()] == [False, True]


def test_a_box_holds_all_pieces() -> None:
    one, other = table(), cantilever()
    low, high = bounds(one, other)
    for piece in (one, other):
        for plank in piece.planks:
            assert np.all((plank.corners() >= low - 1e-9) & (plank.corners() <= high + 1e-9))


def test_linear_rays_touch_the_true_ones_at_their_start() -> None:
    for rays in (joint_rays(model(scales()))[0], tipping_rays(model(toppling()))[0]):
        for ray in rays:
            assert ray.true[0] == pytest.approx(ray.linear[0], rel=1e-6, abs=1e-9)
            assert ray.valid.any()
            assert not ray.valid[0]


def test_a_region_is_valid_where_the_full_test_says_so() -> None:
    furniture = model(toppling())
    region = linearised_and_true(furniture, ("foot: length x", "beam: length x"), (-0.1, 0.5), (-0.4, 0.2), 9)
    # The piece as it is falls; with a foot half as long again it stands.
    assert region.kind[np.argmin(np.abs(region.y)), np.argmin(np.abs(region.x))] == 2
    assert region.kind[0, -1] == 0
    assert region.inside[0, -1] > 0.0
    figure = new_figure(4.0, 3.0)
    axes = figure.subplots()
    draw_region(axes, region, "a region")
    assert "[mm]" in axes.get_xlabel() and "[mm]" in axes.get_ylabel()


@pytest.mark.slow
def test_pictures_are_written(tmp_path, capsys) -> None:
    words = ["--out", str(tmp_path / "a"), "--only", "forces", "suggestions", "--piece", "scales"]
    assert main(["furniture-pictures", *words]) == 0
    for name in ("forces", "suggestions"):
        pixels = image.imread(tmp_path / f"a-{name}.png")
        assert pixels.shape[0] > 400
        assert pixels[..., :3].std() > 0.02
    assert main(["furniture-pictures", "--out", str(tmp_path / "a"), "--only", "forces", "--joints", "1", "9"]) == 2
    assert "choose from 0 to 2" in capsys.readouterr().err
    assert (
        main(["furniture-pictures", "--out", str(tmp_path / "a"), "--only", "suggestions", "--piece", "chair-1"]) == 2
    )


def test_names_and_pushes_are_written_where_they_are_wanted() -> None:
    figure = new_figure(4.0, 3.5)
    axes = figure.subplots()
    furniture = model(table())
    names = [plank.name for plank in furniture.piece.planks][:2]
    draw_piece(axes, furniture, names=names)
    every = {plank.name for plank in furniture.piece.planks}
    assert {text.get_text() for text in axes.texts} & every == set(names)
    assert vector_words(np.array([0.0, -60.0, 0.0])) == "60 N along \N{MINUS SIGN}y"
    assert vector_words(np.array([3.0, 0.0, 4.0])) == "(3, 0, 4) N"
