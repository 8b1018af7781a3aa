"""Benchmarks: the same edits under several policies, and the same frame at several sizes."""
