#pragma once
// Where to put the spots of a region (methods.md 10): those of many candidates that leave the bead best known.
//
// Measured is the deviation across the bead, along normal and binormal at every point of it. A set S of candidates has at
// the displacement D the information M(S) = P + sum over S of J_c^T Sigma_c^-1 J_c, in D and in what the sensors err by
// (correction.h: "What is the same again"), P the prior of the latter; what errs from spot to spot is in Sigma_c, the
// travel of an unsteady trigger included. With a_i the direction i in that space, the set is judged by
//     G(S) = max over displacements and i of 3 sqrt(a_i^T M(S)^-1 a_i)            (G-optimality, a minimax of c-optimality)
// which is three times what predicted_covariance() (forecast.h) says of the bead. Where one spot may be lost, the largest
// G(S without one) is held within the limit too.
//
// Found by a greedy start and Fedorov's exchange (Theory of Optimal Experiments, 1972): one of the set against one of the
// others as long as it gets better; further starts are drawn with the seed. How far that is from the best of all sets is
// bounded from below: over weights xi of the candidates (continuous designs, of which sets of k are some) and weights w of
// the directions, phi_w(xi) = sum w_i a_i^T M(xi)^-1 a_i is convex, so for any xi0 and w
//     min over xi of max_i  >=  phi_w(xi0) + min over xi of grad phi_w(xi0) . (xi - xi0)
// (Kiefer and Wolfowitz's equivalence theorem says that equality is reached); the minimum runs over weights that give no
// place more than 1/k, which every set of k obeys.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/correction/correction.h"

namespace seamwright {

struct PlacingCandidate {
    SpotObservation spot;         // measured_mm is ignored; weights 0 or 1
    double travel_window_mm = 0;  // half of it, as add_travel() takes it
    int place = 0;                // of candidates at one place at most one is taken
};

// Work object, the part as taught; directions of unit length.
struct TaughtBeadPoint {
    Eigen::Vector3d point_mm, normal, binormal;
};

struct PlacingTask {
    std::vector<PlacingCandidate> candidates;
    std::vector<TaughtBeadPoint> bead;
    std::vector<Displacement> displacements{Displacement{}};  // where the bead must be known
    CorrectionOptions options;
    double three_sigma_mm = 0.1;  // across the bead, wanted
    bool one_may_be_lost = true;
    int starts = 0;  // of the exchange, the greedy one among them; 0: 12 for up to 64 candidates, else 3
    std::uint64_t seed = 1;
};

struct PlacedSet {
    std::vector<std::size_t> chosen;  // indices of candidates, in the order of the shortest way
    double three_sigma_mm = 0;        // G; infinite where something is not observed
    double lost_three_sigma_mm = 0;   // with the worst one lost; 0 where that is not asked for
    double way_mm = 0;                // from the first reference to the last
    bool enough = false;              // both within the wanted
};

class SpotPlacing {
  public:
    // Error (input): no candidate, no point of the bead, no displacement, numbers that are none, weights other than 0 and
    // 1, what solve_region refuses of a spot.
    static Expected<SpotPlacing> make(PlacingTask task);
    SpotPlacing(SpotPlacing&&) noexcept;
    SpotPlacing& operator=(SpotPlacing&&) noexcept;
    ~SpotPlacing();

    // A set as it is; ordered as given. For ghosts that are dragged: well under a millisecond.
    PlacedSet judge(std::span<const std::size_t> chosen) const;
    // G at every point of the bead (the worse of normal and binormal), mm.
    std::vector<double> along_bead(std::span<const std::size_t> chosen) const;
    // The best set of k found. Precondition: 1 <= k <= number of places.
    PlacedSet best(int k) const;
    // The fewest from `fewest` to `most` that are enough, then the shortest way that still is; where none are, the best of
    // `most`.
    PlacedSet propose(int fewest, int most) const;
    // No set of k has a smaller G.
    double bound_mm(int k) const;
    int places() const;

    struct Impl;

  private:
    explicit SpotPlacing(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

// Order of points for a short open way (nearest neighbour from every start, then 2-opt), and its length.
std::vector<std::size_t> short_way(std::span<const Eigen::Vector3d> points_mm, double& length_mm);

}  // namespace seamwright
