"""Complete factors: of one rank, of what ranks share in blocks of nodes, their pivots and their borders."""
