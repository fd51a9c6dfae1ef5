// seamwright correct, seamwright plan: a region's displacement from its spots, and its prediction.

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "app/cli/answers/result_json.h"
#include "app/cli/command.h"
#include "core/correction/correction.h"
#include "devices/exchange/files.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

struct Job {
    std::vector<SpotObservation> spots;
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

Expected<SpotObservation> read_spot(const json& spot, const std::string& path, bool needs_measured) {
    if (auto known = only_fields(
            spot,
            {"id", "workobject_from_sensor", "reference", "measured", "weights", "sigma_mm", "covariance_mm2",
             "sensor", "reference_covariance_mm2", "robot_covariance", "reference_arrivals"},
            path);
        !known)
        return tl::unexpected(known.error());
    SpotObservation s;
    SEAM_TRY(auto id, json_string(spot, "id", path));
    s.id = id;
    SEAM_TRY(auto pose, json_field(spot, "workobject_from_sensor", path));
    SEAM_TRY(auto parsed, parse_pose(*pose, json_path(path, "workobject_from_sensor")));
    s.workobject_from_sensor = parsed;
    SEAM_TRY(auto reference, json_vector3(spot, "reference", path));
    s.reference_mm = s.measured_mm = reference;
    if (needs_measured) {
        SEAM_TRY(auto measured, json_vector3(spot, "measured", path));
        s.measured_mm = measured;
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

Expected<Job> read_job(const std::string& file, bool needs_measured) {
    SEAM_TRY(auto text, read_text_file(file));
    SEAM_TRY(auto document, parse_json(text, file));
    SEAM_OK(only_fields(document, {"spots", "free", "limits", "sensors"}, ""));
    SEAM_TRY(auto spots, json_array(document, "spots", ""));
    Job job;
    for (std::size_t i = 0; i < spots->size(); ++i) {
        SEAM_TRY(auto spot, read_spot((*spots)[i], json_path("spots", i), needs_measured));
        job.spots.push_back(std::move(spot));
    }
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

Expected<Answer> correct(const std::string& file) {
    SEAM_TRY(auto job, read_job(file, true));
    SEAM_TRY(auto result, solve_region(job.spots, job.options));
    Answer answer;
    answer.json = correction_json(result);
    answer.text = correction_text(result);
    answer.exit_code = result.status == CorrectionStatus::ok ? kExitOk : kExitVerdict;
    return answer;
}

Expected<Answer> plan(const std::string& file) {
    SEAM_TRY(auto job, read_job(file, false));
    SEAM_TRY(auto result, plan_region(job.spots, job.options));
    Answer answer;
    answer.json = plan_json(result);
    answer.text = plan_text(result);
    answer.exit_code = result.status == CorrectionStatus::ok ? kExitOk : kExitVerdict;
    return answer;
}

}  // namespace

void add_correct(CommandLine& line) {
    CLI::App* command = line.add(
        "correct",
        "Displacement of the part from a region's measured spots.\n"
        "The answer's \"displacement\" is D: the taught frame times D follows the part.",
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
        "  \"scale_sigma\":[kx,kz],\"shear_sigma\":s}}; 6x6 of translation (mm) and rotation vector (rad).");
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
