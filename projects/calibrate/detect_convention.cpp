#include "projects/calibrate/detect_convention.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/calibration/pose/hand_eye.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/input/pose_lists.h"
#include "projects/calibrate/methods/hand_eye_json.h"
#include "projects/calibrate/methods/sphere_profile_json.h"
#include "projects/calibrate/methods/stripe_frames.h"
#include "projects/file/stored_text.h"

namespace seamwright {
namespace {

using nlohmann::json;
using Exclude = std::vector<std::string>;
using Lists = std::vector<std::vector<Pose>>;

// Residuals below these are exact: two readings then tie.
constexpr double kExactPoint_mm = 0.002, kExactPose_mm = 0.02, kExactPose_rad = 2e-4;

// The data as they are but for their poses, which are all alike here and come from a reading later.
json without_poses(std::string_view method, const json& data, const json& instead) {
    json bare = data;
    bare.erase("pose_convention");
    for (const PoseListPlace& place : pose_lists_of(method))
        if (const auto list = bare.find(place.entries); list != bare.end() && list->is_array())
            for (json& entry : *list)
                if (entry.is_object() && entry.contains(place.key)) entry[place.key] = instead;
    return bare;
}

struct Fits {
    PoseFit fit, screen;
};

// The three numbers of a profile weigh very unequally where the poses err, the cut's radius least: two count.
std::optional<ConventionFit> sphere_fit(SphereData& set, const std::vector<Pose>& poses, bool thorough) {
    for (std::size_t i = 0; i < set.observations.size(); ++i) set.observations[i].base_from_flange = poses[i];
    set.options.thorough = thorough;
    const auto solved = calibrate_tcp_sphere(set.observations, set.options);
    if (!solved || solved->status == TcpSphereStatus::not_converged) return std::nullopt;
    const double unknowns = set.options.radius_mm ? 9 : 10;
    return ConventionFit{std::max(kExactPoint_mm * kExactPoint_mm, solved->poses_variance_mm2),
                         std::max(1.0, (solved->poses_freedom + unknowns) * 2 / 3 - unknowns), solved->rms_mm,
                         thorough && solved->fits,
                         thorough ? solved->report.judgement.verdict : Verdict::undetermined};
}

Expected<Fits> sphere_fits(const json& data, const Exclude& exclude) {
    auto sphere = parse_sphere_data(without_poses("tcp-sphere", data, pose_json(Pose::Identity())), exclude);
    if (!sphere) return tl::unexpected(sphere.error());
    const auto set = std::make_shared<SphereData>(std::move(*sphere));
    return Fits{[set](const Lists& lists) { return sphere_fit(*set, lists[0], true); },
                [set](const Lists& lists) { return sphere_fit(*set, lists[0], false); }};
}

// Millimetres and radians have a variance each: their geometric mean has the tails of one of 3 n - 6 degrees at most.
std::optional<ConventionFit> pairs_fit(Mount mount, const std::vector<HandEyePair>& pairs,
                                       const Exclude& exclude) {
    const auto solved = calibrate_hand_eye(mount, pairs, exclude);
    if (!solved) return std::nullopt;
    return ConventionFit{
        std::max(kExactPose_mm, solved->sigma_mm) * std::max(kExactPose_rad, rad_from_deg(solved->sigma_deg)),
        std::max(1.0, 3.0 * solved->pairs_used - 6), solved->rms_mm, solved->fits,
        solved->report.judgement.verdict};
}

Expected<Fits> hand_eye_fits(const json& data, const Exclude& exclude) {
    auto set = parse_hand_eye_data(without_poses("hand-eye", data, pose_json(Pose::Identity())));
    if (!set) return tl::unexpected(set.error());
    PoseFit fit = [set = std::move(*set), exclude](const Lists& lists) mutable {
        for (std::size_t i = 0; i < set.pairs.size(); ++i) {
            set.pairs[i].base_from_flange = lists[0][i];
            set.pairs[i].camera_from_target = lists[1][i];
        }
        return pairs_fit(set.mount, set.pairs, exclude);
    };
    return Fits{std::move(fit), {}};
}

// Camera and plate without the robot, once; the robot's poses then against where the camera saw the plate.
Expected<Fits> stripe_fits(const json& data, const Exclude& exclude) {
    auto set = parse_stripe_data(without_poses("stripe-camera", data, nullptr));
    if (!set) return tl::unexpected(set.error());
    auto solved = calibrate_stripe_frames(set->observations, set->spec, exclude);
    if (!solved) return tl::unexpected(solved.error());
    const json& frames = solved->result.at("frames");
    std::vector<HandEyePair> pairs;
    std::vector<std::size_t> number;  // of the pose in its list
    std::size_t poses = 0;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const json& entry = data.at("frames").at(i);
        if (!entry.contains("base_from_flange") || entry["base_from_flange"].is_null()) continue;
        const std::size_t own = poses++;
        const json& seen = frames[i].at("camera_from_target");
        if (seen.is_null()) continue;
        auto camera_from_target = parse_pose(seen, "camera_from_target");
        if (!camera_from_target) return tl::unexpected(camera_from_target.error());
        pairs.push_back({set->observations[i].id, Pose::Identity(), *camera_from_target});
        number.push_back(own);
    }
    PoseFit fit = [pairs = std::move(pairs), number = std::move(number)](const Lists& lists) mutable {
        for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i].base_from_flange = lists[0][number[i]];
        return pairs_fit(Mount::eye_in_hand, pairs, {});
    };
    return Fits{std::move(fit), {}};
}

struct Detective {
    std::string_view method;
    Expected<Fits> (*fits)(const json& data, const Exclude& exclude);
};
constexpr Detective kDetectives[] = {
    {"tcp-sphere", sphere_fits}, {"hand-eye", hand_eye_fits}, {"stripe-camera", stripe_fits}};

json reading_json(const PoseReading& reading, const std::vector<WrittenPoses>& lists) {
    json conventions = json::object();
    for (std::size_t l = 0; l < lists.size(); ++l)
        conventions[lists[l].name] = code_of(reading.conventions[l]);
    json one{{"conventions", conventions}, {"residual_mm", nullptr}, {"verdict", nullptr}};
    put_text(one, "words", words_of(reading, lists));
    if (reading.fit) {
        one["residual_mm"] = number_json(reading.fit->residual_mm);
        one["verdict"] = std::string(name_of(reading.fit->verdict));
    }
    return one;
}

}  // namespace

bool can_detect_convention(std::string_view method) {
    return std::any_of(std::begin(kDetectives), std::end(kDetectives),
                       [&](const Detective& d) { return d.method == method; });
}

Expected<ConventionAnswer> detect_pose_convention(std::string_view method, const json& data,
                                                  const Exclude& exclude) {
    const auto detective = std::find_if(std::begin(kDetectives), std::end(kDetectives),
                                        [&](const Detective& d) { return d.method == method; });
    if (detective == std::end(kDetectives))
        return usage_error("its data leave no residual that a convention of poses shows in",
                           Text("calibrate {}", std::string(method)),
                           "ask of tcp-sphere, hand-eye or stripe-camera data of the same robot");
    const auto lists = written_poses(method, data);
    if (!lists) return tl::unexpected(lists.error());
    if (lists->empty())
        return input_error("there are no poses", Text("calibrate {}", std::string(method)),
                           "leave --detect-convention out");
    const auto fits = detective->fits(data, exclude);
    if (!fits) return tl::unexpected(fits.error());
    ConventionAnswer answer;
    answer.found = detect_convention(*lists, fits->fit, fits->screen);
    const DetectedConvention& found = answer.found;
    const auto optional = [&](const std::optional<PoseReading>& reading) {
        return reading ? reading_json(*reading, *lists) : json(nullptr);
    };
    json& r = answer.result;
    r = {{"verdict", std::string(name_of(found.finding))},
         {"tried", found.tried},
         {"as_given", reading_json(found.as_given, *lists)},
         {"best", optional(found.best)},
         {"second", optional(found.second)},
         {"equal_poses", found.equal_poses},
         {"ratio", found.second ? number_json(found.ratio) : json(nullptr)},
         {"limit", found.limit > 0 ? number_json(found.limit) : json(nullptr)},
         {"offer", nullptr}};
    put_text(r, "sentence", found.sentence);
    if (found.finding == ConventionFinding::named) {
        answer.offer = json::object();
        if (const auto said = data.find("pose_convention"); said != data.end() && said->is_object())
            answer.offer = *said;
        for (std::size_t l = 0; l < lists->size(); ++l) {
            if (found.best->conventions[l] == (*lists)[l].as_given) continue;
            const std::string code = code_of(found.best->conventions[l]);
            answer.offer[(*lists)[l].name] = code;
            answer.codes.push_back((*lists)[l].name + "=" + code);
        }
        r["offer"] = answer.offer;
    }
    return answer;
}

}  // namespace seamwright
