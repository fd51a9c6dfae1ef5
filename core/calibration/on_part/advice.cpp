#include "core/calibration/on_part/advice.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/geometry/decompositions.h"
#include "core/numbers.h"

namespace seamwright::on_part {
namespace {

Text name_of_part(Eigen::Index part) {
    switch (part) {
        case 0:
            return "the shift along the sensor's X (along the stripe)";
        case 1:
            return "the shift along the sensor's Y (the travel)";
        case 2:
            return "the shift along the sensor's Z (the height)";
        case 3:
            return "the turn about the sensor's X";
        case 4:
            return "the turn about the sensor's Y (the travel)";
        case 5:
            return "the turn about the sensor's Z";
        default:
            return "the latency";
    }
}

enum class Change { turn_x, turn_y, turn_z, aside, raise, back, across };
struct Candidate {
    Change change;
    Text words;
};
std::vector<Candidate> candidates(bool timed) {
    std::vector<Candidate> list = {
        {Change::turn_x, "pass once more, turned 20 degrees about the sensor's X (nose up or down)"},
        {Change::turn_y, "pass once more, turned 20 degrees about the travel"},
        {Change::turn_z, "pass once more, turned 20 degrees about the line of sight"},
        {Change::aside, "pass once more, 15 mm to the side"},
        {Change::raise, "pass once more, 15 mm higher or lower"},
        {Change::across, "pass over a second edge that runs 40 degrees across the first"}};
    if (timed) list.push_back({Change::back, "pass once more in the other direction"});
    return list;
}

// What the words of the candidates say.
constexpr double kTurned_deg = 20, kAside_mm = 15, kAcross_deg = 40;

// The pass with most profiles, taken again otherwise.
void add_pass(Data& data, State& state, Change change) {
    std::vector<std::size_t> count(data.motions.size());
    for (const Sight& s : data.sights) count[s.pass] += s.used;
    const auto of = static_cast<std::size_t>(std::max_element(count.begin(), count.end()) - count.begin());
    std::vector<Sight> sights;
    for (const Sight& s : data.sights)
        if (s.pass == of && s.used) sights.push_back(s);
    std::vector<double> times;
    std::vector<Pose> poses;
    std::size_t edge = sights.front().edge;
    if (change == Change::across) {
        EdgeCurve second = state.edges[edge];
        const Eigen::Vector3d sight =
            (data.motions[of].at(sights.front().time_s) * state.mounting).linear().col(2);
        second.origin = in_base(data, state, sights[sights.size() / 2]);
        second.axes = Eigen::AngleAxisd(rad_from_deg(kAcross_deg), sight).toRotationMatrix() * second.axes;
        second.coefficients.setZero();
        edge = state.edges.size();
        state.edges.push_back(second);
        ++data.edges;
    }
    const EdgeCurve& curve = state.edges[edge];
    for (Sight& s : sights) {
        const Pose before = data.motions[of].at(s.time_s - state.latency_s);
        const Pose sensor = before * state.mounting;
        const Eigen::Vector3d p = sensor * in_sensor(s.point);
        Pose moved = Pose::Identity();
        const auto turned = [&](Eigen::Index axis) {
            const Eigen::Matrix3d r =
                Eigen::AngleAxisd(rad_from_deg(kTurned_deg), sensor.linear().col(axis)).toRotationMatrix();
            moved = make_pose(r, p - r * p);
        };
        if (change == Change::turn_x) turned(0);
        if (change == Change::turn_y) turned(1);
        if (change == Change::turn_z) turned(2);
        if (change == Change::aside) moved.translation() = kAside_mm * sensor.linear().col(0);
        if (change == Change::raise) moved.translation() = kAside_mm * sensor.linear().col(2);
        poses.push_back(moved * before);
        times.push_back(change == Change::back ? -s.time_s : s.time_s);
        // Where the laser plane meets the edge there, along its tangent.
        constexpr double kMeets = 0.05;         // sine between tangent and plane: less runs along it
        constexpr double kFarthest_mm = 100.0;  // along the tangent
        const double along = curve.axes.col(0).dot(p - curve.origin);
        const CurvePoint c = at(curve, along);
        const Pose back = (moved * sensor).inverse();
        const Eigen::Vector3d on =
            back * (curve.origin + curve.axes * Eigen::Vector3d(along, c.across.x(), c.across.y()));
        const Eigen::Vector3d tangent =
            back.linear() * (curve.axes * Eigen::Vector3d(1, c.slope.x(), c.slope.y()));
        const double by = std::abs(tangent.y()) > kMeets
                              ? std::clamp(-on.y() / tangent.y(), -kFarthest_mm, kFarthest_mm)
                              : 0;
        const Eigen::Vector3d seen = on + by * tangent;
        s.point = {seen.x(), seen.z()};
        s.edge = edge;
        s.pass = data.motions.size();
        s.time_s = times.back() + state.latency_s;
    }
    if (change == Change::back) {
        std::reverse(times.begin(), times.end());
        std::reverse(poses.begin(), poses.end());
    }
    data.motions.emplace_back(times, poses);
    state.passes.emplace_back(Vector6::Zero());
    data.sights.insert(data.sights.end(), sights.begin(), sights.end());
}

}  // namespace

Open open_directions(const Eigen::MatrixXd& seen) {
    constexpr double kBeside_mm = 0.05;   // of the mounting beside kOnPartOpen_s: with less it is latency
    constexpr double kNamedShare = 0.12;  // of an open direction: smaller parts are not named
    Open open;
    const SymmetricEigen eigen = symmetric_eigen(seen);
    open.weakest_mm = std::sqrt(std::max(0.0, eigen.values(eigen.values.size() - 1)));
    for (Eigen::Index i = eigen.values.size() - 1; i >= 0; --i) {
        const double sigma = std::sqrt(std::max(0.0, eigen.values(i)));
        if (!(sigma > kOnPartOpen_mm)) break;
        const Eigen::VectorXd share = eigen.vectors.col(i).cwiseAbs2();
        const double beside = std::sqrt(share.head<6>().sum());
        const bool only_latency =
            share.size() > 6 &&
            (sigma * beside < kBeside_mm || kOnPartOpen_mm * beside < kBeside_mm * std::sqrt(share(6)));
        (only_latency ? open.latency : open.mounting) = true;
        std::vector<std::pair<double, Eigen::Index>> parts;
        for (Eigen::Index k = 0; k < share.size(); ++k) parts.emplace_back(-share(k), k);
        std::sort(parts.begin(), parts.end());
        std::vector<Text> names;
        for (const auto& [negative, part] : parts)
            if (names.empty() || (-negative > kNamedShare && names.size() < 3))
                names.push_back(name_of_part(part));
        open.words.push_back(names.size() == 1 ? Text("{} is not determined", names.front())
                                               : Text("only together are not determined: {}", listed(names)));
    }
    return open;
}

std::vector<Text> next_passes(const Data& data, const State& state, const Variances& variances,
                              const Eigen::Vector2d& working_point, double enough_mm) {
    constexpr double kBetter = 0.98;  // of the best variance so far, below which a pass is the better one
    std::vector<Text> words;
    if (std::none_of(data.sights.begin(), data.sights.end(), [](const Sight& s) { return s.used; }))
        return words;  // no pass is there to be taken again otherwise
    Data with = data;
    State at = state;
    for (Vector6& p : at.passes) p.setZero();
    const bool timed = data.latency_free;
    for (int round = 0; round < 3; ++round) {
        double best = kInfinity;
        Text best_words;
        Data best_data;
        State best_state;
        Variances v = variances, best_v;
        for (const Candidate& c : candidates(timed)) {
            Data tried = with;
            State there = at;
            add_pass(tried, there, c.change);
            v.curvature.resize(there.edges.size(), kStraightEdge);
            const Blocks blocks = linearised(tried, v, there);
            if (blocks.ss.size() == 0) continue;
            const Eigen::MatrixXd view = view_of(there, working_point, blocks.wanted);
            const Estimate e = at_variances(blocks, tried, there, v, view);
            const Eigen::MatrixXd back = inverse_matrix(view);
            const Eigen::MatrixXd seen = back * e.covariance * back.transpose();
            const double weakest = symmetric_eigen(seen).values(seen.rows() - 1);
            if (weakest < kBetter * best) {
                best = weakest, best_words = c.words, best_v = v;
                best_data = std::move(tried), best_state = std::move(there);
            }
        }
        if (!std::isfinite(best)) break;
        words.push_back(best_words);
        with = std::move(best_data), at = std::move(best_state);
        if (std::sqrt(best) < enough_mm) break;
    }
    return words;
}

}  // namespace seamwright::on_part
