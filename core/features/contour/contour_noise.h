#pragma once
// The noise of a contour's points: how large it is, and how far neighbours share it.

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace seamwright {

// Noise of a single point across the contour, 1 sigma, from fourth differences (1, -4, 6, -4, 1) / sqrt(70)
// projected on the local normal: shape up to the third order cancels; the median makes it blind to corners
// and outliers. 0 when fewer than 8 differences exist. `x`, `z` finite, in contour order.
// A sensor may measure coarser than the even grid that it delivers. What it interpolated runs from line to line, so that
// neighbours hide their noise: there it is taken from points three lines apart.
struct ContourNoise {
    double point_mm = 0;
    // Of the points that were measured, in lines of the grid; 0: nothing says that they were others than these.
    double measured_apart = 0;
    // How surely straight lines were drawn between these points, 0 to 1, rather than means taken of neighbours: behind what was
    // measured last an interpolation has nothing, a mean still has its lines.
    double drawn = 0;
    double rounding_mm = 0;  // the step of the heights (z_rounding_mm)
    // The variance of rounded heights that the residuals of a fit do not show: on a level sheet all points are rounded alike.
    double shared_rounding_mm2(double rms_mm) const;
};
ContourNoise contour_noise(std::span<const double> x, std::span<const double> z,
                           std::vector<double>& scratch);
double contour_noise_mm(std::span<const double> x, std::span<const double> z, std::vector<double>& scratch);

// Neighbours share their noise where a sensor smooths along its line, where a grid was interpolated from coarser points, on a
// rough surface whose speckle is wider than a point. They know less than their number says.
//
// From the whole profile: V(s), the square of the noise by fourth differences of points s lines apart, is
//   V(s) = V (1 - 1.6 r(s) + 0.8 r(2 s) - 0.23 r(3 s) + 0.03 r(4 s))
// for noise whose neighbours at lag s correlate by r(s). Where V(s) no longer grows r is 0, and from there the r of the
// smaller lags follow one by one. Of a mean of w lines V stands still between w / 3 and w / 2 as well, at a fifth of what it
// is from w on: where V has risen up to three times a level's lag, a later level counts, or in short profiles the last lag.
// Shape that is not cubic over 4 s lines grows with s^8, by more than eight times, and has no level: then nothing is known
// (`points` 0), as with fewer than a hundred points.
struct ProfileNoise : ContourNoise {
    static constexpr std::size_t kLags = 24;
    std::array<double, kLags> r{};  // at lag 1, 2, ..
    double points = 0;              // of a fit, that know r as well
    double alone_mm = 0;            // of a point, none of it hidden by neighbours that share it; 0: not known
    // 1 + 2 (r_1 + ..), of what stands out of chance: of a mean, so many lines count as one.
    double apart() const;
};
// How many lines may share it: a level is looked for up to lag 7, or up to 24.
enum class SharedOver { few, many };
ProfileNoise profile_noise(std::span<const double> x, std::span<const double> z, std::vector<double>& scratch,
                           SharedOver over = SharedOver::few);

// Factor of the variances that a least-squares fit of `unknowns` parameters states for independent points, from its
// residuals in contour order and from what the profile knows beside them:
//   c (n - u) / (n - u min(c, n / 2 u)),  c = 1 + 2 (r_1 + .. + r_k),  r_j the correlation at lag j
// (the long-run variance over that of a point; the fraction is what the fit itself takes of such residuals). A lag counts as
// long as it and all below it stand out of chance, 1.5 / sqrt(n), at most twelve and n / 4 of them; a fit shortens each r_j by
// about u c / n, which is given back with the profile's c. The larger c of the residuals alone and of both together; at least 1,
// and n / u is the most that they can tell. Fewer than eight residuals, and none known: 1.
// A shape that the fit does not have leaves such residuals as well, and widens alike.
double alike_widening(std::span<const double> residuals, int unknowns, const ProfileNoise& profile = {});

// Few points know their own noise badly, and rounded to a sensor's steps they may all lie on the fit: the profile's noise
// counts beside them as four points would, and never makes sigma smaller.
struct PooledSigma {
    double sigma_mm;  // of one point
    double widening;  // of variances, for sigma being estimated: errors over it are Student's
};
PooledSigma pooled_sigma(double sigma_mm, int freedom, const ProfileNoise& profile);

}  // namespace seamwright
