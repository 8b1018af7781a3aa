// Numbers from several places of an array, one SIMD lane each.
#pragma once

#include <cstdint>

#include "fem/pack.hpp"

namespace restshape {

[[gnu::always_inline]] inline Pack gathered(const double* from, const int32_t* places) {
#ifdef __AVX512F__
    return (Pack)_mm512_i32gather_pd(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(places)), from, 8);
#else
    Pack found;
    for (int lane = 0; lane < pack_lanes; ++lane) found[lane] = from[places[lane]];
    return found;
#endif
}

}  // namespace restshape
