#include "core/statistics/drift_chart.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/acceptance/distributions.h"
#include "core/acceptance/stability.h"
#include "core/statistics/ewma.h"

namespace seamwright {

std::string_view to_string(DriftVerdict verdict) {
    switch (verdict) {
        case DriftVerdict::learning:
            return "learning";
        case DriftVerdict::fine:
            return "fine";
        case DriftVerdict::watch:
            return "watch";
        case DriftVerdict::recalibrate:
            return "recalibrate";
        case DriftVerdict::step:
            return "step";
    }
    return "learning";
}

std::string_view to_string(DriftChange change) {
    switch (change) {
        case DriftChange::none:
            return "none";
        case DriftChange::unclear:
            return "unclear";
        case DriftChange::drift:
            return "drift";
        case DriftChange::step:
            return "step";
    }
    return "none";
}

namespace {

constexpr std::array<std::size_t, 11> kLengths{2, 3, 4, 6, 8, 12, 16, 20, 24, 32, 40};
constexpr std::array<std::size_t, 7> kRises{1, 8, 12, 16, 24, 32, 48};
constexpr double kLeastSigmaMm = 1e-3;
constexpr double kMostChance = 0.1;    // of a false alarm that may be asked for
constexpr double kStillThere = 0.5;    // of a step's amplitude: it stands
constexpr double kWarmUpTold = 0.999;  // quantile from which a curve of warming up is told

using Rows = std::span<const std::vector<double>>;

Expected<void> check_points(Rows points, std::span<const DriftChannel> channels, const DriftChartOptions& o) {
    if (points.empty() || channels.empty()) return input_error("there is no point to judge", "drift chart");
    for (const double chance : {o.step_chance, o.drift_chance})
        if (!(chance > 0 && chance <= kMostChance))
            return input_error("a chance of false alarms is not within 0 to 0.1", "drift chart");
    if (!(o.limit_mm > 0) || !(o.degrees >= 1) || !std::isfinite(o.limit_mm) || !std::isfinite(o.degrees))
        return input_error("limit or degrees of freedom are not above 0", "drift chart");
    for (const DriftChannel& c : channels)
        if (!(c.sigma_mm > 0 && std::isfinite(c.sigma_mm)))
            return input_error("a sigma is not above 0", "drift chart", "learn the reference first");
    for (const auto& row : points) {
        if (row.size() != channels.size())
            return input_error("a point has not as many directions as were learnt", "drift chart");
        for (const double v : row)
            if (!std::isfinite(v)) return input_error("a value is not finite", "drift chart");
    }
    return {};
}

// A shape fitted to the last `n` of `rows` with a free level before: amplitude over its sigma by direction.
struct Fit {
    double largest = 0, sum = 0;  // of |u|, of u^2
    double amplitude_mm = 0;      // in the direction of the largest
    std::size_t direction = 0, n = 0, rise = 0;
};

Fit fit_shape(Rows rows, std::span<const DriftChannel> channels, std::size_t n, std::size_t rise) {
    const auto total = static_cast<double>(rows.size());
    double mean = 0, squares = 0;
    const auto shape = [&](std::size_t i) {  // of the i-th of the last n, from 1
        return static_cast<double>(std::min(i, rise)) / static_cast<double>(rise);
    };
    for (std::size_t i = 1; i <= n; ++i) {
        mean += shape(i) / total;
        squares += shape(i) * shape(i);
    }
    const double sxx = squares - total * mean * mean;
    Fit fit;
    fit.n = n;
    fit.rise = rise;
    for (std::size_t d = 0; d < channels.size(); ++d) {
        double sum = 0, product = 0;
        for (const auto& row : rows) sum += row[d];
        for (std::size_t i = 1; i <= n; ++i) product += shape(i) * rows[rows.size() - n + i - 1][d];
        const double amplitude = (product - mean * sum) / sxx;
        const double u = amplitude * std::sqrt(sxx) / channels[d].sigma_mm;
        fit.sum += u * u;
        if (std::abs(u) <= fit.largest) continue;
        fit.largest = std::abs(u);
        fit.amplitude_mm = amplitude;
        fit.direction = d;
    }
    return fit;
}

void find_jump(Rows points, std::span<const DriftChannel> channels, const DriftChartOptions& o,
               DriftJudgement& r) {
    const auto m = static_cast<double>(channels.size());
    const double limit = t_quantile(o.degrees, 1 - o.step_chance / (2 * m));
    const Rows before = points.first(points.size() - 1);
    const Rows line = before.last(std::min(before.size(), kDriftBefore));
    double worst = 0;
    for (std::size_t d = 0; d < channels.size(); ++d) {
        const double x = points.back()[d], sigma = channels[d].sigma_mm;
        double jump = x, ratio = std::abs(x) / (sigma * std::sqrt(1 + 1 / (o.degrees + 1)));
        if (line.size() >= 4) {
            const auto n = static_cast<double>(line.size());
            double mean = 0, slope = 0;
            for (const auto& row : line) mean += row[d] / n;
            for (std::size_t i = 0; i < line.size(); ++i)
                slope += (static_cast<double>(i) - (n - 1) / 2) * (line[i][d] - mean);
            const double sxx = n * (n * n - 1) / 12, ahead = (n + 1) / 2;
            jump = x - mean - slope / sxx * ahead;
            ratio = std::min(ratio, std::abs(jump) / (sigma * std::sqrt(1 + 1 / n + ahead * ahead / sxx)));
        }
        if (ratio <= limit || ratio <= worst) continue;
        worst = ratio;
        r.change = DriftChange::step;
        r.jump = true;
        r.direction = d;
        r.changed = 1;
        r.size_mm = jump;
    }
}

// Knocked, the reference stands beside its place until somebody has looked.
bool stands(Rows window, const Fit& step) {
    const auto mean = [&](Rows rows) {
        double sum = 0;
        for (const auto& row : rows) sum += row[step.direction];
        return sum / static_cast<double>(rows.size());
    };
    const double moved =
        mean(window.last(std::min(step.n, kStepStands))) - mean(window.first(window.size() - step.n));
    return moved / step.amplitude_mm > kStillThere;
}

// Whether something changed within the window, and then what.
void find_change(Rows points, std::span<const DriftChannel> channels, const DriftChartOptions& o,
                 DriftJudgement& r) {
    const Rows window = points.last(std::min(points.size(), kDriftWindow));
    if (window.size() < kDriftBefore + 2) return;
    const std::size_t longest = window.size() - kDriftBefore;
    const auto m = static_cast<double>(channels.size());
    double largest = 0;
    for (const std::size_t n : kLengths)
        if (n <= longest)
            for (const std::size_t rise : {std::size_t{1}, n})
                largest = std::max(largest, fit_shape(window, channels, n, rise).largest);
    const double trials = 2.0 * static_cast<double>(kLengths.size()) * m;
    if (largest <= t_quantile(o.degrees, 1 - o.drift_chance / (2 * trials))) return;

    // A drift may have begun before the window did.
    Fit step, drift;
    for (std::size_t n = 1; n + 2 <= window.size(); ++n)
        for (const std::size_t rise : kRises) {
            const Fit fit = fit_shape(window, channels, n, rise);
            Fit& best = rise == 1 ? step : drift;
            if (fit.sum > best.sum) best = fit;
        }
    const bool surely =
        step.n >= 3 && step.n <= longest && stands(window, step) &&
        step.largest > t_quantile(o.degrees, 1 - o.step_chance / (2 * m * static_cast<double>(kDriftWindow)));
    const bool is_step = step.sum - drift.sum > kStepTold, is_drift = drift.sum - step.sum > kDriftTold;
    const Fit& told = is_step ? step : drift;
    r.change = is_step && surely ? DriftChange::step : is_drift ? DriftChange::drift : DriftChange::unclear;
    r.direction = told.direction;
    r.changed = told.n;
    r.size_mm = told.amplitude_mm;
    const auto n = static_cast<double>(told.n), rise = static_cast<double>(told.rise);
    if (r.change == DriftChange::drift) {
        r.slope_mm = told.n <= told.rise ? told.amplitude_mm / rise : 0;
        r.size_mm = told.amplitude_mm * std::min(1.0, n / rise);
    }
}

Expected<void> find_levels_and_rules(Rows points, std::span<const DriftChannel> channels,
                                     const DriftChartOptions& o, DriftJudgement& r) {
    const Rows recent = points.last(std::min(points.size(), kDriftWindow));
    for (std::size_t d = 0; d < channels.size(); ++d) {
        std::vector<double> values;
        for (const auto& row : recent) values.push_back(row[d]);
        const double sigma = channels[d].sigma_mm;
        SEAM_TRY(const Ewma ewma, ewma_chart(values, 0, sigma, {.lambda = kDriftLambda, .width = 3}));
        r.level_mm.push_back(ewma.z.back());
        r.level_sigma_mm.push_back(std::hypot(ewma.half_width.back() / 3, sigma / std::sqrt(o.degrees + 1)));
        if (r.change == DriftChange::drift && r.direction == d)
            r.level_mm.back() += r.slope_mm * (1 - kDriftLambda) / kDriftLambda;
        for (const StabilityAlarm& alarm : nelson_rules(values, 0, sigma))
            if (alarm.subgroup + 1 == values.size()) r.rules.push_back({d, alarm.rule, false});
        const double stated = channels[d].stated_sigma_mm;
        if (stated > 0 && std::abs(values.back()) > 3 * stated) r.rules.push_back({d, 1, true});
    }
    return {};
}

}  // namespace

Expected<DriftJudgement> judge_drift(Rows points, std::span<const DriftChannel> channels,
                                     const DriftChartOptions& options) {
    SEAM_OK(check_points(points, channels, options));
    DriftJudgement r;
    find_jump(points, channels, options, r);
    if (r.change == DriftChange::none) find_change(points, channels, options, r);
    SEAM_OK(find_levels_and_rules(points, channels, options, r));
    const bool beyond = std::any_of(r.level_mm.begin(), r.level_mm.end(),
                                    [&](double level) { return std::abs(level) > options.limit_mm; });
    // Rules 4, 7 and 8 are patterns of the scatter, not of the place.
    const bool pattern = std::any_of(r.rules.begin(), r.rules.end(), [](const DriftRule& rule) {
        return rule.rule <= 3 || rule.rule == 5 || rule.rule == 6;
    });
    r.verdict = r.change == DriftChange::step              ? DriftVerdict::step
                : beyond                                   ? DriftVerdict::recalibrate
                : r.change != DriftChange::none || pattern ? DriftVerdict::watch
                                                           : DriftVerdict::fine;
    return r;
}

double cold_share(double running_s, double pause_s, double time_constant_s) {
    if (!(time_constant_s > 0)) return 0;
    const double cooled = pause_s < 0 ? 1 : 1 - std::exp(-pause_s / time_constant_s);
    return cooled * std::exp(-std::max(0.0, running_s) / time_constant_s);
}

namespace {

// The chart with this time constant, and twice its negative log likelihood up to a constant.
std::pair<LearntDriftChart, double> chart_with(std::span<const DriftLearning> points,
                                               double time_constant_s) {
    const auto n = static_cast<Eigen::Index>(points.size());
    const Eigen::Index unknowns = time_constant_s > 0 ? 2 : 1;
    Eigen::MatrixXd a = Eigen::MatrixXd::Ones(n, unknowns);
    for (Eigen::Index i = 0; unknowns > 1 && i < n; ++i) {
        const DriftLearning& p = points[static_cast<std::size_t>(i)];
        a(i, 1) = cold_share(p.running_s, p.pause_s, time_constant_s);
    }
    const auto solver = a.colPivHouseholderQr();
    LearntDriftChart chart;
    chart.time_constant_s = time_constant_s;
    double cost = 0;
    if (solver.rank() < unknowns) return {chart, std::numeric_limits<double>::infinity()};
    chart.degrees = static_cast<double>(n - unknowns - (time_constant_s > 0 ? 1 : 0));
    for (std::size_t d = 0; d < points.front().values_mm.size(); ++d) {
        Eigen::VectorXd x(n);
        for (Eigen::Index i = 0; i < n; ++i) x[i] = points[static_cast<std::size_t>(i)].values_mm[d];
        const Eigen::VectorXd found = solver.solve(x);
        const double squares =
            std::max((x - a * found).squaredNorm(), chart.degrees * kLeastSigmaMm * kLeastSigmaMm);
        chart.mean_mm.push_back(found[0]);
        chart.warm_up_mm.push_back(unknowns > 1 ? found[1] : 0);
        chart.sigma_mm.push_back(std::sqrt(squares / chart.degrees));
        cost += static_cast<double>(n) * std::log(squares);
    }
    return {chart, cost};
}

}  // namespace

Expected<LearntDriftChart> learn_drift(std::span<const DriftLearning> points) {
    if (points.size() < static_cast<std::size_t>(kDriftLearnPoints))
        return input_error(Text("{} points of the reference are too few to learn from", points.size()),
                           "drift watch", Text("measure at least {}", kDriftLearnPoints));
    double longest_s = 0;
    for (const DriftLearning& p : points) {
        if (p.values_mm.empty() || p.values_mm.size() != points.front().values_mm.size())
            return input_error("a point has not as many directions as the others", "drift watch");
        for (const double v : p.values_mm)
            if (!std::isfinite(v)) return input_error("a value is not finite", "drift watch");
        if (!std::isfinite(p.running_s) || !std::isfinite(p.pause_s))
            return input_error("a time is not finite", "drift watch");
        longest_s = std::max(longest_s, p.running_s);
    }
    auto [chart, cost] = chart_with(points, 0);
    LearntDriftChart warm = chart;
    double warm_cost = cost;
    // Up to twice what was seen: a curve whose end was not seen is refused, not cut off.
    constexpr int kSteps = 60;
    constexpr double kBegins = 50, kRange = 100;  // a fiftieth of what was seen; times the first
    for (int k = 0; longest_s > 0 && k <= kSteps; ++k) {
        auto [one, one_cost] = chart_with(points, longest_s * std::pow(kRange, 1.0 * k / kSteps) / kBegins);
        if (one_cost >= warm_cost) continue;
        warm = std::move(one);
        warm_cost = one_cost;
    }
    const double asked = chi_square_quantile(static_cast<double>(chart.mean_mm.size()) + 1, kWarmUpTold);
    if (cost - warm_cost > asked) {
        if (3 * warm.time_constant_s > longest_s)
            return input_error("the reference still wanders at the end of what was measured", "drift watch",
                               "let the cell run until it is warm and learn again");
        chart = std::move(warm);
    }
    std::vector<std::vector<double>> rows;
    for (const DriftLearning& p : points) {
        rows.push_back(p.values_mm);
        for (std::size_t d = 0; d < rows.back().size(); ++d)
            rows.back()[d] -= chart.mean_mm[d] +
                              cold_share(p.running_s, p.pause_s, chart.time_constant_s) * chart.warm_up_mm[d];
    }
    std::vector<DriftChannel> channels;
    for (const double sigma : chart.sigma_mm) channels.push_back({sigma, 0});
    DriftJudgement change;
    find_change(rows, channels, {.degrees = chart.degrees}, change);
    if (change.change != DriftChange::none)
        return input_error(change.change == DriftChange::step
                               ? Text("a step lies among the points that would be learnt from")
                               : Text("the reference moves among the points that would be learnt from"),
                           "drift watch", "learn from points of a cell that stands still: --points");
    return chart;
}

}  // namespace seamwright
