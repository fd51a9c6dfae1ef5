#include "core/calibration/table/lookup_table_calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "tests/core/calibration/camera/camera_scene.h"
#include "tests/core/calibration/independent/plain_world.h"

namespace seamwright {
namespace {

using testing::HasSubstr;

SensorModel sensor() {
    return {test::camera_640(), make_pose(rotation_exp({1.0, 0.2, 0.15}), {10, -5, 320}), {}};
}

// Targets of known (x, z), their pixels measured with noise. grid: on a lattice of the image; else scattered.
std::vector<LaserPair> measured(const SensorModel& model, int count, bool grid, double noise_px,
                                std::mt19937& random) {
    std::uniform_real_distribution<double> u(0, 1);
    std::normal_distribution<double> n(0, 1);
    const int side = static_cast<int>(std::lround(std::sqrt(count)));
    std::vector<LaserPair> out;
    while (static_cast<int>(out.size()) < (grid ? side * side : count)) {
        const int i = static_cast<int>(out.size());
        const Eigen::Vector2d at =
            grid ? Eigen::Vector2d(5 + (i % side) * 629.0 / (side - 1), 5 + (i / side) * 469.0 / (side - 1))
                 : Eigen::Vector2d(639 * u(random), 479 * u(random));
        const auto xz = model.to_laser(at);
        if (!xz) {
            ADD_FAILURE() << "the simulated sensor does not see " << at.transpose();
            return out;
        }
        Eigen::Vector2d pixel = at + noise_px * Eigen::Vector2d(n(random), n(random));
        pixel = pixel.cwiseMax(0).cwiseMin(Eigen::Vector2d(639, 479));
        out.push_back({"t" + std::to_string(i), pixel, *xz});
    }
    return out;
}

// rms distance of two tables over the nodes that the first one has.
double distance(const LookupTable& table, const SensorModel& truth, double* worst = nullptr) {
    double sum = 0, most = 0;
    int count = 0;
    for (int j = 0; j < table.rows; ++j)
        for (int i = 0; i < table.columns; ++i) {
            const auto n = static_cast<std::size_t>(j * table.columns + i);
            if (std::isnan(table.x_mm[n])) continue;
            const auto xz = truth.to_laser({table.u0 + i * table.step_u, table.v0 + j * table.step_v});
            if (!xz) continue;
            const double e = (*xz - Eigen::Vector2d(table.x_mm[n], table.z_mm[n])).norm();
            sum += e * e, most = std::max(most, e);
            ++count;
        }
    if (worst) *worst = most;
    return std::sqrt(sum / count);
}

TEST(LookupTableCalibration, ReproducesTheTabulatedSensor) {
    std::mt19937 random(1);
    const SensorModel truth = sensor();
    LookupTableOptions options;
    options.step_px = 8;
    const auto pairs = measured(truth, 900, true, 0, random);
    const auto r = calibrate_lookup_table(640, 480, pairs, options);
    ASSERT_TRUE(r) << r.error().sentence();
    EXPECT_EQ(r->report.judgement.verdict, Verdict::good) << r->report.judgement.reason;
    const LookupTable exact = tabulate(truth, 8);
    ASSERT_EQ(r->table.columns, exact.columns);
    ASSERT_EQ(r->table.rows, exact.rows);
    double worst = 0;
    EXPECT_LT(distance(r->table, truth, &worst), 0.005);
    EXPECT_LT(worst, 0.06);
    // What is left at the pairs is the interpolation of a table of this step.
    double interpolation = 0;
    for (const auto& p : pairs) interpolation += (*exact.at(p.pixel) - p.laser_mm).squaredNorm() / 900;
    EXPECT_LT(r->forward_rms_mm, 1.3 * std::sqrt(interpolation));
    EXPECT_LT(r->backward_rms_px, 0.03);
    EXPECT_GT(r->covered_share, 0.9);
}

TEST(LookupTableCalibration, AveragesTheNoiseAndStatesIt) {
    std::mt19937 random(2);
    const SensorModel truth = sensor();
    for (const bool grid : {true, false}) {
        const auto pairs = measured(truth, 400, grid, 0.3, random);
        const auto r = calibrate_lookup_table(640, 480, pairs, {});
        ASSERT_TRUE(r) << r.error().sentence();
        EXPECT_EQ(r->report.judgement.verdict, Verdict::good) << r->report.judgement.reason;
        EXPECT_NEAR(r->noise_px, 0.3, 0.04);
        // The targets are averaged: the table is far better than one of them.
        const double error = distance(r->table, truth);
        EXPECT_LT(error, 0.4 * r->noise_mm);
        EXPECT_NEAR(error / r->map_sigma_mm, 1, 0.5);
        // Forward and backward are the same noise, through the scale.
        EXPECT_NEAR(r->backward_rms_px, 0.3 * std::sqrt(2.0), 0.08);
        EXPECT_NEAR(r->forward_rms_mm, r->noise_mm, 0.3 * r->noise_mm);
        EXPECT_NEAR(r->report.hold_out.rms_px, 0.3 * std::sqrt(2.0), 0.1);
        EXPECT_GE(r->report.hold_out.folds, 5);
    }
}

TEST(LookupTableCalibration, FollowsALocalBumpThatNoLensHas) {
    std::mt19937 random(3);
    const SensorModel truth = sensor();
    const auto bump = [](const Eigen::Vector2d& p) {
        return std::exp(-(p - Eigen::Vector2d(200, 300)).squaredNorm() / (2 * 60 * 60));
    };
    auto pairs = measured(truth, 900, true, 0.1, random);
    for (auto& p : pairs) p.laser_mm += Eigen::Vector2d(0.8, -0.6) * bump(p.pixel);
    const auto r = calibrate_lookup_table(640, 480, pairs, {});
    ASSERT_TRUE(r) << r.error().sentence();
    EXPECT_EQ(r->report.judgement.verdict, Verdict::good) << r->report.judgement.reason;
    for (const Eigen::Vector2d& p : {Eigen::Vector2d(200, 300), {150, 260}, {260, 300}, {500, 100}}) {
        const auto xz = r->table.at(p);
        ASSERT_TRUE(xz);
        const Eigen::Vector2d expected = *truth.to_laser(p) + Eigen::Vector2d(0.8, -0.6) * bump(p);
        EXPECT_LT((*xz - expected).norm(), 0.1) << p.transpose();  // of a bump of 1 mm
    }
}

TEST(LookupTableCalibration, StatedSigmaCoversTheTruth) {
    const SensorModel truth = sensor();
    int inside = 0, counted = 0;
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (unsigned seed = 0; seed < 120; ++seed) {
        std::mt19937 random(100 + seed);
        LookupTableOptions options;
        options.step_px = 32;
        const auto r = calibrate_lookup_table(640, 480, measured(truth, 100, true, 0.2, random), options);
        ASSERT_TRUE(r);
        const auto& parameters = r->report.parameters;
        ASSERT_GE(parameters.size(), 10u);
        for (std::size_t k = 0; k < parameters.size(); k += 2) {
            double u = 0, v = 0;
            ASSERT_EQ(std::sscanf(parameters[k].name.c_str(), "x(%lf,%lf)", &u, &v), 2);
            const Eigen::Vector2d xz = *truth.to_laser({u, v});
            const Eigen::Vector2d e(parameters[k].value - xz.x(), parameters[k + 1].value - xz.y());
            if (k == 0) mean += e / 120;
            inside += std::abs(e.x()) < 1.96 * parameters[k].sigma;
            inside += std::abs(e.y()) < 1.96 * parameters[k + 1].sigma;
            counted += 2;
        }
    }
    EXPECT_GT(static_cast<double>(inside) / counted, 0.9);
    std::printf("%d of %d inside\n", inside, counted);
    EXPECT_LT(static_cast<double>(inside) / counted, 0.99);
    EXPECT_LT(mean.norm(), 0.03);
}

TEST(LookupTableCalibration, LeavesHolesWhereNothingWasMeasured) {
    std::mt19937 random(4);
    const SensorModel truth = sensor();
    auto pairs = measured(truth, 900, true, 0.1, random);
    // Nothing right of u = 450, and nothing in a disc.
    const Eigen::Vector2d disc(220, 240);
    std::erase_if(pairs,
                  [&](const LaserPair& p) { return p.pixel.x() > 450 || (p.pixel - disc).norm() < 90; });
    LookupTableOptions options;
    options.step_px = 10;
    const auto r = calibrate_lookup_table(640, 480, pairs, options);
    ASSERT_TRUE(r) << r.error().sentence();
    int holes = 0;
    for (int j = 0; j < r->table.rows; ++j)
        for (int i = 0; i < r->table.columns; ++i) {
            const Eigen::Vector2d p(10.0 * i, 10.0 * j);
            const bool hole = std::isnan(r->table.x_mm[static_cast<std::size_t>(j * r->table.columns + i)]);
            holes += hole;
            if (p.x() > 460 || (p - disc).norm() < 30) {
                EXPECT_TRUE(hole) << p.transpose();
            }
            if (p.x() > 15 && p.x() < 425 && p.y() > 15 && p.y() < 465 && (p - disc).norm() > 95) {
                EXPECT_FALSE(hole) << p.transpose();
            }
        }
    EXPECT_EQ(holes, r->holes);
    EXPECT_FALSE(r->table.at(disc));
    EXPECT_FALSE(r->table.at({600, 200}));
    EXPECT_LT(distance(r->table, truth), 0.1);
}

TEST(LookupTableCalibration, NamesTheWrongPairs) {
    std::mt19937 random(5);
    const SensorModel truth = sensor();
    auto pairs = measured(truth, 144, false, 0.2, random);
    pairs[17].pixel += Eigen::Vector2d(pairs[17].pixel.x() > 320 ? -4 : 4, 0);  // small but clear
    std::swap(pairs[60].laser_mm, pairs[61].laser_mm);
    const auto r = calibrate_lookup_table(640, 480, pairs, {});
    ASSERT_TRUE(r) << r.error().sentence();
    EXPECT_EQ(r->report.judgement.verdict, Verdict::usable) << r->report.judgement.reason;
    for (std::size_t i = 0; i < pairs.size(); ++i)
        EXPECT_EQ(r->report.poses[i].used, i != 17 && i != 60 && i != 61) << i;
    EXPECT_THAT(r->report.judgement.reason, HasSubstr("t17, t60, t61"));
    EXPECT_LT(distance(r->table, truth), 0.15);
}

TEST(LookupTableCalibration, SurvivesAFifthOfWrongPairs) {
    std::mt19937 random(6);
    const SensorModel truth = sensor();
    auto pairs = measured(truth, 200, false, 0.2, random);
    std::uniform_real_distribution<double> u(-60, 60);
    for (std::size_t i = 0; i < 40; ++i) pairs[5 * i].laser_mm += Eigen::Vector2d(u(random), u(random));
    const auto r = calibrate_lookup_table(640, 480, pairs, {});
    ASSERT_TRUE(r) << r.error().sentence();
    EXPECT_LT(distance(r->table, truth), 0.25);
    int good_lost = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) good_lost += i % 5 != 0 && !r->report.poses[i].used;
    EXPECT_LE(good_lost, 3);
}

TEST(LookupTableCalibration, UnrelatedPairsAreNotPresentedAsFound) {
    std::mt19937 random(7);
    auto pairs = measured(sensor(), 100, false, 0, random);
    std::vector<Eigen::Vector2d> laser;
    for (const auto& p : pairs) laser.push_back(p.laser_mm);
    std::shuffle(laser.begin(), laser.end(), random);
    for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i].laser_mm = laser[i];
    const auto r = calibrate_lookup_table(640, 480, pairs, {});
    ASSERT_TRUE(r);
    EXPECT_TRUE(r->report.judgement.verdict == Verdict::poor ||
                r->report.judgement.verdict == Verdict::undetermined)
        << r->report.judgement.reason;
}

TEST(LookupTableCalibration, ALineOfPairsIsUndetermined) {
    const SensorModel truth = sensor();
    std::vector<LaserPair> pairs;
    for (int i = 0; i < 40; ++i) {
        const Eigen::Vector2d p(20 + 15 * i, 100 + 4 * i);
        pairs.push_back({std::to_string(i), p, *truth.to_laser(p)});
    }
    const auto r = calibrate_lookup_table(640, 480, pairs, {});
    ASSERT_TRUE(r);
    EXPECT_EQ(r->report.judgement.verdict, Verdict::undetermined);
    EXPECT_TRUE(r->report.parameters.empty());
    EXPECT_TRUE(r->table.x_mm.empty());
}

TEST(LookupTableCalibration, FewPairsAreSaidToBeFew) {
    std::mt19937 random(8);
    SensorModel pinhole = sensor();
    pinhole.camera.k1 = pinhole.camera.k2 = pinhole.camera.p1 = pinhole.camera.p2 = 0;
    const auto r = calibrate_lookup_table(640, 480, measured(pinhole, 16, true, 0.1, random), {});
    ASSERT_TRUE(r);
    EXPECT_EQ(r->report.judgement.verdict, Verdict::usable) << r->report.judgement.reason;
    const auto eight = calibrate_lookup_table(640, 480, measured(sensor(), 8, false, 0.1, random), {});
    ASSERT_TRUE(eight);
    EXPECT_EQ(eight->report.judgement.verdict, Verdict::undetermined);
}

TEST(LookupTableCalibration, RefusesBadInput) {
    std::mt19937 random(9);
    const auto good = measured(sensor(), 49, true, 0.1, random);
    const auto refused = [](std::vector<LaserPair> pairs, int w, LookupTableOptions options,
                            const char* says) {
        const auto r = calibrate_lookup_table(w, 480, pairs, options);
        ASSERT_FALSE(r) << says;
        EXPECT_THAT(r.error().sentence(), HasSubstr(says));
    };
    refused({}, 640, {}, "too few");
    refused({good.begin(), good.begin() + 5}, 640, {}, "too few");
    refused(good, 0, {}, "not possible");
    refused(good, 300, {}, "outside the image");
    auto bad = good;
    bad[3].pixel.x() = std::nan("");
    refused(bad, 640, {}, "t3");
    bad = good;
    bad[4].laser_mm.y() = INFINITY;
    refused(bad, 640, {}, "t4");
    bad = good;
    bad[5].id = bad[6].id;
    refused(bad, 640, {}, "t6");
    bad = good;
    for (auto& p : bad) p.laser_mm *= 0.001;
    refused(bad, 640, {}, "metres");
    refused(good, 640, {{"nobody"}, 0}, "nobody");
    refused(good, 640, {{}, -1}, "step");
    refused(good, 640, {{}, 1e-3}, "step");
    refused(good, 640, {{}, INFINITY}, "step");
}

// Positions on a lattice of x and z as a stage goes to them, seen by `see`.
template <class See>
std::vector<LaserPair> staged(const See& see, int columns, int rows, double noise_px, unsigned seed) {
    plain::Dice dice(seed);
    std::vector<LaserPair> out;
    for (int i = 0; i < columns * rows; ++i) {
        const Eigen::Vector2d xz(-60 + 120.0 * (i % columns) / (columns - 1),
                                 -60 + 120.0 * (i / columns) / (rows - 1));
        const Eigen::Vector2d q = see(xz) + noise_px * Eigen::Vector2d(dice.n(), dice.n());
        if (q.x() > 0 && q.y() > 0 && q.x() < 1279 && q.y() < 959)
            out.push_back({"P" + std::to_string(i), q, xz});
    }
    return out;
}
plain::Motion any_light(plain::Dice& dice) {
    return plain::motion({dice.u(0.8, 1.1), dice.u(-0.1, 0.1), dice.u(-0.1, 0.1)},
                         {dice.u(-10, 10), dice.u(-10, 10), dice.u(300, 400)});
}

TEST(LookupTableCalibration, AColumnThatStoodElsewhereIsNamed) {
    int named = 0, asked = 0;
    for (unsigned seed = 1; seed <= 10; ++seed) {
        plain::Dice dice(seed);
        const plain::Lens lens = plain::any_lens(dice);
        const plain::Motion light = any_light(dice);
        const auto see = [&](const Eigen::Vector2d& xz) {
            return lens.see(light * plain::Vec3(xz.x(), 0, xz.y()));
        };
        for (const bool of_x : {true, false})
            for (const double at : {-60.0, 0.0, 45.0}) {
                auto pairs = staged(see, 9, 9, 0.05, seed);
                if (pairs.size() < 40) continue;
                int moved = 0;
                for (auto& p : pairs)
                    if (std::abs(p.laser_mm(of_x ? 0 : 1) - at) < 1) p.laser_mm(of_x ? 1 : 0) += 0.5, ++moved;
                if (moved < 4) continue;
                const auto r = calibrate_lookup_table(1280, 960, pairs, {});
                ASSERT_TRUE(r) << r.error().sentence();
                ++asked;
                // Either it is named, or the pairs of it are, which the smooth map does not follow.
                const std::string reason = r->report.judgement.reason.english();
                int left_out = 0;
                for (std::size_t i = 0; i < pairs.size(); ++i)
                    left_out +=
                        !r->report.poses[i].used && std::abs(pairs[i].laser_mm(of_x ? 0 : 1) - at) < 1;
                const bool said = reason.find(of_x ? "at x = " : "at z = ") != std::string::npos;
                EXPECT_TRUE(!said || !serves(r->report.judgement.verdict));
                if (said || left_out == moved) {
                    ++named;
                    continue;
                }
                std::printf("%u %c %g: %s\n", seed, of_x ? 'x' : 'z', at, reason.c_str());
            }
    }
    EXPECT_GT(asked, 40);
    EXPECT_GT(named, 0.9 * asked) << asked;  // a rim of few pairs may say nothing
}

// A stage that errs at each x and each z, for all positions there alike, moves the map by that: the sigmas hold it. Where it
// does not, they are no wider for having been asked.
TEST(LookupTableCalibration, AStageThatErrsByItsRowsIsInTheSigmas) {
    double honest_mm = 0;
    for (const double stage_mm : {0.0, 0.05, 0.2}) {
        int asked = 0, inside = 0;
        double stated = 0;
        for (unsigned seed = 1; seed <= 60; ++seed) {
            plain::Dice dice(seed);
            const plain::Lens lens = plain::any_lens(dice);
            const plain::Motion light = any_light(dice);
            const auto see = [&](const Eigen::Vector2d& xz) {
                return lens.see(light * plain::Vec3(xz.x(), 0, xz.y()));
            };
            auto pairs = staged(see, 7, 7, 0.1, seed);
            if (pairs.size() < 40) continue;
            std::map<double, double> x, z;
            for (auto& p : pairs) {
                const Eigen::Vector2d at = p.laser_mm;
                p.laser_mm.x() += x.try_emplace(at.x(), stage_mm * dice.n()).first->second;
                p.laser_mm.y() += z.try_emplace(at.y(), stage_mm * dice.n()).first->second;
            }
            const auto r = calibrate_lookup_table(1280, 960, pairs, {});
            ASSERT_TRUE(r) << r.error().sentence();
            if (r->report.covariance.size() == 0) continue;
            const auto& parameters = r->report.parameters;
            for (std::size_t i = 0; i + 1 < parameters.size(); i += 2) {
                double u = 0, v = 0;
                ASSERT_EQ(std::sscanf(parameters[i].name.c_str(), "x(%lf,%lf)", &u, &v), 2);
                const Eigen::Vector2d found(parameters[i].value, parameters[i + 1].value);
                Eigen::Vector2d truth = found;
                for (int k = 0; k < 20; ++k) {
                    Eigen::Matrix2d j;
                    for (Eigen::Index c = 0; c < 2; ++c)
                        j.col(c) = (see(truth + 1e-3 * Eigen::Vector2d::Unit(c)) -
                                    see(truth - 1e-3 * Eigen::Vector2d::Unit(c))) /
                                   2e-3;
                    truth -= j.inverse() * (see(truth) - Eigen::Vector2d(u, v));
                }
                const auto k = static_cast<Eigen::Index>(i);
                const Eigen::Matrix2d c = r->report.covariance.block<2, 2>(k, k);
                inside += (found - truth).dot(c.inverse() * (found - truth)) < 5.991;
                stated += c.trace();
                ++asked;
            }
        }
        ASSERT_GT(asked, 100);
        const double share = static_cast<double>(inside) / asked;
        stated = std::sqrt(stated / asked);
        std::printf("stage %.2f mm: %.3f of %d inside, stated %.4f mm\n", stage_mm, share, asked, stated);
        EXPECT_GT(share, 0.85) << stage_mm;
        if (stage_mm == 0) honest_mm = stated;
        EXPECT_LT(stated, 4 * std::hypot(honest_mm, stage_mm)) << stage_mm;
    }
}

// Lenses of any kind, a step in the light, noise of the stage: none is taken for a column.
TEST(LookupTableCalibration, HonestLatticesAreNotDoubted) {
    int asked = 0, doubted = 0;
    for (unsigned seed = 1; seed <= 30; ++seed) {
        plain::Dice dice(1000 + seed);
        plain::Lens lens = plain::any_lens(dice);
        const plain::Motion light = any_light(dice);
        const Eigen::Vector2d bump = dice.box(30, 30, 0).head<2>();  // a fold at the rim is a column's shift
        const int kind = static_cast<int>(seed % 6);
        if (kind == 1) lens.k1 = -0.45, lens.k2 = 0.25;
        const auto see = [&](const Eigen::Vector2d& xz) -> Eigen::Vector2d {
            plain::Vec3 at(xz.x(), 0, xz.y());
            if (kind == 2)
                at.y() += 1.5 * std::exp(-(xz - bump).squaredNorm() / 800);  // light that is no plane
            if (kind == 3) at.y() += 0.02 * (xz.x() > bump.x() ? xz.x() - bump.x() : 0.0);  // folded
            const plain::Vec3 p = light * at;
            if (kind == 4) {  // fisheye: the angle goes with the radius
                const double r = std::hypot(p.x(), p.y());
                return Eigen::Vector2d(lens.cx, lens.cy) + lens.fx * std::atan2(r, p.z()) / r * p.head<2>();
            }
            Eigen::Vector2d q = lens.see(p);
            if (kind == 5) q.x() += 0.6 * std::sin(q.x() / 90);
            return q;
        };
        for (const double px : {0.02, 0.1, 0.4}) {
            const auto pairs = staged(see, 9, 9, px, seed);
            if (pairs.size() < 30) continue;
            const auto r = calibrate_lookup_table(1280, 960, pairs, {});
            ASSERT_TRUE(r) << r.error().sentence();
            ++asked;
            if (r->report.judgement.reason.english().find("the positions at") != std::string::npos) {
                ++doubted;
                EXPECT_EQ(kind, 3) << px << " " << seed;
            }
        }
    }
    EXPECT_GT(asked, 60);
    EXPECT_LE(doubted, 1);  // a fold with one column behind it is that column's shift
}

TEST(PixelInTable, InvertsTheTable) {
    const LookupTable table = tabulate(sensor(), 16);
    std::mt19937 random(10);
    std::uniform_real_distribution<double> u(0, 639), v(0, 479);
    for (int i = 0; i < 300; ++i) {
        const Eigen::Vector2d pixel(u(random), v(random));
        const auto xz = table.at(pixel);
        ASSERT_TRUE(xz);
        const auto back = pixel_in_table(table, *xz);
        ASSERT_TRUE(back) << pixel.transpose();
        EXPECT_LT((*back - pixel).norm(), 1e-7);
    }
    EXPECT_FALSE(pixel_in_table(table, {1e6, 0}));
    EXPECT_FALSE(pixel_in_table(table, {NAN, 0}));
    EXPECT_FALSE(pixel_in_table({}, {0, 0}));
}

}  // namespace
}  // namespace seamwright
