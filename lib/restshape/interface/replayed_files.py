"""Replays of scene and script files, for studies."""

from collections.abc import Sequence
from pathlib import Path

from restshape.interface.run import Run
from restshape.replay.request import Request
from restshape.replay.tally import Summary
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene


def replay_files(scene: Path, edits: Path, name: str, overrides: Sequence[str] = (), predict: str = "none") -> Summary:
    """The summary of a replay of files under the policy `name`, for studies; nothing is recorded.

    Args:
        scene: scene file.
        edits: edit script.
        name: of the policy.
        overrides: ``key=value`` as after --set.
        predict: as after --predict.
    """
    read = load_scene(scene, overrides)
    script = load_script(edits, read)
    return Run(Request.of(read, script, name, predict=predict), keep_rows=True).to_end()
