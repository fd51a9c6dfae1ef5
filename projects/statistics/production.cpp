#include "projects/statistics/production.h"

#include <fmt/chrono.h>

#include <algorithm>
#include <charconv>
#include <ctime>
#include <set>

#include "projects/acceptance/study/live_study.h"
#include "projects/proof/known_shift.h"
#include "projects/proof/zero_shift.h"

namespace seamwright {
namespace {

Expected<void> add_file(Production& p, const std::filesystem::path& path, const RunValuesWanted& wanted) {
    SEAM_TRY(auto file, ProjectFile::open(path, FileAccess::read_only));
    SEAM_TRY(auto project, file.load());
    SEAM_TRY(auto evidence, file.evidence());
    RunValuesWanted values = wanted;
    values.covariances |= project.fixture.has_value();  // to say what has moved
    SEAM_TRY(auto runs, file.run_values(values));
    const RunPurposes purposes(evidence);
    std::set<std::int64_t> setups;
    for (RunValues& run : runs) {
        const auto started = utc_milliseconds(run.started_utc);
        if (!started)
            return file_error("a run has no valid time", Text("{}: run {}", path.string(), run.number));
        const RunPurpose purpose = purposes.of(run);
        if (purpose != RunPurpose::production) {
            ++(purpose == RunPurpose::proof ? p.proofs : p.studies);
            continue;
        }
        if (run.status == RunStatus::cancelled || run.status == RunStatus::interrupted) {
            ++p.unfinished;
            continue;
        }
        setups.insert(run.setup);
        p.runs.push_back({p.files.size(), static_cast<double>(*started) / 86400e3, std::move(run)});
    }
    p.setups += setups.size();
    auto points = path_points_of(project);
    p.files.push_back({path, std::move(project), std::move(points)});
    return {};
}

}  // namespace

RunPurposes::RunPurposes(const std::vector<Evidence>& evidence) : proofs_(proof_runs(evidence)) {
    for (const auto& [part, rehung] : rehung_parts(evidence)) rehung_.insert(part);
    for (const Evidence& e : evidence)
        if (const auto* plan = std::get_if<StudyPlan>(&e.what)) plans_.push_back(*plan);
}

RunPurpose RunPurposes::of(const RunValues& run) const {
    if (proofs_.contains(run.number) || is_part_of_proof(run.part_id)) return RunPurpose::proof;
    // A study only measures: what was pushed is a part that went on.
    if (run.push) return RunPurpose::production;
    if (rehung_.contains(run.part_id)) return RunPurpose::study;
    for (const StudyPlan& plan : plans_)
        if (run.number > plan.after_run &&
            std::find(plan.parts.begin(), plan.parts.end(), run.part_id) != plan.parts.end())
            return RunPurpose::study;
    return RunPurpose::production;
}

std::map<std::string, std::vector<PathDirection>> path_points_of(const Project& project) {
    std::map<std::string, std::vector<PathDirection>> points;
    for (const Region& region : project.regions) points[region.id] = path_directions(project, region);
    return points;
}

Expected<Production> production_of(const std::vector<std::filesystem::path>& files,
                                   const RunValuesWanted& wanted) {
    Production p;
    std::set<std::filesystem::path> seen;
    for (const auto& path : files) {
        std::error_code ignored;
        const auto real = std::filesystem::weakly_canonical(path, ignored);
        if (!seen.insert(real).second)
            return usage_error("the file is given twice", path.string(), "give each file once");
        SEAM_OK(add_file(p, path, wanted));
    }
    std::stable_sort(p.runs.begin(), p.runs.end(),
                     [](const ProductionRun& a, const ProductionRun& b) { return a.day < b.day; });
    return p;
}

std::optional<std::int64_t> utc_milliseconds(const std::string& utc) {
    const auto seconds = utc_seconds(utc);
    if (!seconds) return std::nullopt;
    std::int64_t fraction = 0;
    for (std::size_t at = 20, unit = 100; unit > 0; ++at, unit /= 10)
        if (at < utc.size() && utc[at] >= '0' && utc[at] <= '9')
            fraction += static_cast<std::int64_t>(unit) * (utc[at] - '0');
        else
            break;
    return *seconds * 1000 + fraction;
}

std::string utc_text(std::int64_t seconds) {
    return fmt::format("{:%Y-%m-%dT%H:%M:%S}.000Z", fmt::gmtime(static_cast<std::time_t>(seconds)));
}

Expected<std::int64_t> seconds_argument(const std::string& text, const std::string& option) {
    const auto wrong = [&] {
        return usage_error(Text("\"{}\" is no span of time", text), option, "write 30s, 90min, 8h or 7d");
    };
    std::int64_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || number < 1 || number > 31'622'400) return wrong();
    const std::string unit(end, text.data() + text.size());
    const std::int64_t seconds = unit == "s"     ? number
                                 : unit == "min" ? 60 * number
                                 : unit == "h"   ? 3600 * number
                                 : unit == "d"   ? 86400 * number
                                                 : 0;
    if (seconds < 1 || seconds > 31'622'400) return wrong();
    return seconds;
}

Expected<std::string> time_argument(const std::string& text, const std::string& option,
                                    const std::string& now_utc) {
    if (const auto age = seconds_argument(text, option))
        if (const auto now = utc_seconds(now_utc)) return utc_text(*now - *age);
    std::string whole = text;
    if (whole.size() == 16) whole += ":00";  // without seconds
    if (whole.size() == 17 && whole.back() == 'Z') whole = whole.substr(0, 16) + ":00Z";
    const auto as_utc = utc_seconds(whole);
    if (!as_utc)
        return usage_error(Text("\"{}\" is no time", text), option,
                           "write 2024-05-01, 2024-05-01T06:00 (local time), 2024-05-01T06:00Z, or 8h, 7d "
                           "for so long ago");
    if (whole.ends_with('Z')) return utc_text(*as_utc);
    std::tm local = fmt::gmtime(static_cast<std::time_t>(*as_utc));
    local.tm_isdst = -1;
    return utc_text(std::mktime(&local));
}

}  // namespace seamwright
