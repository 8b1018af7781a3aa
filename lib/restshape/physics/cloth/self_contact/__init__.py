"""Contact of cloth with itself: near pairs, barrier, friction between layers, and the order of layers."""
