"""Installed applications, each key of whose scenes has one meaning."""

from functools import cache

from restshape.application import Application, applications
from restshape.scene.extension import refuse_clashes
from restshape.scene.script import shared_events


@cache
def extended_applications() -> dict[str, Application]:
    """The installed applications that add to scenes, by name.

    Raises:
        UserError: two of them give one key different meanings.
    """
    extended = {name: app for name, app in applications().items() if app.scene}
    refuse_clashes(
        {name: app.scene for name, app in extended.items()},
        {name: shared_events(app) for name, app in extended.items()},
    )
    return extended
