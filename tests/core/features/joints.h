#pragma once
// The joints and rims of car bodies, one description each for filter, match and frozen contour; the features' scenes
// beside them. With contour_scenes.h all of it is drawn from geometry: nothing here is shared with the estimators, the
// simulated sensor or the other generators.

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <cstdlib>

#include "contour_scenes.h"
#include "core/features/registration/registration.h"

namespace seamwright::scenes {

// What the environment asks of the tests on joints: so many scenes of each kind, other ones, each that went wrong.
inline int trials_of(int wanted) {
    const char* n = std::getenv("SEAMWRIGHT_TRIALS");
    return n ? std::atoi(n) : wanted;
}
inline std::uint64_t seed_of(std::uint64_t usual) {
    const char* n = std::getenv("SEAMWRIGHT_SEED");
    return n ? std::strtoull(n, nullptr, 10) + usual : usual;
}
inline bool told_of_each() {
    return std::getenv("SEAMWRIGHT_SCENES") != nullptr;
}

// A joint about the origin, seen from above. Its sheets reach far beyond every field.
struct Joint {
    const char* name = "";
    std::vector<Sheet> sheets;
    double from_x = -12, to_x = 12;  // the piece that is taught
};

inline Joint z_fold_joint(Dice& d) {
    const double turn = d.uniform(25, 75), length = d.uniform(2, 8), radius = d.uniform(0.3, 2);
    Sheet s{{-kFar, 0}, {0, 0}};
    roll(s, 0, turn, radius);
    go(s, turn, length);
    roll(s, turn, -turn, radius);
    const double end = s.back().x();
    go(s, 0, kFar);
    return {"Z-fold", {s}, -d.uniform(5, 12), end + d.uniform(5, 12)};
}
inline Joint hem_joint(Dice& d) {
    const double radius = d.uniform(0.7, 2.5);
    Sheet s{{-kFar, 0.02 * kFar}, {0, 0}};
    roll(s, -1.146, -100, radius);
    const double below = -2 * radius - d.uniform(0, 2);
    return {"hem flange", {s, {{-5, below}, {kFar, below - 0.03 * kFar}}}, -d.uniform(5, 15), radius + 4};
}
inline Joint rim_joint(Dice& d, double least = 2, double most = 8) {
    const double radius = d.uniform(least, most);
    Sheet s{{-kFar, 0}, {0, 0}};
    roll(s, 0, -d.uniform(60, 90), radius);
    return {most <= 2 ? "rounded rim 1 to 2" : "rounded rim 2 to 8", {s}, -d.uniform(5, 15), radius + 0.1};
}
inline Joint t_joint_joint(Dice& d) {
    const double flank = d.uniform(65, 80), height = d.uniform(8, 20), width = d.uniform(1.5, 4);
    Sheet s{{-kFar, 0}, {0, 0}};
    go(s, flank, height);
    go(s, 0, width);
    return {"T-joint", {s, {{0, 0}, {kFar, 0}}}, -d.uniform(5, 10), s.back().x() + d.uniform(3, 8)};
}
inline Joint groove_joint(Dice& d) {
    const double open = d.chance(0.5) ? 60 : 90, depth = d.uniform(1, 8),
                 half = depth * std::tan(rad(open / 2));
    return {"V-groove 60, 90",
            {{{-kFar, 0}, {-half, 0}, {0, -depth}, {half, 0}, {kFar, 0}}},
            -half - d.uniform(5, 10),
            half + d.uniform(5, 10)};
}
inline Joint lap_joint(Dice& d) {
    const double step = d.uniform(0.5, 2);
    return {"lap joint 0.5 to 2",
            {{{-kFar, 0}, {0, 0}}, {{-20, -step}, {kFar, -step}}},
            -d.uniform(5, 12),
            d.uniform(5, 12)};
}
// A plate, a web that leans, and the weld's face between them, a little hollow or full.
inline Joint fillet_joint(Dice& d) {
    const double flank = d.uniform(60, 78), leg = d.uniform(3, 8), bow = d.uniform(-0.15, 0.2) * leg;
    const Vector2d toe(-leg, 0), top = turned({leg, 0}, rad(flank)), chord = (top - toe).normalized();
    Sheet s{{-kFar, 0}};
    for (int i = 0; i <= 24; ++i) {
        const double t = i / 24.;
        s.push_back(toe + t * (top - toe) + 4 * bow * t * (1 - t) * Vector2d(-chord.y(), chord.x()));
    }
    go(s, flank, d.uniform(4, 12));
    go(s, 0, d.uniform(2, 5));
    return {"fillet weld", {s, {{s.back().x(), -3}, {kFar, -3}}}, -leg - d.uniform(5, 10), s.back().x()};
}
inline Joint butt_joint(Dice& d) {
    const double gap = d.spread(0.2, 3), flush = d.uniform(-0.3, 0.3);
    return {"butt gap 0.2 to 3",
            {{{-kFar, 0}, {0, 0}}, {{gap, flush}, {kFar, flush}}},
            -d.uniform(5, 12),
            gap + d.uniform(5, 12)};
}
inline Joint hole_joint(Dice& d) {
    const double radius = d.uniform(0.5, 1.5), width = d.uniform(5, 20);
    Sheet left{{-kFar, 0}, {0, 0}}, right{{kFar, 0}, {2 * radius + width, 0}};
    roll(left, 0, -70, radius);
    roll(right, 180, 70, radius);
    return {"hole rim", {left, right}, -d.uniform(5, 12), 2 * radius + 0.1};
}
inline Joint bead_joint(Dice& d) {
    const double side = d.uniform(25, 60), radius = d.uniform(3, 8), foot = d.uniform(0.5, 3);
    Sheet s{{-kFar, 0}, {0, 0}};
    roll(s, 0, side, foot);
    roll(s, side, -2 * side, radius);
    roll(s, -side, side, foot);
    const double end = s.back().x();
    go(s, 0, kFar);
    return {"embossed bead", {s}, -d.uniform(4, 8), end + d.uniform(4, 8)};
}
inline Joint burr_joint(Dice& d) {
    const double height = d.uniform(0.1, 0.4), width = d.uniform(0.1, 0.4);
    Sheet s{{-kFar, 0}, {-width, 0}, {-0.4 * width, height}, {0, 0.6 * height}};
    return {"bare edge with burr", {s}, -d.uniform(5, 15), 0.1};
}
using JointMaker = Joint (*)(Dice&);
inline constexpr JointMaker kJoints[] = {z_fold_joint,
                                         hem_joint,
                                         [](Dice& d) { return rim_joint(d); },
                                         [](Dice& d) { return rim_joint(d, 1, 2); },
                                         t_joint_joint,
                                         groove_joint,
                                         lap_joint,
                                         fillet_joint,
                                         butt_joint,
                                         hole_joint,
                                         bead_joint,
                                         burr_joint};

inline std::vector<Sheet> moved(const std::vector<Sheet>& sheets, const PlanarMotion& m) {
    std::vector<Sheet> out = sheets;
    for (Sheet& s : out)
        for (Vector2d& p : s) p = turned(p, m.phi_rad) + Vector2d(m.dx_mm, m.dz_mm);
    return out;
}

// Distance of a point from all that is drawn, hidden or not.
inline double distance_mm(const std::vector<Sheet>& sheets, const Vector2d& p) {
    double least = std::numeric_limits<double>::infinity();
    for (const Sheet& s : sheets)
        for (std::size_t k = 1; k < s.size(); ++k) {
            const Vector2d e = s[k] - s[k - 1];
            const double t =
                e.squaredNorm() > 0 ? std::clamp((p - s[k - 1]).dot(e) / e.squaredNorm(), 0., 1.) : 0;
            least = std::min(least, (p - s[k - 1] - t * e).norm());
        }
    return least;
}

// Bursts of one to three points put off the contour by 0.3 to 10 mm, along z, as dust, sparks and double reflections do.
// Only what can be told from it: seven sigma and 0.3 mm from every surface, whichever lies beside.
struct Spoilt {
    std::vector<char> outlier;  // per line
};
inline Spoilt spoil(Profile& p, const std::vector<Sheet>& sheets, const SensorModel& s, double share,
                    Dice& dice) {
    Spoilt out{std::vector<char>(p.size(), 0)};
    const double clear = std::max(0.3, 7 * s.noise);
    for (std::size_t k = 0; k < p.size(); ++k) {
        if (!dice.chance(share / 2)) continue;
        const int length = 1 + dice.of(3);
        const bool shared = dice.chance(0.5);
        double offset = 0;
        for (int b = 0; b < length && k < p.size(); ++b, ++k) {
            if (b == 0 || !shared) offset = (dice.chance(0.5) ? 1 : -1) * dice.uniform(0.3, 10);
            if (std::isnan(p.z_mm[k])) continue;
            Vector2d at(p.x_mm[k], p.z_mm[k] + offset);
            for (int tries = 0; tries < 20 && distance_mm(sheets, at) < clear; ++tries)
                at.y() += std::copysign(0.3 * clear, offset);
            if (distance_mm(sheets, at) < clear) continue;
            p.z_mm[k] = at.y();
            out.outlier[k] = 1;
        }
        --k;  // the next burst may follow at once
    }
    return out;
}

// What a cut tells about its motion (shift along x, along z, turn about `about`): slopes of the visible surface under
// the sensor's noise, and jumps, whose place is known to a pitch.
struct Told {
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    int points = 0,
        telling = 0;  // seen at all; standing out of the first straight by four sigma of a difference
};
inline Told told(const std::vector<Sheet>& sheets, const SensorModel& s, const Vector2d& about, double from_x,
                 double to_x) {
    Told out;
    const double eps = 1e-4;
    std::vector<double> at;
    const double first = -s.half_field() + 0.5 * s.pitch;
    for (int i = 0; i < s.points; ++i) {
        const double x = first + s.pitch * i;
        if (x < from_x || x > to_x) continue;
        at.insert(at.end(), {x - eps, x, x + eps});
    }
    const auto z = heights(sheets, at, s.steepest_deg);
    double base_z = 0, base_slope = 0, last_z = std::numeric_limits<double>::quiet_NaN();
    bool based = false;
    for (std::size_t k = 0; k < at.size(); k += 3) {
        const double slope = (z[k + 2] - z[k]) / (2 * eps), h = z[k + 1], x = at[k + 1];
        if (!(std::abs(slope) < 50)) {
            last_z = std::numeric_limits<double>::quiet_NaN();
            continue;
        }
        if (!based) based = true, base_z = h - slope * x, base_slope = slope;
        const double out_of = std::abs(h - base_z - base_slope * x) / std::hypot(1, base_slope);
        ++out.points;
        out.telling += out_of > 4 * std::sqrt(2.0) * s.noise;
        const double noise = std::max(s.noise, 0.3 * s.quantum);
        const double variance = noise * noise * (s.grid == Grid::exact ? 1 : 1 + slope * slope);
        const Vector2d p = Vector2d(x, h) - about;
        const Eigen::Vector3d row(-slope, 1, p.x() + slope * p.y());
        out.information += row * row.transpose() / std::max(variance, 1e-8);
        if (std::abs(h - last_z) > std::max(8 * s.noise, 4 * s.pitch) + std::abs(slope) * s.pitch) {
            const Eigen::Vector3d place(1, 0, -p.y());
            out.information += place * place.transpose() * 12 / (s.pitch * s.pitch);
        }
        last_z = h;
    }
    return out;
}

// A taught piece and a scene in which the joint was moved, by the same sensor.
struct MatchScene {
    Profile taught, scene;
    PlanarMotion truth;
    Vector2d reference = Vector2d::Zero();
    SearchWindow window;
    SensorModel sensor;
    double best_sigma_mm = 0;  // of the landmark, at best; infinite where nothing tells
    const char* name = "";
    bool determined() const { return best_sigma_mm < 0.1; }
};

// `reach`: how far of the window the joint moves; more than 1: beyond it.
inline MatchScene match_scene(const Joint& joint, const SensorModel& sensor, double least_reach,
                              double most_reach, Dice& dice, bool other_ways = true) {
    MatchScene t;
    t.name = joint.name;
    t.sensor = sensor;
    t.window.dx_mm = dice.uniform(5, 12);
    t.window.dz_mm = dice.uniform(3, 12);
    t.window.phi_rad = rad(dice.uniform(3, 15));
    t.window.pivot = SearchPivot::reference;
    t.reference = {dice.uniform(-2, 3), dice.uniform(-2, 1)};
    const double out = dice.uniform(least_reach, most_reach) * (dice.chance(0.5) ? -1 : 1);
    const bool along_x = dice.chance(0.7);
    const Vector2d shift(t.window.dx_mm * (along_x ? out : dice.uniform(-1, 1)),
                         t.window.dz_mm * (along_x ? dice.uniform(-1, 1) : out));
    const double turn = t.window.phi_rad * dice.uniform(-1, 1);
    const Vector2d d = t.reference + shift - turned(t.reference, turn);
    t.truth = {d.x(), d.y(), turn};
    SensorModel plain = sensor;
    plain.reversed = false;
    Profile taught = seen(joint.sheets, plain, dice);
    for (std::size_t i = 0; i < taught.size(); ++i)
        if (taught.x_mm[i] >= joint.from_x && taught.x_mm[i] <= joint.to_x) {
            t.taught.x_mm.push_back(taught.x_mm[i]);
            t.taught.z_mm.push_back(taught.z_mm[i]);
        }
    const auto sheets = moved(joint.sheets, t.truth);
    t.scene = seen(sheets, sensor, dice);
    if (sensor.reversed)
        for (auto* v : {&t.taught.x_mm, &t.taught.z_mm}) std::reverse(v->begin(), v->end());
    const Told at_teaching = told(joint.sheets, plain, t.reference, joint.from_x, joint.to_x);
    const Vector2d a = t.truth * Vector2d(joint.from_x, 0), b = t.truth * Vector2d(joint.to_x, 0);
    const Told now =
        told(sheets, plain, t.truth * t.reference, std::min(a.x(), b.x()), std::max(a.x(), b.x()));
    Eigen::Matrix3d r = Eigen::Matrix3d::Identity();
    r.topLeftCorner<2, 2>() << std::cos(turn), -std::sin(turn), std::sin(turn), std::cos(turn);
    const auto inverse = [](const Eigen::Matrix3d& m) {
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> e(m);
        const Eigen::Vector3d v = e.eigenvalues().cwiseMax(1e-9).cwiseInverse();
        return Eigen::Matrix3d(e.eigenvectors() * v.asDiagonal() * e.eigenvectors().transpose());
    };
    const bool enough = at_teaching.points >= 20 && now.points >= at_teaching.points / 2 &&
                        std::min(at_teaching.telling, now.telling) >= 5;
    const Eigen::Matrix3d c = inverse(now.information) + r * inverse(at_teaching.information) * r.transpose();
    t.best_sigma_mm =
        enough ? std::sqrt(c.topLeftCorner<2, 2>().selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff())
               : std::numeric_limits<double>::infinity();
    // Sensors whose x runs the other way, and such as look along -z.
    const bool mirrored = other_ways && dice.chance(0.5), down = other_ways && dice.chance(0.3);
    for (Profile* p : {&t.taught, &t.scene}) {
        if (mirrored)
            for (double& x : p->x_mm) x = -x;
        if (down)
            for (double& z : p->z_mm) z = -z;
    }
    if (mirrored) t.reference.x() *= -1, t.truth.dx_mm *= -1, t.truth.phi_rad *= -1;
    if (down) t.reference.y() *= -1, t.truth.dz_mm *= -1, t.truth.phi_rad *= -1;
    return t;
}

// Scenes of single features on these joints.

inline Scene burr_end(Dice& dice) {
    Scene s = end_on_the_right(dice);
    s.sheets = burr_joint(dice).sheets;
    // The burr's tip, or the sheet's surface beside it: nobody tells them apart.
    s.loose_mm = 0.45;
    return at_random_place(s, dice, 10);
}
// Where the weld's face meets the plate.
inline Scene weld_toe(Dice& dice) {
    Scene s = corner_scene(dice);
    const double leg = dice.uniform(4, 8), flank = dice.uniform(60, 78);
    const Vector2d toe(-leg, 0), top = turned({leg, 0}, rad(flank));
    Sheet sheet{{-kFar, 0}, toe, top};
    go(sheet, flank, dice.uniform(4, 12));
    go(sheet, 0, dice.uniform(2, 5));
    s.sheets = {sheet, {{sheet.back().x(), -3}, {kFar, -3}}};
    s.truth = toe;
    s = at_random_place(s, dice, 5);
    s.window(s.truth.x() - dice.uniform(6, 12), s.truth.x() + 0.8 * (top - toe).x());
    return s;
}
inline Scene bead_top(Dice& dice, bool round) {
    Scene s = corner_scene(dice);
    s.recipe.kind = "extremum";
    const double side = dice.uniform(25, 60), radius = round ? dice.uniform(3, 8) : 0;
    Sheet sheet{{-kFar, 0}, {0, 0}};
    go(sheet, side, dice.uniform(2, 5));
    if (round) roll(sheet, side, -2 * side, radius);
    go(sheet, -side, 2 * sheet.back().y());
    go(sheet, 0, kFar);
    s.sheets = {sheet};
    s.either = !round;  // under noise a ridge is a summit, somewhere near
    if (round) s.recipe.parameters["fit_length_mm"] = 1.6 * radius * std::sin(rad(side));
    s = at_random_place(s, dice, 0);
    // Of a polygon that is level at its top, the middle there.
    double highest = -1e9;
    Vector2d first = s.truth;
    for (const Vector2d& p : s.sheets[0]) {
        if (p.y() > highest + 1e-9) highest = p.y(), first = p;
        if (p.y() > highest - 1e-9) s.truth = 0.5 * (first + p);
    }
    return s;
}
inline Scene rim_centre(Dice& dice) {
    Scene s = corner_scene(dice);
    s.recipe.kind = "circle";
    const double radius = dice.uniform(2, 8), bend = 70;
    Sheet sheet{{-kFar, 0}, {0, 0}};
    roll(sheet, 0, -bend, radius);
    s.sheets = {sheet};
    s.truth = {0, -radius};
    // Of few points or much noise nobody knows the centre.
    s.either =
        radius < 12 * s.sensor.pitch || s.sensor.noise > 0.004 * std::sqrt(radius / s.sensor.pitch) * radius;
    s.turn(dice.uniform(-5, 5), {dice.uniform(-8, 8), dice.uniform(-20, 20)});
    // The arc alone, from where it has begun; that no straight hides in its noise nobody tells.
    const Vector2d from = s.sheets[0][1 + 8], to = s.sheets[0].back();
    s.window(from.x(), to.x() + 0.5);
    return s;
}
inline Scene template_of(Dice& dice) {
    Scene s = corner_scene(dice);
    s.recipe.kind = "template";
    MatchScene t;
    Joint joint;
    do {
        joint = kJoints[dice.of(std::size(kJoints))](dice);
        s.sensor = SensorModel::any(dice);
        s.sensor.quantum = std::min(s.sensor.quantum, s.sensor.noise);
        t = match_scene(joint, s.sensor, 0, 0.95, dice, false);
    } while (!t.determined());
    s.sheets = moved(joint.sheets, t.truth);
    s.truth = t.truth * t.reference;
    s.recipe.template_profile = t.taught;
    s.recipe.template_reference_mm = t.reference;
    s.recipe.parameters["window_dx_mm"] = t.window.dx_mm;
    s.recipe.parameters["window_dz_mm"] = t.window.dz_mm;
    s.recipe.parameters["window_dphi_deg"] = t.window.phi_rad * 180 / std::numbers::pi;
    s.loose_mm = 5 * t.best_sigma_mm;
    return s;
}

}  // namespace seamwright::scenes
