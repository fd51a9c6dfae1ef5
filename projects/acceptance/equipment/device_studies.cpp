#include "projects/acceptance/equipment/device_studies.h"

#include <fmt/format.h>

#include "projects/report/svg_plot.h"

namespace seamwright {
namespace {

using nlohmann::json;
using report::Mark;
using report::Plot;
using report::Rows;
using report::Series;
namespace colour = report::colour;

json pair_json(const Interval& limits) {
    return json::array({limits.low, limits.high});
}

json source_json(const StudySource& source, const std::string& utc) {
    json remarks = json::array();
    for (const Text& remark : source.remarks) remarks.push_back(remark.in(Language::english));
    return {{"file", source.file},
            {"part", source.part_name},
            {"sensor", source.sensor},
            {"sensor_serial", source.sensor_serial},
            {"robot", source.robot},
            {"robot_serial", source.robot_serial},
            {"simulated", source.simulated},
            {"utc", utc.empty() ? json() : json(utc)},
            {"n", source.runs},
            {"remarks", remarks}};
}

json matrix_json(const Matrix6& m) {
    json list = json::array();
    for (int r = 0; r < 6; ++r)
        for (int c = 0; c < 6; ++c) list.push_back(m(r, c));
    return list;
}

struct ChapterWriter {
    report::Page& page;
    Language language;
    template <class... A>
    std::string t(const char* english, const A&... arguments) const {
        return Text::chosen(english, arguments...).in(language);
    }
    Rows head() const { return {{t("Index"), t("Value"), t("from (95 %)"), t("to (95 %)")}}; }
    static void index(Rows& rows, const std::string& name, double value, const Interval& limits,
                      int decimals = 4) {
        const auto number = [&](double v) { return fmt::format("{:.{}f}", v, decimals); };
        rows.push_back({name, number(value), number(limits.low), number(limits.high)});
    }
    void source(const StudySource& s, const std::string& utc) const {
        if (s.simulated) page.verdict(t("simulated"), report::Tone::attention, t("the cell was simulated"));
        Rows rows{{t("Made with"), t("Value")}};
        if (!s.sensor.empty())
            rows.push_back({t("Sensor"), s.sensor + ", " + t("serial {}", s.sensor_serial)});
        if (!s.robot.empty()) rows.push_back({t("Robot"), s.robot + ", " + t("serial {}", s.robot_serial)});
        rows.push_back(
            {t("date"), utc.empty() ? t("not stored") : utc.substr(0, 10) + " " + utc.substr(11, 5)});
        page.table(rows);
        for (const Text& remark : s.remarks) page.paragraph(remark.in(language));
    }
};

}  // namespace

json robot_study_json(const MeasuredRobot& m) {
    const RobotStudy& s = m.study;
    json spots = json::array(), axes = json::array(), assumed = json::array();
    for (const SpotRepeatability& r : s.spots) {
        json arrival = json::object(), noise = json::object();
        json limits = {{"rp", pair_json(r.rp_limits_mm)},
                       {"rp_measured", pair_json(r.rp_measured_limits_mm)}};
        const auto axis = [&](const char* name, const AxisScatter& a, double noise_mm) {
            arrival[name] = a.sigma_mm;
            noise[name] = noise_mm;
            limits[name] = pair_json(a.limits_mm);
        };
        if (r.x) axis("x", r.arrival_x, r.noise_mm.x());
        if (r.z) axis("z", r.arrival_z, r.noise_mm.y());
        spots.push_back({{"id", r.spot_id},
                         {"returns", r.returns},
                         {"profiles", r.profiles},
                         {"rp", r.rp_mm},
                         {"rp_measured", r.rp_measured_mm},
                         {"arrival", arrival},
                         {"noise", noise},
                         {"limits", limits}});
    }
    for (int a = 0; a < 3; ++a)
        axes.push_back({{"axis", std::string(1, "XYZ"[a])},
                        {"sigma", s.axes[a].sigma_mm},
                        {"limits", pair_json(s.axes[a].limits_mm)}});
    for (const Eigen::Vector3d& u : s.unseen) assumed.push_back({u.x(), u.y(), u.z()});
    return {{"status", "ok"},
            {"robot", m.returns.robot_id},
            {"rp", s.rp_mm},
            {"limits", {{"rp", pair_json(s.rp_limits_mm)}}},
            {"axes", axes},
            {"components_measured", s.seen},
            {"assumed", assumed},
            {"arrival_covariance", matrix_json(m.arrival_covariance)},
            {"replaced_covariance", matrix_json(m.returns.replaced_covariance)},
            {"spots", spots},
            {"source", source_json(m.source, m.utc)}};
}

json trigger_study_json(const MeasuredTrigger& m) {
    json answer = {
        {"status", m.study ? "ok" : "not_seen"}, {"spot", m.passes.spot_id},
        {"travel_deg", m.passes.travel_deg},     {"slope", {m.passes.slope.x(), m.passes.slope.y()}},
        {"slope_sigma", m.passes.slope_sigma},   {"source", source_json(m.source, m.utc)}};
    if (!m.study) {
        answer["message"] = m.unseen.english();
        return answer;
    }
    const TriggerStudy& s = *m.study;
    answer.update({{"latency_ms", s.latency_ms},
                   {"jitter_ms", s.jitter_ms},
                   {"jitter_seen", s.jitter_seen()},
                   {"reversal", s.reversal_mm},
                   {"standing", s.standing_mm},
                   {"limits",
                    {{"latency_ms", pair_json(s.latency_limits_ms)},
                     {"jitter_ms", pair_json(s.jitter_limits_ms)},
                     {"reversal", pair_json(s.reversal_limits_mm)}}},
                   {"speeds_mm_s", s.speeds_mm_s},
                   {"passes", s.moving},
                   {"standing_passes", s.standing},
                   {"jitter_mm", m.jitter_mm},
                   {"replaced_latency_ms", m.passes.replaced_latency_ms},
                   {"replaced_jitter_mm", m.passes.replaced_jitter_mm}});
    return answer;
}

void add_chapter(report::Page& page, Language language, const MeasuredRobot& m, int level) {
    const ChapterWriter w{page, language};
    const RobotStudy& s = m.study;
    page.heading(w.t("Repeatability of robot {} (ISO 9283)", m.returns.robot_id), level);
    w.source(m.source, m.utc);
    Rows rows = w.head();
    w.index(rows, s.seen == 6 ? w.t("RP in space (mm)") : w.t("RP in space, partly assumed (mm)"), s.rp_mm,
            s.rp_limits_mm);
    for (int a = 0; a < 3; ++a)
        w.index(rows, w.t("sigma along base {} (mm)", std::string(1, "XYZ"[a])), s.axes[a].sigma_mm,
                s.axes[a].limits_mm);
    for (const SpotRepeatability& r : s.spots) {
        w.index(rows, w.t("{}: RP where the spot sees (mm)", r.spot_id), r.rp_mm, r.rp_limits_mm);
        w.index(rows, w.t("{}: the same with the sensor's noise (mm)", r.spot_id), r.rp_measured_mm,
                r.rp_measured_limits_mm);
        if (r.x)
            w.index(rows, w.t("{}: arrival, sigma x (mm)", r.spot_id), r.arrival_x.sigma_mm,
                    r.arrival_x.limits_mm);
        if (r.z)
            w.index(rows, w.t("{}: arrival, sigma z (mm)", r.spot_id), r.arrival_z.sigma_mm,
                    r.arrival_z.limits_mm);
    }
    page.table(rows);
    Rows counts{{w.t("Spot"), w.t("returns"), w.t("profiles"), w.t("noise of a profile, x (mm)"),
                 w.t("noise of a profile, z (mm)")}};
    for (const SpotRepeatability& r : s.spots)
        counts.push_back({r.spot_id, std::to_string(r.returns), std::to_string(r.profiles),
                          r.x ? fmt::format("{:.4f}", r.noise_mm.x()) : "-",
                          r.z ? fmt::format("{:.4f}", r.noise_mm.y()) : "-"});
    page.table(counts);
}

void add_chapter(report::Page& page, Language language, const MeasuredTrigger& m, int level) {
    const ChapterWriter w{page, language};
    page.heading(w.t("Trigger: latency and jitter at spot {}", m.passes.spot_id), level);
    w.source(m.source, m.utc);
    if (!m.study) {
        page.verdict(w.t("not seen"), report::Tone::alarm, m.unseen.in(language));
        return;
    }
    const TriggerStudy& s = *m.study;
    Rows rows = w.head();
    w.index(rows, w.t("latency (ms)"), s.latency_ms, s.latency_limits_ms, 3);
    w.index(rows, w.t("jitter, one sigma (ms)"), s.jitter_ms, s.jitter_limits_ms, 3);
    const double half = std::sqrt(3.0) * 1e-3 * m.speed_mm_s;
    w.index(rows, w.t("half width of the jitter at {} mm/s (mm)", fmt::format("{:g}", m.speed_mm_s)),
            half * s.jitter_ms, {half * s.jitter_limits_ms.low, half * s.jitter_limits_ms.high}, 3);
    w.index(rows, w.t("reversal of the robot, half (mm)"), s.reversal_mm, s.reversal_limits_mm);
    page.table(rows);
    page.paragraph(
        w.t("{} passes in motion and {} that stopped. The feature moves by {} mm per mm of travel.", s.moving,
            s.standing, fmt::format("{:.3f}", m.passes.slope.norm())));
    Plot plot;
    plot.title = w.t("Place of the cut against the signed speed");
    plot.x_label = w.t("speed (mm/s)");
    plot.y_label = w.t("travel (mm)");
    plot.width_px = 800;
    Series dots{w.t("pass"), {}, {}, Mark::dots, colour::kBlue},
        line{w.t("latency"), {}, {}, Mark::line, colour::kGreen};
    double mean = 0;
    for (const TriggerPass& p : m.passes.passes) {
        dots.x.push_back(p.velocity_mm_s);
        dots.y.push_back(p.travel_mm);
        mean += (p.travel_mm - 1e-3 * s.latency_ms * p.velocity_mm_s) /
                static_cast<double>(m.passes.passes.size());
    }
    for (const double v : {-s.speeds_mm_s.back(), s.speeds_mm_s.back()}) {
        line.x.push_back(v);
        line.y.push_back(mean + 1e-3 * s.latency_ms * v);
    }
    plot.series = {dots, line};
    page.figure(report::svg(plot));
}

}  // namespace seamwright
