"""Pictures show the stress that quantities report: its values, its place, its range over all frames, its limit."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from small_scenes import (
    BLOCK,
    CLAMPED,
    HEAD,
    HOLE,
    PULLED,
    STEEL,
    across,
    block,
    drag,
    make_replay,
    meshed,
    rows_of,
    write_scene,
    write_script,
)

from restshape.cli.main import main
from restshape.cli.quantity_tables import percent
from restshape.errors import UserError
from restshape.replay.recording.recording import Recording
from restshape.replay.singular_notes import marked
from restshape.report import frames
from restshape.report.drawing import Drawing
from restshape.report.field import limits_of, shown_field
from restshape.report.frames import caption
from restshape.report.happenings import chosen_frames, failure, utilisations, worst_frame
from restshape.report.marks import marks
from restshape.report.quantity_panels import draw_quantities, least_span
from restshape.report.scenery import Scenery, scenery
from restshape.report.smooth import smooth_triangles
from restshape.report.survey import survey
from restshape.scene.physics import PictureField

LIMITED = """
[quantities]
stretch = { displacement = "x", at = "right" }
peak = { stress = "von_mises", at = "window", max = "200 MPa", error = false }
whole = { stress = "von_mises" }
across = { stress = "yy", at = "right", reduce = "min" }
"""
PLATE = HEAD + BLOCK.format(width=2, height=1) + HOLE + STEEL + CLAMPED + PULLED + LIMITED
EVENTS = [
    *drag("window", (0.5, 0.5), across((0.5, 0.5), (0.56, 0.5), 3)),
    {"do": "scale", "on": "window", "factor": 1.8, "frames": 3},
    {"do": "scale", "on": "window", "factor": 9, "frames": 1},
]


@pytest.fixture(scope="module", params=[1, 2])
def recorded(request, tmp_path_factory):
    """A recording of a plate whose hole moves and grows, the last time beyond the edge, which is refused."""
    folder = tmp_path_factory.mktemp("shown")
    scene, script = write_scene(folder, PLATE + meshed(0.14)), write_script(folder, EVENTS)
    out = folder / "out.vtkhdf"
    words = ["--set", f"mesh.order={request.param}"]
    assert main(["replay", str(scene), "--edits", str(script), "--out", str(out), *words]) == 0
    with Recording(out) as recording:
        yield recording


@pytest.mark.slow
def test_quantities_are_in_the_field_that_is_shown(recorded):
    field = shown_field(recorded)
    assert field.name == "von_mises"
    for i in np.flatnonzero(recorded.table["refused"] == ""):
        X, cells = recorded.mesh(i)
        values = field.values(recorded, i)
        assert values.shape == cells.shape and values.max() == recorded.table["q_whole"][i]
        peak, whole = marks(recorded, i, field, cells)
        x, y = X[whole.node]
        assert values[cells == whole.node].max() == values.max() and "whole" in whole.text
        assert values[cells == peak.node].max() == pytest.approx(recorded.table["q_peak"][i], rel=1e-12)
    # The frames before the last lie on the ring of the hole, whose middle is at 0.56 m in the end.
    x, y = recorded.points(8)[marks(recorded, 8, field, recorded.cells(8))[0].node]
    assert np.hypot(x - 0.56, y - 0.5) == pytest.approx(0.15 * 1.8, rel=1e-6)


def test_a_component_is_shown_where_it_is_asked_for(recorded):
    field = shown_field(recorded, "stress_yy")
    (mark,) = marks(recorded, 0, field, recorded.cells(0))
    assert mark.text.startswith("across") and recorded.points(0)[mark.node][0] == pytest.approx(2.0)
    with pytest.raises(UserError, match="no field 'heat'"):
        shown_field(recorded, "heat")


def test_a_part_of_a_body_with_one_stress_everywhere_has_no_mark_elsewhere(tmp_path):
    """A pull without a support across gives one stress: that at a corner is not marked at another node."""
    held = '\n[supports.wall]\non = "left"\nfix = ["x"]\n\n[supports.pin]\non = "a"\nfix = ["x", "y"]\n'
    asked = '\n[quantities]\nerror = true\natc = { stress = "von_mises", at = "c" }\n'
    scene = write_scene(tmp_path, HEAD + block(2, 1) + STEEL + held + PULLED + asked + meshed(0.5))
    out = tmp_path / "out.vtkhdf"
    assert main(["replay", str(scene), "--out", str(out)]) == 0
    with Recording(out) as recording:
        field, words = shown_field(recording, "von_mises"), caption(recording, 0, scenery(recording), 200)
        flat = field.values(recording, 0)
        assert np.ptp(flat) < 1e-9 * flat.max()
        assert not any(mark.text.startswith("atc") for mark in marks(recording, 0, field, recording.cells(0)))
    # What rounding leaves of the estimated error is none.
    assert "error 0 %" in words


def test_the_error_of_a_marked_value_is_named_as_such():
    """What stands behind ± in notes on limits is twice that."""
    header = {"scene_values": {"quantities": {"peak": {"stress": "von_mises"}}}}
    recording = SimpleNamespace(header=header, table={"q_peak": [5e6], "peak_error": [2.5e5]}, n=1)
    values = np.arange(6.0).reshape(2, 3) * 1e6
    look = PictureField("von Mises stress", "Pa")
    field = SimpleNamespace(values=lambda *_: values, look=look, quantity_of=lambda *_: True)
    (mark,) = marks(recording, 0, field, np.arange(6).reshape(2, 3))
    assert mark.text == "peak 5 MPa (error 250 kPa)"


def test_a_field_that_is_0_everywhere_has_no_largest_place():
    table = SimpleNamespace(header={}, table={}, n=1)
    for values, count in ((np.zeros((2, 3)), 0), (np.arange(6.0).reshape(2, 3), 1)):
        field = SimpleNamespace(values=lambda *_, found=values: found, look=PictureField("von Mises stress", "Pa"))
        assert len(marks(table, 0, field, np.arange(6).reshape(2, 3))) == count


def test_an_error_that_is_rounding_is_shown_as_0():
    assert percent(2.2e-14) == "0 %" and percent(2.2e-4) == "0.022 %"


def test_colours_are_those_of_all_frames(recorded):
    common = scenery(recorded)
    assert (common.bottom, common.top) == (0.0, np.nanmax(recorded.table["q_whole"]))
    assert common.beyond == "neither"
    named = scenery(recorded, limits=(90e6, 100e6))
    assert (named.bottom, named.top, named.beyond) == (90e6, 100e6, "both")


def test_a_singular_stress_lies_beyond_the_colours_and_a_rare_frame_does_not(recorded):
    field = shown_field(recorded)
    seen = survey(recorded, field)
    shown = np.isfinite(seen.top)
    seen.top[np.flatnonzero(shown)[0]] = 100.0 * seen.usual[shown].max()
    from restshape.report.survey import colour_range

    assert colour_range(field, seen)[1] == seen.usual[shown].max()
    # A frame in which all is three times as high has colours of its own right.
    seen.usual[np.flatnonzero(shown)[0]] = 90.0 * seen.usual[shown].max()
    assert colour_range(field, seen)[1] == seen.top[shown].max()
    # But the first frame of a motion that is set off at once is far above all others.
    set_off = replace(seen, start=1)
    assert shown[0] and colour_range(field, set_off)[1] == seen.top[shown][1:].max()


def test_the_worst_frame_and_those_that_fail_are_shown_and_say_so(recorded):
    used, peak = utilisations(recorded)["peak"], recorded.table["q_peak"]
    np.testing.assert_allclose(used, peak / 200e6, rtol=1e-12)
    assert limits_of(recorded) == {"peak": {"max": 200e6}}
    worst, words = worst_frame(recorded)
    assert worst == np.nanargmax(peak) and "% of its limit" in words
    chosen, last = chosen_frames(recorded, 6), recorded.n - 1
    assert {0, worst, last} <= set(chosen) and recorded.table["refused"][last]
    common = scenery(recorded)
    for i in range(recorded.n):
        fails = recorded.table["constraint_status"][i] == "fails"
        text = failure(recorded, i)
        assert text.startswith("REFUSED" if recorded.table["refused"][i] else "LIMIT VIOLATED" if fails else "")
        assert bool(text) == bool(fails or recorded.table["refused"][i])
        assert text in caption(recorded, i, common, 500)
    assert any(recorded.table["constraint_status"] == "fails") and not common.seen.solved[last]


def test_the_drawn_body_ends_where_the_deformed_shape_does(recorded):
    common = scenery(recorded, scale=100.0)
    drawing = Drawing(Figure().subplots(), common)
    drawing.show(recorded, 0)
    places, factor = drawing.body._triangulation, common.unit[0]
    x = factor * (recorded.points(0) + 100.0 * recorded.field(0, "displacement"))
    assert places.x.max() == pytest.approx(x[:, 0].max(), rel=1e-12)
    assert drawing.body.get_array().max() <= common.colour[0] * recorded.table["q_whole"][0] * 1.1
    ring = next(ring for ring in drawing.marks if ring.get_marker() == "s")
    assert np.abs(x - np.ravel(ring.get_data())).sum(axis=1).min() < 1e-12


def test_small_triangles_follow_quadratic_sides_and_fields():
    x = np.array([[0, 0], [1, 0], [0, 1], [0.5, -0.25], [0.5, 0.5], [0, 0.5]])
    cells = np.arange(6)[None]
    straight = np.array([[0, 0], [1, 0], [0, 1], [0.5, 0], [0.5, 0.5], [0, 0.5]])
    s, t = straight.T
    field = 1 + s - 2 * t + 3 * s * s + s * t - t * t
    places, triangles, values = smooth_triangles(x, cells, field[None])
    flat, _, _ = smooth_triangles(straight, cells, field[None])
    s, t = flat.T
    np.testing.assert_allclose(values, 1 + s - 2 * t + 3 * s * s + s * t - t * t, atol=1e-14)
    side = np.abs(t) < 1e-14
    np.testing.assert_allclose(places[side, 1], -s[side] * (1 - s[side]), atol=1e-14)
    a, b, c = (flat[triangles[:, k]] for k in range(3))
    areas = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    assert areas.min() > 0 and areas.sum() == pytest.approx(0.5)


REGIONS = """
[material.soft]
E = "1 GPa"
nu = 0.3
thickness = "10 mm"
region = "disc"

[shape.regions.disc]
circle = { center = [1, 0.5], radius = 0.2 }
"""


def test_stresses_jump_between_regions(tmp_path):
    text = HEAD + block(2.0, 1.0) + REGIONS + STEEL + CLAMPED + PULLED
    text += '[quantities]\ninside = { stress = "von_mises", at = "disc" }\nwhole = { stress = "von_mises" }\n' + meshed(
        0.12
    )
    out = tmp_path / "out.vtkhdf"
    assert main(["replay", str(write_scene(tmp_path, text)), "--out", str(out)]) == 0
    with Recording(out) as recording:
        field, cells = shown_field(recording), recording.cells(0)
        values = field.values(recording, 0)
        middle = recording.points(0)[cells].mean(axis=1)
        inside = np.hypot(middle[:, 0] - 1.0, middle[:, 1] - 0.5) < 0.2
        assert values[inside].max() == recording.table["q_inside"][0]
        assert values.max() == recording.table["q_whole"][0]
        # A node of the border has one value on each side.
        shared = np.intersect1d(cells[inside], cells[~inside])
        steps = [np.ptp(values[cells == node]) for node in shared]
        assert len(shared) > 5 and min(steps) > 0.1 * np.median(values)


LARGE = "[effects.large_deformation]\n"


@pytest.mark.slow
def test_large_deformations_are_never_exaggerated(tmp_path, capsys):
    out = tmp_path / "out.vtkhdf"
    text = PLATE.replace("[quantities]", LARGE + "[quantities]") + meshed(0.3)
    assert main(["replay", str(write_scene(tmp_path, text)), "--out", str(out)]) == 0
    with Recording(out) as recording:
        common = scenery(recording)
        assert common.scale == 1.0 and common.deformation.startswith("true deformation")
    assert main(["report", str(out), "--scale", "5"]) == 2
    assert "not exaggerated" in capsys.readouterr().err


def test_error_estimates_and_quantities_share_one_recovery(tmp_path):
    """The estimate of shared stresses is that of its own ones, which differ in what does not count."""
    from restshape.fem.error_estimate import RecoveryEstimate

    replay = make_replay(write_scene(tmp_path, PLATE + meshed(0.2)))
    rows_of(replay)
    problem, x = replay.analysis.problem, replay.analysis.x
    shared = problem.error_estimate()
    own = RecoveryEstimate(shared.space, shared.flux, shared._compliance, shared.stiffest)
    assert shared.shared is problem.nodal_stress and own.shared is None
    assert shared.relative(x) == pytest.approx(own.relative(x), rel=1e-13)


def test_quantities_over_the_edit_have_gaps_limits_and_marks(recorded, tmp_path, monkeypatch):
    figures = []
    monkeypatch.setattr("restshape.outputs.picture_files.write_figure", lambda figure, *_: figures.append(figure))
    assert draw_quantities(recorded, tmp_path / "quantities.png")
    panels = {axes.get_title(loc="left"): axes for axes in figures[0].axes}
    assert list(panels) == ["peak", "stretch", marked("whole", {"whole": 0.7}), "across"]
    stopped = recorded.table["refused"] != ""
    for name, axes in panels.items():
        x, y = axes.lines[0].get_data()
        assert np.array_equal(np.isnan(y), stopped) and np.array_equal(x, np.arange(recorded.n))
        size = np.nanmax(np.abs(y)) / np.nanmax(np.abs(recorded.table[f"q_{name.split()[0]}"]))
        np.testing.assert_allclose(y[~stopped], size * recorded.table[f"q_{name.split()[0]}"][~stopped], rtol=1e-12)
        assert round(float(np.log10(size)), 9) in (-6.0, -3.0, 3.0) and axes.get_ylabel() in ("[MPa]", "[mm]", "[kPa]")
        assert any(0 in line.get_xdata() for line in axes.lines if line.get_marker() == "s")
    crosses = next(line for line in panels["peak"].lines if line.get_marker() == "x" and len(line.get_xdata()))
    assert np.array_equal(crosses.get_xdata(), np.flatnonzero(recorded.table["constraint_status"] == "fails"))
    dashed = [line for line in panels["peak"].lines if line.get_linestyle() == "--" and len(line.get_xdata())]
    assert {float(line.get_ydata()[0]) for line in dashed} == {200.0}
    assert panels["peak"].get_title(loc="right") == "max 200 MPa"


def test_small_pure_numbers_have_a_power_of_ten_in_their_label():
    """Strains of 1.5e-4, whose numbers would else push the label out of the picture."""
    seen = SimpleNamespace(bottom=np.array([-1.5e-4]), top=np.array([1.5e-4]))
    field = SimpleNamespace(look=PictureField("strain xy, shear", "", signed=True))
    for size, factor, label in ((1.5e-4, 1e6, " [10⁻⁶]"), (0.2, 1.0, ""), (2.5e5, 1e-3, " [10³]")):
        common = Scenery(1.0, False, (0.0, 1.0, 0.0, 1.0), field, -size, size, seen)
        assert common.colour == (pytest.approx(factor), f"strain xy, shear{label}")
        figure, _, bar = frames._panels(frames.layout(1, 1.0), ["frame 0"], ["ring"])
        frames.add_colour_bar(figure, bar, SimpleNamespace(header={}, table={}, n=1), common)
        canvas = FigureCanvasAgg(figure)
        canvas.draw()
        assert bar.get_tightbbox(canvas.get_renderer()).x1 <= canvas.get_width_height()[0]


def test_rounding_of_a_quantity_that_stays_is_not_drawn_as_a_change():
    axes = Figure().subplots()
    axes.plot([1e6, 1e6 + 0.1])
    least_span(axes, 1e6, 1e6 + 0.1)
    bottom, top = axes.get_ylim()
    assert top - bottom >= 99.0 and bottom < 1e6 < top
