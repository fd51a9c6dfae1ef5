#include "core/elastic/modes.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <set>

#include "core/elastic/elastic_system.h"
#include "core/geometry/notation.h"

namespace seamwright {

namespace elastic {

std::vector<int> slots_of(std::span<const ElasticSpot> spots, std::span<const SpotObservation> observations) {
    std::vector<int> out;
    for (const SpotObservation& o : observations) {
        const auto at = std::ranges::find(spots, o.id, &ElasticSpot::id);
        out.push_back(at == spots.end() ? -1 : static_cast<int>(at - spots.begin()));
    }
    return out;
}

ShapeInformation shape_information(std::size_t slots, std::span<const int> slot_of,
                                   std::span<const SpotObservation> observations,
                                   const CorrectionOptions& options, const Displacement& displacement,
                                   const std::vector<bool>& used) {
    using namespace correction;
    RegionSystem system;
    system.load(observations, options, false);
    State state;
    const Pose& d = displacement.workobject_from_movedworkobject;
    state.rotation = d.linear();
    state.translation = d.translation();
    const KukaAbc angles = kuka_from_rotation(d.linear());
    state.abc =
        Eigen::Vector3d(rad_from_deg(angles.a_deg), rad_from_deg(angles.b_deg), rad_from_deg(angles.c_deg));
    const Matrix6 xi_from_free = system.xi_from_parameters(state);
    std::vector<int> free;
    for (int i = 0; i < 6; ++i)
        if (options.free[static_cast<std::size_t>(i)]) free.push_back(i);
    Linearization lin;
    Shared shared;
    if (system.shares()) {
        std::vector<double> factor;
        for (const bool u : used) factor.push_back(u ? 1 : 0);
        system.linearize_shared(state, factor, lin, shared);
    }
    const auto dim = static_cast<Eigen::Index>(3 * slots);
    const auto motions = static_cast<Eigen::Index>(free.size());
    const auto nuisances = static_cast<Eigen::Index>(kShared * shared.sensors.size());
    Eigen::MatrixXd tangent(6, motions);
    for (Eigen::Index f = 0; f < motions; ++f)
        tangent.col(f) =
            system.tangent_from_xi(Vector6(xi_from_free.col(free[static_cast<std::size_t>(f)])), state);
    ShapeInformation out;
    out.measured = Eigen::VectorXd::Zero(dim);
    out.seen.assign(slots, Eigen::Matrix3d::Zero());
    Eigen::MatrixXd moves = Eigen::MatrixXd::Zero(dim, motions + nuisances);
    Eigen::MatrixXd blocks = Eigen::MatrixXd::Zero(dim, dim);
    int observed = 0;
    for (std::size_t n = 0; n < observations.size(); ++n) {
        if (slot_of[n] < 0 || !used[n]) continue;
        const Eigen::Index row = 3 * slot_of[n];
        const PreparedSpot& s = system.spot(n);
        Eigen::Vector3d e;
        Rows rows;
        system.residual(n, state, e, rows);
        const Eigen::Matrix3d axes = observations[n].workobject_from_sensor.linear();
        const Eigen::Matrix3d back = -axes * s.shape;  // u from the residual as it is scaled
        Eigen::Vector3d mask = Eigen::Vector3d::Zero();
        for (int i = 0; i < 3; ++i)
            if (observations[n].weights[i] > 0) mask[i] = 1;
        e = e.cwiseProduct(mask);
        const Eigen::Matrix3d whiten = s.shape.inverse() * axes.transpose();
        const Eigen::Matrix3d l = whiten.transpose() * mask.asDiagonal() * whiten / (s.sigma * s.sigma);
        out.measured.segment<3>(row) = back * e;
        out.seen[static_cast<std::size_t>(slot_of[n])] = l;
        blocks.block<3, 3>(row, row) = l;
        // As it moves the taught part, so that what no row tells is the same for all displacements.
        const Eigen::Vector3d place = observations[n].workobject_from_sensor * observations[n].reference_mm;
        Eigen::Matrix<double, 3, 6> moved;
        moved << Eigen::Matrix3d::Identity(), -skew(state.rotation * place);
        moves.block(row, 0, 3, motions) = -state.rotation.transpose() * moved * tangent;
        if (nuisances > 0 && s.sensor >= 0)
            moves.block<3, kShared>(row, motions + kShared * s.sensor) =
                back * shared.spots[n].columns.transpose();
        observed += s.observed;
    }
    out.motions = moves;
    out.shared = static_cast<int>(nuisances);
    const Eigen::MatrixXd heavy = blocks * moves;
    Eigen::MatrixXd inner = moves.transpose() * heavy;
    inner.diagonal().tail(nuisances).array() += 1;
    out.rank = std::max(0, observed - static_cast<int>(motions));
    constexpr double kSingular = 1e-14;  // reciprocal condition
    const Eigen::LDLT<Eigen::MatrixXd> factorised(inner);
    out.regular =
        factorised.info() == Eigen::Success && factorised.isPositive() && factorised.rcond() > kSingular;
    if (!out.regular) return out;
    const Eigen::MatrixXd gain = factorised.solve(heavy.transpose());
    out.information = blocks - heavy * gain;
    out.information = (0.5 * (out.information + out.information.transpose())).eval();
    // y changes by moves * theta, so that D gives way by gain * u where u is taken off.
    out.rigid_from_shape = tangent * gain.topRows(motions);
    return out;
}

}  // namespace elastic

Expected<ElasticRow> elastic_row(std::span<const ElasticSpot> spots,
                                 std::span<const SpotObservation> observations,
                                 const CorrectionOptions& options, const Displacement& displacement) {
    SEAM_OK(correction::check_region(observations, options, true));
    const std::vector<int> slot_of = elastic::slots_of(spots, observations);
    for (std::size_t n = 0; n < slot_of.size(); ++n)
        if (slot_of[n] < 0)
            return input_error(Text("spot {} is none of those that are learnt from", observations[n].id),
                               "elastic part");
    const elastic::ShapeInformation seen =
        elastic::shape_information(spots.size(), slot_of, observations, options, displacement,
                                   std::vector<bool>(observations.size(), true));
    if (!seen.regular || seen.rank < 1)
        return input_error("the measured spots are too few to tell a shape from a motion", "elastic part",
                           "measure more spots of the region");
    ElasticRow row;
    row.residual_mm = seen.measured;
    row.seen = seen.seen;
    row.motions = seen.motions;
    row.shared = seen.shared;
    return row;
}

Expected<void> check_modes(const ElasticModes& modes) {
    const auto refuse = [](const Text& what) {
        return input_error(what, "modes of the part", "learn them again");
    };
    std::set<std::string> ids;
    for (const ElasticSpot& s : modes.spots) {
        if (s.id.empty() || !ids.insert(s.id).second) return refuse("two spots of the modes have one name");
        if (!(s.noise_factor > 0) || !std::isfinite(s.noise_factor))
            return refuse("the noise that was left when learning is no positive number");
        if (!s.workobject_from_sensor.matrix().allFinite() || !s.reference_mm.allFinite() ||
            !s.weights.allFinite() || !s.seen.allFinite() || !s.common_mm.allFinite())
            return refuse("a spot of the modes holds a number that is not finite");
    }
    if (!(modes.noise_factor > 0) || !std::isfinite(modes.noise_factor))
        return refuse("the noise that was left when learning is no positive number");
    for (const ElasticMode& m : modes.modes) {
        if (m.shape.size() != modes.spots.size())
            return refuse("a mode has another number of spots than were learnt");
        const bool finite = std::isfinite(m.variance_mm2) && std::isfinite(m.mean_mm) &&
                            std::isfinite(m.lowest_mm) && std::isfinite(m.highest_mm) &&
                            std::ranges::all_of(m.shape, [](const auto& v) { return v.allFinite(); });
        if (!finite || !(m.variance_mm2 > 0) || m.lowest_mm > m.highest_mm)
            return refuse("a mode holds numbers that are no shape, variance or range");
    }
    return {};
}

}  // namespace seamwright
