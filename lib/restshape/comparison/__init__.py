"""Comparisons of two results: headers, quantities, times and fields beside each other."""
