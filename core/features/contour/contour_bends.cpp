#include "core/features/contour/contour_bends.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/features/contour/contour_noise.h"

namespace seamwright {
namespace {

constexpr std::size_t kNodes = 600;
constexpr double kStretchCost = 60;
constexpr int kFewestNodes = 3;
constexpr int kManyNodes = 12;          // of a stretch that knows the noise
constexpr double kTurnSigma = 6;        // what a turn must be beside its own uncertainty
constexpr double kNoiseOfStep = 0.005;  // floor of the noise, in steps between nodes
constexpr double kShortStretch = 0.25;  // of the stretches beside: part of a radius
constexpr double kMeetAway = 0.5;       // of the shorter stretch: so far off its end lines may meet
constexpr double kMoreNoise = 1.1;
constexpr double kMeetSigma = 8;
constexpr double kMeetBeside = 1.5;  // steps: three points on a radius do not have its direction at their end

enum class Joint : std::uint8_t { smooth, bend, jump };

double turn_between(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
}

}  // namespace

void ContourBends::take_nodes(std::span<const double> x, std::span<const double> z) {
    const std::size_t n = std::min(x.size(), z.size());
    const std::size_t group = n <= kNodes ? 1 : (n + kNodes - 1) / kNodes;
    node_x_.clear();
    node_z_.clear();
    node_first_.clear();
    const auto middle = [&](std::span<const double> values, std::size_t first, std::size_t count) {
        scratch_.assign(values.begin() + std::ptrdiff_t(first),
                        values.begin() + std::ptrdiff_t(first + count));
        const auto at = scratch_.begin() + std::ptrdiff_t(count / 2);
        std::nth_element(scratch_.begin(), at, scratch_.end());
        if (count % 2) return *at;
        return 0.5 * (*at + *std::max_element(scratch_.begin(), at));
    };
    for (std::size_t first = 0; first < n; first += group) {
        const std::size_t count = std::min(group, n - first);
        node_first_.push_back(static_cast<int>(first));
        node_x_.push_back(middle(x, first, count));
        node_z_.push_back(middle(z, first, count));
    }
    node_first_.push_back(static_cast<int>(n));
}

ContourBends::Stretch ContourBends::stretch(int first, int last) const {
    const double m = last - first + 1;
    std::array<double, 5> s;
    for (std::size_t j = 0; j < 5; ++j)
        s[j] = (sums_[std::size_t(last) + 1][j] - sums_[std::size_t(first)][j]) / m;
    const double xx = s[2] - s[0] * s[0], xz = s[3] - s[0] * s[1], zz = s[4] - s[1] * s[1];
    const double angle = 0.5 * std::atan2(2 * xz, xx - zz);
    Stretch r;
    r.first = first;
    r.last = last;
    r.centre = {s[0] + node_x_[0], s[1] + node_z_[0]};
    r.direction = {std::cos(angle), std::sin(angle)};
    const auto node = [&](int i) {
        return Eigen::Vector2d(node_x_[std::size_t(i)], node_z_[std::size_t(i)]);
    };
    if (r.direction.dot(node(last) - node(first)) < 0) r.direction = -r.direction;
    r.begin = r.direction.dot(node(first) - r.centre);
    r.end = r.direction.dot(node(last) - r.centre);
    return r;
}

// The division of least cost, its stretches of four nodes and more.
void ContourBends::divide() {
    const int n = static_cast<int>(node_x_.size());
    sums_.assign(static_cast<std::size_t>(n) + 1, {});
    double way = 0;
    for (int i = 0; i < n; ++i) {
        const double x = node_x_[std::size_t(i)] - node_x_[0], z = node_z_[std::size_t(i)] - node_z_[0];
        const auto& b = sums_[std::size_t(i)];
        sums_[std::size_t(i) + 1] = {b[0] + x, b[1] + z, b[2] + x * x, b[3] + x * z, b[4] + z * z};
        if (i > 0)
            way += std::hypot(node_x_[std::size_t(i)] - node_x_[std::size_t(i) - 1],
                              node_z_[std::size_t(i)] - node_z_[std::size_t(i) - 1]);
    }
    // Neighbours that share their noise hide it, and a stretch of them knows its line no better than the few they count as.
    const ProfileNoise noise = profile_noise(node_x_, node_z_, scratch_, SharedOver::many);
    noise_ = std::max(
        {noise.point_mm, noise.alone_mm * std::sqrt(noise.apart()), kNoiseOfStep * way / std::max(n - 1, 1)});
    // Smallest eigenvalue of the scatter: the sum of squared distances from the line.
    const auto misfit = [&](int a, int b) {
        const double m = b - a;
        std::array<double, 5> s;
        for (std::size_t j = 0; j < 5; ++j) s[j] = sums_[std::size_t(b)][j] - sums_[std::size_t(a)][j];
        const double xx = s[2] - s[0] * s[0] / m, xz = s[3] - s[0] * s[1] / m, zz = s[4] - s[1] * s[1] / m;
        return std::max(0.5 * (xx + zz) - std::hypot(0.5 * (xx - zz), xz), 0.0);
    };
    for (const bool again : {false, true}) {
        cost_.assign(static_cast<std::size_t>(n) + 1, std::numeric_limits<double>::infinity());
        from_.assign(static_cast<std::size_t>(n) + 1, 0);
        cost_[0] = 0;
        const double unit = 1 / (noise_ * noise_);
        for (int b = 1; b <= n; ++b)
            for (int a = 0; a < b; ++a) {
                if (cost_[std::size_t(a)] + kStretchCost >= cost_[std::size_t(b)]) continue;
                const double c = cost_[std::size_t(a)] + kStretchCost + (b - a > 2 ? misfit(a, b) * unit : 0);
                if (c < cost_[std::size_t(b)]) cost_[std::size_t(b)] = c, from_[std::size_t(b)] = a;
            }
        // Noise that runs from point to point shows in the long stretches only.
        double square = 0, freedom = 0;
        for (int b = n; b > 0; b = from_[std::size_t(b)])
            if (const int a = from_[std::size_t(b)]; b - a >= kManyNodes)
                square += misfit(a, b), freedom += b - a - 2;
        const double rms = freedom > 0 ? std::sqrt(square / freedom) : 0;
        if (again || !(rms > kMoreNoise * noise_)) break;
        noise_ = rms;
    }
    stretches_.clear();
    for (int b = n; b > 0; b = from_[std::size_t(b)])
        if (b - from_[std::size_t(b)] >= kFewestNodes)
            stretches_.push_back(stretch(from_[std::size_t(b)], b - 1));
    std::reverse(stretches_.begin(), stretches_.end());
}

const std::vector<Bend>& ContourBends::find(std::span<const double> x, std::span<const double> z,
                                            double least_angle_rad, double blend_mm) {
    bends_.clear();
    take_nodes(x, z);
    if (node_x_.size() < 2 * kFewestNodes) return bends_;
    divide();
    std::erase_if(stretches_, [&](const Stretch& s) { return s.length() < 2 * blend_mm; });
    const auto uncertain = [&](const Stretch& s) {
        const double nodes = s.last - s.first + 1, length = std::max(s.length(), noise_);
        return 12 * noise_ * noise_ / (nodes * length * length);
    };
    const auto turns = [&](const Stretch& a, const Stretch& b) {
        return std::abs(turn_between(a.direction, b.direction)) >=
               std::max(least_angle_rad, kTurnSigma * std::sqrt(uncertain(a) + uncertain(b)));
    };
    // A stretch too short to know its own direction, of a small radius, hides the turn between its neighbours.
    for (std::size_t i = 1; i + 1 < stretches_.size();) {
        const Stretch &before = stretches_[i - 1], &here = stretches_[i], &after = stretches_[i + 1];
        if (!turns(before, here) && !turns(here, after) && turns(before, after))
            stretches_.erase(stretches_.begin() + std::ptrdiff_t(i));
        else
            ++i;
    }
    const std::size_t m = stretches_.size();
    if (m < 2) return bends_;

    // Where the lines of two stretches meet, and whether that is between them.
    const auto meet = [&](const Stretch& a, const Stretch& b, Eigen::Vector2d& place) {
        const double sine = a.direction.x() * b.direction.y() - a.direction.y() * b.direction.x();
        const Eigen::Vector2d d = b.centre - a.centre;
        const double s = (d.x() * b.direction.y() - d.y() * b.direction.x()) / sine;
        const double t = (d.x() * a.direction.y() - d.y() * a.direction.x()) / sine;
        place = a.centre + s * a.direction;
        // They meet anywhere up to the next node; nodes of a radius that are no stretch may stand in between.
        const auto step = [](const Stretch& of) { return of.length() / (of.last - of.first); };
        const double beside = (b.first - a.last + kMeetBeside) * std::max(step(a), step(b));
        const double free = 2 * blend_mm + kMeetAway * std::min(a.length(), b.length()) + beside +
                            kMeetSigma * noise_ / std::abs(sine);
        return std::abs(s - a.end) < free && std::abs(t - b.begin) < free;
    };
    joint_.assign(m, static_cast<std::uint8_t>(Joint::smooth));  // behind every stretch
    for (std::size_t i = 0; i + 1 < m; ++i) {
        const Stretch &a = stretches_[i], &b = stretches_[i + 1];
        const double turn = turn_between(a.direction, b.direction);
        Joint joint = Joint::smooth;
        Eigen::Vector2d place;
        if (turns(a, b))
            joint = meet(a, b, place) ? Joint::bend : Joint::jump;
        else {
            // One beside the other: a step.
            const Eigen::Vector2d gap = b.centre + b.begin * b.direction - a.centre - a.end * a.direction;
            const double off = std::abs(a.direction.x() * gap.y() - a.direction.y() * gap.x());
            if (off > kMeetSigma * noise_ + std::abs(std::sin(turn)) * gap.norm()) joint = Joint::jump;
        }
        joint_[i] = static_cast<std::uint8_t>(joint);
    }
    const auto is = [&](std::size_t i, Joint j) { return joint_[i] == static_cast<std::uint8_t>(j); };
    // Stretches that go on smoothly are one piece: its last stretch.
    const auto piece_end = [&](std::size_t i) {
        while (i + 1 < m && is(i, Joint::smooth)) ++i;
        return i;
    };
    const auto turn_behind = [&](std::size_t i) {
        return turn_between(stretches_[i].direction, stretches_[i + 1].direction);
    };
    const auto longest = [&](std::size_t from, std::size_t end) {
        double length = 0;
        for (; from < end; ++from) length = std::max(length, stretches_[from].length());
        return length;
    };
    // A short piece from..to between bends to one side belongs to a radius.
    const auto of_radius = [&](std::size_t from, std::size_t to) {
        if (from == 0 || to + 1 >= m || !is(from - 1, Joint::bend) || !is(to, Joint::bend)) return false;
        if (turn_behind(from - 1) * turn_behind(to) <= 0) return false;
        double length = 0;
        for (std::size_t k = from; k <= to; ++k) length += stretches_[k].length();
        return length < kShortStretch * std::min(longest(0, from), longest(to + 1, m));
    };
    for (std::size_t first = 0, before = 0; (before = piece_end(first)) + 1 < m;) {
        std::size_t begin = before + 1, last = piece_end(begin);
        if (!is(before, Joint::bend)) {
            first = begin;
            continue;
        }
        while (of_radius(begin, last)) begin = last + 1, last = piece_end(begin);
        // Next to the bend a piece may begin with what is left of a radius.
        std::size_t left = before, right = begin;
        while (left > first && stretches_[left].length() < kShortStretch * longest(first, before + 1)) --left;
        while (right < last && stretches_[right].length() < kShortStretch * longest(begin, last + 1)) ++right;
        Bend bend;
        bend.turn_rad = 0;
        for (std::size_t k = left; k < right; ++k) bend.turn_rad += turn_behind(k);
        if (std::abs(bend.turn_rad) < std::numbers::pi &&
            meet(stretches_[left], stretches_[right], bend.place)) {
            const int end = stretches_[left].last, behind = stretches_[right].first;
            bend.first = node_first_[std::size_t(stretches_[first].first)];
            bend.last = node_first_[std::size_t(stretches_[last].last) + 1] - 1;
            bend.split = node_first_[std::size_t((end + 1 + behind + (behind > end)) / 2)];
            bends_.push_back(bend);
        }
        first = begin;
    }
    return bends_;
}

}  // namespace seamwright
