// Planks that pass through each other or through the floor.
#pragma once

#include <utility>
#include <vector>

#include "shape.hpp"

namespace restshape::planks {

// Pairs of planks that overlap by more than is allowed, and planks (i, -1 - k) that go through a plane k.
// separating: numbers of the axes that have separated pairs before; they are tried first, which changes no answer.
std::vector<std::pair<int, int>> overlaps(const Piece& piece, const Shape<double>& shape, bool first_only,
                                          std::vector<int>* separating = nullptr);

}  // namespace restshape::planks
