// What every controller's programs may call: BAS, messages, strings, VARSTATE, INV_POS, and EthernetKRL.

#include <fmt/format.h>

#include <cmath>

#include "core/number_text.h"
#include "devices/controllers/kuka/krl/arguments.h"
#include "devices/controllers/kuka/robot.h"

namespace seamwright::krl {
namespace {

Value status_value(const EkiChannel::Status& s) {
    Value v = Value::unset(Type::eki_status);
    v.set = true;
    v.parts = {{"BUFF", static_cast<double>(s.buffered)},
               {"READ", static_cast<double>(s.read)},
               {"MSG_NO", s.message},
               {"CONNECTED", s.connected ? 1.0 : 0.0},
               {"COUNTER", 0.0},
               {"LENGTH", 0.0}};
    return v;
}

}  // namespace

EkiChannel& KukaRobot::channel(const std::string& name) {
    const auto it = channels_.find(capitals(name));
    if (it == channels_.end()) throw KrlError(fmt::format("the channel {} is not initialised", name));
    return *it->second;
}

std::optional<Value> KukaRobot::call(Task& task, const std::string& name, std::vector<Argument>& arguments) {
    try {
        if (name.starts_with("EKI_")) return eki(task, name, arguments);
        if (const auto message = message_of(name, arguments)) {
            told(*message);
            return Value();
        }
        if (name == "BAS") {
            expect_initmov(arguments);
            if (task.kind() != TaskKind::robot) throw KrlError("BAS prepares motions");
            const std::lock_guard lock(mutex_);
            velocity_m_s_ = 2.0;
            cdis_mm_ = 0;
            advance_moves_ = 3;
            return Value();
        }
        if (name == "STRCOMP") {
            expect_count(arguments, 3);
            const std::string& how = value_of(arguments, 2, Type::enumeration).text;
            if (how != "CASE_SENS" && how != "NOT_CASE_SENS")
                throw KrlError("parameter 3 is no way to compare");
            const std::string a = text_of(arguments, 0), b = text_of(arguments, 1);
            return Value::boolean(how == "CASE_SENS" ? a == b : capitals(a) == capitals(b));
        }
        if (name == "VARSTATE") {
            expect_count(arguments, 1);
            const auto e = parse_expression(text_of(arguments, 0));
            if (e->kind != Expression::Kind::place) throw KrlError("parameter 1 names no variable");
            std::optional<Place> place;
            try {
                place = task.place(*e);
            } catch (const KrlError&) {
                return Value::name("UNKNOWN");
            }
            try {
                (void)task.read(*place);
                return Value::name("INITIALIZED");
            } catch (const KrlError&) {
                return Value::name("DECLARED");
            }
        }
        if (name == "INV_POS") {
            expect_count(arguments, 1);
            if (!arguments[0].given || !is_geometric(arguments[0].value.type))
                throw KrlError("parameter 1 is no FRAME");
            return Value::of(arguments[0].value.pose().inverse(), Type::frame);
        }
        return std::nullopt;
    } catch (const KrlError& e) {
        throw KrlError(fmt::format("{}: {}", name, e.what()));
    }
}

std::optional<Value> KukaRobot::eki(Task& task, const std::string& name, std::vector<Argument>& arguments) {
    const std::string channel_name = text_of(arguments, 0);
    if (name == "EKI_INIT") {
        expect_count(arguments, 1);
        const auto file = settings_.channels.find(capitals(channel_name));
        if (file == settings_.channels.end())
            throw KrlError(fmt::format("there is no file {}.xml in EthernetKRL's folder", channel_name));
        if (channels_.count(capitals(channel_name)) > 0) return status_value({1, false, 0, 0});
        const auto set_flag = [this](int number, bool on) {
            const std::lock_guard lock(mutex_);
            flags_[number] = on;
        };
        channels_[capitals(channel_name)] =
            std::make_shared<EkiChannel>(parse_eki_configuration(file->second), set_flag, settings_.fault,
                                         settings_.slow, settings_.before_telegram);
        return status_value({});
    }
    EkiChannel& c = channel(channel_name);
    EkiChannel::Status status;
    if (name == "EKI_OPEN" || name == "EKI_CLOSE" || name == "EKI_CLEAR") {
        expect_count(arguments, 1);
        task.unlocked([&] { status = name == "EKI_OPEN" ? c.open() : c.close(); });
        if (name == "EKI_CLEAR") channels_.erase(capitals(channel_name));
    } else if (name == "EKI_SEND") {
        expect_count(arguments, 2);
        const std::string root = text_of(arguments, 1);
        std::optional<KrlError> failed;
        task.unlocked([&] {
            try {
                status = c.send(root);
            } catch (const KrlError& e) {
                failed = e;
            }
        });
        if (failed) throw KrlError(*failed);
    } else if (name == "EKI_CHECKBUFFER") {
        expect_count(arguments, 2);
        status = c.check(text_of(arguments, 1));
    } else if (name == "EKI_SETSTRING" || name == "EKI_SETINT" || name == "EKI_SETREAL") {
        expect_count(arguments, 3);
        c.set(text_of(arguments, 1),
              name == "EKI_SETSTRING" ? text_of(arguments, 2)
              : name == "EKI_SETINT"
                  ? fmt::format("{:.0f}", value_of(arguments, 2, Type::integer).as_number())
                  : fmt::format("{:.6f}", value_of(arguments, 2, Type::real).as_number()));
    } else if (name == "EKI_GETSTRING" || name == "EKI_GETINT" || name == "EKI_GETREAL") {
        expect_count(arguments, 3);
        const Place& to = place_of(arguments, 2);
        const std::string type = name == "EKI_GETSTRING" ? "STRING" : name == "EKI_GETINT" ? "INT" : "REAL";
        const Type held = to.component.empty() ? to.variable->type : Type::real;
        if ((type == "STRING") != to.row || (type == "INT" && held != Type::integer) ||
            (type == "REAL" && held != Type::real))
            throw KrlError(fmt::format("parameter 3 is no {}", type));
        std::string got;
        status = c.take(text_of(arguments, 1), type, got);
        if (status.read == 1) {
            if (type == "STRING") {
                if (!got.empty()) task.write(to, Value::string_of(got));
            } else {
                const double number = number_from<double>(got).value_or(0);
                task.write(to, type == "INT" ? Value::integer(number) : Value::real(number));
            }
        }
    } else {
        return std::nullopt;
    }
    return status_value(status);
}

}  // namespace seamwright::krl
