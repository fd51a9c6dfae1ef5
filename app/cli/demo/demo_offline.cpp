#include <chrono>

#include "app/cli/demo/demo_detail.h"
#include "devices/simulated/scene/door.h"
#include "projects/file/project_file.h"
#include "projects/placing/take.h"
#include "projects/station/acquire.h"

namespace seamwright::cli {
namespace {

constexpr double kPlacesMm = 40;
// As far as the hand-made region takes the neighbouring sides' spots: the parts bend.
constexpr double kBeyondMm = 250;

// Where the flange's step meets the sealing land on the region's side.
std::string step_edge(const Drawing& drawing, const std::string& side) {
    for (const DrawingEdge& e : drawing.edges)
        if (e.fold_deg > 60 && !e.convex && e.length_mm > 300 &&
            door_side_of(e.points[e.points.size() / 2].point_mm) == side)
            return e.id;
    return {};
}

// The hand-made project as it was before anybody stood at the part: cell and calibration, and the region without spots.
Project untaught(const Project& taught) {
    Project project = taught;
    project.name = "Demo: door left, from the drawing";
    project.spots.clear();
    project.regions.resize(1);
    project.regions[0].spot_ids.clear();
    return project;
}

Expected<void> propose(const Project& hand, const std::string& door_step, DemoOffline& out,
                       Project& project) {
    const auto bytes = std::as_bytes(std::span(door_step));
    DrawingOptions reading;
    reading.step_mm = 5;
    SEAM_TRY(const auto drawing, read_drawing(bytes, "door.step", reading));
    out.edge = step_edge(drawing, out.region_id);
    ProposeOptions options;
    options.edge = out.edge;
    options.region_id = out.region_id;
    options.fewest = options.most = static_cast<int>(hand.regions.front().spot_ids.size());
    // At least as good as by hand; what is better than wanted goes into a shorter way.
    SEAM_TRY(const auto bead, bead_of(drawing, out.edge, options.bead_step_mm));
    SEAM_TRY(out.hand, judge_spots(hand, hand.regions.front(), bead));
    options.three_sigma_mm = out.hand.three_sigma_mm;
    options.one_may_be_lost = false;
    options.step_mm = kPlacesMm;
    options.beyond_mm = kBeyondMm;
    // The habits of the hand-made spots: sigma, jitter, speed.
    Project like = project;
    like.spots = {hand.spots.front()};
    SEAM_TRY(out.proposal, propose_spots(like, drawing, options));
    TakeOptions taking;
    taking.region_id = out.region_id;
    SEAM_TRY(const auto taken, take_proposal(project, drawing, bytes, out.proposal, taking));
    project = taken.project;
    return {};
}

}  // namespace

Expected<DemoOffline> run_offline(const DemoOptions& options, const DemoOutcome& hand, SimulatedCell& world,
                                  const std::string& door_step,
                                  const std::function<Expected<void>(Station&)>& connect,
                                  const std::function<void(const std::string&)>& progress) {
    const auto start = std::chrono::steady_clock::now();
    DemoOffline out;
    out.project_file = options.folder / "offline.seam";
    out.region_id = hand.project.regions.front().id;
    Project project = untaught(hand.project);
    progress(fmt::format("offline: spots of region {} proposed from door.step", out.region_id));
    SEAM_OK(propose(hand.project, door_step, out, project));
    SEAM_TRY(auto file, ProjectFile::create(out.project_file, project, true));
    Station station(std::move(file), project);
    SEAM_OK(connect(station));
    world.set_part({});
    world.store_program(measuring_program(project, project.robots.front().id));
    RobotLink& robot = *station.robot(project.robots.front().id);
    SEAM_OK(reset_frames(robot, project));

    progress("offline: not confirmed, the gate refuses");
    world.set_mode(RobotMode::automatic);
    RunOptions dry;
    dry.limits.frame_timeout = kDrawing;
    dry.part_id = "not confirmed";
    SEAM_TRY(const auto refused, station.run(dry));
    for (const Text& reason : refused.regions.front().refusals) {
        out.refused_before = reason;
        break;
    }
    progress("offline: confirmed on the part");
    world.set_mode(RobotMode::manual_reduced);
    ConfirmOptions confirming;
    confirming.region_id = out.region_id;
    SEAM_TRY(out.confirmation, confirm_spots(station, confirming));
    if (out.confirmation.ok) {
        project = out.confirmation.project;
        SEAM_OK(station.edit(project));
        world.store_program(measuring_program(project, project.robots.front().id));
        world.set_mode(RobotMode::automatic);
        for (const DemoPart& same : hand.parts) {
            progress(fmt::format("offline: part {} of {} again", out.parts.size() + 1, hand.parts.size()));
            DemoPart part;
            part.truth = same.truth;
            world.set_part(part.truth);
            SEAM_OK(reset_frames(robot, project));
            RunOptions run;
            run.limits.frame_timeout = kDrawing;
            run.part_id = same.run.part_id;
            run.push = true;
            SEAM_TRY(auto record, station.run(run));
            record.captures.clear();
            part.run = std::move(record);
            SEAM_OK(judge(world, project, robot, part));
            out.parts.push_back(std::move(part));
        }
    }
    out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return out;
}

}  // namespace seamwright::cli
