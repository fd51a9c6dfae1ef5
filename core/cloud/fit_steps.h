#pragma once
// The steps of fit.h, apart from one another.

#include "core/cloud/fit.h"
#include "core/cloud/form_model.h"
#include "core/cloud/refine.h"

namespace seamwright::fitting {

// Of the part's size: where half of the residuals may lie if no limit is given.
inline constexpr double kFormLimit = 0.015;
// What the stated covariance allows is no other place: chi^2 of 6 at 98 %.
inline constexpr double kNoOtherPlace = 15;
// A point that speaks for a rival weighs against so many that speak for the best.
inline constexpr std::size_t kAgainstRival = 3;
inline constexpr double kSettled_mm = 0.1;  // a motion by the form's model that is not repeated

// The residuals of a pose, point by point: what the form's model and the noise are taken from.
struct Residual {
    Eigen::Vector3d place = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();  // base
    double value_mm = 0, noise_mm2 = 0;  // variance; 0: not stated
};
std::vector<Residual> residuals_of(const Cloud& cloud, const Surface& surface, const Pose& base_from_part,
                                   double gate_mm, bool facing);
// Standard deviation of a point beside its neighbours: the median over cells of some eight points. NaN where no cell has
// three.
double local_noise_mm(const std::vector<Residual>& residuals);
// At most some 180 neighbourhoods of one facing. `noise_mm` where a residual states none.
std::vector<FormNode> form_nodes(const std::vector<Residual>& residuals, const FitSystem& system,
                                 double noise_mm);

// The part's longer axes and its thinnest, in base.
PlateAxes plate_axes(const Surface& surface, const Pose& base_from_part);

// A rigid fit with the form's model about it.
struct Stated {
    Text reason;  // why there is nothing to state; empty where there is
    Pose base_from_part = Pose::Identity();
    Matrix6 motion_covariance = Matrix6::Zero();  // of FitSystem's unknowns
    Matrix6 covariance = Matrix6::Zero(), covariance_noise = Matrix6::Zero();
    double scatter_mm = 0;  // of a point of the cloud beside its neighbours
    double form_mm = 0, form_length_mm = 0;
};
Stated stated(const Cloud& cloud, const Surface& surface, const Refined& rigid, bool facing);

// Starts for rivals of `best`: the same part turned by symmetries, tilted and shifted along its axes. With a start only
// what stays within its tolerance.
std::vector<Pose> rival_starts(const Surface& surface, const Pose& best, const FitOptions& options);
// A sheet's two faces explain a scan of the one alike. The cloud again, each time with `towards` for the faces where it
// lies, but the opposite ones for the points of one facing, of two, or of all: refined with facing, a rival.
std::vector<Cloud> on_other_faces(const Cloud& cloud, const Surface& surface, const Pose& best,
                                  double gate_mm);
bool within_start(const Pose& pose, const Surface& surface, const FitOptions& options);
// What `judges` say of two poses. `form_mm`: what a point may be off anyway. A smaller share of them than `least_share`
// speaks for nothing. `rival_is_better`, if given: they speak as clearly for the rival as told_apart means for the best.
FitRival compare(const Cloud& judges, const Surface& surface, const Pose& best, const Pose& rival,
                 double form_mm, double most_mm, double least_share, bool facing,
                 bool* rival_is_better = nullptr);
// The same of poses that are a sheet's thickness or little apart, without sides. What stands on the seen face - nuts,
// clamps, spatter - is nearer to the pose that lies towards it, so a point speaks only for a pose in which it lies on the
// part, and few only where they miss the other one's ends sideways; that both faces were seen, many must say.
FitRival compare_of_sheet(const Cloud& points, const Surface& surface, const Pose& best, const Pose& rival,
                          double form_mm, bool& rival_is_better);
// The largest distance of a corner of the part's box between two poses.
double corner_distance_mm(const Surface& surface, const Pose& a, const Pose& b);

}  // namespace seamwright::fitting
