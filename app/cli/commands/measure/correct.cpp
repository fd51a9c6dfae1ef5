// seamwright correct, seamwright plan: a region's displacement from its spots, and its prediction.

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <set>

#include "app/cli/answers/result_json.h"
#include "app/cli/command.h"
#include "app/cli/commands/measure/contour_spot.h"
#include "core/correction/correction.h"
#include "core/geometry/notation.h"
#include "devices/exchange/files.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "devices/exchange/tables/json_poses.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

// A spot told by contours, and where it stands in the job.
struct JobContour {
    std::string id;
    std::size_t place = 0;
    Feature found;
};

struct Job {
    std::vector<SpotObservation> spots;  // without those whose contour was refused
    std::vector<JobContour> contours;
    CorrectionOptions options;
};

// Rows of N numbers, (mm, mm, mm, rad, rad, rad).
Expected<Matrix6> read_pose_covariance(const json& rows, const std::string& path) {
    Matrix6 c;
    for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t k = 0; k < 6; ++k) {
            if (!rows.is_array() || rows.size() != 6 || !rows[i].is_array() || rows[i].size() != 6 ||
                !rows[i][k].is_number())
                return input_error("not six rows of six numbers", path,
                                   "give the covariance of translation (mm) and rotation vector (rad)");
            c(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = rows[i][k].get<double>();
        }
    return c;
}

// [[xx, xz], [xz, zz]], as `feature` writes it.
Expected<Eigen::Matrix2d> read_covariance(const json& rows, const std::string& path) {
    Eigen::Matrix2d c;
    for (std::size_t i = 0; i < 2; ++i)
        for (std::size_t k = 0; k < 2; ++k) {
            if (!rows.is_array() || rows.size() != 2 || !rows[i].is_array() || rows[i].size() != 2 ||
                !rows[i][k].is_number())
                return input_error("not two rows of two numbers", path, "give [[xx, xz], [xz, zz]] in mm^2");
            c(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = rows[i][k].get<double>();
        }
    return c;
}

// Reference and measure of a spot told by points.
Expected<void> read_points(const json& spot, const std::string& path, bool needs_measured,
                           SpotObservation& s) {
    SEAM_TRY(auto reference, json_vector3(spot, "reference", path));
    s.reference_mm = s.measured_mm = reference;
    if (needs_measured) {
        SEAM_TRY(auto measured, json_vector3(spot, "measured", path));
        s.measured_mm = measured;
    }
    return {};
}

// Of one told by contours, into a spot whose other fields are read; what the registration found.
Expected<Feature> read_contours(const json& spot, const std::string& path,
                                const std::filesystem::path& folder, bool needs_measured,
                                SpotObservation& s) {
    if (spot.contains("measured"))
        return input_error("a point and a contour are two ways to tell a spot", json_path(path, "measured"),
                           "give \"curve\" or \"measured\"");
    Eigen::Matrix2d own = s.covariance_mm2.value_or(Eigen::Matrix2d::Zero());
    if (!own.allFinite() || !(std::abs(own(0, 1) - own(1, 0)) <= 1e-9 * own.norm()) || own(0, 0) < 0 ||
        own.determinant() < -1e-12 * own.squaredNorm())
        return input_error("the covariance is not symmetric and positive", json_path(path, "covariance_mm2"));
    if (spot.contains("sigma_mm")) {
        if (!(s.sigma_mm >= 0)) return input_error("a sigma is negative", json_path(path, "sigma_mm"));
        own += s.sigma_mm * s.sigma_mm * Eigen::Matrix2d::Identity();
    }
    SEAM_TRY(auto contour, find_contour(spot, path, folder, needs_measured));
    take_contour(contour, own, s);
    // Taught with one profile, whose noise is the same for all parts to come. A run's registration holds both noises.
    if (!needs_measured && !s.reference_covariance_mm2)
        s.reference_covariance_mm2 = contour.found.covariance_mm2;
    return contour.found;
}

Expected<SpotObservation> read_spot(const json& spot, const std::string& path,
                                    const std::filesystem::path& folder, bool needs_measured,
                                    std::optional<Feature>& contour) {
    if (auto known = only_fields(spot,
                                 {"id", "workobject_from_sensor", "reference", "measured", "reference_curve",
                                  "curve", "window", "weights", "sigma_mm", "covariance_mm2", "sensor",
                                  "reference_covariance_mm2", "robot_covariance", "reference_arrivals"},
                                 path);
        !known)
        return tl::unexpected(known.error());
    SpotObservation s;
    SEAM_TRY(auto id, json_string(spot, "id", path));
    s.id = id;
    SEAM_TRY(auto pose, json_field(spot, "workobject_from_sensor", path));
    SEAM_TRY(auto parsed, parse_pose(*pose, json_path(path, "workobject_from_sensor")));
    s.workobject_from_sensor = parsed;
    if (!told_by_contours(spot)) {
        if (spot.contains("window"))
            return input_error("only a contour is looked for in a window", json_path(path, "window"),
                               "give \"reference_curve\" with it");
        SEAM_OK(read_points(spot, path, needs_measured, s));
    }
    if (spot.contains("weights")) {
        SEAM_TRY(auto weights, json_vector3(spot, "weights", path));
        s.weights = weights;
    }
    SEAM_TRY(auto sigma, json_number_or(spot, "sigma_mm", s.sigma_mm, path));
    s.sigma_mm = sigma;
    if (spot.contains("covariance_mm2") && !spot["covariance_mm2"].is_null()) {
        SEAM_TRY(auto covariance, read_covariance(spot["covariance_mm2"], json_path(path, "covariance_mm2")));
        s.covariance_mm2 = covariance;
    }
    if (spot.contains("sensor") && !spot["sensor"].is_null()) {
        SEAM_TRY(auto sensor, json_string(spot, "sensor", path));
        if (sensor.empty())
            return input_error("the sensor's id is empty", json_path(path, "sensor"),
                               "name one of \"sensors\", or leave the field out");
        s.sensor = sensor;
    }
    if (const auto c = spot.find("reference_covariance_mm2"); c != spot.end() && !c->is_null()) {
        SEAM_TRY(auto covariance, read_covariance(*c, json_path(path, "reference_covariance_mm2")));
        s.reference_covariance_mm2 = covariance;
    }
    if (const auto c = spot.find("robot_covariance"); c != spot.end() && !c->is_null()) {
        SEAM_TRY(auto covariance, read_pose_covariance(*c, json_path(path, "robot_covariance")));
        s.robot_covariance = covariance;
    }
    SEAM_TRY(const double arrivals, json_number_or(spot, "reference_arrivals", 1, path));
    if (!(arrivals >= 1 && arrivals <= 1e6) || arrivals != std::floor(arrivals))
        return input_error("no number of arrivals", json_path(path, "reference_arrivals"),
                           "give how many arrivals of the robot the reference is the mean of, 1 or more");
    s.reference_arrivals = static_cast<int>(arrivals);
    if (told_by_contours(spot)) {
        SEAM_TRY(contour, read_contours(spot, path, folder, needs_measured, s));
    }
    return s;
}

Expected<SensorPrior> read_sensor(const std::string& id, const json& sensor, const std::string& path) {
    SEAM_OK(only_fields(sensor, {"hand_eye_covariance", "scale_sigma", "shear_sigma"}, path));
    SensorPrior prior;
    prior.id = id;
    if (const auto c = sensor.find("hand_eye_covariance"); c != sensor.end() && !c->is_null()) {
        SEAM_TRY(auto covariance, read_pose_covariance(*c, json_path(path, "hand_eye_covariance")));
        prior.hand_eye_covariance = covariance;
    }
    if (const auto k = sensor.find("scale_sigma"); k != sensor.end() && !k->is_null()) {
        if (!k->is_array() || k->size() != 2 || !(*k)[0].is_number() || !(*k)[1].is_number())
            return input_error("not two numbers", json_path(path, "scale_sigma"),
                               "give the shares of x and z, e.g. [0.001, 0.001]");
        prior.scale_sigma = {(*k)[0].get<double>(), (*k)[1].get<double>()};
    }
    SEAM_TRY(auto shear, json_number_or(sensor, "shear_sigma", 0.0, path));
    prior.shear_sigma = shear;
    return prior;
}

Expected<FreeDof> read_free(const json& list) {
    static const std::string letters = "xyzabc";
    FreeDof free{};
    for (std::size_t i = 0; i < list.size(); ++i) {
        const std::string path = json_path("free", i);
        if (!list[i].is_string() || list[i].get<std::string>().size() != 1 ||
            letters.find(list[i].get<std::string>()) == std::string::npos)
            return input_error("not a degree of freedom", path,
                               "give some of \"x\", \"y\", \"z\", \"a\", \"b\", \"c\"");
        const std::size_t dof = letters.find(list[i].get<std::string>());
        if (free[dof]) return input_error("this degree of freedom is named twice", path);
        free[dof] = true;
    }
    return free;
}

// What a job says of its numbers where they look like others; nothing else is read.
constexpr const char* kUnits = "mm deg";
// Places within so little of each other, and ten times that of the part's frame, look like metres. Those of a sensor that is
// turned about one hole lie so in millimetres.
constexpr double kPartOfMetres = 3;

Expected<void> check_units(const std::vector<SpotObservation>& spots) {
    std::vector<double> angles;
    Eigen::AlignedBox3d places;
    for (const SpotObservation& spot : spots) {
        const KukaAbc abc = kuka_from_rotation(spot.workobject_from_sensor.linear());
        angles.insert(angles.end(), {abc.a_deg, abc.b_deg, abc.c_deg});
        places.extend(spot.workobject_from_sensor.translation());
    }
    const Text where("spots.workobject_from_sensor");
    const Text mend("write millimetres and degrees, or \"units\":\"{}\" beside the spots where they are",
                    kUnits);
    if (turns_of_radian(angles))
        return input_error("the angles look like radian: a half or a quarter turn is among them", where,
                           mend);
    const double apart = spots.size() > 1 ? places.sizes().maxCoeff() : 0;
    if (apart > 0 && apart < kPartOfMetres && places.min().cwiseAbs().maxCoeff() < 10 * kPartOfMetres)
        return input_error(Text("all spots lie within {:.3f} mm: the places look like metres", apart), where,
                           mend);
    return {};
}

Expected<Job> read_job(const std::string& file, bool needs_measured) {
    SEAM_TRY(auto text, read_text_file(file));
    SEAM_TRY(auto document, parse_json(text, file));
    SEAM_OK(only_fields(document, {"spots", "free", "limits", "sensors", "units"}, ""));
    SEAM_TRY(const auto units, json_string_or(document, "units", "", ""));
    if (!units.empty() && units != kUnits)
        return input_error(Text("\"{}\" are no units of a job", units), "units",
                           Text("write millimetres and degrees, and \"{}\" here or nothing", kUnits));
    SEAM_TRY(auto spots, json_array(document, "spots", ""));
    Job job;
    const std::filesystem::path folder = std::filesystem::path(file).parent_path();
    std::set<std::string> refused;
    for (std::size_t i = 0; i < spots->size(); ++i) {
        std::optional<Feature> contour;
        SEAM_TRY(auto spot, read_spot((*spots)[i], json_path("spots", i), folder, needs_measured, contour));
        if (contour) job.contours.push_back({spot.id, i, *contour});
        if (!contour || contour->status == FeatureStatus::ok)
            job.spots.push_back(std::move(spot));
        else if (!refused.insert(spot.id).second)
            return input_error(Text("\"{}\" is named twice", spot.id), json_path("spots", i));
    }
    if (units.empty()) {
        SEAM_OK(check_units(job.spots));
    }
    for (const SpotObservation& spot : job.spots)
        if (refused.contains(spot.id)) return input_error(Text("\"{}\" is named twice", spot.id), "spots");
    if (document.contains("free") && !document["free"].is_null()) {
        SEAM_TRY(auto list, json_array(document, "free", ""));
        SEAM_TRY(auto free, read_free(*list));
        job.options.free = free;
    }
    if (const auto sensors = document.find("sensors"); sensors != document.end() && !sensors->is_null()) {
        if (!sensors->is_object())
            return input_error("not an object", "sensors",
                               "give {\"A\":{\"hand_eye_covariance\":..}} with the spots' sensors as names");
        for (const auto& [id, sensor] : sensors->items()) {
            SEAM_TRY(auto prior, read_sensor(id, sensor, json_path("sensors", id)));
            job.options.sensors.push_back(std::move(prior));
        }
    }
    if (document.contains("limits") && !document["limits"].is_null()) {
        const json& limits = document["limits"];
        SEAM_OK(only_fields(limits, {"translation_mm", "rotation_deg"}, "limits"));
        auto translation =
            json_number_or(limits, "translation_mm", job.options.limits.translation_mm, "limits");
        if (!translation) return tl::unexpected(translation.error());
        SEAM_TRY(auto rotation,
                 json_number_or(limits, "rotation_deg", job.options.limits.rotation_deg, "limits"));
        job.options.limits = {*translation, rotation};
    }
    return job;
}

// What the contours said, into the spots of the answer, which are those of the job in its order.
void tell_contours(const Job& job, Answer& answer) {
    json& spots = answer.json["spots"];
    for (const JobContour& c : job.contours) {
        json registration = feature_json(c.found);
        if (c.found.status == FeatureStatus::ok) {
            for (json& spot : spots)
                if (spot["id"] == c.id) spot["registration"] = registration;
            continue;
        }
        answer.text +=
            fmt::format("  {:<12} refused: {}: {}\n", c.id, to_string(c.found.status), c.found.message);
        const std::size_t place = std::min(c.place, spots.size());
        spots.insert(spots.begin() + static_cast<std::ptrdiff_t>(place),
                     json{{"id", c.id},
                          {"residual_mm", nullptr},
                          {"used", false},
                          {"registration", std::move(registration)}});
    }
}

// No contour of the job was found: there is nothing to solve, which is a verdict and no bad input.
template <class Result>
Result nothing_left() {
    Result result;
    result.status = CorrectionStatus::under_determined;
    const double unknown = std::numeric_limits<double>::infinity();
    for (auto* c : {&result.covariance, &result.covariance_random}) c->diagonal().setConstant(unknown);
    for (auto* s : {&result.sigma_xyz_mm, &result.sigma_abc_deg, &result.sigma_random.xyz_mm,
                    &result.sigma_random.abc_deg})
        s->setConstant(unknown);
    return result;
}

Expected<Answer> correct(const std::string& file) {
    SEAM_TRY(auto job, read_job(file, true));
    RegionCorrection result;
    if (job.spots.empty() && !job.contours.empty()) {
        result = nothing_left<RegionCorrection>();
        result.message = "the contour of no spot was found";
    } else {
        SEAM_TRY(result, solve_region(job.spots, job.options));
    }
    Answer answer;
    answer.json = correction_json(result);
    answer.text = correction_text(result);
    tell_contours(job, answer);
    // As the gate judges it: solved, but the spots say no.
    if (!result.consistent) fmt::print(stderr, "seamwright: {}\n", result.message.english());
    answer.exit_code = result.status == CorrectionStatus::ok && result.consistent ? kExitOk : kExitVerdict;
    return answer;
}

Expected<Answer> plan(const std::string& file) {
    SEAM_TRY(auto job, read_job(file, false));
    RegionPlan result;
    if (job.spots.empty() && !job.contours.empty()) {
        result = nothing_left<RegionPlan>();
        result.advice = "the contour of no spot tells where it is";
    } else {
        SEAM_TRY(result, plan_region(job.spots, job.options));
    }
    Answer answer;
    answer.json = plan_json(result);
    answer.text = plan_text(result);
    // A plan lists no spots; those of contours are named with what they can tell.
    if (!job.contours.empty()) {
        json contours = json::array();
        for (const JobContour& c : job.contours) {
            contours.push_back({{"id", c.id}, {"registration", feature_json(c.found)}});
            if (c.found.status != FeatureStatus::ok)
                answer.text += fmt::format("  {:<12} refused: {}: {}\n", c.id, to_string(c.found.status),
                                           c.found.message);
        }
        answer.json["contours"] = std::move(contours);
    }
    answer.exit_code = result.status == CorrectionStatus::ok ? kExitOk : kExitVerdict;
    return answer;
}

}  // namespace

void add_correct(CommandLine& line) {
    CLI::App* command = line.add(
        "correct",
        "Displacement of the part from a region's measured spots.\n"
        "The answer's \"displacement\" is D: the taught frame times D follows the part. Exit 1 too where "
        "the\n"
        "spots contradict each other (\"consistent\": false): \"sigma_scattered\" is then what it is worth.",
        "seamwright correct job.json --json -\n"
        "  job.json: "
        "{\"spots\":[{\"id\":\"S1\",\"workobject_from_sensor\":{\"xyz\":[900,0,40],\"abc\":[0,0,180]},\n"
        "             "
        "\"reference\":[0,0,0],\"measured\":[1.2,0,-0.4],\"weights\":[1,0,1],\"sigma_mm\":0.05}, ...],\n"
        "             "
        "\"free\":[\"x\",\"y\",\"z\",\"a\",\"b\",\"c\"],\"limits\":{\"translation_mm\":25,\"rotation_deg\":3}"
        "}\n"
        "  What errs the same again, all optional: spots \"sensor\":\"A\", "
        "\"reference_covariance_mm2\":2x2,\n"
        "  \"robot_covariance\":6x6 (one arrival), \"reference_arrivals\":n (that the reference is the mean "
        "of),\n"
        "  and \"sensors\":{\"A\":{\"hand_eye_covariance\":6x6,\n"
        "  \"scale_sigma\":[kx,kz],\"shear_sigma\":s}}; 6x6 of translation (mm) and rotation vector (rad).\n"
        "  A spot may be told by contours: \"reference_curve\":[[x,z],..] as taught and \"curve\":[[x,z],..] "
        "of the "
        "run, or CSV\n"
        "  files beside the job, in place of \"measured\"; \"reference\":[x,0,z] (default: the curve's "
        "middle) is "
        "carried along by\n"
        "  the registration of `match`, whose covariance enters; \"window\":[dx,dz,dphi] is how far it is "
        "looked "
        "for. One that\n"
        "  slides or fits at two places is refused by name, and the others decide.\n"
        "  Places that look like metres and angles that look like radian are asked for: \"units\":\"mm deg\" "
        "says "
        "that they are none.");
    auto file = std::make_shared<std::string>();
    command->add_option("job", *file, "The job (JSON)")->required()->type_name("JOB.json");
    line.on(command, [file] { return correct(*file); });
}

void add_plan(CommandLine& line) {
    CLI::App* command =
        line.add("plan", "What a region will be able to tell, from the taught poses alone.",
                 "seamwright plan job.json      (as for `correct`, \"measured\" is not needed)");
    auto file = std::make_shared<std::string>();
    command->add_option("job", *file, "The job (JSON)")->required()->type_name("JOB.json");
    line.on(command, [file] { return plan(*file); });
}

}  // namespace seamwright::cli
