// What callers get wrong is said with an exception.
#pragma once

#include <stdexcept>

namespace restshape {

inline void require(bool holds, const char* message) {
    if (!holds) throw std::invalid_argument(message);
}

}  // namespace restshape
