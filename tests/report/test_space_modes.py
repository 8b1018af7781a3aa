"""Modes in space: closed bodies of the right thickness, what is told apart, what is in sight, and one period."""

import numpy as np
import pytest
from matplotlib.colors import to_hex
from PIL import Image

from restshape.outputs.kinds import PeriodFile
from restshape.report import mode_period
from restshape.report.bent_plate import LARGEST, FlatBody
from restshape.report.mode_period import draw_period
from restshape.report.space_modes import ModeView, SpaceMode, body_drawing, draw_space_modes
from restshape.report.style import UNTRUSTED


def ring(n=12, thickness=0.1):
    """A square of 2 by 2 with a square hole, of first-order triangles."""
    x = np.linspace(-1.0, 1.0, n + 1)
    X = np.stack(np.meshgrid(x, x), axis=-1).reshape(-1, 2)
    first = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    quads = np.stack([first, first + 1, first + n + 2, first + n + 1], axis=1)
    middle = X[quads].mean(axis=1)
    quads = quads[np.abs(middle).max(axis=1) > 0.5]
    # Every other triangle is turned: the body turns them back.
    return FlatBody(X, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 3, 2]]]), np.full(len(X), thickness))


def volume(places, faces):
    a, b, c = (places[faces[:, k]] for k in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0


def sides_of(faces):
    ends = np.concatenate([faces[:, [i, (i + 1) % 3]] for i in range(3)])
    return {tuple(pair) for pair in ends.tolist()}, len(ends)


def test_the_surface_is_closed_and_holds_the_volume_of_the_body():
    body = ring()
    places, faces = body.surface(np.zeros((len(body.X), 3)))
    assert volume(places, faces) == pytest.approx(3.0 * 0.1)
    # Each side is gone along once in either direction.
    pairs, count = sides_of(faces)
    assert len(pairs) == count and {pair[::-1] for pair in pairs} == pairs
    outline = body.outline()
    assert np.linalg.norm(np.diff(outline, axis=1), axis=2).sum() == pytest.approx(8.0 + 4.0)


def test_a_bent_body_keeps_its_thickness_along_its_normals():
    body = ring()
    turned = np.zeros((len(body.X), 3))
    turned[:, 2] = 0.75 * body.X[:, 0]
    places, _ = body.surface(turned)
    used = np.unique(body.cells)
    across = places[used] - places[used + len(body.X)]
    np.testing.assert_allclose(across, np.broadcast_to([-0.06, 0.0, 0.08], across.shape), atol=1e-12)


def test_second_order_cells_are_drawn_by_their_quarters():
    X = np.array([[0, 0], [2, 0], [0, 2], [1, -0.2], [1, 1], [0, 1.0]])
    body = FlatBody(X, np.array([[0, 1, 2, 3, 4, 5]]), np.full(6, 0.1))
    assert len(body.triangles) == 4 and len(body.sides) == 6
    places, faces = body.surface(np.zeros((6, 3)))
    # The side through (1, -0.2) adds a triangle of 2 by 0.2.
    assert volume(places, faces) == pytest.approx(0.1 * (2.0 + 0.2))


def mode(body, way, normal):
    shape = np.zeros((len(body.X), 3))
    shape[:, way] = body.X[:, 0] - 0.3
    return SpaceMode(shape, normal, f"mode along {'xyz'[way]}")


def test_the_largest_motion_is_drawn_alike_for_any_amplitude():
    body = ring()
    for factor in (1e-9, 1.0, 1e9):
        most = np.linalg.norm(body.drawn(factor * mode(body, 2, 1.0).shape), axis=1).max()
        assert most == pytest.approx(LARGEST * np.sqrt(8.0))


def test_modes_in_the_plane_have_other_colours_and_words(tmp_path, monkeypatch):
    figures = []
    monkeypatch.setattr("restshape.outputs.picture_files.write_figure", lambda figure, *_: figures.append(figure))
    body = ring()
    modes = [mode(body, 2, 0.98), mode(body, 1, 0.02)]
    draw_space_modes(tmp_path / "a.png", body, modes, "ring")
    words = {text.get_text(): to_hex(text.get_color()) for axes in figures[0].axes for text in axes.texts}
    assert words["in the plane: a blow hardly sounds it"] == UNTRUSTED != words["perpendicular: a blow sounds it"]
    labels = [axes.get_xlabel() for axes in figures[0].axes[2:]]
    assert labels[0].startswith("deflection") and labels[1].startswith("size of the motion in the plane")
    # Signed: blue at one end and red at the other; sizes are 0 where it stands still.
    signed, size = (one.colours() for one in modes)
    low, high = int(np.argmin(body.X[:, 0])), int(np.argmax(body.X[:, 0]))
    assert signed[low, 2] > signed[low, 0] and signed[high, 0] > signed[high, 2]
    still = int(np.argmin(np.abs(body.X[:, 0] - 0.3)))
    assert size[still].sum() < size[high].sum() < size[low].sum()


def test_all_that_is_drawn_is_in_sight():
    body = ring()
    one = mode(body, 2, 1.0)
    view = ModeView.of(body, [one], (1.0, -1.0))
    left, right, bottom, top = view.window
    for part in (1.0, -1.0):
        seen = view.camera.project(body.surface(part * body.drawn(one.shape))[0])
        assert (seen > [left, bottom]).all() and (seen < [right, top]).all()
    pixels = body_drawing(body, one).pixels(view.camera, view.window, 60, 40)
    # Nothing at the rim, much inside, and the hole is seen through.
    assert (
        (pixels[[0, -1]] == 1.0).all() and (pixels[:, [0, -1]] == 1.0).all() and (pixels < 1.0).any(axis=2).mean() > 0.3
    )


def test_a_period_moves_there_and_back(tmp_path, monkeypatch):
    monkeypatch.setattr(mode_period, "PICTURES", 4)
    body, path = ring(6), tmp_path / "mode.gif"
    draw_period(path, body, mode(body, 2, 1.0), 440.0, "ring")
    with Image.open(path) as moving:
        pictures = []
        for k in range(moving.n_frames):
            moving.seek(k)
            pictures.append(np.asarray(moving.convert("RGB")).astype(int))
        assert moving.info["loop"] == 0
    # After a quarter and three quarters it is as at rest, but for the rounding of colours.
    assert len(pictures) == 4 and np.abs(pictures[0] - pictures[2]).mean() > 5.0
    assert np.abs(pictures[1] - pictures[3]).mean() < 0.5
    assert PeriodFile(path).ours()
    foreign = tmp_path / "foreign.gif"
    Image.new("P", (2, 2)).save(foreign)
    assert not PeriodFile(foreign).ours()
