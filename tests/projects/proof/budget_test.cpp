// A project's budget: rows by owner, shares of the whole, the correction's own sigma, Monte Carlo of the real
// estimator beside it, refusals in one sentence.

#include "projects/proof/budget.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/correction/predicted.h"
#include "core/correction/travel.h"
#include "core/geometry/notation.h"
#include "projects/measure/measure.h"
#include "projects/proof/budget/budget_json.h"
#include "projects/proof/budget/budget_page.h"
#include "projects/proof/path_direction.h"
#include "tests/projects/fake_cell.h"

namespace seamwright {
namespace {

using testing::HasSubstr;
using testing::Not;

Matrix6 arrival(double mm, double deg) {
    Vector6 size;
    size << Eigen::Vector3d::Constant(mm), Eigen::Vector3d::Constant(rad_from_deg(deg));
    return size.cwiseAbs2().asDiagonal();
}

// Everything that a project can state.
Project stated_project() {
    Project p = make_fake_cell(8)->project;
    for (Spot& s : p.spots) s.sigma_mm = 0.02, s.jitter_mm = 1;
    p.calibrations.front().covariance = arrival(0.05, 0.05);
    p.calibrations.front().method = "tcp-sphere";
    p.robots.front().arrival_covariance = arrival(0.02, 0.003);
    return p;
}

Displacement far_away() {
    return {make_pose(rotation_exp(rad_from_deg(1) * Eigen::Vector3d(1, 2, -1).normalized()), {9, -8, 9})};
}

RegionBudget budget_of(const Project& p, const BudgetOptions& options) {
    const auto budget = region_budget(p, p.regions.front(), options);
    EXPECT_TRUE(budget) << budget.error().sentence();
    return *budget;
}

const BudgetRow* row_of(const MeasurandBudget& m, ErrorSource source) {
    for (const BudgetRow& row : m.rows)
        if (row.source == source) return &row;
    return nullptr;
}

TEST(RegionBudget, RowsAddUpToTheForecastsSigma) {
    const Project p = stated_project();
    const Region& region = p.regions.front();
    for (const Displacement& d : {Displacement{}, far_away()}) {
        const RegionBudget b = budget_of(p, {d});
        EXPECT_EQ(b.status, CorrectionStatus::ok);
        ASSERT_EQ(b.measurands.size(), 8u);
        auto spots = planned_observations(p, region);
        for (SpotObservation& o : spots) {
            o.measured_mm = displaced_measure(o, d);
            add_travel(o, d, travel_window_mm(*find_spot(p, o.id)));
        }
        const auto stated = predicted_covariance(spots, correction_options(p, region), d);
        const Pose& pose = d.workobject_from_movedworkobject;
        for (const MeasurandBudget& m : b.measurands) {
            double share = 0, squares = 0, random = 0;
            for (const BudgetRow& row : m.rows) {
                share += row.share;
                squares += row.u * row.u;
                if (!is_systematic(row.source)) random += row.u * row.u;
                EXPECT_NEAR(row.sensitivity * row.input_u, row.u, 1e-12);
                EXPECT_EQ(row.owner, row.source == ErrorSource::travel ||
                                             row.source == ErrorSource::robot_run ||
                                             row.source == ErrorSource::robot_taught
                                         ? "R1"
                                         : "A");
            }
            EXPECT_NEAR(share, 1, 1e-12);
            EXPECT_NEAR(squares, m.u * m.u, 1e-12);
            EXPECT_NEAR(random, m.u_random * m.u_random, 1e-12);
            EXPECT_NEAR(m.expanded, 1.95996 * m.u, 1e-4 * m.u);  // nothing here has few degrees of freedom
        }
        for (int k = 0; k < 3; ++k)
            EXPECT_NEAR(b.measurands[static_cast<std::size_t>(2 + k)].u, std::sqrt(stated->sum(k, k)),
                        1e-9 * std::sqrt(stated->sum(k, k)));
        // Across the bead by differences: the worst of all path points.
        double worst = 0;
        for (const PathDirection& at : path_directions(p, region)) {
            Vector6 slope;
            for (int k = 0; k < 6; ++k) {
                const Vector6 step = 1e-6 * Vector6::Unit(k);
                slope[k] = (at.value(retract(pose, step)) - at.value(retract(pose, -step))) / 2e-6;
            }
            worst = std::max(worst, std::sqrt(slope.dot(stated->sum * slope)));
        }
        EXPECT_NEAR(std::max(b.measurands[0].u, b.measurands[1].u), worst, 1e-6 * worst);
    }
}

TEST(RegionBudget, OneSourceAtATime) {
    Project p = stated_project();
    const MeasurandBudget all = budget_of(p, {far_away()}).measurands[0];
    for (const ErrorSource source : {ErrorSource::stated, ErrorSource::travel, ErrorSource::robot_run,
                                     ErrorSource::robot_taught, ErrorSource::hand_eye}) {
        ASSERT_TRUE(row_of(all, source)) << to_string(source);
        EXPECT_GT(row_of(all, source)->u, 0) << to_string(source);
    }
    EXPECT_TRUE(row_of(all, ErrorSource::hand_eye)->type_a);
    EXPECT_FALSE(row_of(all, ErrorSource::stated)->type_a);
    EXPECT_NEAR(row_of(all, ErrorSource::travel)->input_u, 1 / std::sqrt(3.0), 1e-12);
    EXPECT_NEAR(row_of(all, ErrorSource::stated)->input_u, 0.02, 1e-12);
    EXPECT_EQ(row_of(budget_of(p, {}).measurands[0], ErrorSource::hand_eye)->u, 0);

    p.robots.front().arrival_covariance.setZero();
    for (Spot& s : p.spots) s.stop_at_trigger = true;
    const RegionBudget eye_only = budget_of(p, {far_away()});
    EXPECT_EQ(eye_only.measurands[0].rows.size(), 2u);  // and the spots' sigma, which is never 0
    p.calibrations.front().covariance.setZero();
    const RegionBudget bare = budget_of(p, {far_away()});
    ASSERT_EQ(bare.measurands[0].rows.size(), 1u);
    EXPECT_DOUBLE_EQ(bare.measurands[0].rows[0].share, 1);
    EXPECT_EQ(bare.measurands[0].u_systematic, 0);
    std::string remarks;
    for (const Text& r : bare.remarks) remarks += r.english() + "\n";
    EXPECT_THAT(remarks, HasSubstr("Robot R1: no repeatability"));
    EXPECT_THAT(remarks, HasSubstr("hand-eye"));
    EXPECT_THAT(remarks, HasSubstr("reference: S1, S2"));
}

TEST(RegionBudget, TheRealEstimatorAgreesAtFifteenMillimetresAndOneDegree) {
    const Project p = stated_project();
    BudgetOptions options{far_away(), true};
    options.drawing.most = 30000;
    const RegionBudget b = budget_of(p, options);
    ASSERT_TRUE(b.drawn);
    EXPECT_EQ(b.drawn->trials, 30000u);
    EXPECT_LT(b.drawn->failed, 60u);
    for (const MeasurandBudget& m : b.measurands) {
        ASSERT_TRUE(m.drawn);
        EXPECT_NEAR(m.drawn->u / m.u, 1, 0.03) << to_string(m.quantity);
        EXPECT_TRUE(m.agrees) << to_string(m.quantity);
    }
    EXPECT_TRUE(b.first_order_holds());
    options.drawing.most = 10000;
    const auto once = budget_of(p, options), again = budget_of(p, options);
    EXPECT_EQ(once.drawn->figures[3].u, again.drawn->figures[3].u);
    options.seed = 2;
    EXPECT_NE(once.drawn->figures[3].u, budget_of(p, options).drawn->figures[3].u);
}

// One spot's trigger comes anywhere in 60 mm of a contour turned by 3 degrees: no normal distribution.
TEST(RegionBudget, SaysWhereTheFirstOrderDoesNotHold) {
    Project p = make_fake_cell(4)->project;
    for (Spot& s : p.spots) s.sigma_mm = 0.005, s.jitter_mm = 0, s.stop_at_trigger = true;
    p.spots.front().stop_at_trigger = false;
    p.spots.front().jitter_mm = 30;
    BudgetOptions options{{make_pose(rotation_exp({0.02, 0.03, 0.03}), {0, 0, 0})}, true};
    options.drawing.most = 20000;
    const RegionBudget b = budget_of(p, options);
    EXPECT_FALSE(b.first_order_holds());
    const std::vector<RegionBudget> all{b};
    EXPECT_THAT(budget_page(all, {}).text(),
                HasSubstr("the first order does not hold: the 95 % limits differ"));
    EXPECT_EQ(budget_json(b)["monte_carlo"]["first_order_holds"], false);
}

TEST(RegionBudget, FewPointsMeanFewDegreesOfFreedom) {
    Project p = make_fake_cell(6)->project;
    FakeCell cell;
    cell.project = p;
    cell.noise_mm = 0.05;
    for (Spot& s : p.spots) {
        s.sigma_mm = 0.001;
        s.stop_at_trigger = true;
        s.reference_profile = cell.cut(s);
        s.reference_profile.segment.assign(s.reference_profile.size(), 0);
    }
    const RegionBudget b = budget_of(p, {});
    const BudgetRow* reference = row_of(b.measurands[0], ErrorSource::reference);
    ASSERT_TRUE(reference);
    EXPECT_TRUE(reference->type_a);
    EXPECT_TRUE(std::isfinite(reference->degrees));
    // Welch-Satterthwaite by hand.
    double sum = 0, spread = 0;
    for (const BudgetRow& row : b.measurands[0].rows) {
        sum += row.u * row.u;
        spread += std::pow(row.u, 4) / row.degrees;
    }
    EXPECT_NEAR(b.measurands[0].degrees, sum * sum / spread, 1e-6 * b.measurands[0].degrees);
    EXPECT_GT(b.measurands[0].k, 1.96);
}

TEST(RegionBudget, TheWorstIsThatOfARequiredDisplacement) {
    Project p = stated_project();
    p.calibrations.front().covariance = arrival(0.3, 0.3);
    const auto worst = worst_budget(p, p.regions.front());
    ASSERT_TRUE(worst);
    EXPECT_GT(worst->bead_u_mm(), budget_of(p, {}).bead_u_mm());
    const RegionBudget same = budget_of(p, {worst->displacement});
    EXPECT_EQ(worst->bead_u_mm(), same.bead_u_mm());
    EXPECT_EQ(worst->spot_id, same.spot_id);
    // What the region keeps fixed is passed over.
    p.regions.front().free = {true, false, false, false, false, false};
    const auto along_x = worst_budget(p, p.regions.front());
    ASSERT_TRUE(along_x) << along_x.error().sentence();
    EXPECT_EQ(along_x->measurands.size(), 3u);
}

TEST(RegionBudget, RefusesInOneSentence) {
    Project p = stated_project();
    const Region& region = p.regions.front();
    const auto refusal = [&](const Displacement& d) {
        const auto budget = region_budget(p, region, {d});
        return budget ? std::string("accepted") : budget.error().sentence();
    };
    EXPECT_THAT(refusal({make_pose(Eigen::Matrix3d::Identity(), {100, 0, 0})}), HasSubstr("limits"));
    EXPECT_THAT(refusal({make_pose(Eigen::Matrix3d::Identity(), {std::nan(""), 0, 0})}), HasSubstr("limits"));
    p.regions.front().free = {true, true, true, true, true, false};
    EXPECT_THAT(refusal(far_away()), HasSubstr("keeps c fixed"));
    EXPECT_EQ(refusal({}), "accepted");
    EXPECT_EQ(budget_of(p, {}).measurands.size(), 7u);
    p.spots[2].reference_mm.setZero();
    EXPECT_THAT(refusal({}), HasSubstr("spot S3 has no reference"));
    p.spots[2].enabled = false;
    EXPECT_EQ(refusal({}), "accepted");
    p.sensors.front().calibration_id.clear();
    EXPECT_THAT(refusal({}), HasSubstr("no calibrated spot"));
}

TEST(RegionBudget, AnUnderDeterminedRegionSaysWhatToAdd) {
    Project p = stated_project();
    p.regions.front().spot_ids = {"S1", "S4"};
    const RegionBudget b = budget_of(p, {});
    EXPECT_EQ(b.status, CorrectionStatus::under_determined);
    EXPECT_FALSE(b.message.empty());
    EXPECT_TRUE(b.measurands.empty());
    EXPECT_EQ(budget_json(b)["status"], "under_determined");
}

TEST(RegionBudget, PageInBothLanguages) {
    const std::vector<RegionBudget> all{budget_of(stated_project(), {far_away()})};
    BudgetPageOptions options;
    options.file = "door.seam";
    const std::string english = budget_page(all, options).html();
    EXPECT_THAT(english, HasSubstr("Uncertainty budget: door.seam"));
    EXPECT_THAT(english, HasSubstr("arrival, taught R1"));
    EXPECT_THAT(english, HasSubstr("<svg"));
    options.language = Language::german;
    const std::string german = budget_page(all, options).text();
    EXPECT_THAT(german, HasSubstr("Unsicherheitsbudget: door.seam"));
    EXPECT_THAT(german, HasSubstr("Hand-Auge A"));
    for (const char* left : {"hand-eye", "random", "Sensitivity", "bead", "stated"})
        EXPECT_THAT(german, Not(HasSubstr(left)));
}

}  // namespace
}  // namespace seamwright
