#pragma once
// Pairs of a taught contour and a scene in which it was moved, over the kinds of contours that are met on
// sheet metal, with what could be known about the motion at best. Shares no code with the estimators.
//
// A section is a polygon in x and z, z towards the sensor. The sensor has `points` lines `pitch` apart, sees
// the highest crossing of each, nothing on flanks steeper than it can see, and adds noise in z.

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "contours.h"

namespace seamwright::test {

struct Section {
    std::string name;
    Shape shape;                  // reaches far beyond the taught piece
    double from_x = 0, to_x = 0;  // the taught piece, as taught
    std::size_t gap_after = 0;    // polygon edge that is a gap (a hole between two sheets); 0: none
};

// A flat of `flat` mm ends in a rounded rim of the given radius that turns down by `turn_deg`.
inline Section rounded_rim(double radius, double flat, double turn_deg = 90) {
    Section s{"rim r" + std::to_string(static_cast<int>(radius)), {}, -flat, radius + 0.01, 0};
    s.shape.line_to(-150, 0);
    s.shape.line_to(0, 0);
    s.shape.arc(0, -radius, radius, 90, 90 - turn_deg);
    s.to_x = s.shape.x.back() + 0.01;
    return s;
}
inline Section z_fold(double height, double steepness_deg, double radius, double flat) {
    Section s{"z-fold", {}, 0, 0, 0};
    const double a = rad_from_deg(steepness_deg), run = radius * std::tan(0.5 * a);
    const double across = height / std::tan(a);
    s.shape.line_to(-150, 0);
    s.shape.line_to(-run, 0);
    s.shape.arc(-run, radius, radius, -90, -90 + steepness_deg);
    const double top = across + run;
    s.shape.line_to(top - radius * std::sin(a), height - radius * (1 - std::cos(a)));
    s.shape.arc(top, height - radius, radius, 90 + steepness_deg, 90);
    s.shape.line_to(150, height);
    s.from_x = -flat;
    s.to_x = across + flat;
    return s;
}
inline Section hem_flange(double radius, double flat) {
    Section s{"hem", {}, -flat, 0, 0};
    s.shape.line_to(-150, -0.02 * 150);
    s.shape.line_to(0, 0);
    s.shape.arc(0.02 * radius, -radius, radius, 90 + 1.146, -35);
    const double x = s.shape.x.back(), z = s.shape.z.back() - 2;
    s.shape.line_to(x - 1, z);
    s.shape.line_to(x + 150, z - 5);
    s.to_x = x + 4;
    return s;
}
inline Section v_groove(double opening_deg, double depth, double flat) {
    Section s{"v-groove", {}, 0, 0, 0};
    const double half = depth * std::tan(rad_from_deg(0.5 * opening_deg));
    s.shape.line_to(-150, 0);
    s.shape.line_to(-half, 0);
    s.shape.line_to(0, -depth);
    s.shape.line_to(half, 0);
    s.shape.line_to(150, 0);
    s.from_x = -half - flat;
    s.to_x = half + flat;
    return s;
}
inline Section lap_joint(double thickness, double flat) {
    Section s{"lap", {}, -flat, flat, 0};
    s.shape.line_to(-150, thickness);
    s.shape.line_to(0, thickness);
    s.shape.line_to(0, 0);
    s.shape.line_to(150, 0);
    return s;
}
inline Section hole_rim(double radius, double flat, double width) {
    Section s{"hole", {}, -flat, 0, 0};
    s.shape.line_to(-150, 0);
    s.shape.line_to(0, 0);
    s.shape.arc(0, -radius, radius, 90, 20);
    s.gap_after = s.shape.x.size();
    s.to_x = s.shape.x.back() + 0.01;
    Shape right;
    right.arc(width + 2 * radius, -radius, radius, 160, 90);
    s.shape.x.insert(s.shape.x.end(), right.x.begin(), right.x.end());
    s.shape.z.insert(s.shape.z.end(), right.z.begin(), right.z.end());
    s.shape.line_to(150, 0);
    return s;
}

// Information about a motion of the section (shift in x and z in mm, turn in radian about `about`).
struct Seen {
    Profile profile;
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    int points_on_piece = 0;
    int telling_points =
        0;  // that stand out of the line in which the piece begins by more than four sigma of
            // a difference of two points: fewer than a handful do not tell a shape from noise
};

struct SensorSettings {
    int points = 640;
    double pitch = 0.1, noise = 0.02, steepest_deg = 75;
    bool reversed = false;  // sensor order against x
};

// `motion` moves the section; `piece_only` leaves out what is beside the taught piece.
inline Seen look(const Section& section, const PlanarMotion& motion, const SensorSettings& sensor,
                 const Eigen::Vector2d& about, bool piece_only, double phase, Random& random) {
    const Shape s = section.shape.moved(motion);
    const double first = -0.5 * sensor.pitch * (sensor.points - 1) + phase * sensor.pitch;
    const auto n = static_cast<std::size_t>(sensor.points);
    std::vector<double> height(n, -std::numeric_limits<double>::infinity());
    std::vector<std::size_t> edge_of(n, 0);
    for (std::size_t i = 1; i < s.x.size(); ++i) {
        if (i == section.gap_after) continue;
        const double ka = (s.x[i - 1] - first) / sensor.pitch, kb = (s.x[i] - first) / sensor.pitch;
        const double lo = std::max(0.0, std::ceil(std::min(ka, kb)));
        const double hi = std::min(double(n) - 1, std::floor(std::max(ka, kb)));
        for (double k = lo; k <= hi; k += 1) {
            const double t = kb != ka ? (k - ka) / (kb - ka) : 0.5;
            const double z = s.z[i - 1] + t * (s.z[i] - s.z[i - 1]);
            const auto cell = static_cast<std::size_t>(k);
            if (z <= height[cell]) continue;
            height[cell] = z;
            edge_of[cell] = i;
        }
    }
    Seen seen;
    std::normal_distribution<double> noise;
    const double variance = std::max(sensor.noise * sensor.noise, 1e-8);
    std::size_t last = n, begin = 1;
    while (begin + 1 < s.x.size() && section.shape.x[begin] < section.from_x) ++begin;
    const Eigen::Vector2d at(s.x[begin], s.z[begin]);
    const Eigen::Vector2d along =
        Eigen::Vector2d(s.x[begin] - s.x[begin - 1], s.z[begin] - s.z[begin - 1]).normalized();
    for (std::size_t cell = 0; cell < n; ++cell) {
        const std::size_t i = edge_of[cell];
        if (i == 0) continue;
        Eigen::Vector2d t(s.x[i] - s.x[i - 1], s.z[i] - s.z[i - 1]);
        t.normalize();
        const double taught_x = 0.5 * (section.shape.x[i] + section.shape.x[i - 1]);
        const bool on_piece = taught_x >= section.from_x && taught_x <= section.to_x;
        if (piece_only && !on_piece) continue;
        const double error = sensor.noise * noise(random);
        if (std::abs(t.x()) < std::cos(rad_from_deg(sensor.steepest_deg))) continue;
        const double x = first + sensor.pitch * double(cell);
        seen.profile.x_mm.push_back(x);
        seen.profile.z_mm.push_back(height[cell] + error);
        if (!on_piece) {
            last = n;
            continue;
        }
        ++seen.points_on_piece;
        const Eigen::Vector2d from = Eigen::Vector2d(x, height[cell]) - at;
        const double out = std::abs(along.x() * from.y() - along.y() * from.x());
        seen.telling_points += out > 4 * std::sqrt(2.0) * sensor.noise;
        const Eigen::Vector2d p = Eigen::Vector2d(x, height[cell]) - about;
        // z = height(x): a shift (u, v) and a turn w change it by v + w x - slope (u - w z).
        const double slope = t.y() / t.x();
        const Eigen::Vector3d row(-slope, 1, p.x() + slope * p.y());
        seen.information += row * row.transpose() / variance;
        // A step between neighbours says where it is to a pitch.
        if (last + 1 == cell &&
            std::abs(height[cell] - height[last]) >
                std::max(8 * sensor.noise, 4 * sensor.pitch) + std::abs(slope) * sensor.pitch) {
            const Eigen::Vector3d place(1, 0, -p.y());
            seen.information += place * place.transpose() * 12 / (sensor.pitch * sensor.pitch);
        }
        last = cell;
    }
    if (sensor.reversed) {
        std::reverse(seen.profile.x_mm.begin(), seen.profile.x_mm.end());
        std::reverse(seen.profile.z_mm.begin(), seen.profile.z_mm.end());
    }
    return seen;
}

inline void mirror_x(Profile& p) {
    for (double& x : p.x_mm) x = -x;
}

struct MatchTrial {
    Profile taught, scene;
    PlanarMotion truth;
    Eigen::Vector2d reference = Eigen::Vector2d::Zero();
    SearchWindow window;
    bool inside = true;            // the motion lies within the window
    double landmark_sigma_mm = 0;  // what the two profiles could tell at best; infinite where nothing
    double scale_mm = 0.1;         // the coarser pitch
    std::string what;

    double error_mm(const PlanarMotion& m) const { return (m * reference - truth * reference).norm(); }
    bool right(const PlanarMotion& m) const {
        return error_mm(m) < std::max({0.15, 1.5 * scale_mm, 5 * landmark_sigma_mm}) &&
               std::abs(m.phi_rad - truth.phi_rad) < 0.05;
    }
    bool determined() const { return landmark_sigma_mm < 0.1; }
};

struct TrialRange {
    double outwards_from = 0, outwards_to = 1;  // motion in parts of the window
    bool may_mirror = true;
};

inline Section random_section(int kind, Random& random) {
    std::uniform_real_distribution<double> unit(0, 1);
    const double flat = 5 + 10 * unit(random);
    switch (kind) {
        case 0:
            return rounded_rim(1, flat, 60 + 30 * unit(random));
        case 1:
            return rounded_rim(2, flat, 60 + 30 * unit(random));
        case 2:
            return rounded_rim(4, flat, 60 + 30 * unit(random));
        case 3:
            return rounded_rim(8, flat, 60 + 30 * unit(random));
        case 4:
            return z_fold(1 + 4 * unit(random), 20 + 45 * unit(random), 0.5 + 1.5 * unit(random), flat);
        case 5:
            return hem_flange(0.7 + 1.8 * unit(random), flat);
        case 6:
            return v_groove(unit(random) < 0.5 ? 60 : 90, 1 + 4 * unit(random), flat);
        case 7:
            return lap_joint(0.5 + 1.5 * unit(random), flat);
        default:
            return hole_rim(0.5 + 1.5 * unit(random), flat, 5 + 15 * unit(random));
    }
}
inline constexpr int kSectionKinds = 9;

// Everything but the section and how far it moved is drawn at random.
inline MatchTrial make_trial(const Section& section, const TrialRange& range, Random& random) {
    std::uniform_real_distribution<double> unit(0, 1);
    auto between = [&](double a, double b) { return a + (b - a) * unit(random); };
    auto log_between = [&](double a, double b) { return a * std::pow(b / a, unit(random)); };
    const int counts[] = {320, 640, 1024, 2048, 4096};
    SensorSettings sensor;
    do {
        sensor.points = counts[std::uniform_int_distribution<int>(0, 4)(random)];
        sensor.pitch = log_between(0.02, 0.3);
    } while (sensor.points * sensor.pitch < 50 || sensor.points * sensor.pitch > 150);
    sensor.noise = log_between(0.01, 0.1);
    sensor.reversed = unit(random) < 0.3;
    MatchTrial trial;
    trial.scale_mm = sensor.pitch;
    trial.window.dx_mm = between(5, 12);
    trial.window.dz_mm = between(3, 12);
    trial.window.phi_rad = rad_from_deg(between(3, 15));
    trial.window.pivot = SearchPivot::reference;
    const Eigen::Vector2d about(between(-2, 3), between(-2, 1));
    trial.reference = about;
    const double out = between(range.outwards_from, range.outwards_to);
    const double sign = unit(random) < 0.5 ? -1 : 1;
    const double turn = trial.window.phi_rad * between(-1, 1);
    // The landmark's motion in parts of the window: one of the two axes takes all of it.
    const bool along_x = unit(random) < 0.7;
    const Eigen::Vector2d shift(trial.window.dx_mm * (along_x ? sign * out : between(-1, 1)),
                                trial.window.dz_mm * (along_x ? between(-1, 1) : sign * out));
    trial.inside = out <= 1;
    PlanarMotion motion{0, 0, turn};
    const Eigen::Vector2d d = about + shift - motion * about;
    motion = {d.x(), d.y(), turn};
    trial.truth = motion;
    Seen taught = look(section, {}, sensor, about, true, unit(random), random);
    Seen scene = look(section, motion, sensor, motion * about, false, unit(random), random);
    // The scene's information is about the moved section's landmark; the taught one's turned into it.
    Eigen::Matrix3d r = Eigen::Matrix3d::Identity();
    r(0, 0) = r(1, 1) = std::cos(turn);
    r(1, 0) = std::sin(turn);
    r(0, 1) = -r(1, 0);
    auto inverse = [](const Eigen::Matrix3d& m) {
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> e(m);
        const Eigen::Vector3d v = e.eigenvalues().cwiseMax(1e-9).cwiseInverse();
        return Eigen::Matrix3d(e.eigenvectors() * v.asDiagonal() * e.eigenvectors().transpose());
    };
    const Eigen::Matrix3d covariance =
        inverse(scene.information) + r * inverse(taught.information) * r.transpose();
    const bool enough = taught.points_on_piece >= 20 && scene.points_on_piece >= taught.points_on_piece / 2 &&
                        std::min(taught.telling_points, scene.telling_points) >= 5;
    trial.landmark_sigma_mm =
        enough
            ? std::sqrt(
                  covariance.topLeftCorner<2, 2>().selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff())
            : std::numeric_limits<double>::infinity();
    trial.taught = std::move(taught.profile);
    trial.scene = std::move(scene.profile);
    if (range.may_mirror && unit(random) < 0.5) {
        mirror_x(trial.taught);
        mirror_x(trial.scene);
        trial.reference.x() = -trial.reference.x();
        trial.truth.dx_mm = -trial.truth.dx_mm;
        trial.truth.phi_rad = -trial.truth.phi_rad;
    }
    trial.what = section.name + " " + std::to_string(sensor.points) + " points, pitch " +
                 std::to_string(sensor.pitch) + ", noise " + std::to_string(sensor.noise);
    return trial;
}

// What a range finder turning in the plane sees of a room of 8 x 6 m with a recess, a pillar and two
// cupboards: half a degree a ray over 270 degrees.
struct RoomScan {
    Profile profile;
};
inline RoomScan scan_room(const Eigen::Vector2d& at, double turn, double noise, Random& random) {
    const std::vector<std::vector<Eigen::Vector2d>> walls{
        {{-3500, -2500},
         {4500, -2500},
         {4500, 1000},
         {5500, 1000},
         {5500, 2600},
         {4500, 2600},
         {4500, 3500},
         {-3500, 3500},
         {-3500, -2500}},
        {{1500, 1200}, {1900, 1200}, {1900, 1600}, {1500, 1600}, {1500, 1200}},
        {{-3500, 800}, {-2900, 800}, {-2900, 2000}, {-3500, 2000}},
        {{1000, -2500}, {1000, -2050}, {2600, -2050}, {2600, -2500}}};
    std::normal_distribution<double> error(0, noise);
    RoomScan scan;
    for (int ray = 0; ray <= 540; ++ray) {
        const double local = rad_from_deg(-135 + 0.5 * ray), angle = local + turn;
        const Eigen::Vector2d d(std::cos(angle), std::sin(angle));
        double nearest = 1e9;
        for (const auto& wall : walls)
            for (std::size_t i = 1; i < wall.size(); ++i) {
                const Eigen::Vector2d e = wall[i] - wall[i - 1], f = wall[i - 1] - at;
                const double cross = d.x() * e.y() - d.y() * e.x();
                if (std::abs(cross) < 1e-9) continue;
                const double range = (f.x() * e.y() - f.y() * e.x()) / cross;
                const double along = (f.x() * d.y() - f.y() * d.x()) / cross;
                if (range > 0 && along >= 0 && along <= 1) nearest = std::min(nearest, range);
            }
        if (nearest > 1e8) continue;
        const double range = nearest + error(random);
        scan.profile.x_mm.push_back(range * std::cos(local));
        scan.profile.z_mm.push_back(range * std::sin(local));
    }
    return scan;
}

}  // namespace seamwright::test
