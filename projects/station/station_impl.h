#pragma once
// What a Station holds, and one run in the making. Private to projects/station.

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "projects/drift/drift_keeper.h"
#include "projects/file/file_use.h"
#include "projects/gate/push.h"
#include "projects/gate/safety_gate.h"
#include "projects/measure/measure.h"
#include "projects/station/acquire.h"
#include "projects/station/light/spot_light.h"
#include "projects/station/station.h"

namespace seamwright {

struct Station::Impl {
    ProjectFile file;
    Project project;
    bool connected = false;
    DeviceSession session;
    std::map<std::string, std::unique_ptr<ProfileSource>> sensors;
    std::map<std::string, std::unique_ptr<RobotLink>> robots;
    std::optional<FileUse> use;  // while real devices are connected

    std::shared_ptr<Recorder> recorder;
    std::map<std::string, std::int64_t> recorded;  // sources of the recording, kept across reconnects

    template <class Add>
    Expected<std::int64_t> recorded_as(const std::string& name, const Add& add) {
        if (const auto known = recorded.find(name); known != recorded.end()) return known->second;
        auto source = add();
        if (source) recorded[name] = *source;
        return source;
    }

    bool writable = true;
    DriftKeeper drift;
    DriftStanding standing;
    PaintFactors paint_factors;  // of the parts before

    Impl(ProjectFile f, Project p) : file(std::move(f)), project(std::move(p)) {}

    // One run in the making.
    struct Job {
        const RunOptions& options;
        Project project;  // of the part's type
        RunRecord run{};
        std::map<std::string, SpotMeasurer> measurers{};
        std::map<std::string, TriggeredFrames> frames{};  // by sensor
        std::vector<std::string> started_robots{};   // and the one that called: they wait for the verdict
        StartedSensors started_sensors{};            // stopped when the robots have it
        std::map<std::string, SensorLight> light{};  // by sensor; set back before they stop
        std::int64_t part_since_ns = 0;
        int done = 0, total = 0;
        StoredMeasurements stored{};
        std::optional<DriftStanding> drift{};  // of a project with a watch
        bool in_file = false;                  // the judged run

        void event(EventKind kind, const std::string& subject, const Text& text) {
            run.events.push_back({0, utc_now(), 0, kind, subject, text});
        }
        void progress(Text text) const {
            if (options.progress) options.progress({done, total, std::move(text)});
        }
        SpotMeasurement& measurement(const std::string& spot_id) {
            return *std::find_if(run.spots.begin(), run.spots.end(),
                                 [&](const SpotMeasurement& m) { return m.spot_id == spot_id; });
        }
    };

    void disconnect();
    void take_identities();
    // By id: all of the project, or those that measured and wait for the verdict.
    std::map<std::string, RobotLink*> links() const;
    std::map<std::string, RobotLink*> links(const std::vector<std::string>& ids) const;

    // station_run.cpp
    Expected<void> prepare(Job& job);
    Expected<void> begin(Job& job);
    std::vector<std::optional<GatePass>> conclude(Job& job, const Expected<void>& measured, bool cancelled);
    tl::unexpected<Error> failed(Job& job, const Error& error);

    // station_measure.cpp
    Expected<FramePtr> frame_of(Job& job, const Spot& spot, const TriggerEvent& trigger);
    Expected<FramePtr> taken_again(Job& job, const Spot& spot, const TriggerEvent& trigger);
    Expected<void> measure_spot(Job& job, const Spot& spot, const TriggerEvent& trigger);
    Expected<void> measure_robot(Job& job, const std::string& robot_id);
    Expected<void> measure_all(Job& job);

    // station_judge.cpp
    Expected<void> watch_drift(Job& job);
    GateSpot gate_spot(const Job& job, const Spot& spot, std::map<std::string, RobotIdentity>& answered);
    void ask_robot(const Job& job, const std::string& robot_id, GateRequest& request);
    Text project_trouble() const;
    GateRequest gate_request(const Job& job, const Region& region, const RegionRecord& record);
    std::vector<std::optional<GatePass>> judge(Job& job);

    // station_push.cpp
    RobotLink& robot_of(const Job& job, const Region& region);
    Expected<void> store_judged(Job& job);
    Expected<void> record_event(Job& job, EventKind kind, const std::string& subject, const Text& text);
    bool confirm_all(Job& job, PartVerdict verdict);
    bool confirmed(Job& job, std::vector<std::optional<GatePass>>& passes);
    EventSink sink(Job& job);
    Expected<void> store_outcome(Job& job);
    bool write_all(Job& job, std::vector<std::optional<GatePass>>& passes);
    void take_frames_back(Job& job);
    void push_all(Job& job, std::vector<std::optional<GatePass>>& passes);
    static Text verdict(const RunRecord& run);
};

}  // namespace seamwright
