#include "projects/acceptance/study/stored_values.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "projects/acceptance/study/live_study.h"
#include "projects/measure/measure.h"
#include "projects/proof/budget.h"
#include "projects/proof/known_shift.h"
#include "projects/proof/path_direction.h"
#include "projects/proof/zero_shift.h"

namespace seamwright {
namespace {

constexpr const char* kUnmovedPart = "zero shift";

enum class RunKind { unmoved, known, part };

struct UsedRun {
    RunKind kind = RunKind::part;
    std::string part, rehang = "1";
    long number = 0;
    std::int64_t setup = 0;
    std::string utc;
    Pose found = Pose::Identity();
    std::optional<Pose> truth;
};

// The cell that a demo serves over real protocols says so in its devices' names.
bool names_simulation(std::string text) {
    for (char& c : text) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
    return text.find("simulated") != std::string::npos;
}

// Mean square of value minus reference, or minus the part's mean.
double mean_square(const std::vector<UsedRun>& runs, const PathDirection& at) {
    struct OfPart {
        double n = 0, sum = 0, squares = 0;
    };
    std::map<std::string, OfPart> parts;
    double squares = 0, n = 0;
    for (const UsedRun& r : runs) {
        const double v = at.value(r.found);
        if (r.truth) {
            squares += (v - at.value(*r.truth)) * (v - at.value(*r.truth));
            ++n;
            continue;
        }
        OfPart& p = parts[r.part];
        const double step = v - p.sum / std::max(1.0, p.n);
        ++p.n;
        p.sum += v;
        p.squares += step * (v - p.sum / p.n);
    }
    for (const auto& [part, p] : parts) {
        squares += p.squares;
        n += p.n - 1;
    }
    return n > 0 ? squares / n : 0;
}

// Type 3 needs as many rehangs of every part, and as many runs of each.
void balance(std::vector<StudyValue>& values, std::vector<Text>& remarks) {
    std::map<std::string, std::map<std::string, std::size_t>> counts;
    for (const StudyValue& v : values) ++counts[v.part][v.rehang];
    std::size_t most = 0, least = 0, once = 0, fewer = 0, dropped = 0;
    for (const auto& [part, rehangs] : counts) most = std::max(most, rehangs.size());
    std::erase_if(counts, [&](const auto& part) {
        const bool alone = part.second.size() == 1 && part.second.begin()->second == 1;
        once += alone;
        fewer += !alone && part.second.size() < most;
        return alone || part.second.size() < most;
    });
    for (const auto& [part, rehangs] : counts)
        for (const auto& [rehang, n] : rehangs) least = least == 0 ? n : std::min(least, n);
    std::vector<StudyValue> kept;
    std::map<std::pair<std::string, std::string>, std::size_t> taken;
    for (auto v = values.rbegin(); v != values.rend(); ++v) {
        if (!counts.contains(v->part)) continue;
        if (taken[{v->part, v->rehang}]++ < least)
            kept.push_back(*v);
        else
            ++dropped;
    }
    std::reverse(kept.begin(), kept.end());
    values = std::move(kept);
    if (once > 0)
        remarks.push_back(Text("Parts left out of type 3 because they were measured once: {}.", once));
    if (fewer > 0)
        remarks.push_back(
            Text("Parts left out of type 3 because they were not hung as often as the others: {}.", fewer));
    if (dropped > 0)
        remarks.push_back(
            Text("Older runs left out of type 3 because the other parts were not measured as often: {}.",
                 dropped));
}

}  // namespace

std::optional<StudyForecast> forecast_at(const Project& setup, const Region& region, const PathDirection& at,
                                         std::span<const Displacement> parts) {
    const Displacement as_taught[] = {Displacement{}};
    const auto taught = stated_scatter(setup, region, at, as_taught);
    if (!taught) return std::nullopt;
    StudyForecast forecast{taught->front().random_mm, taught->front().systematic_mm};
    const auto displaced = stated_scatter(setup, region, at, parts);
    if (!displaced || parts.empty()) return forecast;
    for (const StatedScatter& s : *displaced)
        forecast.ev_mm += s.random_mm * s.random_mm / static_cast<double>(displaced->size());
    forecast.ev_mm = std::sqrt(forecast.ev_mm);
    return forecast;
}

Expected<StudyForecast> forecast_studies(const Project& project, const Region& region) {
    std::optional<StudyForecast> worst;
    for (const PathDirection& at : path_directions(project, region)) {
        const Displacement as_taught[] = {Displacement{}};
        SEAM_TRY(const auto taught, stated_scatter(project, region, at, as_taught));
        const StatedScatter& s = taught.front();
        if (!worst || s.random_mm > worst->type1_s_mm)
            worst = StudyForecast{s.random_mm, s.systematic_mm, s.random_mm};
    }
    if (!worst) return input_error(Text("region \"{}\" has no calibrated spot", region.id), project.name);
    return *worst;
}

void name_devices(StudySource& source, const Project& setup, const Spot& spot) {
    if (const SensorSetup* sensor = find_sensor(setup, spot.sensor_id)) {
        source.sensor = sensor->identity.vendor + " " + sensor->identity.model;
        source.sensor_serial = sensor->identity.serial;
        source.simulated = sensor->driver == "simulated" || names_simulation(source.sensor);
    }
    if (const RobotSetup* robot = find_robot(setup, spot.robot_id)) {
        source.robot = robot->identity.brand + " " + robot->identity.model;
        source.robot_serial = robot->identity.serial;
        source.simulated = source.simulated || robot->driver == "simulated" || names_simulation(source.robot);
    }
}

namespace {

std::string ids_of(const Project& project) {
    std::string ids;
    for (const Region& r : project.regions) ids += (ids.empty() ? "" : ", ") + r.id;
    return ids;
}

Expected<std::string> region_of(const ProjectFile& file, const Project& project,
                                const std::string& region_id) {
    if (project.regions.empty()) return input_error("the project has no region", file.path().string());
    if (region_id.empty() && project.regions.size() > 1)
        return usage_error(Text("the project has {} regions", project.regions.size()), file.path().string(),
                           Text("name one with --region: {}", ids_of(project)));
    return region_id.empty() ? project.regions.front().id : region_id;
}

// What a stored run says of the region.
struct FoundRun {
    bool there = false;  // the region is in it; else it is another region's, or a panel's
    bool used = false;   // with a correction that the gate let pass
    Pose found = Pose::Identity();
};

// The displacements of the newest known-shift proof, by run.
std::map<std::int64_t, Pose> known_shifts(const std::vector<Evidence>& evidence) {
    std::map<std::int64_t, Pose> known;
    for (const Evidence& e : evidence)
        if (const auto* proof = std::get_if<KnownShift>(&e.what)) {
            known.clear();
            for (const ShiftTest& test : proof->tests) known[test.run] = test.workobject_from_movedworkobject;
        }
    return known;
}

bool of_older_proof(const RunSummary& run, const std::map<std::int64_t, Pose>& known) {
    return run.part_id.starts_with(kKnownShiftPrefix) && !known.contains(run.number);
}

// Of each run but those of older proofs.
Expected<std::vector<FoundRun>> found_runs(const ProjectFile& file, const std::vector<RunSummary>& summaries,
                                           const std::map<std::int64_t, Pose>& known, const std::string& id,
                                           Parts* parts) {
    std::vector<FoundRun> found(summaries.size());
    std::vector<std::size_t> mine(summaries.size());
    std::iota(mine.begin(), mine.end(), std::size_t{0});
    if (parts) mine = parts->begin(summaries.size());
    for (const std::size_t i : mine) {
        if (of_older_proof(summaries[i], known)) continue;
        SEAM_TRY(auto run, file.load_run(summaries[i].number, false));
        const auto record = std::ranges::find(run.regions, id, &RegionRecord::region_id);
        if (record == run.regions.end()) continue;
        found[i].there = true;
        found[i].used =
            record->gate_passed && record->correction && record->correction->status == CorrectionStatus::ok;
        if (found[i].used) found[i].found = record->correction->displacement.workobject_from_movedworkobject;
    }
    if (parts) {
        parts->end(
            [&](PartValue& part, std::size_t i) {
                part(found[i].there);
                part(found[i].used);
                part.matrix(found[i].found.matrix());
            },
            0);
        SEAM_OK(parts->check());
    }
    return found;
}

}  // namespace

Expected<void> stored_values_part(const ProjectFile& file, const std::string& region_id, Parts& part) {
    SEAM_TRY(const auto project, file.load());
    SEAM_TRY(const auto id, region_of(file, project, region_id));
    SEAM_TRY(const auto summaries, file.runs());
    SEAM_TRY(const auto evidence, file.evidence());
    return found_runs(file, summaries, known_shifts(evidence), id, &part).map([](const auto&) {});
}

Expected<StoredStudy> stored_values(const ProjectFile& file, const std::string& region_id, Parts* parts) {
    SEAM_TRY(const auto project, file.load());
    return stored_values(file, project, region_id, parts);
}

Expected<StoredStudy> stored_values(const ProjectFile& file, const Project& project,
                                    const std::string& region_id, Parts* parts) {
    SEAM_TRY(const auto id, region_of(file, project, region_id));
    const std::string ids = ids_of(project);
    SEAM_TRY(auto summaries, file.runs());
    SEAM_TRY(auto evidence, file.evidence());
    const std::map<std::int64_t, Pose> known = known_shifts(evidence);
    SEAM_TRY(const auto found, found_runs(file, summaries, known, id, parts));

    const std::map<std::string, RehungPart> rehung = rehung_parts(evidence);
    StoredStudy study;
    StudySource& source = study.source;
    std::vector<UsedRun> used;
    int refused = 0, of_older_proofs = 0;
    for (std::size_t i = 0; i < summaries.size(); ++i) {
        const RunSummary& summary = summaries[i];
        UsedRun r;
        r.part = summary.part_id;
        r.number = static_cast<long>(summary.number);
        r.setup = summary.setup;
        r.utc = summary.started_utc;
        if (r.part.starts_with(kZeroShiftPrefix)) {
            r.kind = RunKind::unmoved;
            r.part = kUnmovedPart;
            r.truth = Pose::Identity();
        } else if (r.part.starts_with(kKnownShiftPrefix)) {
            r.kind = RunKind::known;
            const auto at = known.find(summary.number);
            if (at == known.end()) {
                ++of_older_proofs;
                continue;
            }
            r.truth = at->second;
        } else if (const auto at = rehung.find(r.part); at != rehung.end()) {
            r.part = at->second.part;
            r.rehang = at->second.rehang;
        }
        if (!found[i].there) continue;
        if (!found[i].used) {
            ++refused;
            continue;
        }
        r.found = found[i].found;
        used.push_back(std::move(r));
    }
    const bool known_region = std::any_of(project.regions.begin(), project.regions.end(),
                                          [&](const Region& r) { return r.id == id; });
    if (used.empty() && !known_region)
        return usage_error(Text("there is no region \"{}\"", id), file.path().string(),
                           Text("there are: {}", ids));
    if (used.empty())
        return input_error(
            Text("no stored run holds a correction of region \"{}\" that the gate let pass", id),
            file.path().string(), "measure first, or name another region with --region");
    int other_setup = 0;
    for (const RunKind kind : {RunKind::unmoved, RunKind::part}) {
        std::int64_t newest = 0;
        for (const UsedRun& r : used)
            if (r.kind == kind) newest = r.setup;
        other_setup += static_cast<int>(
            std::erase_if(used, [&](const UsedRun& r) { return r.kind == kind && r.setup != newest; }));
    }
    SEAM_TRY(auto setup, file.load_run_setup(used.back().number));
    const auto region =
        std::find_if(setup.regions.begin(), setup.regions.end(), [&](const Region& r) { return r.id == id; });
    std::vector<PathDirection> directions;
    if (region != setup.regions.end()) directions = path_directions(setup, *region);
    if (directions.empty())
        return input_error(Text("region \"{}\" has no calibrated spot", id), file.path().string());
    const PathDirection* worst = &directions.front();
    double largest = -1;
    for (const PathDirection& d : directions)
        if (const double square = mean_square(used, d); square > largest) largest = square, worst = &d;

    for (const UsedRun& r : used) {
        StudyValue v{r.part, r.rehang, r.number, worst->value(r.found), {}, r.utc};
        if (r.truth) v.reference_mm = worst->value(*r.truth);
        if (r.kind != RunKind::known) {
            study.values.type1.push_back(v);
            study.values.stability.push_back(v);
        }
        if (r.kind == RunKind::unmoved) {
            study.reference_part = kUnmovedPart;
        } else if (r.kind == RunKind::known) {
            study.values.linearity.push_back(v);
        } else {
            study.values.type3.push_back(v);
        }
    }
    std::map<std::string, Displacement> last_found;  // by part
    for (const UsedRun& r : used)
        if (r.kind == RunKind::part) last_found[r.part].workobject_from_movedworkobject = r.found;
    std::vector<Displacement> places;
    for (const auto& [part, place] : last_found) places.push_back(place);
    source.forecast = forecast_at(setup, *region, *worst, places);
    source.unmoved_part = study.reference_part;
    source.offset.emplace(OffsetOfStudy{id, worst->direction, {}});
    if (const KeptOffset* kept = acting_offset(*region)) {
        source.offset->acting = *kept;
        source.remarks.push_back(
            Text("In these runs {}.", said_of(ActingOffset{kept->version, kept->offset_mm})));
    }
    source.file = file.path().filename().string();
    source.measurand =
        Text("region {}, spot {}, {}", id, worst->spot_id, worst->normal ? Text("normal") : Text("binormal"));
    source.part_name = project.part.name;
    source.runs = static_cast<int>(used.size());
    if (const Spot* spot = find_spot(setup, worst->spot_id)) name_devices(source, setup, *spot);
    if (refused > 0)
        source.remarks.push_back(Text("Runs left out because the gate refused them: {}.", refused));
    if (of_older_proofs > 0)
        source.remarks.push_back(
            Text("Runs left out because they belong to an older known shift: {}.", of_older_proofs));
    if (other_setup > 0)
        source.remarks.push_back(Text(
            "Runs left out because they were made with another setup than the newest: {}.", other_setup));
    balance(study.values.type3, source.remarks);
    return study;
}

void add_references(StudyValues& values, const std::vector<StudyValue>& table) {
    std::map<std::string, std::pair<double, double>> sums;
    for (const StudyValue& v : table) {
        sums[v.part].first += v.value_mm;
        ++sums[v.part].second;
    }
    values.correlation = values.type3;
    for (StudyValue& v : values.correlation)
        if (const auto at = sums.find(v.part); at != sums.end())
            v.reference_mm = at->second.first / at->second.second;
}

}  // namespace seamwright
