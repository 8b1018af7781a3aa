"""The front beside a search of all pairs, slopes of power laws, and what is picked."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from restshape_studies.accuracy.front import exponent, front_of, mark_pareto, pareto, picks, rates, rivals, slope

from restshape.errors import UserError

COST = st.sampled_from([0.5, 1.0, 1.5, 2.0, 3.0]) | st.floats(1e-6, 1e6)


def record(error, ms, **other):
    """A point."""
    held = {"name": f"{error} in {ms}", "error": error, "frame_ms": ms, "below_reference": False, "varied": ""}
    held |= {"uncertainty": 0.0}
    return held | {"policy": "auto", "order": 1, "size": 1.0, "errors": {}, "quantities": {}} | other


@given(st.lists(st.tuples(COST, COST), max_size=12))
def test_the_front_is_what_no_other_pair_beats(pairs):
    def beaten(a):
        return any(b[0] <= a[0] and b[1] <= a[1] and b != a for b in pairs)

    assert pareto(pairs) == [not beaten(pair) for pair in pairs]


def test_slope_of_a_power_law():
    law = [record(3.0 * ms**-1.5, ms) for ms in (1.0, 2.0, 5.0)]
    beaten = [record(9.0, 4.0), record(None, 0.1), record(1e-9, None), record(1e-6, 50.0, below_reference=True)]
    mark_pareto([*law, *beaten])
    assert slope([*law, *beaten]) == pytest.approx(-1.5, rel=1e-12)
    assert [r["frame_ms"] for r in front_of([*law, *beaten])] == [1.0, 2.0, 5.0, 50.0]
    assert exponent([1.0], [1.0]) is None and exponent([1.0, 2.0], [0.0, 1.0]) is None


def test_rates_leave_out_what_says_nothing_of_the_mesh():
    def held(size, uncertainty=0.0, solver=0.0):
        return {"worst": 0.1 * size**2, "uncertainty": uncertainty, "solver": solver}

    points = [record(1.0, 1.0, size=h, errors={"l2": held(h)}, quantities={"q": held(h, solver=1.0)}) for h in (1, 2)]
    points.append(record(1.0, 1.0, size=0.5, errors={"l2": held(0.5, uncertainty=1.0)}, quantities={"q": held(0.5)}))
    assert rates(points, "auto") == {"l2": {"1": pytest.approx(2.0)}}


POINTS = [record(0.1, 1.0), record(0.03, 4.0), record(0.031, 3.0), record(0.005, 20.0), record(None, 0.1)]


def test_the_most_accurate_within_a_time_and_the_fastest_below_an_error():
    assert picks(POINTS, 16.0, None)[0]["error"] == 0.03
    assert picks(POINTS, None, 0.05)[0]["frame_ms"] == 3.0
    assert picks(POINTS, 16.0, 0.05)[0]["error"] == 0.03
    assert picks(POINTS, None, 0.03)[0]["error"] == 0.005


def test_what_is_tried_next_is_faster_within_a_time_and_else_more_accurate():
    beaten = [*POINTS, record(0.04, 5.0)]
    assert [r["frame_ms"] for r in picks(beaten, 16.0, None)] == [4.0, 3.0, 1.0]
    assert [r["error"] for r in picks(beaten, None, 0.05)] == [0.031, 0.03, 0.005]


def test_an_error_that_the_reference_cannot_resolve_is_no_reason_to_pick():
    vague = [record(0.001, 5.0, uncertainty=0.02), record(0.002, 3.0, uncertainty=0.02)]
    with pytest.raises(UserError, match="the reference itself is known to 2 % only"):
        picks(vague, None, 0.01)
    assert [r["frame_ms"] for r in picks(vague, None, 0.03)] == [3.0, 5.0]
    # Both are as good as the reference can report: the faster one comes first.
    assert [r["frame_ms"] for r in picks(vague, 16.0, None)] == [3.0]


@pytest.mark.parametrize(
    ("within", "error", "words"),
    [
        (0.5, None, "the fastest, 0.1 in 1.0"),
        (None, 1e-3, "the most accurate, 0.005 in 20.0"),
        (5.0, 0.01, "0.03 in 4.0"),
    ],
)
def test_where_nothing_fits_the_nearest_is_reported(within, error, words):
    with pytest.raises(UserError) as reported:
        picks(POINTS, within, error)
    assert words in reported.value.what and reported.value.do


def test_no_finer_points_are_advised_where_none_converges():
    why = "peak does not converge: its error falls as h^0.01 (order 1)"
    vague = [record(0.001, 5.0, uncertainty=0.02)]
    for points in (POINTS, vague):
        with pytest.raises(UserError, match=r"no finer one will: peak does not converge") as reported:
            picks(points, None, 1e-3, why)
        assert "finer" not in reported.value.do
    assert picks(POINTS, None, 0.05, why) == picks(POINTS, None, 0.05)


def test_nothing_can_be_picked_from_nothing():
    with pytest.raises(UserError, match="no point of the study"):
        picks([record(None, 1.0)], 1.0, None)


def test_values_of_a_key_are_compared_at_one_time():
    def point(ms, error, **given):
        return record(error, ms, size=1.0 / ms, **{"varied": "", "given": None, **given})

    # error = 0.1/ms of the scene's own value, 0.4/ms of the other: in between too, along lines of logarithms.
    own = [point(ms, 0.1 / ms) for ms in (1.0, 4.0, 16.0)]
    other = [point(ms, 0.4 / ms, varied="key", given="b") for ms in (4.0, 64.0)]
    alone = [point(1.0, 0.3, varied="solve.tolerance", given=1e-2)]
    found = rivals([*own, *other, *alone])
    assert list(found) == ["key"] and found["key"].ms == pytest.approx(8.0)
    assert found["key"].then == {None: pytest.approx(0.1 / 8.0), "b": pytest.approx(0.4 / 8.0)}
    assert found["key"].finest == {None: pytest.approx((0.1 / 16.0, 1.0)), "b": pytest.approx((0.4 / 64.0, 1.0))}
    assert rivals([*own, *other[:1]]) == {}
