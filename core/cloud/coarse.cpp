#include "core/cloud/coarse.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "core/cloud/alike_object.h"
#include "core/cloud/refine.h"
#include "core/geometry/decompositions.h"
#include "core/loaded_object.h"

namespace seamwright {
namespace {

// Of a triple's sides: the share of the scan's size below which they are not used; what two may differ by, in spacings
// or of their length.
constexpr double kLeastSide = 0.15, kSideSpacings = 1.5, kSideShare = 0.03;
constexpr double kOnLine = 1e-4;  // of variances: a triangle whose height is 1 % of its longest side
constexpr std::size_t kPartPoints = 3000;
constexpr double kLeastSpacing = 1e-3;                     // of the scan's size
constexpr double kSameTurn_rad = 0.15, kSamePlace = 0.08;  // of the scan's size: two poses that are one start

struct Scored {
    Pose pose;
    double share = 0;
};

double near_share(const Cloud& probe, const Surface& surface, const Pose& pose, double near_mm) {
    double sum = 0;
    for (const double d : distances(probe, surface, pose, near_mm, false)) {
        const double in = 1 - d * d / (near_mm * near_mm);
        sum += in > 0 ? in : 0;
    }
    return sum / static_cast<double>(std::max<std::size_t>(1, probe.size()));
}

// Attitudes that put the principal axes of the one on those of the other, middles together.
std::vector<Pose> axis_poses(const Cloud& scan, const Cloud& part) {
    const auto axes = [](const Cloud& c, Eigen::Vector3d& middle) {
        middle.setZero();
        for (const auto& p : c.points) middle += p;
        middle /= static_cast<double>(c.size());
        Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
        for (const auto& p : c.points) spread += (p - middle) * (p - middle).transpose();
        Eigen::Matrix3d v = symmetric_eigen(spread).vectors;
        if (v.determinant() < 0) v.col(0) = -v.col(0);
        return v;
    };
    Eigen::Vector3d scan_middle, part_middle;
    const Eigen::Matrix3d a = axes(scan, scan_middle), b = axes(part, part_middle);
    std::vector<Pose> out;
    for (int permutation = 0; permutation < 6; ++permutation)
        for (int signs = 0; signs < 8; ++signs) {
            static constexpr int kOrder[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1},
                                                 {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
            Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
            for (int k = 0; k < 3; ++k) m(kOrder[permutation][k], k) = (signs >> k & 1) != 0 ? -1 : 1;
            if (m.determinant() < 0) continue;
            const Eigen::Matrix3d turn = a * m * b.transpose();
            out.push_back(make_pose(turn, scan_middle - turn * part_middle));
        }
    return out;
}

// Poses of triples that look alike and are as far apart.
Expected<std::vector<Scored>> consensus(const Cloud& scan, const Cloud& part, const Surface& surface,
                                        const Cloud& probe, double spacing, const CoarseOptions& options) {
    constexpr int kMostAlike = 8;
    SEAM_TRY(const auto find_alike, loaded_function<decltype(seamwright_alike)>(kAlike, "seamwright_alike"));
    std::vector<std::vector<int>> alike;
    find_alike(scan, part, 5 * spacing, kMostAlike, alike);
    std::vector<Scored> found;
    if (alike.empty()) return found;
    std::mt19937_64 random(options.seed);
    std::uniform_int_distribution<std::size_t> any(0, scan.size() - 1);
    const double size = scan.box().diagonal().norm(), least = kLeastSide * size;
    for (int trial = 0, tested = 0; trial < 60 * options.trials && tested < options.trials; ++trial) {
        std::size_t at[3];
        Eigen::Vector3d p[3], q[3];
        bool usable = true;
        for (int k = 0; k < 3 && usable; ++k) {
            at[k] = any(random);
            usable = !alike[at[k]].empty();
            if (!usable) break;
            p[k] = scan.points[at[k]];
            const auto j = static_cast<std::size_t>(alike[at[k]][random() % alike[at[k]].size()]);
            q[k] = part.points[j];
            for (int o = 0; o < k && usable; ++o) {
                const double a = (p[k] - p[o]).norm(), b = (q[k] - q[o]).norm();
                usable = a > least && std::abs(a - b) < std::max(kSideSpacings * spacing, kSideShare * a);
            }
        }
        if (!usable) continue;
        const auto pose = pose_of_pairs({q[0], q[1], q[2]}, {p[0], p[1], p[2]});
        if (!pose) continue;
        ++tested;
        found.push_back({*pose, near_share(probe, surface, *pose, 2 * spacing)});
    }
    return found;
}

}  // namespace

Expected<Pose> pose_of_pairs(const std::vector<Eigen::Vector3d>& from,
                             const std::vector<Eigen::Vector3d>& to) {
    if (from.size() != to.size() || from.size() < 3)
        return input_error("a pose needs three pairs of points", {},
                           "pick three places of the part that lie far apart");
    const auto n = static_cast<double>(from.size());
    Eigen::Vector3d a = Eigen::Vector3d::Zero(), b = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < from.size(); ++i) a += from[i] / n, b += to[i] / n;
    Eigen::Matrix3d cross = Eigen::Matrix3d::Zero(), own = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < from.size(); ++i) {
        cross += (from[i] - a) * (to[i] - b).transpose();
        own += (from[i] - a) * (from[i] - a).transpose();
    }
    const SymmetricEigen e = symmetric_eigen(own);
    if (!own.allFinite() || !cross.allFinite() || !(e.values[1] > kOnLine * e.values[2]))
        return input_error("the picked points lie on a line", {},
                           "pick three places of the part that lie far apart");
    const SingularValues s = singular_values(cross);
    Eigen::Matrix3d flip = Eigen::Matrix3d::Identity();
    flip(2, 2) = (s.v * s.u.transpose()).determinant() < 0 ? -1 : 1;
    const Eigen::Matrix3d turn = s.v * flip * s.u.transpose();
    return make_pose(turn, b - turn * a);
}

Expected<std::vector<Pose>> coarse_poses(const Cloud& cloud, const Surface& surface,
                                         const CoarseOptions& options) {
    std::vector<Pose> out;
    if (cloud.size() < 20 || surface.empty()) return out;
    const double size = cloud.box().diagonal().norm();
    const Cloud part = surface.sampled(kPartPoints, options.seed);
    Cloud scan = thinned(cloud, 1500);
    const double spacing =
        std::max(std::sqrt(surface.area_mm2() / static_cast<double>(kPartPoints)), kLeastSpacing * size);
    const Cloud probe = thinned(cloud, 120);
    std::vector<Scored> found;
    // Where no sensor says which side is out, both are tried.
    for (int side = 0; side < (cloud.has_towards() ? 1 : 2); ++side) {
        if (side == 1)
            for (auto& n : scan.normals) n = -n;
        SEAM_TRY(const auto alike, consensus(scan, part, surface, probe, spacing, options));
        found.insert(found.end(), alike.begin(), alike.end());
    }
    for (const Pose& p : axis_poses(scan, part)) found.push_back({p, 1});  // always looked at: they are few
    std::stable_sort(found.begin(), found.end(),
                     [](const Scored& a, const Scored& b) { return a.share > b.share; });
    const std::size_t most = options.most + 24;
    for (const Scored& s : found) {
        if (out.size() >= most) break;
        const bool near = std::any_of(out.begin(), out.end(), [&](const Pose& o) {
            return angle_rad(o, s.pose) < kSameTurn_rad &&
                   (o * surface.box().center() - s.pose * surface.box().center()).norm() < kSamePlace * size;
        });
        if (!near) out.push_back(s.pose);
    }
    return out;
}

}  // namespace seamwright
