#pragma once
// Whether the stripes of frames that were taken one after another are one plane's. Private to core/calibration/stripe.
//
// Of each frame two numbers: how far its rows lie off a plane in the mean, and by how much more at the rms of their spread
// along the stripe. Neighbouring rows share speckle and the plate's pose, so a frame counts once, whatever its rows: the
// noise of both is that of the rows and of the plate's pose, and a variance between frames comes on top, as large as the
// frames contradict one another.

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace seamwright::detail {

struct StripeOff {
    Eigen::Vector2d off_mm = Eigen::Vector2d::Zero();
    Eigen::Matrix<double, 2, 3> by_plane =
        Eigen::Matrix<double, 2, 3>::Zero();  // two tilts (rad), offset (mm)
    Eigen::Matrix2d noise_mm2 = Eigen::Matrix2d::Identity();
};

// Standard deviation between frames, beyond the stated noise; zero where one plane explains them or for fewer than three.
double between_frames_mm(const std::vector<StripeOff>& frames);

// The laser was moved against the camera: a plane each before and after explains the frames where one does not (F, chance
// below one in a thousand over all breaks), at least three frames on either side, and no single frame left out does as well.
struct LaserMove {
    std::size_t first_after = 0;
    double apart_mm = 0;  // rms distance of the two planes over the frames' stripes; from 0.1 mm on
};
std::optional<LaserMove> find_move(const std::vector<StripeOff>& frames);

}  // namespace seamwright::detail
