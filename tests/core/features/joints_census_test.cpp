// Filter and match over the joints of car bodies, every sensor's points, pitch, noise and grid. SEAMWRIGHT_TRIALS asks
// for more scenes of each, SEAMWRIGHT_SEED for others, SEAMWRIGHT_SCENES for those that went wrong.

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <map>

#include "core/profile/filter.h"
#include "joints.h"

namespace seamwright::scenes {
namespace {

struct Marks {
    int right = 0, invented = 0, missed = 0, profiles = 0;
    double worst = 1;
    double f1() const {
        return right + invented + missed > 0 ? 2. * right / (2. * right + invented + missed) : 1;
    }
    void add(const Marks& m) { right += m.right, invented += m.invented, missed += m.missed, ++profiles; }
};
// What interpolation has put between two surfaces belongs to neither.
Marks marks(const Profile& p, const Spoilt& truth, const std::vector<char>& phantom) {
    Marks m;
    for (std::size_t k = 0; k < p.size(); ++k) {
        if (std::isnan(p.z_mm[k]) || phantom[k]) continue;
        const bool marked = p.segment[k] == kOutlier, wrong = truth.outlier[k] != 0;
        m.right += marked && wrong, m.invented += marked && !wrong, m.missed += !marked && wrong;
    }
    return m;
}

// What can be had at all: who knows the sheets and the noise marks what lies farther from every sheet than k sigma, with
// the k that serves best over all profiles of a kind.
class Ceiling {
  public:
    void add(const Profile& p, const std::vector<Sheet>& sheets, const SensorModel& s, const Spoilt& truth,
             const std::vector<char>& phantom) {
        for (std::size_t k = 0; k < p.size(); ++k) {
            if (std::isnan(p.z_mm[k]) || phantom[k]) continue;
            const double sigmas = distance_mm(sheets, {p.x_mm[k], p.z_mm[k]}) / s.noise;
            for (std::size_t i = 0; i < marks_.size(); ++i) {
                const bool marked = sigmas > band(i), wrong = truth.outlier[k] != 0;
                Marks& m = marks_[i];
                m.right += marked && wrong, m.invented += marked && !wrong, m.missed += !marked && wrong;
            }
        }
    }
    double f1() const {
        double best = 0;
        for (const Marks& m : marks_) best = std::max(best, m.f1());
        return best;
    }

  private:
    static double band(std::size_t i) { return 2.5 + 0.5 * double(i); }
    std::array<Marks, 12> marks_;  // of 2.5 to 8 sigma
};

SensorModel sensor_of(Dice& dice, int condition) {
    SensorModel s = SensorModel::any(dice);
    if (condition == 0) s.grid = dice.chance(0.5) ? Grid::raw : Grid::exact;
    if (condition == 1) s.grid = Grid::resampled;
    if (condition == 2)
        s.points = 320, s.pitch = dice.uniform(0.16, 0.3), s.noise = 0.05, s.grid = Grid::exact;
    s.quantum = std::min(s.quantum, s.noise);
    return s;
}
constexpr const char* kConditions[] = {"any sensor", "interpolated x", "320 points, noise 0.05"};

TEST(Joints, TheFilterMarksWhatLiesOffTheContour) {
    for (int condition = 0; condition < 3; ++condition) {
        std::printf("\n%-24s %8s %9s %9s %9s   %s\n", kConditions[condition], "F1", "ceiling", "invented",
                    "missed", "outliers");
        for (const JointMaker make : kJoints) {
            Dice dice(seed_of(101));
            Marks all;
            Ceiling ceiling;
            const char* name = "";
            // Of few points there are few outliers: as many profiles that chance is a third of a hundredth.
            for (int i = 0; i < trials_of(condition == 2 ? 300 : 60); ++i) {
                const Joint joint = make(dice);
                name = joint.name;
                const SensorModel sensor = sensor_of(dice, condition);
                const double room = 0.4 * sensor.half_field();
                const auto sheets = moved(joint.sheets, {dice.uniform(-room, room), dice.uniform(-40, 40),
                                                         rad(dice.uniform(-12, 12))});
                Profile p = seen(sheets, sensor, dice);
                const Spoilt truth = spoil(p, sheets, sensor, 0.05, dice);
                std::vector<char> phantom(p.size(), 0);
                for (std::size_t k = 0; k < p.size() && sensor.grid == Grid::resampled; ++k)
                    phantom[k] = !truth.outlier[k] && std::isfinite(p.z_mm[k]) &&
                                 distance_mm(sheets, {p.x_mm[k], p.z_mm[k]}) > 4.5 * sensor.noise;
                ceiling.add(p, sheets, sensor, truth, phantom);
                if (dice.chance(0.3))
                    for (double& z : p.z_mm) z = -z;
                if (dice.chance(0.5))
                    for (double& x : p.x_mm) x = -x;
                ASSERT_TRUE(filter_profile(p, {}));
                const Marks m = marks(p, truth, phantom);
                all.add(m);
                if (told_of_each() && m.invented + m.missed > 3)
                    std::printf(
                        "  %s %d: invented %d missed %d of %d; %d x %.3f noise %.3f grid %d missing %.3f\n",
                        name, i, m.invented, m.missed, m.right + m.missed, sensor.points, sensor.pitch,
                        sensor.noise, int(sensor.grid), sensor.missing);
            }
            std::printf("%-24s %8.4f %9.4f %9d %9d   %d\n", name, all.f1(), ceiling.f1(), all.invented,
                        all.missed, all.right + all.missed);
            EXPECT_GE(all.f1(), ceiling.f1() - 0.01) << name << ", " << kConditions[condition];
        }
    }
}

struct MatchTally {
    int trials = 0, right = 0, wrong = 0, covered = 0, far = 0;
    std::map<RegistrationStatus, int> refused;
    void add(const MatchScene& t, const Registration& r) {
        ++trials;
        if (r.status != RegistrationStatus::ok) {
            ++refused[r.status];
            if (told_of_each() && t.determined()) say("refused", t, r, 0, 0);
            return;
        }
        const Vector2d there = r.scene_from_template * t.reference, e = there - t.truth * t.reference;
        const Vector2d arm = there - Vector2d(r.scene_from_template.dx_mm, r.scene_from_template.dz_mm);
        Eigen::Matrix<double, 2, 3> j;
        j << 1, 0, -arm.y(), 0, 1, arm.x();
        const Eigen::Matrix2d c = j * r.covariance * j.transpose();
        const double square = e.dot(c.ldlt().solve(e));
        const bool near = e.norm() < std::max({0.15, 1.5 * t.sensor.pitch, 5 * t.best_sigma_mm}) &&
                          std::abs(r.scene_from_template.phi_rad - t.truth.phi_rad) < 0.05;
        if (!near && (square > 20 || e.norm() > 1)) {
            ++wrong;
            far += e.norm() > 1;
            if (told_of_each()) say("WRONG", t, r, e.norm(), std::sqrt(square));
            return;
        }
        ++right;
        covered += square < 5.991;
        if (told_of_each() && square > 16) say("unlikely", t, r, e.norm(), std::sqrt(square));
    }
    static void say(const char* what, const MatchScene& t, const Registration& r, double off, double sigmas) {
        std::printf(
            "  %s %s: %s, %.3f off (%.1f sigma), best %.3f; %d x %.3f noise %.3f grid %d missing %.3f share "
            "%.2f\n",
            what, t.name, std::string(to_string(r.status)).c_str(), off, sigmas, t.best_sigma_mm,
            t.sensor.points, t.sensor.pitch, t.sensor.noise, int(t.sensor.grid), t.sensor.missing,
            r.inlier_share);
    }
    int of(RegistrationStatus s) const {
        const auto found = refused.find(s);
        return found == refused.end() ? 0 : found->second;
    }
    void print(const char* name) const {
        std::printf("%-24s %6d %7.2f %% %6d %5d | %5d %5d %5d %5d %5d | %5.1f %%\n", name, trials,
                    trials ? 100. * right / trials : 0, wrong, far, of(RegistrationStatus::no_match),
                    of(RegistrationStatus::sliding), of(RegistrationStatus::ambiguous),
                    of(RegistrationStatus::other_shape), of(RegistrationStatus::no_points),
                    right ? 100. * covered / right : 0);
    }
};

Registration matched(const MatchScene& t) {
    Profile taught = t.taught, scene = t.scene;
    if (!filter_profile(taught, {}) || !filter_profile(scene, {})) return {};
    auto matcher = ContourMatcher::make(taught, t.reference);
    return matcher ? matcher->match(scene, t.window) : Registration{};
}

TEST(Joints, MatchedWhereDeterminedRefusedOtherwise) {
    for (const bool inside : {true, false}) {
        std::printf("\n%-24s %6s %9s %6s %5s | %5s %5s %5s %5s %5s | %s\n",
                    inside ? "in the window" : "beyond it", "n", "right", "WRONG", "far", "no", "slid",
                    "ambig", "other", "none", "95 % covers");
        MatchTally all, never;
        for (const JointMaker make : kJoints) {
            Dice dice(seed_of(102));
            MatchTally known, unknown;
            const char* name = "";
            for (int i = 0; i < trials_of(60); ++i) {
                const Joint joint = make(dice);
                name = joint.name;
                SensorModel sensor = SensorModel::any(dice);
                sensor.quantum = std::min(sensor.quantum, sensor.noise);
                const MatchScene t = match_scene(joint, sensor, inside ? 0 : 1.1, inside ? 0.98 : 2, dice);
                const Registration r = matched(t);
                (t.determined() ? known : unknown).add(t, r);
                (t.determined() ? all : never).add(t, r);
            }
            known.print(name);
            if (unknown.trials > 0) unknown.print("  not determined");
        }
        all.print("ALL determined");
        never.print("ALL others");
        if (inside) {
            EXPECT_GE(all.right, 0.97 * all.trials);
            EXPECT_GE(all.covered, 0.915 * all.right);  // of about 720: 1.2 % is a sigma
        }
        EXPECT_LE(all.wrong + never.wrong, 0.004 * (all.trials + never.trials));
        EXPECT_LE(all.far + never.far, 0.002 * (all.trials + never.trials));
    }
}

// What neighbours share of their noise, by a sensor's own mean or by speckle, is no shape of the part and no more points; a
// step that the mean has drawn out is no flank. Never at a wrong place for that, and as sure as it says.
TEST(Joints, SharedNoiseIsNoShape) {
    struct Like {
        int smoothed, speckle;
        double least_right;
    };
    for (const Like shared : {Like{3, 1, 0.9}, {5, 1, 0.8}, {1, 5, 0.75}}) {
        std::printf("\nmean of %d, speckle of %d\n", shared.smoothed, shared.speckle);
        MatchTally all, never;
        for (const JointMaker make : kJoints) {
            Dice dice(seed_of(103));
            MatchTally known;
            const char* name = "";
            for (int i = 0; i < trials_of(50); ++i) {
                const Joint joint = make(dice);
                name = joint.name;
                SensorModel sensor = SensorModel::any(dice);
                sensor.quantum = std::min(sensor.quantum, sensor.noise);
                if (shared.speckle > 1) sensor.grid = Grid::exact;
                SensorModel drawn = sensor;
                if (shared.speckle > 1) drawn.noise = 0.1 * sensor.noise;  // the rest is speckle
                MatchScene t = match_scene(joint, drawn, 0, 0.98, dice);
                t.sensor = sensor;
                // As many points as one count as one.
                t.best_sigma_mm *= shared.speckle > 1 ? 10 * std::sqrt(shared.speckle) : 1;
                for (Profile* p : {&t.taught, &t.scene}) {
                    if (shared.speckle > 1) speckle(*p, sensor.noise, shared.speckle, dice);
                    smooth(*p, shared.smoothed);
                }
                const Registration r = matched(t);
                (t.determined() ? known : never).add(t, r);
                if (t.determined()) all.add(t, r);
            }
            known.print(name);
        }
        all.print("ALL determined");
        never.print("ALL others");
        EXPECT_GE(all.right, shared.least_right * all.trials);
        EXPECT_GE(all.covered, 0.91 * all.right);
        EXPECT_LE(all.wrong, 0.004 * all.trials);
        EXPECT_LE(all.far + never.far, 0.002 * (all.trials + never.trials));
    }
}

// A joggle less deep than the taught one lies between the places of its two flats: found, it is as unsure as that. The right shape
// is no less sure for it.
TEST(Joints, AnotherShapeIsAsUnsureAsItIsOther) {
    const auto joggle = [](double depth) {
        return Joint{"joggle", {{{-kFar, 0}, {0, 0}, {2, -depth}, {kFar, -depth}}}, -8, 10};
    };
    for (const double noise : {0.03, 0.06})
        for (const double depth : {2.0, 1.8, 1.5}) {
            int ok = 0, covered = 0;
            double sigma = 0;
            for (int i = 0; i < 40; ++i) {
                Dice dice(seed_of(500 + std::uint64_t(i)));
                SensorModel sensor;
                sensor.points = 640, sensor.pitch = 0.09, sensor.noise = noise, sensor.grid = Grid::exact;
                MatchScene t = match_scene(joggle(2), sensor, 0, 0.5, dice, false);
                t.reference = {-2, 0};
                t.scene = seen(moved(joggle(depth).sheets, t.truth), sensor, dice);
                const Registration r = matched(t);
                if (r.status != RegistrationStatus::ok) continue;
                const Vector2d there = r.scene_from_template * t.reference, e = there - t.truth * t.reference;
                const Vector2d arm =
                    there - Vector2d(r.scene_from_template.dx_mm, r.scene_from_template.dz_mm);
                Eigen::Matrix<double, 2, 3> j;
                j << 1, 0, -arm.y(), 0, 1, arm.x();
                const Eigen::Matrix2d c = j * r.covariance * j.transpose();
                ++ok;
                covered += e.dot(c.ldlt().solve(e)) < 5.991;
                sigma += std::min(std::sqrt(c(1, 1)), 1.0);
            }
            EXPECT_GE(ok, depth > 1.9 ? 39 : 20) << noise << " " << depth;
            EXPECT_GE(covered, 0.85 * ok) << noise << " " << depth;
            if (depth > 1.9) {
                EXPECT_LT(sigma / ok, 0.2 * noise + 0.003);
            }
        }
}

// A gap's slopes determine nothing, so that the census above has nothing to measure a place by: an answer that lies a
// millimetre off is wrong nonetheless.
TEST(Joints, AGapBeyondTheWindowIsNotFoundInIt) {
    Dice dice(seed_of(300));
    int ok = 0, far = 0;
    const int trials = trials_of(300);
    for (int i = 0; i < trials; ++i) {
        const Joint joint = butt_joint(dice);
        SensorModel sensor = SensorModel::any(dice);
        sensor.quantum = std::min(sensor.quantum, sensor.noise);
        const MatchScene t = match_scene(joint, sensor, 1.1, 2, dice);
        const Registration r = matched(t);
        if (r.status != RegistrationStatus::ok) continue;
        ++ok;
        far += (r.scene_from_template * t.reference - t.truth * t.reference).norm() > 1;
    }
    std::printf("butt gap beyond the window: ok %d, of them a millimetre off %d, of %d\n", ok, far, trials);
    EXPECT_LE(far, 0.001 * trials);
}

}  // namespace
}  // namespace seamwright::scenes
