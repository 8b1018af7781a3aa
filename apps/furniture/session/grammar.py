"""What `restshape script` understands of furniture."""

GRAMMAR = """\
drag PLANK by DX DY DZ [in N frames]                   drag PLANK PARAMETER by AMOUNT [in N frames]
                                                       PARAMETER: move x, turn y, length x, ...
rotate PLANK by ANGLE [about x|y|z] [in N frames]      scale PLANK by FACTOR [along x|y] [in N frames]
plank NAME from X Y Z to X Y Z width X Y Z [thick LENGTH] [of WOOD] [with FASTENER]
connect PLANK [with FASTENER]
weight NAME of MASS on PLANK [at X Y Z]                delete PLANK or WEIGHT
choose NUMBER                                          slide to PART [in N frames]
set KEY = VALUE [in N frames]                          idle N | undo | redo | analyse
lengths in m or with a unit (8 mm), angles with a unit (30 deg), places on a plank in parts of its size"""
