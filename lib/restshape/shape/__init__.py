"""Outlines and their edits: what a shape consists of, how a hand moves it, and what it may not become."""
