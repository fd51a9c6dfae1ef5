#include "projects/evaluate/elastic_experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/correction/path/path_blend.h"
#include "core/correction/travel.h"
#include "core/elastic/bead_shape.h"
#include "devices/simulated/scene/door.h"

namespace seamwright::evaluation {
namespace {

constexpr double kBeadInboardMm = 10.5, kBeadStepMm = 10;
constexpr double kLength = 1000, kHeight = 750;

struct BentPart {
    Pose truth = Pose::Identity();
    double bend = 0, twist = 0, bulge = 0;
    Eigen::Vector3d place(Eigen::Vector3d p) const {
        const double x = p.x() / kLength, y = 2 * p.y() / kHeight - 1;
        p.z() += bend * x * x + twist * x * y + bulge * std::sin(3 * kPi * x);
        return truth * p;
    }
};

Eigen::Vector3d edge_at(double arc_mm) {
    const DoorEdge e = door_edge(arc_mm);
    return e.point_mm + kDoorFlangeTop_mm * e.up;
}
Eigen::Vector3d bead_at(double arc_mm) {
    const DoorEdge e = door_edge(arc_mm);
    return e.point_mm + kDoorFlangeTop_mm * e.up + kBeadInboardMm * e.inboard;
}

// Where the edge of `part` pierces the plane y = `travel_mm` of a sensor near `arc_mm`.
Eigen::Vector3d pierced(const BentPart& part, const Pose& workobject_from_sensor, double arc_mm,
                        double travel_mm) {
    const Pose back = workobject_from_sensor.inverse();
    double arc = arc_mm;
    for (int i = 0; i < 15; ++i) {
        const double y = (back * part.place(edge_at(arc))).y() - travel_mm;
        const double slope =
            (back * part.place(edge_at(arc + 0.5))).y() - (back * part.place(edge_at(arc - 0.5))).y();
        arc -= y / slope;
    }
    return back * part.place(edge_at(arc));
}

struct Bench {
    EvaluationSettings settings;
    std::vector<SpotObservation> spots;
    std::vector<double> arc_mm;
    std::vector<double> bead_arc_mm;
    std::vector<PathPoint> path;
    std::vector<std::string> side_ids;
    std::vector<DoorRegion> sides;
};

double arc_of(const Eigen::Vector3d& p) {
    double best = 0, nearest = std::numeric_limits<double>::infinity();
    for (double arc = 0; arc < door_edge_length_mm(); arc += 0.25)
        if (const double d = (edge_at(arc) - p).squaredNorm(); d < nearest) nearest = d, best = arc;
    return best;
}

Expected<Bench> bench_of(const EvaluationSettings& settings) {
    Bench b;
    b.settings = settings;
    const BentPart as_taught;
    for (const DoorSpot& spot : default_door_spots()) {
        SpotObservation o;
        o.id = spot.id;
        o.workobject_from_sensor = spot.workobject_from_sensor;
        const double arc = arc_of(spot.workobject_from_sensor * spot.edge_mm);
        o.reference_mm = pierced(as_taught, o.workobject_from_sensor, arc, 0);
        std::vector<TravelPoint> pass;
        for (double y = -20; y <= 20; y += 0.5) {
            const Eigen::Vector3d p = pierced(as_taught, o.workobject_from_sensor, arc, y);
            pass.push_back({y, p.x(), p.z()});
        }
        SEAM_TRY(o.curve, fit_contour_curve(pass));
        o.sigma_mm = std::hypot(settings.noise_mm, settings.repeatability_mm);
        b.spots.push_back(o);
        b.arc_mm.push_back(arc);
    }
    b.sides = default_door_regions();
    for (double arc = 0; arc < door_edge_length_mm(); arc += kBeadStepMm) {
        b.bead_arc_mm.push_back(arc);
        const std::string side = door_side_of(bead_at(arc));
        const auto at = std::ranges::find(b.sides, side, &DoorRegion::id);
        b.path.push_back(
            {make_pose(Eigen::Matrix3d::Identity(), bead_at(arc)), static_cast<int>(at - b.sides.begin())});
    }
    for (const DoorRegion& side : b.sides) b.side_ids.push_back(side.id);
    return b;
}

BentPart random_part(Random& random, double bend, double twist, double bulge, double shift, double turn_deg) {
    BentPart part;
    const Eigen::Vector3d t(random.uniform(-shift, shift), random.uniform(-shift, shift),
                            random.uniform(-shift, shift));
    const double turn = rad_from_deg(turn_deg);
    const Eigen::Vector3d w(random.uniform(-turn, turn), random.uniform(-turn, turn),
                            random.uniform(-turn, turn));
    const Eigen::Vector3d middle(0.5 * kLength, 0.5 * kHeight, 0);
    const Eigen::Matrix3d r = rotation_exp(w);
    part.truth = make_pose(r, t + middle - r * middle);
    const Eigen::Vector3d n = random.normal3();
    part.bend = bend * n.x();
    part.twist = twist * n.y();
    part.bulge = bulge;
    return part;
}

std::vector<SpotObservation> measure_part(const Bench& b, const BentPart& part, Random& random) {
    std::vector<SpotObservation> out = b.spots;
    for (std::size_t n = 0; n < out.size(); ++n) {
        const double travel = random.uniform(-b.settings.jitter_mm, b.settings.jitter_mm);
        const Eigen::Vector3d p = pierced(part, out[n].workobject_from_sensor, b.arc_mm[n], travel);
        const Eigen::Vector3d noise =
            b.settings.noise_mm * random.normal3() + b.settings.repeatability_mm * random.normal3();
        out[n].measured_mm = Eigen::Vector3d(p.x() + noise.x(), 0, p.z() + noise.z());
    }
    return out;
}

// As RegionCorrector does: where the part lies tells what the jitter does.
std::optional<Displacement> add_jitter(const Bench& b, std::vector<SpotObservation>& spots) {
    CorrectionOptions all;
    all.reject_outliers = false;
    const auto rough = solve_region(spots, all);
    if (!rough || rough->status != CorrectionStatus::ok) return std::nullopt;
    for (SpotObservation& o : spots) add_travel(o, rough->displacement, b.settings.jitter_mm);
    const auto solved = solve_region(spots, all);
    if (!solved || solved->status != CorrectionStatus::ok) return std::nullopt;
    return solved->displacement;
}

struct Errors {
    std::vector<double> all;
    double stated = 0;
    std::size_t inside = 0;
    int parts = 0, acted = 0;
    void add(double off, double variance) {
        all.push_back(off);
        stated += variance;
        inside += std::abs(off) < 1.96 * std::sqrt(variance);
    }
    ElasticWay way(std::string name, int spots) const {
        const double n = std::max(1.0, static_cast<double>(all.size()));
        return {std::move(name),
                spots,
                summarise(all),
                3 * std::sqrt(stated / n),
                static_cast<double>(inside) / n,
                parts,
                acted};
    }
};

// Of the corrected place against the true bead of the part, across it. What lies along it is no error.
void judge_bead(const BentPart& part, double arc, const Eigen::Vector3d& found,
                const Eigen::Matrix3d& covariance, Errors& errors) {
    const Eigen::Vector3d along =
        (part.place(bead_at(arc + 0.5)) - part.place(bead_at(arc - 0.5))).normalized();
    const Eigen::Vector3d up = part.truth.linear() * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d aside = along.cross(up).normalized(), out = aside.cross(along);
    const Eigen::Vector3d off = found - part.place(bead_at(arc));
    for (const Eigen::Vector3d& n : {aside, out}) errors.add(off.dot(n), n.dot(covariance * n));
}

void judge_rigid(const Bench& b, const BentPart& part, const std::vector<SpotObservation>& spots, Errors& one,
                 Errors& four) {
    CorrectionOptions all;
    all.reject_outliers = false;
    const auto covariance_at = [](const Matrix6& c, const Eigen::Vector3d& moved) {
        Eigen::Matrix<double, 3, 6> j;
        j << Eigen::Matrix3d::Identity(), -skew(moved);
        return Eigen::Matrix3d(j * c * j.transpose());
    };
    if (const auto whole = solve_region(spots, all); whole && whole->status == CorrectionStatus::ok) {
        ++one.parts;
        const Pose& d = whole->displacement.workobject_from_movedworkobject;
        for (const double arc : b.bead_arc_mm)
            judge_bead(part, arc, d * bead_at(arc),
                       covariance_at(whole->covariance, d.linear() * bead_at(arc)), one);
    }
    std::vector<PathRegion> regions;
    for (const DoorRegion& side : b.sides) {
        std::vector<SpotObservation> own;
        for (const SpotObservation& o : spots)
            if (std::ranges::find(side.spot_ids, o.id) != side.spot_ids.end()) own.push_back(o);
        const auto solved = solve_region(own, all);
        if (!solved || solved->status != CorrectionStatus::ok) return;
        regions.push_back({solved->displacement, solved->covariance});
    }
    const auto path = correct_path(b.path, regions, b.side_ids, {60, true});
    if (!path) return;
    ++four.parts;
    for (std::size_t i = 0; i < b.path.size(); ++i) {
        const PathCorrection& p = path->points[i];
        const Eigen::Vector3d found = p.workobject_from_tool.translation();
        const Matrix6& c = regions[static_cast<std::size_t>(p.region)].covariance;
        judge_bead(part, b.bead_arc_mm[i], found,
                   covariance_at(c, p.displacement.workobject_from_movedworkobject.linear() *
                                        bead_at(b.bead_arc_mm[i])),
                   four);
    }
}

// Modes of some of the spots, and where these stand on the bead.
struct Learnt {
    std::vector<std::string> ids;
    ElasticModes modes;
    std::optional<BeadShape> shape;
    std::vector<SpotObservation> of(std::vector<SpotObservation> spots) const {
        std::erase_if(spots,
                      [&](const SpotObservation& o) { return std::ranges::find(ids, o.id) == ids.end(); });
        return spots;
    }
};

Expected<Learnt> learn(const Bench& b, const std::vector<std::vector<SpotObservation>>& parts,
                       std::vector<std::string> ids) {
    Learnt out;
    out.ids = std::move(ids);
    std::vector<ElasticSpot> slots;
    std::vector<BeadPlace> places;
    for (std::size_t n = 0; n < b.spots.size(); ++n) {
        const SpotObservation& o = b.spots[n];
        if (std::ranges::find(out.ids, o.id) == out.ids.end()) continue;
        slots.push_back({o.id, o.workobject_from_sensor, o.reference_mm, o.weights});
        places.push_back({o.workobject_from_sensor * o.reference_mm, b.arc_mm[n]});
    }
    std::vector<ElasticRow> rows;
    CorrectionOptions all;
    all.reject_outliers = false;
    for (const auto& measured : parts) {
        std::vector<SpotObservation> seen = out.of(measured);
        const auto displacement = add_jitter(b, seen);
        if (!displacement) continue;
        SEAM_TRY(ElasticRow row, elastic_row(slots, seen, all, *displacement));
        row.id = row.part_id = fmt::format("part {}", rows.size() + 1);
        rows.push_back(std::move(row));
    }
    SEAM_TRY(out.modes, learn_modes(slots, rows));
    SEAM_TRY(out.shape, BeadShape::make(out.modes, places, {true, door_edge_length_mm()}));
    return out;
}

void judge_elastic(const Bench& b, const BentPart& part, const std::vector<SpotObservation>& measured,
                   const Learnt& learnt, Errors& errors) {
    std::vector<SpotObservation> spots = learnt.of(measured);
    if (!add_jitter(b, spots)) return;
    auto joint = solve_elastic(spots, {}, learnt.modes);
    if (!joint) return;
    if (!joint->acted) {  // as the rigid way of the table
        CorrectionOptions all;
        all.reject_outliers = false;
        auto rigid = solve_region(spots, all);
        if (!rigid || rigid->status != CorrectionStatus::ok) return;
        joint->correction = std::move(*rigid);
    }
    ++errors.parts;
    errors.acted += joint->acted;
    for (const double arc : b.bead_arc_mm) {
        const BeadPoint p = bead_point(*joint, *learnt.shape, {bead_at(arc), arc});
        judge_bead(part, arc, p.place_mm, p.covariance_mm2, errors);
    }
}

}  // namespace

Expected<ElasticExperiment> elastic_experiment(const EvaluationSettings& settings) {
    ElasticExperiment e;
    e.learnt = 40;
    e.tried = 200;
    e.unseen = 50;
    e.noise_mm = settings.noise_mm;
    e.repeatability_mm = settings.repeatability_mm;
    e.jitter_mm = settings.jitter_mm;
    e.bend_mm = 0.3;
    e.twist_mm = 0.2;
    e.bulge_mm = 0.25;
    e.shift_mm = 4;
    e.turn_deg = 0.35;
    e.seed = settings.seed;
    SEAM_TRY(const Bench b, bench_of(settings));
    Random random(hash64(settings.seed, 71), 1);
    std::vector<std::vector<SpotObservation>> training;
    for (int i = 0; i < e.learnt; ++i)
        training.push_back(
            measure_part(b, random_part(random, e.bend_mm, e.twist_mm, 0, e.shift_mm, e.turn_deg), random));
    std::vector<std::string> all, fewer;
    for (const SpotObservation& o : b.spots) {
        all.push_back(o.id);
        if (o.id.back() != '2') fewer.push_back(o.id);
    }
    SEAM_TRY(const Learnt whole, learn(b, training, all));
    SEAM_TRY(const Learnt third_less, learn(b, training, fewer));
    e.modes = static_cast<int>(whole.modes.modes.size());
    e.modes_of_fewer = static_cast<int>(third_less.modes.modes.size());
    Errors one, four, modes, few;
    for (int i = 0; i < e.tried; ++i) {
        const BentPart part = random_part(random, e.bend_mm, e.twist_mm, 0, e.shift_mm, e.turn_deg);
        const std::vector<SpotObservation> measured = measure_part(b, part, random);
        std::vector<SpotObservation> spots = measured;
        if (!add_jitter(b, spots)) continue;
        judge_rigid(b, part, spots, one, four);
        judge_elastic(b, part, measured, whole, modes);
        judge_elastic(b, part, measured, third_less, few);
    }
    const int n = static_cast<int>(all.size()), m = static_cast<int>(fewer.size());
    e.ways = {one.way("rigid, one region", n), four.way("rigid, four regions", n), modes.way("modes", n),
              few.way("modes, a third fewer spots", m)};
    for (int i = 0; i < e.unseen; ++i) {
        const BentPart part = random_part(random, e.bend_mm, e.twist_mm, e.bulge_mm, e.shift_mm, e.turn_deg);
        std::vector<SpotObservation> spots = measure_part(b, part, random);
        if (!add_jitter(b, spots)) continue;
        const auto joint = solve_elastic(spots, {}, whole.modes);
        e.noticed += joint && !joint->acted;
    }
    return e;
}

std::string elastic_text(const ElasticExperiment& e) {
    std::string text = fmt::format(
        "Simulated: doors bent by {:g} mm and twisted by {:g} mm (1 sigma), displaced by up to {:g} mm and "
        "{:g} "
        "degrees per axis; noise {:g} mm, robot {:g} mm, trigger jitter {:g} mm half width, seed {}. {} "
        "modes learnt "
        "from {} parts, figures of {} others. Bead across its path, every 10 mm:\n",
        e.bend_mm, e.twist_mm, e.shift_mm, e.turn_deg, e.noise_mm, e.repeatability_mm, e.jitter_mm, e.seed,
        e.modes, e.learnt, e.tried);
    for (const ElasticWay& w : e.ways)
        text += fmt::format(
            "{:<28} {:>2} spots   3 sigma {:.4f} mm   stated {:.4f}   inside 95 % {:.1f} %   modes acted on "
            "{} of {}\n",
            w.name, w.spots, w.error.three_sigma, w.stated, 100 * w.inside, w.acted, w.parts);
    text += fmt::format("modes against rigid regions with the same spots: {:.2f} times better\n", e.gain());
    return text + fmt::format("a shape that was not learnt ({:g} mm): noticed on {} of {} parts\n",
                              e.bulge_mm, e.noticed, e.unseen);
}

nlohmann::json elastic_json(const ElasticExperiment& e) {
    nlohmann::json ways = nlohmann::json::array();
    for (const ElasticWay& w : e.ways)
        ways.push_back({{"way", w.name},
                        {"spots", w.spots},
                        {"three_sigma_mm", w.error.three_sigma},
                        {"mean_mm", w.error.mean},
                        {"stated_three_sigma_mm", w.stated},
                        {"inside_95", w.inside},
                        {"parts", w.parts},
                        {"acted", w.acted}});
    return {{"simulated", true},
            {"seed", e.seed},
            {"noise_mm", e.noise_mm},
            {"repeatability_mm", e.repeatability_mm},
            {"jitter_mm", e.jitter_mm},
            {"bend_mm", e.bend_mm},
            {"twist_mm", e.twist_mm},
            {"learnt_parts", e.learnt},
            {"tried_parts", e.tried},
            {"modes", e.modes},
            {"modes_of_fewer_spots", e.modes_of_fewer},
            {"ways", ways},
            {"gain", e.gain()},
            {"unseen", {{"size_mm", e.bulge_mm}, {"parts", e.unseen}, {"noticed", e.noticed}}}};
}

}  // namespace seamwright::evaluation
