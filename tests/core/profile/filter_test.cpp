#include "core/profile/filter.h"

#include <gtest/gtest.h>

#include "tests/core/profile/synthetic_profiles.h"

namespace seamwright {
namespace {

TEST(MapSpacing, KnownValueOfTheThesis) {
    // Fig. 3.4: the exact maximum is 0.12846, the approximation alone prints 0.1284.
    EXPECT_NEAR(map_spacing(0.13, 0.146, -0.111, 0.13, 0.02), 0.1284598, 1e-7);
    EXPECT_NEAR(map_spacing_closed_form(0.13, 0.146, -0.111, 0.13, 0.02), 0.1284, 5e-5);
}

}  // namespace
}  // namespace seamwright
