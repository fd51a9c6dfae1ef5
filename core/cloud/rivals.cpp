// Poses that would explain a scan as well.

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/cloud/fit_steps.h"
#include "core/geometry/decompositions.h"

namespace seamwright::fitting {
namespace {

// Fewer points speak for nothing: beside them, kAgainstRival times the rival's own are asked for.
constexpr std::size_t kLeastPoints = 8;
// Of a point's face: cos of 37 degrees between normals of one facing; facings that are turned by themselves and by twos;
// fewer points are no face.
constexpr double kOneFacing = 0.8;
constexpr std::size_t kMostFacings = 6;
constexpr double kLeastOfFacing = 0.006;  // of the points
// A point that misses a sheet's face lies over its inside, one that misses its end lies sideways of it: cos of 45 degrees
// from the normal. Of the points: fewer over the inside may be what stands on the part; where the sheet ends, few tell.
constexpr double kSideways = 0.7, kLeastShareFace = 0.04, kLeastShareEnds = 0.001;
constexpr double kLeastHalf_mm = 1e-3;  // of the part's thickness
// cos of 6 degrees: farther from the drawing's axes the part's own are others.
constexpr double kOwnAxes = 0.995;

Eigen::Matrix3d principal_axes(const Surface& surface) {
    const Cloud points = surface.sampled(1000, 7);
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const auto& p : points.points) middle += p / static_cast<double>(points.size());
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const auto& p : points.points) spread += (p - middle) * (p - middle).transpose();
    return symmetric_eigen(spread).vectors;
}

}  // namespace

PlateAxes plate_axes(const Surface& surface, const Pose& base_from_part) {
    const Cloud points = surface.sampled(1000, 7);
    Eigen::Matrix3d axes = principal_axes(surface).rowwise().reverse();  // the longest first
    if (axes.determinant() < 0) axes.col(2) = -axes.col(2);
    Eigen::AlignedBox3d own;
    for (const auto& p : points.points) own.extend(Eigen::Vector3d(axes.transpose() * p));
    PlateAxes plate;
    plate.middle_mm = base_from_part * Eigen::Vector3d(axes * own.center());
    plate.axes = base_from_part.linear() * axes;
    plate.half_mm = (own.sizes() / 2).cwiseMax(kLeastHalf_mm);
    return plate;
}

double corner_distance_mm(const Surface& surface, const Pose& a, const Pose& b) {
    double most = 0;
    for (int k = 0; k < 8; ++k) {
        const Eigen::Vector3d c = surface.box().corner(static_cast<Eigen::AlignedBox3d::CornerType>(k));
        most = std::max(most, (a * c - b * c).norm());
    }
    return most;
}

bool within_start(const Pose& pose, const Surface& surface, const FitOptions& options) {
    if (!options.start) return true;
    const Eigen::Vector3d c = surface.box().center();
    return (pose * c - *options.start * c).norm() <= options.start_mm &&
           angle_rad(pose, *options.start) <= rad_from_deg(options.start_deg);
}

std::vector<Pose> rival_starts(const Surface& surface, const Pose& best, const FitOptions& options) {
    std::vector<Pose> out;
    const Eigen::Vector3d centre = surface.box().center();
    const auto moved = [&](const Eigen::Vector3d& axis, double angle, const Eigen::Vector3d& shift) {
        const Eigen::Matrix3d turn = rotation_exp(angle * axis.normalized());
        const Pose part_from_part = make_pose(turn, centre - turn * centre + shift);
        const Pose pose = best * part_from_part;
        if (within_start(pose, surface, options)) out.push_back(pose);
    };
    // The drawing's axes, and the part's own where they are others.
    const Eigen::Matrix3d own = principal_axes(surface);
    std::vector<Eigen::Vector3d> axes{Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(),
                                      Eigen::Vector3d::UnitZ()};
    if (own.cwiseAbs().rowwise().maxCoeff().minCoeff() < kOwnAxes)
        for (int k = 0; k < 3; ++k) axes.emplace_back(own.col(k));
    static constexpr double kTurns_deg[] = {180, 90, -90, 120, -120, 8, -8};      // symmetries, and tilts
    static constexpr double kShifts[] = {0.02, -0.02, 0.06, -0.06, 0.18, -0.18};  // of the part's size
    for (const Eigen::Vector3d& axis : axes) {
        for (const double deg : kTurns_deg) moved(axis, rad_from_deg(deg), Eigen::Vector3d::Zero());
        for (const double share : kShifts) moved(axis, 0, share * surface.size_mm() * axis);
    }
    return out;
}

std::vector<Cloud> on_other_faces(const Cloud& cloud, const Surface& surface, const Pose& best,
                                  double gate_mm) {
    struct Facing {
        Eigen::Vector3f normal;
        std::vector<std::size_t> members;
    };
    std::vector<Facing> facings;
    const Pose part_from_base = best.inverse();
    Cloud seen = cloud;
    seen.towards.assign(cloud.size(), Eigen::Vector3f::Zero());
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        const auto near = surface.nearest(part_from_base * cloud.points[i], gate_mm);
        if (!near) continue;
        const Eigen::Vector3f normal = (best.linear() * near->normal).cast<float>();
        seen.towards[i] = normal;
        const auto alike = [&](const Facing& f) { return f.normal.dot(normal) > kOneFacing; };
        auto mine = std::find_if(facings.begin(), facings.end(), alike);
        if (mine == facings.end()) mine = facings.insert(mine, {normal, {}});
        mine->members.push_back(i);
    }
    std::stable_sort(facings.begin(), facings.end(),
                     [](const Facing& a, const Facing& b) { return a.members.size() > b.members.size(); });
    while (!facings.empty() &&
           (facings.size() > kMostFacings || static_cast<double>(facings.back().members.size()) <
                                                 kLeastOfFacing * static_cast<double>(cloud.size())))
        facings.pop_back();
    std::vector<Cloud> out;
    const auto turn = [](const Facing& facing, Cloud& turned) {
        for (const std::size_t i : facing.members) turned.towards[i] = -turned.towards[i];
    };
    for (std::size_t a = 0; a < facings.size(); ++a)
        for (std::size_t b = a; b < facings.size(); ++b) {
            out.push_back(seen);
            turn(facings[a], out.back());
            if (b != a) turn(facings[b], out.back());
        }
    for (Eigen::Vector3f& side : seen.towards) side = -side;
    out.push_back(std::move(seen));
    return out;
}

namespace {

struct Votes {
    std::size_t best = 0, rival = 0;
};
bool clear(std::size_t mine, std::size_t others, double least_share, std::size_t points) {
    const auto least =
        std::max(kLeastPoints, static_cast<std::size_t>(least_share * static_cast<double>(points)));
    return mine >= least + kAgainstRival * others;
}

}  // namespace

FitRival compare_of_sheet(const Cloud& points, const Surface& surface, const Pose& best, const Pose& rival,
                          double form_mm, bool& rival_is_better) {
    const double most = corner_distance_mm(surface, best, rival) + 2 * form_mm;
    const Pose best_inverse = best.inverse(), rival_inverse = rival.inverse();
    Votes ends, faces;
    for (const Eigen::Vector3d& p : points.points) {
        const Eigen::Vector3d in_best = best_inverse * p, in_rival = rival_inverse * p;
        const auto a = surface.nearest(in_best, most), b = surface.nearest(in_rival, most);
        if (!a || !b || std::abs(a->distance_mm - b->distance_mm) <= form_mm) continue;
        const bool for_best = a->distance_mm < b->distance_mm;
        const SurfacePoint &on = for_best ? *a : *b, &off = for_best ? *b : *a;
        if (on.distance_mm > form_mm) continue;
        const Eigen::Vector3d miss =
            for_best ? rival.linear() * (in_rival - off.point) : best.linear() * (in_best - off.point);
        const Eigen::Vector3d normal = (for_best ? best : rival).linear() * on.normal;
        Votes& kind = std::abs(miss.dot(normal)) < kSideways * off.distance_mm ? ends : faces;
        ++(for_best ? kind.best : kind.rival);
    }
    const auto speak_for = [&](std::size_t Votes::*one, std::size_t Votes::*other) {
        return clear(ends.*one, ends.*other, kLeastShareEnds, points.size()) ||
               clear(faces.*one, faces.*other, kLeastShareFace, points.size());
    };
    const bool for_best = speak_for(&Votes::best, &Votes::rival),
               for_rival = speak_for(&Votes::rival, &Votes::best);
    FitRival r;
    r.base_from_part = rival;
    r.for_best = ends.best + faces.best;
    r.for_rival = ends.rival + faces.rival;
    r.told_apart = for_best && !for_rival;
    rival_is_better = for_rival && !for_best;
    return r;
}

FitRival compare(const Cloud& judges, const Surface& surface, const Pose& best, const Pose& rival,
                 double form_mm, double most_mm, double least_share, bool facing, bool* rival_is_better) {
    FitRival r;
    r.base_from_part = rival;
    const std::vector<double> a = distances(judges, surface, best, most_mm, facing),
                              b = distances(judges, surface, rival, most_mm, facing);
    for (std::size_t i = 0; i < a.size(); ++i) {
        r.for_best += b[i] > a[i] + form_mm;
        r.for_rival += a[i] > b[i] + form_mm;
    }
    r.told_apart = clear(r.for_best, r.for_rival, least_share, a.size());
    if (rival_is_better) *rival_is_better = clear(r.for_rival, r.for_best, least_share, a.size());
    return r;
}

}  // namespace seamwright::fitting
