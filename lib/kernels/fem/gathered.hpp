// Numbers from several places of an array, one SIMD lane each.
#pragma once

#include <cstdint>

#include "fem/register_pack.hpp"

namespace restshape {

[[gnu::always_inline]] inline RegisterPack gathered(const double* from, const int32_t* places) {
#ifdef __AVX512F__
    return (RegisterPack)_mm512_i32gather_pd(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(places)), from, 8);
#else
    return RegisterPack{from[places[0]], from[places[1]], from[places[2]], from[places[3]]};
#endif
}

}  // namespace restshape
