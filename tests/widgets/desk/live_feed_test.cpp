// What the screens get of a fast sensor when the feature takes longer to find than the frames leave time.
#include "widgets/worker/live_feed.h"

#include <gtest/gtest.h>

#include "core/features/registration/taught_stripe.h"
#include "tests/projects/stripe_frame.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <thread>

namespace seamwright {
namespace {

using namespace std::chrono_literals;

constexpr int kPoints = 2048;
constexpr double kStep_mm = -15;  // where the contour steps down, before it is moved

Profile stepped(double shift_mm, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, 0.02);
    Profile p;
    for (int i = 0; i < kPoints; ++i) {
        const double x = -50 + 100.0 * i / kPoints, u = x - shift_mm;
        p.x_mm.push_back(x);
        p.z_mm.push_back((u < kStep_mm ? 0
                          : u < 12     ? -0.8
                                       : std::max(-14.0, -0.8 - 0.8 * (u - 12))) +
                         noise(random));
    }
    return p;
}

// Shows whatever it is given.
class Shown : public ProfileSource {
  public:
    void show(Profile profile) {
        auto frame = std::make_shared<Frame>();
        frame->profile = std::move(profile);
        show(std::move(frame));
    }
    void show(std::shared_ptr<Frame> frame) {
        frame->sequence = ++number_;
        frame->host_time_ns = static_cast<std::int64_t>(number_) * 1'000'000;
        const std::lock_guard lock(mutex_);
        newest_ = std::move(frame);
    }
    FramePtr latest() const override {
        const std::lock_guard lock(mutex_);
        return newest_;
    }
    SensorIdentity identity() const override { return {"test", "", "", ""}; }
    Expected<void> start() override { return {}; }
    void stop() override {}
    Expected<void> trigger(const std::string&) override { return {}; }
    Expected<FramePtr> wait_next(std::chrono::milliseconds) override { return latest(); }
    SourceCounters counters() const override { return {}; }
    std::vector<ParameterInfo> parameters() const override { return {}; }
    Expected<double> get(const std::string&) const override { return 0.0; }
    Expected<void> set(const std::string&, double) override { return {}; }

  private:
    mutable std::mutex mutex_;
    FramePtr newest_;
    std::uint64_t number_ = 0;
};

template <class Met>
bool within(std::chrono::milliseconds time, const Met& met) {
    for (const auto until = std::chrono::steady_clock::now() + time; std::chrono::steady_clock::now() < until;
         std::this_thread::sleep_for(1ms))
        if (met()) return true;
    return met();
}

TEST(LiveFeed, EveryProfileIsShownAndTheLastOneHasItsOwnFeature) {
    Shown sensor;
    LiveFeed feed;
    LiveRecipe recipe;
    recipe.feature.emplace();
    recipe.feature->kind = "template";
    const Profile taught = stepped(0, 1);
    for (std::size_t i = 0; i < taught.size(); ++i)
        if (taught.x_mm[i] > 2 && taught.x_mm[i] < 26) {
            recipe.feature->template_profile.x_mm.push_back(taught.x_mm[i]);
            recipe.feature->template_profile.z_mm.push_back(taught.z_mm[i]);
        }
    recipe.feature->template_reference_mm = {12, -0.8};
    feed.set_recipe("A", recipe);
    feed.attach({{"A", &sensor}});
    double shift_mm = 0;
    for (int i = 0; i < 40; ++i) {
        shift_mm = 0.1 * i;
        sensor.show(stepped(shift_mm, static_cast<unsigned>(i)));
        const auto number = static_cast<std::uint64_t>(i) + 1;
        ASSERT_TRUE(within(5000ms, [&] {
            const auto seen = feed.latest("A");
            return seen && seen->frame->sequence == number;
        }));
        EXPECT_TRUE(feed.latest("A")->feature) << "one that was found shortly before, at least";
    }
    const auto right = [&] {
        const auto seen = feed.latest("A");
        return seen->feature->status == FeatureStatus::ok &&
               std::abs(seen->feature->point_mm.x() - (12 + shift_mm)) < 0.05;
    };
    EXPECT_TRUE(within(2000ms, right)) << "x = " << feed.latest("A")->feature->point_mm.x();
    EXPECT_EQ(feed.latest("A")->frame->sequence, 40U);
    feed.detach();
}

TEST(LiveFeed, AnotherRecipeCountsFromTheNextProfile) {
    Shown sensor;
    LiveFeed feed;
    feed.attach({{"A", &sensor}});
    sensor.show(stepped(0, 1));
    ASSERT_TRUE(within(5000ms, [&] { return feed.latest("A") != nullptr; }));
    EXPECT_FALSE(feed.latest("A")->feature);
    EXPECT_TRUE(feed.latest("A")->profile.filtered());
    LiveRecipe recipe;
    recipe.feature.emplace();  // the contour's end
    feed.set_recipe("A", recipe);
    sensor.show(stepped(0, 2));
    EXPECT_TRUE(within(5000ms, [&] { return feed.latest("A")->feature.has_value(); }));
    feed.set_recipe("A", {});
    sensor.show(stepped(0, 3));
    EXPECT_TRUE(within(5000ms, [&] { return !feed.latest("A")->feature; }));
    feed.detach();
}

// The desk must not show the reflection where a run measures the stripe.
TEST(LiveFeed, AReflectionIsToldByTheReferenceProfileAsInARun) {
    Shown sensor;
    LiveFeed feed;
    LiveRecipe recipe;
    recipe.model = stripe_camera();
    recipe.feature.emplace();  // the contour's end
    recipe.feature->parameters = {{"side", 1}};
    feed.set_recipe("A", recipe);
    feed.attach({{"A", &sensor}});
    const auto shown = [&](double end_mm, double height_mm, const StripeGhost& ghost) {
        auto frame = std::make_shared<Frame>();
        draw_stripe(*frame, *recipe.model, end_mm, height_mm, 0.1, ghost);
        sensor.show(frame);
        EXPECT_TRUE(within(5000ms, [&] {
            const auto seen = feed.latest("A");
            return seen && seen->frame == frame && seen->feature;
        }));
        return feed.latest("A");
    };
    const auto taught = shown(12.3, 5, {});
    ASSERT_EQ(taught->feature->status, FeatureStatus::ok);
    recipe.taught = taught->profile;
    recipe.taught_at_mm = taught->feature->point_mm;
    EXPECT_EQ(shown(12.3, 5, {255, 60, 0})->feature->status, FeatureStatus::ok) << "one of two, untaught";
    feed.set_recipe("A", recipe);
    const auto told = shown(13.1, 5.4, {255, 45, 260});
    EXPECT_EQ(told->feature->status, FeatureStatus::ok);
    EXPECT_NEAR(told->feature->point_mm.x(), 13.1, 0.25);
    EXPECT_NEAR(told->feature->point_mm.y(), 5.4 + 0.1 * told->feature->point_mm.x(), 0.05);
    const auto either = shown(12.3, 5, {255, 60, 0});
    EXPECT_EQ(either->feature->status, FeatureStatus::ambiguous);
    EXPECT_EQ(either->feature->message.english(), kTwoContours);
    feed.detach();
}

}  // namespace
}  // namespace seamwright
