"""Furniture of planks and nails: valid ranges and suggestions while it is being designed."""
