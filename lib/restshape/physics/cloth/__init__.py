"""Cloth: what a scene of it may say, its problem of finite elements, and rooms for its parts."""
