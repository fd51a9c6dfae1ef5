// The normal equations and the covariance of a measurement to come.

#include <algorithm>

#include "core/correction/predicted.h"
#include "core/correction/region_system.h"
#include "core/correction/travel.h"
#include "core/geometry/notation.h"

namespace seamwright {

namespace correction {

Predicted predict(std::span<const SpotObservation> spots, const CorrectionOptions& options,
                  const Displacement& displacement) {
    Predicted out;
    const Pose& d = displacement.workobject_from_movedworkobject;
    out.state.rotation = d.linear();
    out.state.translation = d.translation();
    const KukaAbc abc = kuka_from_rotation(d.linear());
    out.state.abc = rad_from_deg(1) * Eigen::Vector3d(abc.a_deg, abc.b_deg, abc.c_deg);
    out.factor.assign(spots.size(), 1.0);
    const bool drifts = std::any_of(options.sensors.begin(), options.sensors.end(),
                                    [](const SensorPrior& p) { return !p.drift_sigma_mm.isZero(0); });
    if (d.matrix().isIdentity(0) && !drifts) {
        out.system.load(spots, options, true);
        out.system.linearize(out.state, out.factor, out.lin);
    } else {
        std::vector<SpotObservation> moved(spots.begin(), spots.end());
        for (SpotObservation& s : moved) s.measured_mm = displaced_measure(s, displacement);
        out.system.load(moved, options, false);
        if (out.system.shares())
            out.system.linearize_shared(out.state, out.factor, out.lin, out.shared);
        else
            out.system.linearize(out.state, out.factor, out.lin);
    }
    out.spread = out.system.spread(out.lin, out.state);
    return out;
}

}  // namespace correction

Expected<PredictedCovariance> predicted_covariance(std::span<const SpotObservation> spots,
                                                   const CorrectionOptions& options,
                                                   const Displacement& displacement) {
    using namespace correction;
    SEAM_OK(check_region(spots, options, false));
    const Predicted p = predict(spots, options, displacement);
    const RegionSystem::Parts parts = p.system.parts(p.shared, p.state, p.factor, p.spread);
    RegionPlan out;
    report_spread(p.system, p.spread, p.system.observability(p.lin, p.state), p.state, &parts, out);
    return PredictedCovariance{out.covariance, out.covariance_random, out.covariance_systematic};
}

}  // namespace seamwright
