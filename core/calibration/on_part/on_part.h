#pragma once
// Where the sensor sits on the flange, and how late its poses are, from passes over an unknown smooth edge of the part:
// finished profiles' feature points and robot poses, little motion, no target and no image.
//
// Unknown: H = flange_from_sensor (6), the latency tau (1), and each edge. Profile k of a pass was stamped t_k and its
// feature point m_k = (x, 0, z) lies on the edge:
//     p_k = F(t_k - tau) H m_k        on the edge, two equations a profile
// F(t) is the pass's own motion, base_from_flange between its profiles (pass_motion.h). tau > 0: the flange was at the
// stamped pose tau seconds before it says so, the profile is older than its stamp.
//
// An edge is a curve over its chord: across the chord two cubic splines of the way along it (edge_curve.h). A straight
// line has 4 unknowns; what bends beyond that is a priori normal with curvature of size kappa, correlated over 100 mm
// of edge. kappa, the pass's own error q and the white noise s are variance components, estimated by the restricted
// likelihood (Patterson and Thompson 1971; for splines Wahba 1985, Wood 2011): roughness by marginal likelihood instead
// of cross validation. A straight edge is kappa = 1e-6 / mm. Neither kappa nor q is taken as known: the answer is the
// mean over their likely values and its covariance holds their scatter (Hoeting 1999), so that an edge which is straight
// as far as the data show is not promised to be.
//
// Noise model. White: each profile's point by its covariance where given, else isotropic, in both cases times an
// estimated scale; neighbours that err alike (Bartlett's sum of correlations) count for less. Common to a pass: the robot
// stands off by a displacement of six at the flange, F Exp(xi), of q mm in each axis and q / 172 mm rad about each (0.01
// degree for 0.03 mm), as given or estimated. Averaging profiles does not make that smaller, only more passes do.
//
// Prior ("after a bump"): an old flange_from_sensor with its covariance. The test against zero asks whether the data
// contradict it: chi squared of six at 99 %, of the data's answer within a blow's reach (20 mm, 6 degrees) against the
// prior, and of the squares that giving up the prior gains; both must say so. Where the data do not, prior and data are
// one answer; where they do, the prior no longer holds and the data alone must determine the answer. Passes that
// determine fewer than three directions cannot tell, and there is no answer: the old place would be handed on unseen.
//
// A latency that no pass shows (travel along a straight edge) stays where it began, within 0.1 s.
//
// Open directions are read from the information matrix of H and tau with all else eliminated, at the place where the
// sensor sees the edge (lever 100 mm): a sigma beyond 2 mm is open. It is named and its cure is the pass, of a list, whose
// information would leave the smallest sigma. Nothing is regularised away. A second place of the sensor that fits as
// well (one straight edge under one attitude has a mirror image) makes the answer undetermined too.
//
// Degenerate: one attitude only (two places fit), attitudes about one axis (shift along it), every pass along the edge
// alone (height, sideways motion). An edge that bends by more than 60 degrees from its chord is refused.

#include <optional>
#include <string>
#include <vector>

#include "core/calibration/calibration.h"
#include "core/calibration/robot_repeatability.h"
#include "core/geometry/pose.h"

namespace seamwright {

struct EdgeProfile {
    double time_s = 0;
    Pose base_from_flange = Pose::Identity();
    Eigen::Vector2d point_mm = Eigen::Vector2d::Zero();        // x, z
    Eigen::Matrix2d covariance_mm2 = Eigen::Matrix2d::Zero();  // zero: not known
};
struct EdgePass {
    std::string id;
    std::string edge;                   // passes over the same edge say the same
    std::vector<EdgeProfile> profiles;  // in the order of time
};

struct MountingPrior {
    Pose flange_from_sensor = Pose::Identity();
    Matrix6 covariance = Matrix6::Zero();  // tangent of pose.h
};

struct OnPartOptions {
    std::optional<MountingPrior> prior;
    std::optional<double> latency_s;          // fixed; absent: solved for
    std::optional<RobotRepeatability> robot;  // of one pass; absent: estimated from how the passes differ
    std::vector<std::string> exclude;         // passes
};

inline constexpr double kOnPartLever_mm = 100;
inline constexpr double kOnPartOpen_mm = 2.0, kOnPartOpen_s = 0.05;     // sigma
inline constexpr double kOnPartGood_mm = 0.15, kOnPartUsable_mm = 0.5;  // 3 sigma where the edge is seen

enum class OnPartStatus { ok, undetermined, not_converged };
std::string_view name_of(OnPartStatus status);

struct PartEdge {
    std::string id;
    bool straight = false;        // as far as the data show
    double curvature_per_mm = 0;  // kappa, of the likeliest
    double length_mm = 0;
    int passes = 0;
    double rms_mm = 0;
};

// The test of the prior against zero.
struct BumpTest {
    double chi_squared = 0, limit = 0;  // at 99 %; wider where the passes' own errors are estimated
    int directions = 0;                 // that the data determine
    bool moved = false;
    double shift_mm = 0,
           turn_deg = 0;  // answer against prior: of the point where the edge is seen, and the turn
};

struct OnPartResult {
    OnPartStatus status = OnPartStatus::undetermined;
    Pose flange_from_sensor = Pose::Identity();
    Matrix6 covariance = Matrix6::Zero();       // tangent of pose.h
    double latency_s = 0, latency_sigma_s = 0;  // sigma 0: given
    bool latency_known = false;                 // given or determined
    double rms_mm = 0;                          // distance of the used profiles' points from their edge
    double noise_mm = 0;                        // white, one axis
    double pass_error_mm = 0;                   // q
    Eigen::Vector2d working_point_mm = Eigen::Vector2d::Zero();  // mean of the points used
    double working_sigma_mm = 0;         // largest sigma of that point in the flange frame
    std::vector<int> left_out_profiles;  // of each pass, found wrong one by one
    std::vector<PartEdge> edges;
    std::optional<BumpTest> bump;
    std::vector<Text> open;    // what is not determined
    std::vector<Text> advice;  // the next pass, best first
    std::vector<Text> notices;
    CalibrationReport report;  // x y z [mm] rx ry rz [deg] latency [ms] (latency only when solved for)
};

// Error (input): no pass, ids twice, times that do not rise within a pass, metres, what is not finite, a covariance
// that is none, an edge that is none. Too little to solve from is an answer, undetermined. Deterministic. About 0.4 s
// for twelve passes of forty profiles.
Expected<OnPartResult> calibrate_on_part(const std::vector<EdgePass>& passes,
                                         const OnPartOptions& options = {});

}  // namespace seamwright
