"""What is too large or too small: each bound by its name, checked before time or memory goes into what it bounds.

docs/safety.md lists them; a name here is a name there.
"""

SCENE_BYTES = 16 << 20
"""Text of a scene."""
SCRIPT_BYTES = 256 << 20
"""Text of an edit script."""
CALIBRATION_BYTES = 1 << 20
"""Text of a calibration that is read."""
DRAWING_BYTES = 64 << 20
"""A .dxf, .svg or .step file; a .geo file has bounds of its own, in `restshape.shape.drawings.geo_tokens`."""
MESH_BYTES = 1 << 30
"""A mesh file."""
BODY_TRIANGLES = 500_000
"""Triangles of a body that cloth touches."""
BODY_BRICKS = 60_000
"""Bricks of 8^3 cells in which the distance from such a body is kept."""
BODY_LATTICE = 40_000_000
"""Places of the even grid that they are cut from."""
RECORD_BYTES = 32 << 20
"""Text of a record of the ground's acceleration."""
RECORD_POINTS = 1_000_000
"""Samples of such a record."""
READING_MEMORY = 4 << 30
"""Memory that reading a mesh or a drawing may take besides [bytes]: packed files hold more than they show."""

NESTING = 32
"""Tables and lists within each other, in scenes and in events."""
WHOLE_NUMBER = 2**63
"""Whole numbers are smaller than this, as TOML has them."""
NUMBER = 1e60
"""Largest number in SI units: products of four of them are still numbers. Values of formulas, too."""
TOLERANCE = 1e-15
"""Least tolerance of a solve: rounding alone is 1.1e-16 of each number."""
LENGTH = 1e9
"""Largest length or coordinate [m]."""
UNIT_POWER = 12
"""Largest power of a unit."""
QUANTITY_CHARACTERS = 200
"""Characters of a number with its unit."""
FORMULA_CHARACTERS = 2000
"""Characters of a formula."""
NAME_CHARACTERS = 200
"""Characters of a name, so that files can be named for it."""

FILE_NAME_BYTES = 255
"""Bytes of one part of a file's name, as systems take them."""

SPLINE_POINTS = 1000
"""Points of one spline: all of them are coupled by a full matrix."""
POLYLINE_POINTS = 5000
"""Points of one polyline, or corners of one polygon."""
OUTLINE_PIECES = 50_000
"""Straight pieces, close to its curves, that a shape is checked by."""
BULGE = 1e6
"""Largest bulge of an arc: its circle is complete but for a millionth."""
REACH = 100.0
"""Sizes of the shape over which a hand can drag it, and to which an edit can enlarge it."""

TRIANGLES = 4_000_000
"""Triangles of the largest mesh that is begun."""
GROWTH = 50.0
"""How many times as many triangles as the mesh before an edit of the shape may ask for..."""
GROWN_TRIANGLES = 100_000
"""... where they are more than these."""

FRAME_SECONDS = 60.0
"""Processor time that a frame may take, where `--frame-limit` does not say more."""
FRAME_WAITS = 10.0
"""Times as long a frame may take by the clock, whatever it waits for."""
MEMORY_SHARE = 0.9
"""Share of the machine's memory that a run may take, where `--memory-limit` does not say otherwise."""

SWEEP_VALUES = 10_000
"""Runs of one sweep: the product of how many values each key takes."""
