#include <fmt/format.h>

#include <cmath>

#include "devices/exchange/pose_json.h"
#include "projects/scan/fit_report.h"

namespace seamwright {
namespace {

using nlohmann::json;

json numbers(const Eigen::Ref<const Eigen::VectorXd>& v) {
    json out = json::array();
    for (const double x : v) out.push_back(x);
    return out;
}

bool has_covariance(const SurfaceFit& fit) {
    return fit.status == FitStatus::ok || fit.status == FitStatus::ambiguous;
}

json sigma_json(const Matrix6& covariance) {
    const Vector6 sigma = covariance.diagonal().cwiseMax(0).cwiseSqrt();
    // The three angles of a rotation vector in base: for sigmas of this size those of A, B, C about Z, Y, X.
    const Eigen::Vector3d abc(deg_from_rad(sigma[5]), deg_from_rad(sigma[4]), deg_from_rad(sigma[3]));
    return {{"xyz_mm", numbers(sigma.head<3>())}, {"abc_deg", numbers(abc)}};
}

json deviation_json(const DeviationMap& d) {
    json histogram = json::array();
    for (const HistogramBin& b : d.histogram)
        histogram.push_back({{"from_mm", b.from_mm}, {"to_mm", b.to_mm}, {"count", b.count}});
    return {{"points", d.counted},
            {"mean_mm", d.mean_mm},
            {"rms_mm", d.rms_mm},
            {"three_sigma_mm", d.three_sigma_mm},
            {"worst",
             {{"point", numbers(d.worst_part_mm)},
              {"base", numbers(d.worst_base_mm)},
              {"signed_mm", d.worst_mm}}},
            {"histogram", histogram}};
}

}  // namespace

json fit_json(const FitReport& report) {
    const SurfaceFit& fit = report.fit;
    json open = json::array(), rivals = json::array();
    for (const Text& t : fit.unobservable) open.push_back(t.english());
    for (const FitRival& r : fit.rivals)
        rivals.push_back({{"base_from_workobject", pose_json(r.base_from_part)},
                          {"points_for_best", r.for_best},
                          {"points_for_rival", r.for_rival},
                          {"told_apart", r.told_apart}});
    json out{{"status", to_string(fit.status)},
             {"reason", fit.reason.english()},
             {"scan", report.scan},
             {"part", report.part},
             {"from_start", fit.from_start},
             {"points", fit.points},
             {"share_on_part", fit.share_on_part},
             {"unobservable", open},
             {"rivals", rivals},
             {"base_from_workobject", nullptr},
             {"covariance", nullptr},
             {"sigma", nullptr},
             {"deviation", nullptr},
             {"share_seen", nullptr}};
    if (report.to_edges()) out["edges"] = report.edges;
    if (fit.status == FitStatus::no_fit || fit.status == FitStatus::cancelled) return out;
    out["base_from_workobject"] = pose_json(fit.base_from_part);
    out["deviation"] = deviation_json(report.deviation);
    out["share_seen"] = report.deviation.share_seen;
    if (report.to_edges()) {
        out["deviation"]["normal_rms_mm"] = report.normal_rms_mm;
        out["spacing_mm"] = report.spacing_mm;
    }
    if (!has_covariance(fit)) return out;
    json rows = json::array();
    for (int k = 0; k < 6; ++k) rows.push_back(numbers(fit.covariance.row(k).transpose()));
    out["covariance"] = rows;
    out["sigma"] = sigma_json(fit.covariance);
    out["sigma"]["noise"] = sigma_json(fit.covariance_noise);
    out["sigma"]["form"] = sigma_json(fit.covariance - fit.covariance_noise);
    out["noise_mm"] = fit.noise_mm;
    out["form"] = {{"sigma_mm", fit.form_mm}, {"length_mm", fit.form_length_mm}};
    return out;
}

std::string fit_text(const FitReport& report) {
    const SurfaceFit& fit = report.fit;
    std::string text = report.to_edges()
                           ? fmt::format("{}: {} ends of the sheet, {:.0f} % of them on the edge\n",
                                         to_string(fit.status), fit.points, 100 * fit.share_on_part)
                           : fmt::format("{}: {} points, {:.0f} % of them on the part\n",
                                         to_string(fit.status), fit.points, 100 * fit.share_on_part);
    if (!fit.reason.empty()) text += fit.reason.english() + "\n";
    if (fit.status == FitStatus::no_fit || fit.status == FitStatus::cancelled) return text;
    const json pose = pose_json(fit.base_from_part);
    const auto& xyz = pose["xyz"];
    const auto& abc = pose["abc"];
    text +=
        fmt::format("base_from_workobject X {:.3f} Y {:.3f} Z {:.3f} mm  A {:.4f} B {:.4f} C {:.4f} deg\n",
                    xyz[0].get<double>(), xyz[1].get<double>(), xyz[2].get<double>(), abc[0].get<double>(),
                    abc[1].get<double>(), abc[2].get<double>());
    if (has_covariance(fit)) {
        const json s = sigma_json(fit.covariance);
        text += fmt::format(
            "sigma {:.3f} {:.3f} {:.3f} mm  {:.4f} {:.4f} {:.4f} deg (noise of a point {:.3f} mm, form "
            "{:.3f} mm)\n",
            s["xyz_mm"][0].get<double>(), s["xyz_mm"][1].get<double>(), s["xyz_mm"][2].get<double>(),
            s["abc_deg"][0].get<double>(), s["abc_deg"][1].get<double>(), s["abc_deg"][2].get<double>(),
            fit.noise_mm, fit.form_mm);
    }
    const DeviationMap& d = report.deviation;
    if (report.to_edges())
        return text +
               fmt::format(
                   "deviation of the ends: rms {:.3f} mm along the sheet and {:.3f} mm out of it, 3 sigma "
                   "{:.3f} mm, worst {:+.3f} mm at ({:.1f}, {:.1f}, {:.1f}) of the part; {:.0f} % of the "
                   "edge seen\n",
                   d.rms_mm, report.normal_rms_mm, d.three_sigma_mm, d.worst_mm, d.worst_part_mm.x(),
                   d.worst_part_mm.y(), d.worst_part_mm.z(), 100 * d.share_seen);
    text += fmt::format(
        "deviation: rms {:.3f} mm, 3 sigma {:.3f} mm, worst {:+.3f} mm at ({:.1f}, {:.1f}, {:.1f}) of the "
        "part; {:.0f} % of the part seen\n",
        d.rms_mm, d.three_sigma_mm, d.worst_mm, d.worst_part_mm.x(), d.worst_part_mm.y(), d.worst_part_mm.z(),
        100 * d.share_seen);
    return text;
}

}  // namespace seamwright
