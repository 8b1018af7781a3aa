"""What a plate sounds like when it is struck, once or again and again while its shape is edited."""
