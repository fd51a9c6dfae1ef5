#include "projects/drift/drift_keeper.h"

#include <algorithm>

#include "core/number_text.h"
#include "devices/capture/capture.h"
#include "projects/drift/drift_point.h"

namespace seamwright {
namespace {

int badness(DriftVerdict verdict) {
    return verdict == DriftVerdict::learning ? 0 : static_cast<int>(verdict);
}

}  // namespace

std::optional<double> exact_utc_seconds(const std::string& utc) {
    const auto whole = utc_seconds(utc);
    if (!whole) return std::nullopt;
    const auto dot = utc.find('.');
    const std::string digits = dot == std::string::npos ? "" : utc.substr(dot + 1, 3);
    return static_cast<double>(*whole) + 1e-3 * number_from<int>(digits).value_or(0);
}

Expected<void> DriftKeeper::load(const ProjectFile& file, std::int64_t run) {
    SEAM_TRY(points_, file.drift_points(static_cast<std::int64_t>(kDriftKept)));
    SEAM_TRY(const auto runs, file.runs());
    last_s_.reset();
    parts_since_ = 0;
    const std::int64_t last_run = points_.empty() ? 0 : points_.back().run;
    for (const RunSummary& r : runs) {
        if (r.number == run) continue;
        if (const auto end = exact_utc_seconds(r.finished_utc)) last_s_ = end;
        parts_since_ += r.number > last_run;
    }
    if (!points_.empty()) {
        const auto at = exact_utc_seconds(points_.back().utc);
        session_s_ = at.value_or(0) - points_.back().running_s;
        pause_s_ = points_.back().pause_s;
        if (!last_s_) last_s_ = at;
    } else {
        session_s_ = last_s_.value_or(0);
        pause_s_ = -1;
    }
    loaded_ = true;
    return {};
}

Expected<DriftTaken> DriftKeeper::take(ProjectFile& file, const Project& project, const RunRecord& run) {
    DriftTaken taken;
    SEAM_TRY(auto watch, file.load_drift_watch());
    if (!watch) return taken;
    if (!loaded_) SEAM_OK(load(file, run.number));
    Project now = project;
    now.drift = std::move(watch);

    const double began_s = exact_utc_seconds(run.started_utc).value_or(0);
    if (!last_s_ || began_s - *last_s_ > 60 * now.drift->pause_minutes) {
        pause_s_ = last_s_ ? began_s - *last_s_ : -1;
        session_s_ = began_s;
    }
    last_s_ = began_s;
    ++parts_since_;
    if (auto point = drift_point(now, *now.drift, run)) {
        point->running_s = std::max(0.0, began_s - session_s_);
        point->pause_s = pause_s_;
        const bool stopped = drift_standing(now, points_, run.started_utc, 0).stopped;
        judge_point(now, points_, *point);
        SEAM_TRY(point->id, file.append_drift_point(*point));
        taken.stopped_now = point->step && !stopped;
        taken.worse =
            badness(point->verdict) > (points_.empty() ? 1 : std::max(1, badness(points_.back().verdict)));
        points_.push_back(*point);
        // One that stopped production is never forgotten.
        const auto forgotten =
            std::find_if(points_.begin(), points_.end(), [](const DriftPoint& p) { return !p.step; });
        if (points_.size() > kDriftKept && forgotten != points_.end()) points_.erase(forgotten);
        parts_since_ = 0;
        taken.point = std::move(point);
    }
    taken.standing = drift_standing(now, points_, run.started_utc, parts_since_);
    return taken;
}

Expected<DriftStanding> stored_standing(const ProjectFile& file, const Project& project,
                                        const std::string& now_utc) {
    if (!project.drift) return DriftStanding{};
    SEAM_TRY(const auto points, file.drift_points(static_cast<std::int64_t>(kDriftKept)));
    SEAM_TRY(const auto runs, file.runs());
    std::int64_t since = 0;
    for (const RunSummary& run : runs) since += !points.empty() && run.number > points.back().run;
    return drift_standing(project, points, now_utc, since);
}

}  // namespace seamwright
