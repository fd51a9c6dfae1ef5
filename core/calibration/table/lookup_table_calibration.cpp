#include "core/calibration/table/lookup_table_calibration.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>

#include "core/calibration/pose_set.h"
#include "core/calibration/table/smooth_map.h"
#include "core/calibration/table/table_nodes.h"
#include "core/calibration/table/wrong_pairs.h"
#include "core/numbers.h"
#include "core/profile/units.h"

namespace seamwright {

using namespace lookup_table;
using Eigen::Index;
using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::VectorXd;

namespace {

constexpr std::int64_t kMostNodes = 16'000'000;
constexpr std::size_t kMostPairs = 100'000;

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
    std::vector<VectorXd> rows;
    std::vector<Matrix2d> slopes;
    for (const auto& p : places) {
        rows.push_back(map.spread_row(p));
        slopes.push_back(map.homography_slope(p));
        const Vector2d xz = map.at(p);
        report.parameters.push_back({fmt::format("x({:g},{:g})", p.x(), p.y()), xz.x(), "mm", 0});
        report.parameters.push_back({fmt::format("z({:g},{:g})", p.x(), p.y()), xz.y(), "mm", 0});
    }
    report.covariance.resize(2 * m, 2 * m);
    for (Index a = 0; a < m; ++a)
        for (Index b = 0; b < m; ++b)
            report.covariance.block<2, 2>(2 * a, 2 * b) =
                rows[static_cast<std::size_t>(a)].dot(rows[static_cast<std::size_t>(b)]) *
                slopes[static_cast<std::size_t>(a)] * map.noise() *
                slopes[static_cast<std::size_t>(b)].transpose();
    finish_statistics(report);
}

}  // namespace

Expected<LookupTableResult> calibrate_lookup_table(int width, int height, const std::vector<LaserPair>& pairs,
                                                   const LookupTableOptions& options) {
    if (width < 16 || height < 16 || width > 100000 || height > 100000)
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
    LookupTableResult result;
    auto& report = result.report;
    std::vector<std::string> excluded = options.exclude;
    std::sort(excluded.begin(), excluded.end());
    std::vector<char> allowed(pairs.size(), 1);
    double extent = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const auto& p = pairs[i];
        const std::string where = "pairs[" + p.id + "]";
        if (!p.pixel.allFinite() || !p.laser_mm.allFinite() || p.laser_mm.norm() > 1e6)
            return input_error("the pair is not made of finite numbers", where, "leave it out");
        if (p.pixel.x() < -1 || p.pixel.y() < -1 || p.pixel.x() > width || p.pixel.y() > height)
            return input_error(Text("the pixel ({:.1f}, {:.1f}) lies outside the image of {}x{}", p.pixel.x(),
                                    p.pixel.y(), width, height),
                               where, "check the size and the order [u, v]");
        allowed[i] = !std::binary_search(excluded.begin(), excluded.end(), p.id);
        report.poses.emplace_back();
        report.poses.back().id = p.id;
        report.poses.back().used = allowed[i];
        if (!allowed[i]) report.poses.back().note = "excluded";
        extent = std::max(extent, (p.laser_mm - pairs[0].laser_mm).norm());
    }
    const auto count = std::count(allowed.begin(), allowed.end(), 1);
    if (count < 6)
        return input_error(Text("{} pairs are too few, at least 6 are needed", count), "pairs",
                           "measure 25 or more positions over the whole field of view");
    SEAM_OK(check_span_millimetres(extent, "pairs"));

    const char* spread = "measure 25 or more positions over the whole field of view, near and far";
    const auto undetermined = [&](Text reason) {
        result.table = {};
        report.parameters.clear();
        report.covariance.resize(0, 0);
        report.correlations.clear();
        report.judgement = {Verdict::undetermined, std::move(reason), spread};
        return result;
    };
    const Samples all = chosen(pairs, allowed);
    if (!(flatness(all.pixel) > 0.01)) return undetermined("the pixels lie on one line of the image");
    if (!(flatness(all.laser) > 0.01)) return undetermined("the targets lie on one line of the laser plane");
    if (count < 9) return undetermined(Text("{} pairs cannot tell a wrong one from the others", count));
    SmoothMap map;
    std::vector<char> used;
    if (!fit_without_wrong(pairs, allowed, used, map))
        return undetermined("no smooth map explains the pairs");
    const Samples s = chosen(pairs, used);
    const auto n = static_cast<double>(s.pixel.size());
    if (3 * n < 2 * static_cast<double>(count))
        return undetermined(Text("the largest set of pairs that agree has {} of {}", s.pixel.size(), count));
    if (!(flatness(s.pixel) > 0.01) || !(flatness(s.laser) > 0.01))
        return undetermined("the pairs that agree lie on one line");
    const Support support(s.pixel);

    double square_px = 0, square_mm = 0;
    for (const auto& p : s.pixel) {
        const Matrix2d plane = map.homography_slope(p) * map.noise() * map.homography_slope(p).transpose();
        const Matrix2d inverse = map.slope(p).inverse();
        square_px += 0.5 * (inverse * plane * inverse.transpose()).trace() / n;
        square_mm += plane.trace() / n;
    }
    result.noise_px = std::sqrt(square_px);
    result.noise_mm = std::sqrt(square_mm);
    result.degree = map.degree();
    result.effective_parameters = map.effective();

    const auto interpolation = [&](double step) {
        double sum = 0;
        int cells = 0;
        const auto stride = std::max<std::size_t>(1, s.pixel.size() / 400);
        for (std::size_t i = 0; i < s.pixel.size(); i += stride) {
            const double e = table_error_mm(map, s.pixel[i] - Vector2d(step, step) / 2, step);
            if (std::isfinite(e)) sum += e * e, ++cells;
        }
        return cells ? std::sqrt(sum / cells) : 0.0;
    };
    double step = fine;
    if (step == 0) {
        for (const double candidate : {32.0, 16.0, 8.0, 4.0, 2.0}) {
            if (step > 0 && (width / candidate) * (height / candidate) > 400000) break;
            step = candidate;
            if (candidate <= 0.5 * support.spacing &&
                interpolation(candidate) <= std::max(0.2 * result.noise_mm, 1e-6))
                break;
        }
    }
    result.interpolation_mm = interpolation(step);
    int folded = 0;
    result.table = build_table(map, support, s.pixel, width, height, step, folded);
    const LookupTable& table = result.table;
    std::size_t filled = 0, rows = 0;
    double variance = 0, worst_variance = 0;
    const auto stride = std::max<std::size_t>(1, table.x_mm.size() / 4000);
    for (std::size_t k = 0; k < table.x_mm.size(); ++k) {
        if (std::isnan(table.x_mm[k])) {
            ++result.holes;
            continue;
        }
        if (filled++ % stride != 0) continue;
        const Vector2d p(static_cast<double>(k % static_cast<std::size_t>(table.columns)) * step,
                         static_cast<double>(k / static_cast<std::size_t>(table.columns)) * step);
        const Matrix2d carry = map.homography_slope(p);
        const double v = map.spread_row(p).squaredNorm() * (carry * map.noise() * carry.transpose()).trace();
        variance += v;
        worst_variance = std::max(worst_variance, v);
        ++rows;
    }
    result.covered_share = static_cast<double>(filled) / static_cast<double>(table.x_mm.size());
    if (rows > 0) {
        result.map_sigma_mm = std::sqrt(variance / static_cast<double>(rows));
        result.map_sigma_worst_mm = std::sqrt(worst_variance);
    }

    double forward = 0, backward = 0;
    int supported = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        auto& pose = report.poses[i];
        pose.used = used[i];
        const auto xz = table.at(pairs[i].pixel);
        const Vector2d e = (xz ? *xz : map.at(pairs[i].pixel)) - pairs[i].laser_mm;
        if (e.allFinite()) {
            pose.rms_mm = e.norm();
            const double px = (map.slope(pairs[i].pixel).inverse() * e).norm();
            if (std::isfinite(px)) pose.rms_px = px;
        }
        if (allowed[i] && !used[i]) {
            pose.note = "contradicts the pairs around it and was left out";
            continue;
        }
        if (!used[i]) continue;
        // The noise of an edge pair may have it land just outside the table's cells.
        const auto back = pixel_in_table(table, pairs[i].laser_mm, pairs[i].pixel);
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
    if (supported == 0) return undetermined("the pairs are too far apart to fill one cell of the table");
    result.forward_rms_mm = std::sqrt(forward / supported);
    result.backward_rms_px = std::sqrt(backward / supported);
    report.hold_out = leave_out(pairs, used, map);
    Vector2d middle = Vector2d::Zero();
    for (const auto& p : s.pixel) middle += p / n;
    describe(map, table, middle, report);

    Text wrong;
    int wrong_count = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i)
        if (allowed[i] && !used[i] && ++wrong_count <= 8) wrong = joined(wrong, ", ", pairs[i].id);
    if (wrong_count > 8) wrong = Text("{} and {} more", wrong, wrong_count - 8);
    const double hold_px = report.hold_out.rms_px / std::sqrt(2.0);  // per coordinate, as noise_px
    if (result.noise_px > 3 || hold_px > 3)
        report.judgement = {
            Verdict::poor,
            Text("the pairs fit to {:.1f} px only",
                 std::isfinite(hold_px) ? std::max(hold_px, result.noise_px) : result.noise_px),
            "check that pixels and laser points belong together"};
    else if (folded > 0)
        report.judgement = {Verdict::poor, Text("the map folds over in {} cells", folded),
                            "measure more positions there, or check the pairs nearby"};
    else if (wrong_count > 0)
        report.judgement = {Verdict::usable,
                            wrong_count == 1
                                ? Text("the pair {} contradicts the others and was left out", wrong)
                                : Text("the pairs {} contradict the others and were left out", wrong),
                            "measure again there"};
    else if (n < 25)
        report.judgement = {Verdict::usable, Text("{:.0f} pairs are few", n), spread};
    else if (result.covered_share < 0.5)
        report.judgement = {Verdict::usable,
                            Text("the table covers {:.0f} % of the image", 100 * result.covered_share),
                            "measure positions in the rest of the image, if the sensor is to see there"};
    else if (hold_px > std::max(1.6 * result.noise_px, 0.05))
        report.judgement = {Verdict::usable,
                            Text("between the pairs the map is off by {:.2f} px, at them by {:.2f}", hold_px,
                                 result.noise_px),
                            "measure positions closer together"};
    else
        report.judgement = {
            Verdict::good,
            Text("{:.0f} pairs fit to {:.3f} mm ({:.2f} px), the map is known to "
                 "{:.3f} mm over {:.0f} % of the image",
                 n, result.forward_rms_mm, result.noise_px, result.map_sigma_mm, 100 * result.covered_share),
            ""};
    return result;
}

}  // namespace seamwright
