#include "core/calibration/lens/lens.h"

#include <ceres/autodiff_cost_function.h>
#include <ceres/normal_prior.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/calibration/camera/camera.h"
#include "core/calibration/camera/camera_limits.h"
#include "core/calibration/camera/projection.h"
#include "core/calibration/lens/bent_line.h"
#include "core/calibration/lens/line_noise.h"
#include "core/calibration/problem.h"
#include "core/geometry/decompositions.h"
#include "core/median.h"
#include "core/numbers.h"

namespace seamwright {
namespace lens_lines {
namespace {

constexpr double kFarSigmas = 5;    // a point farther from its line is left out ..
constexpr double kNearPx = 0.05;    // .. unless it is this near
constexpr double kLineShare = 0.6;  // of its points that a line must keep
constexpr double kBentTimes = 4;    // rms of a line over the middling line's, beyond which it is no line ..
constexpr double kBentPx = 0.1;     // .. unless it is this small
constexpr int kCleaningRounds = 8;
constexpr double kRestShare =
    1e-4;  // of the cost that a further step may still promise: a hundredth of a sigma
constexpr double kRest_px2 = 1e-18;           // .. or this much, where lines are exact
constexpr double kLeastVariance_px2 = 1e-12;  // of exact lines
constexpr double kVarianceSettled = 1e-3;     // relative change that ends the outer rounds
constexpr double kCostSettled = 1e-8;         // relative gain that ends a solution

template <class T>
using Plane2 = Eigen::Matrix<T, 2, 1>;

template <class T>
struct Spread {
    T most = T(0);           // larger eigenvalue of the centred covariance
    Plane2<T> mean, normal;  // of the line
};

// Of the points by their weights; those without one take no part.
template <class T, class Point, class Weight>
Spread<T> spread_of(const std::vector<Point>& points, const std::vector<Weight>& weight) {
    using std::atan2, std::cos, std::sin, std::sqrt;
    Spread<T> s;
    s.mean.setZero();
    T n = T(0);
    for (std::size_t i = 0; i < points.size(); ++i)
        if (weight[i] > Weight(0)) s.mean += points[i] * T(weight[i]), n += T(weight[i]);
    s.mean /= n;
    T xx = T(0), xy = T(0), yy = T(0);
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!(weight[i] > Weight(0))) continue;
        const Plane2<T> d = points[i] - s.mean;
        const T w = T(weight[i]);
        xx += w * d.x() * d.x(), xy += w * d.x() * d.y(), yy += w * d.y() * d.y();
    }
    const T half_gap = (xx - yy) * 0.5;
    s.most = ((xx + yy) * 0.5 + sqrt(half_gap * half_gap + xy * xy)) / n;
    const T angle = atan2(xy * 2.0, xx - yy) * 0.5;
    s.normal = {-sin(angle), cos(angle)};
    return s;
}

// One char a point: whether it is taken to lie on its line.
using Support = std::vector<std::vector<char>>;

// Signed distances of all points of a line, in px of the image, from the line fitted to its support: the
// distance in the undistorted plane over how far a pixel across the line reaches there. False where the lens
// cannot be undone.
template <class T>
bool distances(const std::vector<Eigen::Vector2d>& points, const std::vector<char>& on,
               const CameraModel& lens, const T* k, std::vector<T>& out) {
    using std::isfinite;
    const Eigen::Vector2d nowhere = Eigen::Vector2d::Constant(std::nan(""));
    const Intrinsics at = intrinsics_of(lens);
    std::vector<Plane2<T>> straight(points.size(), nowhere.cast<T>());
    std::vector<Eigen::Matrix<T, 2, 2>> across(points.size(), Eigen::Matrix<T, 2, 2>::Identity());
    std::vector<T> weight;
    for (const char taken : on) weight.push_back(T(taken));
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Eigen::Vector2d ray = lens.undistort(points[i]);
        if (!ray.allFinite()) {
            if (on[i]) return false;
            continue;
        }
        // One Newton step from the ray found carries the derivatives.
        const Eigen::Matrix2d back = pixel_by_ray(at.data(), ray.x(), ray.y()).inverse();
        const Plane2<T> off = pixel_of_ray(k, T(ray.x()), T(ray.y())) - points[i];
        straight[i] = {ray.x() - off.x() * back(0, 0) - off.y() * back(0, 1),
                       ray.y() - off.x() * back(1, 0) - off.y() * back(1, 1)};
        const Eigen::Matrix<T, 2, 2> j = pixel_by_ray(k, straight[i].x(), straight[i].y());
        const T determinant = j(0, 0) * j(1, 1) - j(0, 1) * j(1, 0);
        across[i] << j(1, 1), -j(1, 0), -j(0, 1), j(0, 0);  // inverse, transposed
        across[i] /= determinant;
    }
    Spread<T> s = spread_of<T>(straight, weight);
    for (std::size_t i = 0; i < points.size(); ++i)
        if (on[i]) weight[i] = T(1.0) / (across[i] * s.normal).squaredNorm();
    s = spread_of<T>(straight, weight);
    if (!(s.most > T(0.0)) || !isfinite(s.most)) return false;
    const Eigen::Vector2d side = spread_of<double>(points, on).normal;  // one for all, or derivatives jump
    if (s.normal.x() * side.x() + s.normal.y() * side.y() < T(0.0)) s.normal = -s.normal;
    out.clear();
    for (std::size_t i = 0; i < points.size(); ++i) {
        const T reach = (across[i] * s.normal).norm();
        out.push_back(s.normal.dot(straight[i] - s.mean) / reach);
    }
    return true;
}

CameraModel lens_of(const double* k, const LensData& data) {
    return camera_of(Eigen::Map<const Intrinsics>(k), data.width, data.height);
}
template <class Jet>
CameraModel lens_of(const Jet* k, const LensData& data) {
    Intrinsics at;
    for (Eigen::Index i = 0; i < 9; ++i) at(i) = k[i].a;
    return camera_of(at, data.width, data.height);
}

// Of the points on one line, by the intrinsics.
struct Straightness {
    const LensData& data;
    const std::vector<Eigen::Vector2d>& points;
    const std::vector<char>& on;
    template <class T>
    bool operator()(const T* k, T* residual) const {
        using std::isfinite;
        std::vector<T> off;
        if (!distances(points, on, lens_of(k, data), k, off)) return false;
        for (std::size_t i = 0; i < off.size(); ++i) {
            if (!on[i]) continue;
            if (!isfinite(off[i])) return false;
            *residual++ = off[i];
        }
        return true;
    }
};

// What the solver sees of the lines: those used, and of these the points on them.
class Lines {
  public:
    explicit Lines(const LensData& data) : used(data.lines.size(), 1), data_(data) {
        for (const auto& line : data.lines) on.emplace_back(line.size(), 1);
    }
    int points(std::size_t line) const {
        return static_cast<int>(std::count(on[line].begin(), on[line].end(), 1));
    }
    double points() const {
        int n = 0;
        for (std::size_t i = 0; i < on.size(); ++i) n += used[i] ? points(i) : 0;
        return n;
    }
    int count() const { return static_cast<int>(std::count(used.begin(), used.end(), 1)); }
    void add_to(ceres::Problem& problem, double* k) const {
        for (std::size_t i = 0; i < on.size(); ++i)
            if (used[i])
                problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Straightness, ceres::DYNAMIC, 9>(
                                             new Straightness{data_, data_.lines[i], on[i]}, points(i)),
                                         nullptr, k);
    }
    // Distances of all points of a line, used or not; empty where the lens cannot be undone.
    std::vector<double> all_distances(std::size_t line, const Intrinsics& k) const {
        std::vector<double> out;
        if (!distances(data_.lines[line], on[line], lens_of(k.data(), data_), k.data(), out)) out.clear();
        return out;
    }
    // Of the points on the lines used, px^2; infinity where the lens cannot be undone.
    double squares(const Intrinsics& k) const {
        double sum = 0;
        for (std::size_t i = 0; i < on.size(); ++i) {
            if (!used[i]) continue;
            const std::vector<double> off = all_distances(i, k);
            if (off.empty()) return kInfinity;
            for (std::size_t j = 0; j < off.size(); ++j)
                if (on[i][j]) sum += off[j] * off[j];
        }
        return sum;
    }

    std::vector<char> used;
    Support on;

  private:
    const LensData& data_;
};

struct Solution {
    Intrinsics k;
    double squares = 0;  // px^2
    Eigen::MatrixXd information;
    double variance = 0;
    bool converged = false;
};

// From k. The prior that holds the centre weighs by the noise estimate: a few outer rounds.
Solution solve_lens(const Lines& lines, const Intrinsics& k, const std::vector<int>& free,
                    const Eigen::Vector2d& middle, double hold_px) {
    Solution s;
    s.k = k;
    s.squares = lines.squares(k);
    if (!std::isfinite(s.squares)) return s;
    const auto n = static_cast<Eigen::Index>(free.size());
    Eigen::MatrixXd moves = Eigen::MatrixXd::Zero(9, n), centre = Eigen::MatrixXd::Zero(2, 9);
    for (Eigen::Index j = 0; j < n; ++j) moves(free[static_cast<std::size_t>(j)], j) = 1;
    centre(0, 2) = centre(1, 3) = 1;
    Eigen::VectorXd held = Eigen::VectorXd::Zero(9);
    held.segment<2>(2) = middle;
    const double freedom = std::max(1.0, lines.points() - 2.0 * lines.count() - static_cast<double>(n));
    s.variance = std::max(s.squares / lines.points(), kLeastVariance_px2);
    for (int outer = 0; outer < 4; ++outer) {
        ceres::Problem problem;
        problem.AddParameterBlock(s.k.data(), 9, linear_manifold(moves));
        lines.add_to(problem, s.k.data());
        problem.AddResidualBlock(new ceres::NormalPrior(std::sqrt(s.variance) / hold_px * centre, held),
                                 nullptr, s.k.data());
        const Solved solved = solve(problem, {}, 60, kCostSettled);
        Eigen::VectorXd residuals;
        Eigen::MatrixXd jacobian;
        s.converged = solved.converged && linearise(problem, {s.k.data()}, residuals, jacobian);
        if (!s.converged) break;
        s.information = jacobian.transpose() * jacobian;
        // Steps that end at the lens' fold, where it can no longer be undone, shrink to nothing too.
        const Eigen::VectorXd gradient = jacobian.transpose() * residuals;
        s.converged = gradient.dot(solve_symmetric(s.information, gradient).col(0)) <=
                      kRestShare * solved.cost + kRest_px2;
        const double before = s.variance;
        s.squares = lines.squares(s.k);
        s.variance = std::max(s.squares / freedom, kLeastVariance_px2);
        if (!s.converged || std::abs(s.variance - before) < kVarianceSettled * before) break;
    }
    return s;
}

// Judges every point anew by the lens found so far, and leaves out the worst line that is none. Whether
// anything has changed.
bool clean(const LensData& data, const Intrinsics& k, Lines& lines, std::vector<PoseResidual>& poses) {
    std::vector<std::vector<double>> off(data.lines.size());
    std::vector<double> all, rms(data.lines.size(), 0), rms_used;
    for (std::size_t i = 0; i < data.lines.size(); ++i) {
        if (!lines.used[i]) continue;
        off[i] = lines.all_distances(i, k);
        double sum = 0, n = 0;
        for (std::size_t j = 0; j < off[i].size(); ++j)
            if (lines.on[i][j]) all.push_back(std::abs(off[i][j])), sum += off[i][j] * off[i][j], n += 1;
        rms[i] = std::sqrt(sum / std::max(n, 1.0));
        rms_used.push_back(rms[i]);
    }
    const int fewest = std::max(3, (2 * static_cast<int>(data.lines.size()) + 2) / 3);
    const double bent = std::max(kBentPx, kBentTimes * median(rms_used));
    const auto worst = static_cast<std::size_t>(std::max_element(rms.begin(), rms.end()) - rms.begin());
    if (lines.count() > fewest && rms[worst] > bent) {
        lines.used[worst] = 0;
        poses[worst].note = Text("left out: it stays bent by {:.2f} px, the others by {:.2f} px", rms[worst],
                                 median(rms_used));
        return true;
    }
    const double far = std::max(kNearPx, kFarSigmas * kMadToSigma * median(all));
    bool changed = false;
    for (std::size_t i = 0; i < data.lines.size(); ++i) {
        if (!lines.used[i]) continue;
        std::vector<char> on(off[i].size());
        for (std::size_t j = 0; j < on.size(); ++j) on[j] = std::abs(off[i][j]) <= far;
        if (std::count(on.begin(), on.end(), 1) < 5) continue;
        changed = changed || on != lines.on[i];
        lines.on[i] = std::move(on);
    }
    return changed;
}

// Corners of the image: how well their distortion must be known at all, and how well to be good.
constexpr double kCornerKnown_px = 3, kCornerGood_px = 0.5;
constexpr double kStraight_px = 2;  // lines that stay more bent than this belong to no lens of this model

// The lines as they are given, which of them count, and which of their points lie on them.
Expected<Lines> read_lines(const LensData& data, const LensOptions& options,
                           std::vector<PoseResidual>& poses) {
    std::vector<char> excluded(data.lines.size(), 0);
    for (const int e : options.exclude) {
        if (e < 0 || static_cast<std::size_t>(e) >= data.lines.size())
            return input_error(Text("there is no line {} to exclude", e), "exclude", "lines count from 0");
        excluded[static_cast<std::size_t>(e)] = 1;
    }
    Lines lines(data);
    for (std::size_t i = 0; i < data.lines.size(); ++i) {
        const std::string where = fmt::format("lines[{}]", i);
        const auto& line = data.lines[i];
        if (line.size() < 5)
            return input_error(Text("{} points are too few for a line", line.size()), where,
                               "give at least 5");
        for (const auto& p : line)
            if (!p.allFinite() || p.x() < -1 || p.y() < -1 || p.x() > data.width || p.y() > data.height)
                return input_error("a point is not finite or lies outside the image", where, "leave it out");
        if (!(spread_of<double>(line, lines.on[i]).most > 1))
            return input_error("all points of the line are the same", where, "leave it out");
        lines.on[i] = on_bent_line(line);
        PoseResidual p;
        p.id = std::to_string(i);
        lines.used[i] = !excluded[i];
        p.excluded = excluded[i];
        if (p.excluded) p.note = "excluded";
        poses.push_back(std::move(p));
    }
    if (lines.count() == 0)
        return input_error("there is no line", "lines", "give 5 or more lines over the whole image");
    for (std::size_t i = 0; i < data.lines.size(); ++i) {
        const auto on = std::count(lines.on[i].begin(), lines.on[i].end(), 1);
        if (!lines.used[i] || static_cast<double>(on) >= kLineShare * static_cast<double>(lines.on[i].size()))
            continue;
        lines.used[i] = 0;
        poses[i].note = Text("left out: only {} of its {} points lie on one line", on, lines.on[i].size());
    }

    return lines;
}

void describe_lines(const LensData& data, const Intrinsics& k, Lines& lines,
                    std::vector<PoseResidual>& poses) {
    for (std::size_t i = 0; i < data.lines.size(); ++i) {
        poses[i].used = lines.used[i];
        // Lines that took no part judge the lens as well, with all their points.
        if (!lines.used[i]) lines.on[i].assign(data.lines[i].size(), 1);
        const std::vector<double> off = lines.all_distances(i, k);
        double sum = 0, on = 0;
        for (std::size_t j = 0; j < off.size(); ++j)
            if (lines.on[i][j]) sum += off[j] * off[j], on += 1;
        if (on > 0) poses[i].rms_px = std::sqrt(sum / on);
        const auto left_out = static_cast<double>(data.lines[i].size()) - on;
        if (lines.used[i] && left_out > 0)
            poses[i].note =
                Text("{:.0f} of its {} points lie off it and took no part", left_out, data.lines[i].size());
    }
}

// Shift of the image's corners by the distortion, and its sigma by the covariance.
void state_corners(const LensData& data, const Intrinsics& k, double half, const std::vector<int>& free,
                   LensResult& result) {
    constexpr double kCentreStep_px = 0.05, kStep = 1e-5;  // of the centre, of a coefficient
    const auto n = static_cast<Eigen::Index>(free.size());
    for (const Eigen::Vector2d& corner :
         {Eigen::Vector2d(0, 0), Eigen::Vector2d(data.width, 0), Eigen::Vector2d(0, data.height),
          Eigen::Vector2d(data.width, data.height)}) {
        const auto shift = [&](const Intrinsics& q) {
            return Eigen::Vector2d(
                corner - (half * camera_of(q, data.width, data.height).undistort(corner) + q.segment<2>(2)));
        };
        const Eigen::Vector2d s = shift(k);
        Eigen::MatrixXd j(2, n);
        for (Eigen::Index i = 0; i < n; ++i) {
            const int p = free[static_cast<std::size_t>(i)];
            const double h = p < 4 ? kCentreStep_px : kStep;
            Intrinsics a = k, b = k;
            a(p) += h, b(p) -= h;
            j.col(i) = (shift(a) - shift(b)) / (2 * h);
        }
        const double sigma = std::sqrt((j * result.report.covariance * j.transpose()).trace());
        result.corner_shift_px = std::max(result.corner_shift_px, s.norm());
        result.corner_sigma_px = std::isfinite(sigma) ? std::max(result.corner_sigma_px, sigma) : kInfinity;
    }
}

bool spans_the_field(const LensResult& result, const Lines& lines, bool converged) {
    return lines.count() >= 3 && converged && result.corner_sigma_px < kCornerKnown_px &&
           result.report.covariance.allFinite();
}

LineNoise point_noise(const LensData& data, const Intrinsics& k, const Lines& lines) {
    LineNoise noise;
    for (std::size_t i = 0; i < data.lines.size(); ++i)
        if (lines.used[i]) noise.add(data.lines[i], lines.on[i], lines.all_distances(i, k));
    return noise;
}

// What no lens of this model takes away, of lines whose points lie where they are seen.
bool stays_bent(double rms_px, double noise_px) {
    constexpr double kTimes = 3;
    return noise_px > 0 && rms_px > std::max(kBentPx, kTimes * noise_px);
}

Judgement judged(const LensResult& result, int lines_used, bool converged, bool spans) {
    const CalibrationReport& report = result.report;
    const char* cure = "take lines in all parts of the image, in two directions, from edge to edge";
    const std::string without = left_out(report.poses);
    const auto say = [&](const Text& reason) {
        return without.empty() ? reason : Text("{}; left out as no straight lines: {}", reason, without);
    };
    if (!spans)
        return {Verdict::undetermined,
                say(lines_used < 3 ? Text("{} line(s) do not determine a lens", lines_used)
                    : !converged   ? Text("no lens makes the lines straight")
                                   : Text("the lines do not span the field: the distortion in the "
                                            "corners is known to {:.1f} px only",
                                          result.corner_sigma_px)),
                cure};
    if (result.straightness_after_px > kStraight_px)
        return {Verdict::poor, say(Text("the lines stay bent by {:.2f} px", result.straightness_after_px)),
                "check that the lines lie on a flat plane"};
    const Text bent("the lines stay bent by {:.2f} px, their points scatter by {:.2f} px",
                    result.straightness_after_px, result.point_noise_px);
    const char* plane = "check that the lines lie on a flat plane";
    if (stays_bent(result.straightness_after_px, result.point_noise_px)) {
        if (result.full_model_px > 0 && !result.centre_strays &&
            result.full_model_px < LineNoise::kStraightTimes * result.point_noise_px)
            return {Verdict::usable, say(bent), "solve for k3, p1 and p2 too"};
        return {Verdict::poor, say(bent), plane};
    }
    if (result.bent && result.straightness_after_px > kNearPx)
        return {result.centre_strays ? Verdict::poor : Verdict::usable, say(bent), plane};
    if (result.corner_sigma_px > kCornerGood_px)
        return {Verdict::usable,
                say(Text("the distortion in the corners is known to {:.2f} px", result.corner_sigma_px)),
                cure};
    return {Verdict::good,
            say(Text("{} lines, straight to {:.2f} px (before: {:.2f} px)", lines_used,
                     result.straightness_after_px, result.straightness_before_px)),
            ""};
}

}  // namespace
}  // namespace lens_lines

Expected<LensResult> calibrate_lens(const LensData& data, const LensOptions& options) {
    using namespace lens_lines;
    if (data.width < kSmallestImage_px || data.height < kSmallestImage_px || data.width > kLargestImage_px ||
        data.height > kLargestImage_px)
        return input_error(Text("an image of {}x{} pixels is not possible", data.width, data.height), "size",
                           "give [width, height] in pixels");
    LensResult result;
    auto& poses = result.report.poses;
    SEAM_TRY(auto lines, read_lines(data, options, poses));
    const double half = 0.5 * std::hypot(data.width, data.height);
    Intrinsics k;
    k << half, half, 0.5 * (data.width - 1), 0.5 * (data.height - 1), 0, 0, 0, 0, 0;
    std::vector<int> free{2, 3, 4, 5};
    if (options.full) free.insert(free.end(), {8, 6, 7});
    const auto n = static_cast<Eigen::Index>(free.size());
    const Eigen::Vector2d middle = k.segment<2>(2);
    constexpr double kCentreSigma = 0.1;  // sigma of the centre about the image's middle, of its width
    const double hold = kCentreSigma * data.width;
    const Intrinsics start = k;
    Solution solved;
    solved.k = start;
    for (int round = 0; round < kCleaningRounds && lines.count() > 0; ++round) {
        const int before = lines.count();
        solved = solve_lens(lines, k, free, middle, hold);
        if (!clean(data, solved.k, lines, poses)) break;
        k = solved.converged && lines.count() == before
                ? solved.k
                : start;  // a line that was none may have led it far astray
    }
    k = solved.k;
    const double points = std::max(1.0, lines.points());
    if (const double before = lines.squares(start); std::isfinite(before))
        result.straightness_before_px = std::sqrt(before / points);
    result.lens = camera_of(k, data.width, data.height);
    result.k1_px = k(4) / (half * half);
    result.k2_px = k(5) / std::pow(half, 4);
    result.straightness_after_px = std::sqrt(solved.squares / points);
    describe_lines(data, k, lines, poses);
    static constexpr const char* names[] = {"", "", "centre_u", "centre_v", "k1", "k2", "p1", "p2", "k3"};
    auto& report = result.report;
    for (const int p : free) report.parameters.push_back({names[p], k(p), p < 4 ? "px" : "1", 0});
    if (solved.information.size() > 0)
        report.covariance = solved.variance * inverse_matrix(solved.information);
    else
        report.covariance.setConstant(n, n, kInfinity);
    const LineNoise noise = point_noise(data, k, lines);
    result.point_noise_px = noise.sigma_px();
    const double form = noise.form_factor(result.straightness_after_px, lines.points(), lines.count());
    result.bent = form > 1;
    result.centre_strays = (k.segment<2>(2) - middle).norm() > hold;
    report.covariance *= std::max(form, noise.alike_factor(static_cast<double>(n)));
    if (!options.full && solved.converged && stays_bent(result.straightness_after_px, result.point_noise_px))
        if (const Solution full = solve_lens(lines, k, {2, 3, 4, 5, 8, 6, 7}, middle, hold); full.converged)
            result.full_model_px = std::sqrt(full.squares / points);
    state_corners(data, k, half, free, result);
    const bool spans = spans_the_field(result, lines, solved.converged);
    report.judgement = judged(result, lines.count(), solved.converged, spans);
    if (spans)
        finish_statistics(report);
    else
        report.covariance.resize(0, 0);
    return result;
}

}  // namespace seamwright
