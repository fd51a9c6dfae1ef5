#include "core/calibration/sphere/tcp_sphere_advice.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/calibration/pose_set.h"
#include "core/geometry/decompositions.h"

namespace seamwright::tcp_sphere {
namespace {

constexpr double kLever_mm = 100;
constexpr double kProposedTurn_deg = 25;
constexpr double kHalfArc_deg = 50;
constexpr double kLeastEigenvalue = 1e-14;  // of the largest: less is no information
constexpr double kNoInformation = 1e-300;   // .. and of a largest that is none
// Information added where proposals are compared: to a radius that is given, and to every direction.
constexpr double kGivenRadius = 1e12, kEveryDirection = 1e-8;

// d(t, w, c, r) / d(working point, lever * w, c, r): the working point is R s + t with fixed s.
Matrix10 scaled_basis(const Model& model, const Eigen::Vector3d& working_point_sensor) {
    Matrix10 basis = Matrix10::Identity();
    basis.block<3, 3>(3, 3) /= kLever_mm;
    basis.block<3, 3>(0, 3) = skew(model.flange_from_sensor.linear() * working_point_sensor) / kLever_mm;
    return basis;
}

// Weight that a view adds: points on an arc of +-50 degrees around +z (or -z, as the arcs seen so far).
Matrix10 information_of_view(const Section& view, const Model& model, int points, double side) {
    const Eigen::Vector3d s = centre_in_sensor(view, model);
    const double rho2 = model.radius * model.radius - s.y() * s.y();
    if (rho2 <= 0) return Matrix10::Zero();
    const double rho = std::sqrt(rho2);
    const Matrix3x10 js = centre_jacobian(view, model);
    Matrix10 sum = Matrix10::Zero();
    constexpr int kSteps = 21;
    for (int i = 0; i < kSteps; ++i) {
        const double angle = rad_from_deg(-kHalfArc_deg + 2 * kHalfArc_deg * i / (kSteps - 1));
        const Eigen::Vector3d u =
            Eigen::Vector3d(-rho * std::sin(angle), s.y(), -side * rho * std::cos(angle)) / model.radius;
        Vector10 j = js.transpose() * u;
        j[9] = -1;
        sum.noalias() += j * j.transpose();
    }
    return sum * (static_cast<double>(points) / kSteps);
}

}  // namespace

Determination determination(const Matrix10& information, const Model& model,
                            const Eigen::Vector3d& working_point_sensor, bool radius_free) {
    const Matrix10 basis = scaled_basis(model, working_point_sensor);
    const Matrix10 scaled = basis.transpose() * information * basis;
    const Eigen::Index n = radius_free ? 10 : 9;
    const SymmetricEigen eigen = symmetric_eigen(scaled.topLeftCorner(n, n));
    Determination result;
    result.weakest_direction.head(n) = eigen.vectors.col(0);
    const double floor = kLeastEigenvalue * std::max(eigen.values[n - 1], kNoInformation);
    const Eigen::VectorXd inverse = eigen.values.cwiseMax(floor).cwiseInverse();
    result.weakest =
        eigen.values[0] > floor ? std::sqrt(inverse[0]) : std::numeric_limits<double>::infinity();
    Matrix10 scaled_inverse = Matrix10::Zero();
    scaled_inverse.topLeftCorner(n, n) = eigen.vectors * inverse.asDiagonal() * eigen.vectors.transpose();
    result.inverse = basis * scaled_inverse * basis.transpose();
    return result;
}

std::vector<Text> degenerate_pose_words(const std::vector<Section>& sections, const Model& model,
                                        bool radius_free) {
    std::vector<Text> words;
    std::vector<Pose> poses;
    std::vector<Eigen::Vector3d> centres;
    double smallest_cut = std::numeric_limits<double>::infinity(), largest_cut = 0;
    for (const auto& section : sections) {
        if (!section.used) continue;
        poses.push_back(section.flange_from_base.inverse());
        centres.push_back(centre_in_sensor(section, model));
        smallest_cut = std::min(smallest_cut, section.circle.radius_mm);
        largest_cut = std::max(largest_cut, section.circle.radius_mm);
    }
    const double enough = rad_from_deg(6);
    const OrientationSpread spread = orientation_spread(poses);
    if (spread.spread_rad[0] < enough) {
        words.push_back(
            "all poses share one orientation about X, Y and Z: rotate the flange about two of its axes (for "
            "example X and Y) "
            "by 20 degrees or more");
    } else if (spread.spread_rad[1] < enough) {
        const Eigen::Vector3d axis = spread.axes.col(0);
        std::string missing;
        static constexpr const char* names[] = {"X", "Y", "Z"};
        for (int k = 0; k < 3; ++k)
            if (std::abs(axis[k]) < std::cos(rad_from_deg(kNearAxis_deg)))
                missing += (missing.empty() ? "" : " and ") + std::string(names[k]);
        std::string choice = missing;
        for (size_t at = choice.find(" and "); at != std::string::npos; at = choice.find(" and ", at))
            choice.replace(at, 5, " or ");
        words.push_back(
            Text("the poses turn about the flange's {} axis only, all poses share one orientation "
                 "about {}: rotate about {} by "
                 "20 degrees or more",
                 axis_name(axis), missing, choice));
    }
    // Where the sphere stands in the sensor frame: a point or a line leaves rotations about it free.
    if (centres.size() >= 2) {
        Eigen::Vector3d mean = Eigen::Vector3d::Zero();
        for (const auto& c : centres) mean += c;
        mean /= static_cast<double>(centres.size());
        Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
        for (const auto& c : centres) scatter += (c - mean) * (c - mean).transpose();
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(scatter /
                                                                   static_cast<double>(centres.size()));
        const double wide = std::sqrt(std::max(0.0, eigen.eigenvalues()[2]));
        const double second = std::sqrt(std::max(0.0, eigen.eigenvalues()[1]));
        constexpr double kOnePlace_mm = 0.5;  // spread of the sphere's places, below
        if (wide < kOnePlace_mm)
            words.push_back(
                "the sphere stands at the same place in every profile: let it appear left and right, near "
                "and far, and cut "
                "it before and behind its middle");
        else if (second < kOnePlace_mm)
            words.push_back(
                Text("the sphere's places in the sensor frame lie on one line along {}: shift it "
                     "across that line by "
                     "half the field of view",
                     axis_name(eigen.eigenvectors().col(2))));
    }
    constexpr double kCutsAlike = 0.1;
    if (radius_free && largest_cut - smallest_cut < kCutsAlike * largest_cut)
        words.push_back(
            "all profiles cut the sphere at about the same height, which leaves its radius free: give the "
            "radius, or cut the "
            "sphere near its middle and near its rim");
    return words;
}

std::vector<PoseProposal> propose_poses(const std::vector<Section>& sections, const Model& model,
                                        const Matrix10& information,
                                        const Eigen::Vector3d& working_point_sensor, bool radius_free,
                                        double sigma_mm, int count) {
    std::vector<PoseProposal> proposals;
    std::vector<const Section*> used;
    double points = 0, side = 0;
    Eigen::Vector3d low = working_point_sensor, high = working_point_sensor;
    for (const auto& section : sections) {
        if (!section.used) continue;
        used.push_back(&section);
        points += section.count();
        side += section.circle.mean_side;
        const Eigen::Vector3d s = centre_in_sensor(section, model);
        low = low.cwiseMin(s);
        high = high.cwiseMax(s);
    }
    if (used.empty()) return proposals;
    const int arc_points = static_cast<int>(points / static_cast<double>(used.size()));
    const double arc_side = side < 0 ? -1 : 1;
    // The reference view is the used one that is nearest to the middle orientation.
    std::vector<Pose> poses;
    for (const auto* section : used) poses.push_back(section->flange_from_base.inverse());
    size_t middle = 0;
    double least = std::numeric_limits<double>::infinity();
    for (size_t i = 0; i < poses.size(); ++i) {
        double sum = 0;
        for (const auto& other : poses) sum += angle_rad(poses[i], other);
        if (sum < least) {
            least = sum;
            middle = i;
        }
    }
    const Eigen::Matrix3d base_from_sensor = poses[middle].linear() * model.flange_from_sensor.linear();

    struct Turn {
        Eigen::Vector3d axis;
        const char* name;
    };
    static const Turn turns[] = {
        {Eigen::Vector3d::UnitX(), "X"}, {Eigen::Vector3d::UnitY(), "Y"}, {Eigen::Vector3d::UnitZ(), "Z"}};
    const double aside = std::max(0.5 * (high.x() - low.x()), model.radius);
    const double nearer = std::max(0.5 * (high.z() - low.z()), model.radius);
    const struct {
        Eigen::Vector3d shift;
        const char* words;
    } places[] = {
        {{0, 0, 0}, "the sphere in the middle of the view"},
        {{aside, 0, 0}, "the sphere towards +x in the view"},
        {{-aside, 0, 0}, "the sphere towards -x in the view"},
        {{0, 0, nearer}, "the sphere at greater z in the view"},
        {{0, 0, -nearer}, "the sphere at smaller z in the view"},
        {{0, 0.5 * model.radius, 0}, "the laser cutting it half a radius off its middle"},
        {{0, -0.5 * model.radius, 0}, "the laser cutting it half a radius off its middle on the other side"}};
    struct View {
        Text words;
        Section section;
        Matrix10 information;
    };
    std::vector<View> views;
    const auto add = [&](const Eigen::Matrix3d& rotation, const Text& turn) {
        for (const auto& place : places) {
            const Eigen::Vector3d s =
                Eigen::Vector3d(working_point_sensor.x(), 0, working_point_sensor.z()) + place.shift;
            const Pose pose =
                make_pose(rotation, model.centre_base - rotation * s) * model.flange_from_sensor.inverse();
            View view{Text("{}, with {}", turn, Text(place.words)), {}, {}};
            view.section.flange_from_base = pose.inverse();
            view.information = information_of_view(view.section, model, arc_points, arc_side);
            views.push_back(std::move(view));
        }
    };
    add(base_from_sensor, "keep the orientation");
    for (const auto& turn : turns)
        for (const double angle_deg : {kProposedTurn_deg, -kProposedTurn_deg})
            add(base_from_sensor * rotation_exp(turn.axis * rad_from_deg(angle_deg)),
                Text("turn the sensor about its own {} axis by {:+.0f} degrees", turn.name, angle_deg));

    Matrix10 known = information;
    for (int k = 0; k < count; ++k) {
        // A direction without any information stays infinite until the last one is gone: compare the sum of
        // the regularised variances, which falls with every direction that a view makes known.
        const auto worth = [&](const Matrix10& total) {
            const Matrix10 basis = scaled_basis(model, working_point_sensor);
            Matrix10 scaled = basis.transpose() * total * basis;
            if (!radius_free) scaled(9, 9) += kGivenRadius;
            scaled.diagonal().array() += kEveryDirection;
            return inverse_matrix(scaled).trace();
        };
        const View* best = nullptr;
        double best_worth = std::numeric_limits<double>::infinity();
        for (const auto& view : views) {
            const double value = worth(known + view.information);
            if (value < best_worth) {
                best_worth = value;
                best = &view;
            }
        }
        if (best == nullptr) break;
        known += best->information;
        proposals.push_back(
            {best->words, best->section.flange_from_base.inverse(),
             sigma_mm * determination(known, model, working_point_sensor, radius_free).weakest});
    }
    return proposals;
}

}  // namespace seamwright::tcp_sphere
