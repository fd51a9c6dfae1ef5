#include "core/calibration/lens.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/calibration/camera.h"
#include "core/geometry/decompositions.h"

namespace seamwright {
namespace {

struct Spread {
    double least = 0, most = 0;    // eigenvalues of the centred covariance
    Eigen::Vector2d mean, normal;  // of the line
};

Spread spread_of(const std::vector<Eigen::Vector2d>& points) {
    Spread s;
    s.mean.setZero();
    for (const auto& p : points) s.mean += p;
    s.mean /= static_cast<double>(points.size());
    double xx = 0, xy = 0, yy = 0;
    for (const auto& p : points) {
        const Eigen::Vector2d d = p - s.mean;
        xx += d.x() * d.x(), xy += d.x() * d.y(), yy += d.y() * d.y();
    }
    const double n = static_cast<double>(points.size());
    const double half = 0.5 * (xx + yy) / n, root = std::hypot(0.5 * (xx - yy), xy) / n;
    s.most = half + root;
    s.least = std::max(0.0, half - root);
    const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
    s.normal = {-std::sin(angle), std::cos(angle)};
    return s;
}

// Distances from the fitted lines in px, each line brought back to its length in the image (the ratio).
bool residuals(const LensData& data, const std::vector<char>& used, const Intrinsics& k,
               Eigen::VectorXd& out) {
    const CameraModel lens = camera_of(k, data.width, data.height);
    Eigen::Index at = 0;
    std::vector<Eigen::Vector2d> straight;
    for (std::size_t i = 0; i < data.lines.size(); ++i) {
        if (!used[i]) continue;
        straight.clear();
        for (const auto& p : data.lines[i]) straight.push_back(k(0) * lens.undistort(p));
        Spread s = spread_of(straight);
        const Spread raw = spread_of(data.lines[i]);
        if (s.normal.dot(raw.normal) < 0) s.normal = -s.normal;  // one side for all, or derivatives jump
        if (!(s.most > 0) || !std::isfinite(s.most)) return false;
        const double scale = std::sqrt(raw.most / s.most);
        for (const auto& p : straight) out(at++) = scale * s.normal.dot(p - s.mean);
    }
    return out.allFinite();
}

}  // namespace

Expected<LensResult> calibrate_lens(const LensData& data, const LensOptions& options) {
    if (data.width < 16 || data.height < 16 || data.width > 100000 || data.height > 100000)
        return input_error(fmt::format("an image of {}x{} pixels is not possible", data.width, data.height),
                           "size", "give [width, height] in pixels");
    LensResult result;
    std::vector<char> used(data.lines.size(), 1);
    for (const int e : options.exclude) {
        if (e < 0 || static_cast<std::size_t>(e) >= data.lines.size())
            return input_error(fmt::format("there is no line {} to exclude", e), "exclude",
                               "lines count from 0");
        used[static_cast<std::size_t>(e)] = 0;
    }
    Eigen::Index points = 0;
    int lines = 0;
    for (std::size_t i = 0; i < data.lines.size(); ++i) {
        const std::string where = fmt::format("lines[{}]", i);
        if (data.lines[i].size() < 5)
            return input_error(fmt::format("{} points are too few for a line", data.lines[i].size()), where,
                               "give at least 5");
        for (const auto& p : data.lines[i])
            if (!p.allFinite() || p.x() < -1 || p.y() < -1 || p.x() > data.width || p.y() > data.height)
                return input_error("a point is not finite or lies outside the image", where, "leave it out");
        if (!(spread_of(data.lines[i]).most > 1))
            return input_error("all points of the line are the same", where, "leave it out");
        PoseResidual p;
        p.id = std::to_string(i);
        p.used = used[i];
        if (!used[i]) p.note = "excluded";
        result.report.poses.push_back(std::move(p));
        if (used[i]) points += static_cast<Eigen::Index>(data.lines[i].size()), ++lines;
    }
    if (lines == 0)
        return input_error("there is no line", "lines", "give 5 or more lines over the whole image");

    const double half = 0.5 * std::hypot(data.width, data.height);
    Intrinsics k;
    k << half, half, 0.5 * (data.width - 1), 0.5 * (data.height - 1), 0, 0, 0, 0, 0;
    std::vector<int> free{2, 3, 4, 5};
    if (options.full) free.insert(free.end(), {8, 6, 7});
    const auto n = static_cast<Eigen::Index>(free.size());
    const Eigen::Vector2d middle = k.segment<2>(2);
    const double hold = 0.1 * data.width;  // px, of the centre

    Eigen::VectorXd r(points), plus(points), minus(points);
    Eigen::MatrixXd jacobian(points, n), information = Eigen::MatrixXd::Identity(n, n);
    residuals(data, used, k, r);
    result.straightness_before_px = std::sqrt(r.squaredNorm() / static_cast<double>(points));
    double variance = std::max(r.squaredNorm() / static_cast<double>(points), 1e-12), damping = 1e-4;
    const double freedom = std::max<double>(1, static_cast<double>(points - 2 * lines - n));
    bool converged = false;
    // The prior's weight follows the noise estimate: a few outer rounds.
    for (int outer = 0; outer < 4; ++outer) {
        const auto cost_of = [&](const Intrinsics& q, Eigen::VectorXd& e) {
            if (!residuals(data, used, q, e)) return std::numeric_limits<double>::infinity();
            return e.squaredNorm() + variance / (hold * hold) * (q.segment<2>(2) - middle).squaredNorm();
        };
        double cost = cost_of(k, r);
        converged = false;
        for (int iteration = 0; iteration < 60 && !converged; ++iteration) {
            for (Eigen::Index j = 0; j < n; ++j) {
                const int p = free[static_cast<std::size_t>(j)];
                const double h = p < 4 ? 0.05 : 1e-5;
                Intrinsics a = k, b = k;
                a(p) += h, b(p) -= h;
                if (!residuals(data, used, a, plus) || !residuals(data, used, b, minus))
                    return input_error("the lines cannot be undistorted", "lines", "check the points");
                jacobian.col(j) = (plus - minus) / (2 * h);
            }
            information = jacobian.transpose() * jacobian;
            Eigen::VectorXd gradient = jacobian.transpose() * r;
            for (Eigen::Index j = 0; j < 2; ++j) {
                information(j, j) += variance / (hold * hold);
                gradient(j) += variance / (hold * hold) * (k(2 + j) - middle(j));
            }
            bool better = false;
            for (int attempt = 0; attempt < 12 && !better; ++attempt) {
                Eigen::MatrixXd damped = information;
                damped.diagonal() *= 1 + damping;
                const Eigen::VectorXd step = -solve_symmetric(damped, gradient);
                Intrinsics trial = k;
                for (Eigen::Index j = 0; j < n; ++j) trial(free[static_cast<std::size_t>(j)]) += step(j);
                Eigen::VectorXd e(points);
                const double c =
                    step.allFinite() ? cost_of(trial, e) : std::numeric_limits<double>::infinity();
                if (c <= cost) {
                    better = true;
                    converged = cost - c <= 1e-10 * cost + 1e-18;
                    k = trial;
                    r = e;
                    cost = c;
                    damping = std::max(damping * 0.1, 1e-12);
                } else {
                    damping *= 10;
                }
            }
            if (!better) converged = true;
        }
        variance = std::max(r.squaredNorm() / freedom, 1e-12);
    }
    result.lens = camera_of(k, data.width, data.height);
    result.k1_px = k(4) / (half * half);
    result.k2_px = k(5) / std::pow(half, 4);
    result.straightness_after_px = std::sqrt(r.squaredNorm() / static_cast<double>(points));
    // Lines that took no part judge the lens as well.
    for (std::size_t i = 0; i < data.lines.size(); ++i) {
        std::vector<char> only(data.lines.size(), 0);
        only[i] = 1;
        Eigen::VectorXd line(static_cast<Eigen::Index>(data.lines[i].size()));
        if (residuals(data, only, k, line))
            result.report.poses[i].rms_px = std::sqrt(line.squaredNorm() / static_cast<double>(line.size()));
    }
    static constexpr const char* names[] = {"", "", "centre_u", "centre_v", "k1", "k2", "p1", "p2", "k3"};
    auto& report = result.report;
    for (const int p : free) report.parameters.push_back({names[p], k(p), p < 4 ? "px" : "1", 0});
    report.covariance = variance * inverse_matrix(information);
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
        result.corner_sigma_px = std::isfinite(sigma) ? std::max(result.corner_sigma_px, sigma)
                                                      : std::numeric_limits<double>::infinity();
    }
    const char* cure = "take lines in all parts of the image, in two directions, from edge to edge";
    if (lines < 3 || !converged || !(result.corner_sigma_px < 3) || !report.covariance.allFinite()) {
        report.covariance.resize(0, 0);
        report.judgement = {Verdict::undetermined,
                            lines < 3 ? fmt::format("{} line(s) do not determine a lens", lines)
                                      : fmt::format("the lines do not span the field: the distortion in the "
                                                    "corners is known to {:.1f} px only",
                                                    result.corner_sigma_px),
                            cure};
        return result;
    }
    finish_statistics(report);
    if (result.straightness_after_px > 2)
        report.judgement = {Verdict::poor,
                            fmt::format("the lines stay bent by {:.2f} px", result.straightness_after_px),
                            "check that the lines lie on a flat plane"};
    else if (result.corner_sigma_px > 0.5)
        report.judgement = {
            Verdict::usable,
            fmt::format("the distortion in the corners is known to {:.2f} px", result.corner_sigma_px), cure};
    else
        report.judgement = {Verdict::good,
                            fmt::format("{} lines, straight to {:.2f} px (before: {:.2f} px)", lines,
                                        result.straightness_after_px, result.straightness_before_px),
                            ""};
    return result;
}

}  // namespace seamwright
