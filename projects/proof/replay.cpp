#include "projects/proof/replay.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <mutex>
#include <thread>

#include "projects/file/project_json.h"
#include "projects/gate/safety_gate.h"
#include "projects/measure/measure.h"
#include "projects/panel/panel_measure.h"

namespace seamwright {
namespace {

// Everything that a run computes, as exact text; two texts are equal when every bit is.
constexpr ArchiveOptions kExact{.profiles = true, .rigid_poses = false, .patterns = false};
template <class T>
std::string exact(const T& value) {
    return to_json_document(value, kExact).dump();
}

// The part of a region that follows from the measurements; gate and push also depend on the robot of that
// moment.
RegionRecord computed_part(const RegionRecord& record) {
    RegionRecord part;
    part.region_id = record.region_id;
    part.correction = record.correction;
    part.base_from_frame = record.base_from_frame;
    part.modes = record.modes;
    return part;
}

PanelRecord computed_part(const PanelRecord& record) {
    PanelRecord part = record;
    part.gate_passed = false;
    part.refusals.clear();
    part.push = {};
    return part;
}

bool nothing_kept(const Capture& raw) {
    return raw.status != FrameStatus::ok ||
           (raw.profile.size() == 0 && raw.candidates.lines == 0 && !raw.image);
}

// A setup with its spots made ready.
class Recomputer {
  public:
    explicit Recomputer(Project setup) : setup_(std::move(setup)) {}

    Expected<RunRecord> recompute(const RunRecord& stored) {
        RunRecord again = stored;
        for (SpotMeasurement& m : again.spots) {
            if (m.capture < 0) continue;
            if (static_cast<std::size_t>(m.capture) >= stored.captures.size())
                return file_error(Text("the capture of spot {} is missing", m.spot_id),
                                  Text("run {}", stored.number));
            const Capture& raw = stored.captures[static_cast<std::size_t>(m.capture)];
            // Nothing was kept because there was nothing to measure: the verdict of then stands. Had it been
            // measured, the difference shows below.
            if (nothing_kept(raw) && m.status != SpotStatus::measured) continue;
            auto it = measurers_.find(m.spot_id);
            if (it == measurers_.end()) {
                SEAM_TRY(auto made, SpotMeasurer::make(setup_, m.spot_id));
                it = measurers_.emplace(m.spot_id, std::move(made)).first;
            }
            const std::string part_id = m.part_id;
            const int capture = m.capture;
            const auto light = m.light;
            m = it->second.measure(raw);
            m.part_id = part_id;
            m.capture = capture;
            m.light = light;
        }
        std::vector<RegionRecord> regions = correct_regions(setup_, again.spots, acting_drift(stored));
        for (std::size_t i = 0; i < regions.size(); ++i) {
            if (regions[i].correction)
                regions[i].base_from_frame =
                    corrected_frame(setup_.part.base_from_workobject, regions[i].correction->displacement,
                                    setup_.regions[i].base_from_frame);
            for (const RegionRecord& old : stored.regions)
                if (old.region_id == regions[i].region_id) {
                    regions[i].gate_passed = old.gate_passed;
                    regions[i].refusals = old.refusals;
                    regions[i].push = old.push;
                }
        }
        again.regions = std::move(regions);
        if (again.panel) SEAM_OK(recompute_panel(stored, *again.panel));
        return again;
    }

  private:
    Expected<void> recompute_panel(const RunRecord& stored, PanelRecord& panel) {
        const Text where("run {}", stored.number);
        const PanelJob* job = find_panel_job(setup_, panel.job_id);
        if (!job) return file_error(Text("the setup of the run has no panel job {}", panel.job_id), where);
        for (auto* list : {&panel.before, &panel.after})
            for (PanelMeasurement& m : *list) {
                if (m.capture < 0) continue;
                const auto count = static_cast<int>(stored.captures.size());
                if (m.capture >= count || m.second_capture >= count)
                    return file_error(Text("the capture of place {} is missing", m.place_id), where);
                const Capture& first = stored.captures[static_cast<std::size_t>(m.capture)];
                const Capture* second = m.second_capture < 0
                                            ? nullptr
                                            : &stored.captures[static_cast<std::size_t>(m.second_capture)];
                if (m.status != SpotStatus::measured &&
                    (nothing_kept(first) || (second && nothing_kept(*second))))
                    continue;
                const auto place = std::find_if(job->places.begin(), job->places.end(),
                                                [&](const PanelPlace& p) { return p.id == m.place_id; });
                if (place == job->places.end())
                    return file_error(Text("the setup of the run has no place {}", m.place_id), where);
                const std::string key = job->id + "\n" + place->id;
                auto it = panel_measurers_.find(key);
                if (it == panel_measurers_.end()) {
                    SEAM_TRY(auto made, PanelMeasurer::make(setup_, *job, *place));
                    it = panel_measurers_.emplace(key, std::move(made)).first;
                }
                PanelMeasurement again = it->second.measure(first, second);
                again.part_id = m.part_id;
                again.capture = m.capture;
                again.second_capture = m.second_capture;
                m = std::move(again);
            }
        compute_panel(setup_, *job, panel);
        return {};
    }

    std::map<std::string, PanelMeasurer> panel_measurers_;
    Project setup_;
    std::map<std::string, SpotMeasurer> measurers_;
};

Text describe_change(const SpotMeasurement& a, const SpotMeasurement& b) {
    if (a.status != b.status) return Text("{} -> {} {}", to_string(a.status), to_string(b.status), b.message);
    return Text("measured ({}, {}, {}) -> ({}, {}, {}) mm", a.measured_mm.x(), a.measured_mm.y(),
                a.measured_mm.z(), b.measured_mm.x(), b.measured_mm.y(), b.measured_mm.z());
}

Text describe_change(const RegionRecord& a, const RegionRecord& b) {
    if (a.correction.has_value() != b.correction.has_value())
        return a.correction ? Text("corrected -> not corrected") : Text("not corrected -> corrected");
    if (!a.correction) return "another frame";
    if (a.correction->status != b.correction->status)
        return Text("{} -> {}", to_string(a.correction->status), to_string(b.correction->status));
    const Pose& from = a.correction->displacement.workobject_from_movedworkobject;
    const Pose& to = b.correction->displacement.workobject_from_movedworkobject;
    return Text("displacement changed by {} mm and {} degrees", distance_mm(from, to),
                deg_from_rad(angle_rad(from, to)));
}

Text describe_change(const PanelMeasurement& a, const PanelMeasurement& b) {
    if (a.status != b.status) return Text("{} -> {} {}", to_string(a.status), to_string(b.status), b.message);
    return Text("gap {}, flush {} -> gap {}, flush {} mm", a.gap_mm, a.flush_mm, b.gap_mm, b.flush_mm);
}

void compare_panels(std::int64_t run, const PanelRecord& a, const PanelRecord& b,
                    std::vector<ReplayDifference>& differences) {
    const auto places = [&](const char* when, const std::vector<PanelMeasurement>& one,
                            const std::vector<PanelMeasurement>& other) {
        for (std::size_t i = 0; i < std::min(one.size(), other.size()); ++i)
            if (exact(one[i]) != exact(other[i]))
                differences.push_back({run, Text("place {} {} the motion", one[i].place_id, Text(when)),
                                       describe_change(one[i], other[i]),
                                       std::max((one[i].panel_mm - other[i].panel_mm).norm(),
                                                (one[i].body_mm - other[i].body_mm).norm())});
    };
    const std::size_t found = differences.size();
    places("before", a.before, b.before);
    places("after", a.after, b.after);
    if (exact(computed_part(a)) == exact(computed_part(b)) || differences.size() > found) return;
    const double off = distance_mm(a.base_from_moved_gripper, b.base_from_moved_gripper);
    differences.push_back(
        {run, Text("panel job {}", a.job_id), Text("the motion changed by {} mm", off), off});
}

struct Part {  // what one run came to
    std::optional<Error> error;
    std::int64_t captures = 0;
    std::vector<ReplayDifference> differences;
};

Part replay_run(const ProjectFile& file, const RunSummary& run, std::map<std::int64_t, Recomputer>& setups) {
    Part part;
    const auto failed = [&](const Error& error) {
        part.error = error;
        return part;
    };
    auto setup = setups.find(run.setup);
    if (setup == setups.end()) {
        auto loaded = file.load_setup(run.setup);
        if (!loaded) return failed(loaded.error());
        setup = setups.emplace(run.setup, Recomputer(std::move(*loaded))).first;
    }
    auto stored = file.load_run(run.number);
    if (!stored) return failed(stored.error());
    auto again = setup->second.recompute(*stored);
    if (!again) return failed(again.error());
    part.captures = static_cast<std::int64_t>(stored->captures.size());
    if (stored->status == RunStatus::interrupted && stored->regions.empty() && !stored->panel)
        return part;  // never judged
    part.differences = compare(*stored, *again);
    return part;
}

}  // namespace

Expected<RunRecord> recompute(const RunRecord& stored, const Project& setup) {
    return Recomputer(setup).recompute(stored);
}

std::vector<ReplayDifference> compare(const RunRecord& stored, const RunRecord& again) {
    std::vector<ReplayDifference> differences;
    const auto count = [&](const char* what, std::size_t a, std::size_t b) {
        if (a != b) differences.push_back({stored.number, what, fmt::format("{} -> {}", a, b), 0});
    };
    count("number of spots", stored.spots.size(), again.spots.size());
    count("number of regions", stored.regions.size(), again.regions.size());
    for (std::size_t i = 0; i < std::min(stored.spots.size(), again.spots.size()); ++i) {
        const SpotMeasurement &a = stored.spots[i], &b = again.spots[i];
        if (exact(a) == exact(b)) continue;
        differences.push_back({stored.number, Text("spot {}", a.spot_id), describe_change(a, b),
                               (a.measured_mm - b.measured_mm).norm()});
    }
    for (std::size_t i = 0; i < std::min(stored.regions.size(), again.regions.size()); ++i) {
        const RegionRecord a = computed_part(stored.regions[i]), b = computed_part(again.regions[i]);
        if (exact(a) == exact(b)) continue;
        differences.push_back({stored.number, Text("region {}", a.region_id), describe_change(a, b),
                               distance_mm(a.base_from_frame, b.base_from_frame)});
    }
    if (stored.panel && again.panel) compare_panels(stored.number, *stored.panel, *again.panel, differences);
    return differences;
}

Expected<ReplayResult> replay(const std::filesystem::path& path, const ReplayOptions& options) {
    if (options.jobs < 1 || options.jobs > 256)
        return usage_error(Text("{} jobs are not possible", options.jobs), "--jobs", "give 1 to 256");
    SEAM_TRY(auto file, ProjectFile::open(path, FileAccess::read_only));
    SEAM_TRY(auto runs, file.runs());
    if (options.run) {
        std::erase_if(runs, [&](const RunSummary& run) { return run.number != options.run; });
        if (runs.empty()) return input_error(Text("there is no run {}", options.run), path.string());
    }

    std::vector<RunSummary> mine;
    for (std::size_t i = 0; i < runs.size(); ++i)
        if (options.portion.holds(i)) mine.push_back(std::move(runs[i]));
    runs = std::move(mine);

    // Runs are handed out one by one; each leaves its part at its own place, so the order of work does not
    // show.
    std::vector<Part> parts(runs.size());
    std::atomic<std::size_t> next{0};
    std::mutex mutex;  // of `done` and the caller's progress function
    int done = 0;
    const auto work = [&](const ProjectFile& connection) {
        std::map<std::int64_t, Recomputer> setups;
        for (;;) {
            const std::size_t i = next.fetch_add(1);
            if (i >= runs.size() || options.cancel.stop_requested()) return;
            parts[i] = replay_run(connection, runs[i], setups);
            const std::lock_guard lock(mutex);
            ++done;
            if (options.progress) options.progress(done, static_cast<int>(runs.size()));
        }
    };
    {
        std::vector<Expected<ProjectFile>> connections;
        std::vector<std::jthread> threads;  // joined before their connections close
        for (int i = 1; i < std::min<int>(options.jobs, static_cast<int>(runs.size())); ++i) {
            connections.push_back(ProjectFile::open(path, FileAccess::read_only));
            if (!connections.back()) return tl::unexpected(connections.back().error());
        }
        for (auto& connection : connections)
            threads.emplace_back([&work, &connection] { work(*connection); });
        work(file);
    }
    ReplayResult result;
    result.cancelled = options.cancel.stop_requested() && done < static_cast<int>(runs.size());
    result.runs = done;
    for (Part& part : parts) {
        if (part.error) return tl::unexpected(*part.error);
        result.captures += part.captures;
        for (ReplayDifference& difference : part.differences)
            result.differences.push_back(std::move(difference));
    }
    return result;
}

}  // namespace seamwright
