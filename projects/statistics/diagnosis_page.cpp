#include <fmt/format.h>

#include <cmath>

#include "projects/statistics/diagnosis.h"

namespace seamwright {
namespace {

using nlohmann::json;

json numbers_json(const Eigen::VectorXd& v) {
    return std::vector<double>(v.data(), v.data() + v.size());
}

json motion_json(const Vector6& motion, const Matrix6& covariance) {
    const Vector6 sigma = covariance.diagonal().cwiseMax(0).cwiseSqrt();
    const auto degrees = [](const Vector6& v) {
        return json{deg_from_rad(v(3)), deg_from_rad(v(4)), deg_from_rad(v(5))};
    };
    return {{"xyz_mm", {motion(0), motion(1), motion(2)}},
            {"rotation_deg", degrees(motion)},
            {"sigma_xyz_mm", {sigma(0), sigma(1), sigma(2)}},
            {"sigma_rotation_deg", degrees(sigma)}};
}

std::string carrier_name(const CarrierDiagnosis& d, std::size_t carrier) {
    return d.carriers[carrier];
}

json change_json(const CarrierDiagnosis& d, const Change& change, const Text& said) {
    const auto car = [&](std::size_t i) {
        return json{{"run", d.cars[i].run}, {"part", d.cars[i].part}, {"utc", d.cars[i].utc}};
    };
    json elements = json::array();
    for (const ElementMoved& e : change.elements) {
        const FixtureElement& element = d.fixture->elements[e.element];
        json directions = json::array();
        for (const Eigen::Vector3d& n : element.directions) directions.push_back({n.x(), n.y(), n.z()});
        elements.push_back({{"id", element.id},
                            {"probability", e.probability},
                            {"directions", directions},
                            {"amount_mm", numbers_json(e.amount_mm)},
                            {"sigma_mm", numbers_json(e.sigma_mm)}});
    }
    json out = {{"what", change.what == Moved::cell ? "cell" : "carrier"},
                {"how", change.how == MovedBy::step ? "step" : "trend"},
                {"since", car(change.first_car)},
                {"earliest", car(change.earliest)},
                {"latest", car(change.latest)},
                {"motion", motion_json(change.motion, change.covariance)},
                {"statistic", change.statistic},
                {"by_chance", change.probability},
                {"elements", elements},
                {"several_probability", change.elements.empty() ? json() : json(change.several)},
                {"text", said}};
    if (change.what == Moved::carrier) out["carrier"] = carrier_name(d, change.carrier);
    return out;
}

}  // namespace

json diagnosis_json(const CarrierDiagnosis& d) {
    json changes = json::array(), carriers = json::array(), apart = json::array();
    for (std::size_t i = 0; i < d.numbers.changes.size(); ++i)
        changes.push_back(change_json(d, d.numbers.changes[i], d.sentences[i]));
    for (std::size_t c = 0; c < d.numbers.carriers.size(); ++c) {
        const CarrierEffect& e = d.numbers.carriers[c];
        if (e.cars == 0) continue;
        json one = motion_json(e.motion, e.covariance);
        one["carrier"] = carrier_name(d, c);
        one["cars"] = e.cars;
        carriers.push_back(std::move(one));
    }
    for (const NotTold& n : d.not_told)
        apart.push_back(
            {{"one", n.one}, {"other", n.other}, {"cars", std::isfinite(n.cars) ? json(n.cars) : json()}});
    return {{"status", d.numbers.status == DiagnosisStatus::too_few ? "too_few"
                       : d.changed()                                ? "moved"
                                                                    : "ok"},
            {"text", d.verdict},
            {"cars", d.numbers.cars},
            {"odd_cars", d.numbers.odd_cars},
            {"without_carrier", d.no_carrier},
            {"not_solved", d.not_solved},
            {"partial_regions", d.partial_regions},
            {"correlation", d.numbers.correlation},
            {"car_scatter", motion_json(Vector6::Zero(), d.numbers.car_covariance)},
            {"changes", changes},
            {"carriers", carriers},
            {"cannot_tell_apart", {{"amount_mm", kToldMm}, {"pairs", apart}}}};
}

void write_diagnosis(const CarrierDiagnosis& d, Language language, report::Page& page) {
    const auto t = [&](const Text& text) { return text.in(language); };
    page.heading(t("What has moved"));
    const bool few = d.numbers.status == DiagnosisStatus::too_few;
    page.verdict(t(few           ? Text("too few cars")
                   : d.changed() ? Text("moved")
                                 : Text("nothing moved")),
                 few           ? report::Tone::neutral
                 : d.changed() ? report::Tone::alarm
                               : report::Tone::good,
                 t(d.verdict));
    for (const Text& said : d.sentences) page.paragraph(t(said));
    if (d.no_carrier > 0) page.paragraph(t(Text("{} parts name no carrier and are left out.", d.no_carrier)));
    if (d.numbers.odd_cars > 0)
        page.paragraph(
            t(Text("{} single cars lay far off the ones before and after them in their carrier and are "
                   "left out.",
                   d.numbers.odd_cars)));
    if (few) return;
    const bool named = d.carriers.size() > 1 || !d.carriers.front().empty();
    if (named) {
        report::Rows rows{
            {t("Carrier"), t("Parts"), "X (mm)", "Y (mm)", "Z (mm)", "sigma X", "sigma Y", "sigma Z"}};
        for (std::size_t c = 0; c < d.numbers.carriers.size(); ++c) {
            const CarrierEffect& e = d.numbers.carriers[c];
            if (e.cars == 0) continue;
            std::vector<std::string> row{d.carriers[c], std::to_string(e.cars)};
            for (int axis = 0; axis < 3; ++axis) row.push_back(fmt::format("{:+.3f}", e.motion(axis)));
            for (int axis = 0; axis < 3; ++axis)
                row.push_back(fmt::format("{:.3f}", std::sqrt(std::max(0.0, e.covariance(axis, axis)))));
            rows.push_back(std::move(row));
        }
        page.table(rows, t("How each carrier lies off the mean of all, changes taken off"));
    }
    if (!d.not_told.empty()) {
        report::Rows rows{{t("Element"), t("Element"), t("Cars to tell them apart")}};
        for (const NotTold& n : d.not_told)
            rows.push_back(
                {n.one, n.other, std::isfinite(n.cars) ? fmt::format("{:.0f}", n.cars) : t("never")});
        page.table(rows, t(Text("What {:.1f} mm of the one cannot be told from the other by {} cars", kToldMm,
                                static_cast<int>(kManyCars))));
    }
}

}  // namespace seamwright
