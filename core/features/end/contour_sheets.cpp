#include "core/features/end/contour_sheets.h"

#include <algorithm>
#include <cmath>

#include "core/numbers.h"
#include "core/profile/no_return.h"

namespace seamwright {
namespace {

// Points as they were measured: what an interpolation has put in between does not count.
constexpr int kHoleLines = 6;
constexpr double kByChance = 1e-5;
constexpr int kStepSide = 12, kStepShort = 6, kStepFewest = 4, kStepBetween = 2;
constexpr double kStepSigma = 6;
constexpr double kWorthLooking = 0.3;  // of kStepSigma: lower jumps are none
constexpr double kInterpolatedApart =
    2.0 / 3;  // points so many lines apart, over ProfileNoise::apart() of lines between them
constexpr double kEvenly = 0.01, kFewSteps = 20;  // steps of a grid
constexpr double kGoesOn = 5;                     // sigma
constexpr double kCloseUp = 4;                    // sigma
constexpr double kRisen = 0.75;
constexpr double kStepRms = 1.6;     // sigma: a side that is no line
constexpr double kBentPitch = 0.02;  // of the pitch, that it is off beside its noise
// Slope, by the measured points in between: what stands between two sheets is no surface to follow.
constexpr double kSteepWall[] = {0, 2, 2.5};
double steep_wall(double between) {
    const double one = std::clamp(between, 0.0, 1.0), two = std::clamp(between - 1, 0.0, 1.0);
    return kSteepWall[0] + one * (kSteepWall[1] - kSteepWall[0]) + two * (kSteepWall[2] - kSteepWall[1]);
}
constexpr double kUpperHalf = 0.55;  // of the step, from above
constexpr double kShadow = 0.6;      // of a step's height: so far a higher sheet may hide the lower one
constexpr double kCoverSigma = 4;
constexpr std::size_t kFragments = 4;  // pieces between a sheet and the one that hides it
constexpr double kLeastPitch_mm = 1e-12, kLeastAdvance_mm2 = 1e-24;  // the latter squared
constexpr int kRimLines = 5;  // an end nearer to the field's rim is none

}  // namespace

// Noise that is shared smears a step; it fills no hole.
ContourSheets::Lines::Lines(double measured_apart, double shared)
    : apart(std::max(measured_apart, shared)),
      hole(static_cast<int>(std::ceil(kHoleLines * measured_apart))),
      side(lines(kStepSide)),
      shorter(lines(kStepShort)),
      between(lines(kStepBetween)) {}

int ContourSheets::Lines::lines(int measured) const {
    return static_cast<int>(std::ceil(measured * apart));
}

// Straight line over the line number through the points from..to, taken at `at`, by the running sums.
ContourSheets::Side ContourSheets::side(int from, int to, double at) const {
    Side s;
    const double n = to - from + 1;
    if (n < kStepFewest) return s;
    Sums m;
    for (std::size_t j = 0; j < m.size(); ++j) m[j] = (sums_[to + 1][j] - sums_[from][j]) / n;
    const double kk = m[3] - m[0] * m[0], kx = m[4] - m[0] * m[1], kz = m[5] - m[0] * m[2];
    s.vx = kx / kk, s.vz = kz / kk;
    const double ahead = at - m[0];
    s.x = m[1] + ahead * s.vx, s.z = m[2] + ahead * s.vz;
    s.variance = (1 + ahead * ahead / kk) / n;
    const double xx = m[6] - m[1] * m[1], xz = m[7] - m[1] * m[2], zz = m[8] - m[2] * m[2];
    const double square = s.vx * s.vx * zz - 2 * s.vx * s.vz * xz + s.vz * s.vz * xx;
    const double length2 = std::max(s.vx * s.vx + s.vz * s.vz, kLeastAdvance_mm2);
    s.rms = std::sqrt(std::max(square / length2, 0.0) * n / (n - 2));
    s.spacing = std::sqrt(length2);
    s.ok = true;
    return s;
}

// How far the lines before and behind miss each other behind point i, `between` points standing there.
ContourSheets::Jump ContourSheets::jump(int i, int between, int points, bool over_hole) const {
    Jump j;
    const int next = i + 1 + between, n = static_cast<int>(all_x_.size());
    if (next >= n || (line_[next] - line_[i] > lines_.hole && !over_hole)) return j;
    if (between == 0 && run_[next] == 1 && !over_hole) return j;
    int from = i - std::min(run_[i], points) + 1, to = next;
    while (to + 1 < n && to - next + 1 < points && run_[to + 1] > 1) ++to;
    for (int k = from; k < i; ++k)
        if (cut_[k]) from = k + 1;
    for (int k = to - 1; k >= next; --k)
        if (cut_[k]) to = k;
    const double at = 0.5 * (line_[i] + line_[next]) - first_line_;
    const Side a = side(from, i, at), b = side(next, to, at);
    if (!a.ok || !b.ok) return j;
    const double gx = b.x - a.x, gz = b.z - a.z;
    const double off_a = std::abs(a.vx * gz - a.vz * gx) / a.spacing;
    const double off_b = std::abs(b.vx * gz - b.vz * gx) / b.spacing;
    j.height = std::min(off_a, off_b);
    const double dx = all_x_[next] - all_x_[i], dz = all_z_[next] - all_z_[i];
    j.risen =
        std::min(std::abs(a.vx * dz - a.vz * dx) / a.spacing, std::abs(b.vx * dz - b.vz * dx) / b.spacing);
    j.lines = line_[next] - line_[i];
    j.spread = std::sqrt(a.variance + b.variance);
    j.rms = std::max(a.rms, b.rms);
    j.longer = std::max(a.spacing, b.spacing);
    j.shorter = std::min(a.spacing, b.spacing);
    return j;
}

// Height of the step, or 0 where noise, a sharp edge or a flank explains it.
double ContourSheets::step(const Jump& over_all, int i, int between) const {
    if (!(over_all.height > 0)) return 0;
    if (over_all.height < kWorthLooking * kStepSigma * noise_ * over_all.spread) return 0;
    const auto bent = [&](const Jump& j) { return j.rms > kStepRms * noise_ + kBentPitch * pitch_.distance; };
    // The last points of a rim that rolls away from a lower sheet stand in between as well, all of them in the upper half.
    if (between > 1) {
        const double a = all_z_[i], b = all_z_[i + 1 + between], top = std::max(a, b);
        const double least = *std::min_element(&all_z_[i + 1], &all_z_[i + between] + 1);
        if (top - least < kUpperHalf * std::abs(a - b)) return 0;
    }
    const Jump close = jump(i, between, lines_.shorter);
    const Jump& j = bent(over_all) ? close : over_all;
    if (!(j.height > 0) || bent(j)) return 0;
    // On a radius the lines miss each other the less the shorter they are.
    if (close.height < kCloseUp * noise_ * close.spread) return 0;
    if (!(j.height > std::max(kStepSigma * noise_ * j.spread, j.lines * j.longer))) return 0;
    // On a flank the points themselves rise by less than the lines miss each other.
    if (j.risen < kRisen * j.height - 3 * noise_) return 0;
    return j.height < steep_wall((between + 1) / lines_.apart - 1) * j.lines * j.shorter ? 0 : j.height;
}

// Of neighbouring places the highest.
void ContourSheets::find_steps() {
    const int n = static_cast<int>(all_x_.size());
    // Coordinates from the middle of the list, where the sums keep their digits.
    sums_.assign(static_cast<std::size_t>(n) + 1, Sums{});
    run_.assign(static_cast<std::size_t>(n), 1);
    const double k0 = n > 0 ? line_[n / 2] : 0, x0 = n > 0 ? all_x_[n / 2] : 0,
                 z0 = n > 0 ? all_z_[n / 2] : 0;
    for (int i = 0; i < n; ++i) {
        const double k = line_[i] - k0, x = all_x_[i] - x0, z = all_z_[i] - z0;
        const Sums term{k, x, z, k * k, k * x, k * z, x * x, x * z, z * z};
        for (std::size_t j = 0; j < term.size(); ++j) sums_[i + 1][j] = sums_[i][j] + term[j];
        if (i > 0 && line_[i] - line_[i - 1] <= lines_.hole && !pitch_.is_gap(all_x_[i] - all_x_[i - 1], 0))
            run_[i] = std::min(run_[i - 1] + 1, lines_.side);
    }
    first_line_ = k0;
    jumps_.clear();
    scratch_.clear();
    for (int i = 0; i + 1 < n; ++i) {
        jumps_.push_back(jump(i, 0, lines_.side));
        if (jumps_.back().spread > 0) scratch_.push_back(jumps_.back().height / jumps_.back().spread);
    }
    // What the lines miss each other by all over the profile is noise, however its points depend on another.
    if (scratch_.size() >= 8) {
        const auto middle = scratch_.begin() + static_cast<std::ptrdiff_t>(scratch_.size() / 2);
        std::nth_element(scratch_.begin(), middle, scratch_.end());
        noise_ = std::max(noise_, kMadToSigma * *middle);
    }
    height_.assign(static_cast<std::size_t>(n), 0);
    for (int i = 0; i + 1 < n; ++i) height_[i] = step(jumps_[i], i, 0);
    for (int i = 0; i + 1 < n; ++i) {
        const double best = height_[i];
        if (best == 0) continue;
        const int from = std::max(0, i - lines_.side / 2), to = std::min(n - 2, i + lines_.side / 2);
        if (std::any_of(&height_[from], &height_[to] + 1, [&](double h) { return h > best; })) continue;
        cut_[i] = 1;
    }
    for (int between = 1; between <= lines_.between; ++between)
        for (int i = 0; i + between + 1 < n; ++i) {
            // A jump that is not far from one already says whether it is worth looking.
            if (!(jumps_[i].height > kWorthLooking * kStepSigma * noise_ * jumps_[i].spread)) continue;
            bool free = true;
            for (int k = std::max(0, i - lines_.side / 2);
                 k <= std::min(n - 1, i + between + lines_.side / 2); ++k)
                free = free && !cut_[k] && !mixed_[k];
            if (!free || step(jump(i, between, lines_.side), i, between) == 0) continue;
            cut_[i] = cut_[i + between] = 1;
            for (int k = 1; k <= between; ++k) mixed_[i + k] = 1;
        }
}

void ContourSheets::divide(const Profile& profile) {
    const int n = static_cast<int>(all_x_.size());
    whole_.clear();
    cut_.assign(static_cast<std::size_t>(n), 0);
    mixed_.assign(static_cast<std::size_t>(n), 0);
    // Lines without return between two points of one segment, not counting those that the filter rejected.
    const auto missing = [&](int i) {
        int lines = 0;
        for (int k = line_[i] + 1; k < line_[i + 1]; ++k)
            lines +=
                !std::isfinite(profile.x_mm[std::size_t(k)]) || !std::isfinite(profile.z_mm[std::size_t(k)]);
        // Lines that were not delivered at all show in x: of an even grid every one.
        if (line_[i + 1] - line_[i] == 1) {
            const double steps =
                std::abs(all_x_[i + 1] - all_x_[i]) / std::max(pitch_.along_x, kLeastPitch_mm);
            if (std::abs(steps - std::round(steps)) < kEvenly && steps < kFewSteps)
                lines = static_cast<int>(std::lround(steps)) - 1;
            else if (pitch_.is_gap(all_x_[i + 1] - all_x_[i], all_z_[i + 1] - all_z_[i]))
                lines = static_cast<int>(steps);
        }
        return lines;
    };
    double runs = 0, pairs = 0, way = 0, steps = 0;
    for (int i = 0; i + 1 < n; ++i) {
        if (segment_[i] != segment_[i + 1]) continue;
        ++pairs, runs += missing(i) > 0;
        const double dx = all_x_[i + 1] - all_x_[i];
        if (line_[i + 1] - line_[i] == 1 && std::abs(dx) < kFewSteps * pitch_.along_x) ++steps, way += dx;
    }
    // Of lines that were not delivered and whose x has noise the mean step tells: longer than the median.
    const double undelivered = way != 0 ? 1 - pitch_.along_x * steps / std::abs(way) : 0;
    const double share = std::max((runs + 0.5) / (pairs + 1), undelivered);
    lost_share_ = pairs > 0 ? runs / pairs : 0;
    const int hole = std::max(
        lines_.hole, share < 1
                         ? static_cast<int>(std::ceil(std::log(kByChance / std::max(n, 1)) / std::log(share)))
                         : 1000);
    find_steps();
    // The filter's own border beside a step stands for the same step, a few points off.
    const auto beside_step = [&](int i) {
        for (int k = std::max(0, i - lines_.side / 2); k <= std::min(n - 1, i + lines_.side / 2); ++k)
            if (cut_[k]) return true;
        return false;
    };
    // A border of the filter where no hole is and one side continues the other: noise made it.
    const auto goes_on = [&](int i) {
        if (missing(i) >= hole) return false;
        const Jump& near = jumps_[std::size_t(i)];
        const Jump j = near.spread > 0 ? near : jump(i, 0, lines_.side, true);
        return j.spread > 0 && j.height < kGoesOn * noise_ * j.spread;
    };
    for (int i = 0, first = 0; i < n; ++i) {
        if (mixed_[i]) {
            first = i + 1;
            continue;
        }
        const bool broken = i + 1 == n || cut_[i] || missing(i) >= hole ||
                            (segment_[i] != segment_[i + 1] && !beside_step(i) && !goes_on(i));
        if (!broken) continue;
        int before = first, after = i;
        while (before > 0 && mixed_[before - 1]) --before;
        while (after + 1 < n && mixed_[after + 1]) ++after;
        whole_.push_back({first, i - first + 1, ContourSheetEnd::open, ContourSheetEnd::open,
                          before < first ? line_[before] : -1, after > i ? line_[after] : -1});
        first = i + 1;
    }
}

void ContourSheets::judge_ends(const Profile& profile, const SensorField& field) {
    const int lines = static_cast<int>(std::min(profile.x_mm.size(), profile.z_mm.size()));
    const int n = static_cast<int>(all_x_.size());
    if (n == 0) return;
    const bool told = field.every_line || lists_every_line(profile, pitch_.along_x, noise_);
    const double beside = kRimLines * pitch_.along_x;
    const auto at_rim = [&](int i) {
        return (told && (line_[i] < kRimLines || line_[i] >= lines - kRimLines)) ||
               all_x_[i] < field.x_min + beside || all_x_[i] > field.x_max - beside;
    };
    for (std::size_t s = 0; s < whole_.size(); ++s) {
        ContourSheet& sheet = whole_[s];
        const int first = sheet.first, last = first + sheet.count - 1;
        if (at_rim(first)) sheet.before = ContourSheetEnd::field;
        if (at_rim(last)) sheet.after = ContourSheetEnd::field;
        // Fragments may lie between a sheet and what hides it.
        const auto hides = [&](int end, int place) {
            const double rise = all_z_[end] - all_z_[place];
            return rise > kCoverSigma * noise_ + pitch_.along_x &&
                   std::abs(all_x_[end] - all_x_[place]) <= kShadow * rise + kRimLines * pitch_.along_x;
        };
        for (std::size_t t = s; t-- > 0 && s - t <= kFragments && sheet.before == ContourSheetEnd::open;)
            if (hides(whole_[t].first + whole_[t].count - 1, first)) sheet.before = ContourSheetEnd::covered;
        for (std::size_t t = s + 1;
             t < whole_.size() && t - s <= kFragments && sheet.after == ContourSheetEnd::open; ++t)
            if (hides(whole_[t].first, last)) sheet.after = ContourSheetEnd::covered;
    }
}

void ContourSheets::gather(const Profile& profile, const FeatureWindow& window, const SensorField& field) {
    all_x_.clear();
    all_z_.clear();
    line_.clear();
    segment_.clear();
    const bool marked = profile.filtered();
    const std::size_t lines = std::min(profile.x_mm.size(), profile.z_mm.size());
    for (std::size_t i = 0; i < lines; ++i) {
        const double px = profile.x_mm[i], pz = profile.z_mm[i];
        if (!std::isfinite(px) || !std::isfinite(pz) || (marked && profile.segment[i] == kOutlier)) continue;
        all_x_.push_back(px);
        all_z_.push_back(pz);
        line_.push_back(static_cast<int>(i));
        segment_.push_back(marked ? profile.segment[i] : 0);
    }
    pitch_ = contour_pitch(all_x_, all_z_, scratch_);
    profile_noise_ = profile_noise(all_x_, all_z_, scratch_, SharedOver::many);
    // Sheets are divided by what neighbours show for certain: a lap's step is not to pass for a mean of many.
    const ProfileNoise neighbours = profile_noise(all_x_, all_z_, scratch_);
    noise_ = profile_noise_.point_mm;
    lines_ = Lines(std::max(1.0, neighbours.measured_apart), kInterpolatedApart * neighbours.apart());
    if (!marked)
        for (std::size_t i = 1; i < all_x_.size(); ++i) {
            const double dx = all_x_[i] - all_x_[i - 1], dz = all_z_[i] - all_z_[i - 1];
            segment_[i] = segment_[i - 1] + (pitch_.is_gap(dx, dz) || pitch_.is_wall(dx, dz));
        }
    divide(profile);
    judge_ends(profile, field);

    x_.clear();
    z_.clear();
    sheets_.clear();
    for (const ContourSheet& whole : whole_) {
        bool before_inside = false;
        for (int i = whole.first; i < whole.first + whole.count; ++i) {
            const bool inside = window.contains(all_x_[i], all_z_[i]);
            if (inside) {
                if (!before_inside)
                    sheets_.push_back({static_cast<int>(x_.size()), 0,
                                       i == whole.first ? whole.before : ContourSheetEnd::window, whole.after,
                                       i == whole.first ? whole.mixed_before : -1, whole.mixed_after});
                x_.push_back(all_x_[i]);
                z_.push_back(all_z_[i]);
                ++sheets_.back().count;
            } else if (before_inside) {
                sheets_.back().after = ContourSheetEnd::window;
                sheets_.back().mixed_after = -1;
            }
            before_inside = inside;
        }
    }
}

}  // namespace seamwright
