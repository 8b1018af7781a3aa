"""Moments along joints and about their normals: fasteners one by one, levers by hand; doubts, and what counts them."""

import json
import warnings

import numpy as np
import pytest
from restshape_apps.furniture.guidance.valid_ranges import Grabbed, ValidRange, decode_ranges, encode_ranges
from restshape_apps.furniture.physics.furniture import Compliance, Forces, Furniture
from restshape_apps.furniture.physics.joint_compliance import UtilisationRange, utilisation_range
from restshape_apps.furniture.physics.joint_label import joint_label, utilisation_words
from restshape_apps.furniture.physics.plank_findings import MOST_UTILISATION
from restshape_apps.furniture.physics.plank_phrases import phrases
from restshape_apps.furniture.pieces import SCENES, drawn
from restshape_apps.furniture.report.guided import CAUSES, doubt_causes
from restshape_apps.furniture.tests.furniture_scenes import ARM, STEP_STOOL, post
from small_scenes import make_replay

from restshape.findings import Finding, decode_findings, encode_findings

G = 9.80665


ALL = '[effects.nails]\nmoments = "all"\n'


def forces_of(furniture: Furniture) -> list[Forces]:
    """Forces of all cases at the last test."""
    return [furniture.forces(case) for case in range(len(furniture.cases))]


def joint_of(furniture: Furniture, plank: str) -> int:
    """The number of the joint of the end of a plank."""
    return [furniture.piece.planks[one.i].name for one in furniture.piece.joints].index(plank)


def analysed(tmp_path, text: str):
    path = tmp_path / "scene.toml"
    path.write_text(text)
    replay = make_replay(path)
    rows = list(replay.frames())
    return replay.analysis, rows[-1]


@pytest.mark.parametrize(("width", "nails"), [(0.02, 1), (0.04, 2), (0.1, 5), (0.3, 15)])
def test_a_post_pushed_along_its_joint_draws_its_screws(tmp_path, width: float, nails: int) -> None:
    force = 20.0
    analysis, row = analysed(tmp_path, post(f"{width} m", f"{force} N"))
    furniture = analysis.design.furniture
    forces = analysis.forces[2]
    # About the end of the line, on which the post turns: the farthest of screws in the middles of equal parts.
    places = (np.arange(nails) + 0.5) * width / nails
    moment, weight = force * 1.0, 420.0 * 0.018 * width * 1.0 * G
    pull = moment * places[-1] / (places**2).sum() - weight / nails
    assert furniture.nails()[0] == nails
    assert forces.line_utilisation[0] == pytest.approx(pull / 549.0, rel=5e-3)
    assert forces.twist_utilisation[0] == pytest.approx(0.0, abs=1e-6)
    assert (row["constraint_status"] == "uncertain") == (pull > 549.0) == (nails < 5)
    found = [(one.kind, one.detail, one.subjects) for one in decode_findings(row["findings"])]
    assert found == [("doubtful", "line", ("post", "base"))] * int(pull > 549.0)
    # What counts is a flaw of the same joint, with the same use.
    counted, failing = analysed(tmp_path, post(f"{width} m", f"{force} N") + ALL)
    assert failing["constraint_status"] == ("fails" if pull > 549.0 else "holds")
    assert counted.result.pull == pytest.approx(forces.line_utilisation[0])


@pytest.mark.parametrize("width", [0.05, 0.09, 0.15])
def test_a_twist_shears_each_fastener_by_its_distance_from_the_middle(tmp_path, width: float) -> None:
    analysis, _ = analysed(tmp_path, ARM.replace("MASS", "0.5 kg").replace('"24 mm"', f"{width}"))
    furniture, forces = analysis.design.furniture, analysis.forces[0]
    joint = joint_of(furniture, "arm")
    nails = furniture.nails()[joint]
    places = (np.arange(nails) + 0.5) * width / nails - 0.5 * width
    # Of the arm's own load, 0.6 m beside its fasteners.
    twist = abs(forces.twist[joint, 1])
    own = 420.0 * 0.018 * 0.018 * 0.591 * G * 0.3
    assert nails > 1 and twist == pytest.approx(0.5 * G * 0.6 + own, rel=0.05)
    assert forces.twist_utilisation[joint] == pytest.approx(
        twist * places[-1] / (places**2).sum() / furniture.strength[joint, 1]
    )


def test_one_screw_holds_no_twist(tmp_path) -> None:
    # The arm's load lies 0.6 m beside its only screw.
    analysis, row = analysed(tmp_path, ARM.replace("MASS", "0.5 kg"))
    joint = joint_of(analysis.design.furniture, "arm")
    own = 420.0 * 0.018 * 0.018 * 0.591 * G * 0.3
    assert analysis.forces[0].twist[joint, 1] == pytest.approx(0.5 * G * 0.6 + own, rel=0.05)
    assert row["constraint_status"] == "uncertain" and np.isinf(analysis.forces[0].twist_utilisation[joint])
    assert (
        "not counted: joint arm on post in twist, which its single fastener does not bear"
        in row["violated_constraints"]
    )


def test_labels_of_pictures_are_numbers_or_words() -> None:
    assert [joint_label(one) for one in (1.001, 12.341, 4321.0, np.inf)] == ["1.01", "12.35", "4.32e+03", "twist"]


def test_scenes_of_the_application_have_none_of_it() -> None:
    for path in sorted(SCENES.glob("*.toml")):
        assert Furniture(drawn(path.stem)).test().doubts == (), path.stem


def test_a_range_says_where_it_is_doubtful(tmp_path) -> None:
    # A narrower post has fewer screws, nearer to the end of its joint's line.
    analysis, _ = analysed(tmp_path, post("0.1 m", "20 N"))
    design = analysis.design
    way = design.parameter(1, 7)
    for low, high in way.doubtful:
        # Ends are bisected: they are on the good side.
        for t in low + np.array([0.01, 0.5, 0.99]) * (high - low):
            result = design.furniture.test(t * way.direction)
            assert result.valid and result.doubts
    sure = [t for t in np.linspace(way.low, way.high, 60) if way.ranges.holds(t)]
    for t in sure:
        doubtful = any(low <= t <= high for low, high in way.doubtful)
        assert bool(design.furniture.test(t * way.direction).doubts) == doubtful
    assert way.doubtful
    text = encode_ranges(Grabbed("rail", "m", (ValidRange(-1.0, 1.0, False, True),), way.doubtful))
    assert decode_ranges(text).doubtful == pytest.approx(np.array(way.doubtful), rel=1e-5)


def test_doubtful_suggestions_come_last_and_say_so(tmp_path) -> None:
    analysis, row = analysed(tmp_path, STEP_STOOL)
    found = analysis.design.suggestion_list.found
    doubts = [bool(one.doubt) for one in found]
    assert len(found) > 2 and doubts == sorted(doubts)
    for one in found:
        result = analysis.design.furniture.test(one.t * one.direction)
        assert result.valid and bool(result.doubts) == bool(one.doubt)
    assert [bool(one.get("doubt")) for one in json.loads(row["suggestions"])] == doubts
    assert any(doubts) == ("but not counted: joint" in found[-1].summary)
    # Where moments count, what is suggested bears them.
    counted, _ = analysed(tmp_path, STEP_STOOL + ALL)
    for one in counted.design.suggestion_list.found:
        result = counted.design.furniture.test(one.t * one.direction)
        assert result.valid and max(f.moment_utilisation.max() for f in forces_of(counted.design.furniture)) <= 1.0


def test_the_legend_names_why_a_piece_is_doubtful() -> None:
    def row(kind: str) -> dict:
        return {
            "constraint_status": "uncertain",
            "findings": encode_findings((Finding(kind, "", ("a", "b"), 2.0, 1.0),), 500),
        }

    moments, compliances = CAUSES["doubtful"], CAUSES["depends"]
    assert doubt_causes([row("doubtful"), {"constraint_status": "holds"}]) == moments
    assert doubt_causes([row("depends")]) == compliances
    assert doubt_causes([row("depends"), row("doubtful")]) == f"{moments} or {compliances}"
    assert doubt_causes([{"constraint_status": "fails"}]) == ""


def test_a_single_fastener_has_no_number_of_its_twist(tmp_path) -> None:
    # Its use is infinite at every ratio of compliances, so that it does not depend on them.
    known = UtilisationRange(np.array([np.inf, 0.5, 1.0]), np.array([np.inf, np.inf, 1.1]), False)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert known.redundant.tolist() == [1, 2]
    # Recorded as a large number, for JSON knows no infinite one; people read what it stands for.
    assert utilisation_words(MOST_UTILISATION, ".3g") == utilisation_words(np.inf, ".3g") == "infinite"
    assert utilisation_words(0.04292, ".3g") == "0.0429"
    finding = Finding("depends", "", ("a", "b"), np.inf, 0.04)
    assert phrases([finding]) == (
        "depends on joints: the utilisation of a on b from 0.04 to infinite over their compliances",
    )


def test_a_joint_that_statics_decides_does_not_depend_on_compliances(tmp_path) -> None:
    # A tree: the moment is the push times its lever, at any ratio.
    path = tmp_path / "post.toml"
    path.write_text(post("0.2 m", "385.19 N") + ALL)
    design = make_replay(path).session.design
    known = utilisation_range(design.piece, Compliance())
    assert known.low[0] < 1.0 < known.high[0] < known.low[0] + 1e-3
    assert not known.findings(design.piece)
    row = next(iter(make_replay(path).frames()))
    assert row["constraint_status"] == ("holds" if row["utilisation"] <= 1.0 else "fails")
    assert "depends" not in row["violated_constraints"]


def test_a_range_is_doubtful_from_where_frames_are(tmp_path) -> None:
    path = tmp_path / "post.toml"
    path.write_text(post("0.2 m", "300 N"))
    design = make_replay(path).session.design
    way = design.parameter(1, 6)
    ((low, high),) = way.doubtful
    inside, outside = 0.0, high
    while outside - inside > 1e-9:
        middle = 0.5 * (inside + outside)
        sure = design.furniture.test(middle * way.direction).status == "holds"
        inside, outside = (middle, outside) if sure else (inside, middle)
    ((least, most),) = way.ranges.intervals
    assert way.name == "post: length x" and low == pytest.approx(inside, abs=2e-6 * (most - least))
