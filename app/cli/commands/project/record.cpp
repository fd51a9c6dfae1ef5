// seamwright record: what a project's sensors and robots deliver, into a capture.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <thread>

#include "app/cli/recording.h"
#include "app/cli/signal_watch.h"
#include "devices/registry.h"
#include "projects/file/project_file.h"
#include "projects/measure/measure.h"

namespace seamwright::cli {
namespace {

using Clock = std::chrono::steady_clock;

struct RecordArguments {
    std::string file, out;
    std::vector<std::string> sensors, robots;
    bool images = false, no_robots = false;
    double seconds = 0, trigger_hz = 0, pose_hz = 50;
    std::uint64_t profiles = 0;
};

// All of the project's, or those named. Error: a name that the project does not have.
template <class Setup>
Expected<std::vector<Setup>> chosen(const std::vector<Setup>& all, const std::vector<std::string>& names,
                                    const char* what) {
    if (names.empty()) return all;
    std::vector<Setup> some;
    for (const std::string& name : names) {
        const auto it = std::find_if(all.begin(), all.end(), [&](const Setup& s) { return s.id == name; });
        if (it == all.end())
            return input_error(Text("the project has no {} \"{}\"", what, name), std::string("--") + what);
        some.push_back(*it);
    }
    return some;
}

// Peaks in millimetres by the sensor's calibration; one buffer a sensor, on that sensor's thread.
std::function<bool(const Frame&, ProfileCandidates&)> candidates_with(const SensorModel& model) {
    struct Buffers {
        SensorModel model;
        StripePeaks peaks;
        Capture capture;
        Text message;
    };
    auto buffers = std::make_shared<Buffers>(Buffers{model, {}, {}, {}});
    return [buffers](const Frame& frame, ProfileCandidates& candidates) {
        const auto status =
            capture_frame(frame, {}, &buffers->model, buffers->peaks, buffers->capture, buffers->message);
        std::swap(candidates, buffers->capture.candidates);
        return status == SpotStatus::measured;
    };
}

Expected<Answer> record(const RecordArguments& a) {
    SEAM_TRY(auto file, ProjectFile::open(a.file, FileAccess::read_only));
    SEAM_TRY(auto project, file.load());
    SEAM_TRY(auto sensors, chosen(project.sensors, a.sensors, "sensor"));
    SEAM_TRY(auto robots,
             chosen(a.no_robots ? std::vector<RobotSetup>() : project.robots, a.robots, "robot"));
    if (sensors.empty() && robots.empty())
        return input_error("the project has no device to record", a.file, "add a sensor first");

    const auto stop = stop_on_signal();
    DeviceSession session;
    std::map<std::string, std::unique_ptr<ProfileSource>> sources;
    std::map<std::string, std::unique_ptr<RobotLink>> links;
    const auto named = [](Error error, const std::string& where) {
        error.within(where);
        return tl::unexpected(std::move(error));
    };
    for (const SensorSetup& s : sensors) {
        auto opened = open_sensor(s.driver, s.settings, session);
        if (!opened) return named(opened.error(), "sensor " + s.id);
        sources[s.id] = std::move(*opened);
    }
    for (const RobotSetup& r : robots) {
        auto opened = open_robot(r.driver, r.settings, session);
        if (!opened) return named(opened.error(), "robot " + r.id);
        links[r.id] = std::move(*opened);
    }
    // Without a calibration the pixels are all that can be measured later.
    const auto model_of = [&](const SensorSetup& s) -> const SensorModel* {
        for (const Calibration& c : project.calibrations)
            if (c.id == s.calibration_id && c.model) return &*c.model;
        return nullptr;
    };
    const bool images = a.images || !std::all_of(sensors.begin(), sensors.end(), model_of);
    SEAM_TRY(auto recorder, open_recorder(a.out, {.images = images}));
    std::vector<RecordingSession::Sensor> from;
    std::vector<RecordingSession::Robot> beside;
    for (const SensorSetup& s : sensors) {
        SEAM_TRY(auto source, recorder->add_sensor(s.id, sources[s.id]->identity()));
        RecordingSession::Sensor sensor{source, sources[s.id].get(), nullptr, a.trigger_hz};
        if (!images) sensor.candidates = candidates_with(*model_of(s));
        from.push_back(std::move(sensor));
    }
    for (const RobotSetup& r : robots) {
        auto identity = links[r.id]->identity();
        if (!identity) return named(identity.error(), "robot " + r.id);
        SEAM_TRY(auto source, recorder->add_robot(r.id, *identity));
        beside.push_back({source, links[r.id].get(), a.pose_hz});
    }
    SEAM_TRY(auto running, RecordingSession::start(recorder, std::move(from), beside));
    const auto begun = Clock::now();
    std::optional<Error> failure;
    while (!stop.stop_requested() && !failure) {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        if (a.seconds > 0 && Clock::now() - begun >= std::chrono::duration<double>(a.seconds)) break;
        if (a.profiles > 0 && running->frames() >= a.profiles) break;
        if (!sensors.empty() && (!running->running() || running->refusal())) break;
        failure = recorder->status().failure;
    }
    running->stop();
    const std::optional<Error> refused = running->refusal();  // of a sensor that is given up
    Answer answer;
    answer.json = {{"status", "ok"},
                   {"seconds", std::chrono::duration<double>(Clock::now() - begun).count()}};
    SEAM_OK(tell_recording(recorder.get(), a.out, answer));
    if (refused) return tl::unexpected(*refused);
    if (!sensors.empty() && running->frames() == 0) {
        answer.exit_code = kExitVerdict;
        answer.json["status"] = "no frames";
        answer.text += "no frame came: a sensor that waits for software triggers wants --trigger-hz\n";
    }
    return answer;
}

}  // namespace

void add_record(CommandLine& line) {
    auto a = std::make_shared<RecordArguments>();
    CLI::App* command = line.add(
        "record", "Record what sensors and robots deliver, until SIGINT, SIGTERM, --seconds or --profiles.",
        "seamwright record door_left.seam --out shift.seam --seconds 60");
    command->add_option("FILE.seam", a->file, "Project whose devices are recorded")->required();
    command->add_option("--out", a->out, "The capture; refused where the file exists")->required();
    command->add_option("--sensor", a->sensors, "Only this sensor (repeatable)");
    auto* only = command->add_option("--robot", a->robots, "Only this robot (repeatable)");
    command->add_flag("--no-robots", a->no_robots, "Sensors alone")->excludes(only);
    command->add_flag("--images", a->images,
                      "Keep the raw images too; else, of calibrated sensors, the stripe's candidates");
    command
        ->add_option("--trigger-hz", a->trigger_hz, "Software triggers; 0: the sensor runs freely or by wire")
        ->check(CLI::Range(0.0, 10000.0))
        ->capture_default_str();
    command->add_option("--pose-hz", a->pose_hz, "How often a robot is asked for its pose")
        ->check(CLI::Range(0.1, 1000.0))
        ->capture_default_str();
    command->add_option("--seconds", a->seconds, "Ends after so long")->check(CLI::PositiveNumber);
    command->add_option("--profiles", a->profiles, "Ends after so many frames of all sensors")
        ->check(CLI::PositiveNumber);
    line.on(command, [a] { return record(*a); });
}

}  // namespace seamwright::cli
