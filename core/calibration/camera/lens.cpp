#include "core/calibration/camera/lens.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/calibration/camera/bent_line.h"
#include "core/calibration/camera/camera.h"
#include "core/geometry/decompositions.h"
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

struct Spread {
    double least = 0, most = 0;    // eigenvalues of the centred covariance
    Eigen::Vector2d mean, normal;  // of the line
};

// Of the points by their weights.
template <class Weights>
Spread spread_of(const std::vector<Eigen::Vector2d>& points, const Weights& weight) {
    Spread s;
    s.mean.setZero();
    double n = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (weight[i] > 0) s.mean += weight[i] * points[i], n += weight[i];
    s.mean /= n;
    double xx = 0, xy = 0, yy = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!(weight[i] > 0)) continue;
        const Eigen::Vector2d d = points[i] - s.mean;
        xx += weight[i] * d.x() * d.x(), xy += weight[i] * d.x() * d.y(), yy += weight[i] * d.y() * d.y();
    }
    const double half = 0.5 * (xx + yy) / n, root = std::hypot(0.5 * (xx - yy), xy) / n;
    s.most = half + root;
    s.least = std::max(0.0, half - root);
    const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
    s.normal = {-std::sin(angle), std::cos(angle)};
    return s;
}

// One char a point: whether it is taken to lie on its line.
using Support = std::vector<std::vector<char>>;

// Signed distances of all points of a line, in px of the image, from the line fitted to its support: the
// distance in the undistorted plane over how far a pixel across the line reaches there. False where the lens
// cannot be undone.
bool distances(const std::vector<Eigen::Vector2d>& points, const std::vector<char>& on, const Intrinsics& k,
               const CameraModel& lens, std::vector<Eigen::Vector2d>& straight,
               std::vector<Eigen::Matrix2d>& across, std::vector<double>& weight, std::vector<double>& out) {
    straight.clear();
    across.clear();
    weight.clear();
    out.clear();
    for (std::size_t i = 0; i < points.size(); ++i) {
        straight.push_back(lens.undistort(points[i]));
        weight.push_back(on[i]);
        if (!straight[i].allFinite()) {
            if (on[i]) return false;
            across.push_back(Eigen::Matrix2d::Identity());
            continue;
        }
        Eigen::Vector2d pixel;
        Eigen::Matrix<double, 2, 3> by_point;
        project_with_jacobian(k, {straight[i].x(), straight[i].y(), 1}, pixel, &by_point, nullptr);
        const Eigen::Matrix2d j = by_point.leftCols<2>();
        across.emplace_back();
        across.back() << j(1, 1), -j(1, 0), -j(0, 1), j(0, 0);  // inverse, transposed
        across.back() /= j.determinant();
    }
    Spread s = spread_of(straight, weight);
    for (std::size_t i = 0; i < points.size(); ++i)
        if (on[i]) weight[i] = 1 / (across[i] * s.normal).squaredNorm();
    s = spread_of(straight, weight);
    if (!(s.most > 0) || !std::isfinite(s.most)) return false;
    if (s.normal.dot(spread_of(points, on).normal) < 0)
        s.normal = -s.normal;  // one side for all, or derivatives jump
    for (std::size_t i = 0; i < points.size(); ++i)
        out.push_back(s.normal.dot(straight[i] - s.mean) / (across[i] * s.normal).norm());
    return true;
}

// What the solver sees of the lines: those used, and of these the points on them.
class Lines {
  public:
    explicit Lines(const LensData& data) : data_(data), used(data.lines.size(), 1) {
        for (const auto& line : data.lines) on.emplace_back(line.size(), 1);
    }
    Eigen::Index points() const {
        Eigen::Index n = 0;
        for (std::size_t i = 0; i < on.size(); ++i)
            if (used[i]) n += std::count(on[i].begin(), on[i].end(), 1);
        return n;
    }
    int count() const { return static_cast<int>(std::count(used.begin(), used.end(), 1)); }
    CameraModel camera(const Intrinsics& k) const { return camera_of(k, data_.width, data_.height); }
    bool residuals(const Intrinsics& k, Eigen::VectorXd& out) {
        const CameraModel lens = camera(k);
        out.resize(points());
        Eigen::Index at = 0;
        for (std::size_t i = 0; i < data_.lines.size(); ++i) {
            if (!used[i]) continue;
            if (!distances(data_.lines[i], on[i], k, lens, straight_, across_, weight_, off_)) return false;
            for (std::size_t j = 0; j < off_.size(); ++j)
                if (on[i][j]) out(at++) = off_[j];
        }
        return out.allFinite();
    }
    // Central differences. False where the lens cannot be undone beside k.
    bool jacobian(const Intrinsics& k, const std::vector<int>& free, Eigen::MatrixXd& out) {
        out.resize(points(), static_cast<Eigen::Index>(free.size()));
        for (Eigen::Index j = 0; j < out.cols(); ++j) {
            const int p = free[static_cast<std::size_t>(j)];
            const double h = p < 4 ? 0.05 : 1e-5;
            Intrinsics a = k, b = k;
            a(p) += h, b(p) -= h;
            if (!residuals(a, plus_) || !residuals(b, minus_)) return false;
            out.col(j) = (plus_ - minus_) / (2 * h);
        }
        return out.allFinite();
    }
    // Distances of all points of a line, used or not; empty where the lens cannot be undone.
    std::vector<double> all_distances(std::size_t line, const Intrinsics& k) {
        std::vector<double> out;
        if (!distances(data_.lines[line], on[line], k, camera(k), straight_, across_, weight_, out))
            out.clear();
        return out;
    }

  private:
    const LensData& data_;
    std::vector<Eigen::Vector2d> straight_;
    std::vector<Eigen::Matrix2d> across_;
    std::vector<double> weight_, off_;
    Eigen::VectorXd plus_, minus_;

  public:
    std::vector<char> used;
    Support on;
};

struct Solution {
    Intrinsics k;
    Eigen::VectorXd r;
    Eigen::MatrixXd information;
    double variance = 0;
    bool converged = false;
};

// Levenberg-Marquardt from k. The prior that holds the centre weighs by the noise estimate: a few outer
// rounds. A step to where the lens can no longer be undone (its fold reaches a point) is refused like one
// uphill.
Solution solve(Lines& lines, Intrinsics k, const std::vector<int>& free, const Eigen::Vector2d& middle,
               double hold_px) {
    Solution s;
    const auto n = static_cast<Eigen::Index>(free.size());
    const auto points = static_cast<double>(lines.points());
    const double freedom = std::max(1.0, points - 2.0 * lines.count() - static_cast<double>(n));
    Eigen::MatrixXd jacobian, trial_jacobian;
    Eigen::VectorXd e;
    s.k = k;
    if (!lines.residuals(s.k, s.r) || !lines.jacobian(s.k, free, jacobian)) return s;
    s.variance = std::max(s.r.squaredNorm() / points, 1e-12);
    double damping = 1e-4;
    for (int outer = 0; outer < 4; ++outer) {
        const double weight = s.variance / (hold_px * hold_px);
        const auto held = [&](const Intrinsics& q) {
            return weight * (q.segment<2>(2) - middle).squaredNorm();
        };
        double cost = s.r.squaredNorm() + held(s.k);
        s.converged = false;
        for (int iteration = 0; iteration < 60 && !s.converged; ++iteration) {
            s.information = jacobian.transpose() * jacobian;
            Eigen::VectorXd gradient = jacobian.transpose() * s.r;
            for (Eigen::Index j = 0; j < 2; ++j) {
                s.information(j, j) += weight;
                gradient(j) += weight * (s.k(2 + j) - middle(j));
            }
            bool better = false, folded = false;
            for (int attempt = 0; attempt < 24 && !better; ++attempt) {
                Eigen::MatrixXd damped = s.information;
                damped.diagonal() *= 1 + damping;
                const Eigen::VectorXd step = -solve_symmetric(damped, gradient);
                Intrinsics trial = s.k;
                for (Eigen::Index j = 0; j < n; ++j) trial(free[static_cast<std::size_t>(j)]) += step(j);
                const bool possible = step.allFinite() && lines.residuals(trial, e);
                const double c = possible ? e.squaredNorm() + held(trial) : kInfinity;
                if (c <= cost && lines.jacobian(trial, free, trial_jacobian)) {
                    better = true;
                    s.converged = cost - c <= 1e-7 * cost + 1e-18;  // a hundredth of a sigma
                    s.k = trial;
                    s.r = e;
                    jacobian.swap(trial_jacobian);
                    cost = c;
                    damping = std::max(damping * 0.1, 1e-12);
                } else {
                    folded = !possible || c <= cost;  // even a short step
                    damping *= 10;
                }
            }
            if (!better) {
                s.converged = !folded;
                break;
            }
        }
        const double before = s.variance;
        s.variance = std::max(s.r.squaredNorm() / freedom, 1e-12);
        if (!s.converged || std::abs(s.variance - before) < 1e-3 * before) break;
    }
    return s;
}

double lens_median(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
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
    const double bent = std::max(kBentPx, kBentTimes * lens_median(rms_used));
    const auto worst = static_cast<std::size_t>(std::max_element(rms.begin(), rms.end()) - rms.begin());
    if (lines.count() > fewest && rms[worst] > bent) {
        lines.used[worst] = 0;
        poses[worst].note = Text("left out: it stays bent by {:.2f} px, the others by {:.2f} px", rms[worst],
                                 lens_median(rms_used));
        return true;
    }
    const double far = std::max(kNearPx, kFarSigmas * kMadToSigma * lens_median(std::move(all)));
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

}  // namespace
}  // namespace lens_lines

Expected<LensResult> calibrate_lens(const LensData& data, const LensOptions& options) {
    using namespace lens_lines;
    if (data.width < 16 || data.height < 16 || data.width > 100000 || data.height > 100000)
        return input_error(Text("an image of {}x{} pixels is not possible", data.width, data.height), "size",
                           "give [width, height] in pixels");
    LensResult result;
    std::vector<char> excluded(data.lines.size(), 0);
    for (const int e : options.exclude) {
        if (e < 0 || static_cast<std::size_t>(e) >= data.lines.size())
            return input_error(Text("there is no line {} to exclude", e), "exclude", "lines count from 0");
        excluded[static_cast<std::size_t>(e)] = 1;
    }
    Lines lines(data);
    auto& poses = result.report.poses;
    for (std::size_t i = 0; i < data.lines.size(); ++i) {
        const std::string where = fmt::format("lines[{}]", i);
        const auto& line = data.lines[i];
        if (line.size() < 5)
            return input_error(Text("{} points are too few for a line", line.size()), where,
                               "give at least 5");
        for (const auto& p : line)
            if (!p.allFinite() || p.x() < -1 || p.y() < -1 || p.x() > data.width || p.y() > data.height)
                return input_error("a point is not finite or lies outside the image", where, "leave it out");
        if (!(spread_of(line, lines.on[i]).most > 1))
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

    const double half = 0.5 * std::hypot(data.width, data.height);
    Intrinsics k;
    k << half, half, 0.5 * (data.width - 1), 0.5 * (data.height - 1), 0, 0, 0, 0, 0;
    std::vector<int> free{2, 3, 4, 5};
    if (options.full) free.insert(free.end(), {8, 6, 7});
    const auto n = static_cast<Eigen::Index>(free.size());
    const Eigen::Vector2d middle = k.segment<2>(2);
    const double hold = 0.1 * data.width;  // px, of the centre
    const Intrinsics start = k;
    Solution solved;
    solved.k = start;
    for (int round = 0; round < kCleaningRounds && lines.count() > 0; ++round) {
        const int before = lines.count();
        solved = solve(lines, k, free, middle, hold);
        if (!clean(data, solved.k, lines, poses)) break;
        k = solved.converged && lines.count() == before
                ? solved.k
                : start;  // a line that was none may have led it far astray
    }
    k = solved.k;
    const auto points = static_cast<double>(std::max<Eigen::Index>(1, lines.points()));
    if (Eigen::VectorXd before; lines.count() > 0 && lines.residuals(start, before))
        result.straightness_before_px = std::sqrt(before.squaredNorm() / points);
    result.lens = camera_of(k, data.width, data.height);
    result.k1_px = k(4) / (half * half);
    result.k2_px = k(5) / std::pow(half, 4);
    result.straightness_after_px = std::sqrt(solved.r.squaredNorm() / points);
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
    static constexpr const char* names[] = {"", "", "centre_u", "centre_v", "k1", "k2", "p1", "p2", "k3"};
    auto& report = result.report;
    for (const int p : free) report.parameters.push_back({names[p], k(p), p < 4 ? "px" : "1", 0});
    if (solved.information.size() > 0)
        report.covariance = solved.variance * inverse_matrix(solved.information);
    else
        report.covariance.setConstant(n, n, kInfinity);
    // Shift of the image's corners and its sigma, by the covariance.
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
            const double h = p < 4 ? 0.05 : 1e-5;
            Intrinsics a = k, b = k;
            a(p) += h, b(p) -= h;
            j.col(i) = (shift(a) - shift(b)) / (2 * h);
        }
        const double sigma = std::sqrt((j * report.covariance * j.transpose()).trace());
        result.corner_shift_px = std::max(result.corner_shift_px, s.norm());
        result.corner_sigma_px = std::isfinite(sigma) ? std::max(result.corner_sigma_px, sigma) : kInfinity;
    }
    const char* cure = "take lines in all parts of the image, in two directions, from edge to edge";
    std::string left_out;
    for (const PoseResidual& p : poses)
        if (!p.used && !p.excluded) left_out += (left_out.empty() ? "" : ", ") + p.id;
    const auto say = [&](const Text& reason) {
        return left_out.empty() ? reason : Text("{}; left out as no straight lines: {}", reason, left_out);
    };
    if (lines.count() < 3 || !solved.converged || !(result.corner_sigma_px < 3) ||
        !report.covariance.allFinite()) {
        report.covariance.resize(0, 0);
        report.judgement = {
            Verdict::undetermined,
            say(lines.count() < 3   ? Text("{} line(s) do not determine a lens", lines.count())
                : !solved.converged ? Text("no lens makes the lines straight")
                                    : Text("the lines do not span the field: the distortion in the "
                                           "corners is known to {:.1f} px only",
                                           result.corner_sigma_px)),
            cure};
        return result;
    }
    finish_statistics(report);
    if (result.straightness_after_px > 2)
        report.judgement = {Verdict::poor,
                            say(Text("the lines stay bent by {:.2f} px", result.straightness_after_px)),
                            "check that the lines lie on a flat plane"};
    else if (result.corner_sigma_px > 0.5)
        report.judgement = {
            Verdict::usable,
            say(Text("the distortion in the corners is known to {:.2f} px", result.corner_sigma_px)), cure};
    else
        report.judgement = {Verdict::good,
                            say(Text("{} lines, straight to {:.2f} px (before: {:.2f} px)", lines.count(),
                                     result.straightness_after_px, result.straightness_before_px)),
                            ""};
    return result;
}

}  // namespace seamwright
