#include "projects/acceptance/equipment/measure_robot.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/median.h"
#include "projects/acceptance/study/stored_values.h"
#include "projects/measure/measure.h"
#include "projects/station/check.h"
#include "projects/station/teach.h"

namespace seamwright {
namespace {

constexpr std::size_t kChosenSpots = 3;
constexpr double kFarOff = 6;  // robust standard deviations
// A feature's stated sigma over what it scatters while the robot stands, from where on its error is of the place.
constexpr double kStandsStill = 5;

bool usable(const Project& project, const Spot& spot) {
    return spot.enabled && (spot.weights.x() > 0 || spot.weights.z() > 0) && calibration_of(project, spot);
}

// Those that together see the most directions, in the project's order.
std::vector<const Spot*> chosen_spots(const Project& project) {
    std::vector<const Spot*> candidates, chosen;
    for (const Spot& spot : project.spots)
        if (usable(project, spot) && (candidates.empty() || spot.robot_id == candidates.front()->robot_id))
            candidates.push_back(&spot);
    Eigen::Matrix3d directions = 1e-3 * Eigen::Matrix3d::Identity();
    while (chosen.size() < std::min(kChosenSpots, candidates.size())) {
        const auto with = [&](const Spot* spot) -> Eigen::Matrix3d {
            const auto sees = seen_by(*spot, calibration_of(project, *spot)->flange_from_sensor);
            return directions + sees.transpose() * sees;
        };
        const auto best =
            *std::max_element(candidates.begin(), candidates.end(), [&](const Spot* a, const Spot* b) {
                return with(a).determinant() < with(b).determinant() * (1 - 1e-9);
            });
        if (std::find(chosen.begin(), chosen.end(), best) != chosen.end()) break;
        directions = with(best);
        chosen.push_back(best);
    }
    std::sort(chosen.begin(), chosen.end());
    return chosen;
}

Expected<std::vector<const Spot*>> spots_of(const Project& project, const std::vector<std::string>& ids) {
    std::vector<const Spot*> spots;
    if (ids.empty()) {
        spots = chosen_spots(project);
        if (spots.empty())
            return input_error("no enabled spot is calibrated", "robot study", "teach and calibrate first");
        return spots;
    }
    for (const std::string& id : ids) {
        const Spot* spot = find_spot(project, id);
        if (!spot) return input_error(Text("there is no spot \"{}\"", id), "spots");
        if (!usable(project, *spot))
            return input_error("it is switched off, not calibrated, or observes neither x nor z",
                               Text("spot {}", id), "take another");
        if (spot->robot_id != find_spot(project, ids.front())->robot_id)
            return input_error(Text("spots {} and {} belong to different robots", ids.front(), id),
                               "robot study", "study one robot at a time");
        if (std::find(spots.begin(), spots.end(), spot) == spots.end()) spots.push_back(spot);
    }
    std::sort(spots.begin(), spots.end());  // the project's order
    return spots;
}

// The measuring program's own way from one spot's trigger pose to another's entry, whatever lies between.
std::vector<Standing> way_between(const Project& project, const Spot& from, const Spot& to) {
    std::vector<Standing> way;
    const auto pass = [&](const Pose& pose) { way.push_back({pose, 0}); };
    bool under_way = false;
    for (const MeasuringMove& move : measuring_program(project, to.robot_id)) {
        if (move.spot_id == from.id) {
            under_way = true;
            pass(move.exit);
            continue;
        }
        if (!under_way) continue;
        for (const Pose& via : move.via) pass(via);
        pass(move.entry);
        if (move.spot_id == to.id) break;
        pass(move.trigger);
        pass(move.exit);
    }
    return way;
}

// Features far off those of the same return are the sensor's mistakes, not the robot's.
int leave_out_far(SpotReturns& spot) {
    int left_out = 0;
    for (int axis = 0; axis < 2; ++axis) {
        std::vector<double> off;
        std::vector<double> middles;
        for (const auto& profiles : spot.returns) {
            std::vector<double> values;
            for (const Eigen::Vector2d& p : profiles) values.push_back(p[axis]);
            middles.push_back(median(values));
            if (profiles.size() > 2)
                for (const Eigen::Vector2d& p : profiles) off.push_back(std::abs(p[axis] - middles.back()));
        }
        if (off.empty()) return 0;
        const double limit = kFarOff * 1.4826 * median(off);
        if (!(limit > 0)) continue;
        for (std::size_t j = 0; j < spot.returns.size(); ++j)
            if (spot.returns[j].size() > 2)
                left_out += static_cast<int>(std::erase_if(spot.returns[j], [&](const Eigen::Vector2d& p) {
                    return std::abs(p[axis] - middles[j]) > limit;
                }));
    }
    return left_out;
}

Expected<SpotReturns> returns_to(Station& station, const Spot& spot, const Spot* before,
                                 const MeasureRobotOptions& options, int done_spots, int all_spots,
                                 int& not_found) {
    const Project& project = station.project();
    const Pose flange_from_sensor = calibration_of(project, spot)->flange_from_sensor;
    const MeasuringMove through = measuring_move(spot, flange_from_sensor);
    SpotReturns out;
    out.spot_id = spot.id;
    out.sees = seen_by(spot, flange_from_sensor);
    out.x = spot.weights.x() > 0;
    out.z = spot.weights.z() > 0;
    std::vector<Standing> stands;
    if (before) stands = way_between(project, *before, spot);
    for (int n = 0; n < options.returns; ++n) {
        stands.push_back({through.entry, 0});
        stands.push_back({through.trigger, options.profiles});
    }
    std::size_t present = stands.size();  // none yet
    Text reason;
    Eigen::Vector2d stated = Eigen::Vector2d::Zero();
    int found = 0;
    const auto progress = [&](const RunProgress& p) {
        if (options.progress) options.progress({done_spots * p.total + p.done, all_spots * p.total, p.text});
    };
    auto measured =
        measure_standing(station, spot, stands, options.cancel, progress,
                         [&](std::size_t stand, const SpotMeasurer&, const SpotMeasurement& m) {
                             if (stand != present) out.returns.emplace_back();
                             present = stand;
                             if (m.status == SpotStatus::measured && m.measured_mm.allFinite()) {
                                 out.returns.back().emplace_back(m.measured_mm.x(), m.measured_mm.z());
                                 stated += m.feature.covariance_mm2.diagonal();
                                 ++found;
                             } else {
                                 ++not_found;
                                 reason = m.message;
                             }
                         });
    if (!measured) return tl::unexpected(measured.error());
    std::erase_if(out.returns, [](const auto& profiles) { return profiles.empty(); });
    if (2 * static_cast<int>(out.returns.size()) < options.returns)
        return input_error(Text("the feature was found in {} of {} measurements ({})", out.returns.size(),
                                options.returns, reason),
                           Text("spot {}", spot.id), "choose another feature or move the sensor");
    out.stated_mm = (stated / std::max(1, found)).cwiseMax(0).cwiseSqrt();
    not_found += leave_out_far(out);
    return out;
}

std::vector<Text> remarks_of(const MeasuredRobot& m, const Project& setup) {
    std::vector<Text> out;
    const RobotStudy& s = m.study;
    for (const Eigen::Vector3d& u : s.unseen)
        out.push_back(Text(
            "No spot sees the base direction ({:.2f}, {:.2f}, {:.2f}); its scatter is taken for the mean "
            "of what is seen.",
            u.x(), u.y(), u.z()));
    if (s.seen < 6)
        out.push_back(
            Text("Of the six components of the covariance {} are measured; the others are those of a robot "
                 "that repeats alike in all directions.",
                 s.seen));
    out.emplace_back(
        "The scatter is that of the points looked at; what of it are turns of the flange is not told apart.");
    for (const SpotRepeatability& r : s.spots) {
        if (r.returns < kReturns)
            out.push_back(Text("Spot {}: {} returns; ISO 9283 asks for {}.", r.spot_id, r.returns, kReturns));
        if ((r.x && r.arrival_x.limits_mm.low == 0) || (r.z && r.arrival_z.limits_mm.low == 0))
            out.push_back(
                Text("Spot {}: the robot's scatter is not told from the sensor's noise in every direction; "
                     "its upper limit holds.",
                     r.spot_id));
    }
    for (const SpotReturns& spot : m.returns.spots) {
        const auto r = std::find_if(s.spots.begin(), s.spots.end(),
                                    [&](const SpotRepeatability& of) { return of.spot_id == spot.spot_id; });
        for (int i = 0; i < 2; ++i)
            if ((i == 0 ? r->x : r->z) && spot.stated_mm[i] > kStandsStill * r->noise_mm[i] &&
                2 * spot.stated_mm[i] > (i == 0 ? r->arrival_x : r->arrival_z).sigma_mm)
                out.push_back(Text(
                    "Spot {}: its feature states a sigma of {:.4f} mm in {}, but stands still within {:.4f} "
                    "mm with the robot: it errs with the place, and that counts as the robot's here. Take "
                    "a template or a corner.",
                    spot.spot_id, spot.stated_mm[i], i == 0 ? "x" : "z", r->noise_mm[i]));
    }
    if (m.returns.not_found > 0)
        out.push_back(
            Text("Profiles left out because the feature was not found or lay far from those of the "
                 "same return: {}.",
                 m.returns.not_found));
    double typed = 0;
    for (const Spot& spot : setup.spots)
        if (spot.robot_id == m.returns.robot_id) typed = std::max(typed, spot.sigma_mm);
    if (typed > 0 && typed >= 0.5 * std::sqrt(s.covariance_mm2.trace() / 3))
        out.push_back(
            Text("sigma_mm of the spots stays, {:.3f} mm at most: what it was to hold of the robot counts "
                 "twice from now on; lower it.",
                 typed));
    return out;
}

Expected<MeasuredRobot> judged(RobotReturns returns, const Project& setup, const std::string& file) {
    MeasuredRobot m;
    SEAM_TRY(auto study, robot_study(returns.spots));
    m.returns = std::move(returns);
    m.study = std::move(study);
    m.arrival_covariance = arrival_covariance_of(m.study);
    m.source.file = file;
    m.source.part_name = setup.part.name;
    for (const SpotRepeatability& r : m.study.spots) m.source.runs += r.returns;
    if (const Spot* spot = find_spot(setup, m.study.spots.front().spot_id))
        name_devices(m.source, setup, *spot);
    m.source.remarks = remarks_of(m, setup);
    return m;
}

RobotSetup* setup_of(Project& project, const std::string& id) {
    for (RobotSetup& robot : project.robots)
        if (robot.id == id) return &robot;
    return nullptr;
}

}  // namespace

Eigen::Matrix<double, 2, 3> seen_by(const Spot& spot, const Pose& flange_from_sensor) {
    const Eigen::Matrix3d axes = (spot.base_from_flange * flange_from_sensor).linear();
    Eigen::Vector2d along = Eigen::Vector2d::Zero();
    if (spot.curve) along = {spot.curve->x_coefficients[0], spot.curve->z_coefficients[0]};
    Eigen::Matrix<double, 2, 3> sees;
    sees.row(0) = -(axes.col(0) - along.x() * axes.col(1)).transpose();
    sees.row(1) = -(axes.col(2) - along.y() * axes.col(1)).transpose();
    return sees;
}

Matrix6 arrival_covariance_of(const RobotStudy& study) {
    Matrix6 c = Matrix6::Zero();
    c.topLeftCorner<3, 3>() = 0.5 * (study.covariance_mm2 + study.covariance_mm2.transpose());
    return c;
}

Expected<MeasuredRobot> measure_robot(Station& station, const MeasureRobotOptions& options) {
    if (options.returns < kLeastReturns || options.returns > 1000)
        return usage_error(Text("{} returns", options.returns), "robot study",
                           Text("give {} to 1000", kLeastReturns));
    if (options.profiles < 2 || options.profiles > 100)
        return usage_error(Text("{} profiles a return", options.profiles), "robot study", "give 2 to 100");
    const Project setup = station.project();
    SEAM_TRY(auto spots, spots_of(setup, options.spot_ids));
    SEAM_OK(none_of_motion(standing_findings(setup)));
    RobotReturns returns;
    returns.robot_id = spots.front()->robot_id;
    returns.replaced_covariance = find_robot(setup, returns.robot_id)->arrival_covariance;
    for (std::size_t i = 0; i < spots.size(); ++i) {
        SEAM_TRY(auto of_spot,
                 returns_to(station, *spots[i], i > 0 ? spots[i - 1] : nullptr, options, static_cast<int>(i),
                            static_cast<int>(spots.size()), returns.not_found));
        returns.spots.push_back(std::move(of_spot));
    }
    auto measured = judged(std::move(returns), setup, station.file().path().filename().string());
    if (!measured || !options.keep) return measured;
    SEAM_OK(station.file().append_evidence({0, {}, 0, measured->returns}, setup));
    measured->utc = utc_now();
    Project project = station.project();
    apply(*measured, project);
    SEAM_OK(station.edit(project));
    return measured;
}

void apply(const MeasuredRobot& measured, Project& project) {
    if (RobotSetup* robot = setup_of(project, measured.returns.robot_id))
        robot->arrival_covariance = measured.arrival_covariance;
}

Expected<std::optional<MeasuredRobot>> stored_robot_study(const ProjectFile& file,
                                                          const std::string& robot_id, const Project* now) {
    SEAM_TRY(auto evidence, file.evidence());
    for (auto e = evidence.rbegin(); e != evidence.rend(); ++e) {
        const auto* returns = std::get_if<RobotReturns>(&e->what);
        if (!returns || (!robot_id.empty() && returns->robot_id != robot_id)) continue;
        SEAM_TRY(auto setup, file.load_setup(e->setup));
        SEAM_TRY(auto measured, judged(*returns, setup, file.path().filename().string()));
        measured.utc = e->utc;
        SEAM_TRY(auto project, now ? Expected<Project>(*now) : file.load());
        const RobotSetup* robot = find_robot(project, returns->robot_id);
        if (!robot || robot->identity.serial != measured.source.robot_serial)
            measured.source.remarks.emplace_back("The robot is another one by now: measure it again.");
        else if (robot->arrival_covariance != measured.arrival_covariance)
            measured.source.remarks.emplace_back("The project holds another covariance by now.");
        return std::optional(std::move(measured));
    }
    return std::nullopt;
}

Expected<void> undo_robot_study(Station& station, const std::string& robot_id) {
    SEAM_TRY(auto stored, stored_robot_study(station.file(), robot_id));
    Project project = station.project();
    RobotSetup* robot = stored ? setup_of(project, stored->returns.robot_id) : nullptr;
    if (!robot) return input_error("no study of the robot is stored", station.file().path().string());
    robot->arrival_covariance = stored->returns.replaced_covariance;
    return station.edit(project);
}

}  // namespace seamwright
