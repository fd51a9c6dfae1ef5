// Over many kinds of contours, pitches and noises: found where it can be, refused where it cannot, and never
// ok elsewhere.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>

#include "match_scenes.h"

namespace seamwright::test {
namespace {

struct Tally {
    int trials = 0, right = 0, wrong = 0, covered = 0;
    int far = 0;  // of the wrong ones: at another place, not beside the right one
    std::map<RegistrationStatus, int> refused;
    void add(const MatchTrial& t, const Registration& r) {
        ++trials;
        if (r.status != RegistrationStatus::ok) {
            if (std::getenv("MATCH_TRIALS") && t.determined())
                std::printf("    refused %s: %s, %.2f off, best sigma %.3f, share %.2f, inside %d\n",
                            std::string(to_string(r.status)).c_str(), t.what.c_str(),
                            t.error_mm(r.scene_from_template), t.landmark_sigma_mm, r.inlier_share, t.inside);
            ++refused[r.status];
            return;
        }
        const Eigen::Vector2d e = r.scene_from_template * t.reference - t.truth * t.reference;
        const Eigen::Vector2d arm = r.scene_from_template * t.reference -
                                    Eigen::Vector2d(r.scene_from_template.dx_mm, r.scene_from_template.dz_mm);
        Eigen::Matrix<double, 2, 3> j;
        j << 1, 0, -arm.y(), 0, 1, arm.x();
        const Eigen::Matrix2d c = j * r.covariance * j.transpose();
        const double square = e.dot(c.ldlt().solve(e));
        // Farther off than it should be, and not within what it states (four sigma) either.
        if (!t.right(r.scene_from_template) && (square > 20 || e.norm() > 1)) {
            ++wrong;
            far += e.norm() > 1 + 20 * t.scale_mm;
            if (std::getenv("MATCH_TRIALS"))
                std::printf(
                    "    wrong: %s: %.2f mm off (%.1f sigma), share %.2f, best sigma %.3f, inside %d, window "
                    "%.1f %.1f, "
                    "moved %.2f %.2f\n",
                    t.what.c_str(), t.error_mm(r.scene_from_template), std::sqrt(square), r.inlier_share,
                    t.landmark_sigma_mm, t.inside, t.window.dx_mm, t.window.dz_mm,
                    (t.truth * t.reference - t.reference).x(), (t.truth * t.reference - t.reference).y());
            return;
        }
        ++right;
        covered += square < 5.991;
    }
    void print(const char* name) const {
        auto of = [&](RegistrationStatus s) {
            const auto found = refused.find(s);
            return found == refused.end() ? 0 : found->second;
        };
        std::printf("%-26s %5d %6.1f %% %6d | %5d %5d %5d %5d | %5.2f\n", name, trials,
                    trials > 0 ? 100.0 * right / trials : 0, wrong, of(RegistrationStatus::no_match),
                    of(RegistrationStatus::sliding), of(RegistrationStatus::ambiguous),
                    of(RegistrationStatus::no_points), right > 0 ? covered / double(right) : 0);
    }
};
void head(const char* what) {
    std::printf("\n%-26s %5s %8s %6s | %5s %5s %5s %5s | %s\n", what, "n", "right", "WRONG", "no", "slid",
                "ambig", "none", "2 sigma");
}

Registration matched(const MatchTrial& t) {
    auto matcher = ContourMatcher::make(t.taught, t.reference);
    return matcher ? matcher->match(t.scene, t.window) : Registration{};
}

int trials_of(int wanted) {
    const char* n = std::getenv("MATCH_TRIALS");
    return n ? std::atoi(n) : wanted;
}

TEST(MatchEverywhere, RightWhereDeterminedRefusedOtherwise) {
    Random random(41);
    const char* places[] = {"within the window", "beyond the window"};
    const TrialRange ranges[] = {{0, 0.98}, {1.1, 2.0}};
    for (int place = 0; place < 2; ++place) {
        head(places[place]);
        Tally all, never;
        for (int kind = 0; kind < kSectionKinds; ++kind) {
            Tally known, unknown;
            std::string name;
            for (int i = 0; i < trials_of(60); ++i) {
                const Section section = random_section(kind, random);
                name = section.name;
                const MatchTrial t = make_trial(section, ranges[place], random);
                const Registration r = matched(t);
                (t.determined() ? known : unknown).add(t, r);
                (t.determined() ? all : never).add(t, r);
            }
            known.print(name.c_str());
            if (unknown.trials > 0) unknown.print("  not determined");
        }
        all.print("ALL determined");
        never.print("ALL not determined");
        if (place == 0) {
            EXPECT_GE(all.right, 0.97 * all.trials);
        }
        EXPECT_LE(all.wrong, 0.005 * all.trials + 1);
        EXPECT_LE(never.wrong, 0.005 * never.trials + 1);
        EXPECT_EQ(all.far + never.far, 0);
        EXPECT_GE(all.covered, (place == 0 ? 0.87 : 0.8) * all.right);
    }
}

// Little more than a flat: what fixes the place are the few points of the rim.
TEST(MatchEverywhere, SmallRimsWithFlats) {
    Random random(42);
    std::uniform_real_distribution<double> unit(0, 1);
    head("small rims, 10 mm flat");
    for (const double radius : {1.0, 2.0}) {
        Tally known, unknown;
        for (int i = 0; i < trials_of(120); ++i) {
            const MatchTrial t =
                make_trial(rounded_rim(radius, 10, 50 + 40 * unit(random)), {0.4, 0.98}, random);
            (t.determined() ? known : unknown).add(t, matched(t));
        }
        known.print(radius < 1.5 ? "r 1" : "r 2");
        unknown.print("  not determined");
        EXPECT_GE(known.right, 0.98 * known.trials);
        EXPECT_EQ(known.far + unknown.far, 0);
    }
}

// Two scans of a room by a turning range finder, millimetres in thousands: pitch and noise of other kinds,
// much of each scan unseen in the other.
TEST(MatchEverywhere, TwoScansOfARoom) {
    Random random(43);
    std::uniform_real_distribution<double> unit(-1, 1);
    head("scans of a room");
    for (const double noise : {3.0, 10.0, 25.0}) {
        Tally tally;
        for (int i = 0; i < trials_of(40); ++i) {
            const RoomScan a = scan_room({0, 0}, 0, noise, random);
            const PlanarMotion there{400 * unit(random), 400 * unit(random), 0.3 * unit(random)};
            const RoomScan b = scan_room({there.dx_mm, there.dz_mm}, there.phi_rad, noise, random);
            MatchTrial t;
            t.taught = a.profile;
            t.scene = b.profile;
            // From the first scanner's frame to the second's.
            const double c = std::cos(there.phi_rad), s = std::sin(there.phi_rad);
            t.truth = {-(c * there.dx_mm + s * there.dz_mm), -(-s * there.dx_mm + c * there.dz_mm),
                       -there.phi_rad};
            t.window.dx_mm = t.window.dz_mm = 600;
            t.window.phi_rad = 0.5;
            t.window.pivot = SearchPivot::reference_or_origin;
            t.scale_mm = 2 * noise;
            t.landmark_sigma_mm = 0.05;
            t.what = "room";
            tally.add(t, matched(t));
        }
        EXPECT_GE(tally.right, 0.95 * tally.trials);
        EXPECT_EQ(tally.wrong, 0);
        tally.print(("noise " + std::to_string(static_cast<int>(noise)) + " mm").c_str());
    }
}

}  // namespace
}  // namespace seamwright::test
