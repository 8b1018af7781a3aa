"""What the first frame of a replay refuses, `restshape check` refuses in the same words."""

import pytest
from cloths import CONTACT, PIN, write_cloth
from modal import SCENES
from small_scenes import plate, write_scene

from restshape.cli.main import main

CORE = "shape.regions.core={circle={center=[5,5],radius=2}}"
ALLOY = 'material.alloy={region="core",E="70 GPa",nu=0.33'


@pytest.fixture
def refused(capsys):
    """What both commands say of a scene with these overrides, having failed with 2."""

    def ran(scene, *overrides: str) -> str:
        said = []
        for command in ("check", "replay"):
            assert main([command, str(scene), *(word for one in overrides for word in ("--set", one))]) == 2
            err = capsys.readouterr().err
            said.append(err[err.index(f"restshape {command}: ") + len(f"restshape {command}: ") :])
        assert said[0] == said[1]
        return said[0]

    return ran


@pytest.mark.parametrize(
    ("overrides", "what"),
    [
        ((CORE, ALLOY + ',rho=2700,thickness="60 mm"}'), "the materials of a solid or a plate have one thickness"),
        ((CORE, ALLOY + ',thickness="50 mm"}'), "material.alloy: a body without density cannot vibrate"),
        (
            ('effects.modal.model="plane_stress"', "material.steel.thickness='0.05 + 0.001*x'"),
            "a plane solid has one thickness",
        ),
        (('supports.rim={on="bottom",fix={z="1 mm"}}',), "what a support prescribes has no meaning"),
        (('quantities.size={area=true,at="bottom"}',), "'bottom' holds no cell of the mesh"),
        (('quantities.sag={displacement="y",at="a"}',), "modes have no displacement"),
    ],
)
def test_of_free_vibrations(refused, overrides, what):
    assert what in refused(SCENES / "square.toml", *overrides)


@pytest.mark.parametrize(
    ("quantity", "what"),
    [
        ('{ energy = "kinetic" }', "a solid in static equilibrium has no 'kinetic' energy"),
        ('{ energy = "strain", at = "right" }', "'right' holds no cell of the mesh"),
    ],
)
def test_of_energies_of_solids(refused, tmp_path, quantity, what):
    scene = write_scene(tmp_path, plate().replace("[quantities]", f"[quantities]\nq = {quantity}"))
    assert what in refused(scene)


@pytest.mark.parametrize("kind", ["energies", "folds"])
def test_of_cloth(refused, tmp_path, kind):
    what = 'energy = "membrane"' if kind == "energies" else "folds = true"
    scene = write_cloth(tmp_path, PIN, CONTACT, f'[quantities]\nq = {{ {what}, at = "left" }}\n')
    assert f"{kind} of cloth are those of all of it" in refused(scene)


LARGE = ("effects.large_deformation={}", "mesh.order=2")


def test_errors_that_are_not_estimated(refused, tmp_path):
    """Of what is not linear, and of what goes on in time; each quantity that asks for its own."""
    what = "errors are estimated in symmetric steady linear scenes"
    scene = write_scene(tmp_path, plate())
    assert what in refused(scene, *LARGE, "quantities.stretch.error=true")
    assert main(["check", str(scene), "--set", "quantities.stretch.error=true"]) == 0
    assert (
        main(["check", str(scene), *(word for one in (*LARGE, "quantities.error=true") for word in ("--set", one))])
        == 0
    )


def test_jumps_that_cannot_be_estimated(refused, tmp_path):
    """And errors: cloth that has several rests has neither."""
    scene = write_cloth(tmp_path, PIN)
    assert "what the mesh alone does cannot be estimated" in refused(scene, "solve.jumps=true")
    assert "errors are estimated in" in refused(scene, 'quantities.q={displacement="z",at="left",error=true}')


def moving(*effects):
    """A plate in motion."""
    text = plate().replace('app = "plane"', 'app = "moving"') + "[effects.dynamics]\ntime_step = 2e-4\n"
    return text + "[effects.ground]\nacceleration = 50\nfrequency = 100\n" + "".join(effects)


def test_bodies_in_motion_without_density(tmp_path, capsys):
    """Each material that fills some of the body needs one; that of the rest does not where regions leave nothing."""
    scene = str(write_scene(tmp_path, moving()))
    core = 'shape.regions={core={polygon=[["1.2","0.2"],["1.6","0.2"],["1.6","0.4"]]}}'
    whole = 'shape.regions={core={loop=["bottom","right","top","left"]}}'
    heavy, light = (f'material.pad={{E=2e11,nu=0.3,rho={rho},thickness="10 mm",region="core"}}' for rho in (8000, 0))
    for words, code in (
        ([core, heavy], 0),
        ([core, light], 2),
        ([core, heavy, "material.steel.rho=0"], 2),
        ([whole, heavy, "material.steel.rho=0"], 0),
    ):
        sets = [word for one in words for word in ("--set", one)]
        assert [main([command, scene, *sets]) for command in ("check", "replay")] == [code, code]
        assert ("a body without density cannot vibrate" in capsys.readouterr().err) == (code == 2)


def test_a_goal_and_a_direction_that_are_not_there(refused, tmp_path):
    """With what to do about each."""
    said = refused(write_scene(tmp_path, plate()), 'quantities.far={distance="arch",at="top"}')
    assert "there is no goal 'arch'" in said and "add [goal.arch]" in said
    said = refused(write_scene(tmp_path, moving("direction = [0, 0]\n")))
    assert "the direction has no length" in said and "direction = [1, 0]" in said
