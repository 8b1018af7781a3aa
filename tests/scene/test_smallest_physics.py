"""The smallest physics of docs/add-a-physics.md: a disc in closed form, reuse, estimates, messages."""

from dataclasses import replace

import numpy as np
import pytest
from restshape_studies.stability.scenery import across, drag, make_replay, rows_of, write_scene, write_script
from sample_applications.film import FILM, Film, application

from restshape.analysis.static.steady import SteadyAnalysis
from restshape.cli.main import main
from restshape.errors import UserError
from restshape.fem.problem import Fields
from restshape.interface.first_frame import first_frame
from restshape.replay.parity import Parity
from restshape.scene.load import load_scene
from restshape.scene.physics import PictureField

DISC = """
format = "restshape-scene"
version = 1
app = "film"
[shape]
outline = ["e1", "e2"]
vertices = { a = ["10 cm", 0], b = ["-10 cm", 0] }
[shape.edges]
e1 = { arc = ["a", "b"], bulge = 1 }
e2 = { arc = ["b", "a"], bulge = 1 }
[shape.holes.wire]
circle = { center = ["5 cm", 0], radius = "1 cm" }
[material.soap]
tension = "50 mN/m"
[supports.ring]
on = "outline"
fix = { w = 0 }
[loads.air]
on = "all"
blown = "2 Pa"
[mesh]
size = "8 mm"
order = 2
[quantities]
top = { height = true }
"""


@pytest.mark.parametrize(("order", "bound"), [(1, 1e-2), (2, 1e-4)])
def test_a_disc_bulges_as_a_paraboloid(tmp_path, install, order, bound):
    install(application)
    text = DISC.replace("[shape.holes.wire]", "").replace('circle = { center = ["5 cm", 0], radius = "1 cm" }', "")
    replay = first_frame(write_scene(tmp_path, text.replace("order = 2", f"order = {order}")), [])
    # w = p (R^2 - r^2) / (4 T)
    assert replay.row["q_top"] == pytest.approx(2 * 0.1**2 / (4 * 0.05), rel=bound)
    X, x = replay.analysis.space.X, replay.analysis.x[:, 0]
    np.testing.assert_allclose(x, 2 * (0.1**2 - (X**2).sum(axis=1)) / (4 * 0.05), atol=bound * 0.1)
    assert 0 < replay.analysis.errors()["estimate"] < 0.2


@pytest.mark.slow
def test_reuse_recordings_and_messages_come_with_it(tmp_path, install):
    install(application)
    scene = write_scene(tmp_path, DISC + "[solve]\ntolerance = 1e-9\n")
    script = write_script(tmp_path, drag("wire", (0.05, 0), across((0.05, 0), (-0.03, 0.02), 6)))
    made = make_replay(scene, script)
    check = Parity(made)
    rows = rows_of(made, lambda row: check())
    assert len(rows) == 9 and check.entries < 1e-12 and check.solution < 1e-6
    out = tmp_path / "out.vtkhdf"
    assert main(["replay", str(scene), "--edits", str(script), "--out", str(out)]) == 0
    assert main(["report", str(out)]) == 0
    with pytest.raises(UserError, match="a stiffness is wanted"):
        load_scene(write_scene(tmp_path, DISC.replace("50 mN/m", "50 mPa")))


@pytest.mark.parametrize(
    ("path", "what", "do"),
    [
        (
            "restshape.analysis.static.steady:SteadyAnalysys",
            "has no 'SteadyAnalysys'",
            "did you mean 'SteadyAnalysis'?",
        ),
        ("restshape.analysis.stedy:SteadyAnalysis", "no module 'restshape.analysis.stedy'", "mend the path"),
    ],
)
def test_a_misspelt_path_of_an_analysis_names_application_path_and_what_there_is(
    tmp_path, install, command, path, what, do
):
    install(replace(application, analysis=path))
    done = command("replay", write_scene(tmp_path, DISC))
    assert done.returncode == 2 and f"the application 'film' names '{path}'" in done.stderr
    assert what in done.stderr and do in done.stderr


class Misspelt(Film):
    """A film whose field has another name than its unknown."""

    def fields(self, x: np.ndarray) -> Fields:
        return {"heigth": x[:, 0]}, {}


def misspelt_analysis(*arguments) -> SteadyAnalysis[Misspelt]:
    return SteadyAnalysis(*arguments, Misspelt)


HEIGTH = replace(FILM, pictured={"heigth": PictureField("height", "m")})


@pytest.mark.parametrize(
    ("changes", "what"),
    [
        (
            {"analysis": f"{__name__}:misspelt_analysis"},
            "the problem of film gives the fields heigth ({n},), and declares height ({n},)",
        ),
        ({"physics": (HEIGTH,)}, "'film' declares pictures of the field 'heigth', and its problem has height"),
    ],
)
def test_fields_that_are_not_declared_end_the_replay(tmp_path, install, command, changes, what):
    install(application)
    scene = write_scene(tmp_path, DISC)
    n = len(first_frame(scene).analysis.space.X)
    assert command("replay", scene).returncode == 0
    install(replace(application, **changes))
    done = command("replay", scene)
    assert done.returncode == 2 and what.format(n=n) in done.stderr
