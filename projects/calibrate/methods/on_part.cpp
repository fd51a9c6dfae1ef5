// {"passes":[{"id"?,"edge":"e1","profiles":[{"time_s","base_from_flange":POSE,"point":[x,z],"covariance":[[..],[..]]?}]}],
//  "prior":{"flange_from_sensor":POSE,"covariance":6x6}?,"latency":"free" | seconds?,
//  "robot":{"sigma_mm","sigma_deg"}?}
// -> {"status":"ok|undetermined|not_converged","flange_from_sensor","covariance" 6x6 (tangent of pose.h: mm, rad; also as
//     "covariance_pose"),"sigma":{"xyz_mm","abc_deg","working_mm"},"latency_s","latency_sigma_s","unobservable":[..],
//     "advice" (one sentence),"next_passes":[..],"per_pass":[{"id","edge","profiles","left_out","used","rms_mm","note"}],
//     "edges":[{"id","kind":"straight|curved","curvature_per_mm","length_mm","passes","rms_mm"}],
//     "moved":{"moved","chi_squared","limit","directions","shift_mm","turn_deg"} or null (no prior),
//     "rms_mm","noise_mm","pass_error_mm","working_point_mm",...}
// p_k = F(t_k - latency) flange_from_sensor (x, 0, z): a latency above zero means that the profile is older than its
// stamp. latency_s is null when it is not determined; absent in the data it is "free".

#include <charconv>
#include <cmath>

#include "core/calibration/on_part/on_part.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/input/entry.h"
#include "projects/calibrate/methods/example/example_cell.h"
#include "projects/calibrate/methods/methods.h"
#include "projects/file/stored_text.h"

namespace seamwright {

using nlohmann::json;

namespace {

constexpr std::size_t kMostProfiles = 200000;

Expected<Eigen::MatrixXd> square_matrix(const json& rows, std::size_t size, const std::string& where) {
    if (!rows.is_array() || rows.size() != size)
        return input_error(Text("this is no {} x {} matrix", size, size), where, "write rows of numbers");
    const auto n = static_cast<Eigen::Index>(size);
    Eigen::MatrixXd matrix(n, n);
    for (std::size_t i = 0; i < size; ++i) {
        SEAM_TRY(auto row, as_numbers(rows[i], size, json_path(where, i)));
        matrix.row(static_cast<Eigen::Index>(i)) = Eigen::Map<const Eigen::RowVectorXd>(row.data(), n);
    }
    return matrix;
}

Expected<EdgeProfile> parse_edge_profile(const json& entry, const std::string& where) {
    EdgeProfile profile;
    SEAM_TRY(auto time, json_number(entry, "time_s", where));
    profile.time_s = time;
    SEAM_TRY(auto field, json_field(entry, "base_from_flange", where));
    SEAM_TRY(auto pose, parse_pose(*field, json_path(where, "base_from_flange")));
    profile.base_from_flange = pose;
    SEAM_TRY(auto point, json_vector2(entry, "point", where));
    profile.point_mm = point;
    if (const auto it = entry.find("covariance"); it != entry.end() && !it->is_null()) {
        SEAM_TRY(auto covariance, square_matrix(*it, 2, json_path(where, "covariance")));
        SEAM_OK(check_variances(covariance.diagonal(), json_path(where, "covariance")));
        profile.covariance_mm2 = covariance;
    }
    return profile;
}

Expected<std::vector<EdgePass>> parse_edge_passes(const json& data) {
    SEAM_TRY(auto list, json_array(data, "passes", ""));
    std::vector<EdgePass> passes;
    std::size_t all = 0;
    for (std::size_t i = 0; i < list->size(); ++i) {
        const json& entry = (*list)[i];
        const std::string where = json_path("passes", i);
        EdgePass pass;
        SEAM_TRY(auto id, entry_id(entry, i, where));
        pass.id = id;
        SEAM_TRY(auto edge, json_string(entry, "edge", where));
        pass.edge = edge;
        SEAM_TRY(auto profiles, json_array(entry, "profiles", where));
        if ((all += profiles->size()) > kMostProfiles)
            return input_error(Text("more than {} profiles", kMostProfiles), where, "thin them out");
        for (std::size_t k = 0; k < profiles->size(); ++k) {
            SEAM_TRY(auto profile,
                     parse_edge_profile((*profiles)[k], json_path(json_path(where, "profiles"), k)));
            pass.profiles.push_back(profile);
        }
        passes.push_back(std::move(pass));
    }
    return passes;
}

Expected<std::optional<double>> parse_latency(const json& data) {
    const auto it = data.find("latency");
    if (it == data.end() || it->is_null()) return std::nullopt;
    const auto bad = [] {
        return input_error("the latency is neither free nor a number of seconds", "latency",
                           "write \"free\" or seconds");
    };
    if (it->is_number()) return it->get<double>();
    if (!it->is_string()) return bad();
    const std::string& text = it->get_ref<const std::string&>();
    if (text == "free") return std::nullopt;
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) return bad();
    return value;
}

Expected<OnPartOptions> parse_on_part_options(const json& data, const ExcludedIds& exclude) {
    OnPartOptions options;
    options.exclude = exclude;
    SEAM_TRY(auto latency, parse_latency(data));
    options.latency_s = latency;
    SEAM_TRY(const auto robot, repeatability_of(data));
    if (robot.stated()) options.robot = robot;
    if (const auto it = data.find("prior"); it != data.end() && !it->is_null()) {
        SEAM_TRY(auto field, json_field(*it, "flange_from_sensor", "prior"));
        SEAM_TRY(auto pose, parse_pose(*field, "prior.flange_from_sensor"));
        SEAM_TRY(auto rows, json_field(*it, "covariance", "prior"));
        SEAM_TRY(auto covariance, square_matrix(*rows, 6, "prior.covariance"));
        SEAM_OK(check_variances(covariance.diagonal(), "prior.covariance"));
        options.prior = MountingPrior{pose, Matrix6(covariance)};
    }
    return options;
}

json edges_json(const OnPartResult& solved) {
    json edges = json::array();
    for (const PartEdge& e : solved.edges)
        edges.push_back({{"id", e.id},
                         {"kind", e.straight ? "straight" : "curved"},
                         {"curvature_per_mm", number_json(e.curvature_per_mm)},
                         {"length_mm", number_json(e.length_mm)},
                         {"passes", e.passes},
                         {"rms_mm", number_json(e.rms_mm)}});
    return edges;
}

json per_pass_json(const OnPartResult& solved, const std::vector<EdgePass>& passes) {
    json list = json::array();
    for (std::size_t i = 0; i < passes.size(); ++i) {
        const PoseResidual& p = solved.report.poses[i];
        json one{{"id", p.id},
                 {"edge", passes[i].edge},
                 {"profiles", passes[i].profiles.size()},
                 {"left_out", solved.left_out_profiles[i]},
                 {"used", p.used},
                 {"rms_mm", number_json(p.rms_mm)}};
        put_text(one, "note", p.note);
        list.push_back(std::move(one));
    }
    return list;
}

json moved_json(const OnPartResult& solved) {
    if (!solved.bump) return nullptr;
    const BumpTest& b = *solved.bump;
    return {{"moved", b.moved},
            {"chi_squared", number_json(b.chi_squared)},
            {"limit", number_json(b.limit)},
            {"directions", b.directions},
            {"shift_mm", number_json(b.shift_mm)},
            {"turn_deg", number_json(b.turn_deg)}};
}

Expected<CalibrationSolution> solve_on_part(const json& data, const ExcludedIds& exclude) {
    SEAM_TRY(auto passes, parse_edge_passes(data));
    SEAM_TRY(auto options, parse_on_part_options(data, exclude));
    SEAM_TRY(auto solved, calibrate_on_part(passes, options));

    CalibrationSolution solution;
    json& result = solution.document;
    const bool ok = solved.status == OnPartStatus::ok;
    if (ok) solution.found = SensorOnFlange{{solved.flange_from_sensor, solved.covariance}};
    const bool latency = ok && solved.latency_known;
    result["status"] = std::string(name_of(solved.status));
    result["flange_from_sensor"] = ok ? pose_json(solved.flange_from_sensor) : json(nullptr);
    result["latency_s"] = latency ? number_json(solved.latency_s) : json(nullptr);
    result["latency_sigma_s"] = latency ? number_json(solved.latency_sigma_s) : json(nullptr);
    result["sigma"] = nullptr;
    if (ok) {
        result["sigma"] = pose_sigma_json(solved.flange_from_sensor, solved.covariance);
        result["sigma"]["working_mm"] = number_json(solved.working_sigma_mm);
        result["rms_mm"] = number_json(solved.rms_mm);
        result["noise_mm"] = number_json(solved.noise_mm);
        result["pass_error_mm"] = number_json(solved.pass_error_mm);
        result["working_point_mm"] = vector_json(solved.working_point_mm);
        result["covariance_pose"] = matrix_json(solved.covariance);
    }
    Text advice;
    for (const Text& next : solved.advice) advice = joined(advice, "; ", next);
    put_text(result, "advice", advice);
    put_texts(result, "next_passes", solved.advice);
    put_texts(result, "unobservable", solved.open);
    result["edges"] = edges_json(solved);
    result["moved"] = moved_json(solved);
    result["per_pass"] = per_pass_json(solved, passes);
    solution.notices = std::move(solved.notices);
    if (solved.bump && (ok || solved.bump->moved))
        solution.notices.insert(
            solution.notices.begin(),
            solved.bump->moved
                ? Text("the sensor has moved: the data contradict its old place (chi squared {:.3g} of "
                       "{:.3g})",
                       solved.bump->chi_squared, solved.bump->limit)
                : Text("nothing shows that the sensor has moved (chi squared {:.3g} of {:.3g})",
                       solved.bump->chi_squared, solved.bump->limit));
    solution.degenerate = std::move(solved.open);
    solution.report = std::move(solved.report);
    finish_document(solution);
    // Of the pose alone, in the one tangent, as programs read it; the parameters' sigmas stand beside them.
    result["covariance"] = ok ? result["covariance_pose"] : json(nullptr);
    return solution;
}

// A gently bent edge, passed ten times to and fro with small S-shaped motions and from some attitudes.
json on_part_example() {
    constexpr double kRadius_mm = 400, kHalf_mm = 15, kSpeed_mm_s = 40, kLatency_s = 0.004;
    constexpr double kNoise_mm = 0.02, kPass_mm = 0.02;
    constexpr int kProfiles = 20;
    example::Dither dither;
    const Pose target = example::base_from_target(), mounting = example::flange_from_sensor();
    const auto edge = [&](double u) {
        return Eigen::Vector3d(target * Eigen::Vector3d(kRadius_mm * (1 - std::cos(u / kRadius_mm)),
                                                        kRadius_mm * std::sin(u / kRadius_mm), 0));
    };
    json passes = json::array();
    for (int i = 0; i < 12; ++i) {
        const double sign = i % 2 == 0 ? 1 : -1, duration = 2 * kHalf_mm / kSpeed_mm_s;
        const Eigen::Vector3d lean(0.3 * std::sin(1.3 * i), 0.3 * std::cos(1.9 * i),
                                   0.3 * std::sin(2.7 * i + 1));
        const double aside = 5 * std::sin(2.1 * i), high = 5 * std::cos(1.1 * i);
        const Pose robot = example::shaken(Pose::Identity(), dither, kPass_mm, kPass_mm / 172);
        const auto sensor_at = [&](double t) {
            const double phase = 2 * kPi * t / duration + i;
            const Eigen::Vector3d turn =
                lean + 0.04 * Eigen::Vector3d(std::sin(phase), std::cos(phase), std::sin(0.7 * phase));
            const Eigen::Matrix3d r = target.linear() * rotation_exp(turn);
            return make_pose(
                r, edge(sign * (t * kSpeed_mm_s - kHalf_mm)) -
                       r * Eigen::Vector3d(aside + 2 * std::sin(phase), 0, high + 2 * std::cos(phase)));
        };
        json profiles = json::array();
        for (int k = 0; k < kProfiles; ++k) {
            const double t = duration * k / (kProfiles - 1);
            const Pose seen_by = sensor_at(t - kLatency_s).inverse();
            // Its own plane goes through the edge at u by construction.
            const Eigen::Vector3d seen = seen_by * edge(sign * ((t - kLatency_s) * kSpeed_mm_s - kHalf_mm));
            profiles.push_back(
                {{"time_s", t},
                 {"base_from_flange", pose_json(sensor_at(t) * mounting.inverse() * robot)},
                 {"point", example::pair_json(seen.x() + dither(kNoise_mm), seen.z() + dither(kNoise_mm))}});
        }
        passes.push_back({{"id", "P" + std::to_string(i + 1)}, {"edge", "e1"}, {"profiles", profiles}});
    }
    return {{"latency", "free"}, {"passes", passes}};
}

}  // namespace

CalibrationMethod on_part_method() {
    CalibrationMethod m;
    m.id = "on-part";
    m.help = "Sensor on the flange and latency from passes over an edge of the part";
    m.usage = "passes.json --exclude P3";
    m.layout = R"({"passes":[{"id"?,"edge":"e1","profiles":[{"time_s","base_from_flange":POSE,"point":[x,z],
     "covariance":[[xx,xz],[xz,zz]]?},..]},..],"latency":"free" or seconds?,
   "prior":{"flange_from_sensor":POSE,"covariance":6x6 (mm, rad)}?,"robot":{"sigma_mm","sigma_deg"}?}
  p_k = F(t_k - latency) flange_from_sensor (x,0,z) lies on the edge; latency above zero: the profile is older than its stamp)";
    m.fields = {{"", {"passes", "latency", "prior", "robot"}},
                {"passes[]", {"id", "edge", "profiles"}},
                {"passes[].profiles[]", {"time_s", "base_from_flange", "point", "covariance"}},
                {"prior", {"flange_from_sensor", "covariance"}},
                robot_fields()};
    m.example = on_part_example;
    m.quantities = {{"passes[].profiles[].base_from_flange"},
                    {"passes[].profiles[].point", QuantityKind::lengths}};
    m.solve = solve_on_part;
    m.entries = "passes";
    m.repeatability = true;
    m.capture = CaptureKind::files;
    m.fewest = 2;
    m.advised = 12;
    m.title = "Sensor on the flange (on the part)";
    m.why =
        "Finds where the sensor sits on the flange from passes over an edge of the part, without a target.";
    m.need = {
        "A smooth edge of the part, straight or bent; its shape need not be known.",
        "12 or more short S-shaped passes in both directions, leaning about all three axes, the edge off the "
        "middle to both sides.",
        "The part stands still meanwhile; every profile has its time and its robot pose."};
    m.file = "JSON with passes: times, robot poses and feature points";
    m.drawing = SetUpDrawing::triangle;
    return m;
}

}  // namespace seamwright
