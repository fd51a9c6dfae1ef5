#include "core/calibration/lens/bent_line.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "core/geometry/decompositions.h"
#include "core/median.h"

namespace seamwright {
namespace bent_line {
namespace {

constexpr int kTriples = 300, kRounds = 6;
constexpr double kLeastLimitPx = 1;

// Along and across the points' spread; along from -1 to 1.
std::vector<Eigen::Vector2d> in_own_axes(const std::vector<Eigen::Vector2d>& points) {
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (const auto& p : points) mean += p;
    mean /= static_cast<double>(points.size());
    double xx = 0, xy = 0, yy = 0;
    for (const auto& p : points) {
        const Eigen::Vector2d d = p - mean;
        xx += d.x() * d.x(), xy += d.x() * d.y(), yy += d.y() * d.y();
    }
    const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
    const Eigen::Vector2d along(std::cos(angle), std::sin(angle)), across(-along.y(), along.x());
    std::vector<Eigen::Vector2d> own;
    double reach = 0;
    for (const auto& p : points) {
        own.emplace_back(along.dot(p - mean), across.dot(p - mean));
        reach = std::max(reach, std::abs(own.back().x()));
    }
    if (reach > 0)
        for (auto& p : own) p.x() /= reach;
    return own;
}

double height(const Eigen::Vector3d& parabola, double u) {
    return parabola.x() + u * (parabola.y() + u * parabola.z());
}

// The parabola through three points that half of all points lie nearest to.
Eigen::Vector3d least_median(const std::vector<Eigen::Vector2d>& own, std::vector<double>& off) {
    constexpr double kApart = 0.15;  // of the half length, or the parabola is guessed beyond its points
    std::mt19937 random(11);
    std::uniform_int_distribution<std::size_t> pick(0, own.size() - 1);
    Eigen::Vector3d best = Eigen::Vector3d::Zero();
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k < kTriples; ++k) {
        const Eigen::Vector2d &p = own[pick(random)], &q = own[pick(random)], &r = own[pick(random)];
        if (std::abs(p.x() - q.x()) < kApart || std::abs(q.x() - r.x()) < kApart ||
            std::abs(r.x() - p.x()) < kApart)
            continue;
        const double pq = (q.y() - p.y()) / (q.x() - p.x()), qr = (r.y() - q.y()) / (r.x() - q.x());
        Eigen::Vector3d trial;  // Newton's form
        trial.z() = (qr - pq) / (r.x() - p.x());
        trial.y() = pq - trial.z() * (p.x() + q.x());
        trial.x() = p.y() - p.x() * (trial.y() + p.x() * trial.z());
        off.clear();
        for (const auto& point : own) off.push_back(std::abs(point.y() - height(trial, point.x())));
        if (const double middle = median(off); middle < least) {
            least = middle;
            best = trial;
        }
    }
    return best;
}

}  // namespace
}  // namespace bent_line

std::vector<char> on_bent_line(const std::vector<Eigen::Vector2d>& points) {
    using namespace bent_line;
    std::vector<char> on(points.size(), 1);
    if (points.size() < 8) return on;
    const std::vector<Eigen::Vector2d> own = in_own_axes(points);
    std::vector<double> off;
    Eigen::Vector3d parabola = least_median(own, off);
    for (int round = 0; round < kRounds; ++round) {
        off.clear();
        for (std::size_t i = 0; i < own.size(); ++i)
            if (round == 0 || on[i]) off.push_back(std::abs(own[i].y() - height(parabola, own[i].x())));
        const double limit = std::max(kLeastLimitPx, 6 * median(off));
        std::vector<char> support(own.size());
        Eigen::Index count = 0;
        for (std::size_t i = 0; i < own.size(); ++i)
            count += support[i] = std::abs(own[i].y() - height(parabola, own[i].x())) <= limit;
        if ((round > 0 && support == on) || count < 5) break;
        on = std::move(support);
        Eigen::MatrixXd a(count, 3);
        Eigen::VectorXd v(count);
        Eigen::Index row = 0;
        for (std::size_t i = 0; i < own.size(); ++i) {
            if (!on[i]) continue;
            a.row(row) << 1, own[i].x(), own[i].x() * own[i].x();
            v(row++) = own[i].y();
        }
        parabola = least_squares(a, v).x;
    }
    return on;
}

}  // namespace seamwright
