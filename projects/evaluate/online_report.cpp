#include "projects/evaluate/online_report.h"

#include <fmt/format.h>

#include "projects/report/svg_plot.h"

namespace seamwright::evaluation {
namespace {

constexpr double kMostBehind = 0.01;  // of the cycles

}  // namespace

std::string online_caption(const OnlineExperiment& o) {
    const OnlineWay way;
    return fmt::format(
        "Online correction against the offline method, simulated: once round the contour of {:.0f} mm, parts "
        "displaced by up to {:g} mm and {:g} degrees per axis, bent ones by {:g} mm and twisted by {:g} mm. "
        "Sensor "
        "{:g} mm ahead of the tool, {:g} profiles/s; corrections every {:g} ms, followed with a lag of {:g} "
        "ms, at "
        "most {:g} mm/s and {:g} mm/s2. Offline: 12 spots, four regions, path blended between them. Error of "
        "the "
        "tool against the part's true contour, across it and in height, mm; the first {:g} mm bring the "
        "correction onto the path and do not count. \"Stated\" is one coordinate's 3 sigma from the "
        "covariances: "
        "measure, reference and robot, nothing of lag, bend and curvature. \"Behind\" is the "
        "share of cycles in which the ramp was more than {:g} mm from what was known.",
        o.contour_mm, o.shift_mm, o.turn_deg, o.bend_mm, o.twist_mm, way.look_ahead_mm, way.rate_hz,
        way.cycle_ms, way.lag_ms, way.limits.speed_mm_s, way.limits.acceleration_mm_s2, kRunInMm, kBehindMm);
}

std::vector<std::vector<std::string>> online_table(const OnlineExperiment& o) {
    std::vector<std::vector<std::string>> rows{{"way", "part", "mm/s", "delay ms", "known in time", "behind",
                                                "mean", "3 sigma", "stated 3 sigma", "worst", "alarms"}};
    for (const OnlineResult& r : o.results) {
        const bool on = r.way.online;
        rows.push_back(
            {on ? "online" : "offline", r.bent ? "bent" : "rigid",
             on ? fmt::format("{:g}", r.way.speed_mm_s) : "-", on ? fmt::format("{:g}", r.way.delay_ms) : "-",
             on ? (r.way.in_time() ? "yes" : "no") : "-",
             on ? fmt::format("{:.0f} %", 100 * r.behind_share) : "-", fmt::format("{:.4f}", r.error.mean),
             fmt::format("{:.4f}", r.error.three_sigma), fmt::format("{:.4f}", 3 * r.sigma_mm),
             fmt::format("{:.4f}", r.worst_mm), std::to_string(r.alarms)});
    }
    return rows;
}

std::string online_verdict(const OnlineExperiment& o) {
    std::vector<std::string> blind, slow;
    for (const OnlineResult& r : o.results) {
        if (!r.way.online || r.bent) continue;
        const std::string way = fmt::format("{:g} mm/s with {:g} ms of delay (up to {:.2f} mm off)",
                                            r.way.speed_mm_s, r.way.delay_ms, r.worst_mm);
        if (!r.way.in_time())
            blind.push_back(way);
        else if (r.behind_share > kMostBehind)
            slow.push_back(way);
    }
    std::string text;
    if (!blind.empty())
        text += fmt::format(
            "Not to be driven, and no alarm tells so: {}. What is measured is known only after the tool has "
            "passed, so it corrects with another place's deviation. Ride slower, shorten the delay, or mount "
            "the "
            "sensor further ahead. ",
            fmt::join(blind, ", "));
    if (!slow.empty())
        text += fmt::format(
            "Known in time but too fast for the limits of the correction, also without an alarm: {}. Ride "
            "slower, or allow more speed and acceleration.",
            fmt::join(slow, ", "));
    return text.empty() ? "Every way was known in time and kept up." : text;
}

nlohmann::json online_json(const OnlineExperiment& o) {
    using nlohmann::json;
    json ways = json::array();
    for (const OnlineResult& r : o.results)
        ways.push_back({{"way", r.way.online ? "online" : "offline"},
                        {"bent", r.bent},
                        {"speed_mm_s", r.way.online ? json(r.way.speed_mm_s) : json()},
                        {"delay_ms", r.way.online ? json(r.way.delay_ms) : json()},
                        {"known_in_time", r.way.in_time()},
                        {"behind_share", r.behind_share},
                        {"parts", r.parts},
                        {"alarms", r.alarms},
                        {"mean_mm", r.error.mean},
                        {"three_sigma_mm", r.error.three_sigma},
                        {"stated_three_sigma_mm", 3 * r.sigma_mm},
                        {"worst_mm", r.worst_mm}});
    const OnlineWay way;
    return {{"contour_mm", o.contour_mm},
            {"look_ahead_mm", way.look_ahead_mm},
            {"rate_hz", way.rate_hz},
            {"cycle_ms", way.cycle_ms},
            {"lag_ms", way.lag_ms},
            {"speed_limit_mm_s", way.limits.speed_mm_s},
            {"acceleration_limit_mm_s2", way.limits.acceleration_mm_s2},
            {"verdict", online_verdict(o)},
            {"ways", ways}};
}

std::string online_curve(const OnlineExperiment& o, bool bent) {
    report::Plot plot;
    plot.title = bent ? "Bent part" : "Rigid part";
    plot.x_label = "along the contour (mm)";
    plot.y_label = "error of the tool (mm)";
    for (const OnlineResult& r : o.results) {
        const bool shown = !r.way.online || (r.way.speed_mm_s == 100 && r.way.delay_ms == 60);
        if (r.bent != bent || !shown) continue;
        plot.series.push_back({r.way.online ? "online, 100 mm/s, 60 ms" : "offline", r.arc_mm, r.length_mm,
                               r.way.online ? report::Mark::line : report::Mark::dashed,
                               r.way.online ? report::colour::kBlue : report::colour::kVermilion});
    }
    return report::svg(plot);
}

std::string online_speeds(const OnlineExperiment& o) {
    report::Plot plot;
    plot.title = "Following error against delay, rigid part";
    plot.x_label = "delay (ms)";
    plot.y_label = "3 sigma (mm)";
    const char* colours[3] = {report::colour::kBlue, report::colour::kGreen, report::colour::kPurple};
    std::size_t k = 0;
    for (const OnlineResult& r : o.results) {
        if (r.bent || !r.way.online) continue;
        const std::string name = fmt::format("{:g} mm/s", r.way.speed_mm_s);
        if (plot.series.empty() || plot.series.back().name != name)
            plot.series.push_back({name, {}, {}, report::Mark::line, colours[k++ % 3]});
        plot.series.back().x.push_back(r.way.delay_ms);
        plot.series.back().y.push_back(r.error.three_sigma);
    }
    for (const OnlineResult& r : o.results)
        if (!r.way.online && !r.bent)
            plot.series.push_back({"offline",
                                   {20, 150},
                                   {r.error.three_sigma, r.error.three_sigma},
                                   report::Mark::dashed,
                                   report::colour::kVermilion});
    return report::svg(plot);
}

}  // namespace seamwright::evaluation
