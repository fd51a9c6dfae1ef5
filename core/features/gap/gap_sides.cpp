#include "core/features/gap/gap_sides.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/features/gap/gap_heads.h"
#include "core/features/gap/gap_limits.h"
#include "core/median.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

using namespace gap;

constexpr double kOffLines = 0.25;      // spacings that a point stands off the even lines of one sensor
constexpr double kInterleaved = 0.02;   // of the points
constexpr double kHole = 1.8;           // spacings along x: a line without return lies in between
constexpr double kHoleInside = 2.5;     // within the end of a piece
constexpr double kGoesOnSteeper = 0.6;  // a rim behind single missing returns
constexpr int kHoleLines = 6;           // without return, within a piece
constexpr double kRimEnd_mm = 3;        // of a piece, that may belong to the other part
constexpr double kFlattens = 0.6;       // of the slope before
constexpr double kMostDrop = 1.2;       // of what a round rim drops in its last line
constexpr int kSparks = 2;              // points passed over
constexpr double kMostLines = 6;        // without return, within a rim
constexpr double kFace_mm = 1;          // from a surface to the first point on its cut face, per line
constexpr double kSteep = 2.1;          // slope: 65 degrees; no panel is seen so steep
constexpr double kSteepSmoothed = 1.4;  // of a sensor that smooths, or may: a ramp is flatter than the step
constexpr double kSteepNoise = 6;       // sigma
constexpr int kMostSteep = 40;          // points over which steepness is judged
constexpr int kFewEndPoints = 4;
constexpr double kSmooths = 1.5;            // lines that share their noise
constexpr double kRampStep = 0.5;           // of the steepest: such a step belongs to the ramp
constexpr double kInterpolatedStep = 0.15;  // the same where straight lines were drawn between points
constexpr double kWholly = 0.9;             // more, and no line is drawn across the step
constexpr double kWholeStep = 0.7;          // of what falls about it, between two lines
constexpr double kByChance = 1e-3;          // holes of missing returns in a profile
constexpr double kLeastDrawn = 4, kDrawnBeyond = 1.5;  // lines of a step; of those that likeness explains
constexpr double kDrawnAlike = 0.25;
constexpr double kSlopeNoise = 3;  // sigma in the height over which a slope is taken

}  // namespace

// A sensor sees its lines one after the other, evenly apart where their rays cross one height. A ray leans by t = a + b x, and
// what a return is off in z by its noise it is off in x by -t of that, as the second differences of both tell.
bool GapSides::interleaved() const {
    const int n = static_cast<int>(x_.size());
    double zz = 0, xzz = 0, xxzz = 0, zx = 0, xzx = 0, middle = 0;
    for (const double z : z_) middle += z / n;
    for (int i = 1; i + 1 < n; ++i) {
        if (std::max(std::abs(x_[i] - x_[i - 1]), std::abs(x_[i + 1] - x_[i])) > kHole * pitch_) continue;
        const double x = x_[i - 1] - 2 * x_[i] + x_[i + 1], z = z_[i - 1] - 2 * z_[i] + z_[i + 1];
        zz += z * z, xzz += x_[i] * z * z, xxzz += x_[i] * x_[i] * z * z;
        zx += z * x, xzx += x_[i] * z * x;
    }
    const double det = zz * xxzz - xzz * xzz;
    const double a = det > 0 ? -(xxzz * zx - xzz * xzx) / det : 0,
                 b = det > 0 ? -(zz * xzx - xzz * zx) / det : 0;
    scratch_.clear();
    for (int i = 0; i + 1 < n; ++i)
        scratch_.push_back(std::abs(x_[i + 1] + (a + b * x_[i + 1]) * (z_[i + 1] - middle) - x_[i] -
                                    (a + b * x_[i]) * (z_[i] - middle)));
    const double line = median(scratch_);
    int neighbours = 0, off = 0;
    for (const double s : scratch_) {
        if (s > kHole * line) continue;
        ++neighbours;
        off += std::abs(s - line) > kOffLines * line;
    }
    return off > kInterleaved * neighbours;
}

bool GapSides::smooths() const {
    return !interleaved_ && noise_.apart() > kSmooths;
}

// Lines without return between two points.
int GapSides::missing(int i, int j) const {
    return static_cast<int>(std::lround(std::abs(x_[j] - x_[i]) / pitch_)) - std::abs(j - i);
}

// So many lines in a row without return, or with a spark, are no chance: of n points with the share q of such ones behind
// them n q^k have k.
int GapSides::chance_lines() const {
    double runs = 0;
    const int n = static_cast<int>(raw_.size());
    for (int i = 0; i + 1 < n; ++i) runs += lost(i, i + 1) > 0;
    const double share = (runs + 0.5) / n;
    return share < 1 ? static_cast<int>(std::ceil(std::log(kByChance / n) / std::log(share))) : n;
}

// Lines between two points of points_.
int GapSides::lost(int a, int b) const {
    return static_cast<int>(std::lround(std::abs(points_.x[b] - points_.x[a]) / pitch_)) - 1;
}

// Nothing is known between two points of points_, or what the filter left out lies lower than both: a narrow gap's ground.
bool GapSides::is_hole(int a, int b) const {
    if (missing(raw_[a], raw_[b]) >= hole_lines_) return true;
    if (lost(a, b) < chance_lines_) return false;
    const double low = std::min(points_.z[a], points_.z[b]) - pitch_ - kNoiseGate * noise_.point_mm;
    return std::any_of(z_.begin() + raw_[a] + 1, z_.begin() + raw_[b], [&](double z) { return z < low; });
}

// Of the lines of two surfaces, without a return or with a spark: that many edges were seen farther inwards.
double GapSides::lost_share(const Core& before, const Core& after) const {
    int lost = 0, lines = 1;
    for (const Core& core : {before, after}) {
        int last = -1;
        for (const int i : raw_) {
            if (i < core.first || i > core.last) continue;
            if (last >= 0) {
                ++lines;
                lost += std::abs(x_[i] - x_[last]) > kHole * pitch_;
            }
            last = i;
        }
    }
    return static_cast<double>(lost) / lines;
}

// Mean place and slope of the points at an end of a sheet.
GapSides::End GapSides::end_of(const Sheet& sheet, bool last, int most) const {
    End e;
    e.count = std::min(most, sheet.last - sheet.first + 1);
    const int from = last ? sheet.last - e.count + 1 : sheet.first;
    for (int i = from; i < from + e.count; ++i) e.x += points_.x[i] / e.count, e.z += points_.z[i] / e.count;
    double xz = 0;
    for (int i = from; i < from + e.count; ++i) {
        e.spread += (points_.x[i] - e.x) * (points_.x[i] - e.x);
        xz += (points_.x[i] - e.x) * (points_.z[i] - e.z);
    }
    e.slope = e.spread > 0 ? xz / e.spread : 0;
    return e;
}

double GapSides::End::variance_at(double place) const {
    return spread > 0 ? 1.0 / count + (place - x) * (place - x) / spread : 1;
}

// Either one lies where the other points to: nothing but noise or a few missing returns divides them.
bool GapSides::goes_on(const Sheet& a, const Sheet& b) const {
    if (is_hole(a.last, b.first)) return false;
    const auto met = [&](const Sheet& end, const Sheet& begin) {
        const End before = end_of(end, true, kEndPoints), after = end_of(begin, false, kEndPoints);
        const double dx = after.x - before.x, dz = after.z - before.z;
        // Of the lines a length beside their middles.
        const double variance = before.variance_at(before.x + before.count * pitch_) +
                                after.variance_at(after.x - after.count * pitch_);
        const double most = kGoesOn * noise_.point_mm * std::sqrt(noise_.apart() * variance) + pitch_;
        return std::abs(dz - before.slope * dx) < most && std::abs(dz - after.slope * dx) < most;
    };
    // A rim is bent over many points, and straight over the few that meet.
    Sheet end = a, begin = b;
    end.first = std::max(a.first, a.last - kFewEndPoints + 1);
    begin.last = std::min(b.last, b.first + kFewEndPoints - 1);
    return met(a, b) || met(end, begin);
}

// The filter joins a panel with the ground in the gap over a face that is seen, and over the ramp that a sensor's
// smoothing makes of a step. So its pieces are divided where they are steep, and at holes.
void GapSides::divide() {
    sheets_.clear();
    const double noise = noise_.point_mm, limit = smooths() || !(noise_.points > 0) ? kSteepSmoothed : kSteep;
    const int w = std::clamp(
        static_cast<int>(std::ceil(kSteepNoise * std::sqrt(2.0) * noise / (limit * pitch_))), 1, kMostSteep);
    const auto steep = [&](int i, int j) {
        const double least = std::max(std::abs(points_.x[j] - points_.x[i]), w * pitch_);
        return std::abs(points_.z[j] - points_.z[i]) > limit * least;
    };
    const auto divide_run = [&](int first, int end) {
        int begin = first, steep_until = -1;
        const auto close = [&](int behind) {
            if (behind - begin > 1) sheets_.push_back({begin, behind - 1, behind - begin, first, end - 1});
        };
        for (int i = first; i + 1 < end; ++i) {
            // The shortest way that is steep: what is level beside a step belongs to its sheet.
            const int most = std::min(i + w, end - 1);
            int j = i + 1;
            while (j <= most && !steep(i, j)) ++j;
            bool shorter = false;
            for (int k = i + 1; k < j && j <= most; ++k) shorter = shorter || steep(k, j);
            if (j <= most && !shorter) steep_until = j;
            if (i >= steep_until) continue;
            close(i + 1);
            begin = i + 1;
        }
        close(end);
    };
    for (const auto& piece : points_.pieces) {
        int first = piece.first;
        for (int i = first; i < piece.first + piece.count; ++i) {
            if (i + 1 < piece.first + piece.count && !is_hole(i, i + 1)) continue;
            divide_run(first, i + 1);
            first = i + 1;
        }
    }
    std::size_t kept = 0;
    for (std::size_t k = 1; k < sheets_.size(); ++k) {
        Sheet& open = sheets_[kept];
        if (goes_on(open, sheets_[k])) {
            open.last = sheets_[k].last;
            open.count += sheets_[k].count;
            open.piece_last = sheets_[k].piece_last;
        } else {
            sheets_[++kept] = sheets_[k];
        }
    }
    sheets_.resize(std::min(sheets_.size(), kept + 1));
    std::erase_if(sheets_, [&](const Sheet& sheet) { return sheet.count < std::max(kLeastGround, w); });
}

bool GapSides::astray(int i, double noise) const {
    if (!rejected(i)) return false;
    const auto after = std::lower_bound(raw_.begin(), raw_.end(), i);
    if (after == raw_.begin() || after == raw_.end()) return true;
    const int a = *(after - 1), b = *after;
    const double slope = x_[b] == x_[a] ? 0 : (z_[b] - z_[a]) / (x_[b] - x_[a]);
    const double off = z_[i] - z_[a] - slope * (x_[i] - x_[a]);
    return std::abs(off) > kNoiseGate * std::sqrt(1.5) * noise + std::abs(slope) * pitch_;
}

// The raw point behind which the first part can have no more points: the widest hole between the surfaces or
// within the end of one of them, for the filter lets a surface go on with the other one's rim. -1: the contour goes on from
// one to the other.
int GapSides::break_between(const Core& before, const Core& after) const {
    const double noise = std::max(noise_of(before.first, before.last), noise_of(after.first, after.last));
    // Where single returns may be missing the contour goes on behind them, seen from either side.
    const auto off_surface = [&](int i) { return (i < before.last || i > after.first) && astray(i, noise); };
    const auto is_break = [&](int i) {
        if (off_surface(i) || off_surface(i + 1)) return false;
        const int lines = missing(i, i + 1) + 1;
        if (lines > chance_lines_) return true;
        const double rise = z_[i + 1] - z_[i], width = pitch_ * lines;
        const auto misses = [&](int a, int b) {
            const double slope = (z_[b] - z_[a]) / (pitch_ * (1 + missing(a, b)));
            return std::abs(rise - slope * width) > (1 + kGoesOnSteeper * std::abs(slope)) * width +
                                                        kNoiseGate * std::sqrt(2.0) * noise * (1 + lines);
        };
        return i > 0 && i + 2 < static_cast<int>(x_.size()) && (misses(i - 1, i) || misses(i + 1, i + 2));
    };
    const auto widest = [&](int from, int to, double least, const auto& counts) {
        int at = -1;
        for (int i = from; i < to; ++i)
            if (const double dx = std::abs(x_[i + 1] - x_[i]); dx > least && counts(i)) {
                least = dx;
                at = i;
            }
        return at;
    };
    int from = before.last, to = after.first;
    while (from > before.first && std::abs(x_[from] - x_[before.last]) < kRimEnd_mm) --from;
    while (to < after.last && std::abs(x_[to] - x_[after.first]) < kRimEnd_mm) ++to;
    const int between = widest(before.last, after.first, kHole * pitch_, [](int) { return true; });
    const double least = between < 0 ? 0 : std::abs(x_[between + 1] - x_[between]);
    if (const int at = widest(from, to, std::max(least, kHoleInside * pitch_), is_break); at >= 0) return at;
    if (between >= 0) return between;
    // No hole: a jump, or ground that is seen all the way.
    double highest = 0;
    int at = -1;
    for (int i = before.last; i < after.first; ++i)
        if (const double dz = std::abs(z_[i + 1] - z_[i]); dz > highest) {
            highest = dz;
            at = i;
        }
    return highest > 2 * pitch_ + kNoiseGate * std::sqrt(2.0) * noise ? at : -1;
}

double GapSides::noise_of(int first, int last) const {
    scratch_.clear();
    for (int i = first + 1; i < last; ++i) scratch_.push_back(std::abs(z_[i - 1] - 2 * z_[i] + z_[i + 1]));
    if (scratch_.empty()) return 0;
    const auto middle = scratch_.begin() + static_cast<std::ptrdiff_t>(scratch_.size() / 2);
    std::nth_element(scratch_.begin(), middle, scratch_.end());
    const double beside = kMadToSigma * *middle / std::sqrt(6.0);
    // Interpolated neighbours hide it.
    return is_drawn() ? std::max(beside, noise_.point_mm) : beside;
}

// The last point of the part that goes on from `from`; `stop` is no more of it. Of a sensor that smooths the last points
// stand on the ramp that it makes of the step behind the edge (or of a face): they are given back, as many as it makes.
int GapSides::walked(int from, int step, int stop, double noise, GapPart& part) const {
    const int w =
        std::clamp(static_cast<int>(std::ceil(std::max(kSlopeNoise * noise / pitch_, drawn_lines()))), 1, 40);
    const double steeper = kMostDrop * w / (std::sqrt(w + 1.0) - 1);
    trail_.clear();
    // A slope that a point beside the contour turns over lets the walk end at once.
    for (int i = from, n = 0; n <= w && i >= 0 && i < static_cast<int>(x_.size()); i -= step) {
        if (i != from && rejected(i)) continue;
        trail_.push_back(i);
        ++n;
    }
    std::reverse(trail_.begin(), trail_.end());
    const auto lines = [&](int a, int b) { return std::max(1.0, std::abs(x_[b] - x_[a]) / pitch_); };
    const auto before = [&](std::size_t back) {
        return trail_[trail_.size() - 1 - std::min(back, trail_.size() - 1)];
    };
    const double gate = kNoiseGate * std::sqrt(2.0) * noise;
    enum class Step { on, flatter, off };
    // From `last`, with the slope since `base`, to i.
    const auto judged = [&](int base, int last, int i) {
        const double slope = base == last ? 0 : (z_[last] - z_[base]) / lines(base, last);
        const double n = lines(last, i), dz = z_[i] - z_[last], tolerance = pitch_ * n + gate;
        const double flat = kFlattens * slope * n, steep = steeper * slope * n;
        const bool falls = slope < 0;
        const double least = falls ? steep - tolerance : flat - gate - 0.5 * pitch_ * n;
        const double most = falls ? flat + gate + 0.5 * pitch_ * n : steep + tolerance;
        const auto cut_face = [&] {
            const int next = i + step;
            if (smooths() || !(std::abs(dz) <= kFace_mm * n) || (next - stop) * step >= 0) return false;
            const double on = (z_[next] - z_[i]) / lines(i, next);
            return on * dz > 0 && std::abs(on) > pitch_ + gate;
        };
        if ((dz >= least && dz <= most) || ((falls ? dz < least : dz > most || dz < least) && cut_face()))
            return Step::on;
        return (falls ? dz > most : dz < least) ? Step::flatter : Step::off;
    };
    // Beside the contour: the filter left it out, and the next goes on without it alone.
    const auto is_spark = [&](int i) {
        const int next = i + step;
        return next != stop && rejected(i) && judged(before(w), before(0), next) == Step::on &&
               judged(before(w - 1), i, next) != Step::on;
    };
    double entered = 0;  // height of the step to the last point
    int sparks = 0;
    bool flattens = false;
    for (int i = from + step; i != stop; i += step) {
        const int last = trail_.back();
        if (lines(last, i) > kMostLines) break;
        const Step taken = judged(before(w), last, i);
        if (taken == Step::on && !is_spark(i)) {
            trail_.push_back(i);
            entered = std::abs(z_[i] - z_[last]);
            sparks = 0;
            flattens = false;
            continue;
        }
        if (sparks == 0) flattens = taken == Step::flatter;
        if (++sparks > kSparks) break;
    }
    if (flattens && trail_.back() != from && entered > pitch_ + gate) trail_.pop_back();
    const int edge = trail_.back(), next = edge + step;
    const bool ground = ground_first_ >= 0;
    const bool goes_on =
        (next == stop ? ground : (stop - next) * step > 0) && missing(edge, next) < hole_lines_;
    const auto steep = [&](int i, int j, double least) {
        return std::abs(z_[j] - z_[i]) >= least * lines(i, j);
    };
    part.unsure_lines = 0;
    part.ramp = smooths() && goes_on;
    if (!(noise_.points > 0) && ground && goes_on) {
        int first = edge, last = edge;
        while (first != from && steep(first, first - step, kSteep * pitch_)) first -= step;
        while (last != stop && steep(last, last + step, kSteep * pitch_)) last += step;
        part.unsure_lines = std::max(0.0, lines(first, last) - 1);
    }
    if (!part.ramp) return edge;
    const int ramp_lines = static_cast<int>(std::lround(noise_.apart()));
    double steepest = 0;
    for (int i = edge, k = 0; k < ramp_lines && i != stop; i += step, ++k)
        steepest = std::max(steepest, std::abs(z_[i + step] - z_[i]) / lines(i, i + step));
    // A median draws no ramp: it leaves the step whole, between two lines.
    const std::size_t inner_lines = std::min(trail_.size() - 1, static_cast<std::size_t>(ramp_lines));
    const int top = before(inner_lines);
    int foot = edge;
    for (int k = 0; k < ramp_lines && foot != stop; ++k) foot += step;
    for (std::size_t k = 0; k < inner_lines; ++k)
        steepest =
            std::max(steepest, std::abs(z_[before(k)] - z_[before(k + 1)]) / lines(before(k), before(k + 1)));
    if (ground && steepest > kSteep * pitch_ + gate && steepest > kWholeStep * std::abs(z_[foot] - z_[top])) {
        part.ramp = false;
        if (steepest > kWholly * std::abs(z_[foot] - z_[top])) part.drawn_lines = 0;
        return edge;
    }
    const double least = std::max(kSteep * pitch_, (is_drawn() ? kInterpolatedStep : kRampStep) * steepest);
    for (int k = 1; k < ramp_lines && trail_.size() > 1 && trail_.back() != from; ++k) {
        const int last = trail_.back(), inner = trail_[trail_.size() - 2];
        if (!steep(inner, last, least)) break;
        trail_.pop_back();
    }
    return trail_.back();
}

// The raw point up to which a part is flat, from its edge inwards: what is half as steep as the steepest on the way to the
// ground belongs to the step.
int GapSides::flat_end(int edge, int to_gap, int inmost) const {
    const auto slope = [&](int i, int j) { return std::abs((z_[j] - z_[i]) / (x_[j] - x_[i])); };
    double steepest = 0;
    for (int i = edge, k = 0; k < kMostSteep && i != (to_gap > 0 ? ground_first_ : ground_last_);
         i += to_gap, ++k)
        steepest = std::max(steepest, slope(i, i + to_gap));
    const double least = std::max(kSteep, kRampStep * steepest);
    while (edge != inmost && slope(edge - to_gap, edge) >= least) edge -= to_gap;
    return edge;
}

// A sensor that means more lines than the likeness of its noise tells draws both steps to the ground over like many of them.
void GapSides::take_drawn_steps(const Core& before, const Core& after, int& last, int& first) {
    const auto lines = [&](int i, int j) { return std::abs(x_[j] - x_[i]) / pitch_; };
    const int left = flat_end(last, 1, before.first), right = flat_end(first, -1, after.last);
    const double drawn_left = lines(left, ground_first_), drawn_right = lines(right, ground_last_);
    const double drawn = std::min(drawn_left, drawn_right);
    if (missing(left, ground_first_) + missing(ground_last_, right) > 0 || drawn < kLeastDrawn ||
        std::abs(drawn_left - drawn_right) > std::max(2.0, kDrawnAlike * drawn) ||
        drawn <= kDrawnBeyond * noise_.apart())
        return;
    last = left;
    first = right;
    for (GapPart& part : parts_) {
        part.ramp = true;
        part.smoothed_lines = drawn;
        part.unsure_lines = 0;
    }
}

GapSides::Found GapSides::find(const Profile& profile, const FeatureWindow& window, int least,
                               double panel_mm) {
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
    noise_ = points_.noise(SharedOver::few);
    pitch_ = points_.pitch.along_x;
    if (x_.size() < 2 || !(pitch_ > 0)) return Found::no_points;
    interleaved_ = interleaved();
    ground_first_ = ground_last_ = -1;
    Core before{}, after{};
    thread_local HeadsContour heads;
    if (interleaved_) {
        heads.arrange(points_, noise_.point_mm);
        x_ = points_.x;
        z_ = points_.z;
        raw_.resize(x_.size());
        std::iota(raw_.begin(), raw_.end(), 0);
        chance_lines_ = hole_lines_ = kHoleLines;
        sheets_.clear();
        for (const auto& [first, last] : heads.sheets())
            sheets_.push_back({first, last, last - first + 1, first, last});
    } else {
        chance_lines_ = chance_lines();
        hole_lines_ = std::max(kHoleLines, chance_lines_);
        divide();
    }
    const double own_noise = noise_.point_mm;
    if (interleaved_) noise_.point_mm = heads.noise_mm();
    const Found found = two_cores(least, panel_mm, before, after);
    noise_.point_mm = own_noise;
    if (found != Found::both) return found;
    if (interleaved_) {
        heads.share_faces(points_, {before.first, before.last}, {after.first, after.last});
        for (const bool of_after : {false, true}) {
            const Core& core = of_after ? after : before;
            GapPart& part = parts_[of_after ? 1 : 0];
            part = {std::move(part.x), std::move(part.z), noise_of(core.first, core.last)};
            part.face = true;
            raw_ = heads.face(of_after);
            for (int i = core.first; i <= core.last; ++i) raw_.push_back(i);
            std::sort(raw_.begin(), raw_.end(),
                      [&](int i, int j) { return of_after ? x_[i] < x_[j] : x_[i] > x_[j]; });
            part.x.clear();
            part.z.clear();
            for (const int i : raw_) part.x.push_back(x_[i]), part.z.push_back(z_[i]);
        }
        return Found::both;
    }
    const bool ground = ground_first_ >= 0;
    const int cut = ground ? ground_first_ - 1 : break_between(before, after);
    if (cut < 0) return Found::unbroken;
    const int after_end = std::max(after.first, cut + 1), after_stop = ground ? ground_last_ : cut;
    before.last = std::min(before.last, cut);
    if (std::min(before.last - before.first, after.last - after_end) + 1 < least) return Found::unbroken;
    const double noise_before = noise_of(before.first, before.last),
                 noise_after = noise_of(after_end, after.last);
    const bool left_first = x_[before.first] < x_[after.last];
    GapPart& part_before = parts_[left_first ? 0 : 1];
    GapPart& part_after = parts_[left_first ? 1 : 0];
    for (GapPart* part : {&part_before, &part_after}) {
        part->x.clear();
        part->z.clear();
    }
    part_before.noise_mm = noise_before;
    part_after.noise_mm = noise_after;
    part_before.lost_share = part_after.lost_share = lost_share(before, {after_end, after.last});
    part_before.face = part_after.face = false;
    // Between two measured points a line is drawn of the whole step.
    const double smoothed = is_drawn() ? 1 + noise_.measured_apart : noise_.apart();
    part_before.smoothed_lines = part_after.smoothed_lines = smooths() ? smoothed : 1;
    part_before.drawn_lines = part_after.drawn_lines = smooths() ? drawn_lines() : 0;
    int last = walked(before.last, 1, cut + 1, noise_before, part_before);
    int first = walked(after_end, -1, after_stop, noise_after, part_after);
    const auto take = [&](GapPart& part, int i) {
        part.x.push_back(x_[i]);
        part.z.push_back(z_[i]);
    };
    if (ground) take_drawn_steps(before, {after_end, after.last}, last, first);
    // Behind the rims a point beside the surface is none of it; what was walked to beyond counts.
    for (int i = last; i >= before.first; --i)
        if (i > before.last || !astray(i, noise_before)) take(part_before, i);
    for (int i = first; i <= after.last; ++i)
        if (i < after_end || !astray(i, noise_after)) take(part_after, i);
    return Found::both;
}

}  // namespace seamwright
