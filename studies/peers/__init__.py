"""The same edits through other solvers: cases, the programs of each peer, and what is said of them."""
