#include "projects/ahead/follow.h"

#include <algorithm>
#include <cmath>

#include "core/features/kinds/feature_registry.h"
#include "devices/exchange/files.h"
#include "devices/exchange/tables/path_csv.h"
#include "projects/ahead/ahead_sensor.h"
#include "projects/measure/measure.h"

namespace seamwright {
namespace {

// Everything that a run needs, found and judged.
struct Prepared {
    Region region;
    std::string spot_id, sensor_id, robot_id;
    const Calibration* calibration = nullptr;  // of the project
    double latency_ms = 0;
    SteeredLink* link = nullptr;
    ProfileSource* sensor = nullptr;
    std::optional<GuideCurve> guide;                         // base
    Eigen::Vector3d looked_at_mm = Eigen::Vector3d::Zero();  // flange
};

// Nothing is known of when a profile was taken, where nobody has measured it.
Expected<double> proven_latency(Station& station, const Calibration& calibration,
                                const std::string& sensor_id, const std::string& robot_id,
                                const FollowOptions& options) {
    const Project& project = station.project();
    if (options.latency_ms) {
        if (!(std::abs(*options.latency_ms) <= 1000))
            return usage_error(Text("a latency of {} ms is not plausible", *options.latency_ms), "latency");
        return *options.latency_ms;
    }
    if (calibration.method == "simulated truth") return 0.0;
    SEAM_TRY(const auto evidence, station.file().evidence());
    for (const Evidence& e : evidence) {
        const auto* passes = std::get_if<TriggerPasses>(&e.what);
        const Spot* spot = passes ? find_spot(project, passes->spot_id) : nullptr;
        if (spot && spot->sensor_id == sensor_id && spot->robot_id == robot_id)
            return find_robot(project, robot_id)->trigger_latency_ms;
    }
    return input_error(Text("the latency between trigger and exposure of sensor {} on robot {} is not proven",
                            sensor_id, robot_id),
                       project.name,
                       "measure it (seamwright measure-trigger), or state it with --latency-ms");
}

Expected<Prepared> prepare(Station& station, const FollowOptions& options) {
    const Project& project = station.project();
    Prepared p;
    const auto region = std::find_if(project.regions.begin(), project.regions.end(), [&](const Region& r) {
        return options.region_id.empty() ? project.regions.size() == 1 : r.id == options.region_id;
    });
    if (region == project.regions.end())
        return options.region_id.empty()
                   ? usage_error("the project does not have exactly one region", project.name,
                                 "name the one whose path runs: --region ID")
                   : input_error(Text("the project has no region \"{}\"", options.region_id), project.name);
    p.region = *region;
    if (region->spot_ids.empty())
        return input_error("the region has no spots", Text("region {}", region->id));
    p.spot_id = options.spot_id.empty() ? region->spot_ids.front() : options.spot_id;
    const Spot* spot = find_spot(project, p.spot_id);
    if (!spot) return input_error(Text("there is no spot \"{}\"", p.spot_id), project.name);
    p.sensor_id = options.sensor_id.empty() ? spot->sensor_id : options.sensor_id;
    p.robot_id = spot->robot_id;
    p.calibration = calibration_of(project, p.sensor_id);
    if (!find_sensor(project, p.sensor_id))
        return input_error(Text("the project has no sensor \"{}\"", p.sensor_id), project.name);
    if (!p.calibration || !serves(p.calibration->verdict))
        return input_error(Text("sensor {} has no calibration that serves", p.sensor_id), project.name,
                           "calibrate it first");
    if (!(options.limit_mm > 0 && options.limit_mm <= p.region.limits.translation_mm))
        return usage_error(Text("the limit of {} mm is none (above 0, up to the region's {} mm)",
                                options.limit_mm, p.region.limits.translation_mm),
                           "limit");
    SEAM_TRY(p.latency_ms, proven_latency(station, *p.calibration, p.sensor_id, p.robot_id, options));

    SEAM_TRY(auto in_base, parse_guide(options.guide_csv, options.guide_name));
    for (GuidePoint& g : in_base) {
        g.point_mm = project.part.base_from_workobject * g.point_mm;
        g.up = project.part.base_from_workobject.linear() * g.up;
    }
    SEAM_TRY(auto guide, GuideCurve::make(in_base));
    p.guide = std::move(guide);
    p.looked_at_mm = p.calibration->flange_from_sensor * spot->reference_mm;

    p.sensor = station.sensor(p.sensor_id);
    RobotLink* robot = station.robot(p.robot_id);
    if (!p.sensor || !robot)
        return usage_error(Text("sensor {} or robot {} is not connected", p.sensor_id, p.robot_id),
                           project.name, "connect first");
    p.link = dynamic_cast<SteeredLink*>(robot);
    if (!p.link)
        return input_error(Text("robot {} ({}) takes no corrections in every cycle", p.robot_id,
                                find_robot(project, p.robot_id)->driver),
                           project.name, "connect it by kuka-rsi or abb-egm, and do not record the run");
    return p;
}

// The device's identity is the calibration's, as the gate asks of the spots' sensors.
Expected<void> same_sensor(const Prepared& p) {
    if (p.sensor->identity() == p.calibration->sensor_identity) return {};
    return device_error(
        Text("the sensor {} is another one than was calibrated ({})", p.sensor_id, p.calibration->id),
        p.sensor_id, "calibrate it, or connect the calibrated one");
}

Text said_of(const SteeringFigures& f, double latency_ms, const std::string& guide) {
    return Text(
        "online correction by {}: {} features kept, {} implausible, {} beyond the limit, {} profiles without "
        "one; "
        "{:.1f} to {:.1f} mm of the guide, offset up to {:.3f} mm, sigma up to {:.4f} mm, up to {:.3f} mm "
        "behind, "
        "sensor at least {:.1f} mm ahead, latency {:.2f} ms",
        guide, f.stored, f.implausible, f.beyond_limit, f.not_found, f.from_mm, f.to_mm, f.largest_mm,
        f.largest_sigma_mm, f.largest_behind_mm, f.least_ahead_mm, latency_ms);
}

// The path was corrected, or the run says why it was not to its end.
Expected<void> record(Station& station, FollowedRun& followed, const FollowOptions& options,
                      const std::string& region_id) {
    RunRecord& run = followed.run;
    const auto event = [&](EventKind kind, const Text& text) -> Expected<void> {
        EventRecord e{0, utc_now(), run.number, kind, region_id, text};
        SEAM_TRY(e.id, station.file().append_event(e));
        run.events.push_back(std::move(e));
        return {};
    };
    if (followed.figures.alarm) SEAM_OK(event(EventKind::alarm, *followed.figures.alarm));
    if (followed.figures.alarm && run.status != RunStatus::ok) {
        run.message = Text("alarm: {}; {}", *followed.figures.alarm, run.message);
        run.status = RunStatus::alarm;
        SEAM_OK(station.file().update_run(run));
    }
    if (followed.figures.cycles > 0)
        SEAM_OK(event(EventKind::note, said_of(followed.figures, followed.latency_ms, options.guide_name)));
    return {};
}

}  // namespace

Expected<FollowedRun> follow_run(Station& station, RunOptions options, const FollowOptions& follow) {
    SEAM_TRY(auto p, prepare(station, follow));
    SEAM_OK(same_sensor(p));
    SEAM_TRY(auto measurer, SpotMeasurer::make(station.project(), p.spot_id));
    SteeringSetup setup;
    setup.base_from_reference = p.link->base_from_reference();
    setup.flange_from_tcp = p.link->flange_from_tcp();
    setup.cycle_s = p.link->cycle_s();
    setup.shifts_along = p.link->shifts_along();
    setup.flange_from_looked_at_mm = p.looked_at_mm;
    setup.line = follow.line;
    setup.limit_mm = follow.limit_mm;
    setup.sigma_limit_mm = p.region.sigma_limit_mm;
    setup.total_limit_mm = p.region.limits.translation_mm;
    AheadSensorSetup ahead;
    ahead.flange_from_sensor = p.calibration->flange_from_sensor;
    ahead.latency_s = p.latency_ms / 1e3;
    ahead.arrival_covariance = find_robot(station.project(), p.robot_id)->arrival_covariance;
    ahead.frame_timeout = follow.frame_timeout;

    FollowedRun out;
    out.guide_mm = p.guide->length_mm();
    out.latency_ms = p.latency_ms;
    SEAM_TRY(const auto kept, station.file().keep_guide(follow.guide_name, follow.guide_csv));
    std::optional<EventRecord> guided;
    std::shared_ptr<SeamSteering> steering;
    std::unique_ptr<AheadSensor> sensor;
    // The person's word, then the steering: it does nothing before the path is released and runs.
    options.push = true;
    options.confirm_push = [&, asked = std::move(options.confirm_push)](const RunRecord& judged) {
        const auto region = std::find_if(judged.regions.begin(), judged.regions.end(),
                                         [&](const RegionRecord& r) { return r.region_id == p.region.id; });
        if (region == judged.regions.end() || (asked && !asked(judged))) return false;
        EventRecord by{0,
                       utc_now(),
                       judged.number,
                       EventKind::note,
                       p.region.id,
                       Text("the path is corrected online by guide {} (SHA-256 {})", kept.name, kept.hash)};
        const auto id = station.file().append_event(by);
        if (!id) return false;  // what cannot be recorded is not done
        by.id = *id;
        guided = std::move(by);
        setup.base_from_moved = region->base_from_frame * p.region.base_from_frame.inverse();
        steering = std::make_shared<SeamSteering>(*p.guide, setup);
        sensor = std::make_unique<AheadSensor>(*p.sensor, std::move(measurer), steering, ahead);
        p.link->steer(steering);
        return true;
    };
    // The outcome of the release is told here, on the running thread and before the sensors are stopped.
    bool ran = false;
    options.progress = [&, told = std::move(options.progress)](const RunProgress& progress) {
        const PathPhase phase = steering ? p.link->path_phase() : PathPhase::none;
        ran = ran || phase == PathPhase::running || (steering && steering->figures().cycles > 0);
        if (ran && phase != PathPhase::running && phase != PathPhase::waiting) sensor->end();
        if (told) told(progress);
    };
    auto run = station.run(options);
    if (sensor) sensor->end();
    if (steering) {
        p.link->steer(nullptr);
        out.figures = steering->figures();
    }
    if (!run) return tl::unexpected(run.error());
    out.run = *std::move(run);
    out.guide_hash = kept.hash;
    if (guided) out.run.events.push_back(std::move(*guided));
    out.base_from_moved = setup.base_from_moved;
    SEAM_OK(record(station, out, follow, p.region.id));
    return out;
}

Expected<std::vector<GuidePoint>> taught_guide(const Project& project, const std::string& spot_id,
                                               const GapPass& pass) {
    const Spot* spot = find_spot(project, spot_id);
    if (!spot) return input_error(Text("there is no spot \"{}\"", spot_id), project.name);
    SEAM_TRY(const auto finder, make_feature_finder(spot->feature));
    std::vector<GuidePoint> points;
    Text last;
    for (const GapSection& section : pass.sections) {
        const Feature f = finder->find(section.profile);
        if (f.status != FeatureStatus::ok) {
            last = f.message;
            continue;
        }
        points.push_back({section.frame_from_sensor * Eigen::Vector3d(f.point_mm.x(), 0, f.point_mm.y()),
                          section.frame_from_sensor.linear().col(2)});
    }
    if (points.size() < 3 || 2 * points.size() < pass.sections.size())
        return input_error(
            Text("the contour is found in {} of {} profiles ({})", points.size(), pass.sections.size(), last),
            project.name, "drive along the contour, with the sensor as at the spots");
    return smoothed_guide(points, kGuideHalfWidthMm, kGuideStepMm);
}

std::string guide_csv(const std::vector<GuidePoint>& guide) {
    ApplicationPath path;
    const auto curve = GuideCurve::make(guide);
    double s = 0;
    for (std::size_t i = 0; curve && i < guide.size(); ++i) {
        if (i > 0) s += (guide[i].point_mm - guide[i - 1].point_mm).norm();
        const Eigen::Matrix3d d = curve->directions(s);
        Eigen::Matrix3d axes;
        axes << d.col(1), d.col(0), d.col(2);
        path.points.push_back({make_pose(axes, guide[i].point_mm), {}});
    }
    return path_csv(path, PathNotation::kuka);
}

Expected<std::vector<GuidePoint>> parse_guide(std::string_view csv, const std::string& where) {
    SEAM_TRY(const auto table, parse_path_csv(csv, PathNotation::kuka, where));
    std::vector<GuidePoint> guide;
    for (const ApplicationPoint& p : table.points)
        guide.push_back({p.frame_from_tool.translation(), p.frame_from_tool.linear().col(2)});
    SEAM_OK(GuideCurve::make(guide));
    return guide;
}

Expected<NamedGuide> find_guide(const ProjectFile& file, const std::string& called) {
    std::error_code none;
    if (!std::filesystem::exists(called, none))
        if (auto kept = file.load_guide(called)) return NamedGuide{kept->name, kept->csv};
    SEAM_TRY(auto csv, read_text_file(called));
    SEAM_OK(parse_guide(csv, called));
    return NamedGuide{std::filesystem::path(called).filename().string(), std::move(csv)};
}

}  // namespace seamwright
