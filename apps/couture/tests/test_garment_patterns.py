"""Garments to measure fit together: edges that are sewn are of one length, for all sizes, and lie on a body."""

from argparse import ArgumentParser
from pathlib import Path

import pytest
from restshape_verification.couture import garments
from restshape_verification.couture.garment_measures import parameters_for

from restshape.errors import UserError
from restshape.interface.first_frame import first_frame
from restshape.physics.cloth.mannequin.body_shape import LEVELS
from restshape.scene.body_sizes import BODIES
from restshape.scene.load import load_scene
from restshape.shape.build import outline_from_spec

PATTERNS = Path(__file__).parents[1] / "patterns"
GARMENTS = sorted(path.stem for path in PATTERNS.glob("*.toml"))


def measures(body: str, garment: str) -> list[str]:
    """The parameters of a garment for a body, as `--set` takes them."""
    return parameters_for(load_scene(PATTERNS / f"{garment}.toml"), body)


def lengths(garment: str, changes: list[str]) -> tuple[dict[str, tuple[float, float]], dict[str, float]]:
    """Both lengths [m] that each seam joins, and those of edges by name."""
    scene = load_scene(PATTERNS / f"{garment}.toml", changes)
    outline = outline_from_spec(scene.shape, PATTERNS)
    edges = dict(zip((edge.name for edge in outline.edges), outline.lengths().tolist()))
    sides = {name: [sum(edges[one] for one in side) for side in seam.sides] for name, seam in scene.seams.items()}
    return {name: (first, second) for name, (first, second) in sides.items()}, edges


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("garment", GARMENTS)
def test_edges_that_are_sewn_are_of_one_length(garment, body):
    seams, _ = lengths(garment, measures(body, garment))
    assert len(seams) >= 6
    over = {name: first - second for name, (first, second) in seams.items()}
    # Bands are shorter than waists by 2 cm in all, and by what a waist rises to darts and sides.
    waists = [over.pop(name) for name in list(over) if name.startswith("waist")]
    least = {"skirt": 0.02, "trousers": 0.02}.get(garment, 0.0) / 8
    assert all(least - 1e-3 < one < least + 0.003 for one in waists) and len(waists) == 8 * (least > 0.0)
    # Caps of sleeves have half of their ease in front and half behind, all parts alike.
    caps = {name: over.pop(name) for name in list(over) if name.startswith("cap")}
    assert sum(caps.values()) == pytest.approx(0.03 if caps else 0.0, abs=1e-9)
    ratios = [seams[name][0] / seams[name][1] for name in caps]
    assert ratios == pytest.approx(ratios[:1] * len(ratios), rel=1e-9)
    assert list(over.values()) == pytest.approx([0.0] * len(over), abs=1e-9)


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize(("garment", "fronts"), [("skirt", 2), ("bodice", 2), ("trousers", 4)])
def test_a_waist_is_as_wide_as_that_of_the_body_and_its_ease(garment, fronts, body):
    changes = measures(body, garment)
    _, edges = lengths(garment, changes)
    waist = sum(length for name, length in edges.items() if "waist" in name)
    ease = 0.05 if garment == "bodice" else 0.02
    # Side seams rise by a centimetre: the slope adds a few millimetres to a line that is level in the draft.
    assert waist == pytest.approx(BODIES[body].waist + ease, abs=0.008)
    if fronts == 2:
        # Darts leave eight parts of the waist.
        assert len([name for name in edges if ".waist" in name]) == 8


@pytest.mark.parametrize("garment", GARMENTS)
def test_measures_that_are_written_are_those_of_the_standard_body(garment):
    written = load_scene(PATTERNS / f"{garment}.toml").parameters
    for change in measures("standard", garment):
        name, value = change.removeprefix("parameters.").split("=")
        # The fork is cut two centimetres below where the legs of the body meet.
        assert written[name] == pytest.approx(float(value), abs=2e-3), name


@pytest.mark.slow
def test_a_waistband_holds_a_skirt_at_the_waist():
    # On edges of 6 cm a band of 3 cm is stretched a little more than on those of its scene.
    row = first_frame(PATTERNS / "skirt.toml", ["mesh.size=0.06", "effects.cloth.trusted_strain=0.08"]).row
    assert row["converged"] == 1 and row["seam_gap"] < 1e-3 and not row["untrusted"]
    waist = LEVELS["waist"] * BODIES["standard"].height
    assert waist < row["q_waistline"] < waist + 0.05


@pytest.mark.parametrize("option", ["garments", "bodies"])
def test_an_empty_list_of_garments_or_bodies_is_refused(option):
    parser = ArgumentParser()
    garments.arguments(parser)
    with pytest.raises(UserError, match=f"none of the {option} are named"):
        garments.run(parser.parse_args([f"--{option}", ""]))


@pytest.mark.parametrize(
    ("changed", "fits"),
    [({}, 0), ({"crossings": 2}, 1), ({"seam_gap": 0.02}, 1), ({"untrusted": "no"}, 1), ({"converged": 0}, 1)],
)
def test_a_garment_fits_with_closed_seams_and_without_crossings(monkeypatch, changed, fits):
    rest = dict.fromkeys(garments.KEPT, 0) | {
        "converged": 1,
        "tangent_positive_definite": 1,
        "untrusted": "",
        "note": "",
    }
    rest |= {"seconds": 1.0, "nodes": 10, "low": 0.0, "high": 1.0, **changed}
    monkeypatch.setattr(garments, "drape", lambda *_: rest)
    parser = ArgumentParser()
    garments.arguments(parser)
    assert garments.run(parser.parse_args(["--garments", "shirt", "--bodies", "standard"])) == fits
