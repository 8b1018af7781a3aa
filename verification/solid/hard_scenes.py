"""Scenes of columns that buckle and of rubber that deforms far, for hard cases."""

from functools import partial

from restshape_studies.stability import columns, rubber, scenery

HEAD = scenery.head("solid")
TWINS = columns.twins("solid")
plate = partial(scenery.plate, "solid")
column = partial(columns.column, "solid")
beam = partial(rubber.beam, "solid")
