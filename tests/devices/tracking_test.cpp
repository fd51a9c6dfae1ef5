// The stripe among its reflections on rendered frames: image -> peaks -> millimetres -> tracking, against
// what the renderer drew.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "core/profile/filter.h"
#include "core/profile/stripe/peaks.h"
#include "devices/simulated/cell.h"

namespace seamwright {
namespace {

constexpr double kNear_mm = 0.15;
constexpr float kSeenElectrons = 400;  // ten grey values of 8 bit, five times the noise of a pixel
constexpr float kRim_px = 6;           // a stripe that runs out of the image has no middle

// Columns in which the stripe is really seen, and of them those whose point is on it. A column may hold the
// stripe more than once, on both sides of a step.
class Truth {
  public:
    Truth(const std::vector<StripeSample>& samples, int lines, int height) : at_(std::size_t(lines)) {
        for (const StripeSample& s : samples) {
            const auto line = static_cast<long>(std::lround(s.u_px));
            if (s.ghost || s.electrons < kSeenElectrons || line < 0 || line >= lines) continue;
            if (s.v_px > kRim_px && s.v_px < float(height) - kRim_px) at_[std::size_t(line)].push_back(s);
        }
    }
    bool seen(std::size_t line) const { return !at_[line].empty(); }
    bool on_stripe(std::size_t line, double x_mm, double z_mm) const {
        const std::size_t first = line > 0 ? line - 1 : 0, last = std::min(line + 1, at_.size() - 1);
        for (std::size_t k = first; k <= last; ++k)
            for (const StripeSample& s : at_[k])
                if (std::hypot(x_mm - double(s.x_mm), z_mm - double(s.z_mm)) < kNear_mm) return true;
        return false;
    }

  private:
    std::vector<std::vector<StripeSample>> at_;
};

struct Shares {
    int frames = 0, columns = 0, offered = 0, tracked = 0, strongest = 0;
    double of(int count) const { return columns ? 100.0 * count / columns : 0; }
};

Shares measure(const CellSettings& settings, std::uint64_t first_seed, std::uint64_t seeds) {
    Shares shares;
    const auto cell = SimulatedCell::open(settings);
    if (!cell) {
        ADD_FAILURE() << cell.error().sentence();
        return shares;
    }
    Frame frame;
    std::vector<StripeSample> samples;
    StripePeaks peaks;
    ProfileCandidates candidates;
    Profile profile;
    std::uint64_t number = first_seed;
    for (const DoorSpot& spot : default_door_spots()) {
        for (std::uint64_t k = 0; k < seeds; ++k) {
            (*cell)->render((*cell)->flange_for(spot.workobject_from_sensor), ++number, frame, &samples);
            EXPECT_TRUE(find_peaks(frame.image, {}, peaks));
            to_millimetres(peaks, (*cell)->sensor_model(), candidates);
            EXPECT_TRUE(track_stripe(candidates, {}, profile));
            const Truth truth(samples, candidates.lines, settings.optics.height);
            ++shares.frames;
            for (int line = 0; line < candidates.lines; ++line) {
                const auto at = std::size_t(line);
                if (!truth.seen(at)) continue;
                ++shares.columns;
                const auto right = [&](int c) {
                    const auto slot = std::size_t(candidates.index(line, c));
                    return truth.on_stripe(at, candidates.x_mm[slot], candidates.z_mm[slot]);
                };
                int strongest = 0;
                bool offered = false;
                for (int c = 0; c < candidates.count[at]; ++c) {
                    offered |= right(c);
                    if (candidates.intensity[std::size_t(candidates.index(line, c))] >
                        candidates.intensity[std::size_t(candidates.index(line, strongest))])
                        strongest = c;
                }
                shares.offered += offered;
                shares.strongest += candidates.count[at] > 0 && right(strongest);
                shares.tracked +=
                    profile.segment[at] >= 0 && truth.on_stripe(at, profile.x_mm[at], profile.z_mm[at]);
            }
        }
    }
    std::printf(
        "%d frames, %d columns with stripe: found among the peaks %.2f %%, tracked %.2f %%, strongest "
        "peak %.2f %%\n",
        shares.frames, shares.columns, shares.of(shares.offered), shares.of(shares.tracked),
        shares.of(shares.strongest));
    return shares;
}

// Every frame with one to three stray reflections, each a copy of up to 30 % of the stripe, 0.3 to 2 times as
// bright; beside them the second bounce of glossy sheet.
TEST(Tracking, KeepsTheStripeAmongDoubleReflections) {
    CellSettings settings = default_cell_settings();
    settings.noise.stray_probability = 1;
    settings.surface.mirror = 1;
    struct Look {
        double gloss, albedo, exposure_us;
    };
    Shares all;
    for (const Look look :
         {Look{0.4, 0.5, 1000}, Look{1.0, 0.5, 1000}, Look{1.0, 0.5, 2500}, Look{0.2, 0.3, 700}}) {
        settings.surface.gloss = look.gloss;
        settings.surface.albedo = look.albedo;
        settings.exposure.exposure_us = look.exposure_us;
        const Shares shares = measure(settings, std::uint64_t(all.frames) + 1, 5);
        EXPECT_EQ(shares.frames, 60);
        EXPECT_GT(shares.columns, 60 * 700);
        EXPECT_GE(shares.of(shares.tracked), 97.5) << "gloss " << look.gloss;
        all.frames += shares.frames, all.columns += shares.columns, all.offered += shares.offered;
        all.tracked += shares.tracked, all.strongest += shares.strongest;
    }
    std::printf("all: tracked %.2f %%, strongest peak %.2f %%\n", all.of(all.tracked), all.of(all.strongest));
    EXPECT_GE(all.of(all.tracked), 98.0);
    EXPECT_LT(all.of(all.strongest), 90.0);
}

TEST(Tracking, LosesNothingWithoutReflections) {
    CellSettings settings = default_cell_settings();
    settings.noise.stray_probability = 0;
    const Shares shares = measure(settings, 1000, 1);
    EXPECT_GE(shares.of(shares.tracked), 99.0);
}

}  // namespace
}  // namespace seamwright
