// seamwright collision: a robot collided, so what was calibrated on it before is not known to hold.

#include <fmt/format.h>

#include "app/cli/command.h"
#include "app/cli/sign_in.h"
#include "projects/file/project_file.h"
#include "projects/measure/measure.h"
#include "projects/measure/nozzle.h"

namespace seamwright::cli {
namespace {

struct CollisionArguments {
    std::string file, robot, utc;
    bool undo = false;
};

// What does not hold any more.
std::vector<std::string> stale_calibrations(const Project& project, const std::string& robot_id) {
    const std::string collided = last_collision(project, robot_id);
    std::vector<std::string> ids;
    for (const SensorSetup& s : project.sensors)
        if (const Calibration* c = calibration_of(project, s.id);
            c && c->robot_id == robot_id && before_collision(c->created_utc, collided))
            ids.push_back(c->id);
    if (const Calibration* c = nozzle_of(project, robot_id); c && before_collision(c->created_utc, collided))
        ids.push_back(c->id);
    return ids;
}

Expected<Answer> collision_command(const CollisionArguments& a) {
    SEAM_TRY(auto file, open_to_edit(a.file));
    SEAM_TRY(auto project, file.load());
    std::string robot = a.robot;
    if (robot.empty()) {
        if (project.robots.size() != 1)
            return usage_error(Text("the project has {} robots", project.robots.size()), "collision",
                               "say which one with --robot");
        robot = project.robots.front().id;
    }
    SEAM_OK(a.undo ? take_collision_back(project, robot) : mark_collision(project, robot, a.utc));
    SEAM_OK(file.save(project));
    const std::string collided = last_collision(project, robot);
    const auto stale = stale_calibrations(project, robot);
    Answer answer;
    answer.json = {{"status", "ok"},
                   {"robot", robot},
                   {"collided_utc", collided.empty() ? nlohmann::json() : nlohmann::json(collided)},
                   {"stale", stale}};
    answer.text = collided.empty() ? fmt::format("robot {}: no collision is marked\n", robot)
                                   : fmt::format("robot {}: collided {}\n", robot, collided);
    for (const std::string& id : stale)
        answer.text +=
            fmt::format("calibration {} is older: nothing is pushed with it, calibrate again\n", id);
    return answer;
}

}  // namespace

void add_collision(CommandLine& line) {
    auto a = std::make_shared<CollisionArguments>();
    CLI::App* command = line.add("collision",
                                 "Mark that a robot collided: calibrations of its sensors and its nozzle "
                                 "that are older are stale, and the "
                                 "safety gate refuses every push until they are made again.",
                                 "seamwright collision door_left.seam --robot R1\n"
                                 "  seamwright collision door_left.seam --robot R1 --undo");
    command->add_option("file", a->file, "The project")->required()->type_name("FILE.seam");
    add_sign_in(command);
    command->add_option("--robot", a->robot, "Which robot (the project's only one)")->type_name("ID");
    auto* utc = command->add_option("--utc", a->utc, "When, ISO 8601; else now")->type_name("DATE");
    command->add_flag("--undo", a->undo, "Take the last mark back")->excludes(utc);
    line.on(command, [a] { return collision_command(*a); });
}

}  // namespace seamwright::cli
