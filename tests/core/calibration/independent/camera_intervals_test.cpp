// Cameras: what they state against the truth, and halves of one data set against each other, for lenses as they are
// built and with the model left to the data.

#include <gtest/gtest.h>

#include "core/calibration/camera/camera.h"
#include "tests/core/calibration/independent/plain_world.h"

namespace seamwright {
namespace {

using namespace plain;

CameraData views(const Lens& lens, int count, double tilt, double noise_px, Dice& dice) {
    const Board board;
    CameraData data;
    data.width = lens.width;
    data.height = lens.height;
    while (static_cast<int>(data.views.size()) < count) {
        Motion view = motion(dice.box(tilt, tilt, 1), Vec3::Zero());
        const double z = lens.fx / 1450 * dice.u(300, 480);
        view.translation() =
            Vec3(0.25 * z * dice.u(-1, 1), 0.18 * z * dice.u(-1, 1), z) - view.linear() * board.middle();
        CameraPoints points;
        points.id = "v" + std::to_string(data.views.size());
        bool inside = true;
        for (int i = 0; i < board.count(); ++i) {
            points.object_mm.push_back(board.at(i));
            points.pixel.push_back(lens.see(view * board.at(i)) + noise_px * Vec2(dice.n(), dice.n()));
            inside &= lens.has(points.pixel.back(), 2);
        }
        if (inside) data.views.push_back(points);
    }
    return data;
}

struct Shares {
    std::array<Share, 9> truth, halves;
    int good = 0, answered = 0, exact = 0;
};

void run(int count, double tilt, double noise_px, int trials, Shares& s) {
    for (int trial = 0; trial < trials; ++trial) {
        Dice dice(static_cast<unsigned>(100000 * count + 31 * trial + static_cast<int>(1000 * noise_px)));
        const Lens lens = any_lens(dice);
        const double truth[] = {lens.fx, lens.fy, lens.cx, lens.cy, lens.k1, lens.k2, lens.p1, lens.p2, 0};
        std::optional<CameraResult> first;
        for (int half = 0; half < 2; ++half) {
            auto r = calibrate_camera(views(lens, count, tilt, noise_px, dice), {});
            ASSERT_TRUE(r) << r.error().sentence();
            if (r->report.covariance.size() == 0) continue;
            ++s.answered;
            s.good += r->report.judgement.verdict == Verdict::good;
            for (std::size_t i = 0; i < 9; ++i) {
                const auto& p = r->report.parameters[i];
                s.exact += !(p.sigma > 0);
                s.truth[i].add(p.value - truth[i], std::max(p.sigma, 1e-12));
                if (!first) continue;
                const auto& q = first->report.parameters[i];
                s.halves[i].add(p.value - q.value, std::max(std::hypot(p.sigma, q.sigma), 1e-12));
            }
            if (!first) first = std::move(*r);
        }
    }
}

TEST(CameraIntervals, HoldTheTruthAndTheOtherHalf) {
    constexpr int kTrials = 30;  // two cameras each
    Shares all;
    for (const auto& [count, tilt] : {std::pair{5, 0.5}, {10, 0.5}, {10, 0.2}, {20, 0.5}})
        for (const double px : {0.05, 0.3}) {
            Shares s;
            run(count, tilt, px, kTrials, s);
            EXPECT_EQ(s.answered, 2 * kTrials) << count << " views, " << px << " px";
            EXPECT_EQ(s.exact, 0) << "nothing that a camera has is known exactly";
            for (std::size_t i = 0; i < 9; ++i) {
                all.truth[i].add(s.truth[i]);
                all.halves[i].add(s.halves[i]);
            }
        }
    for (std::size_t i = 0; i < 9; ++i) {
        all.truth[i].print(kIntrinsicNames[i]);
        all.halves[i].print(std::string("  halves ") + kIntrinsicNames[i]);
        // Four standard deviations of a share of 480, and of 240.
        EXPECT_NEAR(all.truth[i].value(), 0.95, 0.04) << kIntrinsicNames[i];
        EXPECT_NEAR(all.halves[i].value(), 0.95, 0.056) << kIntrinsicNames[i];
    }
}

}  // namespace
}  // namespace seamwright
