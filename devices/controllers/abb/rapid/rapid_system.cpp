#include "devices/controllers/abb/rapid/rapid_system.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>

namespace seamwright::rapid {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::size_t kLongestRaw = 1024;
constexpr int kMostDecimals = 6, kMostLongDecimals = 15;

constexpr const char* kTypes = R"(MODULE system
RECORD pos num x; num y; num z; ENDRECORD
RECORD orient num q1; num q2; num q3; num q4; ENDRECORD
RECORD pose pos trans; orient rot; ENDRECORD
RECORD confdata num cf1; num cf4; num cf6; num cfx; ENDRECORD
RECORD extjoint num eax_a; num eax_b; num eax_c; num eax_d; num eax_e; num eax_f; ENDRECORD
RECORD robtarget pos trans; orient rot; confdata robconf; extjoint extax; ENDRECORD
RECORD speeddata num v_tcp; num v_ori; num v_leax; num v_reax; ENDRECORD
RECORD zonedata bool finep; num pzone_tcp; num pzone_ori; num pzone_eax; num zone_ori; num zone_leax; num zone_reax;
ENDRECORD
RECORD loaddata num mass; pos cog; orient aom; num ix; num iy; num iz; ENDRECORD
RECORD tooldata bool robhold; pose tframe; loaddata tload; ENDRECORD
RECORD wobjdata bool robhold; bool ufprog; string ufmec; pose uframe; pose oframe; ENDRECORD
ALIAS num errnum;
ALIAS num intnum;
ALIAS num symnum;
ALIAS num dionum;
)";

constexpr const char* kData = R"(
VAR errnum ERRNO;
CONST errnum ERR_EXCRTYMAX:=1001;
CONST errnum ERR_WAIT_MAXTIME:=1002;
CONST errnum ERR_ALRDYCNT:=1003;
CONST errnum ERR_SOCK_CLOSED:=1004;
CONST errnum ERR_SOCK_TIMEOUT:=1005;
CONST errnum ERR_SOCK_ADDR_INUSE:=1006;
CONST errnum ERR_SYM_ACCESS:=1007;
CONST errnum ERR_TASKNAME:=1008;
CONST errnum ERR_UDPUC_COMM:=1009;
CONST num WAIT_MAX:=9999999;
CONST num pi:=3.1415927;
CONST symnum OP_UNDEF:=0;
CONST symnum OP_AUTO:=1;
CONST symnum OP_MAN_PROG:=2;
CONST symnum OP_MAN_TEST:=3;
CONST dionum high:=1;
CONST dionum low:=0;
CONST zonedata fine:=[TRUE,0,0,0,0,0,0];
PERS loaddata load0:=[0.001,[0,0,0.001],[1,0,0,0],0,0,0];
PERS tooldata tool0:=[TRUE,[[0,0,0],[1,0,0,0]],[0.001,[0,0,0.001],[1,0,0,0],0,0,0]];
PERS wobjdata wobj0:=[FALSE,TRUE,"",[[0,0,0],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];
VAR mecunit ROB_1;
)";

constexpr const char* kRoutines = R"(
PROC MoveL(\switch Conc,robtarget ToPoint\num ID,speeddata Speed\num V|num T,zonedata Zone\num Z,PERS tooldata Tool
    \PERS wobjdata WObj\switch Corr\PERS loaddata TLoad);
PROC TriggL(\switch Conc,robtarget ToPoint\num ID,speeddata Speed\num T,VAR triggdata Trigg_1\VAR triggdata T2
    \VAR triggdata T3\VAR triggdata T4,zonedata Zone,PERS tooldata Tool\PERS wobjdata WObj\switch Corr\PERS loaddata TLoad);
PROC TriggIO(VAR triggdata TriggData,num Distance\switch Start|switch Time\VAR signaldo DOp,num SetValue\num DODelay);
PROC TriggInt(VAR triggdata TriggData,num Distance\switch Start|switch Time,VAR intnum Interrupt);
PROC IDelete(VAR intnum Interrupt);
PROC ConfL(\switch On|switch Off);
PROC WaitTime(\switch InPos,num Time);
PROC WaitUntil(\switch InPos,bool Cond\num MaxTime\INOUT bool TimeFlag\num PollRate);
PROC SetDO(\num SDelay,VAR signaldo Signal,num Value);
PROC TPWrite(string String);
PROC Stop(\switch NoRegain|switch AllMoveTasks);
PROC ExitCycle();
PROC SocketCreate(VAR socketdev Socket);
PROC SocketBind(VAR socketdev Socket,string LocalAddress,num LocalPort);
PROC SocketListen(VAR socketdev Socket);
PROC SocketAccept(VAR socketdev Socket,VAR socketdev ClientSocket\INOUT string ClientAddress\num Time);
PROC SocketReceive(VAR socketdev Socket\INOUT string Str|VAR rawbytes RawData\num ReadNoOfBytes\INOUT num NoRecBytes
    \num Time);
PROC SocketSend(VAR socketdev Socket\string Str|VAR rawbytes RawData\num NoOfBytes);
PROC SocketClose(VAR socketdev Socket);
PROC GetDataVal(string Object\string TaskName,INOUT anytype Value);
PROC SetDataVal(string Object\string TaskName,anytype Value);
PROC ClkReset(VAR clock Clock_1);
PROC ClkStart(VAR clock Clock_1);
PROC ClkStop(VAR clock Clock_1);
PROC ClearRawBytes(VAR rawbytes RawData\num FromIndex);
PROC PackRawBytes(anytype Value,VAR rawbytes RawData\switch Network,num StartIndex\switch Hex1|num IntX|switch Float4
    |switch ASCII);
PROC UnpackRawBytes(VAR rawbytes RawData\switch Network,num StartIndex,INOUT anytype Value\switch Hex1|num IntX
    |switch Float4|num ASCII);
FUNC num ClkRead(VAR clock Clock_1\switch HighRes);
FUNC num RawBytesLen(VAR rawbytes RawData);
FUNC num StrLen(string Str);
FUNC string StrPart(string Str,num ChPos,num Len);
FUNC num StrFind(string Str,num ChPos,string Set\switch NotInSet);
FUNC bool StrToVal(string Str,INOUT anytype Val);
FUNC string NumToStr(num Val,num Dec\switch Exp);
FUNC string DnumToStr(dnum Val,num Dec\switch Exp);
FUNC string ValToStr(anytype Val);
FUNC dnum NumToDnum(num Value);
FUNC num Abs(num Value);
FUNC bool Present(anytype OptPar);
FUNC bool TestAndSet(INOUT bool Object);
FUNC symnum OpMode();
FUNC dionum DOutput(VAR signaldo Signal);
FUNC robtarget CRobT(\string TaskName\PERS tooldata Tool\PERS wobjdata WObj);
FUNC robtarget Offs(robtarget Point,num XOffset,num YOffset,num ZOffset);
FUNC string GetSysInfo(\switch SerialNo|switch SWVersion|switch RobotType|switch CtrlId|switch LanIp|switch CtrlLang
    |switch SystemName);
FUNC num Distance(pos Point1,pos Point2);
FUNC pose PoseMult(pose Pose1,pose Pose2);
FUNC pose PoseInv(pose Pose1);
FUNC orient NOrient(orient Rotation);
FUNC num SocketPeek(VAR socketdev Socket);
PROC StopMove(\switch Quick\switch AllMotionTasks);
PROC StartMove(\switch AllMotionTasks);
PROC ClearPath();
PROC EGMReset(VAR egmident EGMid);
PROC EGMGetId(VAR egmident EGMid);
PROC EGMSetupUC(VAR mecunit MecUnit,VAR egmident EGMid,string ExtConfigName,string UCDevice\switch Joint|switch Pose_1
    |switch PathCorr\switch APTR|switch LATR\num CommTimeout);
PROC EGMActMove(VAR egmident EGMid,pose SensorFrame\num SampleRate);
PROC EGMMoveL(VAR egmident EGMid,robtarget ToPoint\num ID,speeddata Speed,zonedata Zone,PERS tooldata Tool
    \PERS wobjdata WObj\switch NoCorr);
PROC EGMMoveC(VAR egmident EGMid,robtarget CirPoint,robtarget ToPoint\num ID,speeddata Speed,zonedata Zone,
    PERS tooldata Tool\PERS wobjdata WObj\switch NoCorr);
ENDMODULE
)";

std::string make_text_of_set() {
    std::string text = std::string(kTypes) + kData;
    for (const int v : {5,   10,  20,  30,   40,   50,   60,   80,   100,  150,  200,  300, 400,
                        500, 600, 800, 1000, 1500, 2000, 2500, 3000, 4000, 5000, 6000, 7000})
        text += fmt::format("CONST speeddata v{}:=[{},500,5000,1000];\n", v, v);
    for (const int z : {0, 1, 5, 10, 15, 20, 30, 40, 50, 60, 80, 100, 150, 200})
        text += fmt::format("CONST zonedata z{0}:=[FALSE,{1},{2},{2},{3},{2},{3}];\n", z, z == 0 ? 0.3 : z,
                            z == 0 ? 0.3 : 1.5 * z, z == 0 ? 0.03 : 0.15 * z);
    return text + kRoutines;
}

// A number as StrToVal reads it, whole.
bool read_number(std::string_view text, double& value) {
    while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
    while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
    if (!text.empty() && text.front() == '+') text.remove_prefix(1);
    const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
    return read.ec == std::errc() && read.ptr == text.data() + text.size() && std::isfinite(value);
}

std::string checked(std::string text) {
    if (text.size() > kLongestString)
        Task::raise(0, fmt::format("a string of {} characters is too long", text.size()));
    return text;
}

std::string number_text(const Call& c, int most) {
    const double decimals = c.number("dec");
    if (decimals < 0 || decimals > most || decimals != std::floor(decimals))
        Task::raise(0, fmt::format("{} decimals are asked for, at most {} are given", decimals, most));
    const auto n = static_cast<int>(decimals);
    return checked(c.has("exp") ? fmt::format("{:.{}E}", c.number("val"), n)
                                : fmt::format("{:.{}f}", c.number("val"), n));
}

std::size_t position(const Call& c, std::string_view name, std::size_t high) {
    const double n = c.number(name);
    if (n < 1 || n > static_cast<double>(high) || n != std::floor(n))
        Task::raise(0, fmt::format("{} is {}, not a whole number from 1 to {}", name, n, high));
    return static_cast<std::size_t>(n);
}

struct Stopwatch {
    double counted_s = 0;
    std::optional<Clock::time_point> since;
    double read() const {
        return counted_s + (since ? std::chrono::duration<double>(Clock::now() - *since).count() : 0);
    }
};
Stopwatch& stopwatch(const Call& c) {
    Value& v = c["clock_1"];
    if (!v.object) v.object = std::make_shared<Stopwatch>();
    return *static_cast<Stopwatch*>(v.object.get());
}

std::string value_text(const Value& v) {
    if (v.type->root()->kind == Type::Kind::truth) return v.number != 0 ? "TRUE" : "FALSE";
    if (v.type->root()->kind == Type::Kind::text) return "\"" + v.text + "\"";
    if (v.type->root()->kind == Type::Kind::number) return fmt::format("{:.6g}", v.number);
    if (v.type->root()->kind == Type::Kind::long_number) return fmt::format("{:.15g}", v.number);
    std::string text = "[";
    for (const Value& part : v.parts) text += (text.size() > 1 ? "," : "") + value_text(part);
    return text + "]";
}

}  // namespace

Value make_number(Task& task, double value) {
    Value v = make_value(task.machine().type("num"));
    v.number = as_num(value);
    return v;
}
Value make_truth(Task& task, bool value) {
    Value v = make_value(task.machine().type("bool"));
    v.number = value ? 1 : 0;
    return v;
}
Value make_text(Task& task, std::string value) {
    Value v = make_value(task.machine().type("string"));
    v.text = checked(std::move(value));
    return v;
}

const std::string& instruction_set_text() {
    static const std::string text = make_text_of_set();
    return text;
}

namespace {

using Natives = std::map<std::string, Native>;

void add_flow(Natives& n) {
    n["confl"] = [](Task&, const Call&) { return Value{}; };
    n["waittime"] = [](Task& t, const Call& c) {
        if (c.number("time") < 0) Task::raise(0, "a negative time");
        t.pause(c.number("time"));
        return Value{};
    };
    n["stop"] = [](Task& t, const Call&) -> Value {
        t.stop_here("Stop");
        return {};
    };
    n["tpwrite"] = [](Task& t, const Call& c) {
        t.machine().log(t.name() + ": " + c.text("string"));
        return Value{};
    };
    n["idelete"] = [](Task& t, const Call& c) {
        t.disconnect(static_cast<int>(c.number("interrupt")));
        c["interrupt"].number = 0;
        return Value{};
    };
    n["abs"] = [](Task& t, const Call& c) { return make_number(t, std::abs(c.number("value"))); };
    n["testandset"] = [](Task& t, const Call& c) {
        Value& object = c["object"];
        const bool was = object.number != 0;
        object.number = 1;
        return make_truth(t, !was);
    };
}

void add_texts(Natives& n) {
    n["strlen"] = [](Task& t, const Call& c) {
        return make_number(t, static_cast<double>(c.text("str").size()));
    };
    n["strpart"] = [](Task& t, const Call& c) {
        const std::string& text = c.text("str");
        const std::size_t at = position(c, "chpos", text.size()),
                          length = position(c, "len", text.size() - at + 1);
        return make_text(t, text.substr(at - 1, length));
    };
    n["strfind"] = [](Task& t, const Call& c) {
        const std::string& text = c.text("str");
        const std::size_t from = position(c, "chpos", text.size() + 1) - 1;
        const std::size_t found = c.has("notinset") ? text.find_first_not_of(c.text("set"), from)
                                                    : text.find_first_of(c.text("set"), from);
        return make_number(t, static_cast<double>(found == std::string::npos ? text.size() + 1 : found + 1));
    };
    n["strtoval"] = [](Task& t, const Call& c) {
        Value& target = c["val"];
        const auto kind = target.type->root()->kind;
        if (kind != Type::Kind::number && kind != Type::Kind::long_number)
            Task::raise(0, "StrToVal is executed for numbers only here");
        double value = 0;
        if (!read_number(c.text("str"), value)) return make_truth(t, false);
        target.number = kind == Type::Kind::number ? as_num(value) : value;
        return make_truth(t, true);
    };
    n["numtostr"] = [](Task& t, const Call& c) { return make_text(t, number_text(c, kMostDecimals)); };
    n["dnumtostr"] = [](Task& t, const Call& c) { return make_text(t, number_text(c, kMostLongDecimals)); };
    n["valtostr"] = [](Task& t, const Call& c) { return make_text(t, value_text(c["val"])); };
    n["numtodnum"] = [](Task& t, const Call& c) {
        Value v = make_value(t.machine().type("dnum"));
        v.number = c.number("value");
        return v;
    };
}

void add_stopwatch(Natives& n) {
    n["clkreset"] = [](Task&, const Call& c) {
        stopwatch(c) = {};
        return Value{};
    };
    n["clkstart"] = [](Task&, const Call& c) {
        if (Stopwatch& w = stopwatch(c); !w.since) w.since = Clock::now();
        return Value{};
    };
    n["clkstop"] = [](Task&, const Call& c) {
        Stopwatch& w = stopwatch(c);
        w.counted_s = w.read();
        w.since.reset();
        return Value{};
    };
    n["clkread"] = [](Task& t, const Call& c) { return make_number(t, stopwatch(c).read()); };
}

void add_raw_bytes(Natives& n) {
    n["clearrawbytes"] = [](Task&, const Call& c) {
        if (c.has("fromindex")) Task::raise(0, "\\FromIndex is not executed here");
        c["rawdata"].text.clear();
        return Value{};
    };
    n["rawbyteslen"] = [](Task& t, const Call& c) {
        return make_number(t, static_cast<double>(c.text("rawdata").size()));
    };
    n["packrawbytes"] = [](Task&, const Call& c) {
        const Value& value = c["value"];
        if (!c.has("ascii") || value.type->root()->kind != Type::Kind::text)
            Task::raise(0, "only strings are packed here, with \\ASCII");
        std::string& raw = c["rawdata"].text;
        const std::size_t at = position(c, "startindex", raw.size() + 1) - 1;
        if (at + value.text.size() > kLongestRaw) Task::raise(0, "rawbytes hold 1024 bytes");
        raw.resize(std::max(raw.size(), at + value.text.size()));
        raw.replace(at, value.text.size(), value.text);
        return Value{};
    };
    n["unpackrawbytes"] = [](Task&, const Call& c) {
        Value& value = c["value"];
        if (!c.has("ascii") || value.type->root()->kind != Type::Kind::text)
            Task::raise(0, "only strings are unpacked here, with \\ASCII");
        const std::string& raw = c.text("rawdata");
        const std::size_t at = position(c, "startindex", raw.size()) - 1;
        const std::size_t length = position(c, "ascii", std::min(kLongestString, raw.size() - at));
        value.text = raw.substr(at, length);
        return Value{};
    };
}

}  // namespace

std::map<std::string, Native> general_natives() {
    Natives n;
    add_flow(n);
    add_texts(n);
    add_stopwatch(n);
    add_raw_bytes(n);
    return n;
}

}  // namespace seamwright::rapid
