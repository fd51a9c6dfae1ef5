#include "core/calibration/bundle/stereo.h"

#include <algorithm>
#include <cmath>

#include "core/calibration/bundle/bundle_limits.h"
#include "core/calibration/numbers.h"
#include "core/calibration/pose_set.h"
#include "core/calibration/statistics.h"
#include "core/geometry/decompositions.h"
#include "core/median.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

constexpr double kGoodPoint_mm = 0.2, kUsablePoint_mm = 1.0;  // three sigma of the worst point
constexpr double kNarrow_deg = 5;
constexpr double kStatedFreedom = 1000;  // stands for endless: of a noise that is stated
// A pattern of the gaps is told beyond this many times the squares that the places allow, and beyond this.
constexpr double kAllowedTimes = 9, kSmallestPattern_px = 0.1;
constexpr double kNoSlope = 1e-12;              // guards the scale of a number that moves no gap
constexpr double kSmallestKnownMiss_mm = 0.05;  // of a known point: less contradicts nothing
constexpr double kThreeNumbers = 6;             // of chi squared: what three numbers may show beyond one
constexpr double kRounding_mm = 1e-6;           // cameras that are nearer were given the same place
constexpr double kSamePlace_mm = 1;             // cameras that stand nearer stand in one place
constexpr double kParallelSine2 = 1e-12;
constexpr int kManyGaps = 8;
constexpr int kPlaceNumbers = 5;  // of a relative place that the gaps can show: all but the distance

using Row = Eigen::Matrix<double, 1, 12>;

// A point's numbers and how pixels (4) and places (first, then second camera) move them.
struct Meeting {
    RayMeeting at;
    Eigen::Matrix<double, 3, 4> point_by_pixel;
    Eigen::Matrix<double, 3, 12> point_by_place;
    Row gap_by_place;
    double gap_per_px = 0;  // sigma of the gap for a pixel of noise in all four coordinates
};

std::optional<Meeting> meeting_of(const PlacedCamera& first, const PlacedCamera& second,
                                  const StereoSight& s) {
    const auto at = meet_rays(first, s.first_px, second, s.second_px);
    if (!at) return std::nullopt;
    Meeting m;
    m.at = *at;
    double variance = 0;
    for (int k = 0; k < 4; ++k) {
        constexpr double kStep = 1e-2;
        StereoSight high = s, low = s;
        (k < 2 ? high.first_px : high.second_px)(k % 2) += kStep;
        (k < 2 ? low.first_px : low.second_px)(k % 2) -= kStep;
        const auto a = meet_rays(first, high.first_px, second, high.second_px);
        const auto b = meet_rays(first, low.first_px, second, low.second_px);
        if (!a || !b) return std::nullopt;
        m.point_by_pixel.col(k) = (a->world_mm - b->world_mm) / (2 * kStep);
        variance += std::pow((a->gap_mm - b->gap_mm) / (2 * kStep), 2);
    }
    m.gap_per_px = std::sqrt(variance);
    for (int k = 0; k < 12; ++k) {
        Vector6 step = Vector6::Zero();
        step(k % 6) = k % 6 < 3 ? kPoseStep_mm : kPoseStep_rad;
        PlacedCamera high = k < 6 ? first : second, low = high;
        high.world_from_camera.pose = retract(high.world_from_camera.pose, step);
        low.world_from_camera.pose = retract(low.world_from_camera.pose, -step);
        const auto a = meet_rays(k < 6 ? high : first, s.first_px, k < 6 ? second : high, s.second_px);
        const auto b = meet_rays(k < 6 ? low : first, s.first_px, k < 6 ? second : low, s.second_px);
        if (!a || !b) return std::nullopt;
        m.point_by_place.col(k) = (a->world_mm - b->world_mm) / (2 * step(k % 6));
        m.gap_by_place(k) = (a->gap_mm - b->gap_mm) / (2 * step(k % 6));
    }
    return m.gap_per_px > 0 ? std::optional(m) : std::nullopt;
}

using Meetings = std::vector<std::optional<Meeting>>;

Eigen::Matrix<double, 12, 12> places_of(const PlacedCamera& first, const PlacedCamera& second) {
    Eigen::Matrix<double, 12, 12> c = Eigen::Matrix<double, 12, 12>::Zero();
    c.topLeftCorner<6, 6>() = first.world_from_camera.covariance;
    c.bottomRightCorner<6, 6>() = second.world_from_camera.covariance;
    return c;
}

double of_places_px2(const Meeting& m, const Eigen::Matrix<double, 12, 12>& places) {
    return (m.gap_by_place * places * m.gap_by_place.transpose())(0) / (m.gap_per_px * m.gap_per_px);
}
double gap_px(const Meeting& m) {
    return m.at.gap_mm / m.gap_per_px;
}

// What the gaps say of the noise; of no points the noise nobody stated.
double noise_of(const Meetings& list, const std::vector<char>& use,
                const Eigen::Matrix<double, 12, 12>& places) {
    double squares = 0, of_places = 0;
    int n = 0;
    for (std::size_t i = 0; i < list.size(); ++i)
        if (use[i]) {
            squares += std::pow(gap_px(*list[i]), 2);
            of_places += of_places_px2(*list[i], places);
            ++n;
        }
    return n == 0 ? kUnknownNoise_px
                  : std::sqrt(std::max(squares - of_places, kLeastNoiseShare * squares) / n);
}

// The noise by the median of the gaps.
double middle_gap_px(const Meetings& list, const std::vector<char>& use) {
    std::vector<double> gaps;
    for (std::size_t i = 0; i < list.size(); ++i)
        if (use[i]) gaps.push_back(std::abs(gap_px(*list[i])));
    return kMadToSigma * median(gaps);
}

// Two points of the scene taken for one: the largest gap against the rest.
void drop_wrong(const Meetings& list, std::vector<char>& use, const Eigen::Matrix<double, 12, 12>& places,
                const std::optional<double>& stated, std::vector<PoseResidual>& rows) {
    for (;;) {
        std::size_t suspect = use.size();
        double largest = 0;
        for (std::size_t i = 0; i < use.size(); ++i)
            if (use[i] && std::abs(gap_px(*list[i])) > largest) {
                largest = std::abs(gap_px(*list[i]));
                suspect = i;
            }
        const auto others = static_cast<double>(std::count(use.begin(), use.end(), 1)) - 1;
        if (suspect == use.size() || (!stated && others < 4) || largest < kSmallestWrong_px) return;
        std::vector<char> rest = use;
        rest[suspect] = 0;
        // Of many the middle one tells the noise, which two wrong ones do not hide behind.
        const double noise = stated               ? *stated
                             : others < kManyGaps ? noise_of(list, rest, places)
                                                  : middle_gap_px(list, rest);
        const double chance = noise * noise + of_places_px2(*list[suspect], places);
        if (largest * largest / chance < outlier_limit(stated ? kStatedFreedom : others)) return;
        use = rest;
        rows[suspect].used = false;
        rows[suspect].contradicts = true;
        rows[suspect].note = Text("its rays pass each other by {:.2f} mm: two different points",
                                  std::abs(list[suspect]->at.gap_mm));
    }
}

// Whether the gaps follow the pattern of a camera that stands elsewhere (F test); the pattern's rms in px, else 0.
double pattern_px(const Meetings& list, const std::vector<char>& use,
                  const Eigen::Matrix<double, 12, 12>& places) {
    const auto n = static_cast<Eigen::Index>(std::count(use.begin(), use.end(), 1));
    if (n < kPlaceNumbers + 5) return 0;
    Eigen::MatrixXd a(n, 6);
    Eigen::VectorXd b(n);
    double allowed = 0;
    Eigen::Index row = 0;
    for (std::size_t i = 0; i < list.size(); ++i) {
        if (!use[i]) continue;
        a.row(row) = list[i]->gap_by_place.tail<6>() / list[i]->gap_per_px;
        b(row++) = gap_px(*list[i]);
        allowed += of_places_px2(*list[i], places);
    }
    // Millimetre and radian on one scale.
    const Eigen::VectorXd scale = a.colwise().norm().transpose().cwiseMax(kNoSlope);
    const SingularValues s = singular_values(a * scale.cwiseInverse().asDiagonal());
    const Eigen::VectorXd along = s.u.leftCols(kPlaceNumbers).transpose() * b;
    const double explained = along.squaredNorm(), rest = b.squaredNorm() - explained;
    const auto freedom = static_cast<double>(n - kPlaceNumbers);
    if (explained / kPlaceNumbers < (rest / freedom) * (1 + outlier_limit(freedom) / 3)) return 0;
    if (explained < kAllowedTimes * allowed) return 0;
    const double pattern = std::sqrt(explained / static_cast<double>(n));
    return pattern > kSmallestPattern_px ? pattern : 0;
}

struct KnownPoints {
    double squares_mm2 = 0, max_mm = 0;
    double chi_squared = 0;  // of the one that is missed most beyond chance
    std::string worst;
};

Judgement judged(const StereoResult& r, const KnownPoints& known, double pattern, int used) {
    const Text fit("{} points, noise {:.2f} px, three sigma of the worst point {:.3f} mm", used, r.sigma_px,
                   3 * r.worst_mm);
    // Three numbers, picked as the largest of all.
    if (r.known > 0 && known.chi_squared > outlier_limit(kStatedFreedom) + kThreeNumbers &&
        known.max_mm > kSmallestKnownMiss_mm)
        return {Verdict::poor,
                Text("point '{}' lies {:.2f} mm from where it is known to be", known.worst, known.max_mm),
                "check the places of the cameras, their lenses and the known points"};
    if (pattern > 0)
        return {Verdict::poor,
                Text("the rays pass each other by {:.2f} px as if a camera stood elsewhere", pattern),
                "find the places of both cameras again, with one target"};
    if (3 * r.worst_mm > kUsablePoint_mm || r.sigma_px > kUsableNoise_px)
        return {Verdict::poor, fit,
                r.smallest_deg < kNarrow_deg
                    ? Text("place the cameras farther apart: two rays meet at {:.1f} degrees", r.smallest_deg)
                    : Text("find the features better, or the cameras' places")};
    if (r.known == 0)
        return {Verdict::usable, Text("no known point confirms the scale; {}", fit),
                "give the world coordinates of one point or more"};
    if (3 * r.worst_mm > kGoodPoint_mm || r.sigma_px > kGoodNoise_px)
        return {Verdict::usable, fit,
                "place the cameras nearer or farther apart, or find the features better"};
    return {Verdict::good, fit, ""};
}

Expected<void> check(const PlacedCamera& first, const PlacedCamera& second,
                     const std::vector<StereoSight>& sights, const StereoOptions& options) {
    SEAM_OK(check_cameras({first, second}));
    const std::vector<Pose> places{first.world_from_camera.pose, second.world_from_camera.pose};
    const bool apart = (places[0].translation() - places[1].translation()).norm() > kRounding_mm;
    if (distance_mm(places[0], places[1]) < kSamePlace_mm && apart)
        SEAM_OK(check_millimetres(places, "cameras"));
    if (distance_mm(places[0], places[1]) < kSamePlace_mm)
        return input_error("both cameras stand in the same place", "cameras",
                           "say where each stands in the world");
    if (sights.empty()) return input_error("there are no points", "points", "give one or more");
    std::vector<std::string> ids;
    for (const StereoSight& s : sights) {
        const Text where("point '{}'", s.id);
        SEAM_OK(check_pixel(first, s.first_px, where));
        SEAM_OK(check_pixel(second, s.second_px, where));
        if (s.known_mm && (!s.known_mm->allFinite() || s.known_mm->cwiseAbs().maxCoeff() > kFarthestPoint_mm))
            return input_error("its place in the world is not finite or beyond 1 km", where,
                               "give millimetres");
        ids.push_back(s.id);
    }
    SEAM_OK(check_ids(ids, options.exclude, "points"));
    if (options.sigma_px && !(std::isfinite(*options.sigma_px) && *options.sigma_px > 0))
        return input_error("sigma_px is not a positive number", "sigma_px");
    return {};
}

}  // namespace

std::optional<RayMeeting> meet_rays(const PlacedCamera& first, const Eigen::Vector2d& first_pixel,
                                    const PlacedCamera& second, const Eigen::Vector2d& second_pixel) {
    const Pose &a = first.world_from_camera.pose, &b = second.world_from_camera.pose;
    const Eigen::Vector3d u = (a.linear() * first.camera.undistort(first_pixel).homogeneous()).normalized();
    const Eigen::Vector3d v = (b.linear() * second.camera.undistort(second_pixel).homogeneous()).normalized();
    if (!u.allFinite() || !v.allFinite()) return std::nullopt;
    // a + s u and b + t v where the connection is perpendicular to both.
    const Eigen::Vector3d w = b.translation() - a.translation();
    const double c = u.dot(v), sine2 = 1 - c * c;
    if (sine2 < kParallelSine2) return std::nullopt;
    const double s = (w.dot(u) - c * w.dot(v)) / sine2, t = (c * w.dot(u) - w.dot(v)) / sine2;
    if (!(s > 0) || !(t > 0)) return std::nullopt;
    const Eigen::Vector3d p = a.translation() + s * u, q = b.translation() + t * v;
    return RayMeeting{0.5 * (p + q), (q - p).dot(u.cross(v)) / std::sqrt(sine2),
                      std::acos(std::clamp(c, -1.0, 1.0))};
}

Expected<StereoResult> intersect(const PlacedCamera& first, const PlacedCamera& second,
                                 const std::vector<StereoSight>& sights, const StereoOptions& options) {
    SEAM_OK(check(first, second, sights, options));
    StereoResult r;
    r.baseline_mm = distance_mm(first.world_from_camera.pose, second.world_from_camera.pose);
    const auto places = places_of(first, second);
    Meetings list;
    std::vector<char> use;
    auto& rows = r.report.poses;
    rows.resize(sights.size());
    for (std::size_t i = 0; i < sights.size(); ++i) {
        list.push_back(meeting_of(first, second, sights[i]));
        rows[i].id = sights[i].id;
        rows[i].excluded =
            std::find(options.exclude.begin(), options.exclude.end(), sights[i].id) != options.exclude.end();
        use.push_back(list[i] && !rows[i].excluded ? 1 : 0);
        rows[i].used = use[i] != 0;
        if (rows[i].excluded)
            rows[i].note = "excluded by the user";
        else if (!list[i])
            rows[i].note = "its rays do not meet before both cameras";
    }
    drop_wrong(list, use, places, options.sigma_px, rows);
    const auto used = static_cast<int>(std::count(use.begin(), use.end(), 1));
    r.points.resize(sights.size());
    for (std::size_t i = 0; i < sights.size(); ++i) r.points[i].id = sights[i].id;
    if (used == 0) {
        r.report.judgement = {Verdict::undetermined, "no two rays meet before both cameras",
                              "check which pixel belongs to which camera, and where the cameras stand"};
        return r;
    }
    double student = 1;
    if (options.sigma_px) {
        r.sigma_px = *options.sigma_px;
    } else if (used < 3) {
        r.sigma_px = kUnknownNoise_px;
    } else {
        r.sigma_px = noise_of(list, use, places);
        student = student_quantile(kUpper95, used) / normal_quantile(kUpper95);
    }
    const double variance_px2 = std::pow(student * r.sigma_px, 2);
    double gaps = 0;
    KnownPoints known;
    r.smallest_deg = 180;
    for (std::size_t i = 0; i < sights.size(); ++i) {
        if (!list[i]) continue;
        const Meeting& m = *list[i];
        StereoPoint& p = r.points[i];
        p.met = true;
        p.world_mm = m.at.world_mm;
        p.covariance = variance_px2 * m.point_by_pixel * m.point_by_pixel.transpose() +
                       m.point_by_place * places * m.point_by_place.transpose();
        p.gap_mm = std::abs(m.at.gap_mm);
        p.gap_px = std::abs(gap_px(m));
        p.angle_deg = deg_from_rad(m.at.angle_rad);
        rows[i].rms_px = p.gap_px;
        rows[i].rms_mm = p.gap_mm;
        if (sights[i].known_mm) p.off_mm = (p.world_mm - *sights[i].known_mm).norm();
        if (!use[i]) continue;
        gaps += p.gap_mm * p.gap_mm;
        r.worst_mm = std::max(r.worst_mm, worst_sigma(p.covariance));
        r.smallest_deg = std::min(r.smallest_deg, p.angle_deg);
        if (!p.off_mm) continue;
        ++r.known;
        known.squares_mm2 += *p.off_mm * *p.off_mm;
        const Eigen::Vector3d off = p.world_mm - *sights[i].known_mm;
        const double chi = off.dot(solve_symmetric(p.covariance, off).col(0));
        if (chi > known.chi_squared) {
            known.chi_squared = chi;
            known.worst = sights[i].id;
            known.max_mm = *p.off_mm;
        }
        auto& held = r.report.hold_out;
        held.max_mm = std::isnan(held.max_mm) ? *p.off_mm : std::max(held.max_mm, *p.off_mm);
    }
    r.gap_rms_mm = std::sqrt(gaps / used);
    if (r.known > 0) {
        r.report.hold_out.folds = r.known;
        r.report.hold_out.left_out = 1;
        r.report.hold_out.rms_mm = std::sqrt(known.squares_mm2 / r.known);
    }
    r.report.judgement = judged(r, known, pattern_px(list, use, places), used);
    return r;
}

}  // namespace seamwright
