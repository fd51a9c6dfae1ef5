#include <gtest/gtest.h>

#include "contours.h"

namespace seamwright::test {
namespace {

TEST(Registration, FindsAShapeFarOff) {
    Random random(1);
    const Shape t = hem(-20, 20), s = hem(-35, 35);
    int found = 0;
    const int trials = 100;
    std::uniform_real_distribution<double> unit(-1, 1);
    for (int i = 0; i < trials; ++i) {
        Profile scene_template = sample(t, 0.05);
        auto matcher = ContourMatcher::make(scene_template, {0, 0});
        ASSERT_TRUE(matcher);
        const PlanarMotion truth{10 * unit(random), 10 * unit(random), rad_from_deg(15 * unit(random))};
        Profile scene = sample(s.moved(truth), 0.05, 0.3);
        add_noise(scene, 0.02, random);
        occlude(scene, 0.1, random);
        add_clutter(scene, 0.2, random);
        const Registration r = matcher->match(scene, {});
        const bool good = std::abs(r.scene_from_template.dx_mm - truth.dx_mm) < 0.1 &&
                          std::abs(r.scene_from_template.dz_mm - truth.dz_mm) < 0.1 &&
                          std::abs(r.scene_from_template.phi_rad - truth.phi_rad) < 0.01 &&
                          r.status == RegistrationStatus::ok;
        found += good;
        if (!good)
            printf("%d: %s share %.3f rms %.4f  err %.3f %.3f %.4f\n", i, to_string(r.status).data(),
                   r.inlier_share, r.rms_mm, r.scene_from_template.dx_mm - truth.dx_mm,
                   r.scene_from_template.dz_mm - truth.dz_mm, r.scene_from_template.phi_rad - truth.phi_rad);
    }
    EXPECT_GE(found, 99);
}

}  // namespace
}  // namespace seamwright::test
