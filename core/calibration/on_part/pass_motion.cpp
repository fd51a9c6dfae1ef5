#include "core/calibration/on_part/pass_motion.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>

namespace seamwright::on_part {
namespace {

constexpr std::size_t kWindow = 7;
constexpr double kBeyond = 0.02;  // of an interval
// A motion is noisy when the squares of its sixth differences are beyond so many times those of its fourth, and beyond
// those of white noise of this variance, 924 times as large.
constexpr double kNoisyTimes = 4, kNoisy_mm2 = 1e-6, kWhiteSixth = 924;

Vector6 displacement(const Pose& from, const Pose& to) {
    const Pose d = from.inverse() * to;
    Vector6 v;
    v << d.translation(), rotation_log(d.linear());
    return v;
}

Pose displaced(const Pose& from, const Vector6& by) {
    return from * make_pose(rotation_exp(by.tail<3>()), by.head<3>());
}

// Sixth differences over fourth: of a smooth motion far below one, of white noise sqrt(924 / 70) = 3.6.
bool noisy(const std::vector<Pose>& poses) {
    if (poses.size() < 2 * kWindow) return false;
    double fourth = 0, sixth = 0;
    for (std::size_t k = 0; k + 6 < poses.size(); ++k) {
        const auto p = [&](std::size_t i) -> Eigen::Vector3d { return poses[k + i].translation(); };
        fourth += (p(1) - 4 * p(2) + 6 * p(3) - 4 * p(4) + p(5)).squaredNorm();
        sixth += (p(0) - 6 * p(1) + 15 * p(2) - 20 * p(3) + 15 * p(4) - 6 * p(5) + p(6)).squaredNorm();
    }
    return sixth > kNoisyTimes * fourth &&
           sixth > kNoisy_mm2 * kWhiteSixth * static_cast<double>(poses.size());
}

}  // namespace

PassMotion::PassMotion(std::vector<double> times_s, std::vector<Pose> poses)
    : times_(std::move(times_s)), poses_(std::move(poses)), noisy_(noisy(poses_)) {}

// Cubic through seven by least squares: its noise is nearly the same at and between the samples.
Pose PassMotion::smoothed(double time_s, std::size_t nearest) const {
    const std::size_t first = std::clamp<std::size_t>(nearest, 3, times_.size() - 4) - 3;
    const Pose& centre = poses_[first + 3];
    const double unit = (times_[first + 6] - times_[first]) / 6;
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Matrix<double, 4, 6> right = Eigen::Matrix<double, 4, 6>::Zero();
    for (std::size_t k = first; k < first + kWindow; ++k) {
        const double u = (times_[k] - time_s) / unit;
        const Eigen::Vector4d powers(1, u, u * u, u * u * u);
        normal += powers * powers.transpose();
        right += powers * displacement(centre, poses_[k]).transpose();
    }
    return displaced(centre, normal.llt().solve(right).row(0).transpose());
}

Pose PassMotion::at(double time_s) const {
    const std::size_t n = times_.size();
    if (n < 2) return poses_.front();
    const auto after = std::upper_bound(times_.begin(), times_.end(), time_s);
    const std::size_t i =
        std::clamp<std::size_t>(static_cast<std::size_t>(after - times_.begin()), 1, n - 1) - 1;
    if (noisy_ && time_s >= times_.front() && time_s <= times_.back())
        return smoothed(time_s, time_s - times_[i] > times_[i + 1] - time_s ? i + 1 : i);
    if (time_s == times_[i]) return poses_[i];
    if (n < 4 || time_s < times_.front() || time_s > times_.back()) {
        const std::size_t k = time_s < times_.front() ? std::min<std::size_t>(2, n - 1) : i + 1;
        const std::size_t j = time_s > times_.back() ? n - std::min<std::size_t>(3, n) : i;
        const std::size_t from = time_s < times_.front() ? 0 : time_s > times_.back() ? n - 1 : i;
        const Vector6 rate = displacement(poses_[j], poses_[k]) / (times_[k] - times_[j]);
        return displaced(poses_[from], rate * (time_s - times_[from]));
    }
    const std::size_t first = std::min(i == 0 ? 0 : i - 1, n - 4);
    Vector6 sum = Vector6::Zero();
    for (std::size_t a = first; a < first + 4; ++a) {
        if (a == i) continue;
        double weight = 1;
        for (std::size_t b = first; b < first + 4; ++b)
            if (b != a) weight *= (time_s - times_[b]) / (times_[a] - times_[b]);
        sum += weight * displacement(poses_[i], poses_[a]);
    }
    return displaced(poses_[i], sum);
}

Vector6 PassMotion::twist(double time_s) const {
    if (!timed()) return Vector6::Zero();
    const double h = 0.5 * (times_.back() - times_.front()) / static_cast<double>(times_.size() - 1);
    return displacement(at(time_s - h), at(time_s + h)) / (2 * h);
}

bool PassMotion::inside(double time_s) const {
    if (!timed()) return true;
    return time_s >= times_.front() - kBeyond * (times_[1] - times_[0]) &&
           time_s <= times_.back() + kBeyond * (times_.back() - times_[times_.size() - 2]);
}

}  // namespace seamwright::on_part
