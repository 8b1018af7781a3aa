// What callers get wrong is said with an exception.
#pragma once

#include <stdexcept>
#include <string>

namespace restshape {

inline void require(bool holds, const char* message) {
    if (!holds) throw std::invalid_argument(message);
}
inline void require(bool holds, const std::string& message) {
    if (!holds) throw std::invalid_argument(message);
}

}  // namespace restshape
