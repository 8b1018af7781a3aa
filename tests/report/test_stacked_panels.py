"""Panels one below the other fill their figure, and nothing of them is cut off or covers something else."""

import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest
from clear_figures import check_figure
from plates import record_plate

from restshape.replay.recording.recording import Recording
from restshape.report import levels, quantity_panels, time_history, timeline
from restshape.report.animation import _nearest
from restshape.report.stacked_panels import stack_panels
from restshape.report.style import new_figure


@pytest.fixture(scope="module")
def plate(tmp_path_factory):
    path = tmp_path_factory.mktemp("panels") / "plate.vtkhdf"
    record_plate(path, frames=24, remesh_every=8)
    return path


@pytest.mark.parametrize(
    ("module", "draw"),
    [(timeline, "draw_timeline"), (quantity_panels, "draw_quantities"), (levels, "draw_levels")],
)
def test_nothing_of_the_pictures_of_a_report_is_cut_off(plate, tmp_path, monkeypatch, module, draw):
    figures = []
    monkeypatch.setattr(module, "save_picture", lambda figure, path: figures.append(figure))
    with Recording(plate) as recording:
        getattr(module, draw)(recording, tmp_path / "picture.png")
    assert len(figures) == 1
    check_figure(figures[0])


def test_a_legend_of_all_kinds_and_huge_numbers_are_not_cut_off(tmp_path, monkeypatch):
    figures, n = [], 8
    monkeypatch.setattr(quantity_panels, "save_picture", lambda figure, path: figures.append(figure))
    refused = np.array(["outside"] + [""] * (n - 1))
    table = {"level": np.arange(n) % 4, "refused": refused, "event": refused, "t": np.arange(n) / 60.0}
    table |= {"iterations": np.ones(n), "index": np.arange(n)}
    for name, values in (("small", np.linspace(1.0, 2.0, n)), ("huge", np.linspace(1e14, 9e14, n))):
        table |= {f"q_{name}": values, f"{name}_error": 0.1 * values, f"{name}_jump": 0.1 * values}
    header = {"title": "all kinds", "limits": {"small": {"max": 1.5}, "huge": {"max": 1e17}}}
    recording = SimpleNamespace(table=table, n=n, header=header, summary="8 frames", path=tmp_path / "a")
    assert quantity_panels.draw_quantities(recording, tmp_path / "picture.png")
    (figure,) = figures
    assert len(figure.legends[0].get_texts()) == 7
    check_figure(figure)
    small, huge = figure.axes
    assert small.get_title(loc="right") == "max 1.5"
    assert huge.get_title(loc="right") == "max 1e+17, beyond the axis"
    assert not huge.yaxis.get_offset_text().get_text()


@pytest.mark.parametrize("values", [(0.0, 1.0), (-1234.5678, -1234.5), (2015.697, 2015.698), (1e-3, 5e-3)])
@pytest.mark.parametrize("name", ["", "[MPa]", "displacement of\nthe upper end\n[mm]"])
def test_numbers_beside_an_axis_have_room(values, name):
    figure = new_figure(10.0, 4.0)
    panels = figure.subplots(2, 1, sharex=True)
    for axes in panels:
        axes.plot([0, 1], values)
        axes.ticklabel_format(axis="y", useOffset=False)
        axes.set(ylabel=name)
    panels[-1].set_xlabel("frame")
    figure.suptitle("a title", x=0.01, ha="left")
    figure.legend(panels[0].get_lines(), ["a line"], loc="lower center")
    stack_panels(figure, panels, (1, 2), (0.0, time_history.GAP), rows=1)
    check_figure(figure)
    heights = [axes.get_position().height for axes in panels]
    assert heights[1] == pytest.approx(2.0 * heights[0])


@pytest.mark.cli
def test_a_report_of_a_shape_in_the_plane_loads_no_solver(plate, tmp_path):
    """Its pictures are drawn from the recording alone: neither kernels nor PETSc nor gmsh need to start."""
    words = ["report", str(plate), "--out", str(tmp_path / "out"), "--animation", "none", "--frames", "1"]
    code = (
        f"import sys; from restshape.cli.main import main; main({words!r}); "
        "print([name for name in ('restshape._kernels', 'petsc4py.PETSc', 'gmsh', 'scipy') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"


def test_colours_of_an_animation_are_the_nearest_of_its_palette():
    generator = np.random.default_rng(3)
    palette = generator.integers(0, 256, (256, 3), dtype=np.uint8)
    nearest = _nearest(palette)
    channel = np.arange(32) * 255 / 31
    for index in generator.integers(0, 32**3, 500):
        colour = channel[[index >> 10, index >> 5 & 31, index & 31]]
        away = ((palette - colour) ** 2).sum(axis=1)
        assert away[nearest[index]] == pytest.approx(away.min(), abs=0.1)
