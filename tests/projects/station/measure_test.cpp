#include "projects/measure/measure.h"
#include "projects/measure/reference_feature.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/features/kinds/feature_registry.h"
#include "tests/allocations.h"
#include "tests/projects/fake_cell.h"
#include "tests/projects/sample_project.h"
#include "tests/projects/stripe_frame.h"

namespace seamwright {
namespace {

constexpr StripeGhost kFaint{110};

Project image_project() {
    Project project = make_fake_cell()->project;
    project.calibrations[0].model = stripe_camera();
    return project;
}

TEST(Measure, ImageToPointInMillimetres) {
    const Project project = image_project();
    auto measurer = SpotMeasurer::make(project, "S1");
    ASSERT_TRUE(measurer) << measurer.error().sentence();
    Frame frame;
    for (const bool ghost : {false, true}) {
        draw_stripe(frame, stripe_camera(), 12.3, 5.0, 0.1, ghost ? kFaint : StripeGhost{});
        const SpotMeasurement& m = measurer->measure(frame);
        ASSERT_EQ(m.status, SpotStatus::measured) << m.message;
        EXPECT_NEAR(m.feature.point_mm.x(), 12.3, 0.25);  // the pitch is 0.2 mm
        EXPECT_NEAR(m.feature.point_mm.y(), 5.0 + 0.1 * m.feature.point_mm.x(), 0.02);
        EXPECT_EQ(m.measured_mm.x(), m.feature.point_mm.x());
        EXPECT_EQ(m.measured_mm.y(), 0);
        EXPECT_NEAR(m.sigma_mm, std::sqrt(0.03 * 0.03 + 0.5 * m.feature.covariance_mm2.trace()), 1e-12);
        EXPECT_GT(measurer->capture().candidates.lines, 0);

        // The same from the capture, and from a capture with its image.
        const std::string text = exact_text(m);
        Capture stored = measurer->capture();
        EXPECT_EQ(exact_text(measurer->measure(stored)), text);
        stored.image = StoredImage{640, 480, 8, frame.pixels};
        EXPECT_EQ(exact_text(measurer->measure(stored)), text);
        stored.candidates = {};
        EXPECT_EQ(exact_text(measurer->measure(stored)), text);
    }
}

// Brighter than the stripe and of its shape: the reference profile tells, where it can.
TEST(Measure, AGhostIsToldByTheReferenceProfile) {
    Project project = image_project();
    Frame frame;
    draw_stripe(frame, stripe_camera(), 12.3, 5.0, 0.1);
    {
        auto teaching = SpotMeasurer::make(project, "S1");
        ASSERT_TRUE(teaching);
        const SpotMeasurement& m = teaching->measure(frame);
        ASSERT_EQ(m.status, SpotStatus::measured);
        project.spots[0].reference_profile = teaching->profile();
        project.spots[0].reference_mm = m.measured_mm;
    }
    Project untaught = project;
    untaught.spots[0].reference_profile = {};
    auto measurer = SpotMeasurer::make(project, "S1"), alone = SpotMeasurer::make(untaught, "S1");
    ASSERT_TRUE(measurer && alone);

    // Over the end of the contour only.
    for (const double rows : {-50., 45., 70.}) {
        draw_stripe(frame, stripe_camera(), 13.1, 5.4, 0.1, {255, rows, 260});
        const SpotMeasurement& m = measurer->measure(frame);
        ASSERT_EQ(m.status, SpotStatus::measured) << m.message << ", " << rows << " rows";
        EXPECT_NEAR(m.feature.point_mm.x(), 13.1, 0.25);
        EXPECT_NEAR(m.feature.point_mm.y(), 5.4 + 0.1 * m.feature.point_mm.x(), 0.05);
        EXPECT_EQ(exact_text(measurer->measure(Capture(measurer->capture()))), exact_text(m));
    }
    // As long as the stripe: nothing tells, and that is said.
    draw_stripe(frame, stripe_camera(), 12.3, 5.0, 0.1, {255, 60, 0});
    EXPECT_EQ(alone->measure(frame).status, SpotStatus::measured) << "one of the two";
    const SpotMeasurement& m = measurer->measure(frame);
    EXPECT_EQ(m.status, SpotStatus::no_feature);
    EXPECT_EQ(m.feature.status, FeatureStatus::ambiguous);
    EXPECT_THAT(m.message.english(), testing::HasSubstr("two contours"));
}

TEST(Measure, FinishedProfileSkipsTheImage) {
    auto cell = make_fake_cell();
    auto measurer = SpotMeasurer::make(cell->project, "S1");
    ASSERT_TRUE(measurer);
    Frame frame;
    draw_stripe(frame, stripe_camera(), 12.3, 5.0, 0.1);
    frame.profile = cell->cut(cell->project.spots[0]);
    const SpotMeasurement& m = measurer->measure(frame);
    ASSERT_EQ(m.status, SpotStatus::measured) << m.message;
    EXPECT_NEAR(m.feature.point_mm.x(), 1.5, 1e-9);
    EXPECT_EQ(measurer->peaks().lines, 0);
    EXPECT_EQ(measurer->capture().candidates.lines, 0);
}

TEST(Measure, DamagedEmptyAndUncalibratedFrames) {
    Project project = image_project();
    auto measurer = SpotMeasurer::make(project, "S1");
    ASSERT_TRUE(measurer);
    Frame frame;
    draw_stripe(frame, stripe_camera(), 12.3, 5.0, 0.1);
    for (const FrameStatus status : {FrameStatus::incomplete, FrameStatus::corrupt, FrameStatus::late}) {
        frame.status = status;
        EXPECT_EQ(measurer->measure(frame).status, SpotStatus::damaged_frame);
        EXPECT_EQ(measurer->capture().candidates.lines, 0);
    }
    EXPECT_EQ(measurer->measure(Frame{}).status, SpotStatus::no_stripe);
    frame.status = FrameStatus::ok;
    std::fill(frame.pixels.begin(), frame.pixels.end(), std::byte{8});
    EXPECT_EQ(measurer->measure(frame).status, SpotStatus::no_stripe);
    Frame uneven;
    uneven.profile.x_mm = {1, 2, 3};
    uneven.profile.z_mm = {1};
    EXPECT_EQ(measurer->measure(uneven).status, SpotStatus::damaged_frame);

    project.sensors[0].calibration_id.clear();
    measurer = SpotMeasurer::make(project, "S1");
    ASSERT_TRUE(measurer);
    draw_stripe(frame, stripe_camera(), 12.3, 5.0, 0.1);
    EXPECT_EQ(measurer->measure(frame).status, SpotStatus::no_calibration);
    // A finished profile gives its feature; no correction uses it.
    auto cell = make_fake_cell();
    Frame profile;
    profile.profile = cell->cut(cell->project.spots[0]);
    const SpotMeasurement& m = measurer->measure(profile);
    EXPECT_EQ(m.status, SpotStatus::measured);
    const auto regions = correct_regions(project, std::span(&m, 1));
    EXPECT_FALSE(regions[0].correction);
    EXPECT_THAT(regions[0].refusals, testing::ElementsAre(testing::HasSubstr("no calibration")));
}

TEST(Measure, AfterABadFrameNothingStays) {
    auto cell = make_fake_cell();
    auto measurer = SpotMeasurer::make(cell->project, "S1");
    Frame frame;
    frame.profile = cell->cut(cell->project.spots[0]);
    ASSERT_EQ(measurer->measure(frame).status, SpotStatus::measured);
    frame.status = FrameStatus::corrupt;
    const SpotMeasurement& m = measurer->measure(frame);
    EXPECT_TRUE(std::isnan(m.feature.point_mm.x()));
    EXPECT_EQ(m.measured_mm.norm(), 0);
    EXPECT_EQ(measurer->profile().size(), 0u);
    frame.status = FrameStatus::ok;
    EXPECT_TRUE(measurer->measure(frame).message.empty());
}

TEST(Measure, ReportedPoseThatIsNoPoseIsNotUsed) {
    auto cell = make_fake_cell();
    auto measurer = SpotMeasurer::make(cell->project, "S1");
    Frame frame;
    frame.profile = cell->cut(cell->project.spots[0]);
    Pose bad = cell->project.spots[0].base_from_flange;
    bad(1, 3) = std::nan("");
    EXPECT_EQ(measurer->measure(frame, bad).status, SpotStatus::not_measured);
    EXPECT_EQ(measurer->measure(frame).status, SpotStatus::measured);
}

TEST(Measure, InTaughtSensorIsTheSamePointInBase) {
    std::mt19937 rng(2);
    std::normal_distribution<double> n;
    SampleMaker make(3);
    for (int i = 0; i < 50; ++i) {
        const Pose taught = make.pose(), flange_from_sensor = make.pose();
        const Pose reported = retract(taught, 0.01 * Vector6::NullaryExpr([&] { return n(rng); }));
        const Eigen::Vector2d point(n(rng) * 20, n(rng) * 20);
        const Eigen::Vector3d back = in_taught_sensor(point, flange_from_sensor, taught, reported);
        EXPECT_LT((taught * flange_from_sensor * back -
                   reported * flange_from_sensor * Eigen::Vector3d(point.x(), 0, point.y()))
                      .norm(),
                  1e-9);
        EXPECT_EQ(in_taught_sensor(point, flange_from_sensor, taught, std::nullopt),
                  Eigen::Vector3d(point.x(), 0, point.y()));
    }
}

TEST(Measure, UnknownThingsAreErrors) {
    Project project = make_fake_cell()->project;
    EXPECT_FALSE(SpotMeasurer::make(project, "S99"));
    project.spots[0].feature.kind = "nose";
    auto kind = SpotMeasurer::make(project, "S1");
    ASSERT_FALSE(kind);
    EXPECT_THAT(kind.error().sentence(), testing::HasSubstr("spot S1"));
    project.spots[1].sensor_id = "Z";
    EXPECT_FALSE(SpotMeasurer::make(project, "S2"));
}

// Makes a roof of a flat cut.
void bend(Profile& profile) {
    for (std::size_t k = 0; k < 150; ++k) profile.z_mm[k] += 0.5 * (profile.x_mm[k] + 6);
}

// The hot path of a run: frame to measured point.
TEST(Allocations, NoneAfterTheFirstProfile) {
    auto cell = make_fake_cell();
    cell->noise_mm = 0.01;
    Project project = image_project();
    project.spots[1].feature = {};
    project.spots[1].feature.kind = "template";
    project.spots[1].feature.template_profile = cell->cut(cell->project.spots[1]);
    bend(project.spots[1].feature.template_profile);
    project.spots[1].feature.template_reference_mm = {1.5, -2};
    project.spots[2].feature = {};
    project.spots[2].feature.kind = "corner";
    for (const char* id : {"S1", "S2", "S3"}) {
        auto measurer = SpotMeasurer::make(project, id);
        ASSERT_TRUE(measurer) << measurer.error().sentence();
        std::vector<Frame> frames(6);
        for (std::size_t i = 0; i < frames.size(); ++i) {
            if (std::string(id) == "S1") {
                draw_stripe(frames[i], stripe_camera(), 12.7 - 0.2 * static_cast<double>(i % 3), 5.0, 0.1,
                            kFaint);
            } else {
                frames[i].profile = cell->cut(cell->project.spots[1]);
                bend(frames[i].profile);
            }
        }
        const std::optional<Pose> reported = project.spots[0].base_from_flange;
        measurer->measure(frames[0], reported);
        // The matcher's lists of candidates are as long as the noise makes them: it sees each profile once.
        if (std::string(id) == "S2")
            for (const Frame& frame : frames) measurer->measure(frame, reported);
        const long before = allocations_so_far();
        for (const Frame& frame : frames) measurer->measure(frame, reported);
        const long during = allocations_so_far() - before;
        EXPECT_EQ(during, 0) << "spot " << id;
        EXPECT_EQ(measurer->measure(frames[0], reported).status, SpotStatus::measured)
            << measurer->measure(frames[0]).message;
    }
}

// Remembered answers are those of the finder, and of nothing but the same question.
TEST(ReferenceFeature, IsWhatTheRecipeFindsThere) {
    Spot spot;
    spot.feature.kind = "contour-end";
    spot.feature.parameters = {{"side", 1}};
    for (int i = 0; i < 200; ++i) {
        spot.reference_profile.x_mm.push_back(0.1 * i);
        spot.reference_profile.z_mm.push_back(0.01 * std::sin(12.9 * i));
        spot.reference_profile.segment.push_back(0);
    }
    const auto as_found = [&] {
        const Feature found = make_feature_finder(spot.feature).value()->find(spot.reference_profile);
        EXPECT_EQ(found.status, FeatureStatus::ok);
        for (int again = 0; again < 2; ++again) {
            const auto known = feature_at_reference(spot);
            EXPECT_TRUE(known && known->point_mm == found.point_mm &&
                        known->covariance_mm2 == found.covariance_mm2);
        }
        return found.point_mm;
    };
    const Eigen::Vector2d first = as_found();
    for (double& x : spot.reference_profile.x_mm) x += 0.25;
    const Eigen::Vector2d moved = as_found();
    EXPECT_NEAR(moved.x() - first.x(), 0.25, 1e-6);
    spot.feature.parameters["side"] = 0;
    EXPECT_LT(as_found().x(), moved.x() - 10);
    spot.reference_profile.clear();
    EXPECT_FALSE(feature_at_reference(spot));
}

}  // namespace
}  // namespace seamwright
