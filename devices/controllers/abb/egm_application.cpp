#include "devices/controllers/abb/egm_application.h"

#include <fmt/format.h>

#include <limits>

#include "devices/controllers/abb/rapid/rapid_system.h"

namespace seamwright::rapid {
namespace {

constexpr const char* kTask = "T_ROB1";
constexpr std::size_t kEgmAdvance = 1;  // motions that the program may be ahead
constexpr double kEgmForever_s = 1e9, kPoll_s = 0.001;
constexpr double kSettles_ms = 100;  // in a fine point
constexpr int kSample_ms = 4;

bool is_fine(const Call& c) {
    return c["zone"].parts[0].number != 0;
}

}  // namespace

EgmApplication::EgmApplication(const EgmApplicationSettings& settings, const std::vector<SourceText>& modules)
    : settings_(settings),
      machine_(std::make_unique<Machine>(make_instruction_set(instruction_set_text(), {}), natives(),
                                         [] { return true; })) {
    machine_->add(kTask, modules, "main", true);
    machine_->start();
}

EgmApplication::~EgmApplication() {
    machine_->stop();
}

EgmApplication::Now EgmApplication::cycle(int ms, bool answered, bool permitted) {
    operate(ms);
    Now now;
    bool stopped = false;
    {
        const std::lock_guard lock(mutex_);
        if (mci_ == EgmMci::running) {
            silent_ms_ = answered ? 0 : silent_ms_ + ms;
            if (silent_ms_ > timeout_ms_) stop({kErrUdpucComm, "no answer came within CommTimeout"});
        }
        if (mci_ == EgmMci::running && !ends_ms_.empty()) path_ms_ = std::min(path_ms_ + ms, ends_ms_.back());
        while (!ends_ms_.empty() && ends_ms_.front() <= path_ms_) ends_ms_.pop_front();
        now.talks = set_up_;
        now.mci = mci_;
        now.programmed = settings_.path.at(path_ms_ / 1e3);
        now.travel = settings_.path.tangent(path_ms_ / 1e3);
        now.paths = paths_;
        now.stops = stops_;
        stopped = failure_.has_value();
    }
    const std::lock_guard lock(machine_->mutex());
    machine_->find(kTask, "simPermitted")->number = permitted ? 1 : 0;
    machine_->find(kTask, "simStopped")->number = stopped ? 1 : 0;
    return now;
}

// Whoever finds the program standing starts it from its beginning.
void EgmApplication::operate(int ms) {
    Task& task = *machine_->task(folded(kTask));
    stood_ms_ = task.running() ? 0 : stood_ms_ + ms;
    if (stood_ms_ < settings_.restart_ms) return;
    stood_ms_ = 0;
    task.start();
}

void EgmApplication::egm_fails() {
    const std::lock_guard lock(mutex_);
    if (mci_ == EgmMci::running) stop({0, "EGM has stopped the robot"});
}

void EgmApplication::stop(Failure why) {
    failure_ = std::move(why);
    mci_ = EgmMci::error;
    ends_ms_.clear();
    ++stops_;
}

void EgmApplication::set_up(const Call& c) {
    if (!c["egmid"].object) Task::raise(0, "this egmident has no EGM process: EGMGetId");
    if (c.text("extconfigname") != "SeamwrightPath")
        Task::raise(0, "there is no External Motion Interface Data " + c.text("extconfigname"));
    if (c.text("ucdevice") != "UCdevice") Task::raise(0, "there is no UdpUc device " + c.text("ucdevice"));
    if (!c.has("pathcorr") || !(c.has("aptr") || c.has("latr")))
        Task::raise(0, "a path is corrected with \\PathCorr and \\APTR or \\LATR");
    const double timeout_s = c.has("commtimeout") ? c.number("commtimeout") : 1;
    if (!(timeout_s > 0)) Task::raise(0, "CommTimeout is no time");
    const std::lock_guard lock(mutex_);
    set_up_ = true;
    active_ = false;
    failure_.reset();
    mci_ = EgmMci::stopped;
    timeout_ms_ = timeout_s * 1e3;
}

Value EgmApplication::egm_move(Task& task, const Call& c, double seconds) {
    if (c.has("nocorr")) Task::raise(0, "\\NoCorr is not executed here");
    const bool fine = is_fine(c);
    {
        const std::lock_guard lock(mutex_);
        if (!active_) Task::raise(0, "EGM is not activated: EGMActMove");
        if (!failure_) {
            if (mci_ != EgmMci::running) silent_ms_ = 0;
            mci_ = EgmMci::running;
            ends_ms_.push_back((ends_ms_.empty() ? path_ms_ : ends_ms_.back()) + seconds * 1e3);
        }
    }
    (void)task.wait_until(
        [&] {
            const std::lock_guard lock(mutex_);
            return failure_ || ends_ms_.size() <= (fine ? 0 : kEgmAdvance);
        },
        std::chrono::duration<double>(kEgmForever_s), std::chrono::duration<double>(kPoll_s));
    if (fine) task.pause(kSettles_ms / 1e3);
    std::optional<Failure> failure;
    {
        const std::lock_guard lock(mutex_);
        failure = failure_;
        if (!failure && fine) {
            mci_ = EgmMci::stopped;
            ++paths_;
        }
    }
    if (failure) Task::raise(failure->number, failure->what);
    return {};
}

std::map<std::string, Native> EgmApplication::natives() {
    auto n = general_natives();
    n["movel"] = [this](Task& t, const Call& c) -> Value {
        if (!is_fine(c)) Task::raise(0, "before EGM the robot stands in a fine point");
        {
            const std::lock_guard lock(mutex_);
            if (active_) Task::raise(0, "an ordinary motion while EGM is active");
            path_ms_ = 0;
        }
        t.pause(kSettles_ms / 1e3);
        return {};
    };
    n["egmgetid"] = [](Task&, const Call& c) -> Value {
        if (c["egmid"].object) Task::raise(0, "the EGM process has its identity already");
        c["egmid"].object = std::make_shared<int>(1);
        return {};
    };
    n["egmreset"] = [this](Task&, const Call& c) -> Value {
        c["egmid"].object.reset();
        const std::lock_guard lock(mutex_);
        set_up_ = active_ = false;
        mci_ = EgmMci::undefined;
        ends_ms_.clear();
        return {};
    };
    n["egmsetupuc"] = [this](Task&, const Call& c) -> Value {
        set_up(c);
        return {};
    };
    n["egmactmove"] = [this](Task&, const Call& c) -> Value {
        const double rate = c.has("samplerate") ? c.number("samplerate") : settings_.cycle_ms;
        if (rate != settings_.cycle_ms || settings_.cycle_ms % kSample_ms != 0)
            Task::raise(0, fmt::format("EGM has no sample rate of {} ms", rate));
        const std::lock_guard lock(mutex_);
        if (!set_up_) Task::raise(0, "EGM is not set up: EGMSetupUC");
        active_ = true;
        return {};
    };
    n["egmmovel"] = [this](Task& t, const Call& c) {
        return egm_move(t, c, settings_.ends ? settings_.lead_s : std::numeric_limits<double>::infinity());
    };
    n["egmmovec"] = [this](Task& t, const Call& c) { return egm_move(t, c, settings_.path_s); };
    n["stopmove"] = n["clearpath"] = [this](Task&, const Call&) -> Value {
        const std::lock_guard lock(mutex_);
        ends_ms_.clear();
        return {};
    };
    n["startmove"] = [](Task&, const Call&) { return Value{}; };
    return n;
}

}  // namespace seamwright::rapid
