"""Scenes of a rubber tower that vibrates, for hard cases."""

from functools import partial

from restshape_studies.stability import scenery, towers

HEAD = scenery.head("vibration")
tower = partial(towers.tower, "vibration")
