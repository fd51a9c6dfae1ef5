#include "core/calibration/bundle/onto_rays.h"

#include <algorithm>
#include <cmath>

#include "core/calibration/pose/plate.h"

namespace seamwright {
namespace {

constexpr int kRotations = 60, kRounds = 60, kFewRounds = 12;
constexpr double kApart_rad = 0.02;
constexpr double kOneWay = 1e9;  // inverse of the weights across the rays: beyond, all of them run one way

struct Place {
    Pose pose = Pose::Identity();
    double squares = 0;  // of the weighted distances from the rays, mm^2
    bool before = true;  // all points on the rays' own side
};

class Alternation {
  public:
    explicit Alternation(const std::vector<SightRay>& rays) : rays_(rays) {
        Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
        for (const SightRay& r : rays) {
            across_.emplace_back(r.weight *
                                 (Eigen::Matrix3d::Identity() - r.direction * r.direction.transpose()));
            sum += across_.back();
        }
        inverse_ = sum.inverse();
    }
    bool possible() const { return inverse_.allFinite() && inverse_.cwiseAbs().maxCoeff() < kOneWay; }

    Place run(const Eigen::Matrix3d& start, int rounds) const {
        Place place;
        place.pose = with_shift(start);
        std::vector<Eigen::Vector3d> on_rays(rays_.size()), body;
        for (const SightRay& r : rays_) body.push_back(r.point_mm);
        for (int k = 0; k < rounds; ++k) {
            for (std::size_t i = 0; i < rays_.size(); ++i) {
                const Eigen::Vector3d q = place.pose * rays_[i].point_mm - rays_[i].origin_mm;
                // Behind an origin it is drawn to the ray's own side.
                on_rays[i] = rays_[i].origin_mm + std::abs(q.dot(rays_[i].direction)) * rays_[i].direction;
            }
            place.pose = with_shift(fit_rigid(on_rays, body, {}).linear());
        }
        for (std::size_t i = 0; i < rays_.size(); ++i) {
            const Eigen::Vector3d q = place.pose * rays_[i].point_mm - rays_[i].origin_mm;
            place.squares += q.dot(across_[i] * q);
            place.before = place.before && q.dot(rays_[i].direction) > 0;
        }
        return place;
    }

  private:
    Pose with_shift(const Eigen::Matrix3d& turn) const {
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (std::size_t i = 0; i < rays_.size(); ++i)
            sum += across_[i] * (rays_[i].origin_mm - turn * rays_[i].point_mm);
        return make_pose(turn, inverse_ * sum);
    }

    const std::vector<SightRay>& rays_;
    std::vector<Eigen::Matrix3d> across_;
    Eigen::Matrix3d inverse_ = Eigen::Matrix3d::Zero();
};

// Spread evenly over SO(3) (super-Fibonacci spirals, Alexa 2022).
Eigen::Matrix3d spread_rotation(int index, int count) {
    constexpr double kPhi = 1.4142135623730951, kPsi = 1.533751168755204288118041;
    const double s = index + 0.5, t = s / count;
    const double r = std::sqrt(t), big = std::sqrt(1 - t), alpha = 2 * kPi * s / kPhi,
                 beta = 2 * kPi * s / kPsi;
    return Eigen::Quaterniond(big * std::cos(beta), r * std::sin(alpha), r * std::cos(alpha),
                              big * std::sin(beta))
        .normalized()
        .toRotationMatrix();
}

}  // namespace

std::vector<Pose> onto_rays(const std::vector<SightRay>& rays, std::size_t most) {
    const Alternation alternation(rays);
    if (rays.size() < 3 || !alternation.possible()) return {};
    std::vector<Place> places;
    for (int k = 0; k < kRotations; ++k) {
        const Place place = alternation.run(spread_rotation(k, kRotations), kFewRounds);
        if (place.pose.matrix().allFinite()) places.push_back(place);
    }
    const auto better = [](const Place& a, const Place& b) {
        return a.before != b.before ? a.before : a.squares < b.squares;
    };
    std::sort(places.begin(), places.end(), better);
    places.resize(std::min(places.size(), 3 * most));
    for (Place& place : places) place = alternation.run(place.pose.linear(), kRounds);
    std::sort(places.begin(), places.end(), better);
    std::vector<Pose> apart;
    for (const Place& place : places) {
        if (!place.before || apart.size() == most) break;
        if (std::none_of(apart.begin(), apart.end(),
                         [&](const Pose& other) { return angle_rad(other, place.pose) < kApart_rad; }))
            apart.push_back(place.pose);
    }
    return apart;
}

}  // namespace seamwright
