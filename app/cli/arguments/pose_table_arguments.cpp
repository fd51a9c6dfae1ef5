#include "app/cli/arguments/pose_table_arguments.h"

#include <vector>

#include "app/cli/arguments/pose_argument.h"
#include "core/profile/units.h"

namespace seamwright::cli {

Expected<PoseLayout> PoseTableArguments::layout() const {
    PoseLayout layout{convention, unit, angle, {}, {}};
    if (!flange_from_tool.empty()) {
        SEAM_TRY(const auto pose, read_place_argument(flange_from_tool, "--flange-from-tool", kLeastTool_mm));
        layout.flange_from_tool = pose;
    }
    if (!base_from_user_frame.empty()) {
        SEAM_TRY(const auto pose,
                 read_place_argument(base_from_user_frame, "--base-from-user-frame", kLeastPlace_mm));
        layout.base_from_user_frame = pose;
    }
    return layout;
}

void add_pose_table_options(CLI::App* command, PoseTableArguments& a, CLI::Option* table) {
    const auto list = [](const auto& words) {
        return std::vector<std::string>(std::begin(words), std::end(words));
    };
    std::vector<CLI::Option*> options{
        command
            ->add_option(
                "--pose-convention", a.convention,
                "What six or seven numbers mean: kuka-abc, fanuc-wpr, rpy, ur-rotvec, zyz, quat-wxyz, "
                "quat-xyzw, matrix (default: as their header says)")
            ->check(CLI::IsMember(list(kPoseConventions))),
        command->add_option("--pose-unit", a.unit, "What the positions are in")
            ->check(CLI::IsMember(list(kFileUnits))),
        command->add_option("--pose-angle", a.angle, "What the angles are in")
            ->check(CLI::IsMember({"deg", "rad"})),
        command
            ->add_option("--flange-from-tool", a.flange_from_tool,
                         "The poses are of this tool (TOOL_DATA, UTOOL, tooldata), not of the flange")
            ->type_name("POSE"),
        command
            ->add_option(
                "--base-from-user-frame", a.base_from_user_frame,
                "The poses are given in this frame (BASE_DATA, UFRAME, wobjdata), not in the robot's base")
            ->type_name("POSE")};
    if (table)
        for (CLI::Option* option : options) option->needs(table);
}

}  // namespace seamwright::cli
