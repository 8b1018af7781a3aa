"""What furniture's page says of fasteners and of joints that give: what commands print, and statics by hand."""

from math import pi
from pathlib import Path

import numpy as np
import pytest
from restshape_apps.furniture.physics.furniture import Compliance, Furniture
from restshape_apps.furniture.pieces import bookshelf_20
from restshape_apps.furniture.small_pieces import stretched
from restshape_verification.furniture import between_brackets, fastener_strengths, pliant_joints
from restshape_verification.furniture.least_energy import least_energy

from restshape.cli.main import main

G = 9.80665
PAGE = (Path(__file__).parents[3] / "docs" / "furniture.md").read_text(encoding="utf-8").splitlines()
BENCH = "stretcher, 70 kg over a leg"


def tabled(lines: list[str]) -> dict[str, list[str]]:
    """Cells of the rows of tables, by their first one; of two alike the later."""
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line.startswith("|")]
    rows = [row for row in rows if not row[0].startswith("---")]
    return {first: others for first, *others in rows}


@pytest.mark.slow
def test_the_page_has_the_tables_that_are_printed(capsys) -> None:
    assert main(["fasteners"]) == 0
    page, bears = tabled(PAGE), tabled(capsys.readouterr().out.splitlines())
    assert len(bears) == 6
    assert {first: page.get(first) for first in bears} == bears
    assert main(["pliant-joints"]) == 0
    first, *others = capsys.readouterr().out.split("\n\n")
    head, *rows = tabled(first.splitlines()).items()
    assert page[head[0]] == head[1]
    assert [what for what, _ in rows] == [*pliant_joints.BENCHES, "all joints of table.toml"]
    for what, cells in rows:
        assert [float(cell) for cell in page[what]] == pytest.approx([float(cell) for cell in cells], rel=0.01), what
    # What words report the rest.
    reported, rest = " ".join(PAGE), " ".join(others)
    for number in ("12,300", "27,800", "823 N/mm", "243 nm for each N", "0.105", "0.165"):
        assert number in reported and number in rest, number


@pytest.mark.slow
def test_rows_are_written_for_programs(tmp_path) -> None:
    for command, count in (("fasteners", 15), ("pliant-joints", 75), ("between-brackets", 60)):
        out = tmp_path / "rows.json"
        assert main([command, "--json", str(out)]) == 0
        assert out.read_text().count("{") >= count


def test_what_one_fastener_bears_is_that_of_the_sources() -> None:
    bears = {(row.fastener, row.wood): (row.pull, row.shear) for row in fastener_strengths.strengths()}
    assert bears["nail-thesis", "oak"] == pytest.approx((35.0 * 14, 190))
    assert bears["nail-experiment", "pine"] == pytest.approx((5.2 * 14, 190))
    assert bears["nail", "mdf"] == (None, None)
    # Half of 54.12 G^(5/2) D L, three quarters of 108.25 G^2 D L, heads of 8 mm at 8 N/mm^2, and mantles of dowels.
    assert bears["nail", "pine"][0] == pytest.approx(0.5 * 54.12 * 0.38**2.5 * 2.2 * 22)
    assert bears["screw", "oak"][0] == pytest.approx(
        min(0.75 * 108.25 * 0.58**2 * 4.0 * 22, 70e-6 * 530**2 * 8**2), rel=1e-3
    )
    assert bears["screw", "mdf"][0] == pytest.approx(8.0 * 8**2)
    assert bears["dowel", "pine"][0] == pytest.approx(pi * 8 * 18 * 4.0)
    assert [fastener_strengths.head_pull(t) for t in fastener_strengths.HEADED] == pytest.approx([512.0] * 3)


def test_a_nail_of_32_mm_bears_most_moment_through_half_of_its_length() -> None:
    # t/2 times 35 kN/m times what is left of the nail.
    for t in (0.012, 0.016, 0.018):
        assert fastener_strengths.moment(t) == pytest.approx(0.5 * t * 35e3 * (0.032 - t))
    assert fastener_strengths.moment(0.016) > max(fastener_strengths.moment(t) for t in (0.0155, 0.0165))


@pytest.mark.parametrize("ratio", [1.0, 10.0, 100.0])
def test_uses_of_a_stretcher_are_those_of_least_energy(ratio: float) -> None:
    piece = stretched(0.35)
    usual = Compliance()
    furniture = Furniture(piece, Compliance(usual.joint_t, ratio * usual.joint_t, usual.floor))
    furniture.test()
    joints, _ = least_energy(furniture)
    geometry, rail = furniture.geometry(), [k for k, joint in enumerate(piece.joints) if joint.i == pliant_joints.RAIL]
    tension = np.einsum("ka,ka->k", joints[:, :3], geometry.n)[rail]
    moment = np.abs(np.einsum("ka,ka->k", joints[:, 3:], geometry.y))[rail]
    # Ten screws in each end, 549 N each.
    expected = ((2.0 * moment / 0.018 + tension) / (10 * 549.0)).max()
    found = pliant_joints.used(BENCH, piece, ratio, plank=pliant_joints.RAIL)
    # Feet lift at one edge, which springs both ways do not.
    assert found.pull == pytest.approx(expected, rel=0.15)


def test_a_stretcher_of_pliant_joints_bears_its_own_weight() -> None:
    rows = {(row.what, row.ratio): row for row in pliant_joints.of_stretchers()}
    ratio = pliant_joints.line_ratio(0.018)
    # Half of the rail on ten screws of 320 N.
    own = 420.0 * 0.018 * 0.2 * (0.7 - 0.018) * G
    for what in pliant_joints.BENCHES:
        assert rows[what, ratio].largest == pytest.approx(0.5 * own / 3200.0, rel=0.01)
    # Forces are linear in the load, but for the weights of planks.
    heavy, usual = rows["stretcher, 200 kg over a leg", 1.0].largest, rows[BENCH, 1.0].largest
    assert heavy / usual == pytest.approx(200.0 / 70.0, rel=0.01)


def test_joints_that_turn_more_easily_raise_no_pull() -> None:
    rows = pliant_joints.of_scenes()
    first = {row.what: row for row in rows if row.ratio == 1.0}
    assert len(first) == 10
    for row in rows:
        assert row.pull <= first[row.what].pull + 1e-3, row
        assert row.shear <= first[row.what].shear + 0.06, row
    assert max(row.shear - first[row.what].shear for row in rows) > 0.05


def test_slip_and_turn_of_a_line_of_nails() -> None:
    # 420^1.5 x 2.2/23 = 823.3 N/mm.
    assert pliant_joints.slip("pine", "nail", 5) == pytest.approx(1e-3 / (5 * 823.3), rel=1e-4)
    # Nails of stiffness k turn about an edge t/2 away with k (t/2)^2.
    assert pliant_joints.line_ratio(0.018) == pytest.approx((1.0 / (7.0 * 0.009**2)) / (1.0 / 7.0))


def test_a_board_between_two_brackets_takes_little_off_them() -> None:
    piece = bookshelf_20()
    # 26 kg at 175 mm, and the bracket's own weight, on ten nails of 700 N with a lever of 6 mm.
    alone = (26.0 * 0.175 + 700.0 * 0.25 * 0.2 * 0.012 * 0.125) * G / (10 * 700.0 * 0.006)
    assert between_brackets.utilisations(piece) == pytest.approx((alone, alone), rel=1e-4)
    # Both brackets turn by w. The board turns by f; with h half of its length and all compliances 1 it shears its ends
    # and draws at the brackets' by H, where f h = 2 H. Its ends' moments w - f balance that: w - f = H h.
    h = 0.5 * (0.6 - 0.012)
    share = (h * h / 2) / (1.0 + h * h / 2)
    rows = between_brackets.boards(piece)
    best = min(max(row.utilisations) for row in rows)
    assert best == pytest.approx(alone / (1.0 + share), rel=3e-3)
    assert f"{best:.2f}" == "1.03"
    assert all(min(row.utilisations) > 1.0 and max(row.utilisations) < alone for row in rows)
