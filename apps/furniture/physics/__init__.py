"""Forces, strengths and bending of planks and what joins them."""
