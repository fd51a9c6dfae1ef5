#pragma once
// From observations to a calibrated stripe camera, step by step. Private to core/calibration/stripe: the start with the robot is
// stripe_camera_robot.cpp, the stripes on the plate stripe_camera_laser.cpp, what is answered stripe_camera_result.cpp.

#include <string>
#include <vector>

#include "core/calibration/stripe/stripe_camera.h"
#include "core/calibration/stripe/stripe_line.h"
#include "core/calibration/stripe/stripe_move.h"

namespace seamwright::detail {

inline constexpr double kOnPlaneMm = 0.5;

class StripeCameraSolver {
  public:
    StripeCameraSolver(const std::vector<StripeObservation>& observations, const BoardSpec& spec,
                       const StripeCameraOptions& options)
        : observations_(observations), spec_(spec), options_(options) {}

    Expected<StripeCameraResult> run();

  private:
    struct Model {
        CameraFreedom freedom;
        ShapeFreedom shape;
    };
    static const std::vector<Model>& model_ladder();

    std::size_t count() const { return data_.views.size(); }
    bool has_robot() const { return state_.flange_from_camera.has_value(); }

    Expected<void> collect();
    int same_as_earlier(const FoundBoard& board) const;
    Expected<void> start();
    std::vector<double> cross_validate(const Model& model);
    void choose_model();
    void estimate_sigmas(const PlateBundleFit& fit);
    void refine_without_stripe();

    Expected<void> start_robot();
    void resolve_symmetry(const std::vector<std::size_t>& with);
    Expected<void> check_scale_again() const;
    double robot_views() const;
    double robot_freedom() const;
    double robot_student() const;
    void measure_size();
    void estimate_robot_sigmas(const PlateBundleFit& fit);

    void locate_stripes();
    std::vector<Eigen::Vector3d> points_of(std::size_t k, std::size_t choice, bool on_bow) const;
    StripeOff off_plane(std::size_t k, const LaserPlane& plane) const;
    void look_for_move();
    double between_stripes_mm(const LaserPlane& plane) const;
    void refine_with_stripe();

    void measure();
    void measure_corners();
    void measure_robot();
    void measure_stripes();
    void measure_plane();
    void measure_working_point();
    void list_parameters();
    void list_poses();
    Judgement verdict() const;
    double focal_px() const;
    double sigma_focal_px() const;
    std::ptrdiff_t stripes_used() const;
    std::string frames_off_plane() const;
    std::optional<Judgement> undetermined() const;
    std::optional<Judgement> poor(double misfit) const;
    std::optional<Judgement> usable(double misfit) const;
    Judgement good() const;
    Text corners_misfit(double misfit) const;
    Text working_words() const;
    double mean_distance_mm() const;

    const std::vector<StripeObservation>& observations_;
    const BoardSpec& spec_;
    const StripeCameraOptions& options_;
    StripeCameraResult result_;
    CameraData data_;
    std::vector<std::size_t> view_frame_;  // frame of each view
    PlateBundle bundle_;
    PlateBundleState state_;
    PlateBundleFit fit_;
    Model model_;
    std::vector<std::vector<PlateStripe>> lines_;  // per view
    std::vector<std::size_t> choice_;
    std::vector<char>
        one_laser_;  // per view: taken before the laser moved or after, where there are more; all if it did not
    struct Move {
        std::string last_before, first_after;
        double apart_mm = 0;
    };
    std::optional<Move> move_;
    Text robot_note_, robot_cure_ = "turn the robot about two axes by 20 degrees or more";
    bool robot_as_stated_ = false;
};

}  // namespace seamwright::detail
