#pragma once
// The modes between the spots: how the bead moves where nothing is measured, and how well that is known.
//
// Interpolation. A mode along the bead is a Gaussian process with the rigid motions as its trend (universal
// kriging), since a mode is known up to a rigid motion only, which D takes up:
//     phi(s) = G(p(s)) rho + f(s),   rho flat,   f ~ GP(0, tau^2 k(d / l) 1),   k Matern 5/2,
// observed at the spots along the directions that their cuts tell, with the noise that learning left. d is
// the distance along the arc (round a closed bead: the chord of the circle of its length) or in space; which
// of the two, l and tau are not chosen but averaged over, each with its restricted likelihood (flat over a
// logarithmic grid), so that sigma holds what is not known of them. Sigma is 0 at no place: it is smallest at the
// spots and grows between them, and across a gap of spots.
//
// Turning and shifting the work object turns and shifts the answer (G holds all rigid motions, the three
// coordinates have one kernel).

#include <memory>

#include "core/elastic/elastic_solve.h"

namespace seamwright {

struct BeadPlace {
    Eigen::Vector3d place_mm = Eigen::Vector3d::Zero();  // work object, as taught
    double arc_mm = 0;
};

struct BeadArc {
    bool known = false;           // else arc_mm is not looked at: distances in space alone
    double closed_length_mm = 0;  // 0: open
};

// A mode at one place, mm per mm.
struct ShapeAt {
    Eigen::Vector3d shape = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

class BeadShape {
  public:
    // `spots` in the order of modes.spots: where they lie on the bead. Error (input): sizes, not finite, too
    // few spots to tell a mode (7 observed coordinates).
    static Expected<BeadShape> make(const ElasticModes& modes, std::span<const BeadPlace> spots,
                                    const BeadArc& arc);
    BeadShape(BeadShape&&) noexcept;
    BeadShape& operator=(BeadShape&&) noexcept;
    ~BeadShape();

    std::vector<ShapeAt> at(const BeadPlace& place) const;  // of each mode
    double arc_share() const;  // of the likelihood: distance along the arc against in space

  private:
    struct Impl;
    explicit BeadShape(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

// A point of the bead after correction, work object.
struct BeadPoint {
    Eigen::Vector3d added_mm = Eigen::Vector3d::Zero();        // u, as taught: the modes' part
    Eigen::Vector3d place_mm = Eigen::Vector3d::Zero();        // D (p + u)
    Eigen::Matrix3d covariance_mm2 = Eigen::Matrix3d::Zero();  // pose, amplitudes and interpolation
};
// `shape` is used where the modes acted; else the point moves with D alone, as correct_path() moves it.
BeadPoint bead_point(const ElasticCorrection& correction, const BeadShape& shape, const BeadPlace& place);

}  // namespace seamwright
