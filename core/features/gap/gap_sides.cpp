#include "core/features/gap/gap_sides.h"

#include <algorithm>
#include <cmath>

#include "core/numbers.h"

namespace seamwright {
namespace {

constexpr double kHole = 1.8;        // spacings along x: a line without return lies in between
constexpr double kHoleInside = 2.5;  // within a piece, where single returns may be missing
constexpr double kRimEnd_mm = 3;     // of a piece, that may belong to the other part
constexpr double kNoiseGate = 4.2;   // sigma
constexpr double kFlattens = 0.6;    // of the slope before
constexpr double kMostDrop = 1.2;    // of what a round rim drops in its last line
constexpr int kSparks = 2;           // points passed over
constexpr double kMostLines = 6;     // without return, within a rim
constexpr double kFace_mm = 1;       // from a surface to the first point on its cut face, per line
constexpr double kSlopeNoise = 3;    // sigma in the height over which a slope is taken

}  // namespace

// The two pieces with most points; of a single one what lies before and behind its widest hole.
bool GapSides::two_cores(int least, Core& before, Core& after) const {
    const FeaturePoints::Piece *first = nullptr, *second = nullptr;
    for (const auto& piece : points_.pieces) {
        if (piece.count < least) continue;
        if (!first || piece.count > first->count) {
            second = first;
            first = &piece;
        } else if (!second || piece.count > second->count) {
            second = &piece;
        }
    }
    if (!first) return false;
    const auto core = [&](int begin, int count) {
        return Core{raw_[static_cast<std::size_t>(begin)], raw_[static_cast<std::size_t>(begin + count - 1)]};
    };
    if (second) {
        if (second->first < first->first) std::swap(first, second);
        before = core(first->first, first->count);
        after = core(second->first, second->count);
        return true;
    }
    // Two sheets in flush with nothing seen between them are one contour to the filter: the second goes on
    // where the first points to.
    const int end = first->first + first->count;
    int behind = 0;
    double widest = 0;
    for (int i = first->first + least; i + least <= end; ++i) {
        const double dx = points_.x[i] - points_.x[i - 1], dz = points_.z[i] - points_.z[i - 1];
        if (!points_.pitch.is_gap(dx, dz) || std::hypot(dx, dz) <= widest) continue;
        widest = std::hypot(dx, dz);
        behind = i;
    }
    if (behind == 0) return false;
    before = core(first->first, behind - first->first);
    after = core(behind, end - behind);
    return true;
}

// The raw point behind which the first part can have no more points: the widest hole between the surfaces or
// within the end of one of them, for the filter lets a surface go on with the other one's rim. -1: the contour goes on from one to the other.
int GapSides::break_between(const Core& before, const Core& after) const {
    const auto widest = [&](int from, int to, double least) {
        int at = -1;
        for (int i = from; i < to; ++i)
            if (const double dx = std::abs(x_[i + 1] - x_[i]); dx > least) {
                least = dx;
                at = i;
            }
        return at;
    };
    int from = before.last, to = after.first;
    while (from > before.first && std::abs(x_[from] - x_[before.last]) < kRimEnd_mm) --from;
    while (to < after.last && std::abs(x_[to] - x_[after.first]) < kRimEnd_mm) ++to;
    const int between = widest(before.last, after.first, kHole * pitch_);
    const double least = between < 0 ? 0 : std::abs(x_[between + 1] - x_[between]);
    if (const int at = widest(from, to, std::max(least, kHoleInside * pitch_)); at >= 0) return at;
    if (between >= 0) return between;
    // No hole: a jump, or ground that is seen all the way.
    double highest = 0;
    int at = -1;
    for (int i = before.last; i < after.first; ++i)
        if (const double dz = std::abs(z_[i + 1] - z_[i]); dz > highest) {
            highest = dz;
            at = i;
        }
    const double noise = std::max(noise_of(before.first, before.last), noise_of(after.first, after.last));
    return highest > 2 * pitch_ + kNoiseGate * std::sqrt(2.0) * noise ? at : -1;
}

double GapSides::noise_of(int first, int last) const {
    scratch_.clear();
    for (int i = first + 1; i < last; ++i) scratch_.push_back(std::abs(z_[i - 1] - 2 * z_[i] + z_[i + 1]));
    if (scratch_.empty()) return 0;
    const auto middle = scratch_.begin() + static_cast<std::ptrdiff_t>(scratch_.size() / 2);
    std::nth_element(scratch_.begin(), middle, scratch_.end());
    return kMadToSigma * *middle / std::sqrt(6.0);
}

// The last point of the part that goes on from `from`; `stop` is no more of it.
int GapSides::walked(int from, int step, int stop, double noise) const {
    const int w = std::clamp(static_cast<int>(std::ceil(kSlopeNoise * noise / pitch_)), 1, 40);
    const double steeper = kMostDrop * w / (std::sqrt(w + 1.0) - 1);
    trail_.clear();
    for (int i = from, n = 0; n <= w && i >= 0 && i < static_cast<int>(x_.size()); i -= step, ++n)
        trail_.push_back(i);
    std::reverse(trail_.begin(), trail_.end());
    const auto lines = [&](int a, int b) { return std::max(1.0, std::abs(x_[b] - x_[a]) / pitch_); };
    const double gate = kNoiseGate * std::sqrt(2.0) * noise;
    double entered = 0;  // height of the step to the last point
    int sparks = 0;
    bool flattens = false;
    for (int i = from + step; i != stop; i += step) {
        const int last = trail_.back();
        const int base = trail_[trail_.size() - 1 - std::min<std::size_t>(std::size_t(w), trail_.size() - 1)];
        const double slope = base == last ? 0 : (z_[last] - z_[base]) / lines(base, last);
        const double n = lines(last, i), dz = z_[i] - z_[last], tolerance = pitch_ * n + gate;
        if (n > kMostLines) break;
        const double flat = kFlattens * slope * n, steep = steeper * slope * n;
        const bool falls = slope < 0;
        const double least = falls ? steep - tolerance : flat - gate - 0.5 * pitch_ * n;
        const double most = falls ? flat + gate + 0.5 * pitch_ * n : steep + tolerance;
        const auto cut_face = [&] {
            const int next = i + step;
            if (!(std::abs(dz) <= kFace_mm * n) || (next - stop) * step >= 0) return false;
            const double on = (z_[next] - z_[i]) / lines(i, next);
            return on * dz > 0 && std::abs(on) > pitch_ + gate;
        };
        if ((dz >= least && dz <= most) || ((falls ? dz < least : dz > most || dz < least) && cut_face())) {
            trail_.push_back(i);
            entered = std::abs(dz);
            sparks = 0;
            flattens = false;
            continue;
        }
        if (sparks == 0) flattens = falls ? dz > most : dz < least;
        if (++sparks > kSparks) break;
    }
    if (flattens && trail_.back() != from && entered > pitch_ + gate) trail_.pop_back();
    return trail_.back();
}

GapSides::Found GapSides::find(const Profile& profile, const FeatureWindow& window, int least) {
    points_.gather(profile, window);
    x_.clear();
    z_.clear();
    raw_.clear();
    const bool marked = profile.filtered();
    for (std::size_t i = 0; i < std::min(profile.x_mm.size(), profile.z_mm.size()); ++i) {
        const double x = profile.x_mm[i], z = profile.z_mm[i];
        if (!std::isfinite(x) || !std::isfinite(z) || !window.contains(x, z)) continue;
        if (!marked || profile.segment[i] != kOutlier) raw_.push_back(static_cast<int>(x_.size()));
        x_.push_back(x);
        z_.push_back(z);
    }
    Core before{}, after{};
    if (!two_cores(least, before, after))
        return std::any_of(points_.pieces.begin(), points_.pieces.end(),
                           [&](const auto& p) { return p.count >= least; })
                   ? Found::one_surface
                   : Found::no_points;
    scratch_.clear();
    for (const Core& c : {before, after})
        for (int i = c.first; i < c.last; ++i) scratch_.push_back(std::abs(x_[i + 1] - x_[i]));
    const auto middle = scratch_.begin() + static_cast<std::ptrdiff_t>(scratch_.size() / 2);
    std::nth_element(scratch_.begin(), middle, scratch_.end());
    pitch_ = *middle;
    const int cut = break_between(before, after);
    if (cut < 0 || !(pitch_ > 0)) return Found::unbroken;
    const int after_end = std::max(after.first, cut + 1);
    before.last = std::min(before.last, cut);
    if (std::min(before.last - before.first, after.last - after_end) + 1 < least) return Found::unbroken;
    const double noise_before = noise_of(before.first, before.last),
                 noise_after = noise_of(after_end, after.last);
    const int last = walked(before.last, 1, cut + 1, noise_before);
    const int first = walked(after_end, -1, cut, noise_after);
    double mean_before = 0, mean_after = 0;
    for (int i = before.first; i <= before.last; ++i) mean_before += x_[i] / (before.last - before.first + 1);
    for (int i = after_end; i <= after.last; ++i) mean_after += x_[i] / (after.last - after_end + 1);
    GapPart& part_before = parts_[mean_before < mean_after ? 0 : 1];
    GapPart& part_after = parts_[mean_before < mean_after ? 1 : 0];
    for (GapPart* part : {&part_before, &part_after}) {
        part->x.clear();
        part->z.clear();
    }
    part_before.noise_mm = noise_before;
    part_after.noise_mm = noise_after;
    const auto take = [&](GapPart& part, int i) {
        part.x.push_back(x_[i]);
        part.z.push_back(z_[i]);
    };
    for (int i = last; i >= before.first; --i) take(part_before, i);
    for (int i = first; i <= after.last; ++i) take(part_after, i);
    return Found::both;
}

}  // namespace seamwright
