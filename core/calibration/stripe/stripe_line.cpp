#include "core/calibration/stripe/stripe_line.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

namespace seamwright::detail {
namespace {

struct Line {
    Eigen::Vector2d point = Eigen::Vector2d::Zero(), direction = Eigen::Vector2d::UnitX();
    double distance(const Eigen::Vector2d& p) const {
        const Eigen::Vector2d d = p - point;
        return std::abs(d.x() * direction.y() - d.y() * direction.x());
    }
};

Line fit(const std::vector<Eigen::Vector2d>& points, const std::vector<std::size_t>& chosen) {
    Line l;
    for (const auto i : chosen) l.point += points[i];
    l.point /= static_cast<double>(chosen.size());
    double xx = 0, xy = 0, yy = 0;
    for (const auto i : chosen) {
        const Eigen::Vector2d d = points[i] - l.point;
        xx += d.x() * d.x();
        xy += d.x() * d.y();
        yy += d.y() * d.y();
    }
    const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
    l.direction = {std::cos(angle), std::sin(angle)};
    return l;
}

// Best peak of every scan line within the tolerance.
std::vector<std::size_t> support(const std::vector<Eigen::Vector2d>& points, const std::vector<int>& line,
                                 const std::vector<char>& taken, const Line& l, double tolerance) {
    std::map<int, std::pair<double, std::size_t>> best;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (taken[i]) continue;
        const double d = l.distance(points[i]);
        if (d > tolerance) continue;
        const auto [at, fresh] = best.try_emplace(line[i], d, i);
        if (!fresh && d < at->second.first) at->second = {d, i};
    }
    std::vector<std::size_t> out;
    for (const auto& [k, v] : best) out.push_back(v.second);
    return out;
}

}  // namespace

std::vector<PlateStripe> stripe_lines(const std::vector<Eigen::Vector2d>& straight,
                                      const std::vector<int>& line, double tolerance_px, int most) {
    constexpr std::size_t kFewestPoints = 30;  // of a stripe
    constexpr double kLeastApart_px = 30;      // of two points that a line is tried through
    constexpr double kTrialWithin = 0.6;       // of the tolerance: near a trial line
    constexpr int kLongestGap = 20;            // scan lines off the line that still are the stripe's
    std::vector<PlateStripe> out;
    std::vector<char> taken(straight.size(), 0);
    std::mt19937 random(7);
    while (static_cast<int>(out.size()) < most) {
        std::vector<std::size_t> left;
        for (std::size_t i = 0; i < straight.size(); ++i)
            if (!taken[i]) left.push_back(i);
        if (left.size() < kFewestPoints) break;
        Line best;
        std::size_t best_count = 0;
        std::uniform_int_distribution<std::size_t> pick(0, left.size() - 1);
        for (int trial = 0; trial < 400; ++trial) {
            const auto a = left[pick(random)], b = left[pick(random)];
            const double apart = (straight[a] - straight[b]).norm();
            if (apart < kLeastApart_px) continue;
            Line l;
            l.point = straight[a];
            l.direction = (straight[b] - straight[a]) / apart;
            std::size_t count = 0;
            int last = -1;
            for (const auto i : left)  // scan lines, not peaks, are counted
                if (line[i] != last && l.distance(straight[i]) < kTrialWithin * tolerance_px) {
                    ++count;
                    last = line[i];
                }
            if (count > best_count) {
                best_count = count;
                best = l;
            }
        }
        if (best_count < kFewestPoints) break;
        std::vector<std::size_t> on;
        for (int i = 0; i < 5; ++i) {
            on = support(straight, line, taken, best, tolerance_px);
            if (on.size() < kFewestPoints) break;
            best = fit(straight, on);
        }
        if (on.size() < kFewestPoints) break;
        PlateStripe stripe;
        stripe.on = on;
        // Scan lines between the line's ends that have peaks, all of them off the line.
        std::vector<int> seen(line);
        std::sort(seen.begin(), seen.end());
        seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
        std::size_t k = 0;
        int run = 0;
        for (const int s : seen) {
            if (s < line[on.front()] || s > line[on.back()]) continue;
            while (k < on.size() && line[on[k]] < s) ++k;
            if (k < on.size() && line[on[k]] == s) {
                if (run < kLongestGap) stripe.missed += run;
                run = 0;
            } else {
                ++run;
            }
        }
        for (const auto i : on) taken[i] = 1;
        out.push_back(std::move(stripe));
    }
    std::stable_sort(out.begin(), out.end(),
                     [](const auto& a, const auto& b) { return a.on.size() > b.on.size(); });
    return out;
}

}  // namespace seamwright::detail
