#include "core/profile/stripe/lobe_group.h"

#include <cstring>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "core/profile/stripe/lobe.h"

// Vectors of 32 bytes pass between inlined functions only; their calling convention does not matter.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace seamwright::detail {
namespace {

namespace portable {
#define SEAMWRIGHT_INLINE inline __attribute__((always_inline))
#include "core/profile/stripe/lobe_lanes.inl"
#undef SEAMWRIGHT_INLINE
void measure(LobeGroup& group) {
    measure_lanes(group);
}
}  // namespace portable

#if defined(__x86_64__)
namespace avx2 {
#define SEAMWRIGHT_INLINE inline __attribute__((always_inline, target("avx2")))
#define SEAMWRIGHT_GATHER(from, at) \
    reinterpret_cast<Reals>(_mm256_i32gather_ps(from, reinterpret_cast<__m256i>(at), 4))
#include "core/profile/stripe/lobe_lanes.inl"
#undef SEAMWRIGHT_GATHER
#undef SEAMWRIGHT_INLINE
__attribute__((target("avx2"))) void measure(LobeGroup& group) {
    measure_lanes(group);
}
}  // namespace avx2
#else
namespace avx2 = portable;
#endif

}  // namespace

void measure_group(LobeGroup& group, Kernel kernel) {
    if (has_avx2(kernel)) {
        avx2::measure(group);
    } else {
        portable::measure(group);
    }
}

}  // namespace seamwright::detail
