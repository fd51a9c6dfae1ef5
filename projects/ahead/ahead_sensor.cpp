#include "projects/ahead/ahead_sensor.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <utility>

#include "devices/host_time.h"
#include "devices/silence.h"
#include "projects/station/acquire.h"

namespace seamwright {
namespace {
using std::chrono::milliseconds;
constexpr milliseconds kLook{2}, kSlice{50};
constexpr std::int64_t kPoseWithin_ns = 200'000'000;
}  // namespace

AheadSensor::AheadSensor(ProfileSource& sensor, SpotMeasurer measurer, std::shared_ptr<SeamSteering> steering,
                         const AheadSensorSetup& setup)
    : sensor_(sensor), measurer_(std::move(measurer)), steering_(std::move(steering)), setup_(setup) {
    thread_ = std::thread([this] { run(); });
}

void AheadSensor::end() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
}

void AheadSensor::run() {
    while (!stop_ && steering_->phase() != PathPhase::running) std::this_thread::sleep_for(kLook);
    if (stop_) return;
    const auto by_software = SoftwareTriggered::begin(sensor_);
    if (!by_software) {
        steering_->lose(Text("the sensor takes no trigger: {}", by_software.error().text()));
        return;
    }
    for (std::uint64_t number = 1; !stop_ && steering_->phase() == PathPhase::running; ++number)
        if (auto measured = measure(number); !measured) {
            steering_->lose(Text("the sensor is lost: {}", measured.error().text()));
            return;
        }
}

Expected<void> AheadSensor::measure(std::uint64_t number) {
    const std::string name = fmt::format("ahead {}", number);
    const std::int64_t before = host_now_ns();
    SEAM_OK(sensor_.trigger(name));
    const std::int64_t triggered = before + (host_now_ns() - before) / 2;
    FramePtr frame;
    while (true) {
        auto came = sensor_.wait_next(kSlice);
        if (stop_) return {};
        if (came && (*came)->spot_id != name && !(*came)->spot_id.empty()) continue;  // of the spots before
        if (came) {
            frame = *came;
            break;
        }
        if (!is_silence(came.error())) return tl::unexpected(came.error());
        if (host_now_ns() - triggered > std::chrono::nanoseconds(setup_.frame_timeout).count())
            return device_error(Text("no profile came within {} ms", setup_.frame_timeout.count()), "sensor");
    }
    const SpotMeasurement& found = measurer_.measure(*frame);
    if (found.status != SpotStatus::measured) {
        steering_->not_found(found.message);
        return {};
    }
    std::optional<Pose> flange = frame->base_from_flange;
    if (!flange) {
        const std::int64_t exposed = triggered + std::llround(1e9 * setup_.latency_s);
        while (!steering_->known_until(exposed) && !stop_ && host_now_ns() - exposed < kPoseWithin_ns)
            std::this_thread::sleep_for(kLook);
        flange = steering_->base_from_flange(exposed);
    }
    if (!flange) {
        steering_->not_found("it is not known where the robot was at the exposure");
        return {};
    }
    const Pose base_from_sensor = *flange * setup_.flange_from_sensor;
    const Feature& f = found.feature;
    const Eigen::Vector3d point = base_from_sensor * Eigen::Vector3d(f.point_mm.x(), 0, f.point_mm.y());
    Eigen::Matrix<double, 3, 2> in_plane;
    in_plane << base_from_sensor.linear().col(0), base_from_sensor.linear().col(2);
    Eigen::Matrix<double, 3, 6> of_pose;
    of_pose << Eigen::Matrix3d::Identity(), -skew(point - flange->translation());
    steering_->add(point, in_plane * f.covariance_mm2 * in_plane.transpose() +
                              of_pose * setup_.arrival_covariance * of_pose.transpose());
    return {};
}

}  // namespace seamwright
