#pragma once
// The simulated cell's sensor with finished profiles, cut from the mesh instead of rendered: quick enough for a loaded
// machine. And what may go wrong with it while it rides ahead.

#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>

#include "devices/host_time.h"
#include "devices/profile_source.h"
#include "devices/silence.h"
#include "devices/simulated/cell.h"
#include "devices/simulated/scene/profile_cut.h"

namespace seamwright {

// Counted in the profiles that are triggered ahead.
struct SensorFaults {
    std::atomic<int> silent_after{-1};  // nothing comes any more
    std::atomic<int> blind_after{-1};   // profiles come, without a contour
    std::atomic<int> stray_every{0};    // the contour is seen 0.9 mm beside
    std::atomic<int> ahead{0};
};

class CutSensor final : public ProfileSource {
  public:
    CutSensor(std::shared_ptr<SimulatedCell> cell, std::shared_ptr<SensorFaults> faults)
        : cell_(std::move(cell)), faults_(std::move(faults)) {}
    SensorIdentity identity() const override { return {"test", "Seamwright", "cut", "1"}; }
    Expected<void> start() override {
        cell_->arm(true);
        running_ = true;
        return {};
    }
    void stop() override {
        running_ = false;
        cell_->arm(false);
    }
    Expected<void> trigger(const std::string& spot_id) override { return cell_->software_trigger(spot_id); }
    Expected<FramePtr> wait_next(std::chrono::milliseconds timeout) override {
        for (const auto until = std::chrono::steady_clock::now() + timeout;;) {
            if (!running_) return device_error("the sensor is not started", "cut sensor");
            if (const auto exposure = cell_->take_exposure()) {
                const bool ahead = exposure->spot_id.starts_with("ahead");
                const int number = ahead ? ++faults_->ahead : 0;
                if (ahead && faults_->silent_after >= 0 && number > faults_->silent_after) continue;
                return deliver(*exposure, number);
            }
            if (std::chrono::steady_clock::now() >= until)
                return device_error(ErrorCode::silence, kNoAnswer, "cut sensor");
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    }
    FramePtr latest() const override { return nullptr; }
    SourceCounters counters() const override { return {}; }
    std::vector<ParameterInfo> parameters() const override { return {}; }
    Expected<double> get(const std::string&) const override { return usage_error("none", "cut sensor"); }
    Expected<void> set(const std::string&, double) override { return usage_error("none", "cut sensor"); }

  private:
    FramePtr deliver(const SimulatedCell::Waiting& exposure, int number) {
        const PartState part = cell_->part();
        if (!tree_ || part.bend.bend_mm != bend_.bend_mm || part.bend.twist_mm != bend_.twist_mm) {
            bend_ = part.bend;
            TriangleMesh mesh = cell_->part_mesh();
            const auto box = mesh.box();
            for (Eigen::Vector3d& v : mesh.vertices) v.z() += bend_at(bend_, box, v);
            tree_.emplace(std::move(mesh));
        }
        auto frame = std::make_shared<Frame>();
        frame->sequence = exposure.number;
        frame->spot_id = exposure.spot_id;
        frame->host_time_ns = frame->device_time_ns = host_now_ns();
        const Pose base_from_part = cell_->base_from_workobject() * part.workobject_from_movedworkobject;
        cut_profile(*tree_,
                    base_from_part.inverse() * exposure.base_from_flange * cell_->flange_from_sensor(),
                    cell_->settings().optics, frame->profile);
        Random random(99, exposure.number);
        add_noise(frame->profile, 0.03, random);
        const int stray = faults_->stray_every;
        if (stray > 0 && number > 5 && number % stray == 0)
            for (double& x : frame->profile.x_mm) x += 0.9;
        if (faults_->blind_after >= 0 && number > faults_->blind_after)
            for (double& z : frame->profile.z_mm) z = std::numeric_limits<double>::quiet_NaN();
        return frame;
    }
    std::shared_ptr<SimulatedCell> cell_;
    std::shared_ptr<SensorFaults> faults_;
    std::atomic<bool> running_{false};
    std::optional<MeshTree> tree_;
    PartBend bend_;
};

}  // namespace seamwright
