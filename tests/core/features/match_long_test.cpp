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
    }
}

}  // namespace
}  // namespace seamwright::test
