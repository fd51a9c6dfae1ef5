#include "widgets/worker/live_sensors.h"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

#include "devices/silence.h"
#include "projects/station/acquire.h"

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kRest{30}, kFrame{400}, kSettings{500};
constexpr std::chrono::milliseconds kRetry{1000};  // of a sensor that gives no frame

}  // namespace

void read_settings(ProfileSource& sensor, SensorState& state) {
    state.identity = sensor.identity();
    state.counters = sensor.counters();
    state.parameters = sensor.parameters();
    for (const ParameterInfo& info : state.parameters) {
        auto value = sensor.get(info.name);
        if (value) {
            state.values[info.name] = *value;
        } else if (is_silence(value.error()) || value.error().code == ErrorCode::disconnected) {
            state.trouble = value.error().text();
            return;
        }
    }
}

struct LiveSensors::Lane {
    ProfileSource& source;
    std::mutex mutex;
    SensorState state;
    std::optional<SoftwareTriggered> by_software;  // while it runs; the thread's until that has ended
    bool given_up = false;
    std::jthread thread;

    Lane(ProfileSource& sensor, SensorState known) : source(sensor), state(std::move(known)) {
        state.trouble = {};
        thread = std::jthread([this](const std::stop_token& stop) { run(stop); });
    }
    ~Lane() {
        leave();
        thread.join();
        if (by_software || given_up) source.stop();
    }
    void leave() {
        thread.request_stop();
        const std::lock_guard lock(mutex);
        if (state.trouble.empty() || given_up) return;
        given_up = true;
        source.give_up();  // it may wait for a device that is not there
    }

    Expected<void> one_picture() {
        if (!by_software) {
            SEAM_TRY(auto taken, SoftwareTriggered::begin(source));
            SEAM_OK(source.start());
            by_software.emplace(std::move(taken));
        }
        SEAM_OK(source.trigger(""));
        SEAM_OK(source.wait_next(kFrame));
        return {};
    }

    void run(const std::stop_token& stop) {
        std::mutex resting;
        std::condition_variable_any rest;
        auto settings_due = Clock::now();
        while (!stop.stop_requested()) {
            SensorState now;
            {
                const std::lock_guard lock(mutex);
                now = state;
            }
            now.trouble = {};
            const auto seen = one_picture();
            if (!seen) now.trouble = seen.error().text();
            if (seen && Clock::now() >= settings_due && !stop.stop_requested()) {
                read_settings(source, now);
                settings_due = Clock::now() + kSettings;
            }
            {
                const std::lock_guard lock(mutex);
                state = std::move(now);
            }
            if (!seen && seen.error().code == ErrorCode::end_of_recording) return;
            std::unique_lock lock(resting);
            rest.wait_for(lock, stop, seen ? kRest : kRetry, [] { return false; });
        }
    }
};

LiveSensors::LiveSensors() = default;

LiveSensors::~LiveSensors() {
    for (const auto& lane : lanes_) lane->leave();  // all at once, then one after the other
}

void LiveSensors::add(ProfileSource& sensor, SensorState known) {
    lanes_.push_back(std::make_unique<Lane>(sensor, std::move(known)));
}

std::vector<SensorState> LiveSensors::states() {
    std::vector<SensorState> all;
    for (const auto& lane : lanes_) {
        const std::lock_guard lock(lane->mutex);
        all.push_back(lane->state);
    }
    return all;
}

}  // namespace seamwright
