#pragma once
// How far apart a contour's points are, and what lies between two of them that are farther: a gap, a wall, a step.

#include <cstddef>
#include <span>
#include <vector>

namespace seamwright {

struct ContourPitch {
    double along_x = 0;   // median |dx| of neighbours
    double distance = 0;  // median distance of neighbours
    // Lines that share the noise of a point (ProfileNoise::apart()): a sensor's mean over so many, speckle. 1: its own.
    double shared = 1;
    // A jump seen at one place of the line (a wall or an overhang): far apart, but neighbours in x.
    bool is_wall(double dx, double dz) const;
    // Missing returns, or a jump to another part: nothing is known in between.
    bool is_gap(double dx, double dz) const;
    // A step that is too low for a wall, between neighbours `at` and `at` + 1: more than eight sigma, and level on
    // either side of it, as no flank and no rounded rim is.
    bool is_step(std::span<const double> x, std::span<const double> z, std::size_t at, double sigma_mm) const;
    // How many points from `at` on (one or two) stand in such a step: the light of its edge falls on both sheets, or a
    // resampling has drawn a line between them. They lie on neither. A sensor's mean over m lines makes a ramp of m - 1 of
    // it, between two surfaces that go on alike: straight, whatever the step and however the part is turned.
    int mixed(std::span<const double> x, std::span<const double> z, std::size_t at, double sigma_mm) const;
    // So many points tell as much as one of noise of its own; 1 where an interpolation may be all that they share.
    double alike() const { return shared < kShared ? 1 : shared; }
    // Pitches that two sheets may be apart along x at a step.
    double most_open() const { return most_mixed() + 1.5; }

  private:
    static constexpr double kShared = 2.3;
    int most_mixed() const;
    int drawn_out(std::span<const double> x, std::span<const double> z, std::size_t at,
                  double sigma_mm) const;
    double ramp_misfit(std::span<const double> x, std::span<const double> z, std::size_t a, std::size_t b,
                       double sigma_mm) const;
};
ContourPitch contour_pitch(std::span<const double> x, std::span<const double> z,
                           std::vector<double>& scratch);

}  // namespace seamwright
