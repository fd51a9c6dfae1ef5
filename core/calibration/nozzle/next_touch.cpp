#include "core/calibration/nozzle/next_touch.h"

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>

#include "core/calibration/pose_set.h"

namespace seamwright::nozzle {
namespace {

constexpr double kTurn_deg = 30;
constexpr double kLeastInformation = 1e-12;  // 1/mm^2, of a direction that no touch tells
// What leaving open which of two places the tip has costs, over how far apart a touch sees them and at least this.
constexpr double kOpenChoice_mm3 = 1e3, kLeastTold_mm = 1e-3;
// Of what the best so far leaves: what a turn, and another side alone, must bring it to.
constexpr double kTurnPays = 0.98, kSidePays = 0.999;

struct Side {
    Eigen::Vector3d normal;  // base, from the sphere's centre to the tip
    Text words;
};

std::vector<Side> sides() {
    return {{{0, 0, 1}, "from above (Z of the base)"},
            {{1, 0, 0}, "on its side towards X of the base"},
            {{-1, 0, 0}, "on its side towards -X of the base"},
            {{0, 1, 0}, "on its side towards Y of the base"},
            {{0, -1, 0}, "on its side towards -Y of the base"}};
}

double worst_variance(const Eigen::Matrix3d& information) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(information, Eigen::EigenvaluesOnly);
    return 1 / std::max(eigen.eigenvalues()[0], kLeastInformation);
}

}  // namespace

Text next_touch(const TouchSet& set, const TouchFit& fit) {
    if (set.poses.empty()) return "touch the target";
    const Eigen::Vector3d tip = fit.state.head<3>();
    const Matrix7 so_far = information_at(set, fit.state, fit.variance);
    const Eigen::Matrix3d before = set.poses.front().linear();
    // Against the nearest of the attitudes that were used, each as it is or turned.
    double least = std::numeric_limits<double>::infinity();
    Text best;
    for (int axis = -1; axis < 3; ++axis) {
        Eigen::Matrix3d attitude = before;
        if (axis >= 0)
            attitude = before * rotation_exp(rad_from_deg(kTurn_deg) * Eigen::Vector3d::Unit(axis));
        for (const Side& side : sides()) {
            const Matrix7 more = information_of(set, attitude, side.normal, tip, fit.variance);
            double left = worst_variance(information_of_tip(so_far + more));
            if (fit.other && set.sphere) {
                // A touch that sees both places alike does not choose between them.
                const double apart = std::abs(side.normal.dot(attitude * (*fit.other - tip)));
                left += kOpenChoice_mm3 / std::max(apart, kLeastTold_mm);
            }
            // A turn costs more work than another side.
            if (!(left < least * (axis >= 0 ? kTurnPays : kSidePays))) continue;
            least = left;
            const Text turned("with the flange turned by {:g} degrees about its {}", kTurn_deg,
                              axis >= 0 ? std::string(1, "XYZ"[axis]) : std::string());
            const Text flange = axis >= 0 ? turned : Text("with the flange as it was");
            best = set.sphere ? Text("touch the sphere {}, {}", side.words, flange)
                              : Text("touch the point {}", flange);
        }
    }
    return best;
}

std::vector<Text> open_directions(const TouchFit& fit) {
    std::vector<Text> open;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(fit.information);
    for (int k = 0; k < 3; ++k)
        if (eigen.eigenvalues()[k] < 1 / (kOpen_mm * kOpen_mm))
            open.push_back(Text("the tip along {} of the flange", axis_name(eigen.eigenvectors().col(k))));
    if (open.empty() && fit.other)
        open.push_back(Text("which of two places the tip has, {:.1f} mm apart",
                            (*fit.other - fit.state.head<3>()).norm()));
    return open;
}

}  // namespace seamwright::nozzle
