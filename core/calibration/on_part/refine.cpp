#include "core/calibration/on_part/refine.h"

#include <algorithm>
#include <cmath>

#include "core/calibration/numbers.h"
#include "core/calibration/on_part/advice.h"
#include "core/calibration/on_part/start.h"
#include "core/calibration/statistics.h"
#include "core/geometry/decompositions.h"
#include "core/median.h"
#include "core/numbers.h"

namespace seamwright::on_part {
namespace {

constexpr double kKnot_mm = 8;
constexpr int kMostSegments = 12;
constexpr double kRobust_mm = 0.2;
constexpr double kLeastNoise_mm =
    0.002;  // no feature point is better; keeps exact data from promising the impossible
constexpr double kWrongProfile = 5.0;  // sigma
constexpr double kWrongPass = 35;      // chi squared of six, the 99.9995 % point: the largest of many
constexpr double kFirstPass_mm = 0.06, kFirstCurvature = 0.01;  // the variances that are guessed first
// A whole pass lies elsewhere beyond this, and this many times the middling pass's median distance.
constexpr double kGross_mm = 0.6, kGrossTimes = 8;
constexpr double kWhiteSettled = 0.02;  // relative change of the white noise that ends the rounds
constexpr double kFewTimes = 1.5;       // what an estimate from few passes may be too small by
constexpr double kKept = 0.5;           // of the profiles: where fewer agree, the edge is not theirs
constexpr double kExactRobot_mm = 1e-4, kExactRobot_rad = 1e-7;  // no stated robot is better

Variances first_guess(std::size_t edges) {
    Variances v;
    v.white = 1;
    v.pass_mm = kFirstPass_mm, v.pass_rad = kFirstPass_mm / kPassLever_mm;
    v.curvature.assign(edges, kFirstCurvature);
    return v;
}

double mean_sigma(const Data& data) {
    double sum = 0, n = 0;
    for (const Sight& s : data.sights)
        if (s.used) sum += std::sqrt(0.5 * s.covariance.trace()), ++n;
    return n > 0 ? sum / n : 1;
}

Eigen::Vector2d mean_point(const Data& data) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double n = 0;
    for (const Sight& s : data.sights)
        if (s.used) sum += s.point, ++n;
    return n > 0 ? Eigen::Vector2d(sum / n) : sum;
}

// Whole passes that lie elsewhere, by the median distance of their points when all are solved robustly without their
// own displacements.
std::vector<bool> gross_passes(const Data& data, const State& state) {
    std::vector<std::vector<double>> off(data.motions.size());
    for (const Sight& s : data.sights)
        if (s.used) off[s.pass].push_back(distance(data, state, s).norm());
    std::vector<double> medians;
    std::vector<bool> gross(off.size());
    for (auto& list : off)
        if (!list.empty()) medians.push_back(median(list));
    const double limit = std::max(kGross_mm, kGrossTimes * median(medians));
    for (std::size_t p = 0; p < off.size(); ++p) gross[p] = !off[p].empty() && median(off[p]) > limit;
    if (std::count(gross.begin(), gross.end(), true) * 4 > static_cast<std::ptrdiff_t>(medians.size()))
        gross.assign(off.size(), false);
    return gross;
}

// By whitened residuals with the passes' displacements; true: somebody was left out.
bool leave_out_profiles(Data& data, const Blocks& blocks, double at_least) {
    std::vector<double> size;
    for (std::size_t k = 0; k < blocks.sight_of.size(); ++k)
        size.push_back(blocks.residuals.segment<2>(static_cast<Eigen::Index>(2 * k)).norm());
    if (size.empty()) return false;
    std::vector<double> sorted = size;
    const double limit = std::max(at_least, kWrongProfile * median(sorted) / kRayleighMedian);
    bool any = false;
    for (std::size_t k = 0; k < size.size(); ++k)
        if (size[k] > limit) data.sights[blocks.sight_of[k]].used = false, any = true;
    return any;
}

void drop_beyond_ends(Data& data, double latency_s) {
    for (Sight& s : data.sights)
        if (s.used && !data.motions[s.pass].inside(s.time_s - latency_s)) s.used = false, s.beyond = true;
}

void drop_passes(Data& data, const std::vector<bool>& which) {
    for (Sight& s : data.sights)
        if (which[s.pass]) s.used = false;
}

std::ptrdiff_t used_of(const Data& data) {
    return std::count_if(data.sights.begin(), data.sights.end(), [](const Sight& s) { return s.used; });
}

void robustly(Data& data, State& state, const Variances& guess, std::vector<bool>& wrong) {
    for (int round = 0; round < 2; ++round) {
        State coarse = start_at(data, state.mounting, state.latency_s, kKnot_mm, kMostSegments);
        if (!std::isfinite(solve_state(data, guess, {kRobust_mm, false, 40}, coarse))) return;
        state = coarse;
        // Its motion is linear about the latency it began with.
        State again = start_at(data, state.mounting, state.latency_s, kKnot_mm, kMostSegments);
        again.mounting = state.mounting;
        state = again;
        const std::vector<bool> gross = gross_passes(data, state);
        const bool found = std::find(gross.begin(), gross.end(), true) != gross.end();
        for (std::size_t p = 0; p < gross.size(); ++p) wrong[p] = wrong[p] || gross[p];
        drop_passes(data, gross);
        if (!found) break;
    }
}

// Solved at variances that fit, three times over.
bool settle(Refined& r, const Given& how, bool straight) {
    const double floor = kLeastNoise_mm / mean_sigma(r.data);
    for (int round = 0; round < 4; ++round) {
        if (!std::isfinite(r.cost = solve_state(r.data, r.variances, {}, r.state))) return false;
        if (round == 0) drop_beyond_ends(r.data, r.state.latency_s);
        Blocks blocks = linearised(r.data, r.variances, r.state);
        if (blocks.ss.size() == 0) return false;
        if (round < 2 &&
            leave_out_profiles(r.data, blocks,
                               kWrongProfile * std::max(floor / r.variances.white, round * 1.0))) {
            blocks = linearised(r.data, r.variances, r.state);
            if (blocks.ss.size() == 0) return false;
        }
        Given given = how;
        given.view = view_of(r.state, mean_point(r.data), blocks.wanted);
        given.least = floor / r.variances.white;
        const Variances before = r.variances;
        r.variances = estimate(blocks, r.data, r.state, before, given).variances;
        r.variances.white = std::max(r.variances.white, floor);
        if (straight) r.variances.curvature = before.curvature;
        if (round > 1 && std::abs(r.variances.white / before.white - 1) < kWhiteSettled &&
            r.variances.pass_mm == before.pass_mm && r.variances.curvature == before.curvature)
            break;
    }
    return std::isfinite(r.cost = solve_state(r.data, r.variances, {}, r.state));
}

// The pass that the others contradict most, when they do.
std::optional<std::size_t> contradicting(const Refined& r, const Given& how) {
    const Blocks blocks = linearised(r.data, r.variances, r.state);
    if (blocks.ss.size() == 0) return std::nullopt;
    std::vector<std::pair<double, std::size_t>> suspects;
    int used = 0;
    for (std::size_t p = 0; p < blocks.rows.size(); ++p) {
        if (blocks.rows[p] == 0) continue;
        ++used;
        suspects.emplace_back(
            -(r.state.passes[p].head<3>().norm() + kOnPartLever_mm * r.state.passes[p].tail<3>().norm()), p);
    }
    if (used < 5) return std::nullopt;
    std::sort(suspects.begin(), suspects.end());
    suspects.resize(std::min<std::size_t>(2, suspects.size()));
    Given given = how;
    given.view = view_of(r.state, r.working_point, blocks.wanted);
    given.scale_free = false;
    for (const auto& [size, p] : suspects) {
        const Estimate others =
            estimate(without_pass(blocks, r.data, p), r.data, r.state, r.variances, given);
        Variances v = others.variances;
        if (!how.robot && used < 8) v.pass_mm *= kFewTimes, v.pass_rad *= kFewTimes;  // estimated from few
        const double bound = at_variances(blocks, r.data, r.state, v, given.view).rr;
        const double loose = at_variances(blocks, r.data, r.state, v, given.view, p).rr;
        if (bound - loose > kWrongPass * (1 + 6.0 / used)) return p;
    }
    return std::nullopt;
}

}  // namespace

Refined refine(const Data& data, const State& start, const std::optional<RobotRepeatability>& robot,
               bool straight) {
    Refined r;
    r.data = data;
    r.state = start;
    r.variances = first_guess(data.edges);
    if (straight) r.variances.curvature.assign(data.edges, kStraightEdge);
    r.wrong_passes.assign(data.motions.size(), false);
    robustly(r.data, r.state, r.variances, r.wrong_passes);
    Given how;
    if (robot) {
        how.robot = true;
        r.variances.pass_mm = std::max(robot->sigma_mm, kExactRobot_mm);
        r.variances.pass_rad = std::max(robot->sigma_rad, kExactRobot_rad);
    }
    // Wrong profiles before anything is estimated from them.
    State first = r.state;
    if (!std::isfinite(solve_state(r.data, r.variances, {kRobust_mm, true, 30}, first))) return r;
    r.state = first;
    const auto most = static_cast<int>(data.motions.size() / 4);
    int left_out = static_cast<int>(std::count(r.wrong_passes.begin(), r.wrong_passes.end(), true));
    for (;;) {
        {
            const Blocks blocks = linearised(r.data, r.variances, r.state);
            if (blocks.ss.size() == 0) return r;
            leave_out_profiles(r.data, blocks, 5 * kWrongProfile * kLeastNoise_mm / mean_sigma(r.data));
        }
        if (!settle(r, how, straight)) return r;
        if (static_cast<double>(used_of(r.data)) < kKept * static_cast<double>(used_of(data))) return r;
        r.working_point = mean_point(r.data);
        const auto wrong = left_out < most ? contradicting(r, how) : std::nullopt;
        if (!wrong) break;
        r.wrong_passes[*wrong] = true;
        drop_passes(r.data, r.wrong_passes);
        ++left_out;
    }
    Blocks blocks = linearised(r.data, r.variances, r.state);
    if (blocks.ss.size() == 0) return r;
    r.neighbours = neighbours_factor(blocks, r.data);
    if (r.neighbours > 1) {
        r.variances.white *= std::sqrt(r.neighbours);
        blocks = linearised(r.data, r.variances, r.state);
    }
    how.view = view_of(r.state, r.working_point, blocks.wanted);
    how.scale_free = false;
    r.estimate = estimate(blocks, r.data, r.state, r.variances, how);
    if (!how.robot) {  // q is known as well as the passes are many: four numbers each, less what is solved for
        const auto passes =
            std::count_if(blocks.rows.begin(), blocks.rows.end(), [](int n) { return n > 0; });
        const double freedom = 4.0 * static_cast<double>(passes) - static_cast<double>(blocks.wanted) -
                               4.0 * static_cast<double>(data.edges);
        const double student = student_quantile(kUpper95, std::max(2.0, freedom)) / normal_quantile(kUpper95);
        r.estimate.covariance *= student * student;
    }
    r.solved = true;
    return r;
}

Rival rival(const Refined& refined, const State& start) {
    Rival other;
    Data data = refined.data;
    State state = start_at(data, start.mounting, start.latency_s, kKnot_mm, kMostSegments);
    solve_state(data, first_guess(data.edges), {kRobust_mm, false, 40}, state);
    other.state = start_at(data, state.mounting, state.latency_s, kKnot_mm, kMostSegments);
    other.cost = solve_state(data, refined.variances, {}, other.state);
    return other;
}

std::vector<double> held_out(const Refined& refined, const Blocks& all, std::size_t pass) {
    const Data& data = refined.data;
    std::vector<bool> seen(data.edges);
    for (const Sight& s : data.sights)
        if (s.used && s.pass != pass) seen[s.edge] = true;
    const Eigen::MatrixXd view = view_of(refined.state, refined.working_point, all.wanted);
    const Estimate e =
        at_variances(without_pass(all, data, pass), data, refined.state, refined.variances, view);
    const Eigen::MatrixXd back = inverse_matrix(view);
    if (open_directions(back * e.covariance * back.transpose()).mounting) return {};
    State state = refined.state;
    state.mounting = retract(state.mounting, e.step.head<6>());
    if (e.step.size() > 6) state.latency_s += e.step(6);
    Eigen::Index at = 0;
    for (EdgeCurve& edge : state.edges) {
        edge.coefficients += e.edges.segment(at, edge.coefficients.size());
        at += edge.coefficients.size();
    }
    std::vector<double> off;
    for (const Sight& s : data.sights)
        if (s.used && s.pass == pass && seen[s.edge]) off.push_back(distance(data, state, s).norm());
    return off;
}

}  // namespace seamwright::on_part
