// Included last, where GCC warns of AVX-512 intrinsics within Eigen: what intrinsics.hpp says of them is lost where the
// header is precompiled.
#pragma once

#ifdef __AVX512F__
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
