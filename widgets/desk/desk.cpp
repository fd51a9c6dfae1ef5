#include "widgets/desk/desk.h"

#include <QTimer>

#include "projects/measure/measure.h"
#include "projects/model/part_types.h"
#include "widgets/shown_text.h"

namespace seamwright {
namespace {

// Who is in trouble, by name.
std::vector<Text> troubles(const StationState& state) {
    std::vector<Text> names;
    for (const SensorState& s : state.sensors)
        if (!s.trouble.empty()) names.push_back(Text("sensor {}", s.id));
    for (const RobotState& r : state.robots)
        if (!r.trouble.empty()) names.push_back(Text("robot {}", r.id));
    return names;
}

constexpr int kLookAgainMs = 2000;

}  // namespace

Desk::Desk(QObject* parent) : QObject(parent), worker_(live_) {
    connect(&undo_, &QUndoStack::cleanChanged, this, [this] {
        if (modified() != was_modified_) emit modified_changed(was_modified_ = modified());
        if (!modified()) drop_kept();  // undone to what was saved
    });
    connect(&selection_, &Selection::changed, this, &Desk::set_recipes);
    connect(&recovery_writer_, &RecoveryWriter::written, this, [this] {
        if (recovery_writer_.kept()) emit recovery_written();  // else a newer one is under way
    });
    connect(&recovery_writer_, &RecoveryWriter::trouble, this, &Desk::trouble);
    connect(&worker_, &StationWorker::failed, this, [this](const QString& sentence) {
        note(EventKind::device, "studio", sentence.toStdString());
        emit trouble(sentence);
    });
    connect(&worker_, &StationWorker::state_changed, this, [this](std::shared_ptr<const StationState> state) {
        const bool changes = state->connected != state_->connected;
        if (state->connection != state_->connection || !state->connected) attended_.clear();
        const bool healthier = troubles(*state) != troubles(*state_);
        state_ = std::move(state);
        if (healthier && !changes) derive();
        // Connected anew, with a robot more, is connected before and after.
        if (state_->connected) take_identities(*state_);
        if (changes) {
            note(EventKind::device, "studio",
                 state_->connected ? "devices connected" : "devices disconnected");
            set_recipes();
            derive();
        }
        emit station_changed();
    });
    const auto run_ended = [this](const auto&) {
        derive();
        emit runs_changed();
        emit events_changed();
    };
    connect(&worker_, &StationWorker::measured, this, run_ended);
    connect(&worker_, &StationWorker::panel_measured, this, run_ended);
    connect(&worker_, &StationWorker::panel_learnt, this, run_ended);
    connect(&worker_, &StationWorker::proven, this, [this] {
        derive();
        emit events_changed();
    });
    auto* look = new QTimer(this);
    connect(look, &QTimer::timeout, this, &Desk::look_again);
    look->start(kLookAgainMs);
    derive();
}

Desk::~Desk() {
    undo_.disconnect(this);  // it clears itself at its end; what is unsaved stays kept
    worker_.close();
}

void Desk::changed() {
    if (file_) {
        if (!recovery_) recovery_writer_.write(project_);  // never over what waits for an answer
        worker_.use(project_);
    }
    if (modified() != was_modified_) emit modified_changed(was_modified_ = modified());
    // A selected thing that is gone is not selected any more.
    if (!selection_.spot().empty() && index_of<Spot>(project_, selection_.spot()) < 0)
        selection_.select_spot("");
    if (!selection_.region().empty() && index_of<Region>(project_, selection_.region()) < 0)
        selection_.select_region("");
    // Nobody has said to stand beside a robot that bears the name of another from now on.
    std::erase_if(attended_, [&](const std::string& id) { return !find_robot(project_, id); });
    select_measured_type();
    set_recipes();
    derive();
    emit project_changed();
}

// One of the project's: what is measured without a type in a project with types is refused.
void Desk::select_measured_type() {
    const auto& types = project_.part_types;
    if (!find_type(project_, selection_.part_type()))
        selection_.select_part_type(types.empty() ? "" : types.front().id);
}

bool Desk::asks_who() const {
    return !users().empty();
}

std::vector<User> Desk::users() const {
    if (!file_) return {};
    auto users = file_->users();
    return users ? std::move(*users) : std::vector<User>{};
}

Expected<void> Desk::sign_in(const std::string& name, const std::string& password) {
    if (!file_) return usage_error("no project is open", {}, "open or make one");
    SEAM_TRY(auto signed_in, file_->sign_in(name, password));
    person_ = signed_in.person();
    signed_in_ = std::move(signed_in);
    worker_.act_for(signed_in_);
    emit person_changed();
    emit events_changed();
    return {};
}

void Desk::sign_out(const Text& why) {
    if (!person_) return;
    worker_.act_for(std::nullopt);
    if (file_)
        if (auto out = file_->sign_out(why); !out) {
            file_->forget_person();
            emit trouble(shown_error(out.error()));
        }
    person_.reset();
    signed_in_.reset();
    emit person_changed();
    emit events_changed();
}

Expected<void> Desk::may(Deed deed) const {
    if (!file_) return usage_error("no project is open", {}, "open or make one");
    return file_->may(deed);
}

void Desk::take_identities(const StationState& state) {
    bool news = false;
    for (const SensorState& s : state.sensors)
        for (SensorSetup& setup : project_.sensors)
            if (setup.id == s.id && !(setup.identity == s.identity)) setup.identity = s.identity, news = true;
    for (const RobotState& r : state.robots)
        for (RobotSetup& setup : project_.robots)
            if (setup.id == r.id && !(setup.identity == r.identity)) setup.identity = r.identity, news = true;
    if (!news) return;
    // Who answered is no edit: nobody undoes it. It is saved with the next save, and the station knows it.
    worker_.use(project_);
    emit project_changed();
}

void Desk::set_recipes() {
    const Spot* selected = find_spot(project_, selection_.spot());
    for (const SensorSetup& sensor : project_.sensors) {
        LiveRecipe recipe;
        recipe.peaks = sensor.peaks;
        recipe.filter = sensor.filter;
        for (const Calibration& c : project_.calibrations)
            if (c.id == sensor.calibration_id) recipe.model = c.model;
        if (selected && selected->sensor_id == sensor.id) {
            recipe.feature = selected->feature;
            recipe.taught = selected->reference_profile;
            recipe.taught_at_mm = {selected->reference_mm.x(), selected->reference_mm.z()};
        }
        live_.set_recipe(sensor.id, recipe);
    }
}

void Desk::derive() {
    facts_.sensors.emplace();
    facts_.robots.emplace();
    for (const SensorState& s : state_->sensors)
        facts_.sensors->push_back({s.id, state_->connected, s.trouble});
    for (const RobotState& r : state_->robots) facts_.robots->push_back({r.id, state_->connected, r.trouble});
    if (file_)
        if (auto known = gather(*file_, facts_); !known) emit trouble(shown_error(known.error()));
    checks_ = checklist(project_, facts_);
    steps_ = steps_of(checks_, language_);
    emit checklist_changed();
}

// What another program, the headless runner, has put into the file.
void Desk::look_again() {
    if (!file_ || worker_.busy()) return;
    const auto newer = file_->evidence(facts_.evidence.empty() ? 0 : facts_.evidence.back().id);
    if (!newer || newer->empty()) return;
    derive();
    emit runs_changed();
    emit events_changed();
}

void Desk::set_language(Language language) {
    language_ = language;
    derive();
}

Expected<void> Desk::record(const Evidence& evidence) {
    if (!file_) return usage_error("no project is open", {}, "open or make one");
    SEAM_OK(file_->append_evidence(evidence, project_));
    derive();
    return {};
}

Expected<std::vector<RunSummary>> Desk::runs() const {
    if (!file_) return std::vector<RunSummary>{};
    return file_->runs();
}

Expected<RunRecord> Desk::run(std::int64_t number) const {
    if (!file_) return usage_error("no project is open");
    return file_->load_run(number, false);
}

Expected<std::vector<EventRecord>> Desk::events() const {
    if (!file_) return std::vector<EventRecord>{};
    return file_->events();
}

Expected<void> Desk::delete_run(std::int64_t number) {
    if (!file_) return usage_error("no project is open");
    auto deleted = file_->delete_run(number);
    derive();
    emit runs_changed();
    return deleted;
}

void Desk::note(EventKind kind, const std::string& subject, const Text& text) {
    if (!file_) return;
    if (auto id = file_->append_event({0, utc_now(), 0, kind, subject, text}); !id)
        emit trouble(shown_error(id.error()));
    emit events_changed();
}

}  // namespace seamwright
