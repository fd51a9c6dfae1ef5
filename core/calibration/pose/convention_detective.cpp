#include "core/calibration/pose/convention_detective.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/acceptance/distributions.h"

namespace seamwright {
namespace {

constexpr double kChance = 1e-3;
constexpr std::size_t kSolved = 6;  // in full, of those that the screen ranks
constexpr double kSamePose = 1e-6;  // mm, and of a rotation's entries

using PoseLists = std::vector<std::vector<Pose>>;

std::optional<PoseLists> read_all(std::span<const WrittenPoses> lists, const PoseReading& reading) {
    PoseLists all;
    for (std::size_t l = 0; l < lists.size(); ++l) {
        all.emplace_back();
        for (const PoseNumbers& numbers : lists[l].numbers) {
            auto pose = read_pose(numbers, reading.conventions[l]);
            if (!pose) return std::nullopt;
            all.back().push_back(*pose);
        }
    }
    return all;
}

bool same_poses(const PoseLists& a, const PoseLists& b) {
    for (std::size_t l = 0; l < a.size(); ++l)
        for (std::size_t i = 0; i < a[l].size(); ++i)
            if ((a[l][i].matrix() - b[l][i].matrix()).cwiseAbs().maxCoeff() > kSamePose) return false;
    return true;
}

// As given first.
std::vector<PoseReading> readings_of(std::span<const WrittenPoses> lists) {
    PoseReading given;
    for (const WrittenPoses& list : lists) given.conventions.push_back(list.as_given);
    std::vector<PoseReading> readings = {given};
    for (std::size_t l = 0; l < lists.size(); ++l)
        for (const PoseConvention& c : possible_conventions(lists[l].numbers, lists[l].as_given)) {
            if (c == lists[l].as_given) continue;
            readings.push_back(given);
            readings.back().conventions[l] = c;
        }
    if (lists.size() < 2) return readings;
    const PoseConvention& first = lists.front().as_given;
    const auto alike = [&](const WrittenPoses& list) { return list.as_given == first; };
    if (!std::all_of(lists.begin(), lists.end(), alike)) return readings;
    for (const PoseConvention& c : possible_conventions(lists.front().numbers, first)) {
        if (c == first || c.unit != first.unit || c.inverse != first.inverse) continue;
        readings.push_back(given);
        readings.back().conventions.assign(lists.size(), c);
    }
    return readings;
}

// Readings that give the same poses are one solution.
struct ReadSolution {
    PoseLists poses;
    std::vector<PoseReading> readings;  // in the order tried; the first holds the fit until all have one
    bool full = true;                   // solved by more than the screen
    bool fits() const { return readings.front().fit && readings.front().fit->fits; }
    double variance() const {
        const auto& fit = readings.front().fit;
        return fit && std::isfinite(fit->variance) ? fit->variance : std::numeric_limits<double>::infinity();
    }
};

double limit_of(const ConventionFit& second, const ConventionFit& best, int tried) {
    return f_quantile(std::max(1.0, second.freedom), std::max(1.0, best.freedom), 1 - kChance / tried);
}

bool by_variance(const ReadSolution& a, const ReadSolution& b) {
    return a.variance() < b.variance();
}

Text millimetres(const PoseReading& reading) {
    return reading.fit ? Text("{:.3g} mm", reading.fit->residual_mm) : Text("not at all");
}

}  // namespace

std::string_view name_of(ConventionFinding finding) {
    switch (finding) {
        case ConventionFinding::named:
            return "named";
        case ConventionFinding::as_given:
            return "as_given";
        default:
            return "cannot_tell";
    }
}

Text words_of(const PoseReading& reading, std::span<const WrittenPoses> lists) {
    std::vector<Text> changed;
    for (std::size_t l = 0; l < lists.size(); ++l)
        if (!(reading.conventions[l] == lists[l].as_given))
            changed.push_back(Text("{} read as {}", lists[l].name, words_of(reading.conventions[l])));
    if (!changed.empty()) return listed(changed);
    for (std::size_t l = 0; l < lists.size(); ++l)
        changed.push_back(Text("{} as given, {}", lists[l].name, words_of(lists[l].as_given)));
    return listed(changed);
}

DetectedConvention detect_convention(std::span<const WrittenPoses> lists, const PoseFit& fit,
                                     const PoseFit& screen) {
    DetectedConvention found;
    const std::vector<PoseReading> readings = readings_of(lists);
    std::vector<ReadSolution> solutions;
    for (const PoseReading& reading : readings) {
        const bool first = ++found.tried == 1;
        auto poses = read_all(lists, reading);
        if (poses) {
            const auto known = std::find_if(solutions.begin(), solutions.end(), [&](const ReadSolution& s) {
                return same_poses(s.poses, *poses);
            });
            if (known != solutions.end()) {
                known->readings.push_back(reading);
            } else {
                auto solved = first || !screen ? fit(*poses) : screen(*poses);
                solutions.push_back({std::move(*poses), {reading}});
                solutions.back().readings[0].fit = solved;
                solutions.back().full = first || !screen;
            }
        }
        if (!first) continue;
        found.as_given = solutions.empty() ? reading : solutions[0].readings[0];
        if (!found.as_given.fit || found.as_given.fit->verdict != Verdict::good) continue;
        found.finding = ConventionFinding::as_given;
        found.best = found.as_given;
        found.sentence = Text("the poses fit as they are read, {} ({})", millimetres(found.as_given),
                              words_of(reading, lists));
        return found;
    }
    std::stable_sort(solutions.begin(), solutions.end(), by_variance);
    for (std::size_t i = 0; i < std::min(kSolved, solutions.size()); ++i)
        if (!solutions[i].full)
            if (auto solved = fit(solutions[i].poses)) solutions[i].readings[0].fit = solved;
    for (ReadSolution& s : solutions)
        for (PoseReading& reading : s.readings) reading.fit = s.readings[0].fit;
    std::stable_sort(solutions.begin(), solutions.end(), by_variance);
    const auto best =
        std::find_if(solutions.begin(), solutions.end(), [](const auto& s) { return s.fits(); });
    if (best == solutions.end()) {
        if (solutions.empty() || std::isinf(solutions.front().variance())) {
            found.sentence =
                Text("none of {} ways to read the poses fits: look for the cause elsewhere", found.tried);
            return found;
        }
        found.best = solutions.front().readings.front();
        if (solutions.size() > 1 && !std::isinf(solutions[1].variance()))
            found.second = solutions[1].readings.front();
        found.sentence = Text(
            "none of {} ways to read the poses fits, the best leaves {} ({}): look for the cause elsewhere",
            found.tried, millimetres(*found.best), words_of(*found.best, lists));
        return found;
    }
    std::rotate(solutions.begin(), best, best + 1);
    const ReadSolution& first = solutions.front();
    found.best = first.readings.front();
    const ConventionFit& best_fit = *found.best->fit;
    double second_variance = std::numeric_limits<double>::infinity();
    if (solutions.size() > 1 && !std::isinf(solutions[1].variance())) {
        found.second = solutions[1].readings.front();
        second_variance = solutions[1].variance();
        found.limit = limit_of(*found.second->fit, best_fit, found.tried);
    }
    found.ratio = second_variance / best_fit.variance;
    const bool alone = !(found.ratio <= found.limit);
    const bool given_fits = found.as_given.fit && found.as_given.fit->fits;
    const bool given_is_best = found.best->conventions == found.as_given.conventions;
    if (given_is_best || (given_fits && !alone)) {
        found.finding = ConventionFinding::as_given;
        found.best = found.as_given;
        found.sentence = Text("the poses fit as they are read, {} ({})", millimetres(found.as_given),
                              words_of(found.as_given, lists));
        return found;
    }
    if (first.readings.size() > 1) {
        found.second = first.readings[1];
        found.equal_poses = true;
        found.ratio = 1;
    }
    if (!alone || found.equal_poses) {
        found.sentence =
            found.equal_poses
                ? Text("{} and {} are the same poses here ({}): these data cannot tell them apart",
                       words_of(*found.best, lists), words_of(*found.second, lists), millimetres(*found.best))
                : Text("{} ({}) and {} ({}) fit about equally well: these data cannot tell them apart",
                       words_of(*found.best, lists), millimetres(*found.best), words_of(*found.second, lists),
                       millimetres(*found.second));
        return found;
    }
    found.finding = ConventionFinding::named;
    found.sentence = Text("{} fits far better than any other way: {}, as given {}, the next {}",
                          words_of(*found.best, lists), millimetres(*found.best), millimetres(found.as_given),
                          found.second ? millimetres(*found.second) : Text("not at all"));
    return found;
}

}  // namespace seamwright
