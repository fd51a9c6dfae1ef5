#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/cli/answers/result_json.h"
#include "app/cli/demo/demo.h"
#include "devices/simulated/scene/door.h"
#include "projects/report/html.h"
#include "projects/report/svg_plot.h"

namespace seamwright::cli {
namespace {

using namespace report;

constexpr double kMagnify = 100;  // of the deviations in the plan view

std::string mm(double value, int decimals = 3) {
    return fmt::format("{:.{}f}", value, decimals);
}

void calibration_chapter(Page& page, const DemoOutcome& o) {
    page.heading("Calibration of the sensor");
    page.paragraph("Solved from rendered frames, starting from nothing but the sizes of plate and sphere.");
    for (const DemoCalibrationStep& step : o.calibration.steps) {
        page.heading(step.name, 3);
        page.verdict(name_of(step.report.judgement.verdict), tone_of(step.report.judgement.verdict),
                     step.report.judgement.reason.english());
        page.paragraph(step.summary);
        Plot plot;
        plot.title = step.name + ": residual per pose";
        const bool in_px = std::any_of(step.report.poses.begin(), step.report.poses.end(),
                                       [](const PoseResidual& p) { return std::isfinite(p.rms_px); });
        plot.y_label = in_px ? "rms (px)" : "rms (mm)";
        Series bars;
        bars.mark = Mark::bars;
        for (const PoseResidual& pose : step.report.poses) {
            bars.x.push_back(static_cast<double>(plot.categories.size()));
            bars.y.push_back(in_px ? pose.rms_px : pose.rms_mm);
            plot.categories.push_back(fmt::format("{}", plot.categories.size() + 1));
        }
        plot.series = {bars};
        plot.height_px = 220;
        page.figure(svg(plot));
    }
    page.paragraph(fmt::format(
        "Against the cell's truth, the calibrated chain is off by at most {:.3f} mm over the working range "
        "(60 mm x 30 mm).",
        o.calibration.truth_mm));
}

void teaching_chapter(Page& page, const DemoOutcome& o) {
    page.heading("Taught spots: the frozen contour");
    std::vector<std::vector<std::string>> rows = {{"spot", "verdict", "yaw (deg)", "pitch (deg)",
                                                   "radius (mm)", "expected error (mm)", "spread x (mm)",
                                                   "spread z (mm)"}};
    for (const DemoTaughtSpot& t : o.taught)
        rows.push_back({t.id, std::string(to_string(t.alignment.status)), mm(t.alignment.yaw_deg),
                        mm(t.alignment.pitch_deg),
                        std::isfinite(t.alignment.radius_mm) ? mm(t.alignment.radius_mm, 0) : "straight",
                        mm(t.alignment.expected_error_mm), mm(t.spread_mm.x(), 4), mm(t.spread_mm.y(), 4)});
    page.table(rows);
    std::vector<std::string> plots;
    for (const DemoTaughtSpot& t : o.taught) {
        Plot plot;
        plot.title = "spot " + t.id;
        plot.x_label = "travel (mm)";
        plot.y_label = "offset (mm)";
        plot.width_px = 340;
        plot.height_px = 220;
        Series dx{"dx", {}, {}, Mark::line, colour::kBlue},
            dz{"dz", {}, {}, Mark::dashed, colour::kVermilion};
        for (const TravelOffset& offset : t.alignment.offsets) {
            if (!offset.ok) continue;
            dx.x.push_back(offset.travel_mm), dx.y.push_back(offset.dx_mm);
            dz.x.push_back(offset.travel_mm), dz.y.push_back(offset.dz_mm);
        }
        plot.series = {dx, dz};
        plots.push_back(svg(plot));
    }
    page.figures(plots,
                 "Registration of each profile of the pass to the one at the trigger. The curve of the "
                 "contour is used in the correction.");
    page.heading("Regions: what they can tell, before measuring", 3);
    rows = {{"region", "status", "sigma at the spots (mm)", "weakest", "redundancy"}};
    for (std::size_t i = 0; i < o.plans.size(); ++i)
        rows.push_back({o.project.regions[i].id, std::string(to_string(o.plans[i].status)),
                        mm(o.plans[i].sigma_at_spots_mm), o.plans[i].weakest.english(),
                        fmt::format("{}", o.plans[i].redundancy)});
    page.table(rows);
}

void zero_shift_chapter(Page& page, const DemoOutcome& o) {
    page.heading("Zero shift");
    page.paragraph(
        "The part unmoved, measured three times: every displacement must read zero within its sigma.");
    std::vector<std::vector<std::string>> rows = {{"run", "region", "translation (mm)", "rotation (deg)"}};
    for (const RunRecord& run : o.zero_shift)
        for (const RegionRecord& region : run.regions) {
            if (!region.correction) continue;
            const Pose& d = region.correction->displacement.workobject_from_movedworkobject;
            rows.push_back({fmt::format("{}", run.number), region.region_id, mm(d.translation().norm()),
                            mm(deg_from_rad(angle_rad(d, Pose::Identity())), 4)});
        }
    page.table(rows);
}

std::vector<std::vector<std::string>> statistic_rows(const std::vector<DemoStatistic>& statistic) {
    std::vector<std::vector<std::string>> rows = {
        {"region", "before, largest (mm)", "after, mean (mm)", "after, 3 sigma (mm)", "after, largest (mm)"}};
    for (const DemoStatistic& s : statistic)
        rows.push_back({s.region_id, mm(s.before_max_mm), mm(s.after_mean_mm), mm(s.after_three_sigma_mm),
                        mm(s.after_max_mm)});
    return rows;
}

// Of a region whose bead scatters by more than a tenth of a millimetre: how much from part to part, which a
// better measurement would mend, and how much along one part, which no rigid frame can follow.
std::vector<std::string> what_limits(const DemoOutcome& o) {
    constexpr double kTenth_mm = 0.1;
    std::vector<std::string> sentences;
    const std::vector<DemoStatistic> path = statistics(o, &DemoPart::path);
    for (std::size_t r = 0; r < o.project.regions.size() && r < o.plans.size(); ++r) {
        if (!(path[r].after_three_sigma_mm > kTenth_mm)) continue;
        double within = 0, points = 0, means = 0, mean_squares = 0, parts = 0;
        for (const DemoPart& part : o.parts)
            for (const int axis : {0, 1}) {
                double n = 0, sum = 0, squares = 0;
                for (const DemoDeviation& d : part.path)
                    if (part.pushed() && d.region_id == o.project.regions[r].id)
                        n += 1, sum += d.after_mm[axis], squares += d.after_mm[axis] * d.after_mm[axis];
                if (n == 0) continue;
                within += squares - sum * sum / n;
                points += n;
                means += sum / n, mean_squares += sum / n * sum / n, parts += 1;
            }
        const double along = within / points, between = mean_squares / parts - means / parts * means / parts;
        const RegionPlan& plan = o.plans[r];
        sentences.push_back(fmt::format(
            "{}: 3 sigma of {} mm is above a tenth of a millimetre. Of that variance {:.0f} % lies between "
            "the parts, from how well a part's displacement is measured ({} mm predicted, 3 sigma at the "
            "spots; "
            "least known: {}), and {:.0f} % along the bead of one part, whose bend and twist one rigid frame "
            "cannot follow.",
            o.project.regions[r].id, mm(path[r].after_three_sigma_mm), 100 * between / (between + along),
            mm(3 * plan.sigma_at_spots_mm), plan.weakest, 100 * along / (between + along)));
    }
    return sentences;
}

void correction_chapter(Page& page, const DemoOutcome& o) {
    page.heading("Parts: displaced, measured, corrected, pushed");
    std::vector<std::vector<std::string>> rows = {
        {"part", "run", "status", "shift (mm)", "turn (deg)", "bend (mm)", "twist (mm)",
         "largest deviation of the bead before (mm)", "after (mm)"}};
    for (const DemoPart& part : o.parts) {
        double before = 0, after = 0;
        for (const DemoDeviation& d : part.path)
            before = std::max(before, d.before_mm.norm()), after = std::max(after, d.after_mm.norm());
        const Pose& d = part.truth.workobject_from_movedworkobject;
        rows.push_back({part.run.part_id, fmt::format("{}", part.run.number),
                        std::string(to_string(part.run.status)), mm(d.translation().norm(), 2),
                        mm(deg_from_rad(angle_rad(d, Pose::Identity()))), mm(part.truth.bend.bend_mm, 2),
                        mm(part.truth.bend.twist_mm, 2), mm(before, 2),
                        part.pushed() ? mm(after) : "no bead laid"});
    }
    page.table(rows);
    const auto pushed =
        std::count_if(o.parts.begin(), o.parts.end(), [](const DemoPart& p) { return p.pushed(); });
    page.paragraph(fmt::format("The figures below hold for the {} of {} parts that were pushed.", pushed,
                               o.parts.size()));
    page.heading("Deviation at the spots", 3);
    page.table(statistic_rows(statistics(o, &DemoPart::spots)),
               "Across the edge and in height; the direction along the edge does not move the bead.");
    page.heading("Deviation along the bead", 3);
    page.table(statistic_rows(statistics(o, &DemoPart::path)));
    for (const std::string& sentence : what_limits(o)) page.paragraph(sentence);
    if (o.parts.empty()) return;
    Plot before, after;
    before.title = "Bead before correction";
    after.title = "Bead after correction";
    before.x_label = after.x_label = "along the bead (mm)";
    before.y_label = after.y_label = "deviation across the edge (mm)";
    before.width_px = after.width_px = 520;
    after.bands = {{-0.1, 0.1, "0.1 mm"}};
    const char* colours[] = {colour::kBlue,  colour::kVermilion, colour::kGreen,
                             colour::kAmber, colour::kPurple,    colour::kGrey};
    for (std::size_t i = 0; i < o.parts.size(); ++i) {
        Series b{"", {}, {}, Mark::dots, colours[i % 6]}, a = b;
        for (const DemoDeviation& d : o.parts[i].path) {
            b.x.push_back(d.arc_mm), b.y.push_back(d.before_mm.x());
            a.x.push_back(d.arc_mm), a.y.push_back(d.after_mm.x());
        }
        before.series.push_back(b);
        if (o.parts[i].pushed()) after.series.push_back(a);
    }
    page.figures({svg(before), svg(after)},
                 "Every part in its own colour. Between two regions the correction changes from one frame to "
                 "the next.");
}

}  // namespace

std::string demo_picture(const DemoOutcome& o) {
    Plot plot;
    plot.title = fmt::format("Door, spots and bead; deviation of one part magnified {} x", kMagnify);
    plot.x_label = "X (mm)";
    plot.y_label = "Y (mm)";
    plot.equal_scale = true;
    plot.width_px = 760;
    plot.height_px = 560;
    Series edge{"edge", {}, {}, Mark::line, colour::kGrey},
        taught{"bead, where it belongs", {}, {}, Mark::line, colour::kGreen};
    for (double s = 0; s <= door_edge_length_mm() + 5; s += 5) {
        const DoorEdge e = door_edge(s);
        edge.x.push_back(e.point_mm.x()), edge.y.push_back(e.point_mm.y());
    }
    const std::vector<Eigen::Vector3d> path = door_bead_path(10);
    for (std::size_t i = 0; i <= path.size(); ++i)
        taught.x.push_back(path[i % path.size()].x()), taught.y.push_back(path[i % path.size()].y());
    Series spots{"spots", {}, {}, Mark::crosses, colour::kBlue};
    for (const DoorSpot& spot : dense_door_spots()) {
        const Eigen::Vector3d p = spot.workobject_from_sensor * spot.edge_mm;
        spots.x.push_back(p.x()), spots.y.push_back(p.y());
    }
    Series before{"uncorrected (1 x)", {}, {}, Mark::dots, colour::kVermilion};
    Series after{fmt::format("corrected ({} x)", kMagnify), {}, {}, Mark::dots, colour::kAmber};
    if (const auto part =
            std::find_if(o.parts.begin(), o.parts.end(), [](const DemoPart& p) { return p.pushed(); });
        part != o.parts.end())
        for (const DemoDeviation& d : part->path) {
            const std::size_t i = static_cast<std::size_t>(std::lround(d.arc_mm / 10));
            const Eigen::Vector3d along =
                (path[(i + 1) % path.size()] - path[(i + path.size() - 1) % path.size()]).normalized();
            const Eigen::Vector3d across = Eigen::Vector3d::UnitZ().cross(along).normalized();
            const Eigen::Vector3d b = path[i] + d.before_mm.x() * across,
                                  a = path[i] + kMagnify * d.after_mm.x() * across;
            before.x.push_back(b.x()), before.y.push_back(b.y());
            after.x.push_back(a.x()), after.y.push_back(a.y());
        }
    plot.series = {edge, before, after, taught, spots};
    return svg(plot);
}

namespace {

void offline_chapter(Page& page, const DemoOutcome& outcome) {
    const DemoOffline& o = *outcome.offline;
    page.heading("From the drawing");
    page.paragraph(
        fmt::format("The same cell without a person at the part: spots of region {} proposed along edge {} "
                    "of door.step, as many as "
                    "were made by hand, taken into a copy of the project ({}), confirmed on the part, the "
                    "same parts again.",
                    o.region_id, o.edge, o.project_file.filename().string()));
    page.paragraph(
        fmt::format("Before they were confirmed the safety gate said: {}.", o.refused_before.english()));
    page.verdict(o.confirmation.ok ? "confirmed" : "not confirmed",
                 o.confirmation.ok ? Tone::good : Tone::attention, said_of(o.confirmation).english());
    std::vector<std::vector<std::string>> rows = {
        {"spot", "finding", "shift x (mm)", "shift z (mm)", "contour rms (mm)", "left (mm)"}};
    for (const SpotConfirmation& s : o.confirmation.spots)
        rows.push_back({s.spot_id, std::string(to_string(s.finding)), mm(s.shift_mm.x()), mm(s.shift_mm.y()),
                        mm(s.contour_rms_mm), mm(s.left_mm)});
    page.table(rows);
    const DemoStatistic now = statistic_of(o.parts, o.region_id, &DemoPart::path),
                        hand = statistic_of(outcome.parts, o.region_id, &DemoPart::path);
    page.table(
        {{"spots", "bead forecast, 3 sigma (mm)", "bead after, 3 sigma (mm)", "bead after, largest (mm)"},
         {"by hand", mm(o.hand.three_sigma_mm), mm(hand.after_three_sigma_mm), mm(hand.after_max_mm)},
         {"from the drawing", mm(o.proposal.set.three_sigma_mm), mm(now.after_three_sigma_mm),
          mm(now.after_max_mm)}});
}

}  // namespace

std::string demo_report(const DemoOutcome& o) {
    Page page("Seamwright demo: door left");
    const auto path = statistics(o, &DemoPart::path);
    const bool all_ok =
        std::all_of(o.parts.begin(), o.parts.end(), [](const DemoPart& p) { return p.pushed(); });
    page.verdict(all_ok ? "all parts corrected and pushed" : "some parts were refused",
                 all_ok ? Tone::good : Tone::attention,
                 fmt::format("bead off by up to {:.2f} mm before, {:.3f} mm (3 sigma) after",
                             path.back().before_max_mm, path.back().after_three_sigma_mm));
    page.paragraph(
        "Simulated. The figures hold for the cell stated at the end: its sensor noise, trigger jitter, robot "
        "repeatability, part "
        "deformation and seed. They are not measured on a machine.");
    page.figure(demo_picture(o));
    calibration_chapter(page, o);
    teaching_chapter(page, o);
    zero_shift_chapter(page, o);
    correction_chapter(page, o);
    if (o.offline) offline_chapter(page, o);
    page.heading("The simulated cell");
    std::vector<std::vector<std::string>> rows = {{"setting", "value"}};
    for (const auto& item : o.cell.items()) rows.push_back({item.key(), item.value().dump()});
    page.table(rows);
    page.paragraph(fmt::format("Whole job in {:.1f} s. Project: {}. Run it again: seamwright replay {}",
                               o.seconds, o.project_file.string(), o.project_file.string()));
    return page.html();
}

}  // namespace seamwright::cli
