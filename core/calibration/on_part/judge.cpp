#include "core/calibration/on_part/judge.h"

#include <algorithm>
#include <cmath>

#include "core/calibration/statistics.h"
#include "core/geometry/decompositions.h"
#include "core/numbers.h"

namespace seamwright::on_part {
namespace {

constexpr double kAsGood = 25;  // difference of squares below which a second place fits as well
constexpr double kApart_mm = 3, kApart_rad = 0.05;
constexpr double kSteepest = 1.73;         // slope against the chord: 60 degrees
constexpr double kPoorPass_mm = 0.35;      // by which passes contradict one another, beyond
constexpr double kHoldOutTimes = 3;        // what passes not used may miss by over what is expected
constexpr double kRobotTimes = 4;          // .. over what the stated robot explains
constexpr double kLikelier = 0.5;          // a straight edge, from that probability on
constexpr double kLeastOfLatency = 1e-12;  // guards the quotient
constexpr double kMoved = 0.99;            // of chi squared

PoseResidual residual_of(const Refined& r, const Names& names, std::size_t pass, const Data& given,
                         int& wrong) {
    PoseResidual one;
    one.id = names.passes[pass];
    one.excluded = names.excluded[pass];
    double sum = 0, n = 0;
    wrong = 0;
    const auto sees = [&](std::size_t edge) {
        return std::any_of(r.data.sights.begin(), r.data.sights.end(),
                           [&](const Sight& s) { return s.used && s.edge == edge; });
    };
    const auto own = std::find_if(given.sights.begin(), given.sights.end(),
                                  [&](const Sight& s) { return s.pass == pass; });
    if (own == given.sights.end() || !sees(own->edge)) {
        one.used = false;
        one.note = "no pass that is used follows its edge";
        return one;
    }
    for (std::size_t i = 0; i < given.sights.size(); ++i) {
        const Sight& s = given.sights[i];
        if (s.pass != pass) continue;
        const bool used = r.data.sights[i].used;
        if (!used && r.data.sights[i].beyond) continue;
        if (!used && !r.wrong_passes[pass] && !one.excluded) {
            wrong += r.data.motions[pass].inside(s.time_s - r.state.latency_s);
            continue;
        }
        sum += distance(given, r.state, s).squaredNorm(), ++n;
    }
    if (n > 0) one.rms_mm = std::sqrt(sum / n);
    one.used = n > 0 && !one.excluded && !r.wrong_passes[pass];
    if (r.wrong_passes[pass])
        one.note = "the other passes contradict it; left out";
    else if (wrong > 0)
        one.note = Text("{} of its profiles lie off the edge and are left out", wrong);
    return one;
}

HoldOut verify(const Refined& r) {
    HoldOut h;
    h.left_out = 1;
    double sum = 0, n = 0, worst = 0;
    const Blocks all = linearised(r.data, r.variances, r.state);
    if (all.ss.size() == 0) return h;
    for (std::size_t p = 0; p < r.data.motions.size(); ++p) {
        if (r.wrong_passes[p] || std::none_of(r.data.sights.begin(), r.data.sights.end(),
                                              [&](const Sight& s) { return s.used && s.pass == p; }))
            continue;
        const std::vector<double> off = held_out(r, all, p);
        if (off.empty()) continue;
        ++h.folds;
        for (const double d : off) sum += d * d, ++n, worst = std::max(worst, d);
    }
    if (h.folds == 0) h.left_out = 0;
    if (n > 0) h.rms_mm = std::sqrt(sum / n), h.max_mm = worst;
    return h;
}

bool apart(const State& a, const State& b, const Eigen::Vector2d& point) {
    return (a.mounting * in_sensor(point) - b.mounting * in_sensor(point)).norm() > kApart_mm ||
           angle_rad(a.mounting, b.mounting) > kApart_rad;
}

std::vector<PartEdge> edges_of(const Refined& r, const Names& names, bool& steep) {
    std::vector<PartEdge> list;
    for (std::size_t e = 0; e < r.data.edges; ++e) {
        PartEdge one;
        one.id = names.edges[e];
        one.straight = r.estimate.straight[e] > kLikelier;
        one.curvature_per_mm = r.variances.curvature[e];
        std::vector<bool> passes(r.data.motions.size());
        double sum = 0, n = 0, low = kInfinity, high = -kInfinity;
        for (const Sight& s : r.data.sights) {
            if (!s.used || s.edge != e) continue;
            const double along =
                r.state.edges[e].axes.col(0).dot(in_base(r.data, r.state, s) - r.state.edges[e].origin);
            low = std::min(low, along), high = std::max(high, along);
            steep = steep || at(r.state.edges[e], along).slope.norm() > kSteepest;
            sum += distance(r.data, r.state, s).squaredNorm(), ++n;
            passes[s.pass] = true;
        }
        one.length_mm = n > 0 ? high - low : 0;
        one.passes = static_cast<int>(std::count(passes.begin(), passes.end(), true));
        one.rms_mm = n > 0 ? std::sqrt(sum / n) : 0;
        list.push_back(one);
    }
    return list;
}

// Mounting (and latency, in ms) into the report.
void state_parameters(OnPartResult& result, bool latency_free) {
    CalibrationReport& report = result.report;
    add_pose(report, result.flange_from_sensor);
    const bool latency = latency_free && result.latency_known;
    if (latency) report.parameters.push_back({"latency", 1e3 * result.latency_s, "ms", 0});
}

double mean_trace(const Data& data) {
    double sum = 0, n = 0;
    for (const Sight& s : data.sights)
        if (s.used) sum += 0.5 * s.covariance.trace(), ++n;
    return n > 0 ? sum / n : 0;
}

void verdict_of(OnPartResult& result, const Text& left_out_text) {
    Judgement& j = result.report.judgement;
    const HoldOut& h = result.report.hold_out;
    const double three = 3 * result.working_sigma_mm;
    const double expected =
        std::hypot(std::sqrt(2.0) * result.noise_mm, 2 * std::sqrt(2.0) * result.pass_error_mm) +
        2 * result.working_sigma_mm;
    const Text known("3 sigma {:.3f} mm where the edge is seen", three);
    const Text cure =
        result.advice.empty() ? Text("make more passes, from more attitudes") : result.advice.front();
    if (three > kOnPartUsable_mm) {
        j = {Verdict::poor, Text("the passes tell too little: {}", known), cure};
    } else if (result.pass_error_mm > kPoorPass_mm) {
        j = {Verdict::poor, Text("the passes contradict one another by {:.2f} mm", result.pass_error_mm),
             "check that the part stands still, that every pass names its edge, and the robot's poses"};
    } else if (h.folds == 0) {
        j = {Verdict::usable, Text("{}; no pass can be left out to verify it", known), cure};
    } else if (h.rms_mm > kHoldOutTimes * expected) {
        j = {Verdict::poor,
             Text("passes not used lie {:.3f} mm off, expected were {:.3f} mm", h.rms_mm, expected),
             "check that the part stands still, that every pass names its edge, and the robot's poses"};
    } else if (three > kOnPartGood_mm) {
        j = {Verdict::usable, Text("{}; passes not used fit to {:.3f} mm", known, h.rms_mm), cure};
    } else if (!left_out_text.empty()) {
        j = {Verdict::usable, left_out_text, "look at what was left out, and make those passes again"};
    } else {
        j = {Verdict::good, Text("{}; passes not used fit to {:.3f} mm", known, h.rms_mm), ""};
    }
}

void undetermined(OnPartResult& result, const Text& reason, const Text& cure) {
    result.status = OnPartStatus::undetermined;
    result.report.judgement = {Verdict::undetermined, reason, cure};
}

// Who was left out, in one sentence; empty: nobody.
Text left_out_sentence(OnPartResult& result, const Refined& r) {
    const std::string passes = left_out(result.report.poses);
    int profiles = 0, all = 0;
    for (const int n : result.left_out_profiles) profiles += n;
    for (const Sight& s : r.data.sights) all += s.used;
    if (!passes.empty()) {
        result.notices.emplace_back(Text("passes left out because the others contradict them: {}", passes));
        return Text("passes had to be left out: {}", passes);
    }
    const auto beyond = std::count_if(r.data.sights.begin(), r.data.sights.end(),
                                      [](const Sight& s) { return !s.used && s.beyond; });
    if (beyond > 0)
        result.notices.emplace_back(Text(
            "{} profiles at the ends of their passes took no part: with this latency their poses lie beyond "
            "what was recorded",
            beyond));
    if (profiles > 0) result.notices.emplace_back(Text("{} wrong profiles were left out", profiles));
    return profiles * 5 > all ? Text("{} of {} profiles had to be left out", profiles, profiles + all)
                              : Text();
}

}  // namespace

BumpTest bump_of(const Refined& r, const MountingPrior& prior, const Pose& answer) {
    BumpTest test;
    const Matrix6 view = view_of(r.state, r.working_point, 6);
    Eigen::MatrixXd info = r.estimate.information;
    Eigen::VectorXd g = r.estimate.gradient;
    if (info.rows() > 6) {  // the latency goes with the data
        const double tau = std::max(info(6, 6), kLeastOfLatency);
        g = (g.head(6) - info.col(6).head(6) * (g(6) / tau)).eval();
        info = (info.topLeftCorner(6, 6) - info.col(6).head(6) * info.row(6).head(6) / tau).eval();
    }
    // By the data alone, from the prior's mean: step d with information * d = q.
    const Vector6 off = difference(r.state.mounting, prior.flange_from_sensor);
    const Vector6 q = view.transpose() * (info * off - g);
    const Matrix6 s = view.transpose() * info * view;
    const Matrix6 back = inverse_matrix(view);
    const Matrix6 p = back * prior.covariance * back.transpose();
    const SymmetricEigen eigen = symmetric_eigen(s);
    std::vector<Eigen::Index> known;
    for (Eigen::Index i = 0; i < 6; ++i)
        if (eigen.values(i) > 1 / (kOnPartOpen_mm * kOnPartOpen_mm)) known.push_back(i);
    test.directions = static_cast<int>(known.size());
    if (!known.empty()) {
        const Eigen::MatrixXd v = eigen.vectors(Eigen::all, known);
        const Eigen::VectorXd lambda = eigen.values(known);
        const Eigen::VectorXd d = lambda.cwiseInverse().asDiagonal() * (v.transpose() * q);
        const Eigen::MatrixXd c = v.transpose() * p * v + Eigen::MatrixXd(lambda.cwiseInverse().asDiagonal());
        test.chi_squared = d.dot(solve_symmetric(c, d).col(0));
        test.limit = chi_squared_quantile(kMoved, static_cast<double>(known.size()));
        test.moved = test.chi_squared > test.limit;
    }
    const Eigen::Vector3d m = in_sensor(r.working_point);
    test.shift_mm = (answer * m - prior.flange_from_sensor * m).norm();
    test.turn_deg = deg_from_rad(angle_rad(answer, prior.flange_from_sensor));
    return test;
}

OnPartResult refused(const Names& names, OnPartStatus status, const Text& reason, const Text& cure) {
    OnPartResult result;
    result.status = status;
    for (std::size_t p = 0; p < names.passes.size(); ++p) {
        PoseResidual one;
        one.id = names.passes[p];
        one.used = one.excluded = names.excluded[p];
        one.used = !one.excluded;
        result.report.poses.push_back(one);
    }
    result.left_out_profiles.assign(names.passes.size(), 0);
    if (!cure.empty()) result.advice.push_back(cure);
    result.report.judgement = {Verdict::undetermined, reason, cure};
    return result;
}

OnPartResult judge(const Refined& r, const Data& given, const Names& names, const std::vector<Rival>& rivals,
                   const OnPartOptions& options) {
    OnPartResult result;
    for (std::size_t p = 0; p < names.passes.size(); ++p) {
        int wrong = 0;
        result.report.poses.push_back(residual_of(r, names, p, given, wrong));
        result.left_out_profiles.push_back(wrong);
    }
    bool steep = false;
    result.edges = edges_of(r, names, steep);
    double sum = 0, n = 0;
    for (const Sight& s : r.data.sights)
        if (s.used) sum += distance(r.data, r.state, s).squaredNorm(), ++n;
    result.rms_mm = std::sqrt(sum / std::max(1.0, n));
    result.noise_mm = r.variances.white * std::sqrt(mean_trace(r.data) / r.neighbours);
    result.pass_error_mm = r.variances.pass_mm;
    result.working_point_mm = r.working_point;
    const Text left_out_text = left_out_sentence(result, r);

    const Eigen::MatrixXd& covariance = r.estimate.covariance;
    const Eigen::Index wanted = covariance.rows();
    const Eigen::MatrixXd view = view_of(r.state, r.working_point, wanted);
    const Eigen::MatrixXd back = inverse_matrix(view);
    const Eigen::MatrixXd seen = back * covariance * back.transpose();
    const Open open = open_directions(seen);
    result.working_sigma_mm = std::sqrt(symmetric_eigen(seen.topLeftCorner(3, 3)).values(2));
    const Pose answer = retract(r.state.mounting, r.estimate.step.head<6>());
    if (open.mounting || 3 * result.working_sigma_mm > kOnPartGood_mm)
        result.advice = next_passes(r.data, r.state, r.variances, r.working_point, kOnPartGood_mm / 3);
    result.open = open.words;
    if (open.mounting) {
        undetermined(result, result.open.front(), result.advice.empty() ? Text() : result.advice.front());
        return result;
    }
    for (const Rival& other : rivals)
        if (other.cost < r.cost + kAsGood * r.neighbours && apart(other.state, r.state, r.working_point)) {
            if (result.advice.empty())
                result.advice = {"pass once more, turned 20 degrees about the sensor's X (nose up or down)"};
            result.open.emplace_back("a second place of the sensor fits the passes as well");
            undetermined(result,
                         Text("a second place of the sensor fits as well, {:.3g} degrees away",
                              deg_from_rad(angle_rad(other.state.mounting, r.state.mounting))),
                         result.advice.front());
            return result;
        }
    if (steep) {
        undetermined(result, "an edge bends by more than 60 degrees from its chord",
                     "give the parts before and after the bend different edge names");
        return result;
    }
    result.status = OnPartStatus::ok;
    result.flange_from_sensor = answer;
    result.covariance = covariance.topLeftCorner<6, 6>();
    result.latency_s = r.data.latency_free ? r.state.latency_s + r.estimate.step(6) : given.latency_s;
    result.latency_known = !open.latency && !r.idle_latency;
    result.latency_sigma_s = r.data.latency_free && !open.latency ? std::sqrt(covariance(6, 6)) : 0;
    if (r.idle_latency) result.open.emplace_back("the latency is not determined");
    if (!result.latency_known)
        result.notices.emplace_back(
            "the latency is not determined; nothing else depends on it in these passes");
    state_parameters(result, given.latency_free);
    const auto k = static_cast<Eigen::Index>(result.report.parameters.size());
    Eigen::MatrixXd stated = covariance.topLeftCorner(k, k);
    if (k > 6) stated.row(6) *= 1e3, stated.col(6) *= 1e3;
    state_covariance(result.report, stated);
    result.report.hold_out = verify(r);
    verdict_of(result, left_out_text);
    if (options.robot && result.rms_mm > 0 && result.report.hold_out.folds > 1 &&
        result.report.hold_out.rms_mm > kRobotTimes * std::hypot(result.noise_mm, 2 * result.pass_error_mm))
        result.notices.emplace_back(
            "the passes differ by more than the robot's stated repeatability explains");
    return result;
}

}  // namespace seamwright::on_part
