#include "projects/proof/known_shift.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "devices/registry.h"
#include "devices/simulated/cell.h"
#include "projects/measure/measure.h"
#include "projects/model/part_types.h"
#include "projects/proof/zero_shift.h"

namespace seamwright {
namespace {

constexpr const char* kWhere = "known shift";
constexpr std::size_t kMostTests = 2000;
constexpr CorrectionLimits kNoLimits{1000, 45};
constexpr char kAxes[] = "XYZ";

// A robot whose base is shifted: what it is asked and what it reports is in the unshifted base.
class ShiftedRobot final : public RobotLink {
  public:
    ShiftedRobot(std::unique_ptr<RobotLink> robot, std::shared_ptr<const Pose> base_from_shiftedbase)
        : robot_(std::move(robot)), shift_(std::move(base_from_shiftedbase)) {}
    Expected<RobotIdentity> identity() override { return robot_->identity(); }
    Expected<RobotMode> mode() override { return robot_->mode(); }
    bool tells_mode() const override { return robot_->tells_mode(); }
    bool permission_outlives_link() const override { return robot_->permission_outlives_link(); }
    Expected<Pose> base_from_flange() override { return back(robot_->base_from_flange()); }
    Expected<StartSignal> wait_start(std::chrono::milliseconds timeout) override {
        return robot_->wait_start(timeout);
    }
    Expected<void> start_measuring(const std::vector<MeasuringMove>& moves) override {
        std::vector<MeasuringMove> shifted = moves;
        for (MeasuringMove& move : shifted) {
            for (Pose* pose : {&move.entry, &move.trigger, &move.exit}) *pose = *shift_ * *pose;
            for (Pose& via : move.via) via = *shift_ * via;
        }
        return robot_->start_measuring(shifted);
    }
    Expected<TriggerEvent> wait_trigger(std::chrono::milliseconds timeout) override {
        auto event = robot_->wait_trigger(timeout);
        if (event && event->base_from_flange)
            *event->base_from_flange = shift_->inverse() * *event->base_from_flange;
        return event;
    }
    Expected<Pose> read_frame(const std::string& name) override { return robot_->read_frame(name); }
    Expected<void> write_frame(const std::string& name, const Pose&) override {
        return usage_error("nothing is written to a robot whose base is shifted for a proof", name);
    }
    Expected<void> confirm(PartVerdict verdict, const std::string& text) override {
        return robot_->confirm(verdict, text);
    }
    Expected<Permission> permission() override { return robot_->permission(); }
    Expected<void> move_to(const Pose& pose) override { return robot_->move_to(*shift_ * pose); }
    std::vector<Text> take_notices() override { return robot_->take_notices(); }

  private:
    Expected<Pose> back(Expected<Pose> pose) const {
        if (pose) *pose = shift_->inverse() * *pose;
        return pose;
    }
    std::unique_ptr<RobotLink> robot_;
    std::shared_ptr<const Pose> shift_;
};

// The middle of all regions' spots, about which the part turns.
Expected<Eigen::Vector3d> middle_of(const Project& project) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int count = 0;
    for (const Region& region : project.regions)
        for (const Eigen::Vector3d& p : reference_points(project, region)) sum += p, ++count;
    if (count == 0)
        return usage_error("no region has a calibrated spot", kWhere, "teach spots and make a region first");
    return sum / count;
}

int steps(double range, double step) {
    return static_cast<int>(std::floor(range / step + 1e-9));
}

// The station's devices, opened for the proof; given back at the end of its life.
class Borrowed {
  public:
    explicit Borrowed(Station& station)
        : station_(station), before_(station.project()), was_connected_(station.connected()) {
        for (const RobotSetup& r : before_.robots)
            if (RobotLink* robot = station_.robot(r.id); robot && is_simulated_cell(r.driver))
                if (auto pose = robot->base_from_flange()) stood_[r.id] = *pose;
        station_.disconnect();
    }
    Borrowed(const Borrowed&) = delete;
    Borrowed& operator=(const Borrowed&) = delete;
    Expected<void> open(ShiftBy by) {
        const Project& project = station_.project();
        std::map<std::string, std::unique_ptr<ProfileSource>> sensors;
        std::map<std::string, std::unique_ptr<RobotLink>> robots;
        for (const SensorSetup& setup : project.sensors) {
            SEAM_TRY(auto sensor, open_sensor(setup.driver, setup.settings, session_));
            sensors[setup.id] = std::move(sensor);
        }
        for (const RobotSetup& setup : project.robots) {
            SEAM_TRY(auto robot, open_robot(setup.driver, setup.settings, session_));
            if (by == ShiftBy::robot_moves)
                robots[setup.id] = std::make_unique<ShiftedRobot>(std::move(robot), shift_);
            else
                robots[setup.id] = std::move(robot);
        }
        if (by == ShiftBy::simulated_part) {
            SEAM_TRY(auto cell, shared_cell(project.sensors.front().settings, session_));
            cell_ = std::move(cell);
        }
        station_.connect(std::move(sensors), std::move(robots));
        return {};
    }
    void place(const Pose& displacement, const Pose& base_from_shiftedbase) {
        *shift_ = base_from_shiftedbase;
        if (cell_) cell_->set_part({displacement, {}});
    }
    ~Borrowed() {
        station_.disconnect();
        station_.use(before_);
        // A device that is gone by now says so at the next thing that is asked of it.
        if (was_connected_) (void)station_.connect();
        // A simulated cell is made anew, and its robot has not been anywhere yet: its sensor would see
        // nothing.
        for (const auto& [id, pose] : stood_)
            if (RobotLink* robot = station_.robot(id)) (void)robot->move_to(pose);
    }

  private:
    Station& station_;
    const Project before_;
    bool was_connected_;
    std::map<std::string, Pose> stood_;  // simulated robots
    DeviceSession session_;
    std::shared_ptr<SimulatedCell> cell_;
    std::shared_ptr<Pose> shift_ = std::make_shared<Pose>(Pose::Identity());
};

Expected<void> fits(const Project& project, const KnownShiftOptions& options) {
    if (options.by == ShiftBy::by_hand && !options.place)
        return usage_error("nobody is there to displace the part", kWhere, "run it at a terminal");
    if (options.by != ShiftBy::simulated_part) return {};
    const auto simulated = [](const auto& device) { return is_simulated_cell(device.driver); };
    if (project.sensors.empty() || !std::all_of(project.sensors.begin(), project.sensors.end(), simulated) ||
        !std::all_of(project.robots.begin(), project.robots.end(), simulated))
        return usage_error("only a simulated cell can move its part", kWhere,
                           "shift the robot's base instead");
    return {};
}

}  // namespace

Expected<std::vector<ShiftTest>> shift_tests(const Project& project, const ShiftGrid& grid) {
    for (const auto& [range, step, unit] :
         {std::tuple{grid.range_mm, grid.step_mm, "mm"}, std::tuple{grid.range_deg, grid.step_deg, "deg"}})
        if (!(range > 0 && step > 0 && step <= range && range <= 1000))
            return usage_error(Text("a range of {0} {2} in steps of {1} {2}", range, step, unit), kWhere,
                               "give a positive range and a step not above it");
    const int moves = steps(grid.range_mm, grid.step_mm), turns = steps(grid.range_deg, grid.step_deg);
    const double count = 3.0 * 2 * (2.0 * moves + turns);
    if (count > static_cast<double>(kMostTests))
        return usage_error(Text("{:.0f} displacements are too many", count), kWhere, "give larger steps");
    SEAM_TRY(const auto middle, middle_of(project));
    std::vector<ShiftTest> tests;
    const auto add = [&](ShiftKind kind, int axis, double amount, double mm, double deg) {
        const Eigen::Vector3d along = Eigen::Vector3d::Unit(axis);
        const Eigen::Matrix3d turn = rotation_exp(along * rad_from_deg(deg));
        ShiftTest& test = tests.emplace_back();
        test.kind = kind;
        test.axis = axis;
        test.amount = amount;
        test.workobject_from_movedworkobject = make_pose(turn, middle - turn * middle + along * mm);
    };
    for (int axis = 0; axis < 3; ++axis) {
        for (int n = -moves; n <= moves; ++n)
            if (n) add(ShiftKind::translation, axis, n * grid.step_mm, n * grid.step_mm, 0);
        for (int n = -turns; n <= turns; ++n)
            if (n) add(ShiftKind::rotation, axis, n * grid.step_deg, 0, n * grid.step_deg);
        for (int n = -moves; n <= moves; ++n)
            if (n)
                add(ShiftKind::both, axis, n * grid.step_mm, n * grid.step_mm,
                    n * grid.step_mm * grid.range_deg / grid.range_mm);
    }
    return tests;
}

std::string shift_name(const ShiftTest& test, const KnownShift& proof) {
    const char axis = kAxes[test.axis];
    switch (test.kind) {
        case ShiftKind::translation:
            return fmt::format("{} {:+.3g} mm", axis, test.amount);
        case ShiftKind::rotation:
            return fmt::format("{} {:+.3g} deg", axis, test.amount);
        case ShiftKind::both:
            break;
    }
    return fmt::format("{} {:+.3g} mm and {:+.3g} deg", axis, test.amount,
                       test.amount * proof.range_deg / proof.range_mm);
}

std::vector<ShiftOutcome> judge_shift(const Project& setup, const RunRecord& run, const Pose& truth) {
    std::vector<ShiftOutcome> outcomes;
    for (const Region& region : setup.regions) {
        ShiftOutcome& outcome = outcomes.emplace_back();
        outcome.region_id = region.id;
        const auto record = std::find_if(run.regions.begin(), run.regions.end(),
                                         [&](const RegionRecord& r) { return r.region_id == region.id; });
        if (record == run.regions.end()) {
            outcome.message = run.message;
            continue;
        }
        outcome.ok =
            record->gate_passed && record->correction && record->correction->status == CorrectionStatus::ok;
        if (!record->refusals.empty()) outcome.message = record->refusals.front();
        // An under-determined region found nothing that could be compared.
        if (!record->correction || (record->correction->status != CorrectionStatus::ok &&
                                    record->correction->status != CorrectionStatus::over_limit))
            continue;
        const Pose& found = record->correction->displacement.workobject_from_movedworkobject;
        const std::vector<Eigen::Vector3d> points = reference_points(setup, region);
        for (const Eigen::Vector3d& p : points) {
            const Eigen::Vector3d deviation = found * p - truth * p;
            for (int k = 0; k < 3; ++k) outcome.deviations_mm.push_back(deviation[k]);
            outcome.mean_abs_mm += deviation.norm() / static_cast<double>(points.size());
        }
    }
    return outcomes;
}

Expected<KnownShift> prove_known_shift(Station& station, const KnownShiftOptions& options) {
    SEAM_TRY(const auto type, called_type(station.project(), options.part_type));
    const Project setup = of_type(station.project(), type);
    SEAM_OK(fits(setup, options));
    SEAM_TRY(auto tests, shift_tests(setup, options.grid));
    KnownShift proof;
    proof.realised_by = options.by;
    proof.range_mm = options.grid.range_mm;
    proof.range_deg = options.grid.range_deg;
    {
        Borrowed devices(station);
        // What is found is judged, not what the limits of the day let through; nothing is pushed.
        Project unlimited = setup;
        for (Region& region : unlimited.regions) region.limits = kNoLimits;
        station.use(unlimited);
        SEAM_OK(devices.open(options.by));
        int done = 0;
        const auto cancelled = [&] {
            return usage_error(Text("cancelled after {} of {} displacements", done, tests.size()), kWhere,
                               "start it again");
        };
        for (ShiftTest& test : tests) {
            if (options.cancel.stop_requested()) return cancelled();
            const Pose& b = setup.part.base_from_workobject;
            const Pose shift = b * test.workobject_from_movedworkobject.inverse() * b.inverse();
            devices.place(test.workobject_from_movedworkobject, shift);
            if (options.by == ShiftBy::by_hand && !options.place(test, shift)) return cancelled();
            const std::string name = shift_name(test, proof);
            RunOptions run_options;
            run_options.part_id = kKnownShiftPrefix + name;
            run_options.part_type = type;
            run_options.cancel = options.cancel;
            SEAM_TRY(auto run, station.run(run_options));
            if (options.measured) options.measured(run);
            if (run.status == RunStatus::cancelled) return cancelled();
            if (run.status == RunStatus::device) return device_error(run.message, kWhere);
            test.run = run.number;
            test.regions = judge_shift(setup, run, test.workobject_from_movedworkobject);
            ++done;
            if (options.progress) options.progress({done, static_cast<int>(tests.size()), name});
        }
    }
    proof.tests = std::move(tests);
    SEAM_OK(station.file().append_evidence({0, {}, 0, proof}, setup));
    return proof;
}

std::vector<ShiftStatistic> statistics(const KnownShift& proof) {
    std::vector<std::string> regions;
    for (const ShiftTest& test : proof.tests)
        for (const ShiftOutcome& o : test.regions)
            if (std::find(regions.begin(), regions.end(), o.region_id) == regions.end())
                regions.push_back(o.region_id);
    if (regions.size() > 1) regions.emplace_back();
    std::vector<ShiftStatistic> lines;
    for (const std::string& id : regions)
        for (const ShiftKind kind : {ShiftKind::translation, ShiftKind::rotation, ShiftKind::both}) {
            ShiftStatistic line;
            line.region_id = id;
            line.kind = kind;
            std::vector<double> all;
            for (const ShiftTest& test : proof.tests)
                for (const ShiftOutcome& o : test.regions) {
                    if (test.kind != kind || (!id.empty() && o.region_id != id)) continue;
                    ++line.tests;
                    line.refused += !o.ok;
                    all.insert(all.end(), o.deviations_mm.begin(), o.deviations_mm.end());
                }
            if (line.tests == 0) continue;
            line.summary = summarise(all);
            double square = 0;
            for (double d : all) square += d * d / static_cast<double>(all.size());
            line.about_truth_mm = 3 * std::sqrt(square);
            lines.push_back(line);
        }
    return lines;
}

ProvenAccuracy proven_accuracy(const KnownShift& proof, const std::string& region_id) {
    ProvenAccuracy proven;
    double square = 0;
    std::size_t count = 0;
    for (const ShiftTest& test : proof.tests)
        for (const ShiftOutcome& o : test.regions) {
            if (!region_id.empty() && o.region_id != region_id) continue;
            ++proven.tests;
            proven.refused += !o.ok;
            count += o.deviations_mm.size();
            for (double d : o.deviations_mm) {
                square += d * d;
                proven.worst_mm = std::max(proven.worst_mm, std::abs(d));
            }
        }
    if (count) proven.three_sigma_mm = 3 * std::sqrt(square / static_cast<double>(count));
    return proven;
}

ProvenRange proven_range(const KnownShift& proof) {
    ProvenRange range;
    for (const ShiftTest& test : proof.tests) {
        if (std::any_of(test.regions.begin(), test.regions.end(), [](const auto& o) { return !o.ok; }))
            continue;
        const Pose& d = test.workobject_from_movedworkobject;
        range.translation_mm = std::max(range.translation_mm, d.translation().norm());
        range.rotation_deg = std::max(range.rotation_deg, deg_from_rad(angle_rad(d, Pose::Identity())));
    }
    return range;
}

CorrectionLimits proven_limits(const KnownShift& proof) {
    const ProvenRange range = proven_range(proof);
    constexpr double kHair = 1e-6;  // a turn of 1 degree comes back as 0.9999999
    return {std::floor((range.translation_mm + kHair) * 100) / 100,
            std::floor((range.rotation_deg + kHair) * 1000) / 1000};
}

}  // namespace seamwright
