#include "devices/controllers/kuka/cell_operator.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "core/number_text.h"
#include "devices/exchange/files.h"
#include "devices/exchange/settings.h"
#include "devices/kuka/program.h"

namespace seamwright::krl {
namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kOperatorTick = std::chrono::milliseconds(2);
constexpr auto kStartKey = std::chrono::milliseconds(300);  // from a HALT to the operator's hand
constexpr auto kReady = std::chrono::milliseconds(500);     // a restarted application, until it waits

// The customer's application: waits for a part, and where it is corrected runs a path in each region's frame.
constexpr const char* kApplication = R"(DEF BODYCELL()
DECL INT N
BAS(#INITMOV,0)
$BASE=$NULLFRAME
$TOOL=$NULLFRAME
PTP $AXIS_ACT
SW_SETUP()
; the line calls by itself, and measuring by command needs no call
SW_CALLS=FALSE
LOOP
   SEAMWRIGHT_SPOTS()
   WAIT FOR (SW_VERDICT<>0) OR ($TIMER[SW_TIMER]>=0)
   ; something of its own to do first, unless the permission is taken back meanwhile
   $TIMER[11]=-@WAIT@
   $TIMER_STOP[11]=FALSE
   WAIT FOR (SW_VERDICT<>1) OR ($TIMER[11]>=0)
   IF SW_VERDICT==1 THEN
      FOR N=1 TO SW_FRAMES
         ; a number that no region of the program has
         IF NOT StrComp(SW_NAME[N,],"-",#CASE_SENS) THEN
            SW_ACTIVATE(N)
            $VEL.CP=0.25
            LIN_REL {Z 10.0} C_DIS
            LIN_REL {Z -10.0}
         ENDIF
      ENDFOR
   ENDIF
ENDLOOP
END
)";

int serial_number(const std::string& serial) {
    std::string digits;
    for (const char c : serial)
        if (c >= '0' && c <= '9') digits += c;
    return number_from<int>(digits.substr(0, 9)).value_or(1);
}

}  // namespace

Expected<OperatorSettings> parse_operator_settings(const nlohmann::json& settings, int port, int least_port) {
    OperatorSettings s;
    s.port = port;
    SettingsReader f(settings, "settings");
    f.only({"address", "port", "slow_ms", "time_scale", "programs", "application_wait_ms"});
    f.text("address", s.address);
    f.text("programs", s.programs);
    f.whole("port", s.port, least_port, 65534);
    f.whole("slow_ms", s.slow_ms, 0, 60000);
    f.whole("application_wait_ms", s.application_wait_ms, 0, 86400000);
    f.number("time_scale", s.time_scale, 0.01, 1000);
    if (f.failed()) return tl::unexpected(f.error());
    return s;
}

KukaCell::KukaCell(std::shared_ptr<SimulatedCell> cell, OperatorSettings settings, bool submit)
    : cell_(std::move(cell)), settings_(std::move(settings)), with_submit_(submit) {}

KukaCell::~KukaCell() = default;

Expected<std::vector<ProgramFile>> KukaCell::files() const {
    if (!settings_.programs.empty()) {
        std::vector<ProgramFile> all;
        for (const char* name : {"Seamwright.xml", "seamwright.dat", "seamwright.src", "seamwright_sub.sub",
                                 "seamwright_spots.dat", "seamwright_spots.src"}) {
            SEAM_TRY(auto text, read_text_file(std::filesystem::path(settings_.programs) / name));
            all.push_back({name, text});
        }
        return all;
    }
    ProgramRequest request;
    request.project = "simulated cell";
    request.moves = cell_->program();
    for (const auto& [name, taught] : cell_->settings().robot.frames) {
        auto frame = cell_->read_frame(name);
        request.frames.push_back({name, name, frame ? *frame : taught});
    }
    request.settings = {{"listen", settings_.address}, {"port", std::max(settings_.port, 1)}};
    return write_kuka_program(request);
}

Expected<void> KukaCell::load(bool everything) {
    SEAM_TRY(auto all, files());
    try {
        std::stable_sort(all.begin(), all.end(), [](const ProgramFile& a, const ProgramFile& b) {
            return a.name.ends_with(".dat") > b.name.ends_with(".dat");
        });
        for (const ProgramFile& file : all) {
            if (file.name.ends_with(".xml"))
                channels_[capitals(file.name.substr(0, file.name.size() - 4))] = file.text;
            else if (everything || file.name.starts_with("seamwright_spots"))
                machine_.load(file.name, file.text);
        }
        if (everything) {
            std::string application = kApplication;
            application.replace(application.find("@WAIT@"), 6, std::to_string(settings_.application_wait_ms));
            machine_.load("bodycell.src", application);
        }
        if (everything && with_submit_)
            for (const auto& [name, xml] : channels_) (void)parse_eki_configuration(xml);
    } catch (const KrlError& e) {
        return device_error(Text("the controller does not take the program: {}", e.what()), "simulated KUKA");
    }
    return {};
}

Expected<void> KukaCell::begin() {
    const auto moves = cell_->program();
    loaded_ = program_signature(moves);
    SEAM_OK(load(true));
    RobotSettings robot;
    robot.time_scale = settings_.time_scale;
    robot.slow = Timeout(settings_.slow_ms);
    robot.serial = serial_number(cell_->settings().serial);
    robot.fault = [this] { return fault(); };
    robot.before_telegram = [this] { refresh(); };
    robot.channels = channels_;
    Pose start = Pose::Identity();
    if (const auto at = cell_->reported_flange())
        start = *at;
    else if (!moves.empty())
        start = moves.front().entry;
    robot_ = std::make_unique<KukaRobot>(cell_, std::move(robot), start, 1);
    operator_ = std::jthread([this](const std::stop_token& stop) { operate(stop); });
    if (with_submit_)
        submit_ = std::jthread([this](const std::stop_token& stop) {
            std::string failure;
            TaskEnd end{};
            {
                const std::unique_ptr<Task> task =
                    std::make_unique<Task>(machine_, *robot_, TaskKind::submit, stop);
                end = task->run("SEAMWRIGHT_SUB", failure);
            }
            if (end != TaskEnd::failed) return;
            robot_->told("SEAMWRIGHT_SUB: " + failure);
            std::fprintf(stderr, "simulated KUKA: SEAMWRIGHT_SUB: %s\n", failure.c_str());
        });
    return {};
}

void KukaCell::end() {
    operator_ = {};
    submit_ = {};
    {
        const std::lock_guard lock(operator_mutex_);
        cancel();
    }
    robot_.reset();
}

void KukaCell::cancel() {
    program_.request_stop();
    if (robot_) robot_->arm().halt();
    program_ = {};
    if (robot_) robot_->set_state(ProgramState::free);
    selected_.clear();
}

void KukaCell::select(const std::string& program) {
    cancel();
    selected_ = program;
    program_failed_ = false;
    robot_->select(program);
    robot_->set_state(ProgramState::active);
    program_ = std::jthread([this, program](const std::stop_token& stop) {
        std::string failure;
        TaskEnd end{};
        {
            Task task(machine_, *robot_, TaskKind::robot, stop);
            end = task.run(program, failure);
        }
        if (end == TaskEnd::stopped) return;
        robot_->set_state(end == TaskEnd::failed ? ProgramState::stopped : ProgramState::ended);
        if (end != TaskEnd::failed) return;
        program_failed_ = true;
        robot_->told(program + ": " + failure);
        std::fprintf(stderr, "simulated KUKA: %s: %s\n", program.c_str(), failure.c_str());
    });
}

void KukaCell::refresh() {
    if (!settings_.programs.empty()) return;
    const std::string now = program_signature(cell_->program());
    const std::lock_guard lock(operator_mutex_);
    if (now == loaded_) return;
    loaded_ = now;
    const std::string running = selected_;
    cancel();
    if (auto loaded = load(false); !loaded) {
        robot_->told(loaded.error().sentence());
        return;
    }
    if (running.empty()) return;
    select(running);
    for (const auto until = Clock::now() + kReady; Clock::now() < until && number("SW_WAITS", 1) == 0;)
        std::this_thread::sleep_for(kOperatorTick);
}

void KukaCell::operate(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        robot_->tick();
        refresh();
        line_calls();
        keep_frames();
        {
            const std::lock_guard lock(operator_mutex_);
            const RobotMode mode = cell_->mode();
            std::string wanted = mode == RobotMode::manual_reduced ? "SEAMWRIGHT" : "BODYCELL";
            if (mode == RobotMode::stopped || mode == RobotMode::fault) wanted.clear();
            if (wanted.empty()) {
                if (!selected_.empty()) cancel();
            } else if (wanted != selected_) {
                select(wanted);
            }
            const bool halted = robot_->halted();
            if (!halted) halted_since_ = Clock::now();
            if (halted && Clock::now() - halted_since_ > kStartKey) select(wanted);
        }
        std::this_thread::sleep_for(kOperatorTick);
    }
}

// The line's controller: names the part and calls, as a submit program of the plant would.
void KukaCell::line_calls() {
    const auto call = take_start();
    if (!call) return;
    const auto text = [](std::string said) {
        std::replace_if(
            said.begin(), said.end(), [](char c) { return c < ' ' || c > '~' || c == '"'; }, '?');
        return "\"" + (said.empty() ? "-" : said.substr(0, 79)) + "\"";
    };
    const std::lock_guard lock(machine_.mutex());
    try {
        machine_.set(*robot_, "SW_PART[]", text(call->part_id));
        if (!call->part_type.empty()) machine_.set(*robot_, "SW_TYPE[]", text(call->part_type));
        machine_.set(*robot_, "SW_CALL", "TRUE");
    } catch (const KrlError& e) {
        robot_->told(e.what());
    }
}

// What was written on the controller is the cell's.
void KukaCell::keep_frames() {
    std::vector<std::pair<std::string, Pose>> frames;
    {
        const std::lock_guard lock(machine_.mutex());
        const auto names = machine_.find("SW_NAME", ""), poses = machine_.find("SW_FRAME", "");
        const auto count = static_cast<std::size_t>(number("SW_FRAMES", 0));
        if (!names || !poses) return;
        for (std::size_t i = 0; i < std::min(count, poses->cells.size()); ++i)
            if (poses->cells[i].set)
                frames.emplace_back(names->row_text(i * names->row_length()), poses->cells[i].pose());
    }
    for (const auto& [name, pose] : frames) {
        const auto known = cell_->read_frame(name);
        if (known && !known->isApprox(pose, 1e-9)) (void)cell_->write_frame(name, pose);
    }
}

double KukaCell::number(const char* name, double otherwise) const {
    const std::lock_guard lock(machine_.mutex());
    const auto variable = machine_.find(name, "");
    if (!variable || !variable->cells.front().set) return otherwise;
    return variable->cells.front().number;
}

bool KukaCell::released() const {
    return number("SW_RELEASED", 0) != 0 || taken();
}
bool KukaCell::taken() const {
    return number("SW_TAKEN", 0) != 0;
}
std::optional<PartVerdict> KukaCell::verdict() const {
    switch (static_cast<int>(number("SW_VERDICT", 0))) {
        case 1:
            return PartVerdict::corrected;
        case 2:
            return PartVerdict::refused;
        case 3:
            return PartVerdict::failed;
        default:
            return std::nullopt;
    }
}
std::vector<std::string> KukaCell::messages() const {
    return robot_->messages();
}

}  // namespace seamwright::krl
