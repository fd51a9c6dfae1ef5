// JSON from outside: parsed strictly; a pose that is accepted is a rigid one.

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    if (const auto document = seamwright::parse_json(text, "fuzz")) {
        if (const auto pose = seamwright::parse_pose(*document, "fuzz")) {
            const Eigen::Matrix3d r = pose->linear();
            if (!((r * r.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-9)) std::abort();
        }
    }
    (void)seamwright::parse_tuple_pose(text, "fuzz");
    (void)seamwright::parse_yaml_pose(text, "fuzz");
    return 0;
}
