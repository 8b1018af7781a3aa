"""Findings as recordings have them: what is written is read again, and what has no room is counted."""

import json
from math import inf

import pytest

from restshape.findings import OMITTED, Finding, decode_findings, encode_findings

LIMIT = Finding("limit", "max", ("sag",), 3.2e-3, 3e-3, "m")
MANY = tuple(Finding("weak", "pull", (f"leg-{k}", "top"), 2.0 - 0.01 * k, 1.0, case="push wind") for k in range(40))


@pytest.mark.parametrize("found", [(), (LIMIT,), (LIMIT, Finding("falls", subjects=("Bölzchen",)))])
def test_findings_are_read_as_they_were_written(found):
    assert decode_findings(encode_findings(found)) == found


def test_infinite_values_are_json():
    one = Finding("limit", "max", ("load",), inf, 1.0)
    text = encode_findings([one])
    assert json.loads(text, parse_constant=pytest.fail)[0]["value"] == "inf" and decode_findings(text) == (one,)


def test_the_first_of_each_kind_are_kept_and_the_others_counted():
    text = encode_findings([*MANY, LIMIT], 600)
    *kept, omitted = decode_findings(text)
    assert len(text.encode()) <= 600
    assert tuple(kept) == (*MANY[: len(kept) - 1], LIMIT) and len(kept) > 2
    assert omitted == Finding("weak", OMITTED, value=41 - len(kept))


def test_what_fits_nowhere_is_counted():
    assert decode_findings(encode_findings([Finding("falls", subjects=("x" * 2000,))])) == (
        Finding("falls", OMITTED, value=1),
    )


def test_only_amounts_vary():
    assert LIMIT.identity == Finding("limit", "max", ("sag",), unit="m")
    assert Finding("apart", "part", ("leg",), 3).identity.value == 3
