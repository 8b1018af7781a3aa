"""Rasping a bar towards its tone: material only comes off."""
