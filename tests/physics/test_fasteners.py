"""Strength of fasteners against the formulas of their sources, worked by hand."""

from math import pi, sqrt

import pytest

from restshape.errors import UserError
from restshape.physics.fasteners import FASTENERS, WOODS, fastener, johansen, wood


def test_the_nail_of_the_thesis() -> None:
    nail = fastener("nail-thesis")
    assert nail.pull_strength(wood("mdf"), 0.012) == pytest.approx(700.0)
    assert nail.shear_strength(wood("mdf"), wood("mdf"), 0.012) == 190.0


def test_the_nail_of_the_experiment() -> None:
    # 1.86 N m with three nails and a lever of 6 mm.
    assert 3 * 0.006 * fastener("nail-experiment").pull_strength(wood("mdf"), 0.012) == pytest.approx(1.86, rel=0.01)


def test_withdrawal_of_nails_and_screws_in_side_grain() -> None:
    # In inches and pounds the Wood Handbook has 7850 G^(5/2) D L for nails and 15,700 G^2 D L for screws.
    inch, pound = 0.0254, 4.4482216
    mdf = wood("mdf")
    for name, factor, power in (("nail", 7850.0, 2.5), ("screw", 15700.0, 2.0)):
        kind = fastener(name)
        by_hand = factor * mdf.gravity**power * kind.diameter / inch * 0.028 / inch * pound
        assert kind.pull_strength(mdf, kind.length - 0.028) == pytest.approx(by_hand, rel=2e-3)


def test_a_glued_dowel_pulls_out_with_its_mantle() -> None:
    assert fastener("dowel").pull_strength(wood("pine"), 0.02) == pytest.approx(0.5 * pi * 0.008 * 0.03 * 4e6)


def test_johansen_with_equal_members() -> None:
    f, d, moment = 20e6, 0.003, 3.0
    # Long members: two hinges, sqrt(2 M f d) times 1.15. Short ones: the wood gives way at (sqrt(2) - 1) f t d.
    assert johansen(f, f, 1.0, 1.0, d, moment) == pytest.approx(1.15 * sqrt(2 * moment * f * d))
    assert johansen(f, f, 1e-3, 1e-3, d, moment) == pytest.approx((sqrt(2) - 1) * f * 1e-3 * d, rel=1e-6)
    assert johansen(f, f, 1e-4, 1.0, d, moment) == pytest.approx(f * 1e-4 * d, rel=1e-6)


def test_every_entry_names_its_source() -> None:
    for entry in (*FASTENERS.values(), *WOODS.values()):
        assert len(entry.source) > 10
    for kind in FASTENERS.values():
        for one in WOODS.values():
            assert 1.0 < kind.pull_strength(one, 0.018) < 5e3
            assert 10.0 < kind.shear_strength(one, one, 0.018) < 5e3


def test_unknown_names_say_what_there_is() -> None:
    with pytest.raises(UserError, match="nail-thesis"):
        fastener("rivet")
    with pytest.raises(UserError, match="mdf"):
        wood("balsa")
