#include "projects/statistics/statistics.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

#include "core/acceptance/distributions.h"
#include "core/geometry/notation.h"
#include "projects/proof/path_direction.h"

namespace seamwright {
namespace {

constexpr std::size_t kLongestSaid = 200;

bool only_signs(const std::string& pattern) {
    bool inside = false;
    for (const char c : pattern) {
        inside = c == '{' || (inside && c != '}');
        if (!inside && (std::isalpha(static_cast<unsigned char>(c)) || static_cast<unsigned char>(c) >= 0x80))
            return false;
    }
    return true;
}

void count_refusal(std::vector<RefusalReason>& reasons, const Text& text, const std::string& utc) {
    std::string pattern = refusal_pattern(text);
    auto at = std::find_if(reasons.begin(), reasons.end(),
                           [&](const RefusalReason& r) { return r.pattern == pattern; });
    if (at == reasons.end()) at = reasons.insert(at, {std::move(pattern), telling_refusal(text), 0, {}});
    ++at->count;
    at->last_utc = utc;
}

template <class Counted>
void most_frequent_first(std::vector<Counted>& list) {
    std::stable_sort(list.begin(), list.end(),
                     [](const Counted& a, const Counted& b) { return a.count > b.count; });
}

ProcessLimits about(double middle, double half) {
    if (!std::isfinite(half) || !(half > 0)) return {};
    return {middle - half, middle + half};
}

// The newest file that has it says its limits and points.
template <class Thing>
const Thing* newest(const Production& p, std::vector<Thing> Project::*list, const std::string& id) {
    for (auto file = p.files.rbegin(); file != p.files.rend(); ++file)
        for (const Thing& thing : file->project.*list)
            if (thing.id == id) return &thing;
    return nullptr;
}

class Maker {
  public:
    Maker(Statistics& statistics, const ProductionTotals* totals) : s_(statistics), totals_(totals) {}

    Expected<void> make() {
        std::vector<std::string> regions, jobs;
        for (const ProductionFile& file : s_.production.files) {
            for (const Region& r : file.project.regions) add(regions, r.id);
            for (const PanelJob& j : file.project.panel_jobs) add(jobs, j.id);
        }
        // What was renamed or deleted since has values without limits.
        for (const ProductionRun& run : s_.production.runs) {
            for (const RegionValue& r : run.values.regions) add(regions, r.region_id);
            if (run.values.panel) add(jobs, run.values.panel->job_id);
        }
        if (totals_) {
            for (const auto& [id, all] : totals_->regions) add(regions, id);
            for (const auto& [id, all] : totals_->panels) add(jobs, id);
        }
        const std::string& wanted = s_.options.region;
        bool found = wanted.empty();
        for (const auto& id : regions)
            if (wanted.empty() || id == wanted) {
                found = true;
                SEAM_OK(region(id));
            }
        for (const auto& id : jobs)
            if (wanted.empty() || id == wanted) {
                found = true;
                SEAM_OK(panel(id));
            }
        if (!found) {
            regions.insert(regions.end(), jobs.begin(), jobs.end());
            std::string ids;
            for (const auto& id : regions) ids += (ids.empty() ? "" : ", ") + id;
            return usage_error(Text("there is no region \"{}\"", wanted), "statistics",
                               Text("there are: {}", ids));
        }
        counts();
        cycle();
        caveats();
        return {};
    }

  private:
    static void add(std::vector<std::string>& list, const std::string& id) {
        if (std::find(list.begin(), list.end(), id) == list.end()) list.push_back(id);
    }

    Expected<void> region(const std::string& id) {
        RegionStatistics out;
        out.id = id;
        std::vector<std::size_t> used;
        std::vector<Pose> found;
        for (std::size_t i = 0; i < s_.production.runs.size(); ++i)
            for (const RegionValue& r : s_.production.runs[i].values.regions) {
                if (r.region_id != id) continue;
                ++out.runs;
                out.passed += r.gate_passed;
                for (const Text& why : r.refusals)
                    count_refusal(out.refusals, why, s_.production.runs[i].values.started_utc);
                out.over_limit += !r.gate_passed && r.status == CorrectionStatus::over_limit;
                if (!is_value(r)) {
                    ++out.left_out;
                    continue;
                }
                used.push_back(i);
                found.push_back(r.workobject_from_movedworkobject);
            }
        const Region* setup = newest(s_.production, &Project::regions, id);
        add_six(out, setup, found);
        if (setup) add_path(out, *setup, found);
        for (Characteristic& c : out.characteristics) c.runs = used;
        return finish(std::move(out));
    }

    void add_six(RegionStatistics& out, const Region* setup, const std::vector<Pose>& found) const {
        constexpr std::array<const char*, 6> names{"X", "Y", "Z", "A", "B", "C"};
        for (std::size_t k = 0; k < 6; ++k) {
            if (setup && !setup->free[k]) continue;
            Characteristic c;
            c.key = kDisplacementKeys[k];
            c.name = std::string(names[k]);
            c.unit = k < 3 ? "mm" : "deg";
            if (setup) c.limits = about(0, k < 3 ? setup->limits.translation_mm : setup->limits.rotation_deg);
            for (const Pose& d : found) c.values.push_back(displacement_numbers(d)[k]);
            out.characteristics.push_back(std::move(c));
        }
    }

    void add_path(RegionStatistics& out, const Region& region, const std::vector<Pose>& found) const {
        for (auto file = s_.production.files.rbegin(); file != s_.production.files.rend(); ++file) {
            const auto points = file->path_points.find(region.id);
            if (points == file->path_points.end()) continue;
            for (const PathDirection& at : points->second) {
                Characteristic c;
                c.key = path_point_key(at);
                c.name =
                    at.normal ? Text("spot {}, normal", at.spot_id) : Text("spot {}, binormal", at.spot_id);
                c.path_point = true;
                if (s_.options.tolerance_mm) c.limits = about(0, *s_.options.tolerance_mm / 2);
                for (const Pose& d : found) c.values.push_back(at.value(d));
                out.characteristics.push_back(std::move(c));
            }
            return;
        }
    }

    // The path point with the largest mean square.
    static void mark_worst_point(RegionStatistics& out) {
        Characteristic* worst = nullptr;
        double largest = -1;
        for (Characteristic& c : out.characteristics) {
            const ProcessSummary& r = c.summary;
            const double square = r.mean * r.mean + r.s * r.s * (r.n - 1) / r.n;
            if (!c.path_point || !(square > largest)) continue;
            worst = &c;
            largest = square;
        }
        if (worst) worst->worst_point = true;
    }

    Expected<void> panel(const std::string& id) {
        RegionStatistics out;
        out.id = id;
        out.panel = true;
        const PanelJob* job = newest(s_.production, &Project::panel_jobs, id);
        std::map<std::string, std::array<Characteristic, 2>> places;
        for (std::size_t i = 0; i < s_.production.runs.size(); ++i) {
            const RunValues& run = s_.production.runs[i].values;
            if (!run.panel || run.panel->job_id != id) continue;
            ++out.runs;
            out.passed += run.panel->gate_passed;
            for (const Text& why : run.panel->refusals) count_refusal(out.refusals, why, run.started_utc);
            out.left_out += run.panel->after.empty();
            for (const PlaceValue& place : run.panel->after) {
                auto& two = places[place.place_id];
                for (Characteristic& c : two) c.runs.push_back(i);
                two[0].values.push_back(place.gap_mm);
                two[1].values.push_back(place.flush_mm);
            }
        }
        for (auto& [place_id, two] : places) {
            const PanelPlace* taught = nullptr;
            if (job)
                for (const PanelPlace& p : job->places)
                    if (p.id == place_id) taught = &p;
            two[0].key = place_key(place_id, true);
            two[0].name = Text("place {}, gap", place_id);
            two[1].key = place_key(place_id, false);
            two[1].name = Text("place {}, flush", place_id);
            if (taught) {
                two[0].nominal = taught->gap_mm;
                two[0].limits = about(taught->gap_mm, job->gap_tolerance_mm);
                two[1].nominal = taught->flush_mm;
                two[1].limits = about(taught->flush_mm, job->flush_tolerance_mm);
            }
            for (Characteristic& c : two) out.characteristics.push_back(std::move(c));
        }
        return finish(std::move(out));
    }

    Expected<void> finish(RegionStatistics out) {
        const RegionTotals* all = nullptr;
        if (totals_) {
            const auto& of_kind = out.panel ? totals_->panels : totals_->regions;
            if (const auto found = of_kind.find(out.id); found != of_kind.end()) all = &found->second;
        }
        if (all) {
            out.runs = all->runs;
            out.passed = all->passed;
            out.over_limit = all->over_limit;
            out.left_out = all->left_out;
            out.refusals = all->refusals;
        }
        most_frequent_first(out.refusals);
        std::erase_if(out.characteristics, [](const Characteristic& c) { return c.values.empty(); });
        for (Characteristic& c : out.characteristics) {
            SEAM_OK(judge(c));
            if (all) SEAM_OK(judge_all(c, out, *all));
            say_caveats(c);
        }
        mark_worst_point(out);
        s_.regions.push_back(std::move(out));
        return {};
    }

    Expected<void> judge(Characteristic& c) const {
        SEAM_TRY(auto summary, summarise_process(c.values, c.limits));
        c.summary = summary;
        std::vector<StudyValue> row;
        for (const double v : c.values) row.push_back({{}, {}, static_cast<long>(row.size()), v, {}, {}});
        SEAM_TRY(auto groups, subgroups_of(row, s_.options.subgroup));
        // Without scatter, or with one group, there is no chart, and the table shows why.
        if (auto chart = stability_study(groups.groups)) c.chart = std::move(*chart);
        if (auto ewma = ewma_chart(c.values, c.summary.mean, c.summary.sigma_within))
            c.ewma = std::move(*ewma);
        std::vector<double> days;
        for (const std::size_t run : c.runs) days.push_back(s_.production.runs[run].day);
        SEAM_TRY(auto trend, trend_of(days, c.values, c.limits));
        c.trend = trend;
        return {};
    }

    // Of all values what their sums tell.
    Expected<void> judge_all(Characteristic& c, const RegionStatistics& of, const RegionTotals& all) const {
        const auto sums = all.sums.find(c.key);
        if (sums == all.sums.end()) return {};
        SEAM_TRY(auto summary, summarise_sums(sums->second, c.limits));
        const bool below = c.limits.lower && summary.lowest < *c.limits.lower;
        const bool above = c.limits.upper && summary.highest > *c.limits.upper;
        if (below || above) {
            SEAM_TRY(summary.beyond, totals_->beyond(of.id, of.panel, c.key, c.limits));
        }
        summary.median = c.summary.median;
        summary.normal_p = c.summary.normal_p;
        summary.by_quantiles = c.summary.by_quantiles;
        c.summary = summary;
        c.trend = trend_of(sums->second, c.limits);
        return {};
    }

    static void say_caveats(Characteristic& c) {
        const ProcessSummary& r = c.summary;
        if (r.n < kCapabilityValues)
            c.caveats.push_back(
                Text("{} values are few: an index is a hint below {}", r.n, kCapabilityValues));
        if (r.correlated)
            c.caveats.push_back(
                Text("parts that follow each other are alike (correlation {:.2f}): the limits of "
                     "the indices are wider for it, the charts alarm more often than by chance, "
                     "Cp and Cpk flatter",
                     r.correlation));
        if (r.not_normal())
            c.caveats.push_back(
                c.limits.any() && r.by_quantiles
                    ? Text("the values are not normally distributed: read the indices by quantiles")
                    : Text("the values are not normally distributed: shares beyond the limits do not follow "
                           "from the indices"));
        if (c.trend && c.trend->significant)
            c.caveats.push_back("the values wander with time: an index describes no state that stays");
    }

    void counts() {
        std::vector<UnmeasuredSpot>& list = s_.unmeasured;
        if (totals_) {
            s_.parts = totals_->parts;
            s_.first_utc = totals_->first_utc;
            s_.last_utc = totals_->last_utc;
            s_.by_type = totals_->by_type;
            s_.by_status = totals_->by_status;
            list = totals_->unmeasured;
            return most_frequent_first(list);
        }
        const auto& runs = s_.production.runs;
        s_.parts = runs.size();
        if (!runs.empty()) {
            s_.first_utc = runs.front().values.started_utc;
            s_.last_utc = runs.back().values.started_utc;
        }
        for (const ProductionRun& run : s_.production.runs) {
            ++s_.by_status[static_cast<std::size_t>(run.values.status)];
            if (!run.values.type_id.empty()) ++s_.by_type[run.values.type_id];
            for (const auto& missing : run.values.not_measured) {
                const auto& [spot, status] = missing;
                auto at = std::find_if(list.begin(), list.end(), [&](const UnmeasuredSpot& u) {
                    return u.spot_id == missing.first && u.status == missing.second;
                });
                if (at == list.end()) at = list.insert(at, {spot, status, 0});
                ++at->count;
            }
        }
        most_frequent_first(list);
    }

    void cycle() {
        if (totals_) {
            s_.cycle = totals_->cycle;
            return;
        }
        std::vector<double> took, between;
        for (std::size_t i = 0; i < s_.production.runs.size(); ++i) {
            const ProductionRun& run = s_.production.runs[i];
            if (i > 0) between.push_back(86400 * (run.day - s_.production.runs[i - 1].day));
            if (run.values.status == RunStatus::device) continue;
            const auto end = utc_milliseconds(run.values.finished_utc);
            const auto start = utc_milliseconds(run.values.started_utc);
            // A clock that was set back during a run tells no time.
            if (end && start && *end >= *start) took.push_back(static_cast<double>(*end - *start) / 1e3);
        }
        if (took.empty()) return;
        CycleTime c;
        c.n = static_cast<int>(took.size());
        if (took.size() > 1) {
            const Moments m = moments(took);
            c.mean_s = m.mean;
            c.s_s = m.s;
        } else {
            c.mean_s = took.front();
        }
        std::sort(took.begin(), took.end());
        std::sort(between.begin(), between.end());
        const std::size_t last = took.size() - 1;
        c.median_s = took[last / 2];
        c.p95_s = took[(95 * last + 99) / 100];
        c.longest_s = took.back();
        if (!between.empty()) c.between_s = between[(between.size() - 1) / 2];
        s_.cycle = c;
    }

    void caveats() {
        const Production& p = s_.production;
        std::vector<Text>& say = s_.caveats;
        if (p.proofs > 0)
            say.push_back(
                Text("Runs of proofs (unmoved part, known shifts) that are left out: {}.", p.proofs));
        if (p.studies > 0)
            say.push_back(Text("Runs of studies of the measuring process that are left out: {}.", p.studies));
        if (p.unfinished > 0)
            say.push_back(Text("Cancelled and interrupted runs that are left out: {}.", p.unfinished));
        if (p.setups > p.files.size())
            say.push_back(
                Text("The runs were made with {} different setups: a step may be a change of the "
                     "project and not of the parts.",
                     p.setups));
        const bool newest = std::ranges::any_of(s_.regions, [](const RegionStatistics& r) {
            return std::ranges::any_of(r.characteristics, [](const Characteristic& c) {
                return c.values.size() < static_cast<std::size_t>(c.summary.n);
            });
        });
        if (newest)
            say.push_back(Text(
                "Charts, medians, quantiles and tests for normality are of the newest parts of each region; "
                "everything else is of all {}.",
                s_.parts));
        int left_out = 0;
        for (const RegionStatistics& r : s_.regions) left_out += r.panel ? 0 : r.left_out;
        if (left_out > 0)
            say.push_back(
                Text("Refused corrections without a value here: {}. What the parts were like that "
                     "could not be measured is not known.",
                     left_out));
        if (std::any_of(s_.regions.begin(), s_.regions.end(),
                        [](const RegionStatistics& r) { return !r.panel; }))
            say.push_back(
                "The limits of a displacement are the safety gate's: Cpk says how far the parts are from "
                "a refusal, not how good the bead is.");
    }

    Statistics& s_;
    const ProductionTotals* totals_;
};

}  // namespace

std::string RefusalReason::said(Language language) const {
    if (only_signs(first.key())) return pattern;
    const std::string words =
        language == Language::german ? std::string(german_of(pattern).value_or(pattern)) : pattern;
    std::string out;
    bool inside = false;
    for (std::size_t i = 0; i < words.size(); ++i) {
        const char c = words[i];
        if (!inside && i + 1 < words.size() && (c == '{' || c == '}') && words[i + 1] == c) {
            out += c;
            ++i;
        } else if (c == '{') {
            inside = true;
            out += "…";
        } else if (c == '}') {
            inside = false;
        } else if (!inside) {
            out += c;
        }
    }
    return out;
}

std::array<double, 6> displacement_numbers(const Pose& d) {
    const KukaAbc abc = kuka_from_rotation(d.linear());
    return {d.translation().x(), d.translation().y(), d.translation().z(), abc.a_deg, abc.b_deg, abc.c_deg};
}
std::string path_point_key(const PathDirection& at) {
    return at.spot_id + (at.normal ? "_normal_mm" : "_binormal_mm");
}
std::string place_key(const std::string& place_id, bool gap) {
    return place_id + (gap ? "_gap_mm" : "_flush_mm");
}
bool is_value(const RegionValue& r) {
    return r.gate_passed ? r.status == CorrectionStatus::ok : r.status == CorrectionStatus::over_limit;
}

// "{}: {}" says nothing itself; what it joins does. Words of somebody else are their own pattern.
const Text& telling_refusal(const Text& text) {
    if (!only_signs(text.key())) return text;
    for (auto argument = text.arguments().rbegin(); argument != text.arguments().rend(); ++argument)
        if (const Text* inner = std::get_if<Text>(&*argument)) return telling_refusal(*inner);
    return text;
}

std::string refusal_pattern(const Text& text) {
    const Text& t = telling_refusal(text);
    return only_signs(t.key()) ? t.english().substr(0, kLongestSaid) : t.key();
}

Expected<void> check_statistics_options(const StatisticsOptions& options) {
    if (options.subgroup < 1 || options.subgroup > 25)
        return usage_error(Text("a subgroup of {} values is none", options.subgroup), "statistics",
                           "give 1 to 25");
    if (options.tolerance_mm && !(*options.tolerance_mm > 0 && std::isfinite(*options.tolerance_mm)))
        return usage_error("the tolerance is not above 0", "statistics", "give T = USL - LSL in mm");
    const RunValuesWanted& when = options.runs;
    if (!when.since_utc.empty() && !when.until_utc.empty() && when.until_utc <= when.since_utc)
        return usage_error("the end is not after the beginning", "statistics", "give --since before --until");
    return {};
}

Expected<Statistics> statistics_of(Production production, const StatisticsOptions& options,
                                   const ProductionTotals* totals) {
    Statistics s;
    s.options = options;
    s.production = std::move(production);
    SEAM_OK(Maker(s, totals).make());
    return s;
}

Expected<Statistics> production_statistics(const std::vector<std::filesystem::path>& files,
                                           const StatisticsOptions& options) {
    if (files.empty()) return usage_error("no file is given", "statistics", "name FILE.seam");
    SEAM_OK(check_statistics_options(options));
    SEAM_TRY(auto production, production_of(files, options.runs));
    SEAM_TRY(auto s, statistics_of(std::move(production), options));
    const auto& read = s.production.files;
    const bool one_kind =
        read.size() == 1 && (read.front().project.part_types.size() < 2 || !options.runs.type_id.empty());
    if (one_kind && read.front().project.fixture) {
        CarrierDiagnosisOptions how;
        how.runs = options.runs;
        if (auto moved = diagnose_production(s.production, how))
            s.diagnosis = std::move(*moved);
        else
            s.caveats.push_back(moved.error().text());
    }
    return s;
}

}  // namespace seamwright
