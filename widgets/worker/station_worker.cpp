#include "widgets/worker/station_worker.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "devices/registry.h"
#include "devices/simulated/cell.h"
#include "projects/measure/measure.h"
#include "projects/station/acquire.h"
#include "widgets/shown_text.h"

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kRobotPeriod{500};

}  // namespace

StationWorker::StationWorker(LiveFeed& feed, QObject* parent)
    : QObject(parent), feed_(feed), thread_([this](const std::stop_token& stop) { work(stop); }) {}

StationWorker::~StationWorker() {
    cancel();
    thread_.request_stop();
    wake_.notify_all();
    thread_.join();
    stop_live();
    feed_.detach();
}

void StationWorker::open(const std::filesystem::path& file, const Project& project) {
    cancel();
    const std::lock_guard lock(mutex_);
    queue_.clear();
    jog_request_.reset();
    newest_project_.reset();
    open_request_.emplace(file, project);
    close_request_ = false;
    opened_ = true;
    opened_last_ = ++opening_;
    wake_.notify_all();
}

void StationWorker::close() {
    cancel();
    std::unique_lock lock(mutex_);
    queue_.clear();
    open_request_.reset();
    if (!opened_) return;
    close_request_ = true;
    opened_last_ = ++opening_;
    wake_.notify_all();
    wake_.wait(lock, [&] { return !close_request_; });
}

void StationWorker::use(const Project& project) {
    const std::lock_guard lock(mutex_);
    newest_project_ = std::make_unique<Project>(project);
    wake_.notify_all();
}

bool StationWorker::busy() const {
    const std::lock_guard lock(mutex_);
    return busy_ || !queue_.empty();
}

bool StationWorker::losable() const {
    const std::lock_guard lock(mutex_);
    return (busy_ && doing_ == Loss::result) ||
           std::any_of(queue_.begin(), queue_.end(), [](const Request& r) { return r.loss == Loss::result; });
}

void StationWorker::cancel() {
    const std::lock_guard lock(mutex_);
    jog_request_.reset();
    cancel_.request_stop();
    for (Request& waiting : queue_) waiting.cancel.request_stop();
    push_answer_ = false;
    wake_.notify_all();
}

void StationWorker::act_for(std::optional<SignedIn> who) {
    const std::lock_guard lock(mutex_);
    who_ = std::move(who);
}

void StationWorker::answer_push(bool yes) {
    const std::lock_guard lock(mutex_);
    push_answer_ = yes;
    wake_.notify_all();
}

void StationWorker::post(const QString& what, Task task, Unserved unserved) {
    post(Loss::result, what, std::move(task), std::move(unserved));
}

void StationWorker::post(Loss loss, const QString& what, Task task, Unserved unserved) {
    const std::lock_guard lock(mutex_);
    queue_.push_back({what, std::move(task), {}, loss, std::move(unserved)});
    wake_.notify_all();
}

Error StationWorker::no_station() const {
    return open_trouble_ ? *open_trouble_ : usage_error("no project is open", {}, "open or make one").value();
}

// Whoever asked waits for an answer.
void StationWorker::refuse(const Request& request) {
    if (request.unserved)
        request.unserved(no_station());
    else
        tell(&StationWorker::failed,
             shown_error(tr("\"%1\" was not begun.").arg(request.what), no_station()));
    emit busy_changed(false, request.what);
}

std::function<void(const RunProgress&)> StationWorker::progress_sink() {
    return [this](const RunProgress& p) { tell(&StationWorker::progressed, p.done, p.total, shown(p.text)); };
}

void StationWorker::attach_feed(Station& station) {
    if (!station.connected()) return;
    std::map<std::string, ProfileSource*> sources;
    // A sensor that was added meanwhile is connected with the next connecting.
    for (const SensorSetup& setup : station.project().sensors)
        if (ProfileSource* sensor = station.sensor(setup.id)) sources[setup.id] = sensor;
    feed_.attach(sources);
}

void StationWorker::connect_devices() {
    post(Loss::none, tr("Connecting"), [this](Station& station, const std::stop_token& cancel) {
        feed_.detach();
        connect_trouble_.clear();
        auto connected = station.connect({.cancel = cancel});
        if (!connected) {
            connect_trouble_ = connected.error().text();
            tell(&StationWorker::failed,
                 shown_error(tr("The devices were not connected."), connected.error()));
        } else {
            ++connection_;
            // A simulated robot that stands nowhere yet goes to its first spot, or home, so that there is
            // something to see and it can be moved by hand; a real one is never moved from here.
            for (const RobotSetup& setup : station.project().robots) {
                RobotLink* robot = station.robot(setup.id);
                if (!is_simulated_cell(setup.driver) || robot->base_from_flange()) continue;
                const auto& spots = station.project().spots;
                const auto spot = std::find_if(spots.begin(), spots.end(),
                                               [&](const Spot& s) { return s.robot_id == setup.id; });
                if (spot != spots.end())
                    (void)robot->move_to(spot->base_from_flange);
                else if (const auto home = simulated_home(setup.settings))
                    (void)robot->move_to(*home);
            }
            attach_feed(station);
        }
        publish(station);
    });
}

void StationWorker::disconnect_devices() {
    post(Loss::none, tr("Disconnecting"), [this](Station& station, const std::stop_token&) {
        feed_.detach();
        connect_trouble_.clear();
        station.disconnect();
        publish(station);
    });
}

void StationWorker::run_one(Station& station, const RunOptions& options) {
    auto run = station.run(options);
    if (!run) {
        tell(&StationWorker::failed, shown_error(tr("The part was not measured."), run.error()));
        return;
    }
    tell(&StationWorker::measured, std::make_shared<const RunRecord>(std::move(*run)));
}

void StationWorker::measure(const std::string& part_id, bool push, bool keep_images,
                            const std::string& part_type) {
    post(tr("Measuring"), [=, this](Station& station, const std::stop_token& cancelled) {
        RunOptions options;
        options.part_id = part_id;
        options.part_type = part_type;
        options.push = push;
        options.keep_images = keep_images;
        options.cancel = cancelled;
        options.progress = progress_sink();
        if (push)
            options.confirm_push = [&](const RunRecord& judged) {
                return ask(cancelled, [&] {
                    tell(&StationWorker::confirm_push, std::make_shared<const RunRecord>(judged));
                });
            };
        run_one(station, options);
    });
}

void StationWorker::zero_shift(int runs, const std::string& part_type) {
    post(tr("Zero shift"), [=, this](Station& station, const std::stop_token& cancelled) {
        ZeroShiftOptions options;
        options.runs = runs;
        options.part_type = part_type;
        options.cancel = cancelled;
        options.progress = progress_sink();
        options.measured = [this](const RunRecord& run) {
            tell(&StationWorker::measured, std::make_shared<const RunRecord>(run));
        };
        if (auto zero = measure_zero_shift(station, options); !zero)
            return tell(&StationWorker::failed,
                        shown_error(tr("The zero shift was not measured."), zero.error()));
        tell(&StationWorker::proven);
    });
}

void StationWorker::known_shift(ShiftBy by, const ShiftGrid& grid, const std::string& part_type) {
    post(tr("Known shift"), [=, this](Station& station, const std::stop_token& cancelled) {
        feed_.detach();  // the proof opens the devices for itself
        KnownShift naming;
        naming.range_mm = grid.range_mm;
        naming.range_deg = grid.range_deg;
        KnownShiftOptions options;
        options.by = by;
        options.part_type = part_type;
        options.grid = grid;
        options.cancel = cancelled;
        options.progress = progress_sink();
        options.place = [&](const ShiftTest& test, const Pose& shift) {
            return ask(cancelled, [&] {
                tell(&StationWorker::place_part, QString::fromStdString(shift_name(test, naming)), shift);
            });
        };
        auto proof = prove_known_shift(station, options);
        attach_feed(station);
        if (!proof)
            return tell(&StationWorker::failed,
                        shown_error(tr("The known shift was not measured."), proof.error()));
        tell(&StationWorker::proven);
    });
}

void StationWorker::teach(const Spot& draft, int repeats) {
    post(tr("Teaching"), [=, this](Station& station, const std::stop_token& cancelled) {
        TeachOptions options;
        options.repeats = repeats;
        options.cancel = cancelled;
        options.progress = progress_sink();
        auto spot = teach_spot(station, draft, options);
        if (!spot)
            tell(&StationWorker::failed, shown_error(tr("The reference was not measured."), spot.error()));
        else
            tell(&StationWorker::taught, std::make_shared<const TaughtSpot>(std::move(*spot)));
    });
}

void StationWorker::find_light(const Spot& spot) {
    post(tr("Finding the light"), [=, this](Station& station, const std::stop_token& cancelled) {
        FindLightOptions options;
        options.cancel = cancelled;
        auto found = seamwright::find_light(station, spot, options);
        if (!found)
            tell(&StationWorker::failed, shown_error(tr("The light was not found."), found.error()));
        else
            tell(&StationWorker::light_found,
                 std::make_shared<const LightOfSpot>(LightOfSpot{spot, std::move(*found)}));
    });
}

void StationWorker::record_pass(const Spot& spot, double step_mm, const AlignmentOptions& alignment) {
    post(tr("Recording the pass"), [=, this](Station& station, const std::stop_token& cancelled) {
        PassOptions options;
        options.step_mm = step_mm;
        options.cancel = cancelled;
        options.progress = progress_sink();
        auto pass = seamwright::record_pass(station, spot, options);
        if (!pass)
            return tell(&StationWorker::failed, shown_error(tr("The pass was not recorded."), pass.error()));
        auto judged = judge_pass(spot, std::move(*pass), alignment);
        if (!judged)
            return tell(&StationWorker::failed,
                        shown_error(tr("The pass cannot be judged."), judged.error()));
        tell(&StationWorker::passed, std::make_shared<const JudgedPass>(std::move(*judged)));
    });
}

int StationWorker::take_shots(const std::vector<std::string>& sensor_ids, const std::string& robot_id,
                              bool board) {
    const int number = ++shots_asked_;
    post(
        tr("Capturing"),
        [=, this](Station& station, const std::stop_token& cancelled) {
            auto shots = std::make_shared<CalibrationShots>();
            for (const std::string& id : sensor_ids) {
                auto shot = take_shot(station, SensorId(id), RobotId(robot_id), board, cancelled);
                // A device names its address; among several sensors that is no name.
                if (!shot && sensor_ids.size() > 1 && shot.error().where != "robot " + robot_id)
                    shot.error().where = "sensor " + id;
                shots->push_back(std::move(shot));
            }
            tell(&StationWorker::shots_taken, std::move(shots), number);
        },
        [this, number](const Error& why) {
            tell(&StationWorker::shots_taken,
                 std::make_shared<const CalibrationShots>(1, tl::unexpected(why)), number);
        });
    return number;
}

void StationWorker::search_cameras() {
    post(Loss::none, tr("Searching cameras"), [this](Station&, const std::stop_token&) {
        tell(&StationWorker::cameras_found,
             std::make_shared<const std::vector<DiscoveredCamera>>(discover_cameras()));
    });
}

void StationWorker::set_sensor_parameter(const std::string& sensor_id, const std::string& name,
                                         double value) {
    post(Loss::none, tr("Setting the sensor"), [=, this](Station& station, const std::stop_token&) {
        ProfileSource* sensor = station.sensor(sensor_id);
        if (!sensor)
            return tell(&StationWorker::failed,
                        tr("sensor %1 is not connected").arg(QString::fromStdString(sensor_id)));
        if (auto set = sensor->set(name, value); !set)
            tell(&StationWorker::failed,
                 shown_error(tr("The sensor did not take the setting."), set.error()));
        publish(station);
    });
}

void StationWorker::publish(Station& station) {
    auto state = std::make_shared<StationState>();
    state->connected = station.connected();
    state->connection = connection_;
    state->asked = Clock::now();
    state->trouble = connect_trouble_;
    if (live_) sensors_ = live_->states();
    if (!live_) {
        sensors_.clear();
        for (const SensorSetup& setup : station.project().sensors)
            if (ProfileSource* sensor = station.sensor(setup.id)) {
                SensorState s;
                s.id = setup.id;
                read_settings(*sensor, s);
                sensors_.push_back(std::move(s));
            }
    }
    state->sensors = sensors_;
    for (const RobotSetup& setup : station.project().robots) {
        RobotLink* robot = station.robot(setup.id);
        if (!robot) continue;
        RobotState r;
        r.id = setup.id;
        r.identity = setup.identity;
        r.can_move = robot->can_move();
        if (auto mode = robot->mode())
            r.mode = *mode;
        else
            r.trouble = mode.error().text();
        if (r.trouble.empty())
            if (auto at = robot->base_from_flange()) r.base_from_flange = *at;
        state->robots.push_back(std::move(r));
    }
    tell(&StationWorker::state_changed, std::move(state));
}

// Where devices have other names, settings, or are gone, nothing of the old ones stays on the screen.
void StationWorker::take_project(Station& station, const Project& newest) {
    const auto same = [](const auto& before, const auto& after) {
        return std::ranges::equal(before, after, [](const auto& a, const auto& b) {
            return a.id == b.id && a.driver == b.driver && a.settings == b.settings;
        });
    };
    const Project& before = station.project();
    if (!station.connected() || (same(before.sensors, newest.sensors) && same(before.robots, newest.robots)))
        return station.use(newest);
    stop_live();
    feed_.detach();
    station.use(newest);
    attach_feed(station);
    publish(station);
}

void StationWorker::stop_live() {
    live_.reset();
}

void StationWorker::start_live(Station& station) {
    if (!station.connected() || live_) return;
    live_ = std::make_unique<LiveSensors>();
    for (const SensorSetup& setup : station.project().sensors) {
        ProfileSource* source = station.sensor(setup.id);
        if (!source) continue;
        SensorState known;
        known.id = setup.id;
        for (const SensorState& s : sensors_)
            if (s.id == setup.id) known = s;
        live_->add(*source, std::move(known));
    }
}

void StationWorker::work(const std::stop_token& stop) {
    auto next_state = Clock::now();
    while (!stop.stop_requested()) {
        Request request;
        std::optional<JogRequest> by_hand;
        std::optional<SignedIn> who;
        {
            std::unique_lock lock(mutex_);
            wake_.wait_until(lock, stop, next_state, [&] {
                return open_request_ || close_request_ || !queue_.empty() || newest_project_ || jog_request_;
            });
            if (stop.stop_requested()) break;
            if (open_request_ || close_request_) {
                auto opening = std::move(open_request_);
                open_request_.reset();
                told_of_ = opening_;
                lock.unlock();
                stop_live();
                feed_.detach();
                station_.reset();
                connect_trouble_.clear();
                open_trouble_.reset();
                if (opening) {
                    auto file = ProjectFile::open(opening->first);
                    if (file)
                        station_.emplace(std::move(*file), std::move(opening->second));
                    else
                        tell(&StationWorker::failed, shown_error(*(open_trouble_ = file.error())));
                }
                tell(&StationWorker::state_changed, std::make_shared<const StationState>());
                lock.lock();
                if (close_request_) {
                    close_request_ = false;
                    opened_ = false;
                }
                lock.unlock();
                wake_.notify_all();
                continue;
            }
            if (newest_project_) {
                const std::unique_ptr<Project> newest = std::move(newest_project_);
                lock.unlock();
                if (station_) take_project(*station_, *newest);
                lock.lock();
                if (open_request_ || close_request_ || newest_project_) continue;
            }
            if (!queue_.empty()) {
                request = std::move(queue_.front());
                queue_.pop_front();
                cancel_ = request.cancel;
                doing_ = request.loss;
                busy_ = true;
            }
            who = who_;
            if (!request.task) by_hand = std::exchange(jog_request_, std::nullopt);
            jog_request_.reset();
        }
        if (!station_) {
            if (request.task) {
                {
                    const std::lock_guard lock(mutex_);
                    busy_ = false;
                }
                refuse(request);
            }
            if (by_hand)
                tell(&StationWorker::jogged, by_hand->robot_id, by_hand->base_from_flange,
                     shown_error(tr("The robot was not moved."), no_station()));
            next_state = Clock::now() + kRobotPeriod;
            continue;
        }
        if (request.task) {
            emit busy_changed(true, request.what);
            stop_live();
            station_->file().forget_person();
            // Who may not act any more does what needs no person: the file says so where it needs one.
            if (who) (void)station_->file().act_for(*who);
            request.task(*station_, request.cancel.get_token());
            {
                const std::lock_guard lock(mutex_);
                busy_ = false;
            }
            publish(*station_);
            emit busy_changed(false, request.what);
            next_state = Clock::now();
            continue;
        }
        start_live(*station_);
        if (by_hand) move_by_hand(*station_, *by_hand);
        if (Clock::now() >= next_state) {
            if (station_->connected()) publish(*station_);
            next_state = Clock::now() + kRobotPeriod;
        }
    }
    stop_live();
}

}  // namespace seamwright
