#include "app/cli/arguments/pose_argument.h"

#include "devices/exchange/files.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"

namespace seamwright::cli {

namespace {

Expected<nlohmann::json> document_of(const std::string& argument, const std::string& where) {
    std::string text = argument;
    if (text.find('{') == std::string::npos) {
        SEAM_TRY(auto read, read_text_file(argument));
        text = read;
    }
    return parse_json(text, where);
}

}  // namespace

Expected<Pose> read_pose_argument(const std::string& argument, const std::string& where) {
    if (argument.empty()) return Pose::Identity();
    SEAM_TRY(auto document, document_of(argument, where));
    return parse_pose(document, where);
}

Expected<Pose> read_place_argument(const std::string& argument, const std::string& where, double least_mm,
                                   const char* field) {
    if (argument.empty()) return Pose::Identity();
    SEAM_TRY(auto document, document_of(argument, where));
    if (document.is_object() && document.contains(field)) {
        nlohmann::json inner = document[field];
        document = std::move(inner);
    }
    SEAM_TRY(const auto pose, parse_pose(document, where));
    const double farthest = pose.translation().cwiseAbs().maxCoeff();
    const bool own = document.contains("matrix") && document.contains("abc");
    if (!own && farthest > 0 && farthest < least_mm)
        return input_error(Text("no coordinate is longer than {:.4g} mm, which looks like metres", farthest),
                           where, "write millimetres; where they are, give xyz, abc and matrix together");
    return pose;
}

}  // namespace seamwright::cli
