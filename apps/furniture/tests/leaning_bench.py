"""A bench with a leaning leg and a rail that ends before it: it holds, but the rail's joint bends along its line."""

LEANING_BENCH = """format = "restshape-scene"
version = 1
app = "furniture"
title = "bench with a slanted leg"

[wood]
name = "pine"
thickness = "30 mm"

[fastener]
name = "screw"
spacing = "30 mm"

[floor]
friction = 0.45

[planks]
seat = { from = [-0.6, 0, 0.44], to = [0.6, 0, 0.44], width = [0, 0.32, 0] }
left = { from = [-0.5, 0, 0], to = [-0.5, 0, 0.425], width = [0, 0.3, 0] }
right = { from = [0.4903712, 0, 0], to = [0.4331671, 0, 0.425], width = [0, 0.3, 0] }
rail = { from = [-0.485, 0, 0.3775], to = [0.4, 0, 0.3775], width = [0, 0, 0.095] }

[weights]
two = { on = "seat", mass = "150 kg", at = [0, 0, 0.5] }

[pushes]
edge = { on = "seat", force = [0, 0, "-800 N"], at = [-0.5, 0, 0.5] }
shove = { on = "seat", force = ["200 N", 0, 0] }

[effects]
gravity = {}
push = {}
bending = {}
guidance = {}
"""
