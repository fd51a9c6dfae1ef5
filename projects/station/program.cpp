#include "projects/station/program.h"

#include <algorithm>

#include "devices/registry.h"
#include "projects/model/part_types.h"
#include "projects/station/acquire.h"
#include "projects/station/check.h"

namespace seamwright {

Expected<ProgramRequest> program_request(const Project& whole, const RobotId& robot_id,
                                         const PartTypeId& part_type) {
    SEAM_TRY(const auto type, called_type(whole, part_type.text()));
    const Project project = of_type(whole, type);
    const auto& robots = project.robots;
    if (robots.empty()) return input_error("the project has no robot", project.name, "add one");
    if (robot_id.empty() && robots.size() > 1)
        return input_error("the project has several robots", project.name, "say which with --robot");
    const auto robot = robot_id.empty()
                           ? robots.begin()
                           : std::find_if(robots.begin(), robots.end(),
                                          [&](const RobotSetup& r) { return r.id == robot_id.text(); });
    if (robot == robots.end())
        return input_error(Text("the project has no robot \"{}\"", robot_id.text()), project.name,
                           Text("its first is \"{}\"", robots.front().id));
    SEAM_OK(none_of_motion(motion_findings(project, false)));
    ProgramRequest request;
    request.project = project.name;
    request.part_type = type;
    request.settings = robot->settings;
    request.driver = robot->driver;
    request.moves = measuring_program(project, robot->id);
    if (request.moves.empty())
        return input_error("no spot of it is enabled", Text("robot {}", robot->id), "teach a spot first");
    for (const Region& region : project.regions) {
        const bool its =
            std::any_of(region.spot_ids.begin(), region.spot_ids.end(), [&](const std::string& id) {
                return std::any_of(request.moves.begin(), request.moves.end(),
                                   [&](const MeasuringMove& m) { return m.spot_id == id; });
            });
        if (!its) continue;
        if (region.frame_name.empty())
            return input_error("it names no frame on the controller", Text("region {}", region.id),
                               "name one");
        for (const ApplicationFrame& other : request.frames)
            if (other.name == region.frame_name)
                return input_error(
                    Text("its frame \"{}\" is that of region {} too", region.frame_name, other.region_id),
                    Text("region {}", region.id), "give each region a frame of its own");
        request.frames.push_back({region.id, region.frame_name, region.base_from_frame,
                                  region_number(project, region.id, robot->id)});
    }
    return request;
}

std::vector<std::string> types_with_these_files(const Project& project, const RobotId& robot_id,
                                                const std::string& brand, const ProgramRequest& request,
                                                const std::vector<ProgramFile>& files) {
    std::vector<std::string> types;
    for (const PartType& type : project.part_types) {
        if (type.id == request.part_type) continue;
        const auto other = program_request(project, robot_id, PartTypeId(type.id));
        const auto its = other ? write_robot_program(brand, *other)
                               : Expected<std::vector<ProgramFile>>(tl::unexpected(other.error()));
        if (!its) continue;  // it has none
        const bool clashes = std::ranges::any_of(files, [&](const ProgramFile& file) {
            return std::ranges::any_of(
                *its, [&](const ProgramFile& f) { return f.name == file.name && f.text != file.text; });
        });
        if (clashes) types.push_back(type.id);
    }
    return types;
}

}  // namespace seamwright
