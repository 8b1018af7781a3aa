"""Overrides that are no texts."""

from pathlib import Path

import pytest

import restshape
from restshape.errors import UserError

FISH = Path(__file__).parents[1] / "scenes" / "fish.toml"


@pytest.mark.parametrize("given", [["mesh.size='1 cm'"], {"mesh.size": "1 cm"}, 3])
def test_what_is_no_text_is_refused_with_what_to_write(given):
    with pytest.raises(UserError, match="an override is a text") as refused:
        restshape.load(FISH, given)
    assert "star before a list" in refused.value.do
