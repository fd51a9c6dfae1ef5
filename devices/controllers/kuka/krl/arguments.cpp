#include "devices/controllers/kuka/krl/arguments.h"

#include <fmt/format.h>

namespace seamwright::krl {

std::string text_of(const std::vector<Argument>& arguments, std::size_t i) {
    if (i >= arguments.size() || !arguments[i].given)
        throw KrlError(fmt::format("parameter {} is left out", i + 1));
    if (!arguments[i].value.string || !arguments[i].value.set)
        throw KrlError(fmt::format("parameter {} is no string, or one that is not initialised", i + 1));
    return arguments[i].value.text;
}
const Value& value_of(const std::vector<Argument>& arguments, std::size_t i, Type type) {
    if (i >= arguments.size() || !arguments[i].given)
        throw KrlError(fmt::format("parameter {} is left out", i + 1));
    const Value& v = arguments[i].value;
    if (v.type != type || v.string || !v.set)
        throw KrlError(
            fmt::format("parameter {} is no {}, or one that is not initialised", i + 1, to_string(type)));
    return v;
}
void expect_count(const std::vector<Argument>& arguments, std::size_t n) {
    if (arguments.size() != n)
        throw KrlError(fmt::format("it takes {} parameters, not {}", n, arguments.size()));
}
const Place& place_of(const std::vector<Argument>& arguments, std::size_t i) {
    if (i >= arguments.size() || !arguments[i].place || !arguments[i].place->variable)
        throw KrlError(fmt::format("parameter {} is no variable", i + 1));
    const Place& p = *arguments[i].place;
    if (p.row) {
        if (!p.variable->row_initialised(p.cell))
            throw KrlError(fmt::format("{}[] must be initialised, every character, before it is read into",
                                       p.variable->name));
        return p;
    }
    if (!arguments[i].value.set)
        throw KrlError(fmt::format("{} must be initialised before it is read into", p.variable->name));
    return p;
}

int index_of(const Place& place, int most) {
    if (place.indices.size() != 1 || place.row)
        throw KrlError(fmt::format("{} wants one index", place.system));
    if (place.indices[0] < 1 || place.indices[0] > most)
        throw KrlError(fmt::format("{}[{}] is outside 1 to {}", place.system, place.indices[0], most));
    return static_cast<int>(place.indices[0]);
}

void expect_initmov(const std::vector<Argument>& arguments) {
    expect_count(arguments, 2);
    if (value_of(arguments, 0, Type::enumeration).text != "INITMOV")
        throw KrlError("only #INITMOV is known here");
    (void)value_of(arguments, 1, Type::integer);
}

std::optional<std::string> message_of(const std::string& name, const std::vector<Argument>& arguments) {
    if (name != "MSGQUIT" && name != "MSGNOTIFY") return std::nullopt;
    if (arguments.empty() || arguments.size() > 6) throw KrlError("it takes 1 to 6 parameters");
    return text_of(arguments, 0);
}

}  // namespace seamwright::krl
