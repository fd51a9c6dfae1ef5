#pragma once
// Straight line through points of a contour, robust, with the uncertainty of every place on it.

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/features/contour/contour_noise.h"

namespace seamwright {

// Noise model: equal, across the line; what neighbours share widens the variances (contour_noise.h). `ok` is false for fewer than 3 points or no extent.
struct LineFit {
    bool ok = false;
    Eigen::Vector2d centre = Eigen::Vector2d::Zero();      // weighted mean of the used points
    Eigen::Vector2d direction = Eigen::Vector2d::UnitX();  // unit, from the first towards the last point
    double sigma_mm = 0;  // noise of one point across, from the residuals and what is known of the profile's
    double rms_mm = 0;
    double widening = 1;               // of variances, for sigma being estimated from few points
    double alike = 1;                  // of variances, for neighbours that share their noise
    int used = 0;                      // points within 3.5 sigma
    double first_mm = 0, last_mm = 0;  // extent of the used points along the line, from the centre
    double spread_mm2 = 0;             // sum of squared distances from the centre along the line
    double length_mm() const { return last_mm - first_mm; }
    // Variance across the line at `s` along it from the centre.
    double variance_at(double s) const {
        return widening * alike * sigma_mm * sigma_mm * (1.0 / used + s * s / spread_mm2);
    }
    double angle_variance() const { return widening * alike * sigma_mm * sigma_mm / spread_mm2; }  // rad^2
    double distance(const Eigen::Vector2d& p) const {  // signed, positive left of the direction
        const Eigen::Vector2d d = p - centre;
        return direction.x() * d.y() - direction.y() * d.x();
    }
};

struct LineWorkspace {
    std::vector<double> sizes;
    std::vector<std::uint8_t> keep;
    ProfileNoise noise;  // of the profile, where the caller knows it
};

// Total least squares with reweighting: the start is a RANSAC over fixed pairs when less than the whole set
// agrees with the first line, then the points within 3.5 robust sigma (median) are fitted until the set
// stands still. Withstands 40 % of points that do not belong to the line.
LineFit fit_line(std::span<const double> x, std::span<const double> z, LineWorkspace& workspace);

}  // namespace seamwright
