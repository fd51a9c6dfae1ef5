#include "projects/evaluate/panel_experiment.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/panel/panel_fit.h"
#include "core/panel/servoing.h"
#include "devices/simulated/scene/random.h"

namespace seamwright::evaluation {
namespace {

struct PanelStudyCell {
    std::vector<PanelSpot> spots;
    Pose panel = Pose::Identity(), body = Pose::Identity();

    explicit PanelStudyCell(double sigma_mm) {
        for (int n = 0; n < 8; ++n) {
            PanelSpot s;
            s.id = "S" + std::to_string(n + 1);
            const double phi = kPi / 4 * n + (n % 2 ? 0.3 : -0.2);
            s.gripper_from_sensor = make_pose(rotation_exp({0, 0, phi + 0.3 * (n % 3)}),
                                              {500 * std::cos(phi), 350 * std::sin(phi), 900});
            s.body.reference_mm = {4, 0, 0};
            s.sigma_mm = sigma_mm;
            spots.push_back(s);
        }
    }
    // Where the displaced contour, straight along the sensor's Y, meets the laser plane.
    static Eigen::Vector3d cut(const PanelSpot& s, const Eigen::Vector3d& point, const Pose& displacement) {
        const Pose m = s.gripper_from_sensor.inverse() * displacement * s.gripper_from_sensor;
        const Eigen::Vector3d a = m * point, along = m.linear().col(1);
        return a - along * (a.y() / along.y());
    }
    // The panel rides in the gripper; the body comes the other way.
    void measure(const Pose& motion, double noise_mm, Random& random) {
        const auto noise = [&] {
            return Eigen::Vector3d(noise_mm * random.normal(), 0, noise_mm * random.normal());
        };
        for (PanelSpot& s : spots) {
            s.panel.measured_mm = cut(s, s.panel.reference_mm, panel) + noise();
            s.body.measured_mm = cut(s, s.body.reference_mm, motion.inverse() * body) + noise();
        }
    }
    Eigen::VectorXd values(const Pose& motion, double noise_mm, Random& random) {
        measure(motion, noise_mm, random);
        Eigen::VectorXd v(static_cast<Eigen::Index>(2 * spots.size()));
        Eigen::Index k = 0;
        for (const PanelSpot& s : spots) {
            const GapFlushValue g = gap_and_flush(s, s.panel.measured_mm, s.body.measured_mm);
            v[k++] = g.gap_mm;
            v[k++] = g.flush_mm;
        }
        return v;
    }
    void judge(const Pose& motion, int moves, double noise_mm, PanelWay& way) const {
        way.moves += moves;
        way.fewest_moves = way.judged++ ? std::min(way.fewest_moves, moves) : moves;
        way.most_moves = std::max(way.most_moves, moves);
        const Pose left = body.inverse() * motion * panel;
        for (const PanelSpot& s : spots) {
            const Eigen::Vector3d p = s.gripper_from_sensor * s.panel.reference_mm;
            const Eigen::Vector3d off = s.gripper_from_sensor.linear().transpose() * (left * p - p);
            for (double v : {off.x(), off.z()}) {
                way.rms_mm += v * v;
                way.worst_mm = std::max(way.worst_mm, std::abs(v));
                way.within_three_sigma += std::abs(v) <= 3 * std::sqrt(2.0) * noise_mm;  // of two points
            }
        }
    }
};

}  // namespace

PanelComparison compare_panel_fitting(int panels, std::uint64_t seed) {
    PanelComparison out;
    out.panels = panels;
    PanelStudyCell cell(out.noise_mm);
    Random random(seed, 501);
    ServoingOptions options;
    const auto values = [&](const Pose& motion) { return cell.values(motion, out.noise_mm, random); };
    const Eigen::VectorXd set = cell.values(Pose::Identity(), 0, random);
    const Sensitivity learnt = learn_sensitivity(values, options);
    out.training_moves = learnt.moves;
    using Clock = std::chrono::steady_clock;
    const auto since = [](Clock::time_point t) {
        return std::chrono::duration<double, std::milli>(Clock::now() - t).count();
    };
    for (int i = 0; i < panels; ++i) {
        const auto displaced = [&] {
            const auto part = [&](double h) {
                const double x = random.uniform(-h, h), y = random.uniform(-h, h), z = random.uniform(-h, h);
                return Eigen::Vector3d(x, y, z);
            };
            const Eigen::Vector3d turn = part(0.01), move = part(10);
            return make_pose(rotation_exp(turn), move);
        };
        cell.panel = displaced();
        cell.body = displaced();
        cell.measure(Pose::Identity(), out.noise_mm, random);
        auto start = Clock::now();
        const auto fit = fit_panel(cell.spots, {});
        out.single_step.compute_ms += since(start) / panels;
        if (fit && fit->status == CorrectionStatus::ok) {
            cell.judge(fit->gripper_motion, 1, out.noise_mm, out.single_step);
        } else {
            ++out.single_step.failed;
        }
        start = Clock::now();
        const ServoingResult r = servo(learnt, values, set, options);
        out.servoing.compute_ms += since(start) / panels;
        out.servoing.failed += r.status != ServoingStatus::reached && r.status != ServoingStatus::settled;
        cell.judge(r.motion, r.moves, out.noise_mm, out.servoing);
    }
    const double count = 2.0 * static_cast<double>(cell.spots.size());
    for (PanelWay* way : {&out.single_step, &out.servoing}) {
        const double judged = std::max(1, way->judged);
        way->rms_mm = std::sqrt(way->rms_mm / (count * judged));
        way->within_three_sigma /= count * judged;
        way->moves /= judged;
    }
    return out;
}

}  // namespace seamwright::evaluation
