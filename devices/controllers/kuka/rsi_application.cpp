#include "devices/controllers/kuka/rsi_application.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <pugixml.hpp>
#include <set>

#include "devices/controllers/kuka/krl/arguments.h"

namespace seamwright::krl {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
constexpr double kBrakes_ms = 100;
constexpr std::size_t kAdvance = 3;  // $ADVANCE of BAS(#INITMOV)
constexpr std::size_t kMostTold = 200;
constexpr int kOutputs = 4096;

// What the option package declares.
constexpr const char* kRsiConstants = "DEFDAT RSI_CONSTANTS PUBLIC\nDECL GLOBAL INT RSIOK=0\nENDDAT\n";

pugi::xml_node rsi_object(const pugi::xml_document& context, const char* attribute,
                          const std::string& value) {
    const auto found =
        context.child("RSIObjects").find_child_by_attribute("RSIObject", attribute, value.c_str());
    if (!found) throw KrlError(fmt::format("the context has no object with {} {}", attribute, value));
    return found;
}
int rsi_index(const pugi::xml_node& object) {
    const int index = object.child("Parameters")
                          .find_child_by_attribute("Parameter", "Name", "Index")
                          .attribute("ParamValue")
                          .as_int();
    if (index < 1 || index > kOutputs) throw KrlError("the context names an output that there is not");
    return index;
}
std::string channel_of(const pugi::xml_document& configuration, const char* way, const char* tag) {
    const auto element = configuration.child("ROOT")
                             .child(way)
                             .child("ELEMENTS")
                             .find_child_by_attribute("ELEMENT", "TAG", tag);
    if (!element) throw KrlError(fmt::format("ETHERNET's configuration has no element {}", tag));
    return element.attribute("INDX").value();
}

bool stops_advance_run(const std::string& name) {
    return name == "$OUT" || name == "$IN" || name == "$POS_ACT" || name == "$STOPMESS";
}

}  // namespace

RsiApplication::RsiApplication(RsiApplicationSettings settings, const std::vector<ProgramFile>& files)
    : settings_(std::move(settings)) {
    machine_.load("RSI_CONSTANTS.dat", kRsiConstants);
    for (const ProgramFile& file : files) {
        if (file.name == "seamwright_rsi.src")
            machine_.load(file.name, file.text);
        else
            files_[file.name] = file.text;
    }
    operator_ = std::jthread([this](const std::stop_token& stop) { operate(stop); });
}

RsiApplication::~RsiApplication() {
    operator_ = {};
}

void RsiApplication::operate(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        std::stop_source run;
        {
            const std::lock_guard lock(mutex_);
            run_ = run;
            path_ms_ = 0;
            rate_ = 1;
            at_block_ = prepared_ = braking_ = false;
        }
        const std::stop_callback with_it(stop, [&] { run.request_stop(); });
        std::string failure;
        const TaskEnd end =
            Task(machine_, *this, TaskKind::robot, run.get_token()).run("SEAMWRIGHT_RSI", failure);
        {
            const std::lock_guard lock(mutex_);
            on_ = false;
            path_output_ = release_output_ = 0;
            ends_ms_.clear();
        }
        if (end == TaskEnd::failed) {
            told("SEAMWRIGHT_RSI: " + failure);
            std::fprintf(stderr, "simulated KUKA: SEAMWRIGHT_RSI: %s\n", failure.c_str());
        }
        const auto again = Clock::now() + milliseconds(settings_.restart_ms);
        while (!stop.stop_requested() && Clock::now() < again) std::this_thread::sleep_for(milliseconds(2));
    }
}

RsiApplication::Now RsiApplication::cycle(int ms) {
    const std::lock_guard lock(mutex_);
    rate_ = braking_ ? std::max(0.0, rate_ - ms / kBrakes_ms) : 1;
    if (!ends_ms_.empty()) path_ms_ = std::min(path_ms_ + rate_ * ms, ends_ms_.back());
    while (!ends_ms_.empty() && ends_ms_.front() <= path_ms_) ends_ms_.pop_front();
    Now now;
    now.on = on_;
    now.relative = relative_;
    now.session = sessions_;
    now.under_way = on_ && out(path_output_);
    now.programmed = settings_.path.at(path_ms_ / 1e3);
    return now;
}

bool RsiApplication::out(int number) const {
    const auto it = outputs_.find(number);
    return it != outputs_.end() && it->second;
}

void RsiApplication::set_release(bool released) {
    const std::lock_guard lock(mutex_);
    if (on_) outputs_[release_output_] = released;
}

void RsiApplication::rsi_fails() {
    const std::lock_guard lock(mutex_);
    on_ = false;
    run_.request_stop();
}

std::vector<std::string> RsiApplication::messages() const {
    const std::lock_guard lock(mutex_);
    return messages_;
}

void RsiApplication::told(const std::string& message) {
    const std::lock_guard lock(mutex_);
    if (messages_.size() < kMostTold) messages_.push_back(message);
}

std::optional<Value> RsiApplication::system_value(Task& task, const Place& place) {
    const std::string& name = place.system;
    if (task.stops_advance() && stops_advance_run(name)) wait_main_run(task);
    if (name == "$STOPMESS") return Value::boolean(settings_.stop_message());
    const std::lock_guard lock(mutex_);
    if (name == "$OUT") return Value::boolean(out(index_of(place, kOutputs)));
    if (name == "$POS_ACT") return Value::of(settings_.path.at(path_ms_ / 1e3), Type::e6pos);
    return std::nullopt;
}

bool RsiApplication::set_system(Task& task, const Place& place, const Value& value) {
    if (place.system != "$OUT") return false;
    wait_main_run(task);
    const int number = index_of(place, kOutputs);
    const bool on = value.truth();
    bool over = false;
    {
        const std::lock_guard lock(mutex_);
        over = on_ && number == path_output_ && out(number) && !on;
        outputs_[number] = on;
    }
    if (over) settings_.path_over();
    return true;
}

std::optional<Value> RsiApplication::call(Task& task, const std::string& name,
                                          std::vector<Argument>& arguments) {
    try {
        if (const auto message = message_of(name, arguments)) {
            told(*message);
            return Value();
        }
        if (name == "IR_STOPM") {  // of BASISTECH
            expect_count(arguments, 0);
            return Value();
        }
        if (name == "BAS") {
            expect_initmov(arguments);
            const std::lock_guard lock(mutex_);
            prepared_ = true;
            return Value();
        }
        return rsi(task, name, arguments);
    } catch (const KrlError& e) {
        throw KrlError(fmt::format("{}: {}", name, e.what()));
    }
}

std::optional<Value> RsiApplication::rsi(Task& task, const std::string& name,
                                         const std::vector<Argument>& arguments) {
    if (name == "RSI_CREATE") {
        expect_count(arguments, 3);
        if (!arguments[1].place || !arguments[1].place->variable ||
            arguments[1].place->variable->type != Type::integer)
            throw KrlError("parameter 2 is no INT variable");
        (void)value_of(arguments, 2, Type::boolean).truth();
        create(text_of(arguments, 0));
        task.write(*arguments[1].place, Value::integer(1));
    } else if (name == "RSI_ON") {
        expect_count(arguments, 1);
        const std::string& mode = value_of(arguments, 0, Type::enumeration).text;
        if (mode != "ABSOLUTE" && mode != "RELATIVE") throw KrlError("parameter 1 is no mode of RSI");
        const std::lock_guard lock(mutex_);
        if (path_output_ == 0) throw KrlError("no context is created");
        if (on_) throw KrlError("RSI is on already");
        relative_ = mode == "RELATIVE";
        on_ = true;
        ++sessions_;
    } else if (name == "RSI_OFF") {
        expect_count(arguments, 0);
        wait_main_run(task);
        const std::lock_guard lock(mutex_);
        if (!on_) throw KrlError("RSI is off already");
        on_ = false;
    } else {
        return std::nullopt;
    }
    return Value::integer(0);
}

// Follows <Path> and <Release> through the context to the outputs of the program.
void RsiApplication::create(const std::string& name) {
    const auto text = [&](const std::string& file) {
        const auto it = files_.find(file);
        if (it == files_.end()) throw KrlError(fmt::format("there is no file {} in SensorInterface", file));
        return it->second;
    };
    if (!name.ends_with(".rsi")) throw KrlError("parameter 1 is no context");
    (void)text(name);
    pugi::xml_document context, configuration;
    if (!context.load_string(text(name + ".xml").c_str())) throw KrlError("the context is no XML");
    const pugi::xml_node ethernet = rsi_object(context, "ObjType", "ETHERNET");
    const std::string file = ethernet.child("Parameters")
                                 .find_child_by_attribute("Parameter", "Name", "ConfigFile")
                                 .attribute("ParamValue")
                                 .value();
    if (!configuration.load_string(text(file).c_str())) throw KrlError(file + " is no XML");
    const auto fed_by = ethernet.child("Inputs").find_child_by_attribute(
        "Input", "InIdx", channel_of(configuration, "SEND", "Path").c_str());
    const int path = rsi_index(rsi_object(context, "ObjID", fed_by.attribute("OutObjID").value()));
    const pugi::xml_node sets = rsi_object(context, "ObjType", "MAP2DIGOUT");
    if (channel_of(configuration, "RECEIVE", "Release") !=
        sets.child("Inputs").child("Input").attribute("OutIdx").value())
        throw KrlError("<Release> is wired to no output");
    const std::lock_guard lock(mutex_);
    path_output_ = path;
    release_output_ = rsi_index(sets);
}

void RsiApplication::move(Task& task, Motion motion, const Value&, bool, std::vector<PathTrigger> triggers) {
    if (!triggers.empty()) throw KrlError("TRIGGER is not known to this robot");
    {
        const std::lock_guard lock(mutex_);
        if (!prepared_) throw KrlError("the velocities are not initialised");
        if (motion != Motion::ptp && !at_block_)
            throw KrlError("the first motion of a selected program is a PTP (block coincidence)");
        at_block_ = true;
        if (motion == Motion::ptp) return;  // to where it stands
        ends_ms_.push_back((ends_ms_.empty() ? path_ms_ : ends_ms_.back()) + settings_.path_s * 1e3);
    }
    task.wait([this] {
        const std::lock_guard lock(mutex_);
        return ends_ms_.size() <= kAdvance;
    });
}

void RsiApplication::wait_main_run(Task& task) {
    task.wait([this] {
        const std::lock_guard lock(mutex_);
        return ends_ms_.empty() || (braking_ && rate_ == 0);
    });
}

void RsiApplication::brake(Task& task) {
    {
        const std::lock_guard lock(mutex_);
        braking_ = true;
    }
    task.wait([this] {
        const std::lock_guard lock(mutex_);
        return ends_ms_.empty() || rate_ == 0;
    });
}

void RsiApplication::give_up_motions(Task&) {
    const std::lock_guard lock(mutex_);
    ends_ms_.clear();
    braking_ = false;
}

void RsiApplication::interrupt_ended(Task&) {
    const std::lock_guard lock(mutex_);
    braking_ = false;
}

void RsiApplication::pulse(Task&, const Place&, bool, double) {
    throw KrlError("PULSE is not known to this robot");
}

void RsiApplication::wait_seconds(Task& task, double seconds) {
    const auto until =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
    task.wait([&] { return Clock::now() >= until; });
}

void RsiApplication::halt(Task& task) {
    const auto start_key = Clock::now() + milliseconds(settings_.restart_ms);
    task.unlocked([&] {
        while (!task.stop().stop_requested() && Clock::now() < start_key)
            std::this_thread::sleep_for(milliseconds(2));
    });
}

}  // namespace seamwright::krl
