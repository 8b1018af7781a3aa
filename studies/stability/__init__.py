"""Stability: hard cases that state what must hold, and random scenes and edits that must never break."""
