#pragma once
// Finding spots whose measure is wrong (foreign particle, wrong feature): data snooping with an exhaustive
// search.

#include <span>
#include <vector>

#include "core/correction/region_system.h"

namespace seamwright::correction {

// A sum of squares less probable than this is beyond chance.
inline constexpr double kGlobalDisagreement = 1e-4;

// How well the used spots agree with each other at a fit.
struct Agreement {
    double smallest_p =
        1;  // of the studentised spot residuals, chi-square with the spot's redundant directions
    bool plausible = true;   // the sum of squares, chi-square with `redundancy`, is not beyond chance
    double sum_squares = 0;  // of residual / sigma over observed coordinates
    int observed = 0, redundancy = 0;
};

// sum_squares is chi-square with `redundancy` degrees when all weights are 0 or 1, near it otherwise. A smallest_p of at
// least `enough` need not be told: it may come out larger.
Agreement agreement(const RegionSystem& system, const RegionSystem::Fit& fit, const Spread& spread,
                    std::span<const double> factor, double enough = 1);

enum class Verdict {
    agree,         // nothing wrong beyond chance
    found,         // `factor` has 0 at the spots left out; `fit` is without them
    noisy,         // found, or nothing to find, but the others scatter beyond their stated sigma
    contradictory  // something is wrong and cannot be told apart; `fit` is with all spots
};

class WrongSpotSearch {
  public:
    // `fit` and `factor` (all 1) describe the fit with all spots; both are replaced when spots are left
    // out. `all` is the agreement of that fit; `taught` the same spots as they were taught, which those kept
    // must be enough of.
    Verdict run(const RegionSystem& system, const RegionSystem& taught, double significance,
                const Agreement& all, RegionSystem::Fit& fit, std::vector<double>& factor);

  private:
    struct Candidate {
        std::vector<std::size_t> out;
        double sum_squares = 0;
    };
    bool explain(const RegionSystem& system, const RegionSystem& taught, std::size_t count, double level,
                 std::vector<double>& factor, RegionSystem::Fit& fit, bool& tied);
    bool graduated(const RegionSystem& system, const RegionSystem& taught, double level,
                   std::vector<double>& factor, RegionSystem::Fit& fit);
    bool stands_out(const RegionSystem& system, const RegionSystem& taught, double level,
                    std::vector<double>& factor, RegionSystem::Fit& fit);
    std::vector<double> trial_;
    std::vector<double> soft_;
};

// p-value of `value` under chi-square with `degrees`.
double chi_square_p(double value, int degrees);

}  // namespace seamwright::correction
