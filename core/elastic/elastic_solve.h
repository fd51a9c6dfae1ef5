#pragma once
// A region's displacement together with the amplitudes of its modes (modes.h): the region solve with j more
// unknowns, prior N(mean, lambda).
//
// Solution. With M the information that is left of the measures when the rigid motion and what the sensors
// share are eliminated, at D:
//     (Phi^T M Phi + Lambda^-1) a = Phi^T M (y - common) + Lambda^-1 a_0;
// the measures are freed of u = Phi a + common along the directions they tell, and solve_region() finds D from
// them, with its limits, sensors and tests; again until a stands. This is the joint solution: M has no part
// along the rigid motion. Covariance, tangent of pose.h then amplitudes (mm):
//     C_aa = (Phi^T M Phi + Lambda^-1)^-1,  K = (G^T L G)^-1 G^T L Phi,  C_xa = K C_aa,  C_xx = C_rigid + K C_aa K^T.
// Sigmas are the stated ones, times the spot's factor as learnt where that is more than 1.
//
// When the modes act. Only where all of this holds; else the rigid answer stands, bit for bit, and `why` says:
//   - every measured spot is one that was learnt, as it was taught then;
//   - the joint solution is found, and the spots are more than the unknowns of D;
//   - what is left fits: chi-square of residual and amplitudes with rank(M) degrees of freedom, probability
//     not below `fit_significance`. One spot may be left out as wrong, and is named. A shape that was not
//     learnt is noticed so;
//   - every amplitude lies within the learnt range, widened by sqrt(lambda) at both ends;
//   - what is added at a spot stays below `most_added_mm`.

#include "core/elastic/modes.h"

namespace seamwright {

struct ElasticOptions {
    double fit_significance = 1e-3;
    double most_added_mm = 1;
};

struct ElasticAmplitude {
    double value_mm = 0, sigma_mm = 0;
    bool learnt = true;  // within the learnt range
};

struct ElasticCorrection {
    RegionCorrection correction;  // of the joint solution when the modes acted, else the rigid one
    bool acted = false;
    Text why;  // not acted: the reason; empty when there are no modes
    // As found, also when they did not act (then for people alone); empty where they could not be found.
    std::vector<ElasticAmplitude> amplitudes;
    double largest_added_mm = 0;  // at a spot, from the modes alone
    double chi_square = 0, probability = 1;
    int degrees = 0;
    bool shape_fits = true;
    Eigen::MatrixXd covariance;  // (6 + modes)^2; empty when not acted
};

// With no modes: solve_region(), bit for bit. Error: as solve_region and check_modes.
Expected<ElasticCorrection> solve_elastic(std::span<const SpotObservation> spots,
                                          const CorrectionOptions& options, const ElasticModes& modes,
                                          const ElasticOptions& elastic = {});

}  // namespace seamwright
