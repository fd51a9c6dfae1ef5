#include "widgets/desk/calibration_desk.h"

#include <QUndoCommand>
#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/calibration/robot_repeatability.h"
#include "devices/exchange/image_file.h"
#include "devices/exchange/pose_json.h"
#include "devices/registry.h"
#include "devices/simulated/cell.h"
#include "projects/calibrate/session/answer.h"
#include "projects/measure/measure.h"
#include "widgets/shown_text.h"

namespace seamwright {
namespace {

// The whole state before and after: captures are shared, so that it costs a list.
class CmdSession final : public QUndoCommand {
  public:
    using Apply = std::function<void(const SessionState&)>;
    CmdSession(const QString& text, SessionState before, SessionState after, Apply apply)
        : QUndoCommand(text),
          before_(std::move(before)),
          after_(std::move(after)),
          apply_(std::move(apply)) {}
    void undo() override { apply_(before_); }
    void redo() override {
        if (std::exchange(done_, true)) apply_(after_);
    }

  private:
    SessionState before_, after_;
    Apply apply_;
    bool done_ = false;  // the edit is made before its command is pushed
};

// The session's folder against the one that is put aside; either way is the same deed.
class CmdAnew final : public QUndoCommand {
  public:
    using Exchange = std::function<void(std::filesystem::path&)>;
    CmdAnew(const QString& text, std::filesystem::path parked, Exchange exchange)
        : QUndoCommand(text), parked_(std::move(parked)), exchange_(std::move(exchange)) {}
    void undo() override { exchange_(parked_); }
    void redo() override {
        if (std::exchange(done_, true)) exchange_(parked_);
    }

  private:
    std::filesystem::path parked_;
    Exchange exchange_;
    bool done_ = false;
};

}  // namespace

CalibrationDesk::CalibrationDesk(Desk& desk, QObject* parent)
    : QObject(parent), desk_(desk), thread_([this](const std::stop_token& stop) { work(stop); }) {
    connect(&desk_, &Desk::opened, this, &CalibrationDesk::close);
    connect(&desk_, &Desk::sensor_renamed, this, [this](const std::string& from, const std::string& to) {
        if (session_)
            follow(session_->sensor_id() == from ? to : session_->sensor_id(), session_->robot_id());
    });
    connect(&desk_, &Desk::robot_renamed, this, [this](const std::string& from, const std::string& to) {
        if (session_) follow(session_->sensor_id(), session_->robot_id() == from ? to : session_->robot_id());
    });
    connect(&desk_, &Desk::station_changed, this, &CalibrationDesk::watch_robot);
    connect(&desk_.live(), &LiveFeed::arrived, this, &CalibrationDesk::look);
    connect(&desk_.worker(), &StationWorker::shots_taken, this, &CalibrationDesk::take_shots);
}

CalibrationDesk::~CalibrationDesk() {
    cancel_.request_stop();
    thread_.request_stop();
    wake_.notify_all();
}

void CalibrationDesk::post(Job job) {
    const std::lock_guard lock(mutex_);
    jobs_.emplace_back(std::move(job), cancel_.get_token());
    wake_.notify_all();
}

void CalibrationDesk::work(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        Job job;
        std::stop_token cancelled;
        {
            std::unique_lock lock(mutex_);
            if (!wake_.wait(lock, stop, [&] { return !jobs_.empty(); })) return;
            std::tie(job, cancelled) = std::move(jobs_.front());
            jobs_.pop_front();
        }
        job(cancelled);
    }
}

void CalibrationDesk::set_doing(const QString& what) {
    if (doing_ == what) return;
    doing_ = what;
    emit busy_changed();
}

Expected<void> CalibrationDesk::open(const MethodId& method, const SensorId& sensor, const RobotId& robot) {
    if (!desk_.is_open()) return usage_error("no project is open", {}, "open or make one");
    close();
    std::vector<std::string> robots;
    for (const RobotSetup& r : desk_.project().robots) robots.push_back(r.id);
    std::vector<std::string> sensors;
    for (const SensorSetup& s : desk_.project().sensors) sensors.push_back(s.id);
    SEAM_TRY(auto session, CalibrationSession::open(desk_.path(), method, sensor, robot, robots, sensors));
    session_ = std::move(session);
    for (const Text& notice : session_->notices()) emit refused(shown(notice));
    if (session_->state().captures.empty())
        if (auto settings = prepared_settings(session_->method(), session_->state().settings, base(),
                                              desk_.project().calibrations,
                                              find_robot(desk_.project(), session_->robot_id()));
            settings && *settings != session_->state().settings)
            (void)session_->set_settings(std::move(*settings));
    emit changed();
    solve_when_due();
    return {};
}

// Chains name their sensors in their captures, which undo would bring back with the former name.
void CalibrationDesk::follow(const std::string& sensor, const std::string& robot) {
    if (session_->method().capture != CaptureKind::board_chain) return session_->renamed(sensor, robot);
    const MethodId method(session_->method().id);
    if (auto opened = open(method, SensorId(sensor), RobotId(robot)); !opened)
        emit refused(shown_error(opened.error()));
}

void CalibrationDesk::close() {
    cancel();
    ++generation_;
    session_.reset();
    undo_.clear();
    live_ = {};
    circle_.reset();
    automatic_ = false;
    emit changed();
}

const Calibration* CalibrationDesk::base() const {
    return session_ ? calibration_of(desk_.project(), session_->sensor_id()) : nullptr;
}

std::vector<std::string> CalibrationDesk::shot_sensors() const {
    std::vector<std::string> connected;
    for (const SensorState& s : desk_.station().sensors) connected.push_back(s.id);
    return seamwright::shot_sensors(*session_, desk_.project(), connected);
}

std::optional<Pose> CalibrationDesk::mounting() const {
    return session_ ? known_mounting(*session_, desk_.project()) : std::nullopt;
}

void CalibrationDesk::push(const QString& text, const SessionState& before) {
    undo_.push(new CmdSession(text, before, session_->state(), [this](const SessionState& state) {
        if (!session_) return;
        if (auto ok = session_->set_state(state); !ok) emit refused(shown_error(ok.error()));
        emit changed();
        solve_when_due();
    }));
}

Expected<void> CalibrationDesk::edited(Expected<void> done, const QString& text, const SessionState& before) {
    if (!done) return done;
    push(text, before);
    emit changed();
    solve_when_due();
    return done;
}

Expected<void> CalibrationDesk::leave_out(const std::string& id, bool left_out) {
    const SessionState before = session_->state();
    return edited(session_->leave_out(id, left_out),
                  (left_out ? tr("Leave out %1") : tr("Take in %1")).arg(QString::fromStdString(id)), before);
}

Expected<void> CalibrationDesk::set_verification(const std::string& id, bool verification) {
    const SessionState before = session_->state();
    return edited(
        session_->set_verification(id, verification),
        (verification ? tr("Keep %1 for verification") : tr("Solve with %1")).arg(QString::fromStdString(id)),
        before);
}

Expected<void> CalibrationDesk::remove(const std::string& id) {
    const SessionState before = session_->state();
    return edited(session_->remove(id), tr("Remove capture %1").arg(QString::fromStdString(id)), before);
}

Expected<void> CalibrationDesk::set(const std::string& name, double value) {
    const SessionState before = session_->state();
    return edited(session_->set(name, value), tr("Change %1").arg(QString::fromStdString(name)), before);
}

Expected<void> CalibrationDesk::set_nominal_mounting(const Pose& flange_from_sensor) {
    const SessionState before = session_->state();
    nlohmann::json settings = before.settings;
    settings["nominal_flange_from_sensor"] = pose_json(flange_from_sensor);
    return edited(session_->set_settings(std::move(settings)), tr("Mounting from the drawing"), before);
}

Expected<void> CalibrationDesk::state_repeatability(double mm, double deg) {
    const SessionState before = session_->state();
    nlohmann::json settings = before.settings;
    settings.erase("robot");
    if (mm > 0) {
        SEAM_OK(check_repeatability({mm, rad_from_deg(deg)}));
        settings["robot"] = {{"sigma_mm", mm}, {"sigma_deg", deg}};
    }
    if (settings == before.settings) return {};
    return edited(session_->set_settings(std::move(settings)), tr("State the robot's repeatability"), before);
}

bool CalibrationDesk::convention_in_doubt() const {
    const CalibrationSolution* solution = session_ ? session_->solution() : nullptr;
    if (!solution || !session_->method().convention_fits) return false;
    return solution->verdict() == Verdict::poor ||
           (solution->verdict() == Verdict::undetermined && solution->degenerate.empty());
}

const ConventionAnswer* CalibrationDesk::convention() const {
    return session_ && convention_ && convention_of_ == session_->state() ? &*convention_ : nullptr;
}

void CalibrationDesk::detect_convention() {
    if (!session_ || busy() || !session_->method().convention_fits) return;
    set_doing(tr("Trying the conventions of poses"));
    post([this, session = *session_, generation = generation_](const std::stop_token& cancelled) {
        auto found = std::make_shared<Expected<ConventionAnswer>>(
            detect_pose_convention(session.method(), session.data(), session.exclude()));
        if (cancelled.stop_requested()) return;
        QMetaObject::invokeMethod(this, [this, found, generation, state = session.state()] {
            if (generation != generation_) return;
            set_doing({});
            if (!*found) return emit refused(shown_error(found->error()));
            convention_ = std::move(**found);
            convention_of_ = state;
            emit changed();
        });
    });
}

Expected<void> CalibrationDesk::take_convention() {
    const ConventionAnswer* answer = convention();
    if (!answer || answer->offer.is_null())
        return usage_error("no convention is offered", {}, "ask for it first");
    const SessionState before = session_->state();
    nlohmann::json settings = before.settings;
    settings["pose_convention"] = answer->offer;
    return edited(session_->set_settings(std::move(settings)), tr("Read the poses in the convention found"),
                  before);
}

Expected<nlohmann::json> CalibrationDesk::capture_settings() const {
    return seamwright::capture_settings(*session_, desk_.project(), shot_sensors());
}

std::optional<Pose> CalibrationDesk::robot_pose() const {
    for (const RobotState& r : desk_.station().robots)
        if (r.id == session_->robot_id()) return r.base_from_flange;
    return std::nullopt;
}

void CalibrationDesk::capture(bool verification) {
    if (!session_ || busy()) return;
    auto settings = capture_settings();
    if (!settings) return emit refused(shown_error(settings.error()));
    const CaptureKind kind = session_->method().capture;
    waiting_for_shot_ = true;
    shot_verifies_ = verification;
    set_doing(tr("Capturing"));
    // A robot that is there tells its pose also where the method can do without: the next poses follow from
    // it.
    const auto& robots = desk_.station().robots;
    const bool robot = session_->method().robot ||
                       std::any_of(robots.begin(), robots.end(),
                                   [&](const RobotState& r) { return r.id == session_->robot_id(); });
    shots_number_ = desk_.worker().take_shots(shot_sensors(), robot ? session_->robot_id() : std::string(),
                                              shows_board(kind));
}

void CalibrationDesk::take_shots(const std::shared_ptr<const CalibrationShots>& shots, int number) {
    if (!waiting_for_shot_ || !session_ || number != shots_number_) return;
    waiting_for_shot_ = false;
    auto settings = capture_settings();
    if (!settings) {
        set_doing({});
        return emit refused(shown_error(settings.error()));
    }
    post([this, shots, project = desk_.project(), settings = std::move(*settings), session = *session_,
          generation = generation_, verification = shot_verifies_](const std::stop_token& cancelled) {
        auto taken =
            std::make_shared<ShotCaptures>(captures_of_shots(session, project, settings, *shots, cancelled));
        if (cancelled.stop_requested()) return;
        QMetaObject::invokeMethod(this, [this, taken, generation, verification] {
            if (generation != generation_) return;
            set_doing({});
            QStringList refusals;
            for (const Error& refusal : taken->refusals) refusals << shown_error(refusal);
            refusals.removeDuplicates();  // of the robot
            if (!refusals.isEmpty()) emit refused(refusals.join("\n"));
            if (!taken->captures.empty())
                take_captures(std::move(taken->captures), std::move(taken->settings), verification,
                              tr("Capture"));
        });
    });
}

void CalibrationDesk::take_captures(std::vector<CalibrationCapture> captures, nlohmann::json settings,
                                    bool verification, const QString& text) {
    const SessionState before = session_->state();
    if (auto done = add_captures(*session_, std::move(captures), std::move(settings), verification); !done)
        emit refused(shown_error(done.error()));
    if (!(session_->state() == before)) (void)edited({}, text, before);
}

void CalibrationDesk::load(const std::filesystem::path& path) {
    if (!session_ || busy()) return;
    std::optional<Calibration> used;
    if (base()) used = *base();
    auto settings = capture_settings();
    set_doing(tr("Reading"));
    const auto& chosen = settings ? *settings : session_->state().settings;
    post([this, path, used, settings = chosen, method = &session_->method(),
          generation = generation_](const std::stop_token& cancelled) {
        const auto progress = [&](int done, int total) {
            QMetaObject::invokeMethod(this, [this, done, total] { emit progressed(done, total); });
        };
        auto read = std::make_shared<Expected<ReadCaptures>>(
            read_captures(*method, settings, used ? &*used : nullptr, path, progress, cancelled));
        QMetaObject::invokeMethod(this, [this, read, generation, path] {
            if (generation != generation_) return;
            set_doing({});
            if (!*read) return emit refused(shown_error(read->error()));
            for (const Text& sentence : (*read)->skipped) emit refused(shown(sentence));
            take_captures(std::move((*read)->captures), std::move((*read)->settings), false,
                          tr("Load %1").arg(QString::fromStdString(path.filename().string())));
        });
    });
}

void CalibrationDesk::solve_when_due() {
    if (!session_ || session_->solution() || session_->solving_captures() < session_->method().fewest) return;
    solve();
}

void CalibrationDesk::solve() {
    if (!session_) return;
    set_doing(tr("Solving"));
    if (std::exchange(solving_, true)) {
        solve_again_ = true;  // what runs was cancelled, or is of a session before
        return;
    }
    post([this, session = *session_, generation = generation_](const std::stop_token& cancelled) {
        auto outcome = std::make_shared<Expected<CalibrationSolution>>(
            cancelled.stop_requested() ? Expected<CalibrationSolution>(CalibrationSolution{})
                                       : session.solve());
        QMetaObject::invokeMethod(this, [this, outcome, generation, cancelled, of = session.state()] {
            solving_ = false;
            if (doing_ == tr("Solving")) set_doing({});
            const bool again = std::exchange(solve_again_, false);
            if (generation != generation_ || !session_ || cancelled.stop_requested()) {
                if (again || generation != generation_) return solve_when_due();
                return emit changed();
            }
            if (!*outcome) {
                // Only what was asked for the captures as they are is worth a sentence.
                if (of == session_->state()) emit refused(shown_error(outcome->error()));
            } else if (auto taken = session_->take(**outcome, of); !taken) {
                emit refused(shown_error(taken.error()));
            }
            emit changed();
            if (!(of == session_->state())) solve_when_due();
        });
    });
}

void CalibrationDesk::cancel() {
    {
        const std::lock_guard lock(mutex_);
        cancel_.request_stop();
        cancel_ = std::stop_source();
    }
    if (waiting_for_shot_) {
        waiting_for_shot_ = false;
        desk_.worker().cancel();
    }
    set_doing({});
}

Expected<void> CalibrationDesk::finish(bool use) {
    if (!session_) return usage_error("no calibration is open", "calibrate");
    if (session_->stage() != SessionStage::use && session_->stage() != SessionStage::used)
        return input_error("the solution is not verified", session_->method().id,
                           "take a pose for verification first");
    SEAM_TRY(auto made, calibrations_of_session(*session_, desk_.project()));
    std::vector<std::string> ids;
    for (const Calibration& c : made) ids.push_back(c.id);
    SEAM_OK(desk_.take_calibrations(std::move(made), use));
    auto noted = session_->set_used_as(std::move(ids));
    emit changed();
    return noted;
}

void CalibrationDesk::exchange(std::filesystem::path& parked) {
    if (!session_) return;
    cancel();
    ++generation_;
    if (auto ok = session_->exchange(parked); !ok) emit refused(shown_error(ok.error()));
    emit changed();
    solve_when_due();
}

Expected<void> CalibrationDesk::begin_anew() {
    if (!session_) return usage_error("no calibration is open", "calibrate");
    cancel();
    ++generation_;
    auto parked = session_->begin_anew();
    if (parked)
        undo_.push(new CmdAnew(tr("Begin anew"), std::move(*parked),
                               [this](std::filesystem::path& folder) { exchange(folder); }));
    emit changed();
    return parked ? Expected<void>() : tl::unexpected(parked.error());
}

}  // namespace seamwright
