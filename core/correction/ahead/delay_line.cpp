#include "core/correction/ahead/delay_line.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace seamwright {
namespace {

constexpr double kForgetful = 0.1;  // share of a new measure in the means
constexpr double kLeastVarianceMm2 = 1e-12;
constexpr double kWellInside = 1.5;  // of a neighbour's distance: half the window that holds it
constexpr double kOnePlace = 1e-9;   // of the squared distances: measures that tell no slope

double tricube(double u) {
    if (!(u < 1)) return 0;
    const double v = 1 - u * u * u;
    return v * v * v;
}

}  // namespace

double matched_half_width_mm(double sigma_mm, double pitch_mm, const DelayLineOptions& o) {
    const double ratio = sigma_mm / o.wanted_sigma_mm;
    return std::clamp(0.5 * pitch_mm * ratio * ratio, o.shortest_mm, o.longest_mm);
}

double AheadOffset::sigma_mm() const {
    const double middle = covariance_mm2.trace() / 2;
    const double spread = std::hypot((covariance_mm2(0, 0) - covariance_mm2(1, 1)) / 2, covariance_mm2(0, 1));
    return std::sqrt(std::max(0.0, middle + spread));
}

DelayLine::DelayLine(const DelayLineOptions& options)
    : options_(options), half_width_mm_(options.shortest_mm) {
    measures_.reserve(options_.capacity + 1);
}

std::size_t DelayLine::above(double s_mm) const {
    const auto it = std::upper_bound(measures_.begin(), measures_.end(), s_mm,
                                     [](double s, const AheadMeasure& m) { return s < m.s_mm; });
    return static_cast<std::size_t>(it - measures_.begin());
}

bool DelayLine::add(const AheadMeasure& measure) {
    if (!std::isfinite(measure.s_mm) || !measure.off_mm.allFinite() || !measure.covariance_mm2.allFinite())
        return false;
    const std::size_t next = above(measure.s_mm);
    if (!measures_.empty()) {
        double nearest = next < measures_.size() ? measures_[next].s_mm : measures_[next - 1].s_mm;
        if (next > 0 && measure.s_mm - measures_[next - 1].s_mm < std::abs(nearest - measure.s_mm))
            nearest = measures_[next - 1].s_mm;
        const double distance = std::abs(measure.s_mm - nearest), change = options_.slope * distance;
        const AheadOffset expected = line_at(nearest);
        const Eigen::Vector2d rest = measure.off_mm - expected.off_mm;
        Eigen::Matrix2d spread = expected.covariance_mm2 + measure.covariance_mm2;
        spread.diagonal().array() += change * change + kLeastVarianceMm2;
        if (!(rest.dot(spread.inverse() * rest) <= options_.gate * options_.gate)) return false;
        if (distance < kSamePlaceMm) return true;
        mean_pitch_mm_ += (mean_pitch_mm_ > 0 ? kForgetful : 1) *
                          (std::min(distance, options_.most_gap_mm) - mean_pitch_mm_);
    }
    const double variance = measure.covariance_mm2.trace() / 2;
    mean_variance_ += (mean_variance_ > 0 ? kForgetful : 1) * (variance - mean_variance_);
    half_width_mm_ =
        matched_half_width_mm(std::sqrt(std::max(0.0, mean_variance_)), mean_pitch_mm_, options_);
    measures_.insert(measures_.begin() + static_cast<std::ptrdiff_t>(next), measure);
    if (measures_.size() > options_.capacity) measures_.erase(measures_.begin());
    return true;
}

void DelayLine::forget_before(double s_mm) {
    // A whole window stays behind the place.
    const std::size_t gone = above(s_mm - 2 * options_.longest_mm - options_.most_gap_mm);
    measures_.erase(measures_.begin(), measures_.begin() + static_cast<std::ptrdiff_t>(gone));
}

// Precondition: there are measures.
AheadOffset DelayLine::line_at(double s_mm) const {
    const std::size_t next = above(s_mm);
    // At least the neighbours, well inside.
    double w = half_width_mm_;
    const auto reach = [&](std::size_t i) {
        w = std::max(w, kWellInside * std::abs(measures_[i].s_mm - s_mm));
    };
    if (next > 0) reach(next - 1);
    if (next < measures_.size()) reach(next);
    const std::size_t first = above(s_mm - w), last = above(s_mm + w);
    const auto weight = [&](const AheadMeasure& m) {
        return tricube(std::abs(m.s_mm - s_mm) / w) / std::max(m.covariance_mm2.trace(), kLeastVarianceMm2);
    };
    double sum = 0, sum_d = 0, sum_dd = 0;
    for (std::size_t i = first; i < last; ++i) {
        const double k = weight(measures_[i]), d = measures_[i].s_mm - s_mm;
        sum += k;
        sum_d += k * d;
        sum_dd += k * d * d;
    }
    AheadOffset out;
    out.state = AheadState::known;
    const double determinant = sum * sum_dd - sum_d * sum_d;
    const bool line = determinant > kOnePlace * sum * sum_dd;
    for (std::size_t i = first; i < last; ++i) {
        const AheadMeasure& m = measures_[i];
        const double k = weight(m), d = m.s_mm - s_mm;
        const double l = line ? k * (sum_dd - sum_d * d) / determinant : k / sum;
        out.off_mm += l * m.off_mm;
        if (line) out.slope += k * (sum * d - sum_d) / determinant * m.off_mm;
        out.covariance_mm2 += l * l * m.covariance_mm2;
    }
    return out;
}

AheadOffset DelayLine::at(double s_mm) const {
    if (measures_.empty()) return {};
    AheadOffset out;
    const auto holds = [&](double place_mm, AheadState state) {
        out = line_at(place_mm);
        out.state = state;
        out.slope.setZero();
        return out;
    };
    if (s_mm < first_mm()) return holds(first_mm(), AheadState::before);
    if (s_mm > newest_mm() + options_.shortest_mm) return holds(newest_mm(), AheadState::behind);
    out = line_at(s_mm);
    const std::size_t next = above(s_mm);
    if (next > 0 && next < measures_.size() &&
        measures_[next].s_mm - measures_[next - 1].s_mm > options_.most_gap_mm)
        out.state = AheadState::lost;
    return out;
}

}  // namespace seamwright
