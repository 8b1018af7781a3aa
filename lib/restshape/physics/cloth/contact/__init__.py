"""Contact of cloth with bodies: distances, penalty, friction by anchors, and bodies that begin inside it."""
