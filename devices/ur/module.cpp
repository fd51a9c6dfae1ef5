#include "devices/ur/module.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/geometry/notation.h"
#include "core/number_text.h"

namespace seamwright::ur {

std::string_view refusal(std::int32_t status) {
    switch (static_cast<Status>(status)) {
        case Status::done:
            return "";
        case Status::no_frame:
            return "its program has no such frame";
        case Status::other_program:
            return "another measuring program is loaded than the project's";
        case Status::running:
            return "the measuring program runs already";
        case Status::in_use:
            return "a path runs in the frames";
        case Status::not_teaching:
            return "moving by command wants the program sw_teach() to run";
        case Status::not_waiting:
            return "no robot program waits in sw_measure()";
        case Status::unknown_command:
            return "its module does not know the request";
    }
    return "for a reason that this version does not know";
}

std::optional<State> state_from(std::int32_t number) {
    if (number < 0 || number % 10 > 3 || number / 10 > 3) return std::nullopt;
    return State{static_cast<Permitted>(number % 10), static_cast<Phase>(number / 10)};
}

std::int32_t frame_number(std::string_view name) {
    std::uint32_t hash = 2166136261U;
    for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 16777619U;
    return static_cast<std::int32_t>(hash);
}

std::pair<std::int32_t, std::int32_t> signature_numbers(std::string_view signature) {
    const auto half = [&](std::size_t at) {
        return static_cast<std::int32_t>(
            number_from<std::uint32_t>(signature.substr(std::min(at, signature.size()), 8), 16).value_or(0));
    };
    return {half(3), half(11)};  // behind "SW-"
}

std::string_view part_alphabet() {
    static const std::string signs = [] {
        std::string s;
        for (char c = ' '; c <= '~'; ++c)
            if (c != '"' && c != '\\') s += c;
        return s;
    }();
    return signs;
}

std::array<std::int32_t, 4> part_registers(std::string_view part_id) {
    std::array<std::int32_t, 4> out{};
    std::size_t n = 0;
    std::int32_t factor = 1;
    for (const char c : part_id) {
        const std::size_t at = part_alphabet().find(c);
        if (at == std::string_view::npos) continue;
        if (n == 16) break;
        if (n % 4 == 0) factor = 1;
        out[n / 4] += factor * static_cast<std::int32_t>(at + 1);
        factor *= 96;
        ++n;
    }
    return out;
}

std::string part_from_registers(const std::array<std::int32_t, 4>& registers) {
    std::string out;
    for (std::int32_t r : registers)
        for (int i = 0; i < 4 && r > 0; ++i, r /= 96)
            if (const auto sign = static_cast<std::size_t>(r % 96);
                sign >= 1 && sign <= part_alphabet().size())
                out += part_alphabet()[sign - 1];
    return out;
}

std::array<double, 6> ur_pose(const Pose& pose) {
    const Eigen::Vector3d p = pose.translation() / 1000, r = ur_from_rotation(pose.linear());
    return {p.x(), p.y(), p.z(), r.x(), r.y(), r.z()};
}

Expected<Pose> pose_from_ur(const std::array<double, 6>& pose, const std::string& where) {
    for (std::size_t i = 0; i < 6; ++i)
        if (!(std::abs(pose[i]) <= (i < 3 ? 100.0 : 4 * kPi)))
            return device_error(Text("{} {} is no position of a robot", pose[i], i < 3 ? "m" : "rad"), where);
    return make_pose(rotation_from_ur({pose[3], pose[4], pose[5]}),
                     {1000 * pose[0], 1000 * pose[1], 1000 * pose[2]});
}

}  // namespace seamwright::ur
