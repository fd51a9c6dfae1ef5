// What a Universal Robots controller sends: a stream of packages, and the answers, recipes and values in
// them.

#include <cstdint>
#include <cstdlib>
#include <string>

#include "devices/ur/module.h"
#include "devices/ur/rtde_message.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace seamwright;
    std::string stream(reinterpret_cast<const char*>(data), size);
    const std::vector<std::string> names = {"actual_TCP_pose", "robot_mode", "output_double_register_24"};
    rtde::Recipe recipe{1, true, names, {rtde::Kind::vector6, rtde::Kind::int32, rtde::Kind::real}};
    for (;;) {
        const std::size_t before = stream.size();
        const auto package = rtde::take_package(stream);
        if (!package || !*package) return 0;
        const std::string& payload = (*package)->payload;
        if (stream.size() + payload.size() + rtde::kHeaderBytes != before) std::abort();
        (void)rtde::version_of(payload);
        (void)rtde::accepted_of(payload);
        for (const int version : {1, 2}) {
            (void)rtde::text_of(payload, version);
            if (const auto read = rtde::recipe_of(payload, names, version == 2)) recipe = *read;
        }
        const auto values = rtde::values_of(payload, recipe);
        if (!values) continue;
        if (values->size() != recipe.kinds.size()) std::abort();
        if (rtde::data_payload(recipe, *values) != payload) std::abort();
        if (const auto* pose = std::get_if<std::array<double, 6>>(&values->front()))
            if (const auto read = ur::pose_from_ur(*pose, "fuzz"); read && !read->matrix().allFinite())
                std::abort();
        if (const auto* number = values->size() > 1 ? std::get_if<std::int32_t>(&(*values)[1]) : nullptr)
            (void)ur::part_from_registers({*number, *number, 0, -1});
    }
}
