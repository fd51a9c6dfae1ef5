#include "app/cli/arguments/pose_argument.h"

#include "devices/exchange/files.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"

namespace seamwright::cli {

Expected<Pose> read_pose_argument(const std::string& argument, const std::string& where) {
    if (argument.empty()) return Pose::Identity();
    std::string text = argument;
    if (text.find('{') == std::string::npos) {
        SEAM_TRY(auto read, read_text_file(argument));
        text = read;
    }
    SEAM_TRY(auto document, parse_json(text, where));
    return parse_pose(document, where);
}

}  // namespace seamwright::cli
