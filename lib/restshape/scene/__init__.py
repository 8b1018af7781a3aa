"""What the user writes: scene files, edit scripts, the plan of effects."""
