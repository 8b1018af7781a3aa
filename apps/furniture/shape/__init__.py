"""Planks, their joints and their edits."""
