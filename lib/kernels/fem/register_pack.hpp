// As many numbers at once as one register has, one SIMD lane each.
//
// A `Pack` has more than registers without AVX-512: GCC keeps it in memory there, and what is shuffled or filled lane
// by lane is waited for. Loops whose lanes never meet have the same results to the last bit with either.
#pragma once

#include <cmath>

#include "fem/pack.hpp"

namespace restshape {

#ifdef __AVX512F__
constexpr int register_lanes = pack_lanes;
using RegisterPack = Pack;
#else
constexpr int register_lanes = 4;
using RegisterPack = double __attribute__((vector_size(register_lanes * sizeof(double))));

[[gnu::always_inline]] inline RegisterPack square_root(RegisterPack a) {
    for (int lane = 0; lane < register_lanes; ++lane) a[lane] = std::sqrt(a[lane]);
    return a;
}

[[gnu::always_inline]] inline RegisterPack larger(const RegisterPack& a, const RegisterPack& b) {
    return a > b ? a : b;
}

[[gnu::always_inline]] inline bool all(const decltype(RegisterPack{} > RegisterPack{}) & holds) {
    return (holds[0] & holds[1] & holds[2] & holds[3]) != 0;
}
#endif

}  // namespace restshape
