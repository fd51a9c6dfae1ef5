#include "projects/acceptance/equipment/sensor_check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/calibration/sphere/circle_section.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/acceptance/pages/acceptance_page.h"
#include "projects/acceptance/study/stored_values.h"
#include "projects/measure/measure.h"

namespace seamwright {
namespace {

using nlohmann::json;
using report::Rows;

enum class Artefact { sphere, plane };

Expected<Profile> profile_of(const json& entry, const std::string& where) {
    SEAM_TRY(auto list, json_array(entry, "profile", where));
    const std::string path = json_path(where, "profile");
    const double none = std::numeric_limits<double>::quiet_NaN();
    Profile profile;
    for (std::size_t i = 0; i < list->size(); ++i) {
        const json& point = (*list)[i];
        double x = none, z = none;
        const bool given = !point.is_null();
        if (given && !(point.is_array() && point.size() == 2 && point[0].is_number() &&
                       (point[1].is_number() || point[1].is_null())))
            return input_error("a point is not [x, z]", json_path(path, i),
                               "write two numbers, null for no return");
        if (given && point[1].is_number()) x = point[0].get<double>(), z = point[1].get<double>();
        profile.x_mm.push_back(x);
        profile.z_mm.push_back(z);
    }
    return profile;
}

// The points of an artefact in the base, from profiles at known poses.
Expected<std::vector<Eigen::Vector3d>> points_of(const json& observations, const Pose& flange_from_sensor,
                                                 const std::set<std::string>& exclude, Artefact artefact,
                                                 const std::string& where, int& without) {
    std::vector<Eigen::Vector3d> points;
    for (std::size_t i = 0; i < observations.size(); ++i) {
        const std::string path = json_path(where, i);
        const json& entry = observations[i];
        SEAM_TRY(auto field, json_field(entry, "base_from_flange", path));
        if (entry.contains("id") && entry["id"].is_string() &&
            exclude.contains(entry["id"].get<std::string>()))
            continue;
        SEAM_TRY(auto pose, parse_pose(*field, json_path(path, "base_from_flange")));
        SEAM_TRY(auto profile, profile_of(entry, path));
        std::vector<int> its;
        if (artefact == Artefact::sphere) {
            if (const auto section = find_circle_section(profile, {})) its = section->inliers;
            without += its.empty();
        } else {
            for (std::size_t k = 0; k < profile.size(); ++k)
                if (std::isfinite(profile.z_mm[k])) its.push_back(static_cast<int>(k));
        }
        for (const int k : its) {
            const auto at = static_cast<std::size_t>(k);
            points.push_back(pose * flange_from_sensor *
                             Eigen::Vector3d(profile.x_mm[at], 0, profile.z_mm[at]));
        }
    }
    return points;
}

class SensorData {
  public:
    SensorData(const json& data, std::string where, const Project* project, SensorCheck& check)
        : data_(data), where_(std::move(where)), project_(project), check_(check) {}

    Expected<SensorStudyData> read() {
        if (auto known = only_fields(
                data_, {"sensor", "flange_from_sensor", "limits_mm", "spheres", "distances", "planes"}, "");
            !known)
            return tl::unexpected(known.error());
        SEAM_OK(sensor());
        if (data_.contains("limits_mm")) {
            const json& limits = data_["limits_mm"];
            if (auto known = only_fields(limits, {"form", "size", "distance", "flatness"}, "limits_mm");
                !known)
                return tl::unexpected(known.error());
            for (const auto& [key, value] : {std::pair{"form", &study_.limits.form_mm},
                                             {"size", &study_.limits.size_mm},
                                             {"distance", &study_.limits.distance_mm},
                                             {"flatness", &study_.limits.flatness_mm}}) {
                SEAM_TRY(auto number, json_number_or(limits, key, 0, "limits_mm"));
                *value = number;
            }
        }
        for (const auto& [list, kind] :
             {std::pair{"spheres", Artefact::sphere}, {"planes", Artefact::plane}}) {
            if (!data_.contains(list)) continue;
            SEAM_TRY(auto entries, json_array(data_, list, ""));
            for (std::size_t i = 0; i < entries->size(); ++i)
                SEAM_OK(artefact((*entries)[i], json_path(list, i), kind, entries->size()));
        }
        SEAM_OK(distances());
        return std::move(study_);
    }

  private:
    Expected<void> sensor() {
        SEAM_TRY(auto id, json_string_or(data_, "sensor", "", ""));
        check_.source.sensor = id;
        if (data_.contains("flange_from_sensor")) {
            SEAM_TRY(auto pose, parse_pose(data_["flange_from_sensor"], "flange_from_sensor"));
            flange_from_sensor_ = pose;
        }
        if (!project_) return {};
        const SensorSetup* setup = id.empty() && project_->sensors.size() == 1 ? &project_->sensors.front()
                                                                               : find_sensor(*project_, id);
        if (!setup)
            return input_error(id.empty() ? Text("the project has {} sensors", project_->sensors.size())
                                          : Text("there is no sensor \"{}\"", id),
                               "sensor", "name one of the project's");
        Spot spot;
        spot.sensor_id = setup->id;
        if (const Calibration* in_use = calibration_of(*project_, setup->id)) {
            spot.robot_id = in_use->robot_id;
            in_use_ = in_use;
            if (!flange_from_sensor_) flange_from_sensor_ = in_use->flange_from_sensor;
        }
        name_devices(check_.source, *project_, spot);
        return {};
    }

    // Observations that a calibration of the project keeps, and which of them it left out.
    const json* stored(const std::string& id, bool alone, std::set<std::string>& exclude) {
        if (!project_) return nullptr;
        const Calibration* from = nullptr;
        for (const Calibration& c : project_->calibrations)
            if (c.id == id) from = &c;
        if (!from && alone) from = in_use_;
        if (!from) return nullptr;
        const json* raw = &from->raw;
        if (raw->contains("exclude") && (*raw)["exclude"].is_array())
            for (const json& left : (*raw)["exclude"])
                if (left.is_string()) exclude.insert(left.get<std::string>());
        if (raw->contains("data")) raw = &(*raw)["data"];
        if (!raw->is_object() || !raw->contains("observations")) return nullptr;
        check_.remarks.push_back(
            Text("{}: from the profiles of calibration {}. Where the sensor sits was solved from them too.",
                 id, from->id));
        return &(*raw)["observations"];
    }

    Expected<void> artefact(const json& entry, const std::string& where, Artefact kind, std::size_t of) {
        const bool sphere = kind == Artefact::sphere;
        const auto known =
            sphere
                ? only_fields(entry,
                              {"id", "diameter_mm", "diameter_u_mm", "form_mm", "certificate", "points",
                               "observations"},
                              where)
                : only_fields(entry, {"id", "flatness_mm", "certificate", "points", "observations"}, where);
        if (!known) return known;
        SEAM_TRY(auto id, json_string(entry, "id", where));
        SEAM_TRY(auto certificate, json_string_or(entry, "certificate", "", where));
        check_.certificates.emplace_back(id, certificate);

        std::vector<Eigen::Vector3d> points;
        int without = 0;
        std::set<std::string> exclude;
        const json* observations = nullptr;
        if (entry.contains("points")) {
            SEAM_TRY(auto list, json_array(entry, "points", where));
            for (std::size_t i = 0; i < list->size(); ++i) {
                SEAM_TRY(auto xyz, as_numbers((*list)[i], 3, json_path(json_path(where, "points"), i)));
                points.emplace_back(xyz[0], xyz[1], xyz[2]);
            }
        } else if (entry.contains("observations")) {
            SEAM_TRY(auto list, json_array(entry, "observations", where));
            observations = list;
        } else {
            observations = sphere ? stored(id, of == 1, exclude) : nullptr;
            if (!observations || !observations->is_array())
                return input_error(
                    Text("there are no data of \"{}\"", id), where,
                    "give points or observations, or the project whose calibration keeps them");
        }
        if (observations) {
            if (!flange_from_sensor_)
                return input_error("where the sensor sits on the flange is not known", where,
                                   "give flange_from_sensor");
            SEAM_TRY(auto found, points_of(*observations, *flange_from_sensor_, exclude, kind,
                                           json_path(where, "observations"), without));
            points = std::move(found);
        }
        if (without > 0) check_.remarks.push_back(Text("{}: profiles that show no sphere: {}.", id, without));

        const auto number = [&](const char* key) { return json_number_or(entry, key, 0, where); };
        if (!sphere) {
            SEAM_TRY(auto flatness, number("flatness_mm"));
            study_.planes.push_back({id, std::move(points), flatness});
            return {};
        }
        auto u = number("diameter_u_mm"), form = number("form_mm"), diameter = number("diameter_mm");
        for (const auto* given : {&u, &form, &diameter})
            if (!*given) return tl::unexpected(given->error());
        study_.spheres.push_back({id, std::move(points), {}, *u, *form});
        if (entry.contains("diameter_mm")) study_.spheres.back().diameter_mm = *diameter;
        return {};
    }

    Expected<void> distances() {
        if (!data_.contains("distances")) return {};
        SEAM_TRY(auto entries, json_array(data_, "distances", ""));
        for (std::size_t i = 0; i < entries->size(); ++i) {
            const std::string where = json_path("distances", i);
            const json& entry = (*entries)[i];
            SEAM_OK(only_fields(entry, {"from", "to", "length_mm", "u_mm"}, where));
            auto from = json_string(entry, "from", where), to = json_string(entry, "to", where);
            auto length = json_number(entry, "length_mm", where), u = json_number_or(entry, "u_mm", 0, where);
            if (!from) return tl::unexpected(from.error());
            if (!to) return tl::unexpected(to.error());
            if (!length) return tl::unexpected(length.error());
            if (!u) return tl::unexpected(u.error());
            study_.distances.push_back({*from, *to, *length, *u});
        }
        return {};
    }

    const json& data_;
    std::string where_;
    const Project* project_;
    SensorCheck& check_;
    std::optional<Pose> flange_from_sensor_;
    const Calibration* in_use_ = nullptr;
    SensorStudyData study_;
};

json index_json(const SensorIndex& i) {
    return {{"value", i.value_mm},
            {"U", i.U_mm},
            {"limit", i.limit_mm > 0 ? json(i.limit_mm) : json()},
            {"verdict", i.verdict ? json(to_string(*i.verdict)) : json()}};
}

}  // namespace

Expected<SensorCheck> sensor_check(const json& data, const std::string& where, const Project* project) {
    SensorCheck check;
    auto read = SensorData(data, where, project, check).read();
    if (read) {
        auto study = sensor_study(*read);
        if (study) {
            check.study = std::move(*study);
            check.source.file = where;
            return check;
        }
        read = tl::unexpected(study.error());
    }
    read.error().within(where);
    return tl::unexpected(read.error());
}

json sensor_check_json(const SensorCheck& c) {
    json spheres = json::array(), planes = json::array(), distances = json::array(), remarks = json::array(),
         certificates = json::object();
    for (const auto& [id, certificate] : c.certificates) certificates[id] = certificate;
    for (const Text& remark : c.remarks) remarks.push_back(remark.in(Language::english));
    for (const ProbedSphere& s : c.study.spheres)
        spheres.push_back({{"id", s.id},
                           {"points", s.points},
                           {"left_out", s.left_out},
                           {"centre_mm", {s.centre_mm.x(), s.centre_mm.y(), s.centre_mm.z()}},
                           {"diameter_mm", s.diameter_mm},
                           {"rms_mm", s.rms_mm},
                           {"probing_form", index_json(s.form)},
                           {"probing_size", s.size ? index_json(*s.size) : json()}});
    for (const ProbedPlane& p : c.study.planes)
        planes.push_back({{"id", p.id},
                          {"points", p.points},
                          {"left_out", p.left_out},
                          {"rms_mm", p.rms_mm},
                          {"flatness", index_json(p.flatness)}});
    for (const ProbedDistance& d : c.study.distances)
        distances.push_back({{"from", d.from},
                             {"to", d.to},
                             {"measured_mm", d.measured_mm},
                             {"sphere_distance", index_json(d.error)}});
    return {{"spheres", spheres},
            {"planes", planes},
            {"distances", distances},
            {"certificates", certificates},
            {"sensor", c.source.sensor},
            {"sensor_serial", c.source.sensor_serial},
            {"simulated", c.source.simulated},
            {"remarks", remarks},
            {"verdict", to_string(c.study.verdict)}};
}

void add_chapter(report::Page& page, Language language, const SensorCheck& c, int level) {
    const auto t = [&]<class... A>(const char* english, const A&... arguments) {
        return Text::chosen(english, arguments...).in(language);
    };
    page.heading(t("Sensor against certified artefacts"), level);
    page.verdict(name_of(c.study.verdict).in(language), tone_of(c.study.verdict),
                 c.study.verdict == AcceptanceVerdict::too_little_data
                     ? t("no largest permitted error is given: the values are stated, not judged")
                     : t("the worst of the indices below"));
    if (c.source.simulated)
        page.verdict(t("simulated"), report::Tone::attention, t("the cell was simulated"));
    Rows rows{{t("Index"), t("Artefact"), t("Points"), t("Value") + " (mm)", "U (mm)", t("permitted (mm)"),
               t("Verdict")}};
    const auto row = [&](const std::string& name, const std::string& id, const std::string& points,
                         const SensorIndex& i) {
        rows.push_back({name, id, points, fmt::format("{:.4f}", i.value_mm), fmt::format("{:.4f}", i.U_mm),
                        i.limit_mm > 0 ? fmt::format("{:.4f}", i.limit_mm) : "-",
                        i.verdict ? name_of(*i.verdict).in(language) : t("not judged")});
    };
    for (const ProbedSphere& s : c.study.spheres) {
        row(t("probing form"), s.id, std::to_string(s.points), s.form);
        if (s.size) row(t("probing size"), s.id, std::to_string(s.points), *s.size);
    }
    for (const ProbedDistance& d : c.study.distances)
        row(t("sphere distance"), d.from + " - " + d.to, "-", d.error);
    for (const ProbedPlane& p : c.study.planes)
        row(t("flatness"), p.id, std::to_string(p.points), p.flatness);
    page.table(rows);
    Rows certificates{{t("Artefact"), t("Certificate")}};
    for (const auto& [id, certificate] : c.certificates)
        certificates.push_back({id, certificate.empty() ? t("not named") : certificate});
    page.table(certificates);
    for (const Text& remark : c.remarks) page.paragraph(remark.in(language));
    page.paragraph(
        t("In the spirit of VDI/VDE 2634 part 2, not by its letter: the artefacts stood where the data were "
          "taken, and points from a robot's poses hold the robot's error too. Three of a thousand points may "
          "be "
          "left out. Judged by ISO 14253-1 with U of the certificate."));
}

}  // namespace seamwright
