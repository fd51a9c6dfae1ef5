#include "projects/acceptance/simulated_parts.h"

#include <algorithm>
#include <random>

#include "devices/exchange/pose_json.h"

namespace seamwright {
namespace {

std::uint64_t fnv(std::string_view text) {
    std::uint64_t hash = 1469598103934665603ULL;
    for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
    return hash;
}

// The same everywhere, which the distributions of <random> are not.
class Draw {
  public:
    explicit Draw(std::uint64_t seed) : engine_(seed) {}
    double uniform() { return 2 * static_cast<double>(engine_() >> 11) * 0x1p-53 - 1; }
    double normal() {  // of twelve uniforms, sigma 1
        double sum = 0;
        for (int i = 0; i < 12; ++i) sum += uniform();
        return sum / 2;
    }
    template <class F>
    Eigen::Vector3d vector(F one) {
        const double x = one(), y = one();
        return {x, y, one()};
    }

  private:
    std::mt19937_64 engine_;
};

Pose place_of(const std::string& part, int rehang) {
    Draw of_part(fnv(part)), of_hanging(fnv(part + " hung " + std::to_string(rehang)));
    const auto uniform = [&] { return of_part.uniform(); };
    const auto normal = [&] { return of_hanging.normal(); };
    const Eigen::Vector3d t = kPartMm * of_part.vector(uniform) + kRehangMm * of_hanging.vector(normal);
    const Eigen::Vector3d w = rad_from_deg(kPartDeg) * of_part.vector(uniform) +
                              rad_from_deg(kRehangDeg) * of_hanging.vector(normal);
    return make_pose(rotation_exp(w), t);
}

}  // namespace

bool SimulatedParts::possible(const Project& project) {
    const auto simulated = [](const auto& device) { return is_simulated_cell(device.driver); };
    return !project.sensors.empty() &&
           std::all_of(project.sensors.begin(), project.sensors.end(), simulated) &&
           std::all_of(project.robots.begin(), project.robots.end(), simulated);
}

Expected<void> SimulatedParts::put(const std::string& part, int rehang) {
    const Project project = station_.project();
    SEAM_TRY(auto runs, station_.file().runs());
    const std::uint64_t made = runs.empty() ? 0 : static_cast<std::uint64_t>(runs.back().number);
    const std::uint64_t noise = fnv(part + " " + std::to_string(rehang) + " " + std::to_string(made)) >> 16;
    Project placed = project;
    const auto place = [&](auto& all) {
        for (auto& setup : all) {
            setup.settings["seed"] = noise;
            if (!part.empty()) setup.settings["part"]["displacement"] = pose_json(place_of(part, rehang));
        }
    };
    place(placed.sensors);
    place(placed.robots);
    for (const RobotSetup& setup : project.robots)
        if (RobotLink* robot = station_.robot(setup.id); robot && !put_)
            if (auto pose = robot->base_from_flange()) stood_[setup.id] = *pose;
    put_ = true;
    station_.use(placed);
    auto connected = station_.connect();
    station_.use(project);
    return connected;
}

SimulatedParts::~SimulatedParts() {
    // Devices that do not come back say so at the next thing that is asked of them.
    if (!put_ || !station_.connected() || !station_.connect()) return;
    for (const auto& [id, pose] : stood_)
        if (RobotLink* robot = station_.robot(id)) (void)robot->move_to(pose);
}

}  // namespace seamwright
