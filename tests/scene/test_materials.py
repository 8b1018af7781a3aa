"""Materials by name: what a name brings, what is given besides, and what is refused."""

from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError

from restshape.errors import UserError
from restshape.physics.cloth.cloth_declaration import CLOTH
from restshape.physics.cloth.sheet.cloth_material_keys import CLOTH_MATERIALS
from restshape.physics.elasticity.elasticity_declaration import FREE_VIBRATIONS, PLANE_SOLIDS
from restshape.physics.elasticity.elasticity_material_keys import ELASTIC_MATERIALS, ElasticMaterial
from restshape.physics.elasticity.stiffness import isotropic, orthotropic, plane_stress, stiffness_of, turned
from restshape.scene.expressions import Expression
from restshape.scene.load import load_scene
from restshape.scene.materials import LIBRARY, sources
from restshape.scene.model import Material
from restshape.scene.scene_type import material_type


def material(**keys) -> ElasticMaterial:
    return material_type(ElasticMaterial, ELASTIC_MATERIALS).model_validate(keys)


@pytest.mark.parametrize("name", ELASTIC_MATERIALS)
def test_a_name_is_enough(name):
    found = material(name=name)
    assert 500 < found.rho < 20000
    assert np.linalg.eigvalsh(stiffness_of(found)).min() > 0
    assert len(ELASTIC_MATERIALS[name]["source"]) > 20


def test_where_no_material_is_known_a_name_is_refused():
    with pytest.raises(ValidationError, match="no material is known by a name"):
        Material.model_validate({"name": "steel"})


@pytest.mark.parametrize("physics", [PLANE_SOLIDS, FREE_VIBRATIONS], ids=lambda one: one.name)
def test_solids_and_plates_know_the_same(physics):
    assert physics.materials is ELASTIC_MATERIALS


def test_cloth_knows_fabrics_besides():
    fabrics = set(CLOTH_MATERIALS) - set(ELASTIC_MATERIALS)
    assert CLOTH.materials is CLOTH_MATERIALS and set(ELASTIC_MATERIALS) < set(CLOTH_MATERIALS)
    assert fabrics == {"soft cloth", "dress cloth", "interlock", "denim", "trouser cloth", "polyester cloth"}


def test_steel_is_that_of_the_standard():
    steel = material(name="steel")
    assert (steel.E, steel.nu, steel.rho) == (210e9, 0.3, 7850.0)


def test_what_is_given_comes_before_the_name():
    steel = material(name="steel", E="200 GPa")
    assert (steel.E, steel.nu, steel.rho) == (200e9, 0.3, 7850.0)
    wood = material(name="rosewood", rho=900, orthotropic={"E": ["20 GPa", "2 GPa", "1 GPa"]})
    assert wood.rho == 900 and wood.orthotropic.E == (20e9, 2e9, 1e9)
    assert wood.orthotropic.G == material(name="rosewood").orthotropic.G


def test_a_rosewood_bar_and_a_steel_bar():
    """sqrt(E/rho), the speed of waves along a bar: 4000 to 4800 m/s in rosewood along its grain, 5172 m/s in steel."""
    wood = material(name="rosewood")
    assert 4000 < np.sqrt(wood.orthotropic.E[0] / wood.rho) < 4800
    steel = material(name="steel")
    assert np.sqrt(steel.E / steel.rho) == pytest.approx(5172, abs=1)


@pytest.mark.parametrize(
    "keys, what",
    [
        ({"name": "stele"}, "'steel'"),
        ({"nu": 0.3}, "'E' is missing"),
        ({"E": 1e9}, "'nu' is missing"),
        ({"E": 1e9, "nu": 0.3, "grain": "30 deg"}, "no grain"),
        ({"name": "rosewood", "E": 1e9}, "orthotropic.E"),
        ({"orthotropic": {"E": [1e9, 1e9, 1e9], "nu": [0.6, 0.6, 0.6], "G": [1e9, 1e9, 1e9]}}, "energy free"),
        ({"orthotropic": {"E": [1e9, 1e9], "nu": [0.3, 0.3, 0.3], "G": [1e9, 1e9, 1e9]}}, "missing"),
        ({"name": "steel", "thickness": 0.0}, "greater than 0"),
        ({"name": "steel", "thickness": "3 mm^2*(1 + x)"}, "two things"),
    ],
)
def test_what_is_refused(keys, what):
    with pytest.raises(ValidationError, match=what.replace(".", r"\.") if what != "missing" else "required"):
        material(**keys)


@pytest.mark.slow
def test_bound_of_the_ratios_is_that_of_the_energy():
    """Of random constants those are refused whose compliance is not positive definite, and no others."""
    rng = np.random.default_rng(1)
    refused = 0
    for _ in range(300):
        E, nu = rng.uniform(1, 5, 3), rng.uniform(-1.2, 1.2, 3)
        S = np.diag(1 / E)
        for (i, j), n in zip(((0, 1), (0, 2), (1, 2)), nu):
            S[i, j] = S[j, i] = -n / E[i]
        definite = np.linalg.eigvalsh(S).min() > 0
        try:
            material(orthotropic={"E": list(E), "nu": list(nu), "G": [1.0, 1.0, 1.0]})
            assert definite
        except ValidationError:
            assert not definite
            refused += 1
    assert 50 < refused < 250


def test_thickness_may_be_a_formula_with_units():
    thickness = material(name="brass", thickness="3 mm*(1 - 0.3*exp(-(x/20 mm)^2))").thickness
    assert isinstance(thickness, Expression)
    np.testing.assert_allclose(thickness.evaluate([0.0, 0.02], 0.0, {}), 3e-3 * (1 - 0.3 * np.exp([0.0, -1.0])))


def test_stiffness_along_directions():
    """Young's modulus along a direction n at an angle to the grain: 1/E = c^4/E1 + s^4/E2 + c^2 s^2 (1/G - 2 nu/E1)."""
    wood = material(name="rosewood", grain="35 deg")
    (E1, E2, _), nu, G = wood.orthotropic.E, wood.orthotropic.nu[0], wood.orthotropic.G[0]
    c, s = np.cos(np.radians(35)), np.sin(np.radians(35))
    exact = 1 / (c**4 / E1 + s**4 / E2 + c**2 * s**2 * (1 / G - 2 * nu / E1))
    C = stiffness_of(wood)
    assert 1 / np.linalg.inv(C)[0, 0] == pytest.approx(exact, rel=1e-12)
    assert 1 / np.linalg.inv(plane_stress(C))[0, 0] == pytest.approx(exact, rel=1e-12)


def test_isotropic_stiffness_is_hookes_and_does_not_turn():
    lam, mu = 70 * 0.33 / (1.33 * 0.34), 70 / 2.66
    expected = lam * np.pad(np.ones((3, 3)), (0, 3)) + mu * np.diag([2.0, 2, 2, 1, 1, 1])
    np.testing.assert_allclose(isotropic(70.0, 0.33), expected, atol=1e-12)
    np.testing.assert_allclose(turned(isotropic(70.0, 0.33), 0.7), expected, atol=1e-12)


def test_a_quarter_turn_exchanges_two_axes():
    C = orthotropic((13.0, 2.0, 1.0), (0.36, 0.46, 0.6), (1.1, 0.9, 0.3))
    swap = [1, 0, 2, 4, 3, 5]
    np.testing.assert_allclose(turned(C, np.pi / 2), C[np.ix_(swap, swap)], atol=1e-12)


def scene_text(app: str, material: str) -> str:
    return f"""
format = "restshape-scene"
version = 1
app = "{app}"
[shape]
outline = ["a", "b", "c"]
vertices = {{ p = [0, 0], q = [1, 0], r = [0, 1] }}
[shape.edges]
a = {{ line = ["p", "q"] }}
b = {{ line = ["q", "r"] }}
c = {{ line = ["r", "p"] }}
[material.body]
{material}
[supports.ground]
on = "a"
fix = ["x", "y"]
[effects.solid]
[mesh]
size = 0.2
"""


def test_a_scene_may_name_its_material(tmp_path):
    path = tmp_path / "named.toml"
    path.write_text(scene_text("plane", 'name = "copper"'))
    assert load_scene(path).material["body"].E == 120e9
    assert load_scene(path, ["material.body.name=brass"]).material["body"].E == 100e9


def test_a_wrong_name_is_reported_with_the_nearest_one(tmp_path):
    path = tmp_path / "named.toml"
    path.write_text(scene_text("plane", 'name = "coper"'))
    with pytest.raises(UserError) as caught:
        load_scene(path)
    assert "material.body.name (line 13)" in caught.value.where and "'copper'" in caught.value.do


def test_a_grain_is_refused_where_bodies_are_isotropic(tmp_path):
    path = tmp_path / "wooden.toml"
    path.write_text(scene_text("plane", 'name = "rosewood"'))
    with pytest.raises(UserError, match="knows isotropic materials only"):
        load_scene(path)


def test_a_thickness_that_names_what_is_not_there_is_refused():
    scene = Path(__file__).parents[1] / "scenes" / "bar_100.toml"
    with pytest.raises(UserError, match="names 'foo'"):
        load_scene(scene, ["material.aluminium.thickness=4 mm*(1 - foo*x)"])


def test_sources_are_those_of_the_names_that_are_taken():
    found = sources({"hem": "steel", "own": None})
    assert found == [("hem", "steel", LIBRARY["steel"]["source"])]
