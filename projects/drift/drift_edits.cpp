#include "projects/drift/drift_edits.h"

#include <algorithm>
#include <cmath>

#include "projects/drift/drift_point.h"
#include "projects/drift/drift_standing.h"

namespace seamwright {
namespace {

Expected<void> in_range(double value, double least, double most, const char* name) {
    if (value >= least && value <= most) return {};
    return input_error(Text("{} is {}, which is not within {} to {}", name, value, least, most),
                       "drift watch", "give a number within");
}

Expected<void> has_watch(const Project& project) {
    if (project.drift) return {};
    return input_error("the project watches no reference", "drift watch",
                       "name its spots first: drift FILE.seam set --spots W1");
}

bool stopped(const Project& project, std::span<const DriftPoint> points) {
    return drift_standing(project, points, {}, 0).stopped;
}

}  // namespace

Expected<void> set_drift_watch(Project& project, const DriftSettings& settings) {
    DriftWatch watch = project.drift.value_or(DriftWatch{});
    if (!settings.spot_ids.empty() && settings.spot_ids != watch.spot_ids) {
        watch.spot_ids = settings.spot_ids;
        watch.learnt.reset();
        watch.compensate = false;
    }
    if (settings.every_parts) {
        SEAM_OK(in_range(*settings.every_parts, 0, 1e6, "every_parts"));
        watch.every_parts = *settings.every_parts;
    }
    if (settings.every_minutes) {
        SEAM_OK(in_range(*settings.every_minutes, 0, 1e6, "every_minutes"));
        watch.every_minutes = *settings.every_minutes;
    }
    if (settings.limit_mm) {
        SEAM_OK(in_range(*settings.limit_mm, 1e-3, 10, "limit_mm"));
        watch.limit_mm = *settings.limit_mm;
    }
    if (settings.pause_minutes) {
        SEAM_OK(in_range(*settings.pause_minutes, 1e-3, 1e5, "pause_minutes"));
        watch.pause_minutes = *settings.pause_minutes;
    }
    SEAM_OK(check_drift_watch(project, watch));
    project.drift = std::move(watch);
    return {};
}

Expected<void> learn_drift_watch(Project& project, std::span<const DriftPoint> points, std::size_t newest,
                                 const std::string& now_utc) {
    SEAM_OK(has_watch(project));
    DriftWatch& watch = *project.drift;
    SEAM_OK(check_drift_watch(project, watch));
    if (stopped(project, points))
        return input_error("a step was not acknowledged", "drift watch", "acknowledge it first");
    const std::uint32_t mark = drift_mark(project, watch);
    std::vector<const DriftPoint*> used;
    for (const DriftPoint& p : points) {
        const bool aside = std::any_of(
            watch.set_aside.begin(), watch.set_aside.end(),
            [&](const SetAside& range) { return p.id >= range.first_point && p.id <= range.last_point; });
        if (p.mark == mark && !aside && p.values_mm.size() == 2 * watch.spot_ids.size()) used.push_back(&p);
    }
    if (newest > 0 && used.size() > newest)
        used.erase(used.begin(), used.end() - static_cast<std::ptrdiff_t>(newest));
    std::vector<DriftLearning> learning;
    for (const DriftPoint* p : used) learning.push_back({p->values_mm, p->running_s, p->pause_s});
    SEAM_TRY(const LearntDriftChart chart, learn_drift(learning));
    LearntDrift learnt;
    learnt.utc = now_utc;
    learnt.first_point = used.front()->id;
    learnt.last_point = used.back()->id;
    learnt.points = static_cast<int>(used.size());
    learnt.degrees = chart.degrees;
    learnt.time_constant_s = chart.time_constant_s;
    learnt.mark = mark;
    for (std::size_t d = 0; d < chart.mean_mm.size(); ++d) {
        double variance = 0;
        for (const DriftPoint* p : used)
            if (d < p->sigma_mm.size())
                variance += p->sigma_mm[d] * p->sigma_mm[d] / static_cast<double>(used.size());
        learnt.directions.push_back({watch.spot_ids[d / 2], d % 2 == 0 ? 0 : 2, chart.mean_mm[d],
                                     chart.sigma_mm[d], std::sqrt(variance), chart.warm_up_mm[d]});
    }
    watch.learnt = std::move(learnt);
    return {};
}

Expected<void> switch_compensation(Project& project, std::span<const DriftPoint> points, bool on,
                                   DriftOf drifts, double most_mm, const std::string& now_utc) {
    SEAM_OK(has_watch(project));
    DriftWatch& watch = *project.drift;
    const Text where("drift compensation");
    if (!on && !watch.compensate) return input_error("it is off already", where);
    if (on) {
        if (watch.compensate && watch.drifts == drifts && watch.most_mm == most_mm)
            return input_error("it is on already", where);
        if (!watch.learnt)
            return input_error("nothing is learnt", where, "learn first: drift FILE.seam learn");
        if (stopped(project, points))
            return input_error("a step was not acknowledged", where, "acknowledge it first");
        SEAM_OK(in_range(most_mm, 1e-3, kMostCompensatedMm, "most_mm"));
        watch.drifts = drifts;
        watch.most_mm = most_mm;
    }
    watch.compensate = on;
    watch.switched_utc = now_utc;
    return {};
}

Expected<SetAside> acknowledge_step(Project& project, std::span<const DriftPoint> points,
                                    const std::string& by, const std::string& text,
                                    const std::string& now_utc) {
    SEAM_OK(has_watch(project));
    if (by.empty()) return input_error("nobody is named who looked", "drift watch", "say who: --by NAME");
    const DriftStanding standing = drift_standing(project, points, now_utc, 0);
    if (!standing.stopped)
        return input_error("there is no step to acknowledge", "drift watch", "see: drift FILE.seam status");
    SetAside range{standing.stopped_by, points.back().id, now_utc, by, text};
    const auto at = std::find_if(points.begin(), points.end(),
                                 [&](const DriftPoint& p) { return p.id == standing.stopped_by; });
    // A small step was told some points after it came.
    for (auto p = at; p != points.begin() && at - p + 1 < at->changed; --p)
        range.first_point = std::prev(p)->id;
    project.drift->set_aside.push_back(range);
    return range;
}

}  // namespace seamwright
