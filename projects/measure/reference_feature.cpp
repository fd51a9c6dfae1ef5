#include "projects/measure/reference_feature.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <mutex>
#include <string>
#include <type_traits>
#include <unordered_map>

#include "core/features/kinds/feature_registry.h"

namespace seamwright {

namespace {

constexpr std::size_t kMostRemembered = 256;  // some 10 MB

// Everything that the answer depends on, as bytes: not a number alone would be taken for another of its kind.
class Question {
  public:
    explicit Question(const Spot& spot) {
        const FeatureRecipe& recipe = spot.feature;
        add(recipe.kind);
        add_value(recipe.parameters.size());
        for (const auto& [name, value] : recipe.parameters) add(name), add_value(value);
        add(recipe.template_profile);
        add_value(recipe.template_reference_mm.x());
        add_value(recipe.template_reference_mm.y());
        add(spot.reference_profile);
    }
    std::string bytes;

  private:
    template <class T>
    void add_value(const T& value) {
        static_assert(std::is_arithmetic_v<T>);
        bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
    template <class Values>  // of arithmetic values, in one piece
    void add(const Values& values) {
        add_value(values.size());
        if (!values.empty())
            bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof *values.data());
    }
    void add(const Profile& profile) {
        add(profile.x_mm), add(profile.z_mm), add(profile.intensity), add(profile.segment);
    }
};

std::optional<Feature> find(const Spot& spot) {
    const auto finder = make_feature_finder(spot.feature);
    if (!finder) return std::nullopt;
    Feature found = (*finder)->find(spot.reference_profile);
    if (found.status != FeatureStatus::ok || !found.covariance_mm2.allFinite()) return std::nullopt;
    return found;
}

}  // namespace

std::optional<Feature> feature_at_reference(const Spot& spot) {
    if (spot.reference_profile.size() == 0) return std::nullopt;
    static std::mutex mutex;
    static std::unordered_map<std::string, std::optional<Feature>> remembered;
    Question question(spot);
    {
        const std::lock_guard lock(mutex);
        if (const auto known = remembered.find(question.bytes); known != remembered.end())
            return known->second;
    }
    std::optional<Feature> found = find(spot);
    const std::lock_guard lock(mutex);
    if (remembered.size() >= kMostRemembered) remembered.clear();
    remembered.emplace(std::move(question.bytes), found);
    return found;
}

int points_at_reference(const Spot& spot) {
    const std::optional<Feature> found = feature_at_reference(spot);
    return found ? found->points_used : 0;
}

double reference_beside_mm(const Project& project, const Spot& spot) {
    // Between the mean of the arrivals and one of them lies what an ordinary robot repeats (0.1 mm, thesis 5.1), five
    // times, or what this one was measured to, and the feature's own noise.
    constexpr double kRepeatsMm = 0.6, kSigmas = 6;
    const auto found = feature_at_reference(spot);
    if (!found) return 0;
    const Eigen::Vector2d beside(spot.weights.x() == 0 ? 0 : spot.reference_mm.x() - found->point_mm.x(),
                                 spot.weights.z() == 0 ? 0 : spot.reference_mm.z() - found->point_mm.y());
    double repeats = std::max(kRepeatsMm, kSigmas * spot.sigma_mm);
    if (const RobotSetup* robot = find_robot(project, spot.robot_id))
        repeats =
            std::max(repeats, kSigmas * std::sqrt(robot->arrival_covariance.topLeftCorner<3, 3>().trace()));
    const Eigen::Matrix2d reach =
        kSigmas * kSigmas * found->covariance_mm2 + repeats * repeats * Eigen::Matrix2d::Identity();
    return beside.dot(reach.ldlt().solve(beside)) > 1 ? beside.norm() : 0;
}

}  // namespace seamwright
