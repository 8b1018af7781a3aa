"""Garments to measure fit together: edges that are sewn are of one length, for all sizes, and lie on a body."""

from pathlib import Path

import pytest

from restshape.physics.cloth.mannequin.body_shape import LEVELS
from restshape.replay.first_frame import first_frame
from restshape.scene.body_sizes import BODIES
from restshape.scene.load import load_scene
from restshape.shape.build import outline_from_spec

PATTERNS = Path(__file__).parents[1] / "patterns"
GARMENTS = sorted(path.stem for path in PATTERNS.glob("*.toml"))


def measures(body: str, garment: str) -> list[str]:
    """The parameters of a garment for a body, as `--set` takes them."""
    sizes = BODIES[body].completed()
    known = {name: getattr(sizes, name) for name in sizes.names}
    known |= {f"{name}_level": share * sizes.height for name, share in LEVELS.items()}
    known |= {"neck_level": 0.84 * sizes.height, "crotch_level": 0.446 * sizes.height}
    wanted = load_scene(PATTERNS / f"{garment}.toml").parameters
    return [f"parameters.{name}={value:.6g}" for name, value in known.items() if name in wanted]


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
    for name, (first, second) in seams.items():
        # Caps of sleeves have half of their ease in front and half behind.
        assert first - second == pytest.approx(0.0075 if name.startswith("cap") else 0.0, abs=1e-9), name


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
def test_a_skirt_lies_on_the_hips_of_the_standard_body():
    row = first_frame(PATTERNS / "skirt.toml", ["mesh.size=0.06"]).row
    assert row["converged"] == 1 and row["seam_gap"] < 1e-3 and not row["untrusted"]
    # Its waist is wider than that of the body, and narrower than the hips.
    height = BODIES["standard"].height
    assert LEVELS["hip"] * height < row["q_waistline"] < LEVELS["waist"] * height
