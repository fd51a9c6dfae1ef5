#include "core/calibration/table/wrong_groups.h"
#include "core/acceptance/distributions.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/calibration/camera/camera.h"
#include "core/calibration/f_test.h"
#include "core/calibration/numbers.h"
#include "core/calibration/statistics.h"

namespace seamwright::lookup_table {

using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

namespace {

// H but its last number, centre, k1, k2, then k3, p1, p2; pixels and places in units of about one.
using LensOnPlane = Eigen::Matrix<double, 15, 1>;
// Most lenses need no more than k1 and k2; what the rest is free for, a column at the rim hides behind.
constexpr Eigen::Index kSimple = 12, kRich = LensOnPlane::RowsAtCompileTime;
constexpr int kFewestOfGroup = 3, kFewestGroups = 4;
constexpr double kFewestFreedom = 20;
constexpr double kGross = 9;        // mean square without the shift over that with it, at least
constexpr double kAsNoise = 1.5;    // of the map's noise, what may remain
constexpr double kLeast_px = 0.25;  // of a shift, in the image

class PlaneFit {
  public:
    PlaneFit(const Samples& s, int width, int height, Eigen::Index unknowns)
        : unknowns_(unknowns),
          middle_(0.5 * width, 0.5 * height),
          half_px_(0.5 * std::max(width, height)),
          samples_(s) {
        for (const auto& l : s.laser) mean_ += l / static_cast<double>(s.laser.size());
        for (const auto& l : s.laser) half_mm_ = std::max(half_mm_, (l - mean_).norm());
    }

    // From where it stands, or a homography. False: no start, or a derivative that is none.
    bool solve(const std::vector<Vector2d>& laser) {
        if (!started_ && !start(laser)) return false;
        constexpr double kSettled = 1e-8, kStep = 1e-6;
        r_ = residuals(p_, laser);
        MatrixXd j(r_.size(), unknowns_);
        for (int round = 0; round < 40; ++round) {
            for (Eigen::Index k = 0; k < unknowns_; ++k) {
                const LensOnPlane step = kStep * LensOnPlane::Unit(k);
                j.col(k) = (residuals(p_ + step, laser) - residuals(p_ - step, laser)) / (2 * kStep);
            }
            if (!j.allFinite() || !r_.allFinite()) return false;
            const Eigen::ColPivHouseholderQR<MatrixXd> qr(j);
            LensOnPlane full = LensOnPlane::Zero();
            full.head(unknowns_) = qr.solve(r_);
            q_ = qr.householderQ() * MatrixXd::Identity(j.rows(), unknowns_);
            const double cost = r_.squaredNorm();
            double share = 1;
            VectorXd then = residuals(p_ - full, laser);
            while (!(then.squaredNorm() < cost) && share > 1e-3)
                share *= 0.25, then = residuals(p_ - share * full, laser);
            if (!(then.squaredNorm() < cost)) break;
            p_ -= share * full;
            r_ = then;
            if (cost - then.squaredNorm() < kSettled * cost) break;
        }
        slope_.resize(laser.size());
        for (std::size_t i = 0; i < laser.size(); ++i) {
            const double h = 1e-5 * half_mm_;
            for (Eigen::Index k = 0; k < 2; ++k)
                slope_[i].col(k) =
                    (at(p_, laser[i] + h * Vector2d::Unit(k)) - at(p_, laser[i] - h * Vector2d::Unit(k))) /
                    (2 * h);
        }
        return r_.allFinite();
    }
    double squares() const { return r_.squaredNorm(); }
    double freedom() const { return static_cast<double>(r_.size() - unknowns_); }
    const VectorXd& residual() const { return r_; }
    // By errors of these rows along an axis, 1 mm each, as far as the map does not follow them.
    MatrixXd left_of(const std::vector<std::vector<std::size_t>>& rows, Eigen::Index axis) const {
        MatrixXd moved = MatrixXd::Zero(r_.size(), static_cast<Eigen::Index>(rows.size()));
        for (std::size_t k = 0; k < rows.size(); ++k)
            for (const std::size_t i : rows[k])
                moved.block<2, 1>(static_cast<Eigen::Index>(2 * i), static_cast<Eigen::Index>(k)) =
                    slope_[i].col(axis);
        return moved - q_ * (q_.transpose() * moved);
    }

    // What these pairs' places are off by together (mm), that taken away takes most off the sum of squares; and how much.
    double best_shift(const std::vector<std::size_t>& group, Vector2d& shift_mm) const {
        Matrix2d cc = Matrix2d::Zero();
        Vector2d cr = Vector2d::Zero();
        MatrixXd within = MatrixXd::Zero(q_.cols(), 2);
        for (const std::size_t i : group) {
            const auto row = static_cast<Eigen::Index>(2 * i);
            cc += slope_[i].transpose() * slope_[i];
            cr += slope_[i].transpose() * r_.segment<2>(row);
            within += q_.middleRows<2>(row).transpose() * slope_[i];
        }
        constexpr double kNothingLeft = 1e-9;  // of the group, beside the map
        const Matrix2d left = cc - within.transpose() * within;
        if (!(left.determinant() > kNothingLeft * cc.determinant())) return 0;
        shift_mm = left.inverse() * cr;
        return cr.dot(shift_mm);
    }
    // The same in the image, rms over the group.
    double seen_px(const std::vector<std::size_t>& group, const Vector2d& shift_mm) const {
        double sum = 0;
        for (const std::size_t i : group) sum += (slope_[i] * shift_mm).squaredNorm();
        return std::sqrt(sum / static_cast<double>(group.size()));
    }

  private:
    bool start(const std::vector<Vector2d>& laser) {
        constexpr double kAtHorizon = 1e-9;
        std::vector<Vector2d> from, to;
        for (const auto& l : laser) from.push_back((l - mean_) / half_mm_);
        for (const auto& q : samples_.pixel) to.push_back((q - middle_) / half_px_);
        const auto h = homography_dlt(from, to);
        if (!h || !(std::abs((*h)(2, 2)) > kAtHorizon * h->norm())) return false;
        const Eigen::Matrix3d n = *h / (*h)(2, 2);
        p_.head<8>() << n(0, 0), n(0, 1), n(0, 2), n(1, 0), n(1, 1), n(1, 2), n(2, 0), n(2, 1);
        return started_ = p_.allFinite();
    }
    // Pixel of a place.
    Vector2d at(const LensOnPlane& p, const Vector2d& place) const {
        Eigen::Matrix3d h;
        h << p.segment<3>(0).transpose(), p.segment<3>(3).transpose(), p(6), p(7), 1;
        const Vector2d w = through(h, (place - mean_) / half_mm_), d = w - p.segment<2>(8);
        const double r2 = d.squaredNorm(), bend = r2 * (p(10) + r2 * (p(11) + r2 * p(12)));
        const double xy = 2 * d.x() * d.y();
        const Vector2d seen(w.x() + d.x() * bend + p(13) * xy + p(14) * (r2 + 2 * d.x() * d.x()),
                            w.y() + d.y() * bend + p(13) * (r2 + 2 * d.y() * d.y()) + p(14) * xy);
        return middle_ + half_px_ * seen;
    }
    VectorXd residuals(const LensOnPlane& p, const std::vector<Vector2d>& laser) const {
        VectorXd r(2 * static_cast<Eigen::Index>(laser.size()));
        for (std::size_t i = 0; i < laser.size(); ++i)
            r.segment<2>(static_cast<Eigen::Index>(2 * i)) = at(p, laser[i]) - samples_.pixel[i];
        return r;
    }

    Eigen::Index unknowns_;
    Vector2d middle_, mean_ = Vector2d::Zero();
    double half_px_, half_mm_ = 0;
    const Samples& samples_;
    bool started_ = false;
    LensOnPlane p_ = LensOnPlane::Zero();
    std::vector<Matrix2d> slope_;  // of the pixel by its place, px per mm
    MatrixXd q_;                   // of the derivatives by p_
    VectorXd r_;
};

// Pairs of one x (or z), in the order of it; empty where too few stand in rows.
std::vector<std::vector<std::size_t>> rows_of(const std::vector<Vector2d>& laser, Eigen::Index axis) {
    constexpr double kSame = 1e-4;  // of the extent
    std::vector<std::size_t> order(laser.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return laser[a](axis) < laser[b](axis); });
    const double same = kSame * (laser[order.back()](axis) - laser[order.front()](axis));
    std::vector<std::vector<std::size_t>> rows;
    for (const std::size_t i : order) {
        if (rows.empty() || laser[i](axis) - laser[rows.back().front()](axis) > same) rows.emplace_back();
        rows.back().push_back(i);
    }
    std::erase_if(rows, [](const auto& row) { return row.size() < kFewestOfGroup; });
    if (rows.size() < kFewestGroups) rows.clear();
    return rows;
}

struct Row {
    bool of_x;
    std::vector<std::size_t> pairs;
};

// By a lens of so many unknowns.
std::optional<WrongGroup> worst_row(const Samples& samples, const std::vector<Row>& rows, PlaneFit fit,
                                    double noise_px) {
    if (!fit.solve(samples.laser)) return std::nullopt;
    const double freedom = fit.freedom() - 2, before = fit.squares();
    if (freedom < kFewestFreedom) return std::nullopt;
    const Row* worst = nullptr;
    double most = 0;
    Vector2d shift, found = Vector2d::Zero();
    for (const Row& row : rows)
        if (const double taken = fit.best_shift(row.pairs, shift); taken > most)
            most = taken, worst = &row, found = shift;
    if (!worst) return std::nullopt;
    std::vector<Vector2d> laser = samples.laser;
    double after = before;
    for (int round = 0; round < 3; ++round) {  // the first shift is of a fit that the group has bent
        for (const std::size_t i : worst->pairs) laser[i] = samples.laser[i] - found;
        if (!fit.solve(laser)) return std::nullopt;
        after = fit.squares() - fit.best_shift(worst->pairs, shift);
        found += shift;
    }
    const double chance = freed_chance(before, after, 2, freedom) * static_cast<double>(rows.size());
    if (!(chance < kNoAccident) || !(before > kGross * after) ||
        !(std::sqrt(after / freedom) < kAsNoise * noise_px) ||
        !(fit.seen_px(worst->pairs, found) > kLeast_px))
        return std::nullopt;
    // A sensor of another kind has other rows left that a shift would mend.
    for (const Row& row : rows) {
        const double rest = after - fit.best_shift(row.pairs, shift);
        if (&row != worst &&
            freed_chance(after, rest, 2, freedom - 2) * static_cast<double>(rows.size()) < kNoAccident)
            return std::nullopt;
    }
    WrongGroup group{worst->of_x, 0, found};
    for (const std::size_t i : worst->pairs)
        group.at_mm += samples.laser[i](worst->of_x ? 0 : 1) / static_cast<double>(worst->pairs.size());
    return group;
}

}  // namespace

StageRows stage_rows(const Samples& samples) {
    return {rows_of(samples.laser, 0), rows_of(samples.laser, 1)};
}

std::array<double, 2> row_sigmas_mm(const Samples& samples, int width, int height, double noise_px) {
    constexpr double kChance = 0.01, kLeastNoise_px2 = 1e-12;
    constexpr std::size_t kMostNumbers = 4'000'000;
    std::array<double, 2> sigma{};
    const StageRows rows = stage_rows(samples);
    const std::size_t all = rows[0].size() + rows[1].size();
    if (all == 0 || all * samples.pixel.size() > kMostNumbers) return sigma;
    for (const Eigen::Index unknowns : {kSimple, kRich}) {
        PlaneFit fit(samples, width, height, unknowns);
        if (!fit.solve(samples.laser) || fit.freedom() < kFewestFreedom) continue;
        const std::array left{fit.left_of(rows[0], 0), fit.left_of(rows[1], 1)};
        Eigen::Matrix3d shares = Eigen::Matrix3d::Identity();
        Eigen::Vector3d sums(fit.squares(), 0, 0);
        shares(0, 0) = fit.freedom();
        std::array<double, 2> degrees{};
        for (std::size_t a = 0; a < 2; ++a) {
            if (rows[a].empty()) continue;
            const auto at = static_cast<Eigen::Index>(a) + 1;
            const MatrixXd own = left[a].transpose() * left[a];
            sums(at) = (left[a].transpose() * fit.residual()).squaredNorm();
            shares(at, 0) = shares(0, at) = own.trace();
            shares(at, at) = own.squaredNorm();
            degrees[a] = own.trace() * own.trace() / own.squaredNorm();
        }
        if (!rows[0].empty() && !rows[1].empty())
            shares(1, 2) = shares(2, 1) = (left[0].transpose() * left[1]).squaredNorm();
        const Eigen::Vector3d variances = shares.fullPivLu().solve(sums);
        if (!variances.allFinite() || !(variances(0) < kAsNoise * kAsNoise * noise_px * noise_px)) continue;
        const double rest = std::max(1.0, fit.freedom() - degrees[0] - degrees[1]);
        for (std::size_t a = 0; a < 2; ++a) {
            const auto at = static_cast<Eigen::Index>(a) + 1;
            const double noise = std::max(variances(0), kLeastNoise_px2);
            if (degrees[a] > 1 && variances(at) > 0 &&
                f_upper(degrees[a], rest, sums(at) / shares(at, 0) / noise) < kChance)
                sigma[a] = std::sqrt(variances(at)) * student_quantile(kUpper95, degrees[a]) /
                           normal_quantile(kUpper95);
        }
        return sigma;
    }
    return sigma;
}

std::optional<WrongGroup> wrong_group(const Samples& samples, int width, int height, double noise_px) {
    std::vector<Row> rows;
    for (const bool of_x : {true, false})
        for (auto& pairs : rows_of(samples.laser, of_x ? 0 : 1)) rows.push_back({of_x, std::move(pairs)});
    if (rows.empty()) return std::nullopt;
    for (const Eigen::Index unknowns : {kSimple, kRich})
        if (auto found = worst_row(samples, rows, PlaneFit(samples, width, height, unknowns), noise_px))
            return found;
    return std::nullopt;
}

}  // namespace seamwright::lookup_table
