"""What a hand takes hold of, and how shapes, bodies, pins and points follow it."""
