#include "core/correction/placing/placing.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <set>

#include "core/correction/placing/placing_impl.h"
#include "core/correction/region_system.h"
#include "core/correction/travel.h"
#include "core/geometry/notation.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

// Holds what is not observed yet to 100 mm, so that a set that is still too small has an order among its like. Against a
// spot's 400 per mm^2 it is nothing.
constexpr double kHoldPerMm2 = 1e-4;
constexpr double kBeyond = 1e6;  // cost of a set that does not hold with one lost
constexpr double kBetter = 1 - 1e-6;
constexpr double kNotUnit = 1e-6;  // what a direction's length may be off 1
constexpr double kByG = 1e-3;      // share of g in that cost: it decides among sets that lose alike
constexpr std::size_t kNobody = static_cast<std::size_t>(-1);

SpotPlacing::Impl::At information_at(const PlacingTask& task, const Displacement& d, int& dof, int& size) {
    using namespace correction;
    std::vector<SpotObservation> moved;
    for (const PlacingCandidate& c : task.candidates) {
        moved.push_back(c.spot);
        moved.back().measured_mm = displaced_measure(c.spot, d);
        add_travel(moved.back(), d, c.travel_window_mm);
    }
    RegionSystem system;
    system.load(moved, task.options, false);
    State state;
    const Pose& pose = d.workobject_from_movedworkobject;
    state.rotation = pose.linear();
    state.translation = pose.translation();
    const KukaAbc abc = kuka_from_rotation(pose.linear());
    state.abc = rad_from_deg(1) * Eigen::Vector3d(abc.a_deg, abc.b_deg, abc.c_deg);
    const std::vector<double> factor(moved.size(), 1.0);
    Linearization lin;
    Shared shared;
    if (system.shares()) system.linearize_shared(state, factor, lin, shared);

    const Matrix6 from_parameters = system.xi_from_parameters(state);
    Eigen::MatrixXd free(6, 0);
    for (int k = 0; k < 6; ++k)
        if (!from_parameters.col(k).isZero(0)) {
            free.conservativeResize(6, free.cols() + 1);
            free.col(free.cols() - 1) = from_parameters.col(k);
        }
    dof = static_cast<int>(free.cols());
    size = dof + kShared * static_cast<int>(shared.sensors.size());

    SpotPlacing::Impl::At out;
    out.prior = Eigen::MatrixXd::Identity(size, size);
    out.prior.topLeftCorner(dof, dof) = kHoldPerMm2 * free.transpose() * free;
    for (std::size_t n = 0; n < moved.size(); ++n) {
        const PreparedSpot& s = system.spot(n);
        Eigen::Vector3d e;
        Rows rows;
        system.residual(n, state, e, rows);
        Eigen::MatrixXd j = Eigen::MatrixXd::Zero(3, size);
        for (int i = 0; i < 3; ++i) {
            if (!(s.weights[i] > 0)) continue;
            j.row(i).head(dof) = rows.row(i) * free / s.sigma;
            if (s.sensor >= 0 && !shared.spots.empty())
                j.row(i).segment(dof + kShared * s.sensor, kShared) =
                    shared.spots[n].columns.col(i).transpose() / s.sigma;
        }
        out.information.push_back(j.transpose() * j);
    }
    Matrix6 tangent;
    for (int k = 0; k < 6; ++k) tangent.col(k) = system.tangent_from_xi(Vector6::Unit(k), state);
    out.bead.resize(static_cast<Eigen::Index>(2 * task.bead.size()), dof);
    for (std::size_t i = 0; i < task.bead.size(); ++i)
        for (int k = 0; k < 2; ++k) {
            const Eigen::Vector3d& direction = k == 0 ? task.bead[i].normal : task.bead[i].binormal;
            Vector6 a;
            a << direction, (state.rotation * task.bead[i].point_mm).cross(direction);
            out.bead.row(static_cast<Eigen::Index>(2 * i) + k) = a.transpose() * tangent * free;
        }
    return out;
}

Expected<void> check(const PlacingTask& task) {
    if (task.candidates.empty()) return input_error("there is no candidate for a spot");
    if (task.bead.empty()) return input_error("there is no point of the bead");
    if (task.displacements.empty()) return input_error("there is no displacement to judge at");
    if (!(task.three_sigma_mm > 0) || !std::isfinite(task.three_sigma_mm))
        return input_error("the wanted 3 sigma is not above 0 mm");
    for (const TaughtBeadPoint& p : task.bead)
        if (!p.point_mm.allFinite() || std::abs(p.normal.norm() - 1) > kNotUnit ||
            std::abs(p.binormal.norm() - 1) > kNotUnit)
            return input_error("a point of the bead is not finite, or a direction there has not length 1");
    for (const PlacingCandidate& c : task.candidates)
        for (int i = 0; i < 3; ++i)
            if (c.spot.weights[i] != 0 && c.spot.weights[i] != 1)
                return input_error("the weights of a candidate are other than 0 and 1", c.spot.id);
    std::vector<SpotObservation> spots;
    for (const PlacingCandidate& c : task.candidates) spots.push_back(c.spot);
    return correction::check_region(spots, task.options, false);
}

}  // namespace

bool SpotPlacing::Impl::invert(const Eigen::MatrixXd& m, Eigen::MatrixXd& covariance) const {
    Eigen::MatrixXd left = m.topLeftCorner(dof, dof);
    if (const int u = size - dof; u > 0)
        left -= m.topRightCorner(dof, u) * m.bottomRightCorner(u, u).llt().solve(m.bottomLeftCorner(u, dof));
    const Eigen::LLT<Eigen::MatrixXd> llt(left);
    if (llt.info() != Eigen::Success) return false;
    covariance = llt.solve(Eigen::MatrixXd::Identity(dof, dof));
    return covariance.allFinite();
}

double SpotPlacing::Impl::worst_variance(const At& where, const Eigen::MatrixXd& information) const {
    Eigen::MatrixXd covariance;
    if (!invert(information, covariance)) return kInfinity;
    return (where.bead * covariance).cwiseProduct(where.bead).rowwise().sum().maxCoeff();
}

SpotPlacing::Impl::Judged SpotPlacing::Impl::judge(std::span<const std::size_t> chosen, double cutoff) const {
    double worst = 0, lost = 0;
    std::vector<Eigen::MatrixXd> sums;
    for (const At& where : at) {
        Eigen::MatrixXd& sum = sums.emplace_back(where.prior);
        for (const std::size_t c : chosen) sum += where.information[c];
        worst = std::max(worst, worst_variance(where, sum));
        if (!(3 * std::sqrt(worst) < cutoff)) return {3 * std::sqrt(worst), kInfinity};
    }
    if (task.one_may_be_lost)
        for (std::size_t d = 0; d < at.size(); ++d)
            for (const std::size_t c : chosen)
                lost = std::max(lost, worst_variance(at[d], sums[d] - at[d].information[c]));
    return {3 * std::sqrt(worst), 3 * std::sqrt(lost)};
}

double SpotPlacing::Impl::cost(const Judged& j) const {
    return j.lost <= task.three_sigma_mm || !task.one_may_be_lost ? j.g : kBeyond + j.lost + kByG * j.g;
}

bool SpotPlacing::Impl::place_taken(std::span<const std::size_t> chosen, std::size_t candidate,
                                    std::size_t but) const {
    for (std::size_t i = 0; i < chosen.size(); ++i)
        if (i != but && task.candidates[chosen[i]].place == task.candidates[candidate].place) return true;
    return false;
}

std::vector<std::size_t> SpotPlacing::Impl::greedy(int k) const {
    std::vector<std::size_t> chosen;
    std::vector<Eigen::MatrixXd> sums;
    for (const At& where : at) sums.push_back(where.prior);
    while (static_cast<int>(chosen.size()) < k) {
        std::size_t best = kNobody;
        double least = kInfinity;
        for (std::size_t c = 0; c < task.candidates.size(); ++c) {
            if (place_taken(chosen, c, kNobody)) continue;
            double worst = 0;
            for (std::size_t d = 0; d < at.size() && worst < least; ++d)
                worst = std::max(worst, worst_variance(at[d], sums[d] + at[d].information[c]));
            if (worst < least || best == kNobody) least = worst, best = c;
        }
        chosen.push_back(best);
        for (std::size_t d = 0; d < at.size(); ++d) sums[d] += at[d].information[best];
    }
    return chosen;
}

void SpotPlacing::Impl::exchange(std::vector<std::size_t>& chosen, double& now) const {
    constexpr int kMostSweeps = 30;
    for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
        bool better = false;
        for (std::size_t i = 0; i < chosen.size(); ++i) {
            const std::size_t before = chosen[i];
            std::size_t best = before;
            for (std::size_t c = 0; c < task.candidates.size(); ++c) {
                if (c == before || place_taken(chosen, c, i)) continue;
                chosen[i] = c;
                const double then = cost(judge(chosen, now < kBeyond ? now : kInfinity));
                if (then < kBetter * now) now = then, best = c;
            }
            chosen[i] = best;
            better = better || best != before;
        }
        if (!better) return;
    }
}

PlacedSet SpotPlacing::Impl::placed(std::vector<std::size_t> chosen, bool order) const {
    PlacedSet set;
    std::vector<Eigen::Vector3d> points;
    for (const std::size_t c : chosen) points.push_back(references[c]);
    if (order) {
        for (const std::size_t i : short_way(points, set.way_mm)) set.chosen.push_back(chosen[i]);
    } else {
        for (std::size_t i = 1; i < points.size(); ++i) set.way_mm += (points[i] - points[i - 1]).norm();
        set.chosen = std::move(chosen);
    }
    const Judged judged = judge(set.chosen, kInfinity);
    set.three_sigma_mm = judged.g;
    set.lost_three_sigma_mm = judged.lost;
    set.enough = judged.g <= task.three_sigma_mm && judged.lost <= task.three_sigma_mm;
    return set;
}

void SpotPlacing::Impl::shorten(PlacedSet& set) const {
    constexpr double kWorthMm = 1;
    for (bool better = true; better;) {
        better = false;
        for (std::size_t i = 0; i < set.chosen.size() && !better; ++i)
            for (std::size_t c = 0; c < task.candidates.size() && !better; ++c) {
                if (place_taken(set.chosen, c, i) || c == set.chosen[i]) continue;
                std::vector<std::size_t> other = set.chosen;
                other[i] = c;
                std::vector<Eigen::Vector3d> points;
                for (const std::size_t n : other) points.push_back(references[n]);
                double way = 0;
                short_way(points, way);
                if (way > set.way_mm - kWorthMm) continue;
                if (const PlacedSet then = placed(other, true); then.enough) set = then, better = true;
            }
    }
}

Expected<SpotPlacing> SpotPlacing::make(PlacingTask task) {
    SEAM_OK(check(task));
    auto impl = std::make_unique<Impl>();
    impl->task = std::move(task);
    std::set<int> places;
    for (const PlacingCandidate& c : impl->task.candidates) {
        impl->references.push_back(c.spot.workobject_from_sensor * c.spot.reference_mm);
        places.insert(c.place);
    }
    impl->places = static_cast<int>(places.size());
    for (const Displacement& d : impl->task.displacements)
        impl->at.push_back(information_at(impl->task, d, impl->dof, impl->size));
    return SpotPlacing(std::move(impl));
}

SpotPlacing::SpotPlacing(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SpotPlacing::SpotPlacing(SpotPlacing&&) noexcept = default;
SpotPlacing& SpotPlacing::operator=(SpotPlacing&&) noexcept = default;
SpotPlacing::~SpotPlacing() = default;

int SpotPlacing::places() const {
    return impl_->places;
}

PlacedSet SpotPlacing::judge(std::span<const std::size_t> chosen) const {
    return impl_->placed({chosen.begin(), chosen.end()}, false);
}

std::vector<double> SpotPlacing::along_bead(std::span<const std::size_t> chosen) const {
    std::vector<double> out(impl_->task.bead.size(), 0);
    for (const Impl::At& where : impl_->at) {
        Eigen::MatrixXd sum = where.prior, covariance;
        for (const std::size_t c : chosen) sum += where.information[c];
        const bool regular = impl_->invert(sum, covariance);
        for (std::size_t i = 0; i < out.size(); ++i)
            for (int k = 0; k < 2; ++k) {
                const auto a = where.bead.row(static_cast<Eigen::Index>(2 * i) + k);
                const double variance = regular ? a.dot(a * covariance) : kInfinity;
                out[i] = std::max(out[i], 3 * std::sqrt(variance));
            }
    }
    return out;
}

PlacedSet SpotPlacing::best(int k) const {
    std::mt19937_64 random(impl_->task.seed);
    std::vector<std::size_t> best;
    double least = kInfinity;
    const int starts = impl_->task.starts > 0                ? impl_->task.starts
                       : impl_->task.candidates.size() <= 64 ? 12
                                                             : 3;
    for (int start = 0; start < starts; ++start) {
        std::vector<std::size_t> chosen;
        if (start == 0) {
            chosen = impl_->greedy(k);
        } else {
            std::vector<std::size_t> all(impl_->task.candidates.size());
            std::iota(all.begin(), all.end(), std::size_t{0});
            for (std::size_t i = all.size(); i > 1; --i) std::swap(all[i - 1], all[random() % i]);
            for (const std::size_t c : all)
                if (static_cast<int>(chosen.size()) < k && !impl_->place_taken(chosen, c, kNobody))
                    chosen.push_back(c);
        }
        double now = impl_->cost(impl_->judge(chosen, kInfinity));
        impl_->exchange(chosen, now);
        if (now < least || best.empty()) least = now, best = chosen;
    }
    return impl_->placed(std::move(best), true);
}

PlacedSet SpotPlacing::propose(int fewest, int most) const {
    most = std::min(most, impl_->places);
    PlacedSet set;
    for (int k = std::min(fewest, most); k <= most; ++k) {
        // No set of so few can be enough: not worth a search.
        if (k < most && bound_mm(k) > impl_->task.three_sigma_mm) continue;
        set = best(k);
        if (set.enough) break;
    }
    if (set.enough && fewest < most) impl_->shorten(set);
    return set;
}

}  // namespace seamwright
