// Which sheets of a gap's profile are its two panels, and which the ground (gap_sides.h).

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/features/gap/gap_limits.h"
#include "core/features/gap/gap_sides.h"

namespace seamwright {
namespace {

using namespace gap;

constexpr double kGroundSlope = 1;  // at most
constexpr int kOfItsSize = 3;       // times the points of a smaller sheet: that one is none beside it
constexpr int kOpen = 2;            // times the size, of a pair with a hole or ground in between
constexpr int kLinePoints = 60;     // beside what divides two sheets

}  // namespace

// Ends of neighbouring sheets: b's lies deeper than a's, and b is no piece of a rim that falls.
bool GapSides::lower(const Sheet& b, const Sheet& a) const {
    const bool behind = b.first > a.first;
    const auto level = [&](const Sheet& sheet, bool last) {
        const int i = last ? sheet.last : sheet.first, step = last ? -1 : 1;
        return (points_.z[i] + points_.z[i + step]) / 2;
    };
    return level(b, !behind) < level(a, behind) - pitch_ - kNoiseGate * noise_.point_mm &&
           std::abs(points_.z[b.last] - points_.z[b.first]) <
               kGroundSlope * std::abs(points_.x[b.last] - points_.x[b.first]);
}

// Over whatever divides them: what the two show beside it lies on one line.
bool GapSides::in_line(const Sheet& a, const Sheet& b) const {
    const End before = end_of(a, true, kLinePoints), after = end_of(b, false, kLinePoints);
    const double middle = (points_.x[a.last] + points_.x[b.first]) / 2;
    const double variance = before.variance_at(middle) + after.variance_at(middle);
    return std::abs(before.at(middle) - after.at(middle)) <
           kGoesOn * noise_.point_mm * std::sqrt(noise_.apart() * variance) + pitch_;
}

// The two largest sheets with nothing as high as they are, and of their size, in between.
GapSides::Found GapSides::two_cores(int least, double panel_mm, Core& before, Core& after) {
    const auto n = sheets_.size();
    std::size_t a = n, b = n;
    int most = 0, sum = 0;
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = i + 1; j < n; ++j) {
            const int smaller = std::min(sheets_[i].count, sheets_[j].count),
                      both = sheets_[i].count + sheets_[j].count;
            bool free = smaller >= least;
            // Heads that look from either side see the ground on below the panels.
            const bool under_it = interleaved_ && points_.x[sheets_[j].first] < points_.x[sheets_[i].last];
            bool open = j == i + 1 && !under_it && is_hole(sheets_[i].last, sheets_[j].first);
            for (std::size_t k = i + 1; k < j && free; ++k) {
                const bool ground = lower(sheets_[k], sheets_[i]) && lower(sheets_[k], sheets_[j]);
                free = ground || kOfItsSize * sheets_[k].count < smaller;
                open = open || ground;
            }
            // A gap rather than a step, which a panel may have as well.
            const int weight = (open ? kOpen : 1) * smaller;
            if (!free || weight < most || (weight == most && both <= sum)) continue;
            a = i, b = j, most = weight, sum = both;
        }
    if (b == n) {
        const bool any = std::any_of(sheets_.begin(), sheets_.end(),
                                     [&](const Sheet& sheet) { return sheet.count >= least; });
        return any ? Found::one_surface : Found::no_points;
    }
    // A short one with a higher one of its size on its other side as well may be the ground of a gap.
    const auto ground = [&](std::size_t k, std::size_t panel) {
        const Sheet& sheet = sheets_[k];
        if (!lower(sheet, sheets_[panel]) ||
            std::abs(points_.x[sheet.last] - points_.x[sheet.first]) > 2 * panel_mm)
            return false;
        for (std::size_t other = 0; other < n; ++other)
            if ((other < k) != (panel < k) && other != k &&
                kOfItsSize * sheets_[other].count >= sheet.count && lower(sheet, sheets_[other]))
                return true;
        return false;
    };
    if (ground(a, b) || ground(b, a)) return Found::ambiguous;
    // What else lies as high between them is a panel's too, beyond a dark streak or a step: of the side of the ground that it
    // stands on, else of the panel whose line it continues. Where neither tells, nobody can.
    const auto under = [&](std::size_t k) {
        return lower(sheets_[k], sheets_[a]) && lower(sheets_[k], sheets_[b]);
    };
    const auto height = [&](std::size_t k) {
        return (points_.z[sheets_[k].first] + points_.z[sheets_[k].last]) / 2;
    };
    // Of what lies under both the upper half of the depth that is seen is a ledge.
    double deepest = std::numeric_limits<double>::infinity();
    for (std::size_t k = a + 1; k < b; ++k)
        if (under(k)) deepest = std::min(deepest, height(k));
    const double ledge = (std::min(height(a), height(b)) + deepest) / 2;
    const auto is_ground = [&](std::size_t k) { return under(k) && height(k) <= ledge; };
    std::size_t ground_from = n, ground_to = 0;
    for (std::size_t k = a + 1; k < b; ++k)
        if (is_ground(k)) ground_from = std::min(ground_from, k), ground_to = k;
    const bool ground_seen = ground_from < n;
    std::size_t left_first = a, left_end = a, right_begin = b, right_last = b;
    const auto as_high = [&](std::size_t k, int points) {
        const Sheet& sheet = sheets_[k];
        return sheet.count >= points && !is_ground(k) &&
               std::abs(points_.z[sheet.last] - points_.z[sheet.first]) <
                   kGroundSlope * std::abs(points_.x[sheet.last] - points_.x[sheet.first]);
    };
    const int few = std::max(kLeastGround, (least + 1) / 2);  // that lie on a panel's line
    for (std::size_t k = a + 1; k < b; ++k) {
        if (!as_high(k, few)) continue;
        const bool on_left = in_line(sheets_[left_end], sheets_[k]);
        if (!on_left && (under(k) || !as_high(k, least))) continue;
        if (ground_seen ? k > ground_from : !on_left || in_line(sheets_[k], sheets_[b])) break;
        if (!on_left) left_first = k;
        left_end = k;
    }
    for (std::size_t k = b - 1; k > left_end; --k) {
        if (!as_high(k, few)) continue;
        const bool on_right = in_line(sheets_[k], sheets_[right_begin]);
        if (!on_right && (under(k) || !as_high(k, least))) continue;
        if (ground_seen ? k < ground_to : !on_right || in_line(sheets_[a], sheets_[k])) break;
        if (!on_right) right_last = k;
        right_begin = k;
    }
    for (std::size_t k = left_end + 1; k < right_begin; ++k)
        if (as_high(k, least)) return Found::ambiguous;
    a = left_end, b = right_begin;
    before = {raw_[sheets_[left_first].first], raw_[sheets_[left_end].last]};
    after = {raw_[sheets_[right_begin].first], raw_[sheets_[right_last].last]};
    for (std::size_t k = a + 1; k < b; ++k) {
        if (!lower(sheets_[k], sheets_[a]) || !lower(sheets_[k], sheets_[b])) continue;
        // Up to the panels, as far as it is the ground's line.
        const auto until = [&](int i, int step, int stop) {
            const End end = end_of(sheets_[k], step > 0, kEndPoints);
            while (i + step != stop && std::abs(z_[i + step] - end.z - end.slope * (x_[i + step] - end.x)) <
                                           kNoiseGate * noise_.point_mm)
                i += step;
            return i;
        };
        if (ground_first_ < 0) ground_first_ = until(raw_[sheets_[k].first], -1, before.last);
        ground_last_ = until(raw_[sheets_[k].last], 1, after.first);
    }
    // A rim is steep as well: where its piece reaches neither the ground nor the other panel it is the panel's.
    if (smooths()) return Found::both;
    if (const int end = raw_[sheets_[a].piece_last]; end < (ground_first_ < 0 ? after.first : ground_first_))
        before.last = end;
    if (const int end = raw_[sheets_[b].piece_first]; end > (ground_last_ < 0 ? before.last : ground_last_))
        after.first = end;
    return Found::both;
}

}  // namespace seamwright
