#include "projects/panel/panel_servo.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "projects/panel/panel_run.h"
#include "projects/station/check.h"

namespace seamwright {
namespace {

using panel_running::PanelRun;
using panel_running::Places;

std::vector<std::string> enabled_places(const PanelJob& job) {
    std::vector<std::string> ids;
    for (const PanelPlace& p : job.places)
        if (p.enabled) ids.push_back(p.id);
    return ids;
}

const PanelPlace& place_of(const PanelJob& job, const std::string& id) {
    return *std::find_if(job.places.begin(), job.places.end(),
                         [&](const PanelPlace& p) { return p.id == id; });
}

// What every servoing run has: moves through the gate, and what failed at one of them.
class Moving : public PanelRun {
  public:
    Moving(Station& station, const PanelJob& job, Places& places, const RunOptions& options,
           const PanelMoved& moved)
        : PanelRun(station, job, places, options), moved_(moved) {}

  protected:
    // Gap and flush of all enabled places, taught ones off. Error: one of them was not measured.
    Expected<Eigen::VectorXd> values(const std::vector<PanelMeasurement>& measured) const {
        Eigen::VectorXd v(2 * static_cast<Eigen::Index>(measured.size()));
        for (std::size_t i = 0; i < measured.size(); ++i) {
            const PanelMeasurement& m = measured[i];
            if (m.status != SpotStatus::measured)
                return input_error(Text("place {} was not measured ({})", m.place_id, m.message),
                                   Text("panel job {}", job_.id), "servoing needs all enabled places");
            v[2 * static_cast<Eigen::Index>(i)] = m.gap_mm;
            v[2 * static_cast<Eigen::Index>(i) + 1] = m.flush_mm;
        }
        return v;
    }

    // Of a motion that is known but for the robot: two arrivals of it, in the gripper's own axes. Where the robot's is not
    // stated, the places' sigma holds it (RobotSetup::arrival_covariance).
    Matrix6 arrivals() const {
        Matrix6 c = Matrix6::Zero();
        const RobotSetup* robot = find_robot(station_.project(), job_.robot_id);
        if (robot && !robot->arrival_covariance.isZero(0)) {
            const Eigen::Matrix3d gripper_from_base = job_.base_from_gripper.linear().transpose();
            Matrix6 turned = Matrix6::Zero();
            turned.topLeftCorner<3, 3>() = turned.bottomRightCorner<3, 3>() = gripper_from_base;
            c = 2 * turned * robot->arrival_covariance * turned.transpose();
            return 0.5 * (c + c.transpose());
        }
        double sigma = 0;
        for (const PanelMeasurement& m : run_.panel->before)
            sigma = std::max(sigma, place_of(job_, m.place_id).sigma_mm);
        c.topLeftCorner<3, 3>() = sigma * sigma * Eigen::Matrix3d::Identity();
        return c;
    }

    // The motion as the gate judges it.
    RegionCorrection correction(const Pose& motion, const Matrix6& covariance) const {
        PanelFit moved;
        moved.status = CorrectionStatus::ok;
        moved.gripper_motion = motion;
        moved.covariance = covariance;
        return motion_as_correction(job_, run_.panel->base_from_gripper, moved);
    }

    // By a pass of the gate to base_from_gripper * motion, measured there into `after`. What fails ends all moves.
    bool move(const Pose& motion, const Matrix6& covariance) {
        const auto& rests_on = panel().after.empty() ? panel().before : panel().after;
        GateVerdict verdict = pass_gate(gate_request(correction(motion, covariance), rests_on));
        if (!verdict.pass) {
            for (const Text& reason : verdict.reasons) {
                panel().refusals.push_back(reason);
                (void)event(EventKind::refusal, job_.id, reason);
            }
            return failed(RunStatus::refused, Text("a move is refused: {}", verdict.reasons.front()));
        }
        // Between two moves a person may end it: everything is taken back.
        if (options_.cancel.stop_requested()) return failed(RunStatus::cancelled, "cancelled");
        panel().servo->motion = motion;
        place_servo(job_, panel());
        PushRecord push = push_region(std::move(*verdict.pass), *places_.robot, sink());
        push.robot_id = job_.robot_id;
        const bool written = push.status == PushStatus::written;
        const Text trouble = push.message;
        // What is taken back in the end is the frame from before the first move.
        if (panel().push.status == PushStatus::written) push.before = panel().push.before;
        if (written || panel().push.status != PushStatus::written) panel().push = std::move(push);
        if (!written) return failed(RunStatus::alarm, Text("alarm: {}", trouble));
        if (!record_pushed("a move is pushed; whether the panel was moved by it is not recorded yet"))
            return failed(RunStatus::alarm, run_.message);
        if (!tell(PartVerdict::corrected, "moved, to be measured again"))
            return failed(RunStatus::alarm, "alarm: the robot did not acknowledge the corrected frame");
        if (auto measured = measure_moved(); !measured)
            return failed(RunStatus::device, Text("not verified after a move: {}", measured.error().text()));
        progress(0, Text("{}: move {}", job_.id, ++moves_));
        return true;
    }
    bool failed(RunStatus status, Text why) {
        failed_ = true;
        failed_status_ = status;
        failed_why_ = std::move(why);
        return false;
    }
    // The first frame again, whatever was written.
    void take_all_back(RunStatus status, const Text& why) {
        if (panel().push.status == PushStatus::written) return take_back_motion(status, why);
        run_.status = status;
        run_.message = why;
        tell(status == RunStatus::refused ? PartVerdict::refused : PartVerdict::failed);
    }

    void tell_moved() {
        if (moved_) moved_(panel(), moves_);
    }

    bool failed_ = false;
    RunStatus failed_status_ = RunStatus::refused;
    Text failed_why_;
    int moves_ = 0;

  private:
    const PanelMoved& moved_;
};

class Learning : public Moving {
  public:
    using Moving::Moving;

    Expected<LearntPanel> learn(const ServoingOptions& servoing) {
        SEAM_OK(begin());
        panel().servo.emplace();
        panel().base_from_gripper = job_.base_from_gripper;
        const auto measured = measure(job_.base_from_gripper, panel().before, panel().base_from_gripper);
        compute_panel(station_.project(), job_, panel());
        run_.status = measured ? RunStatus::interrupted : RunStatus::device;
        run_.message =
            measured ? Text("the program ended while the sensitivity was learnt") : measured.error().text();
        SEAM_OK(store_or_tell());
        Sensitivity learnt;
        if (measured) {
            const auto at = [&](const Pose& motion) -> Eigen::VectorXd {
                const Eigen::VectorXd none =
                    Eigen::VectorXd::Zero(2 * static_cast<Eigen::Index>(panel().before.size()));
                if (failed_ || !move(motion, arrivals())) return none;
                tell_moved();
                auto found = values(panel().after);
                if (!found) failed(RunStatus::device, found.error().text());
                return found.value_or(none);
            };
            learnt = learn_sensitivity(at, servoing);
            panel().verdict = judge_panel(job_, panel().after);
            if (failed_)
                take_all_back(failed_status_, failed_why_);
            else
                take_all_back(RunStatus::refused,
                              "no part: the sensitivity was learnt, and the frame taken back");
        } else {
            tell(PartVerdict::failed);
        }
        const Error trouble{ErrorKind::device, measured ? failed_why_ : run_.message,
                            Text("panel job {}", job_.id), "see the run's events"};
        const bool sound = measured && !failed_;
        LearntPanel out;
        SEAM_TRY(out.run, end());
        if (!sound) return tl::unexpected(trouble);
        out.job = job_;
        out.condition = learnt.condition;
        out.usable = learnt.usable;
        if (!learnt.usable) return out;
        PanelSensitivity& kept = out.job.sensitivity.emplace();
        kept.places = enabled_places(job_);
        for (Eigen::Index i = 0; i < learnt.matrix.rows(); ++i) {
            auto& row = kept.rows.emplace_back();
            for (std::size_t k = 0; k < 6; ++k) row[k] = learnt.matrix(i, static_cast<Eigen::Index>(k));
        }
        kept.step_mm = servoing.step_mm;
        kept.step_deg = servoing.step_deg;
        kept.condition = learnt.condition;
        kept.utc = utc_now();
        return out;
    }
};

class Servoing : public Moving {
  public:
    Servoing(Station& station, const PanelJob& job, Places& places, const RunOptions& options,
             const PanelMoved& moved, const Sensitivity& sensitivity, const ServoingOptions& servoing)
        : Moving(station, job, places, options, moved), sensitivity_(sensitivity), servoing_(servoing) {}

    Expected<RunRecord> servo_run() {
        SEAM_OK(begin());
        panel().servo.emplace();
        std::optional<GatePass> first = measure_and_judge();
        const bool pushing = options_.push && first;
        if (pushing) run_.status = RunStatus::interrupted;
        SEAM_OK(store_or_tell());
        if (pushing && confirmed(first))
            servo_and_verify();
        else
            tell_not_moved();
        return end();
    }

  protected:
    // Of the first move; its pass writes nothing, every move asks again.
    std::optional<GatePass> judge() override {
        panel().refusals.clear();
        std::optional<GatePass> pass;
        if (auto found = values(panel().before); !found) {
            panel().refusals.push_back(found.error().text());
        } else {
            const Pose step = own_motion(-servoing_.gain * sensitivity_.pseudo_inverse * (*found - set()));
            panel().servo->motion = step;
            place_servo(job_, panel());
            GateVerdict verdict =
                pass_gate(gate_request(correction(step, sigma(panel().before)), panel().before));
            panel().refusals = std::move(verdict.reasons);
            if (verdict.pass) pass.emplace(std::move(*verdict.pass));
        }
        panel().gate_passed = pass.has_value();
        for (const Text& reason : panel().refusals) (void)event(EventKind::refusal, job_.id, reason);
        return pass;
    }

  private:
    Eigen::VectorXd set() const {
        const auto places = enabled_places(job_);
        Eigen::VectorXd v(2 * static_cast<Eigen::Index>(places.size()));
        for (std::size_t i = 0; i < places.size(); ++i) {
            const PanelPlace& place = place_of(job_, places[i]);
            v[2 * static_cast<Eigen::Index>(i)] = place.gap_mm;
            v[2 * static_cast<Eigen::Index>(i) + 1] = place.flush_mm;
        }
        return v;
    }

    // Of the motion, from what the values are known to.
    Matrix6 sigma(const std::vector<PanelMeasurement>& measured) const {
        Eigen::VectorXd variance(2 * static_cast<Eigen::Index>(measured.size()));
        for (std::size_t i = 0; i < measured.size(); ++i) {
            // Gap and flush are differences of two points of that sigma.
            const double own = 2 * std::pow(place_of(job_, measured[i].place_id).sigma_mm, 2);
            for (int k = 0; k < 2; ++k)
                variance[2 * static_cast<Eigen::Index>(i) + k] = measured[i].gap_flush_covariance(k, k) + own;
        }
        const Eigen::MatrixXd& j = sensitivity_.pseudo_inverse;
        const Matrix6 c = j * variance.asDiagonal() * j.transpose();
        return 0.5 * (c + c.transpose());
    }

    void servo_and_verify() {
        cancel_ = {};
        const Eigen::VectorXd taught = set();
        const Eigen::VectorXd lost =
            Eigen::VectorXd::Constant(taught.size(), std::numeric_limits<double>::quiet_NaN());
        const auto at = [&](const Pose& motion) -> Eigen::VectorXd {
            const bool start = panel().servo->moves.empty();
            if (failed_ || (!start && !move(motion, sigma(panel().before)))) return lost;
            auto found = values(start ? panel().before : panel().after);
            if (!found) {
                failed(RunStatus::device, found.error().text());
                return lost;
            }
            const Eigen::VectorXd off = *found - taught;
            panel().servo->moves.push_back(
                {motion, std::sqrt(off.squaredNorm() / static_cast<double>(off.size()))});
            tell_moved();
            return *found;
        };
        const ServoingResult result = servo(sensitivity_, at, taught, servoing_);
        panel().servo->status = result.status;
        // As taught from the start: its frame is written all the same, or nothing could be released in it.
        if (!failed_ && result.moves == 0) (void)move(Pose::Identity(), sigma(panel().before));
        panel().verdict = judge_panel(job_, panel().after);
        if (failed_) return take_all_back(failed_status_, failed_why_);
        if (result.status == ServoingStatus::diverged)
            return take_all_back(
                RunStatus::refused,
                Text("the deviations grow ({:.3f} mm after {} moves): learn the sensitivity anew",
                     result.rms_mm, result.moves));
        judge_moved_and_release();
    }

    const Sensitivity& sensitivity_;
    const ServoingOptions& servoing_;
};

Expected<PanelJob> job_named(Station& station, const std::string& job_id, bool push) {
    const std::string path = station.file().path().string();
    if (!station.connected())
        return usage_error("the station is not connected to its devices", path, "connect first");
    const PanelJob* found = find_panel_job(station.project(), job_id);
    if (!found) return input_error(Text("there is no panel job \"{}\"", job_id), path);
    SEAM_OK(none_of_motion(motion_findings(station.project(), *found, push)));
    return *found;
}

}  // namespace

Expected<LearntPanel> learn_panel(Station& station, const std::string& job_id,
                                  const ServoingOptions& servoing, const RunOptions& options,
                                  const PanelMoved& moved) {
    SEAM_TRY(const PanelJob job, job_named(station, job_id, true));
    const bool small = servoing.step_mm >= 0.05 && servoing.step_mm <= 3 && servoing.step_deg >= 0.005 &&
                       servoing.step_deg <= 0.5;
    if (!small)
        return usage_error(Text("steps of {} mm and {} degrees", servoing.step_mm, servoing.step_deg),
                           Text("panel job {}", job_id), "give 0.05 to 3 mm and 0.005 to 0.5 degrees");
    SEAM_TRY(auto places, panel_running::prepare(station, job));
    RunOptions moving = options;
    moving.push = true;
    if (moving.part_id.empty()) moving.part_id = "sensitivity";
    return Learning(station, job, places, moving, moved).learn(servoing);
}

Expected<RunRecord> servo_panel(Station& station, const std::string& job_id, const ServoingOptions& servoing,
                                const RunOptions& options, const PanelMoved& moved) {
    SEAM_TRY(const PanelJob job, job_named(station, job_id, options.push));
    const Text where("panel job {}", job.id);
    if (!job.sensitivity) return usage_error("its sensitivity is not learnt", where, "learn it first");
    if (job.sensitivity->places != enabled_places(job) ||
        job.sensitivity->rows.size() != 2 * job.sensitivity->places.size())
        return input_error("its sensitivity is that of other places", where, "learn it anew");
    Eigen::MatrixXd matrix(static_cast<Eigen::Index>(job.sensitivity->rows.size()), 6);
    for (Eigen::Index i = 0; i < matrix.rows(); ++i)
        for (Eigen::Index k = 0; k < 6; ++k)
            matrix(i, k) = job.sensitivity->rows[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)];
    ServoingOptions scaled = servoing;
    scaled.step_mm = job.sensitivity->step_mm;
    scaled.step_deg = job.sensitivity->step_deg;
    const Sensitivity sensitivity = inverted(matrix, scaled);
    if (!sensitivity.usable)
        return input_error(
            Text("its sensitivity cannot be inverted (condition {:.0f})", sensitivity.condition), where,
            "measure at more places, in other directions, and learn it anew");
    SEAM_TRY(auto places, panel_running::prepare(station, job));
    return Servoing(station, job, places, options, moved, sensitivity, scaled).servo_run();
}

}  // namespace seamwright
