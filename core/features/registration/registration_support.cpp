// What speaks for a pose: how likely the scene is at it, and how much of what fixes the template is met.
//
// Length alone is no measure: of a rim of radius 1 with 10 mm of flat, six points out of seventy say where
// along the flat it is, and a pose that has slid along the flat meets as much of the length as the true one.
// The cost counts points against the noise, so these six weigh 9 each; the information of each direction is
// looked at by itself, so that what fixes it must be there.

#include <Eigen/Eigenvalues>
#include <utility>

#include "core/features/registration/registration_kernel.h"

namespace seamwright {
namespace {

// What a template point without a partner costs: beyond three sigma it is no partner.
constexpr double kMissing = 9;
// A partner lies within this part of the final gate (four sigma).
constexpr double kPartner = 0.75;
// A steep flank has at least so many of the points of as long a flat.
constexpr double kLeastAcross = 0.25;
constexpr int kMostBins = 20000;
constexpr float kContradicted = 1e6F;

}  // namespace

void ContourMatcher::Impl::learn_directions() {
    const double half = 0.5 * model.extent_mm(), pitch = model.pitch().along_x;
    const double variance = model.sigma_mm() * model.sigma_mm() * model.pitch().alike();
    const Eigen::Vector3d scale(1, 1, 1 / half);
    bins = std::clamp(static_cast<int>(model.length_mm() / (0.5 * model.pitch().distance)), 1, kMostBins);
    const double bin = model.length_mm() / bins;

    // A slope is known as well as the window of its fit allows; what that noise seems to tell is taken off.
    auto false_part = [&](const ContourModel::Edge& edge, double u,
                          const Eigen::Vector3d& slide) -> Eigen::Matrix3d {
        return variance * model.weights(edge, u).slope_variance * slide * slide.transpose();
    };
    slope_doubt.clear();
    for (const auto& edge : model.edges())
        slope_doubt.push_back(edge.wall ? 0 : variance * model.weights(edge, 0).slope_variance);
    Eigen::Matrix3d all = Eigen::Matrix3d::Zero();
    for (const auto& edge : model.edges()) {
        if (edge.wall || edge.count < 4) continue;
        const RegistrationRow row = registration_row(edge, 0);
        all += 2 * edge.half * (row.across * row.across.transpose() - false_part(edge, 0, row.along));
    }
    // A jump is known to a pitch, a point across its line to sigma.
    const auto jump_row = [](const JumpEnd& j) -> Eigen::Vector3d {
        if (!j.tells()) return Eigen::Vector3d::Zero();
        if (const SheetOutline& o = j.outline; o.nearer != SheetOutline::Nearer::unknown)
            return {-1, 0, o.nearer == SheetOutline::Nearer::upper ? o.upper.z : o.lower.z};
        return Eigen::Vector3d(-j.tx, -j.tz, -(-j.tx * j.z + j.tz * j.x));
    };
    const double jump_worth = [&] {
        const double s = std::max(model.sigma_mm(), 0.05 * pitch);
        return 12 * s * s / (pitch * pitch + 12 * s * s) * pitch;
    }();
    for (const JumpEnd& j : jumps) all += jump_worth * jump_row(j) * jump_row(j).transpose();
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(
        Eigen::Matrix3d(scale.asDiagonal() * all * scale.asDiagonal()));
    weakest_share =
        eigen.eigenvalues()[2] > 0 ? std::max(0.0, eigen.eigenvalues()[0] / eigen.eigenvalues()[2]) : 0;
    std::array<double, 3> scatter{};
    for (int k = 0; k < 3; ++k) directions[k] = {scale.cwiseProduct(eigen.eigenvectors().col(k)), 0, false};

    bin_information.assign(static_cast<std::size_t>(bins) + jumps.size(), {0, 0, 0});
    bin_across.assign(static_cast<std::size_t>(bins), 1);
    std::size_t e = 0;
    for (int b = 0; b < bins; ++b) {
        const double s = (b + 0.5) * bin;
        while (e + 1 < model.edges().size() &&
               (model.edges()[e].wall || s > arc[e] + 2 * model.edges()[e].half))
            ++e;
        const auto& edge = model.edges()[e];
        const double u = std::clamp(s - arc[e] - edge.half, -edge.half, edge.half);
        const RegistrationRow row = registration_row(edge, u);
        const Eigen::Matrix3d doubt = false_part(edge, u, row.along);
        bin_across[b] = static_cast<float>(std::abs(edge.tx));
        // Between two points of which no wider piece is known, the slope is not: a step or a bend within a
        // pitch.
        if (edge.count < 4) continue;
        for (int k = 0; k < 3; ++k) {
            const Eigen::Vector3d& v = directions[k].twist;
            const double noise = v.dot(doubt * v);
            const double told = bin / pitch * (std::pow(row.across.dot(v), 2) - noise);
            bin_information[b][k] = static_cast<float>(told);
            directions[k].information += told;
            // Neighbouring slopes come from the same window, so their errors add up over it.
            scatter[k] += 2 * std::pow(bin / pitch * noise, 2) * std::max(1.0, edge.count * pitch / bin);
        }
    }
    for (std::size_t j = 0; j < jumps.size(); ++j)
        for (int k = 0; k < 3; ++k) {
            const double told = jump_worth / pitch * std::pow(jump_row(jumps[j]).dot(directions[k].twist), 2);
            bin_information[static_cast<std::size_t>(bins) + j][k] = static_cast<float>(told);
            directions[k].information += told;
        }
    const double points = model.length_mm() / pitch;
    fit_variance = 0;
    for (const auto& edge : model.edges())
        if (!edge.wall) fit_variance += model.weights(edge, 0).value_variance / double(model.edges().size());
    for (int k = 0; k < 3; ++k)
        directions[k].determined =
            directions[k].information > 4 * std::sqrt(scatter[k]) + points * kStraight_rad * kStraight_rad;
}

ContourMatcher::Impl::Support ContourMatcher::Impl::support(const Finish& found, double sigma,
                                                            int stride) const {
    Support result;
    result.pose = found.pose;
    result.sigma = found.sigma;
    result.gate = std::clamp(found.gate, smallest_gate(), std::max(smallest_gate(), largest_final_gate()));
    // Scene points near the template that do not lie on it speak against the pose as missing partners do.
    const double capture = std::max(3 * result.gate, std::min(2.0, 0.08 * model.extent_mm()));
    const double partner = kPartner * result.gate;
    bin_residual2.assign(static_cast<std::size_t>(bins), -1.0F);
    collect(result.pose, capture, stride);
    const double per_mm = bins / model.length_mm();
    const double bridge = 4 * std::max(model.pitch().distance, stride * scene.pitch.distance);
    const double over = 1 / std::max(sigma * sigma, 1e-10);
    // A template coarser than the scene tells no more than its own points.
    const double thinner = std::min(1.0, stride * scene.pitch.along_x / model.pitch().along_x);
    // Between neighbours of the scene that both lie on the curve all of it is met.
    double last_s = 0, last_r2 = 0;
    int last_scene = -1, last_run = -1;
    auto mark = [&](double from, double to, double r2) {
        const int first = std::clamp(static_cast<int>(from * per_mm), 0, bins - 1);
        const int last = std::clamp(static_cast<int>(to * per_mm), 0, bins - 1);
        for (int b = first; b <= last; ++b)
            if (bin_residual2[b] < 0 || r2 < bin_residual2[b]) bin_residual2[b] = static_cast<float>(r2);
    };
    for (const Match& m : matches) {
        const auto& edge = model.edges()[m.foot.edge];
        // Beside a sheet's end nothing lies across it, and yet it is not met.
        const double size =
            m.foot.beyond > 0 ? std::hypot(m.foot.residual, m.foot.beyond) : std::abs(m.foot.residual);
        ++(size > result.gate ? result.off : result.on);
        result.contradicted += thinner * (std::min(kMissing, size * size * over) - 1);
        if (edge.wall) continue;
        const double s = arc[static_cast<std::size_t>(m.foot.edge)] + edge.half +
                         std::clamp(m.foot.u, -edge.half, edge.half);
        if (size > partner) {
            mark(s, s, kContradicted);
            continue;
        }
        const double r2 = size * size * over;
        const bool neighbours = last_scene >= 0 && m.scene - last_scene <= 2 * stride &&
                                edge.run == last_run && std::abs(s - last_s) < bridge;
        if (neighbours) mark(std::min(s, last_s), std::max(s, last_s), 0.5 * (r2 + last_r2));
        const double around = 0.25 * bridge;
        mark(s - around, s + around, r2);
        last_s = s;
        last_r2 = r2;
        last_scene = m.scene;
        last_run = edge.run;
    }
    // Points per bin as dense as the coarser of the two.
    const double density = 1 / (per_mm * std::max(model.pitch().along_x, scene.pitch.along_x * stride));
    std::array<double, 3> met{};
    int marked = 0;
    for (int b = 0; b < bins; ++b) {
        const double points = density * std::max(double(bin_across[b]), kLeastAcross);
        const bool partnered = bin_residual2[b] >= 0 && bin_residual2[b] < kContradicted;
        const double cost = points * (partnered ? std::min<double>(bin_residual2[b], kMissing) : kMissing);
        result.cost += cost;
        if (!partnered) {
            result.missing += cost;
            continue;
        }
        ++marked;
        for (int k = 0; k < 3; ++k) met[k] += bin_information[b][k];
    }
    if (!jumps.empty()) {
        collect_jumps(result.pose, result.gate);
        for (const JumpMatch& j : jump_matches)
            for (int k = 0; k < 3; ++k) met[k] += bin_information[static_cast<std::size_t>(bins + j.jump)][k];
        double absent = 0;
        for (const JumpEnd& j : jumps) absent += j.tells() ? kMissing : 0;
        for (const JumpMatch& j : jump_matches)
            if (jumps[static_cast<std::size_t>(j.jump)].tells()) absent -= kMissing;
        result.cost += absent;
        result.missing += absent;
        for (const JumpMatch& j : jump_matches)
            result.cost += std::min(kMissing, j.residual * j.residual / j.variance);
    }
    // Points that share their noise speak as one.
    const double alike = std::max(scene.pitch.alike(), model.pitch().alike());
    result.contradicted /= alike;
    result.cost /= alike;
    result.missing /= alike;
    result.share = double(marked) / bins;
    for (int k = 0; k < 3; ++k)
        result.informed[k] = directions[k].determined ? met[k] / directions[k].information : 1;
    return result;
}

ContourMatcher::Impl::TurnedAway ContourMatcher::Impl::turned_away(const CentredPose& pose) const {
    constexpr double kSteepest = 0.15;  // cosine
    double away = 0, points = 0;
    for (const ContourModel::Edge& edge : model.edges()) {
        if (edge.wall) continue;
        const double before = std::abs(edge.tx),
                     now = (edge.tx < 0 ? -1 : 1) * (pose.cosine * edge.tx - pose.sine * edge.tz);
        if (now >= std::min(kSteepest, 0.5 * before)) continue;
        away += 2 * edge.half;
        points += 2 * edge.half * std::max(before, kLeastAcross);
    }
    return {away / model.length_mm(),
            kMissing * points / std::max(model.pitch().along_x, scene.pitch.along_x)};
}

double ContourMatcher::Impl::replaced(const Finish& found, double sigma) const {
    support(found, sigma, 1);  // marks the bins
    const double cell = 2 * std::max(scene.pitch.along_x, model.pitch().along_x);
    const auto [lo, hi] = std::minmax_element(scene.x.begin(), scene.x.end());
    const double origin = *lo;
    seen_x.assign(static_cast<std::size_t>(std::min((*hi - origin) / cell, double(kMostBins))) + 1, 0);
    const auto cell_of = [&](double x) { return static_cast<std::size_t>((x - origin) / cell); };
    for (const double x : scene.x)
        if (cell_of(x) < seen_x.size()) seen_x[cell_of(x)] = 1;
    const double bin = model.length_mm() / bins;
    double all = 0, elsewhere = 0;
    std::size_t e = 0;
    for (int b = 0; b < bins; ++b) {
        const double s = (b + 0.5) * bin;
        while (e + 1 < model.edges().size() &&
               (model.edges()[e].wall || s > arc[e] + 2 * model.edges()[e].half))
            ++e;
        const double points = std::max(double(bin_across[b]), kLeastAcross);
        all += points;
        if (bin_residual2[b] >= 0 && bin_residual2[b] < kContradicted) continue;
        const auto& edge = model.edges()[e];
        const double u = std::clamp(s - arc[e] - edge.half, -edge.half, edge.half);
        const double x = (found.pose * Eigen::Vector2d(edge.cx + u * edge.tx, edge.cz + u * edge.tz)).x();
        if (x >= origin && x <= *hi && cell_of(x) < seen_x.size() && seen_x[cell_of(x)]) elsewhere += points;
    }
    return all > 0 ? elsewhere / all : 0;
}

ContourMatcher::Impl::Held ContourMatcher::Impl::held(const Finish& found, const Support& here, double sigma,
                                                      const Eigen::Vector3d& twist, double telling) const {
    constexpr int kSide = 20;
    constexpr std::size_t kPoints = 1500;
    constexpr double kGrain = 0.1;
    std::array<double, 2 * kSide + 1> cost;
    const int stride = static_cast<int>(scene.x.size() / kPoints) + 1;
    const double step = search.step_mm() / kSide;
    Finish beside = found;
    for (int i = -kSide; i <= kSide; ++i) {
        beside.pose = moved_along(found.pose, twist, i * step);
        cost[i + kSide] = support(beside, sigma, stride).contradicted * stride;
    }
    // Where the noise is not small beside the steps, what is likely at one of them alone is so by chance.
    if (sigma > kGrain * step) {
        double before = cost[0];
        for (std::size_t i = 1; i + 1 < cost.size(); ++i)
            before = std::exchange(cost[i], std::max(cost[i], std::min(before, cost[i + 1])));
    }
    const auto best = std::min_element(cost.begin(), cost.end());
    const double least = *best;
    // Of a straight line the template's own waves tell a place: their part in the cost scatters by this.
    const double waves = std::sqrt(8 * here.on * fit_variance * model.sigma_mm() * model.sigma_mm()) / sigma;
    const double told = least + telling + 3 * waves;
    Held result;
    // To either side of the likeliest place: of one at the rim of what was looked at nobody knows whether it goes on.
    result.held = best != cost.begin() && *std::max_element(cost.begin(), best) > told &&
                  *std::max_element(best, cost.end()) > told;
    // Mean and variance of the place along the direction, all of the step alike likely before, and none the likelier for
    // what waves may make.
    double sum = 0, first = 0, second = 0;
    for (int i = -kSide; i <= kSide; ++i) {
        const double w = std::exp(-0.5 * std::max(cost[i + kSide] - least - waves, 0.0)), t = i * step;
        sum += w;
        first += w * t;
        second += w * t * t;
    }
    result.shift = first / sum;
    result.variance = second / sum - result.shift * result.shift + step * step / 12;
    return result;
}

double ContourMatcher::Impl::telling_difference(const Support& first) {
    // Each missing point may be missing by chance (clutter, occlusion): their number scatters by its root.
    return kTelling + 3 * std::sqrt(first.missing);
}

}  // namespace seamwright
