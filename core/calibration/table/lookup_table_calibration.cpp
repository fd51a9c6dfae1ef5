#include "core/calibration/table/lookup_table_calibration.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "core/calibration/camera/camera_limits.h"
#include "core/calibration/numbers.h"
#include "core/calibration/pose_set.h"
#include "core/calibration/table/smooth_map.h"
#include "core/calibration/table/table_nodes.h"
#include "core/calibration/table/wrong_groups.h"
#include "core/calibration/table/wrong_pairs.h"
#include "core/numbers.h"
#include "core/profile/units.h"

namespace seamwright {

using namespace lookup_table;
using Eigen::Index;
using Eigen::Matrix2d;
using Eigen::Vector2d;

namespace {

constexpr std::int64_t kMostNodes = 16'000'000;
constexpr std::size_t kMostPairs = 100'000;
constexpr int kFewestPairs = 6;       // to begin with
constexpr int kFewestToCompare = 9;   // to tell a wrong one
constexpr double kHalfCovered = 0.5;  // of the image, below
// Between the pairs the map may be off by that much more than at them, or by so much.
constexpr double kBetweenTimes = 1.6, kBetween_px = 0.05;
constexpr int kManyPairs = 25;
constexpr const char* kSpreadPairs =
    "measure 25 or more positions over the whole field of view, near and far";

// Spread across the main direction relative to along it; 0: all on one line.
double flatness(const std::vector<Vector2d>& points) {
    Vector2d mean = Vector2d::Zero();
    for (const auto& p : points) mean += p / static_cast<double>(points.size());
    Matrix2d scatter = Matrix2d::Zero();
    for (const auto& p : points) scatter += (p - mean) * (p - mean).transpose();
    const Vector2d l = Eigen::SelfAdjointEigenSolver<Matrix2d>().computeDirect(scatter).eigenvalues();
    return l(1) > 0 ? std::sqrt(std::max(0.0, l(0)) / l(1)) : 0;
}

// Predicts each fold from the others, with the degree of the whole.
HoldOut leave_out(const std::vector<LaserPair>& pairs, const std::vector<char>& used,
                  const SmoothMap& whole) {
    HoldOut out;
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < pairs.size(); ++i)
        if (used[i]) order.push_back(i);
    if (order.size() < 12) return out;
    // Shuffled: the pairs may come row by row, and a fold must not be a column of a grid.
    std::mt19937 random(7);
    std::shuffle(order.begin(), order.end(), random);
    const std::size_t folds = order.size() > 5000 ? 5 : 10;
    double mm = 0, px = 0, most = 0;
    int counted = 0;
    for (std::size_t fold = 0; fold < folds; ++fold) {
        std::vector<char> rest = used;
        std::vector<std::size_t> tested;
        for (std::size_t k = fold; k < order.size(); k += folds) {
            rest[order[k]] = 0;
            tested.push_back(order[k]);
        }
        const Samples s = chosen(pairs, rest);
        SmoothMap map;
        if (!map.fit(s, std::min(whole.degree(), 2), whole.degree())) continue;
        const Support support(s.pixel);
        ++out.folds;
        out.left_out = std::max(out.left_out, static_cast<int>(tested.size()));
        for (const std::size_t i : tested) {
            if (outside(support.hull, pairs[i].pixel) > 0) continue;
            const Vector2d e = map.at(pairs[i].pixel) - pairs[i].laser_mm;
            const Vector2d p = whole.slope(pairs[i].pixel).inverse() * e;
            if (!e.allFinite() || !p.allFinite()) continue;
            mm += e.squaredNorm();
            px += p.squaredNorm();
            most = std::max(most, e.norm());
            ++counted;
        }
    }
    if (counted == 0) return {};
    out.rms_mm = std::sqrt(mm / counted);
    out.rms_px = std::sqrt(px / counted);
    out.max_mm = most;
    return out;
}

// Table at the middle of the samples and at four nodes towards the corners.
void describe(const SmoothMap& map, const LookupTable& t, const Vector2d& middle, CalibrationReport& report) {
    std::vector<Vector2d> places;
    const auto pick = [&](const auto& cost) {
        double least = kInfinity;
        Vector2d at(kNaN, kNaN);
        for (int j = 0; j < t.rows; ++j)
            for (int i = 0; i < t.columns; ++i) {
                const auto n = static_cast<std::size_t>(j) * static_cast<std::size_t>(t.columns) +
                               static_cast<std::size_t>(i);
                if (std::isnan(t.x_mm[n])) continue;
                const Vector2d p(i * t.step_u, j * t.step_v);
                const double c = cost(p);
                if (c < least) least = c, at = p;
            }
        if (at.allFinite() && std::find(places.begin(), places.end(), at) == places.end())
            places.push_back(at);
    };
    pick([&](const Vector2d& p) { return (p - middle).squaredNorm(); });
    for (const Vector2d& corner : {Vector2d(-1, -1), Vector2d(1, -1), Vector2d(1, 1), Vector2d(-1, 1)})
        pick([&](const Vector2d& p) { return -(p - middle).dot(corner); });
    const auto m = static_cast<Index>(places.size());
    std::vector<SmoothMap::Known> known;
    std::vector<Matrix2d> slopes;
    for (const auto& p : places) {
        known.push_back(map.known(p));
        slopes.push_back(map.homography_slope(p));
        const Vector2d xz = map.at(p);
        report.parameters.push_back({fmt::format("x({:g},{:g})", p.x(), p.y()), xz.x(), "mm", 0});
        report.parameters.push_back({fmt::format("z({:g},{:g})", p.x(), p.y()), xz.y(), "mm", 0});
    }
    report.covariance.resize(2 * m, 2 * m);
    for (Index a = 0; a < m; ++a)
        for (Index b = 0; b < m; ++b)
            report.covariance.block<2, 2>(2 * a, 2 * b) =
                slopes[static_cast<std::size_t>(a)] *
                known[static_cast<std::size_t>(a)].with(known[static_cast<std::size_t>(b)], map.noise()) *
                slopes[static_cast<std::size_t>(b)].transpose();
    finish_statistics(report);
}

Expected<void> check_request(int width, int height, const std::vector<LaserPair>& pairs,
                             const LookupTableOptions& options) {
    if (width < kSmallestImage_px || height < kSmallestImage_px || width > kLargestImage_px ||
        height > kLargestImage_px)
        return input_error(Text("an image of {}x{} pixels is not possible", width, height), "size",
                           "give [width, height] in pixels");
    const double fine = options.step_px;
    if (fine != 0 &&
        (!(fine > 0) || !std::isfinite(fine) || fine > std::max(width, height) ||
         (std::ceil((width - 1) / fine) + 1) * (std::ceil((height - 1) / fine) + 1) > kMostNodes))
        return input_error(Text("a step of {} px is not possible for {}x{} pixels", fine, width, height),
                           "step_px", "give e.g. 8");
    if (pairs.size() > kMostPairs)
        return input_error(Text("{} pairs are too many", pairs.size()), "pairs",
                           "thin them out to 100000 or fewer");
    std::vector<std::string> ids;
    for (const auto& p : pairs) ids.push_back(p.id);
    SEAM_OK(check_ids(ids, options.exclude, "pairs"));
    double extent = 0;
    for (const auto& p : pairs) {
        const std::string where = "pairs[" + p.id + "]";
        if (!p.pixel.allFinite() || !p.laser_mm.allFinite() || p.laser_mm.norm() > kFarthestPoint_mm)
            return input_error("the pair is not made of finite numbers", where, "leave it out");
        if (p.pixel.x() < -1 || p.pixel.y() < -1 || p.pixel.x() > width || p.pixel.y() > height)
            return input_error(Text("the pixel ({:.1f}, {:.1f}) lies outside the image of {}x{}", p.pixel.x(),
                                    p.pixel.y(), width, height),
                               where, "check the size and the order [u, v]");
        extent = std::max(extent, (p.laser_mm - pairs[0].laser_mm).norm());
    }
    std::vector<std::string> excluded = options.exclude;
    std::sort(excluded.begin(), excluded.end());
    const auto left_out = std::count_if(pairs.begin(), pairs.end(), [&](const LaserPair& p) {
        return std::binary_search(excluded.begin(), excluded.end(), p.id);
    });
    const auto count = static_cast<std::ptrdiff_t>(pairs.size()) - left_out;
    if (count < kFewestPairs)
        return input_error(Text("{} pairs are too few, at least 6 are needed", count), "pairs",
                           "measure 25 or more positions over the whole field of view");
    return check_span_millimetres(extent, "pairs");
}

// Every pair in the report; which ones may be used.
std::vector<char> begin_report(const std::vector<LaserPair>& pairs, std::vector<std::string> excluded,
                               CalibrationReport& report) {
    std::sort(excluded.begin(), excluded.end());
    std::vector<char> allowed;
    for (const auto& p : pairs) {
        allowed.push_back(!std::binary_search(excluded.begin(), excluded.end(), p.id));
        report.poses.emplace_back();
        report.poses.back().id = p.id;
        report.poses.back().used = allowed.back();
        if (!allowed.back()) report.poses.back().note = "excluded";
    }
    return allowed;
}

// The smooth map through the pairs that agree.
struct Fitted {
    SmoothMap map;
    std::vector<char> used;
    Samples samples;
    double count() const { return static_cast<double>(samples.pixel.size()); }
};

// The reason why there is none; empty: there is.
Text fit_agreeing(const std::vector<LaserPair>& pairs, const std::vector<char>& allowed, Fitted& fitted) {
    const auto count = std::count(allowed.begin(), allowed.end(), 1);
    const Samples all = chosen(pairs, allowed);
    if (!(flatness(all.pixel) > kPairsOnALine)) return "the pixels lie on one line of the image";
    if (!(flatness(all.laser) > kPairsOnALine)) return "the targets lie on one line of the laser plane";
    if (count < kFewestToCompare) return Text("{} pairs cannot tell a wrong one from the others", count);
    if (!fit_without_wrong(pairs, allowed, fitted.used, fitted.map))
        return "no smooth map explains the pairs";
    fitted.samples = chosen(pairs, fitted.used);
    const Samples& s = fitted.samples;
    if (3 * fitted.count() < 2 * static_cast<double>(count))
        return Text("the largest set of pairs that agree has {} of {}", s.pixel.size(), count);
    if (!(flatness(s.pixel) > kPairsOnALine) || !(flatness(s.laser) > kPairsOnALine))
        return "the pairs that agree lie on one line";
    return {};
}

void state_noise(const Fitted& fitted, LookupTableResult& result) {
    double square_px = 0, square_mm = 0;
    for (const auto& p : fitted.samples.pixel) {
        const Matrix2d carry = fitted.map.homography_slope(p);
        const Matrix2d plane = carry * fitted.map.noise() * carry.transpose();
        const Matrix2d inverse = fitted.map.slope(p).inverse();
        square_px += 0.5 * (inverse * plane * inverse.transpose()).trace() / fitted.count();
        square_mm += plane.trace() / fitted.count();
    }
    result.noise_px = std::sqrt(square_px);
    result.noise_mm = std::sqrt(square_mm);
    result.degree = fitted.map.degree();
    result.effective_parameters = fitted.map.effective();
}

// What cells of this size err by between their nodes, at some of the pairs.
double interpolation_mm(const Fitted& fitted, double step) {
    constexpr std::size_t kPlaces = 400;
    const auto& pixels = fitted.samples.pixel;
    double sum = 0;
    int cells = 0;
    for (std::size_t i = 0; i < pixels.size(); i += std::max<std::size_t>(1, pixels.size() / kPlaces)) {
        const double e = table_error_mm(fitted.map, pixels[i] - Vector2d(step, step) / 2, step);
        if (std::isfinite(e)) sum += e * e, ++cells;
    }
    return cells ? std::sqrt(sum / cells) : 0.0;
}

// The largest cells that err by far less than the noise and are no larger than the pairs lie apart.
double suitable_step(const Fitted& fitted, const Support& support, int width, int height, double noise_mm) {
    constexpr double kMostCells = 400000, kShareOfNoise = 0.2, kExact_mm = 1e-6;
    constexpr double kShareOfSpacing = 0.5;
    constexpr std::array kSteps_px{32.0, 16.0, 8.0, 4.0, 2.0};
    double step = 0;
    for (const double candidate : kSteps_px) {
        if (step > 0 && (width / candidate) * (height / candidate) > kMostCells) break;
        step = candidate;
        if (candidate <= kShareOfSpacing * support.spacing &&
            interpolation_mm(fitted, candidate) <= std::max(kShareOfNoise * noise_mm, kExact_mm))
            break;
    }
    return step;
}

// Holes, how much of the image is covered, and what the map is known to there.
void state_cover(const SmoothMap& map, LookupTableResult& result) {
    constexpr std::size_t kPlaces = 4000;
    const LookupTable& table = result.table;
    std::size_t filled = 0, rows = 0;
    double variance = 0, worst_variance = 0;
    const auto stride = std::max<std::size_t>(1, table.x_mm.size() / kPlaces);
    const auto columns = static_cast<std::size_t>(table.columns);
    for (std::size_t k = 0; k < table.x_mm.size(); ++k) {
        if (std::isnan(table.x_mm[k])) {
            ++result.holes;
            continue;
        }
        if (filled++ % stride != 0) continue;
        const Vector2d p(static_cast<double>(k % columns) * table.step_u,
                         static_cast<double>(k / columns) * table.step_v);
        const Matrix2d carry = map.homography_slope(p);
        const auto known = map.known(p);
        const double v = (carry * known.with(known, map.noise()) * carry.transpose()).trace();
        variance += v;
        worst_variance = std::max(worst_variance, v);
        ++rows;
    }
    result.covered_share = static_cast<double>(filled) / static_cast<double>(table.x_mm.size());
    if (rows > 0) {
        result.map_sigma_mm = std::sqrt(variance / static_cast<double>(rows));
        result.map_sigma_worst_mm = std::sqrt(worst_variance);
    }
}

// How the finished table meets the pairs, there and back. False: it supports none of them.
bool state_pairs(const std::vector<LaserPair>& pairs, const std::vector<char>& allowed, const Fitted& fitted,
                 LookupTableResult& result) {
    double forward = 0, backward = 0;
    int supported = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        auto& pose = result.report.poses[i];
        pose.used = fitted.used[i];
        const auto xz = result.table.at(pairs[i].pixel);
        const Vector2d e = (xz ? *xz : fitted.map.at(pairs[i].pixel)) - pairs[i].laser_mm;
        if (e.allFinite()) {
            pose.rms_mm = e.norm();
            const double px = (fitted.map.slope(pairs[i].pixel).inverse() * e).norm();
            if (std::isfinite(px)) pose.rms_px = px;
        }
        if (allowed[i] && !fitted.used[i]) {
            pose.note = "contradicts the pairs around it and was left out";
            continue;
        }
        if (!fitted.used[i]) continue;
        // The noise of an edge pair may have it land just outside the table's cells.
        const auto back = pixel_in_table(result.table, pairs[i].laser_mm, pairs[i].pixel);
        if (!xz) {
            ++result.unsupported_pairs;
            pose.note = "beside a hole of the table";
            continue;
        }
        forward += e.squaredNorm();
        result.forward_max_mm = std::max(result.forward_max_mm, e.norm());
        ++supported;
        if (!back) continue;
        const double px = (*back - pairs[i].pixel).norm();
        pose.rms_px = px;
        backward += px * px;
        result.backward_max_px = std::max(result.backward_max_px, px);
    }
    if (supported == 0) return false;
    result.forward_rms_mm = std::sqrt(forward / supported);
    result.backward_rms_px = std::sqrt(backward / supported);
    return true;
}

Judgement judged(const LookupTableResult& result, double count, int folded, const Text& wrong,
                 int wrong_count, const std::optional<WrongGroup>& group) {
    const double hold_px = result.report.hold_out.rms_px / std::sqrt(2.0);  // per coordinate, as noise_px
    if (result.noise_px > kPoorPairs_px || hold_px > kPoorPairs_px)
        return {Verdict::poor,
                Text("the pairs fit to {:.1f} px only",
                     std::isfinite(hold_px) ? std::max(hold_px, result.noise_px) : result.noise_px),
                "check that pixels and laser points belong together"};
    if (group)
        return {Verdict::poor,
                group->of_x ? Text("the positions at x = {:g} contradict the others by {:.2f} mm",
                                   group->at_mm, group->shift_mm.norm())
                            : Text("the positions at z = {:g} contradict the others by {:.2f} mm",
                                   group->at_mm, group->shift_mm.norm()),
                "measure these positions again, or leave them out"};
    if (folded > 0)
        return {Verdict::poor, Text("the map folds over in {} cells", folded),
                "measure more positions there, or check the pairs nearby"};
    if (wrong_count > 0)
        return {Verdict::usable,
                wrong_count == 1 ? Text("the pair {} contradicts the others and was left out", wrong)
                                 : Text("the pairs {} contradict the others and were left out", wrong),
                "measure again there"};
    if (count < kManyPairs) return {Verdict::usable, Text("{:.0f} pairs are few", count), kSpreadPairs};
    if (result.covered_share < kHalfCovered)
        return {Verdict::usable, Text("the table covers {:.0f} % of the image", 100 * result.covered_share),
                "measure positions in the rest of the image, if the sensor is to see there"};
    if (hold_px > std::max(kBetweenTimes * result.noise_px, kBetween_px))
        return {Verdict::usable,
                Text("between the pairs the map is off by {:.2f} px, at them by {:.2f}", hold_px,
                     result.noise_px),
                "measure positions closer together"};
    return {
        Verdict::good,
        Text("{:.0f} pairs fit to {:.3f} mm ({:.2f} px), the map is known to "
             "{:.3f} mm over {:.0f} % of the image",
             count, result.forward_rms_mm, result.noise_px, result.map_sigma_mm, 100 * result.covered_share),
        ""};
}

// The first few by name.
Text names_of_wrong(const std::vector<LaserPair>& pairs, const std::vector<char>& allowed,
                    const std::vector<char>& used, int& count) {
    constexpr int kNamed = 8;
    Text wrong;
    count = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i)
        if (allowed[i] && !used[i] && ++count <= kNamed) wrong = joined(wrong, ", ", pairs[i].id);
    return count > kNamed ? Text("{} and {} more", wrong, count - kNamed) : wrong;
}

}  // namespace

Expected<LookupTableResult> calibrate_lookup_table(int width, int height, const std::vector<LaserPair>& pairs,
                                                   const LookupTableOptions& options) {
    SEAM_OK(check_request(width, height, pairs, options));
    LookupTableResult result;
    auto& report = result.report;
    const std::vector<char> allowed = begin_report(pairs, options.exclude, report);
    const auto undetermined = [&](Text reason) {
        result.table = {};
        report.judgement = {Verdict::undetermined, std::move(reason), kSpreadPairs};
        return result;
    };
    Fitted fitted;
    if (Text reason = fit_agreeing(pairs, allowed, fitted); !reason.empty()) return undetermined(reason);
    const auto& pixels = fitted.samples.pixel;
    const Support support(pixels);
    fitted.map.state_places(fitted.samples, options.place_sigma_mm);
    state_noise(fitted, result);
    fitted.map.state_rows(row_sigmas_mm(fitted.samples, width, height, result.noise_px));
    const double step = options.step_px != 0 ? options.step_px
                                             : suitable_step(fitted, support, width, height, result.noise_mm);
    result.interpolation_mm = interpolation_mm(fitted, step);
    int folded = 0;
    result.table = build_table(fitted.map, support, pixels, width, height, step, folded);
    state_cover(fitted.map, result);
    if (!state_pairs(pairs, allowed, fitted, result))
        return undetermined("the pairs are too far apart to fill one cell of the table");
    report.hold_out = leave_out(pairs, fitted.used, fitted.map);
    Vector2d middle = Vector2d::Zero();
    for (const auto& p : pixels) middle += p / fitted.count();
    describe(fitted.map, result.table, middle, report);
    int wrong_count = 0;
    const Text wrong = names_of_wrong(pairs, allowed, fitted.used, wrong_count);
    report.judgement = judged(result, fitted.count(), folded, wrong, wrong_count,
                              wrong_group(fitted.samples, width, height, result.noise_px));
    return result;
}

}  // namespace seamwright
