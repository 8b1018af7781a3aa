"""Garbled files: whatever the text, a scene and a script are read or refused with a message, and never break."""

import tomllib
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from restshape_studies.stability.damage import keys_of, spliced, splices, values

from restshape.errors import UserError
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene, revise

DATA = Path(__file__).parents[1] / "data"
SCENE = (DATA / "plate.toml").read_text()
SCRIPT = (DATA / "plate.jsonl").read_text()
quiet = settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


@pytest.mark.slow
@quiet
@given(st.lists(splices, min_size=1, max_size=3))
def test_spliced_scene(tmp_path, changes):
    path = tmp_path / "scene.toml"
    path.write_text(spliced(SCENE, changes))
    try:
        load_scene(path)
    except UserError as error:
        assert error.what and "scene.toml" in error.where


@quiet
@given(st.lists(splices, min_size=1, max_size=3))
def test_spliced_script(tmp_path, changes):
    path = tmp_path / "edits.jsonl"
    path.write_text(spliced(SCRIPT, changes))
    try:
        load_script(path)
    except UserError as error:
        assert error.what and "edits.jsonl" in error.where


@pytest.mark.slow
@quiet
@given(st.sampled_from(keys_of(tomllib.loads(SCENE))), values)
def test_any_value_at_any_key(tmp_path, key, value):
    path = tmp_path / "scene.toml"
    path.write_text(SCENE)
    scene = load_scene(path)
    try:
        revise(scene, ".".join(key), value)
    except UserError as error:
        assert error.what and error.where
