"""Derivatives of answers with respect to the design, and what they predict."""
