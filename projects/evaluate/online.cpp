#include "projects/evaluate/online.h"
#include "projects/evaluate/spread.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include "core/correction/ahead/delay_line.h"
#include "core/correction/path/path_blend.h"
#include "core/features/kinds/feature_registry.h"
#include "core/profile/filter.h"
#include "devices/simulated/scene/door.h"
#include "devices/simulated/scene/profile_cut.h"

namespace seamwright::evaluation {
namespace {

constexpr int kParts = 2;
constexpr double kShiftMm = 4, kTurnDeg = 0.35, kBendMm = 0.3, kTwistMm = 0.2;
constexpr double kReferenceStepMm = 5, kPathStepMm = 2;
constexpr int kReferenceRepeats = 8;
const Eigen::Vector3d kPartMiddle(500, 375, 0);

// As a DoorSpot's sensor stands (door.h), anywhere along the contour.
Pose sensor_at(double arc_mm) {
    const DoorEdge e = door_edge(arc_mm);
    Eigen::Matrix3d axes;
    axes.col(0) = e.inboard;
    axes.col(2) = e.up;
    axes.col(1) = e.up.cross(e.inboard);
    return make_pose(axes, e.point_mm + 15 * e.inboard + kDoorFlangeTop_mm * e.up);
}

// The contour as taught: the landmark's place in the sensor's plane against the arc.
class Reference {
  public:
    explicit Reference(std::vector<Eigen::Vector2d> points) : points_(std::move(points)) {}
    Eigen::Vector2d at(double arc_mm) const {
        const double n = static_cast<double>(points_.size());
        double u = arc_mm / door_edge_length_mm() * n;
        u -= n * std::floor(u / n);
        const auto i = static_cast<std::size_t>(u) % points_.size();
        const double share = u - std::floor(u);
        return (1 - share) * points_[i] + share * points_[(i + 1) % points_.size()];
    }
    Eigen::Vector3d place(double arc_mm) const {
        const Eigen::Vector2d p = at(arc_mm);
        return sensor_at(arc_mm) * Eigen::Vector3d(p.x(), 0, p.y());
    }

  private:
    std::vector<Eigen::Vector2d> points_;
};

struct Part {
    Pose truth = Pose::Identity();
    PartBend bend;
    Eigen::AlignedBox3d box;
    Eigen::Vector3d displaced(Eigen::Vector3d p) const {
        p.z() += bend_at(bend, box, p);
        return truth * p;
    }
};

// (across, height) from the true contour to `point`, which belongs to `arc_mm` of the path.
Eigen::Vector2d error_at(const Reference& exact, const Part& part, const Eigen::Vector3d& point,
                         double arc_mm) {
    constexpr double h = 0.5;
    double arc = arc_mm;
    Eigen::Vector3d off = Eigen::Vector3d::Zero(), along = Eigen::Vector3d::UnitY();
    for (int i = 0; i < 4; ++i) {  // the foot of the perpendicular
        along = (part.displaced(exact.place(arc + h)) - part.displaced(exact.place(arc - h))) / (2 * h);
        off = point - part.displaced(exact.place(arc));
        arc += off.dot(along) / along.squaredNorm();
    }
    off = point - part.displaced(exact.place(arc));
    const Eigen::Vector3d up = part.truth.linear() * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d across = along.normalized().cross(up).normalized();
    return {off.dot(across), off.dot(along.normalized().cross(across).normalized())};
}

// Measured, and known from then on.
struct Measure {
    double ready_s;
    AheadMeasure what;
};

struct World {
    Cell cell;
    Method method;
    TaughtCell taught;  // with a region for every side of the door
    FeatureRecipe recipe;
    Reference measured{{}}, exact{{}};  // as the pass found it; without noise
    double point_sigma_mm = 0;          // of a measure, from the pass
    Eigen::AlignedBox3d box;
};

std::optional<Eigen::Vector2d> measure_at(const World& w, const MeshTree& mesh, const FeatureFinder& finder,
                                          const Pose& part_from_sensor, double noise_mm, Random& random,
                                          Profile& profile) {
    cut_profile(mesh, part_from_sensor, w.cell.optics, profile);
    ++*w.cell.profiles;
    if (noise_mm > 0) add_noise(profile, noise_mm, random);
    (void)filter_profile(profile, {});  // refuses only arrays of different length
    const Feature f = finder.find(profile);
    if (f.status != FeatureStatus::ok) return std::nullopt;
    return f.point_mm;
}

Expected<void> teach_pass(World& w) {
    const EvaluationSettings& s = w.cell.settings;
    const auto count = static_cast<std::size_t>(std::ceil(door_edge_length_mm() / kReferenceStepMm));
    std::vector<Eigen::Vector2d> measured(count), exact(count);
    std::vector<double> variance(count);
    std::atomic<int> lost{0};
    spread_out(s.jobs, count, [&] {
        return [&, finder = std::shared_ptr<FeatureFinder>(std::move(*make_feature_finder(w.recipe))),
                profile = std::make_shared<Profile>()](std::size_t i) {
            Random random(hash64(s.seed, 61), i);
            const Pose at =
                sensor_at(door_edge_length_mm() * static_cast<double>(i) / static_cast<double>(count));
            const auto clean = measure_at(w, *w.cell.taught, *finder, at, 0, random, *profile);
            Eigen::Vector2d sum = Eigen::Vector2d::Zero();
            double squares = 0, n = 0;
            for (int k = 0; k < kReferenceRepeats; ++k) {
                Pose there = at;
                there.translation() += s.repeatability_mm * random.normal3();
                const auto p = measure_at(w, *w.cell.taught, *finder, there, s.noise_mm, random, *profile);
                if (!p || !clean) continue;
                sum += *p;
                squares += (*p - *clean).squaredNorm();
                n += 1;
            }
            if (n < kReferenceRepeats / 2) {
                ++lost;
                return;
            }
            exact[i] = *clean;
            measured[i] = sum / n;
            variance[i] = squares / (2 * n);
        };
    });
    if (lost > 0)
        return input_error("the contour is not found everywhere along the pass over the taught part",
                           "online correction", "evaluate with less noise");
    w.measured = Reference(std::move(measured));
    w.exact = Reference(std::move(exact));
    double sum = 0;
    for (double v : variance) sum += v / static_cast<double>(count);
    w.point_sigma_mm = std::sqrt(sum);
    return {};
}

struct PartErrors {
    bool alarm = false;
    std::vector<double> arc_mm;
    std::vector<Eigen::Vector2d> error;
    double behind = 0;    // share of the cycles
    double variance = 0;  // as stated, of one coordinate, mean along the path
};

PartErrors run_online(const World& w, const OnlineWay& way, const Part& part, const MeshTree& mesh,
                      Random& random) {
    const EvaluationSettings& s = w.cell.settings;
    const auto finder = std::move(*make_feature_finder(w.recipe));
    Profile profile;
    PartErrors out;
    const double cycle = way.cycle_ms / 1000, lag = way.lag_ms / 1000, period = 1 / way.rate_hz;
    OffsetTrail trail(way.limits.speed_mm_s, way.limits.acceleration_mm_s2, cycle);
    Eigen::Vector2d actual = Eigen::Vector2d::Zero();
    DelayLineOptions smoothing;
    smoothing.shortest_mm = smoothing.longest_mm = way.smooth_mm;
    DelayLine line(smoothing);
    std::deque<Measure> coming;
    const Eigen::Matrix2d of_measure = w.point_sigma_mm * w.point_sigma_mm * Eigen::Matrix2d::Identity();
    double next_exposure = 0, next_judged = 0, cycles = 0;
    const double end = door_edge_length_mm();
    for (double t = 0;; t += cycle) {
        const double arc = -kRunInMm + way.speed_mm_s * t;
        if (arc > end) break;
        while (next_exposure <= t) {
            // The sensor rides on the corrected tool; the controller's pose says where it stands.
            const double at = -kRunInMm + way.speed_mm_s * next_exposure + way.look_ahead_mm;
            const Pose taught = sensor_at(at);
            Pose there = taught;
            there.translation() += taught.linear() * Eigen::Vector3d(actual.x(), 0, actual.y());
            Pose real = there;
            real.translation() += s.repeatability_mm * random.normal3();
            const auto p =
                measure_at(w, mesh, *finder, part.truth.inverse() * real, s.noise_mm, random, profile);
            if (p) {
                const Eigen::Vector2d found = *p + actual - w.measured.at(at);
                coming.push_back({next_exposure + way.delay_ms / 1000, {at, found, of_measure}});
            }
            next_exposure += period;
        }
        // Where the tool will be when what is sent now has been followed.
        const double acts = arc + way.speed_mm_s * (cycle + lag);
        for (; !coming.empty() && coming.front().ready_s <= t; coming.pop_front())
            (void)line.add(coming.front().what);
        const AheadOffset known = line.at(acts);
        const Eigen::Vector2d& target = known.off_mm;
        const Eigen::Vector2d rate = way.speed_mm_s * known.slope;
        if (target.norm() > way.limit_mm) {
            out.alarm = true;
            return out;
        }
        trail.set_target({target.x(), target.y(), 0}, {rate.x(), rate.y(), 0});
        const Eigen::Vector2d sent = trail.step().head<2>();
        actual += (sent - actual) * (1 - std::exp(-cycle / lag));
        const double now = arc + way.speed_mm_s * cycle;
        if (now >= 0) {
            cycles += 1;
            out.behind += (target - sent).norm() > kBehindMm;
            out.variance += known.covariance_mm2.trace() / 2;
        }
        if (now < 0 || now < next_judged || now > end) continue;
        next_judged += kPathStepMm;
        const Pose taught = sensor_at(now);
        const Eigen::Vector2d r = w.exact.at(now) + actual;
        const Eigen::Vector3d tool =
            taught * Eigen::Vector3d(r.x(), 0, r.y()) + s.repeatability_mm * random.normal3();
        out.arc_mm.push_back(now);
        out.error.push_back(error_at(w.exact, part, tool, now));
    }
    out.behind /= std::max(1.0, cycles);
    out.variance = out.variance / std::max(1.0, cycles) + of_measure(0, 0) / kReferenceRepeats +
                   s.repeatability_mm * s.repeatability_mm;
    return out;
}

PartErrors run_offline(const World& w, const Part& part, const MeshTree& mesh, Random& random) {
    const EvaluationSettings& s = w.cell.settings;
    PartErrors out;
    Frame frame;
    Cell cell = w.cell;
    cell.measured = std::shared_ptr<MeshTree>(const_cast<MeshTree*>(&mesh), [](MeshTree*) {});
    std::vector<SpotMeasurement> measurements;
    Measurers measurers = make_measurers(w.taught);
    for (std::size_t n = 0; n < measurers.size(); ++n)
        measurements.push_back(
            measure_spot(cell, w.method, w.taught.spots[n], n, measurers[n], part.truth, random, frame));
    std::vector<PathRegion> regions;
    std::vector<std::string> names;
    for (const RegionRecord& side : correct_regions(w.taught.project, measurements)) {
        if (!side.correction || side.correction->status != CorrectionStatus::ok) {
            out.alarm = true;
            return out;
        }
        regions.push_back({side.correction->displacement, side.correction->covariance});
        names.push_back(side.region_id);
    }
    std::vector<PathPoint> path;
    for (double arc = 0; arc < door_edge_length_mm(); arc += kPathStepMm) {
        PathPoint p;
        p.workobject_from_tool.translation() = w.exact.place(arc);
        const auto at = std::find(names.begin(), names.end(), door_side_of(door_edge(arc).point_mm));
        p.region = static_cast<int>(at - names.begin());
        path.push_back(p);
        out.arc_mm.push_back(arc);
    }
    const auto corrected = correct_path(path, regions, names, {60, true});
    if (!corrected) {
        out.alarm = true;
        return out;
    }
    for (std::size_t i = 0; i < path.size(); ++i) {
        const PathCorrection& p = corrected->points[i];
        const Eigen::Vector3d tool =
            p.workobject_from_tool.translation() + s.repeatability_mm * random.normal3();
        out.error.push_back(error_at(w.exact, part, tool, out.arc_mm[i]));
        // Of one coordinate: the regions' own along the contour is not seen in the error.
        const PathRegion& region = regions[static_cast<std::size_t>(p.region)];
        const Pose taught = sensor_at(out.arc_mm[i]);
        Eigen::Matrix<double, 3, 6> j;
        j << Eigen::Matrix3d::Identity(), -skew(path[i].workobject_from_tool.translation());
        const Eigen::Matrix3d c = j * region.covariance * j.transpose();
        const double seen = 0.5 * (taught.linear().col(0).dot(c * taught.linear().col(0)) +
                                   taught.linear().col(2).dot(c * taught.linear().col(2)));
        out.variance += (seen + s.repeatability_mm * s.repeatability_mm) / static_cast<double>(path.size());
    }
    return out;
}

}  // namespace

bool OnlineWay::in_time() const {
    const double needed = speed_mm_s * (delay_ms + cycle_ms + lag_ms + 1000 / rate_hz) / 1000 + smooth_mm;
    return !online || look_ahead_mm >= needed;
}

Expected<OnlineExperiment> online_experiment(const EvaluationSettings& settings,
                                             std::atomic<std::size_t>& profiles) {
    World w;
    w.cell = door_cell(settings, profiles);
    SEAM_TRY(w.taught, teach_all(w.cell, w.method));
    w.recipe = w.taught.spots.front().spot.feature;  // the rim's section is the same all along
    w.taught.project.regions.clear();
    for (const DoorRegion& side : default_door_regions()) {
        w.taught.project.regions.emplace_back().id = side.id;
        w.taught.project.regions.back().spot_ids = side.spot_ids;
    }
    TriangleMesh mesh = door_mesh();
    w.box = mesh.box();
    SEAM_OK(teach_pass(w));

    OnlineExperiment out;
    out.contour_mm = door_edge_length_mm();
    out.bend_mm = kBendMm;
    out.twist_mm = kTwistMm;
    out.shift_mm = kShiftMm;
    out.turn_deg = kTurnDeg;
    for (const bool bent : {false, true}) {
        OnlineResult offline;
        offline.way.online = false;
        offline.bent = bent;
        out.results.push_back(offline);
        for (const double speed : {100.0, 200.0, 400.0})
            for (const double delay : {20.0, 60.0, 150.0}) {
                if (bent && (speed != 100 || delay != 60)) continue;
                OnlineResult r;
                r.way.speed_mm_s = speed;
                r.way.delay_ms = delay;
                r.bent = bent;
                out.results.push_back(r);
            }
    }
    TriangleMesh bent_mesh = mesh;
    for (Eigen::Vector3d& v : bent_mesh.vertices) v.z() += bend_at({kBendMm, kTwistMm}, w.box, v);
    const MeshTree bent_tree(std::move(bent_mesh));

    std::vector<PartErrors> errors(out.results.size() * kParts);
    const auto worker = [&] {
        return [&](std::size_t i) {
            const OnlineResult& result = out.results[i / kParts];
            // The same parts for every way.
            Random where(hash64(settings.seed, 62), i % kParts);
            const auto vector = [&](double reach) {
                const double x = where.uniform(-reach, reach), y = where.uniform(-reach, reach),
                             z = where.uniform(-reach, reach);
                return Eigen::Vector3d(x, y, z);
            };
            const Eigen::Vector3d move = vector(kShiftMm), turn = vector(rad_from_deg(kTurnDeg));
            const Eigen::Matrix3d r = rotation_exp(turn);
            Part part;
            part.truth = make_pose(r, move + kPartMiddle - r * kPartMiddle);
            if (result.bent) part.bend = {kBendMm, kTwistMm};
            part.box = w.box;
            const MeshTree& tree = result.bent ? bent_tree : *w.cell.taught;
            Random random(hash64(settings.seed, 63), i);
            errors[i] = result.way.online ? run_online(w, result.way, part, tree, random)
                                          : run_offline(w, part, tree, random);
        };
    };
    spread_values(settings, profiles, errors.size(), worker, [&](PartValue& part, std::size_t i) {
        PartErrors& e = errors[i];
        part(e.alarm);
        part.list(e.arc_mm, [&](double& v) { part(v); });
        part.list(e.error, [&](Eigen::Vector2d& v) { part.matrix(v); });
        part(e.behind);
        part(e.variance);
    });
    for (std::size_t k = 0; k < out.results.size(); ++k) {
        OnlineResult& r = out.results[k];
        std::vector<double> all;
        double variance = 0;
        for (std::size_t p = 0; p < kParts; ++p) {
            const PartErrors& e = errors[k * kParts + p];
            if (e.alarm) {
                ++r.alarms;
                continue;
            }
            const bool first = r.parts == 0;
            ++r.parts;
            variance += e.variance;
            r.behind_share += e.behind / kParts;
            for (std::size_t i = 0; i < e.error.size(); ++i) {
                for (const double v : e.error[i]) all.push_back(v);
                r.worst_mm = std::max(r.worst_mm, e.error[i].norm());
                if (!first) continue;
                r.arc_mm.push_back(e.arc_mm[i]);
                r.length_mm.push_back(e.error[i].norm());
            }
        }
        r.error = summarise(all);
        r.sigma_mm = std::sqrt(variance / std::max(1, r.parts));
    }
    return out;
}

}  // namespace seamwright::evaluation
