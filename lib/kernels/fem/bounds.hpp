// Whether indices that others give are those of an array.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace restshape {

// Without an end in the middle the loop takes many at once; negative ones are the largest where they have no sign.
inline bool all_within(const int32_t* index, std::ptrdiff_t count, std::ptrdiff_t size) {
    uint32_t most = 0;
    for (std::ptrdiff_t i = 0; i < count; ++i) most = std::max(most, static_cast<uint32_t>(index[i]));
    return count == 0 || static_cast<std::ptrdiff_t>(most) < size;
}

}  // namespace restshape
