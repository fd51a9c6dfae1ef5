#pragma once
// The lists of robot (and target) poses in a calibration's data, and in which convention they are written.
//
// Data may say it: "pose_convention":"CODE" of the robot's poses, or {"base_from_flange":"CODE",..} by list (codes in
// core/geometry/pose_convention.h). Then the numbers stay as somebody wrote them: a POSE gives three, four or
// sixteen numbers, and the code what they mean. Without it a POSE means what pose_json.h says.

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/calibration/pose/convention_detective.h"

namespace seamwright {

struct PoseListPlace {
    std::string_view entries, key;  // "pairs", "camera_from_target"
};
using PoseLists = std::vector<PoseListPlace>;  // of one method, the robot's first
inline constexpr std::string_view kRobotPose = "base_from_flange";

// As written, entries without a pose left out. Error (input): a pose that is no POSE, a list in several forms, a
// convention that is none or does not fit the numbers.
Expected<std::vector<WrittenPoses>> written_poses(const PoseLists& lists, const nlohmann::json& data);

// Sets `said`, "CODE" or "LIST=CODE", in the data. Error (usage), at `where`: no such list, or no such code.
Expected<void> say_convention(const PoseLists& lists, const std::string& said, const Text& where,
                              nlohmann::json& data);

// The data as they are but for their poses, each of which is `instead`, and for what they say of the convention.
nlohmann::json without_poses(const PoseLists& lists, const nlohmann::json& data,
                             const nlohmann::json& instead);

// Data whose poses are all POSEs of the usual meaning: the data themselves where they say no convention.
class UsualPoses {
  public:
    explicit UsualPoses(const nlohmann::json& data) : given_(&data) {}
    UsualPoses(nlohmann::json changed, nlohmann::json said)
        : changed_(std::move(changed)), said_(std::move(said)) {}
    const nlohmann::json& data() const { return given_ ? *given_ : changed_; }
    void put(nlohmann::json& result) const;  // "pose_convention" into the result, as it was said

  private:
    const nlohmann::json* given_ = nullptr;
    nlohmann::json changed_, said_;
};
// `data` outlives the answer. Error (input): as of written_poses(), or numbers that are no pose in that convention.
Expected<UsualPoses> with_usual_poses(const PoseLists& lists, const nlohmann::json& data);

}  // namespace seamwright
