// Gap and flush where rays do not fall straight: two heads that look from either side, and a fan whose noise runs along its
// rays. The shapes and the rays share nothing with the gauge, nor with gap_width_test.cpp.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "core/features/gap/gap_flush.h"
#include "core/geometry/pose.h"
#include "core/panel/double_head.h"
#include "core/profile/filter.h"

namespace seamwright {
namespace {

using HeadsSheet = std::vector<Eigen::Vector2d>;

// Two panels that stand over ground, or turn back under themselves, and what heads see of them that look from either side:
// all that no part hides on the way to the head.
struct TwoHeads {
    double gap_mm, flush_mm, radius_mm, pitch_mm, noise_mm, ground_mm;
    bool hem;  // else a face of 3 mm
};
GapFlush seen_by_two(const TwoHeads& s, std::mt19937_64& engine) {
    std::uniform_real_distribution<double> uniform(0, 1);
    std::normal_distribution<double> normal;
    std::vector<HeadsSheet> parts;
    for (const int side : {-1, 1}) {
        HeadsSheet o{{-60, 0}};
        const double until = s.hem ? M_PI : M_PI / 2;
        for (int k = 0; k <= 40; ++k)
            o.emplace_back(s.radius_mm * (std::sin(until * k / 40) - 1),
                           s.radius_mm * (std::cos(until * k / 40) - 1));
        o.emplace_back(s.hem ? -5 : 0, o.back().y() - (s.hem ? 0 : 3));
        for (auto& p : o)
            p = Eigen::Vector2d(-side * p.x() + (side < 0 ? 0 : s.gap_mm),
                                p.y() + (side < 0 ? 0 : s.flush_mm));
        parts.push_back(o);
    }
    if (s.ground_mm > 0) parts.push_back({{-80, -s.ground_mm}, {80, -s.ground_mm}});
    Profile heads[2];
    Pose poses[2];
    for (const int h : {0, 1}) {
        Profile& p = heads[h];
        const double b = (h == 0 ? 1 : -1) * (0.4 + 0.15 * uniform(engine));
        poses[h] = make_pose(rotation_exp({0, b, 0}), {s.gap_mm / 2, 0, 0});
        for (double line = -18 + s.pitch_mm * uniform(engine); line < 18; line += s.pitch_mm) {
            const Eigen::Vector3d from = poses[h] * Eigen::Vector3d(0, 0, 120),
                                  to = poses[h] * Eigen::Vector3d(line, 0, 0);
            const Eigen::Vector2d o(from.x(), from.z()), d(to.x() - from.x(), to.z() - from.z());
            double first = 1e9;
            for (const HeadsSheet& part : parts)
                for (std::size_t i = 0; i + 1 < part.size(); ++i) {
                    const Eigen::Vector2d e = part[i + 1] - part[i], w = part[i] - o;
                    const double cross = d.x() * e.y() - d.y() * e.x();
                    const double t = (w.x() * e.y() - w.y() * e.x()) / cross,
                                 u = (w.x() * d.y() - w.y() * d.x()) / cross;
                    const bool grazed = std::abs(cross) < 0.08 * d.norm() * e.norm();
                    if (u >= 0 && u <= 1 && t > 0 && t < first && !grazed) first = t;
                }
            const double t = first + s.noise_mm * normal(engine) / d.norm();
            p.x_mm.push_back(line * t);
            p.z_mm.push_back(first < 1e8 ? 120 - 120 * t : std::nan(""));
        }
        EXPECT_TRUE(filter_profile(p, {}));
    }
    const auto merged = merge_heads(heads[0], {poses[0], s.noise_mm}, heads[1], {poses[1], s.noise_mm});
    EXPECT_TRUE(merged);
    return GapFlushGauge({}).measure(merged->profile);
}

TEST(GapHeads, NeitherTheGroundNorTheFarFaceIsThePanelOfADoubleHead) {
    std::mt19937_64 engine(61);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (const bool hem : {false, true})
        for (const bool ground : {false, true}) {
            int ok = 0, far = 0;
            for (int trial = 0; trial < 100; ++trial) {
                const TwoHeads s{2 + 6 * uniform(engine),
                                 6 * uniform(engine) - 3,
                                 0.3 + 0.9 * uniform(engine),
                                 0.1,
                                 0.03,
                                 ground ? 5 + 2 * uniform(engine) : 0,
                                 hem};
                const GapFlush g = seen_by_two(s, engine);
                if (g.status != GapFlushStatus::ok) continue;
                ++ok;
                far += std::abs(g.gap_mm - s.gap_mm) > 0.4 || std::abs(g.flush_mm - s.flush_mm) > 0.3;
            }
            EXPECT_GE(ok, 97) << hem << ground;
            EXPECT_EQ(far, 0) << hem << ground;
        }
}

// Of a sensor whose rays spread from one place the noise moves a return along its ray, in x as well.
TEST(GapHeads, NoiseAlongTheRaysIsNoSecondHead) {
    std::mt19937_64 engine(62);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::normal_distribution<double> normal;
    constexpr double kStand_mm = 150;
    for (const auto& [pitch, noise] : {std::pair(0.03, 0.02), std::pair(0.03, 0.05), std::pair(0.05, 0.05)}) {
        int ok = 0, far = 0;
        for (int trial = 0; trial < 60; ++trial) {
            const double gap = 2 + 6 * uniform(engine), flush = 6 * uniform(engine) - 3,
                         ground = 6 + 9 * uniform(engine);
            // Flat sheets that end square: a ray meets the first level that it crosses within its reach, or a face.
            const double left = -gap / 2, right = gap / 2;
            Profile p;
            for (double line = -25 + pitch * uniform(engine); line < 25; line += pitch) {
                const auto at = [&](double height) { return line * (kStand_mm - height) / kStand_mm; };
                double z = -ground;
                if (at(0) <= left)
                    z = 0;
                else if (at(flush) >= right)
                    z = flush;
                else if (line < 0 && at(-3) < left)
                    z = kStand_mm * (1 - left / line);
                else if (line > 0 && at(flush - 3) > right)
                    z = kStand_mm * (1 - right / line);
                z += noise * normal(engine);
                p.x_mm.push_back(at(z));
                p.z_mm.push_back(z);
            }
            EXPECT_TRUE(filter_profile(p, {}));
            const GapFlush g = GapFlushGauge({}).measure(p);
            if (g.status != GapFlushStatus::ok) continue;
            ++ok;
            far += std::abs(g.gap_mm - gap) > 0.5 || std::abs(g.flush_mm - flush) > 0.3;
        }
        EXPECT_GE(ok, 59) << pitch << " " << noise;
        EXPECT_EQ(far, 0) << pitch << " " << noise;
    }
}

}  // namespace
}  // namespace seamwright
