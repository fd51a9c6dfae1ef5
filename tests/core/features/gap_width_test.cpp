// Gap width on sheets that stop square or in a rounded rim, cast by vertical rays: the shapes, the rays and
// the truth (the outermost place along the left surface that any ray meets) share nothing with the gauge.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "core/features/gap/gap_flush.h"
#include "core/profile/filter.h"

namespace seamwright {
namespace {

using Outline = std::vector<Eigen::Vector2d>;

struct GapScene {
    std::vector<Outline> sheets;
    // Height of the highest sheet at x, and which it is; NaN between them.
    double height(double x, int& sheet) const {
        double best = std::nan("");
        for (std::size_t s = 0; s < sheets.size(); ++s)
            for (std::size_t i = 0; i + 1 < sheets[s].size(); ++i) {
                const Eigen::Vector2d &a = sheets[s][i], &b = sheets[s][i + 1];
                if ((x < a.x()) == (x < b.x())) continue;
                const double z = a.y() + (x - a.x()) / (b.x() - a.x()) * (b.y() - a.y());
                if (best >= z) continue;
                best = z;
                sheet = static_cast<int>(s);
            }
        return best;
    }
};

// A sheet that ends towards +x at 0, its top at z = 0.
Outline rim(double radius_mm) {
    Outline o{{-15, 0}};
    if (radius_mm <= 0) {
        o.emplace_back(0, 0);
        o.emplace_back(0, -1);
    }
    for (int k = 0; radius_mm > 0 && k <= 60; ++k) {
        const double a = M_PI / 2 - M_PI * k / 60;
        o.emplace_back(radius_mm * (std::cos(a) - 1), radius_mm * (std::sin(a) - 1));
    }
    o.emplace_back(-15, o.back().y());
    return o;
}

void turn(Outline& o, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    for (auto& p : o) p = Eigen::Vector2d(c * p.x() - s * p.y(), s * p.x() + c * p.y());
}

struct Tally {
    int asked = 0, ok = 0, inside = 0, far = 0;
    double error = 0, sigma = 0;
    void add(const Tally& t) {
        asked += t.asked, ok += t.ok, inside += t.inside, far += t.far;
        error += t.error, sigma += t.sigma;
    }
};

struct Sensing {
    double pitch_mm, noise_mm;
    double missing = 0.01;  // share of the returns
    int mean = 1;           // lines that the sensor means
    double ground_mm = 0;   // depth at which the ground is seen in the gap; 0: it is dark
    double apart = 0;       // pitches at which points are measured, to be laid on a grid; 0: on its lines
};

// What a sensor makes of it that means so many lines, of those with a return.
void smooth(std::vector<double>& z, int lines) {
    const std::vector<double> raw = z;
    const int n = static_cast<int>(z.size()), half = lines / 2;
    for (int i = 0; i < n; ++i) {
        if (std::isnan(raw[i])) continue;
        double sum = 0;
        int count = 0;
        for (int k = std::max(0, i - half); k <= std::min(n - 1, i + half); ++k)
            if (!std::isnan(raw[k])) sum += raw[k], ++count;
        z[i] = sum / count;
    }
}

// The lines of an even grid between measured neighbours, by straight lines.
Profile laid_on_grid(const Profile& measured, double step_mm, double pitch_mm) {
    Profile p;
    std::size_t next = 1;
    for (double x = measured.x_mm.front(); x < measured.x_mm.back(); x += pitch_mm) {
        while (next + 1 < measured.size() && measured.x_mm[next] < x) ++next;
        const double t = (x - measured.x_mm[next - 1]) / step_mm;
        p.x_mm.push_back(x);
        p.z_mm.push_back((1 - t) * measured.z_mm[next - 1] + t * measured.z_mm[next]);
    }
    return p;
}

Tally measure(double radius_mm, const Sensing& sensing, int trials, std::mt19937_64& engine) {
    const double pitch_mm = sensing.pitch_mm, noise_mm = sensing.noise_mm, ground_mm = sensing.ground_mm;
    std::uniform_real_distribution<double> uniform(0, 1);
    std::normal_distribution<double> normal;
    Tally tally;
    for (int trial = 0; trial < trials; ++trial) {
        const double wanted =
            ground_mm > 0 ? 2 + 4 * uniform(engine) : 3 * pitch_mm + 0.2 * std::pow(50, uniform(engine));
        const double tilt = 0.2 * (uniform(engine) - 0.5);
        Outline left = rim(radius_mm), right = rim(radius_mm);
        for (auto& p : right) p.x() = -p.x();
        turn(right, 0.1 * (uniform(engine) - 0.5));
        double nearest = 1e9;
        for (const auto& p : right) nearest = std::min(nearest, p.x());
        const double flush = (ground_mm > 0 ? 2 : 6) * (uniform(engine) - 0.5);
        for (auto& p : right) p += Eigen::Vector2d(wanted - nearest, flush);
        turn(left, tilt);
        turn(right, tilt);
        GapScene scene{{left, right}};
        if (ground_mm > 0) {
            Outline ground{{-1, -ground_mm}, {wanted + 1, -ground_mm}};
            turn(ground, tilt);
            scene.sheets.push_back(ground);
        }
        const Eigen::Vector2d u(std::cos(tilt), std::sin(tilt));
        double edge[2] = {-1e9, 1e9};
        // An outline is straight between its corners: the outermost place is a corner that is seen.
        for (const Outline& o : {left, right})
            for (const auto& corner : o)
                for (const double x : {corner.x() - 1e-7, corner.x() + 1e-7}) {
                    int sheet = 0;
                    const double z = scene.height(x, sheet);
                    if (!std::isfinite(z) || sheet > 1) continue;
                    const double along = u.dot(Eigen::Vector2d(x, z));
                    edge[sheet] = sheet == 0 ? std::max(edge[0], along) : std::min(edge[1], along);
                }
        Profile p;
        const double step_mm = sensing.apart > 0 ? sensing.apart * pitch_mm : pitch_mm;
        for (double x = -14 + step_mm * uniform(engine); x < 14 + wanted; x += step_mm) {
            int sheet = 0;
            const bool missing = uniform(engine) < sensing.missing;
            p.x_mm.push_back(x);
            p.z_mm.push_back(missing ? std::nan("") : scene.height(x, sheet) + noise_mm * normal(engine));
        }
        if (sensing.apart > 0) p = laid_on_grid(p, step_mm, pitch_mm);
        smooth(p.z_mm, sensing.mean);
        EXPECT_TRUE(filter_profile(p, {}));
        GapFlushSettings settings;
        settings.surface_mm = 6;
        settings.edge_skip_mm = std::max(1.5, 1.2 * radius_mm);
        const GapFlush f = GapFlushGauge(settings).measure(p);
        ++tally.asked;
        if (f.status != GapFlushStatus::ok) continue;
        const double error = f.gap_mm - (edge[1] - edge[0]), sigma = std::sqrt(f.covariance(0, 0));
        ++tally.ok;
        tally.inside += std::abs(error) < 2 * sigma;
        tally.far += std::abs(error) > 6 * sigma;
        tally.error += error;
        tally.sigma += sigma;
    }
    return tally;
}

TEST(GapWidth, IsAsSureAsItSaysOverPitchNoiseGapFlushAndRim) {
    std::mt19937_64 engine(31);
    for (const double radius : {0.0, 0.5, 1.5, 4.0}) {
        Tally all;
        for (const double pitch : {0.02, 0.05, 0.1, 0.2, 0.3})
            for (const double noise : {0.01, 0.03, 0.1}) {
                const Tally t = measure(radius, {pitch, noise}, 60, engine);
                EXPECT_GE(t.ok, 0.7 * t.asked) << "radius " << radius << " pitch " << pitch << " " << noise;
                EXPECT_LT(std::abs(t.error), 0.55 * t.sigma) << radius << " pitch " << pitch << " " << noise;
                all.add(t);
            }
        EXPECT_GE(all.ok, 0.9 * all.asked) << radius;
        EXPECT_NEAR(double(all.inside) / all.ok, 0.95, 0.022) << radius;
        EXPECT_LE(all.far, 0.005 * all.ok) << radius;
        EXPECT_LT(std::abs(all.error), 0.15 * all.sigma) << radius;
    }
}

// What the filter has marked in a panel is neither its edge nor the break behind it.
TEST(GapWidth, DustOverThePanelsIsNoEdge) {
    std::mt19937_64 engine(33);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform(0, 1);
    int asked = 0, ok = 0, wrong = 0;
    for (int trial = 0; trial < 300; ++trial) {
        const double width = 1 + 3 * uniform(engine), flush = 0.6 * uniform(engine) - 0.3, pitch = 0.05;
        Profile p;
        for (double x = -12 + pitch * uniform(engine); x < 12 + width; x += pitch) {
            const bool in_gap = x > 0 && x < width;
            double z = (x < width ? 0 : flush) + 0.02 * normal(engine);
            if (uniform(engine) < 0.04) z += (uniform(engine) < 0.5 ? -1 : 1) * (0.4 + 4 * uniform(engine));
            p.x_mm.push_back(x);
            p.z_mm.push_back(in_gap ? std::nan("") : z);
        }
        ASSERT_TRUE(filter_profile(p, {}));
        const GapFlush f = GapFlushGauge({}).measure(p);
        ++asked;
        if (f.status != GapFlushStatus::ok) continue;
        ++ok;
        wrong += std::abs(f.gap_mm - width) > 0.3;
    }
    EXPECT_GE(ok, 0.95 * asked);
    EXPECT_LE(wrong, 1);
}

// The ground is no panel, a missing return no edge, and the ramp that a smoothing sensor draws of the step is known.
TEST(GapWidth, GroundThatIsSeenInTheGapIsNoPanel) {
    std::mt19937_64 engine(32);
    for (const double missing : {0.0, 0.05})
        for (const int mean : {1, 3, 5}) {
            Tally all;
            for (const double radius : {0.0, 1.2})
                for (const double depth : {3.0, 8.0})
                    for (const double pitch : {0.02, 0.05, 0.1, 0.2}) {
                        const Tally t = measure(radius, {pitch, pitch / 5, missing, mean, depth}, 15, engine);
                        EXPECT_GE(t.ok, 0.9 * t.asked)
                            << radius << " " << depth << " " << pitch << " " << mean;
                        all.add(t);
                    }
            EXPECT_GE(all.ok, 0.98 * all.asked) << missing << " " << mean;
            EXPECT_GE(double(all.inside) / all.ok, 0.88) << missing << " " << mean;
            EXPECT_LE(all.far, 0.0125 * all.ok) << missing << " " << mean;
        }
}

// Without ground as well: a face that is seen is drawn out.
TEST(GapWidth, IsAsSureAsItSaysOfASensorThatSmooths) {
    std::mt19937_64 engine(33);
    for (const int mean : {3, 5})
        for (const double radius : {0.0, 0.5, 1.5}) {
            Tally all;
            for (const double pitch : {0.02, 0.05, 0.1}) {
                const Tally t = measure(radius, {pitch, pitch / 5, 0.0, mean}, 60, engine);
                all.add(t);
            }
            EXPECT_GE(all.ok, 170);
            EXPECT_GE(double(all.inside) / all.ok, 0.83) << radius << " " << mean;
            EXPECT_LE(all.far, 2) << radius << " " << mean;
        }
}

// Points that lie denser than they were measured end before the last measured one, and draw a ramp down to ground that is seen.
TEST(GapWidth, OnAGridDenserThanWhatWasMeasured) {
    std::mt19937_64 engine(35);
    Tally all;
    for (const double apart : {1.4, 1.7, 1.9, 2.2, 2.6, 3.1})
        for (const double radius : {0.0, 1.5})
            for (const double ground : {0.0, 5.0}) {
                Tally here;
                for (const double pitch : {0.03, 0.06})
                    for (const double noise : {0.01, 0.03})
                        here.add(measure(radius, {pitch, noise, 0, 1, ground, apart}, 60, engine));
                EXPECT_GE(double(here.inside) / here.ok, 0.75) << apart << " " << radius << " " << ground;
                EXPECT_LE(here.far, 2) << apart << " " << radius << " " << ground;
                EXPECT_LT(std::abs(here.error), 0.95 * here.sigma) << apart << " " << radius << " " << ground;
                all.add(here);
            }
    EXPECT_EQ(all.ok, all.asked);
    EXPECT_GE(double(all.inside) / all.ok, 0.9);
    EXPECT_LE(all.far, 0.002 * all.ok);
}

// Panels of 15 and `right_mm` with a gap of 6 mm and ground 4 mm below between them; returns at 0.05 mm.
Profile over_ground(double right_mm) {
    Profile p;
    for (int i = 0; i * 0.05 < 21 + right_mm; ++i) {
        const double x = 0.05 * i - 15;
        p.x_mm.push_back(x);
        p.z_mm.push_back(x > 0 && x < 6 ? -4 : 0);
    }
    return p;
}

TEST(GapWidth, ReturnsThatAreMissingInAPanelAreNoEdge) {
    Profile p = over_ground(12);
    EXPECT_TRUE(filter_profile(p, {}));
    const GapFlush whole = GapFlushGauge({}).measure(p);
    ASSERT_EQ(whole.status, GapFlushStatus::ok) << whole.message;
    EXPECT_NEAR(whole.gap_mm, 6, 0.051);
    for (int place = 225; place < 298; place += 8) {
        Profile holed = over_ground(12);
        holed.z_mm[place] = holed.z_mm[place + 1] = holed.z_mm[place / 2] = std::nan("");
        EXPECT_TRUE(filter_profile(holed, {}));
        const GapFlush g = GapFlushGauge({}).measure(holed);
        ASSERT_EQ(g.status, GapFlushStatus::ok) << g.message;
        EXPECT_NEAR(g.gap_mm, whole.gap_mm, 1e-6) << place;
    }
}

// A panel beside the gap of 4 mm at x = 0 that is dark from `from_mm` to `to_mm` off its edge, and higher by `step_mm` from
// `from_mm` on; the other one stands `flush_mm` higher. Ground at -`ground_mm`, where it is seen.
struct Streak {
    double from_mm, to_mm, step_mm, flush_mm, ground_mm;
};
GapFlush beside(const Streak& s, double pitch_mm, bool left, std::mt19937_64& engine) {
    std::uniform_real_distribution<double> uniform(0, 1);
    std::normal_distribution<double> normal;
    Profile p;
    for (double x = -20 + pitch_mm * uniform(engine); x < 24; x += pitch_mm) {
        const bool in_gap = x > 0 && x < 4;
        const double off = x <= 0 ? -x : x - 4;
        double z = in_gap ? (s.ground_mm > 0 ? -s.ground_mm : std::nan("")) : x >= 4 ? s.flush_mm : 0;
        if (!in_gap && (x <= 0) == left && off > s.from_mm) z += off < s.to_mm ? std::nan("") : s.step_mm;
        p.x_mm.push_back(x);
        p.z_mm.push_back(z + 0.02 * normal(engine));
    }
    EXPECT_TRUE(filter_profile(p, {}));
    return GapFlushGauge({}).measure(p);
}

TEST(GapWidth, ADarkStreakBesideItIsNotTheGap) {
    std::mt19937_64 engine(52);
    for (const double pitch : {0.04, 0.1})
        for (const bool left : {true, false})
            for (const double strip : {1.0, 3.0, 8.0})
                for (const double ground : {6.0, 0.0})
                    for (int trial = 0; trial < 5; ++trial) {
                        const Streak s{strip, strip + 8 * pitch, 0, ground > 0 ? 0.2 : 0.5, ground};
                        const GapFlush g = beside(s, pitch, left, engine);
                        ASSERT_EQ(g.status, GapFlushStatus::ok)
                            << g.message << pitch << left << strip << ground;
                        EXPECT_NEAR(g.gap_mm, 4, 0.05) << pitch << left << strip << ground;
                    }
}

TEST(GapWidth, WhatNobodyCanTellFromTheGapIsNotMeasured) {
    std::mt19937_64 engine(53);
    for (int trial = 0; trial < 20; ++trial) {
        const GapFlush flush = beside({3, 4, 0, 0, 0}, 0.1, trial % 2 == 0, engine);
        EXPECT_EQ(flush.status, GapFlushStatus::ill_conditioned)
            << "two breaks in one line: " << flush.gap_mm;
        const GapFlush step = beside({3, 3, 0.7, 0.2, 6}, 0.1, true, engine);
        EXPECT_TRUE(step.status == GapFlushStatus::ill_conditioned || std::abs(step.gap_mm - 4) < 0.1)
            << "a ledge: " << step.gap_mm;
        EXPECT_EQ(beside({3, 3, 0, 0, 0}, 0.1, true, engine).status, GapFlushStatus::ok) << "no second break";
    }
}

// Likeness of neighbours sees no mean over so many lines; the steps down to the ground show it.
TEST(GapWidth, ASensorThatMeansManyLinesOverDeepGround) {
    std::mt19937_64 engine(54);
    std::normal_distribution<double> normal;
    for (const double pitch : {0.04, 0.1, 0.2})
        for (const int mean : {9, 11, 15})
            for (const double ground : {6.0, 20.0})
                for (int trial = 0; trial < 5 && mean * pitch < 2.5;
                     ++trial) {  // else hardly any ground is left
                    Profile p;
                    for (double x = -20 + 0.01 * trial; x < 24; x += pitch) {
                        p.x_mm.push_back(x);
                        p.z_mm.push_back((x < 0 || x > 4 ? 0 : -ground) + 0.02 * normal(engine));
                    }
                    smooth(p.z_mm, mean);
                    EXPECT_TRUE(filter_profile(p, {}));
                    const GapFlush g = GapFlushGauge({}).measure(p);
                    ASSERT_EQ(g.status, GapFlushStatus::ok) << g.message;
                    EXPECT_LT(std::abs(g.gap_mm - 4), std::max(0.05, 2 * std::sqrt(g.covariance(0, 0))))
                        << pitch << " " << mean << " " << ground << ": " << g.gap_mm;
                    EXPECT_NEAR(g.gap_mm, 4, 2.1 * pitch) << mean << " " << ground;
                }
}

// A median leaves a step where it is: no ramp of it is to be given back.
TEST(GapWidth, ASensorThatTakesMediansDrawsNoRamp) {
    std::mt19937_64 engine(55);
    std::normal_distribution<double> normal;
    for (const int lines : {3, 7})
        for (int trial = 0; trial < 20; ++trial) {
            std::vector<double> raw;
            Profile p;
            for (double x = -20 + 0.005 * trial; x < 24; x += 0.1) {
                p.x_mm.push_back(x);
                raw.push_back((x < 0 || x > 4 ? 0 : -8) + 0.02 * normal(engine));
            }
            p.z_mm = raw;
            for (std::size_t k = lines / 2; k + lines / 2 < raw.size(); ++k) {
                std::vector<double> around(raw.begin() + k - lines / 2, raw.begin() + k + lines / 2 + 1);
                std::sort(around.begin(), around.end());
                p.z_mm[k] = around[lines / 2];
            }
            EXPECT_TRUE(filter_profile(p, {}));
            const GapFlush g = GapFlushGauge({}).measure(p);
            ASSERT_EQ(g.status, GapFlushStatus::ok) << g.message;
            EXPECT_NEAR(g.gap_mm, 4, 0.11) << lines;
        }
}

// One return below the contour, where the rim grows steep, must not end the part there.
TEST(GapWidth, ASparkOnTheRimIsNoEdge) {
    constexpr double kPitch = 0.055, kGap = 4;
    std::mt19937_64 engine(41);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform(0, 1);
    const Outline left = rim(1);
    Outline right = left;
    for (auto& q : right) q.x() = kGap - q.x();
    const GapScene scene{{left, right}};
    double worst = 0;
    for (int trial = 0; trial < 30; ++trial) {
        Profile p;
        for (double x = -12 + kPitch * uniform(engine); x < 12 + kGap; x += kPitch) {
            int sheet = 0;
            p.x_mm.push_back(x);
            p.z_mm.push_back(scene.height(x, sheet) + 0.035 * normal(engine));
        }
        smooth(p.z_mm, 3);
        for (std::size_t i = 1; i < p.x_mm.size(); ++i) {
            if (p.x_mm[i] < kGap + 3 * kPitch || p.x_mm[i] > kGap + 0.6) continue;
            Profile with = p;
            with.z_mm[i] = with.z_mm[i - 1] - 0.015;
            EXPECT_TRUE(filter_profile(with, {}));
            with.segment[i] = kOutlier;
            const GapFlush g = GapFlushGauge({}).measure(with);
            ASSERT_EQ(g.status, GapFlushStatus::ok) << g.message;
            worst = std::max(worst, std::abs(g.gap_mm - kGap));
        }
    }
    EXPECT_LT(worst, 3 * kPitch);
}

TEST(GapWidth, IsRefusedWhereTheGroundCannotBeToldFromAPanel) {
    Profile p = over_ground(2.5);
    EXPECT_TRUE(filter_profile(p, {}));
    const GapFlush g = GapFlushGauge({}).measure(p);
    EXPECT_EQ(g.status, GapFlushStatus::ill_conditioned) << g.gap_mm;
    EXPECT_NE(std::string(g.message).find("ground"), std::string::npos) << g.message;
}

// A line may be lost right at the edge as well as elsewhere.
TEST(GapWidth, IsAsSureAsItSaysWhereReturnsAreMissing) {
    std::mt19937_64 engine(34);
    for (const double missing : {0.05, 0.2}) {
        Tally all;
        for (const double radius : {0.0, 1.2})
            for (const double pitch : {0.02, 0.05, 0.1}) {
                const Tally t = measure(radius, {pitch, pitch / 5, missing}, 60, engine);
                all.add(t);
            }
        EXPECT_GE(all.ok, 353) << missing;
        EXPECT_GE(double(all.inside) / all.ok, 0.92) << missing;
        EXPECT_LE(all.far, 3) << missing;
    }
}

// Heads that look from either side see the faces of the gap; merged, the points of a face lie in order of x.
TEST(GapWidth, FacesThatADoubleHeadSeesAreThePanels) {
    std::mt19937_64 engine(35);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::normal_distribution<double> normal;
    int ok = 0, within = 0, inside = 0;
    double sum = 0;
    for (int trial = 0; trial < 200; ++trial) {
        const double gap = 2 + 6 * uniform(engine), flush = 3 * uniform(engine) - 1.5;
        std::vector<Eigen::Vector2d> panel[2];
        for (const int side : {0, 1}) {
            for (double s = 0.05; s < 15; s += 0.05 + 0.02 * uniform(engine)) panel[side].emplace_back(s, 0);
            for (double depth = 0.1; depth < 5; depth += 0.15) panel[side].emplace_back(0, -depth);
            for (auto& p : panel[side]) {
                p += 0.01 * Eigen::Vector2d(normal(engine), normal(engine));
                p = side == 0 ? Eigen::Vector2d(-p.x(), p.y()) : Eigen::Vector2d(gap + p.x(), flush + p.y());
            }
            std::sort(panel[side].begin(), panel[side].end(),
                      [](const auto& a, const auto& b) { return a.x() < b.x(); });
        }
        Profile p;
        for (const int side : {0, 1})
            for (const auto& point : panel[side]) {
                p.x_mm.push_back(point.x());
                p.z_mm.push_back(point.y());
                p.segment.push_back(side);
            }
        const GapFlush g = GapFlushGauge({}).measure(p);
        ok += g.status == GapFlushStatus::ok;
        within += std::abs(g.gap_mm - gap) < 0.05 && std::abs(g.flush_mm - flush) < 0.05;
        inside += std::abs(g.gap_mm - gap) < 2 * std::sqrt(g.covariance(0, 0));
        sum += g.gap_mm - gap;
    }
    EXPECT_EQ(ok, 200);
    EXPECT_GE(within, 196);
    EXPECT_GE(inside, 180);
    EXPECT_NEAR(sum / ok, 0, 0.015) << "the outermost of many returns stands out by its noise";
}

}  // namespace
}  // namespace seamwright
