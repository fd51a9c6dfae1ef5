#include "core/calibration/sphere/circle_section.h"
#include "core/geometry/pose.h"
#include "core/median.h"
#include "core/numbers.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <random>

namespace seamwright {
namespace {

constexpr double kVanishing = 1e-9;  // of a length, a step or a pivot, in millimetres or relative
// Noise of a profile's z: what is taken where too few points tell, and the least and most that is believed.
constexpr std::size_t kFewestBends = 8;
constexpr double kNoiseUntold_mm = 0.05, kLeastProfileNoise_mm = 0.002, kMostNoise_mm = 0.3;
// Points within so many noises of a circle are its own; the band is never narrower.
constexpr double kBandNoises = 4, kLeastBand_mm = 0.03, kLeastRefinedBand_mm = 0.02;
// A triple's circle is rough: it may be beyond the limits by so much, and its arc shorter.
constexpr double kRoughSmaller = 0.7, kRoughLarger = 1.4, kRoughArcShare = 0.4;
// A circle that holds this share of all points has been hit many times by the fewest trials.
constexpr double kClearShare = 0.33;

struct Circle {
    double x = 0, z = 0, r = 0;
};

struct Points {
    std::vector<double> x, z;
    std::vector<int> index;  // into the profile
    int size() const { return static_cast<int>(x.size()); }
};

// hypot() guards against overflow at ten times the cost; profiles are millimetres.
double distance(double dx, double dz) {
    return std::sqrt(dx * dx + dz * dz);
}

// Standard deviation of z from second differences along the sensor order: a smooth contour cancels, noise
// does not (variance of z0 - 2 z1 + z2 is 6 sigma^2). The median keeps jumps and corners out.
double noise_from_second_differences(const Points& p) {
    std::vector<double> d;
    d.reserve(p.x.size());
    for (int i = 1; i + 1 < p.size(); ++i) {
        const auto k = static_cast<size_t>(i);
        if (p.index[k + 1] - p.index[k - 1] != 2) continue;
        d.push_back(std::abs(p.z[k - 1] - 2 * p.z[k] + p.z[k + 1]));
    }
    if (d.size() < kFewestBends) return kNoiseUntold_mm;
    return median(d) * kMadToSigma / std::sqrt(6.0);
}

bool circle_through(const Points& p, int i, int j, int k, Circle& out) {
    const auto a = static_cast<size_t>(i), b = static_cast<size_t>(j), c = static_cast<size_t>(k);
    const double x1 = p.x[b] - p.x[a], z1 = p.z[b] - p.z[a], x2 = p.x[c] - p.x[a], z2 = p.z[c] - p.z[a];
    const double det = 2 * (x1 * z2 - x2 * z1);
    if (std::abs(det) < kVanishing * kVanishing) return false;
    const double q1 = x1 * x1 + z1 * z1, q2 = x2 * x2 + z2 * z2;
    const double cx = (q1 * z2 - q2 * z1) / det, cz = (x1 * q2 - x2 * q1) / det;
    out = {p.x[a] + cx, p.z[a] + cz, std::hypot(cx, cz)};
    return true;
}

// Truncated squares over every `stride`-th point: each point within the band earns 1 - (e / band)^2.
double score(const Points& p, const Circle& c, double band, int stride) {
    double sum = 0;
    // | |p - c| - r | < band without a root for the many points far away.
    const double outer = (c.r + band) * (c.r + band);
    const double inner = c.r > band ? (c.r - band) * (c.r - band) : 0;
    for (size_t i = 0; i < p.x.size(); i += static_cast<size_t>(stride)) {
        const double dx = p.x[i] - c.x, dz = p.z[i] - c.z, d2 = dx * dx + dz * dz;
        if (d2 > outer || d2 < inner) continue;
        const double e = (std::sqrt(d2) - c.r) / band;
        sum += 1 - e * e;
    }
    return sum;
}

void choose_inliers(const Points& p, const Circle& c, double band, std::vector<int>& inliers) {
    inliers.clear();
    for (int i = 0; i < p.size(); ++i) {
        const auto k = static_cast<size_t>(i);
        if (std::abs(distance(p.x[k] - c.x, p.z[k] - c.z) - c.r) < band) inliers.push_back(i);
    }
}

// Geometric least squares by Gauss-Newton; returns the standard deviation of the radial residual, < 0 on
// failure.
double fit(const Points& p, const std::vector<int>& inliers, Circle& c) {
    double squares = 0;
    for (int iteration = 0; iteration < 8; ++iteration) {
        Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
        Eigen::Vector3d g = Eigen::Vector3d::Zero();
        squares = 0;
        for (int i : inliers) {
            const auto k = static_cast<size_t>(i);
            const double dx = p.x[k] - c.x, dz = p.z[k] - c.z, d = distance(dx, dz);
            if (d < kVanishing) return -1;
            const Eigen::Vector3d j(-dx / d, -dz / d, -1);
            const double e = d - c.r;
            h.noalias() += j * j.transpose();
            g += j * e;
            squares += e * e;
        }
        const Eigen::LDLT<Eigen::Matrix3d> ldlt(h);
        if (ldlt.info() != Eigen::Success ||
            ldlt.vectorD().minCoeff() < kVanishing * static_cast<double>(inliers.size()))
            return -1;
        Eigen::Vector3d step = -ldlt.solve(g);
        if (!step.allFinite()) return -1;
        const double limit = 0.5 * c.r;  // a short arc throws the first step far out
        if (step.norm() > limit) step *= limit / step.norm();
        c.x += step[0];
        c.z += step[1];
        c.r += step[2];
        if (c.r <= 0) return -1;
        if (step.norm() < kVanishing * c.r) break;
    }
    return std::sqrt(squares / std::max<double>(1, static_cast<double>(inliers.size()) - 3));
}

}  // namespace

CircleSectionLimits limits_of_sphere(double radius_mm) {
    // Beyond the radius by a hundredth and what noise does to a small one; a cut nearer to the pole is too flat an arc.
    constexpr double kLarger = 1.01, kNoise_mm = 0.1, kSmallestShare = 0.12;
    CircleSectionLimits limits;
    limits.largest_radius_mm = kLarger * radius_mm + kNoise_mm;
    limits.smallest_radius_mm = kSmallestShare * radius_mm;
    return limits;
}

std::optional<CircleSection> find_circle_section(const Profile& profile, const CircleSectionLimits& limits) {
    Points p;
    for (size_t i = 0; i < profile.size(); ++i) {
        if (!std::isfinite(profile.x_mm[i]) || !std::isfinite(profile.z_mm[i])) continue;
        p.x.push_back(profile.x_mm[i]);
        p.z.push_back(profile.z_mm[i]);
        p.index.push_back(static_cast<int>(i));
    }
    const int n = p.size();
    if (n < limits.fewest_points) return std::nullopt;
    const double noise = std::clamp(noise_from_second_differences(p), kLeastProfileNoise_mm, kMostNoise_mm);
    const double band = std::max(kBandNoises * noise, kLeastBand_mm);

    // Triples spread over a window of the sensor order: the sphere's points are neighbours, whatever else is
    // there.
    std::mt19937 random(20240607u);
    const auto below = [&random](int m) { return static_cast<int>(random() % static_cast<unsigned>(m)); };
    // Arc length that the points of a circle must cover; a piece of table passes for a huge circle's short
    // arc.
    std::vector<double> steps;
    for (int i = 1; i < n; ++i)
        steps.push_back(std::abs(p.x[static_cast<size_t>(i)] - p.x[static_cast<size_t>(i) - 1]));
    const double step = median(steps);
    struct Candidate {
        double score = 0;
        Circle circle;
    };
    constexpr size_t kKept = 5;
    std::vector<Candidate> best;
    const int stride = std::max(1, n / 160);
    constexpr int kTrials = 400, kFewestTrials = 150;
    for (int trial = 0; trial < kTrials; ++trial) {
        if (trial >= kFewestTrials && !best.empty() && best.front().score * stride > kClearShare * n) break;
        const int smallest = std::max(4, n / 25);
        const int window = trial % 4 == 3 ? n : std::min(n, smallest + below(std::max(1, n / 2)));
        if (window < 3) continue;
        const int start = below(n - window + 1);
        const int third = std::max(1, window / 3);
        const int i = start + below(third), j = start + third + below(third);
        const int k = start + std::min(window - 1, 2 * third + below(std::max(1, window - 2 * third)));
        Circle circle;
        if (i == j || j == k || i == k || !circle_through(p, i, j, k, circle)) continue;
        if (circle.r < kRoughSmaller * limits.smallest_radius_mm ||
            circle.r > kRoughLarger * limits.largest_radius_mm)
            continue;
        const double value = score(p, circle, 2 * band, stride);
        if (value * stride * step < kRoughArcShare * limits.smallest_arc_rad * circle.r) continue;
        if (best.size() == kKept && value <= best.back().score) continue;
        if (best.size() == kKept) best.pop_back();
        best.insert(std::upper_bound(best.begin(), best.end(), value,
                                     [](double v, const Candidate& c) { return v > c.score; }),
                    {value, circle});
    }

    std::optional<CircleSection> found;
    double found_score = 0;
    std::vector<int> inliers, previous;
    for (const auto& candidate : best) {
        Circle c = candidate.circle;
        double width = 2 * band, sigma = -1;
        previous.clear();
        for (int round = 0; round < 12; ++round) {
            choose_inliers(p, c, width, inliers);
            if (static_cast<int>(inliers.size()) < limits.fewest_points) {
                sigma = -1;
                break;
            }
            if (inliers == previous) break;
            sigma = fit(p, inliers, c);
            if (sigma < 0) break;
            previous = inliers;
            width = std::clamp(kBandNoises * sigma, kLeastRefinedBand_mm, 2 * band);
        }
        if (sigma < 0 || c.r < limits.smallest_radius_mm || c.r > limits.largest_radius_mm) continue;
        Eigen::Vector2d mean = Eigen::Vector2d::Zero();
        for (int i : inliers) {
            const auto k = static_cast<size_t>(i);
            mean += Eigen::Vector2d(p.x[k] - c.x, p.z[k] - c.z) / c.r;
        }
        mean /= static_cast<double>(inliers.size());
        const double toward = std::atan2(mean.y(), mean.x());
        double low = 0, high = 0;
        for (int i : inliers) {
            const auto k = static_cast<size_t>(i);
            const double angle = std::remainder(std::atan2(p.z[k] - c.z, p.x[k] - c.x) - toward, 2 * kPi);
            low = std::min(low, angle);
            high = std::max(high, angle);
        }
        if (high - low < limits.smallest_arc_rad) continue;
        const double value = score(p, c, band, 1);
        if (value <= found_score) continue;
        found_score = value;
        CircleSection section{c.x, c.z, c.r, sigma, high - low, mean.y(), {}};
        for (int i : inliers) section.inliers.push_back(p.index[static_cast<size_t>(i)]);
        found = std::move(section);
    }
    return found;
}

}  // namespace seamwright
