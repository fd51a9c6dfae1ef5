// Every frame with one to three stray reflections, as smooth as the stripe and up to twice as bright: the spots that a
// template finds by the frame alone, and with what was taught. SEAMWRIGHT_TRIALS: frames.

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "core/features/kinds/feature_registry.h"
#include "core/features/registration/taught_stripe.h"
#include "core/profile/stripe/peaks.h"
#include "devices/simulated/cell.h"

namespace seamwright {
namespace {

constexpr double kWrong_mm = 0.3;

struct Tally {
    long right = 0, refused = 0, wrong = 0;
    void add(const Feature& f, const Eigen::Vector2d& truth) {
        ++(f.status != FeatureStatus::ok ? refused : (f.point_mm - truth).norm() < kWrong_mm ? right : wrong);
    }
};

struct TaughtSpot {
    Pose base_from_flange;
    std::unique_ptr<FeatureFinder> finder;
    std::optional<TaughtStripe> stripe;
    Eigen::Vector2d reference;
};

void candidates_of(SimulatedCell& cell, const Pose& base_from_flange, std::uint64_t seed,
                   ProfileCandidates& out) {
    thread_local Frame frame;
    thread_local StripePeaks peaks;
    cell.render(base_from_flange, seed, frame, nullptr);
    ASSERT_TRUE(find_peaks(frame.image, {}, peaks));
    to_millimetres(peaks, cell.sensor_model(), out);
}

TEST(GhostFrames, ASpotIsMeasuredRightOrNotAtAll) {
    const char* wanted = std::getenv("SEAMWRIGHT_TRIALS");
    const long frames = wanted ? std::atol(wanted) : 100000;
    Tally alone, told;
    long refused_now = 0, wrong_now = 0;
    ProfileCandidates candidates;
    Profile profile;
    for (const double gloss : {0.4, 1.0}) {
        CellSettings settings = default_cell_settings();
        settings.noise.stray_probability = 0;
        settings.surface.mirror = 1;
        settings.surface.gloss = gloss;
        const auto calm = SimulatedCell::open(settings).value();
        settings.noise.stray_probability = 1;
        const auto cell = SimulatedCell::open(settings).value();
        std::vector<TaughtSpot> spots;
        for (const DoorSpot& spot : default_door_spots()) {
            TaughtSpot t;
            t.base_from_flange = calm->flange_for(spot.workobject_from_sensor);
            candidates_of(*calm, t.base_from_flange, 1, candidates);
            ASSERT_TRUE(track_stripe(candidates, {}, profile));
            FeatureRecipe recipe{"template", {}, {}, Eigen::Vector2d::Zero()};
            for (std::size_t i = 0; i < profile.size(); ++i) {
                if (profile.segment[i] == kOutlier || !(profile.x_mm[i] < 27)) continue;
                recipe.template_profile.x_mm.push_back(profile.x_mm[i]);
                recipe.template_profile.z_mm.push_back(profile.z_mm[i]);
                recipe.template_profile.segment.push_back(profile.segment[i]);
            }
            t.finder = make_feature_finder(recipe).value();
            const Feature taught = t.finder->find(profile);
            ASSERT_EQ(taught.status, FeatureStatus::ok);
            t.reference = taught.point_mm;
            t.stripe = TaughtStripe::make(profile, t.reference, search_window(recipe)).value();
            spots.push_back(std::move(t));
        }
        for (long k = 0; k < frames / 2; ++k) {
            TaughtSpot& spot = spots[static_cast<std::size_t>(k) % spots.size()];
            const auto seed = static_cast<std::uint64_t>(k + 2);
            candidates_of(*cell, spot.base_from_flange, seed, candidates);
            ASSERT_TRUE(track_stripe(candidates, {}, profile));
            const Feature by_frame = spot.finder->find(profile);
            alone.add(by_frame, spot.reference);
            const auto choice = spot.stripe->track(candidates, {}, profile);
            ASSERT_TRUE(choice);
            Feature by_taught = spot.finder->find(profile);
            if (*choice == StripeChoice::undecided) by_taught.status = FeatureStatus::ambiguous;
            told.add(by_taught, spot.reference);
            if (by_frame.status == FeatureStatus::ok &&
                (by_frame.point_mm - spot.reference).norm() < kWrong_mm) {
                refused_now += by_taught.status != FeatureStatus::ok;
                wrong_now += by_taught.status == FeatureStatus::ok &&
                             !((by_taught.point_mm - spot.reference).norm() < kWrong_mm);
            }
        }
    }
    std::printf(
        "%ld frames, each with stray reflections: by the frame alone right %ld, refused %ld, wrong %ld; with "
        "what was "
        "taught right %ld, refused %ld, wrong %ld (right before and refused now %ld, wrong now %ld)\n",
        frames, alone.right, alone.refused, alone.wrong, told.right, told.refused, told.wrong, refused_now,
        wrong_now);
    EXPECT_LE(static_cast<double>(told.wrong), 1e-5 * static_cast<double>(frames));
    EXPECT_LE(told.refused, alone.refused);
    EXPECT_GE(static_cast<double>(told.right), 0.999 * static_cast<double>(frames));
}

}  // namespace
}  // namespace seamwright
