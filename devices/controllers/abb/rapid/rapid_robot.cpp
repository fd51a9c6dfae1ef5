#include "devices/controllers/abb/rapid/rapid_robot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/geometry/notation.h"
#include "devices/abb/rapid_message.h"
#include "devices/controllers/abb/rapid/rapid_system.h"
#include "devices/controllers/abb/rapid/rapid_values.h"

namespace seamwright::rapid {
namespace {

using Milliseconds = std::chrono::milliseconds;
using Seconds = std::chrono::duration<double>;
constexpr int kTriggerOutput = 1;
constexpr std::size_t kAdvanceRun = 3;  // moves that a program may be ahead of the arm
constexpr double kForever_s = 1e9;
const Milliseconds kSocketSlice{20};

double in_time(const Call& c, double otherwise) {
    const double s = c.has("time") ? c.number("time") : otherwise;
    return s >= 9999998 ? kForever_s : s;  // WAIT_MAX
}

Pose workobject_of(const Call& c) {
    if (!c.has("wobj")) return Pose::Identity();
    const Value& w = c["wobj"];
    if (w.parts[0].number != 0 || w.parts[1].number == 0)
        Task::raise(0, "work objects that are held or moved are not executed here");
    return pose_from(w.parts[3]) * pose_from(w.parts[4]);
}

Pose tool_of(const Call& c) {
    if (!c.has("tool")) return Pose::Identity();
    const Value& tool = c["tool"];
    if (tool.parts[0].number == 0) Task::raise(0, "tools that the robot does not hold are not executed here");
    const Value& load = c.has("tload") ? c["tload"] : tool.parts[2];
    if (!(load.parts[0].number > 0)) Task::raise(0, "the load of the tool has no mass");
    return pose_from(tool.parts[1]);
}

bool spoil(abb::Message& m, ControllerFault fault) {
    if (fault == ControllerFault::wrong_answer) {
        if (m.number == 0)
            m.word = "COFFEE";
        else
            m.number = m.number % abb::kHighestNumber + 1;
        return true;
    }
    if (fault != ControllerFault::out_of_range) return false;
    if (m.word == "MODE") m.fields = {"DREAM", "ON", "RUN"};
    if (m.word == "POSE" || m.word == "READ" || m.word == "WRITE" || m.word == "TRIGGER")
        m.line2 = "1000000000.0000 0.0000 0.0000";
    return true;
}

}  // namespace

struct RapidRobot::Socket {
    bool created = false, closed_by_peer = false, silent_for_ever = false;
    std::optional<TcpListener> listener;
    std::optional<TcpConnection> connection;
    std::string address, received, sending;
    int port = 0;
};

struct RapidRobot::Trigger {
    double before_mm = 0;
    int output = 0, interrupt = 0;
    bool on = false;
};

Pose pose_from(const Value& pose) {
    const auto& t = pose.parts[0].parts;
    const auto& r = pose.parts[1].parts;
    const Eigen::Quaterniond q(r[0].number, r[1].number, r[2].number, r[3].number);
    if (!(std::abs(q.norm() - 1) < 1e-3)) Task::raise(0, "an orientation is not normalised");
    return make_pose(q.normalized().toRotationMatrix(), {t[0].number, t[1].number, t[2].number});
}

void store_pose(Value& pose, const Pose& from) {
    const AbbQuaternion q = abb_from_rotation(from.linear());
    for (int i = 0; i < 3; ++i)
        pose.parts[0].parts[static_cast<std::size_t>(i)].number = as_num(from.translation()[i]);
    const double values[4] = {q.w, q.x, q.y, q.z};
    for (std::size_t i = 0; i < 4; ++i) pose.parts[1].parts[i].number = as_num(values[i]);
}

RapidRobot::RapidRobot(std::shared_ptr<SimulatedCell> cell, RobotSettings settings, TcpListener listener,
                       std::function<ControllerFault()> fault)
    : cell_(std::move(cell)),
      settings_(std::move(settings)),
      listener_(std::move(listener)),
      fault_(std::move(fault)) {
    const auto program = cell_->program();
    const Pose home = program.empty() ? Pose::Identity() : program.front().entry;
    ArmSettings arm;
    arm.time_scale = settings_.time_scale;
    arm.trigger_output = kTriggerOutput;
    arm_ = std::make_unique<SimulatedArm>(cell_, arm, cell_->reported_flange().value_or(home));
}

std::map<std::string, std::string> RapidRobot::signals() {
    return {{"sw_doTrigger", "signaldo"},
            {"sw_doMotorsOn", "signaldo"},
            {"sw_doEStop", "signaldo"},
            {"sw_doCycleOn", "signaldo"}};
}

bool RapidRobot::may_move() const {
    const RobotMode mode = cell_->mode();
    return mode != RobotMode::stopped && mode != RobotMode::fault;
}

int RapidRobot::output(const std::string& signal) const {
    const RobotMode mode = cell_->mode();
    if (signal == "sw_dotrigger") return arm_->output(kTriggerOutput) ? 1 : 0;
    if (signal == "sw_domotorson") return may_move() ? 1 : 0;
    if (signal == "sw_doestop") return mode == RobotMode::fault ? 1 : 0;
    const Task* motion = machine_->task("t_rob1");
    return may_move() && motion && motion->running() ? 1 : 0;  // sw_doCycleOn
}

RapidRobot::Socket& RapidRobot::socket(const Call& c, std::string_view name) const {
    Value& v = c[name];
    if (!v.object) v.object = std::make_shared<Socket>();
    return *static_cast<Socket*>(v.object.get());
}

Value RapidRobot::move(Task& task, const Call& c, std::vector<PathEvent> events) {
    if (c.has("t") || c.has("corr")) Task::raise(0, "this argument of a motion is not executed here");
    const Value& zone = c["zone"];
    ArmMove m;
    m.base_from_flange = workobject_of(c) * pose_from(c["topoint"]) * tool_of(c).inverse();
    m.speed_mm_s = c["speed"].parts[0].number;
    if (!(m.speed_mm_s > 0)) Task::raise(0, "a motion without speed");
    const bool stops = zone.parts[0].number != 0;
    m.rounding_mm = stops ? 0 : zone.parts[1].number;
    m.events = std::move(events);
    if (arm_->pending() == 0)
        if (const auto at = cell_->reported_flange()) arm_->place(*at);  // moved by hand meanwhile
    arm_->move(std::move(m));
    task.wait_until([&] { return arm_->pending() <= (stops ? 0 : kAdvanceRun); }, Seconds(kForever_s),
                    Seconds(0.001));
    return {};
}

Value RapidRobot::trigger_move(Task& task, const Call& c) {
    std::vector<PathEvent> events;
    for (const char* name : {"trigg_1", "t2", "t3", "t4"}) {
        if (!c.has(name)) continue;
        const auto trigger = std::static_pointer_cast<Trigger>(c[name].object);
        if (!trigger) Task::raise(0, "a trigger is used that nothing has set up");
        PathEvent event;
        event.before_end_mm = trigger->before_mm;
        event.act = [this, trigger, &task](const Pose&) {
            if (trigger->output > 0)
                arm_->set_output(trigger->output, trigger->on);
            else
                task.interrupt(trigger->interrupt);
        };
        events.push_back(std::move(event));
    }
    return move(task, c, std::move(events));
}

// A work object that the cell has as a frame is that frame, whoever sets it.
Value RapidRobot::data_value(Task& task, const Call& c, bool set) {
    const std::string name = folded(c.text("object"));
    Task* owner = c.has("taskname") ? task.machine().task(folded(c.text("taskname"))) : &task;
    if (!owner) Task::raise(kErrTaskname, "there is no task " + c.text("taskname"));
    const Data* data = owner->program().find(name);
    if (!data || (owner != &task && data->storage != Storage::persistent))
        Task::raise(kErrSymAccess, "there is no data " + c.text("object"));
    if (set && (data->storage == Storage::constant || fault_() == ControllerFault::reject_write))
        Task::raise(kErrSymAccess, c.text("object") + " cannot be set");
    Value& value = c["value"];
    if (value.type->root() != data->type->root() || value.dims != data->sizes)
        Task::raise(kErrSymAccess, c.text("object") + " has another type");
    std::string frame;
    if (data->type->name == "wobjdata")
        for (const auto& [known, pose] : cell_->settings().robot.frames)
            if (folded(known) == name) frame = known;
    if (!frame.empty()) {
        const auto now = cell_->read_frame(frame);
        const auto last = mirrored_.find(frame);
        if (now && (last == mirrored_.end() || !last->second.isApprox(*now, 0))) {
            store_pose(data->value->parts[3], Pose::Identity());
            store_pose(data->value->parts[4], *now);
            mirrored_[frame] = *now;
        }
    }
    if (!set) {
        store(value, *data->value);
        return {};
    }
    store(*data->value, value);
    if (!frame.empty()) {
        const Pose pose = pose_from(value.parts[3]) * pose_from(value.parts[4]);
        if (!cell_->write_frame(frame, pose)) Task::raise(kErrSymAccess, c.text("object") + " cannot be set");
        mirrored_[frame] = *cell_->read_frame(frame);
    }
    return {};
}

// Takes what has come, waiting for at most so long.
void RapidRobot::fill(Task& task, Socket& from, Milliseconds at_most) const {
    if (from.closed_by_peer || !from.connection) return;
    std::byte buffer[1024];
    const auto got = task.unlocked([&] { return from.connection->receive_some(buffer, at_most); });
    if (got)
        from.received.append(reinterpret_cast<const char*>(buffer), *got);
    else if (!is_silence(got.error()))
        from.closed_by_peer = true;
}

// Whole messages meet the fault of the moment; false when the connection is to be closed.
bool RapidRobot::send(Task& task, Socket& to, const std::string& bytes) {
    to.sending += bytes;
    while (to.sending.size() >= abb::kMessageBytes) {
        std::string message = to.sending.substr(0, abb::kMessageBytes);
        to.sending.erase(0, abb::kMessageBytes);
        if (!send_message(task, to, std::move(message))) return false;
    }
    return true;
}

bool RapidRobot::send_message(Task& task, Socket& to, std::string bytes) {
    const ControllerFault fault = fault_();
    if (fault == ControllerFault::silent || to.silent_for_ever) return true;
    if (fault == ControllerFault::slow) task.pause(std::chrono::duration<double>(settings_.slow).count());
    if (auto message = abb::parse_message(bytes, ""); message && spoil(*message, fault))
        bytes = abb::message_bytes(*message);
    const bool half = fault == ControllerFault::half_message || fault == ControllerFault::disconnect;
    if (half) bytes.resize(bytes.size() / 2);
    to.silent_for_ever = half;
    const bool sent =
        task.unlocked([&] { return to.connection->send(bytes_of(bytes), Milliseconds(200)).has_value(); });
    return sent && fault != ControllerFault::disconnect;
}

std::map<std::string, Native> RapidRobot::natives() {
    auto n = general_natives();
    add_motion(n);
    add_places(n);
    add_system(n);
    add_sockets(n);
    add_socket_bytes(n);
    return n;
}

void RapidRobot::add_motion(Natives& n) {
    n["movel"] = [this](Task& t, const Call& c) {
        if (c.has("v") || c.has("z")) Task::raise(0, "this argument of a motion is not executed here");
        return move(t, c, {});
    };
    n["triggl"] = [this](Task& t, const Call& c) { return trigger_move(t, c); };
    n["triggio"] = [](Task&, const Call& c) -> Value {
        if (!c.has("dop") || c.has("start") || c.has("time") || c.has("dodelay"))
            Task::raise(0, "TriggIO is executed with \\DOp before the end only");
        c["triggdata"].object = std::make_shared<Trigger>(
            Trigger{c.number("distance"), kTriggerOutput, 0, c.number("setvalue") != 0});
        if (c.text("dop") != "sw_dotrigger") Task::raise(0, "this output is set by the system");
        return {};
    };
    n["triggint"] = [](Task& t, const Call& c) -> Value {
        if (c.has("start") || c.has("time")) Task::raise(0, "TriggInt is executed before the end only");
        const int number = static_cast<int>(c.number("interrupt"));
        if (!t.is_connected(number)) Task::raise(0, "the interrupt is connected with no trap");
        c["triggdata"].object = std::make_shared<Trigger>(Trigger{c.number("distance"), 0, number, false});
        return {};
    };
    n["setdo"] = [this](Task&, const Call& c) -> Value {
        if (c.text("signal") != "sw_dotrigger" || c.has("sdelay"))
            Task::raise(0, "this output is set by the system");
        arm_->set_output(kTriggerOutput, c.number("value") != 0);
        return {};
    };
    n["doutput"] = [this](Task& t, const Call& c) { return make_number(t, output(c.text("signal"))); };
    n["opmode"] = [this](Task& t, const Call&) {
        const RobotMode mode = cell_->mode();
        return make_number(t, mode == RobotMode::manual_reduced ? 2
                              : mode == RobotMode::manual_full  ? 3
                              : mode == RobotMode::unknown      ? 0
                                                                : 1);
    };
}

void RapidRobot::add_places(Natives& n) {
    n["crobt"] = [this](Task& t, const Call& c) -> Value {
        if (c.has("taskname") && folded(c.text("taskname")) != "t_rob1")
            Task::raise(kErrTaskname, "that task moves nothing");
        if (!c.has("taskname") && t.name() != "T_ROB1") Task::raise(kErrTaskname, "this task moves nothing");
        Value at = make_value(t.machine().type("robtarget"));
        const Pose flange = cell_->reported_flange().value_or(Pose::Identity());
        store_pose(at, workobject_of(c).inverse() * flange * tool_of(c));
        for (Value& axis : at.parts[3].parts) axis.number = as_num(9e9);
        return at;
    };
    n["offs"] = [](Task&, const Call& c) {
        Value at = c["point"];
        const char* names[3] = {"xoffset", "yoffset", "zoffset"};
        for (std::size_t i = 0; i < 3; ++i)
            at.parts[0].parts[i].number = as_num(at.parts[0].parts[i].number + c.number(names[i]));
        return at;
    };
    n["distance"] = [](Task& t, const Call& c) {
        double squares = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const double d = c["point1"].parts[i].number - c["point2"].parts[i].number;
            squares += d * d;
        }
        return make_number(t, std::sqrt(squares));
    };
    n["posemult"] = [](Task&, const Call& c) {
        Value product = c["pose1"];
        store_pose(product, pose_from(c["pose1"]) * pose_from(c["pose2"]));
        return product;
    };
    n["poseinv"] = [](Task&, const Call& c) {
        Value inverse = c["pose1"];
        store_pose(inverse, pose_from(c["pose1"]).inverse());
        return inverse;
    };
    n["norient"] = [](Task&, const Call& c) {
        Value out = c["rotation"];
        double norm = 0;
        for (const Value& q : out.parts) norm += q.number * q.number;
        norm = std::sqrt(norm);
        if (!(std::abs(norm - 1) < 0.1)) Task::raise(0, "the orientation is far from normalised");
        for (Value& q : out.parts) q.number = as_num(q.number / norm);
        return out;
    };
}

void RapidRobot::add_system(Natives& n) {
    n["getsysinfo"] = [this](Task& t, const Call& c) -> Value {
        if (c.has("serialno")) return make_text(t, settings_.serial);
        if (c.has("robottype")) return make_text(t, settings_.model);
        if (c.has("swversion")) return make_text(t, "6.08.0134");
        Task::raise(0, "this is not told here");
    };
    n["getdataval"] = [this](Task& t, const Call& c) { return data_value(t, c, false); };
    n["setdataval"] = [this](Task& t, const Call& c) { return data_value(t, c, true); };
}

void RapidRobot::add_sockets(Natives& n) {
    n["socketcreate"] = [this](Task&, const Call& c) -> Value {
        Socket& s = socket(c, "socket");
        if (s.created) Task::raise(0, "the socket is created already");
        s = {};
        s.created = true;
        return {};
    };
    n["socketbind"] = [this](Task&, const Call& c) -> Value {
        Socket& s = socket(c, "socket");
        const double port = c.number("localport");
        if (!s.created) Task::raise(kErrSockClosed, "the socket is not created");
        if (port < 1 || port > 65535) Task::raise(0, fmt::format("{} is no port", port));
        s.address = c.text("localaddress");
        s.port = static_cast<int>(port);
        return {};
    };
    n["socketlisten"] = [this](Task&, const Call& c) -> Value {
        Socket& s = socket(c, "socket");
        if (!s.created || s.port == 0) Task::raise(kErrSockClosed, "the socket is not bound");
        if (listener_ && listener_->port() == s.port) {
            s.listener = std::move(*listener_);
            listener_.reset();
        } else {
            auto listener = TcpListener::listen(s.address, static_cast<std::uint16_t>(s.port));
            if (!listener) Task::raise(kErrSockAddrInuse, listener.error().what.english());
            s.listener = std::move(*listener);
        }
        listening_ = true;
        return {};
    };
    n["socketaccept"] = [this](Task& t, const Call& c) -> Value {
        Socket &server = socket(c, "socket"), &client = socket(c, "clientsocket");
        if (!server.listener) Task::raise(kErrSockClosed, "the socket does not listen");
        if (client.created) Task::raise(0, "the client's socket is created already");
        std::optional<TcpConnection> accepted;
        const bool came = t.wait_until(
            [&] {
                auto got = t.unlocked([&] { return server.listener->accept(kSocketSlice); });
                if (got) accepted = std::move(*got);
                return accepted.has_value();
            },
            Seconds(in_time(c, 60)), Seconds(0.001));
        if (!came) Task::raise(kErrSockTimeout, "nobody connects");
        client = {};
        client.created = true;
        client.connection = std::move(accepted);
        return {};
    };
}

void RapidRobot::add_socket_bytes(Natives& n) {
    n["socketpeek"] = [this](Task& t, const Call& c) {
        Socket& s = socket(c, "socket");
        if (!s.created) Task::raise(kErrSockClosed, "the socket is closed");
        fill(t, s, Milliseconds(1));
        // That the other side has closed is told by reading and writing only.
        return make_number(t, static_cast<double>(std::min<std::size_t>(s.received.size(), 1024)));
    };
    n["socketreceive"] = [this](Task& t, const Call& c) -> Value {
        Socket& s = socket(c, "socket");
        if (!s.created) Task::raise(kErrSockClosed, "the socket is closed");
        if (!c.has("str") && !c.has("rawdata")) Task::raise(0, "SocketReceive wants \\Str or \\RawData");
        const std::size_t room = c.has("str") ? kLongestString : 1024;
        const double asked = c.has("readnoofbytes") ? c.number("readnoofbytes") : 0;
        if (asked < 0 || asked > static_cast<double>(room))
            Task::raise(0, "more bytes are asked for than it holds");
        const auto wanted = std::max<std::size_t>(1, static_cast<std::size_t>(asked));
        const bool came = t.wait_until(
            [&] {
                if (s.received.size() < wanted) fill(t, s, Milliseconds(2));
                return s.received.size() >= wanted || s.closed_by_peer;
            },
            Seconds(in_time(c, 60)), Seconds(0.001));
        if (s.received.size() < wanted && s.closed_by_peer)
            Task::raise(kErrSockClosed, "the other side has closed");
        if (!came) Task::raise(kErrSockTimeout, "nothing comes");
        const std::size_t count = asked > 0 ? wanted : std::min(room, s.received.size());
        c[c.has("str") ? "str" : "rawdata"].text = s.received.substr(0, count);
        s.received.erase(0, count);
        if (c.has("norecbytes")) c["norecbytes"].number = static_cast<double>(count);
        return {};
    };
    n["socketsend"] = [this](Task& t, const Call& c) -> Value {
        Socket& s = socket(c, "socket");
        if (!s.created || !s.connection || s.closed_by_peer)
            Task::raise(kErrSockClosed, "the socket is closed");
        if (!c.has("str") && !c.has("rawdata")) Task::raise(0, "SocketSend wants \\Str or \\RawData");
        std::string bytes = c.has("str") ? c.text("str") : c.text("rawdata");
        if (c.has("noofbytes")) bytes.resize(static_cast<std::size_t>(c.number("noofbytes")));
        if (send(t, s, bytes)) return {};
        s.connection.reset();
        s.closed_by_peer = true;
        Task::raise(kErrSockClosed, "the connection is lost");
    };
    n["socketclose"] = [this](Task&, const Call& c) -> Value {
        socket(c, "socket") = {};
        return {};
    };
}

}  // namespace seamwright::rapid
