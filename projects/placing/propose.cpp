#include "projects/placing/propose.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "devices/simulated/scene/random.h"
#include "projects/measure/measure.h"
#include "projects/placing/expected_profile.h"
#include "projects/proof/forecast.h"

namespace seamwright {
namespace {

constexpr int kUsualPlaces = 60;
constexpr double kNearestMm = 10;      // of two places
constexpr double kCurveTravelMm = 20;  // of the edge that the spot's curve is fitted to
constexpr const char* kRegion = "proposed";

Eigen::Vector3d middle_normal(const DrawingPoint& p) {
    Eigen::Vector3d n = p.normal_left + p.normal_right;
    if (n.norm() < 0.1)
        n = p.normal_left.cross(p.tangent) - p.tangent.cross(p.normal_right);  // a knife's edge
    n -= p.tangent.dot(n) * p.tangent;
    return n.normalized();
}

struct Attitude {
    double arc_mm = 0, turned_deg = 0;
    int place = 0;
    Pose workobject_from_sensor = Pose::Identity();
};

// How far a place of the chain is from the piece between two others of it.
double beyond(const EdgeChain& chain, double arc, double from, double to) {
    if (arc >= from && arc <= to) return 0;
    const double before = from - arc, after = arc - to, length = chain.length_mm();
    if (!chain.closed) return std::max(before, after);
    return std::min(before > 0 ? before : before + length, after > 0 ? after : after + length);
}

std::vector<Attitude> attitudes(const EdgeChain& chain, const std::pair<double, double>& edge,
                                const ProposeOptions& o, int& places) {
    const double length = chain.length_mm();
    const double step = o.step_mm > 0 ? o.step_mm : std::max(kNearestMm, length / kUsualPlaces);
    places = std::max(1, static_cast<int>(length / step));
    std::vector<double> turns{0};
    if (o.cone_deg > 0) turns = {-o.cone_deg, 0, o.cone_deg};
    std::vector<Attitude> all;
    for (int i = 0; i < places; ++i) {
        const double arc = length * (i + 0.5) / places;
        if (beyond(chain, arc, edge.first, edge.second) > o.beyond_mm) continue;
        const DrawingPoint p = chain.at(arc);
        for (const double turn : turns)
            for (const double way : {1.0, -1.0}) {
                Eigen::Matrix3d axes;
                axes.col(1) = way * p.tangent;
                axes.col(2) = rotation_exp(rad_from_deg(turn) * p.tangent) * middle_normal(p);
                axes.col(0) = axes.col(1).cross(axes.col(2));
                all.push_back({arc, turn, i, make_pose(axes, p.point_mm)});
            }
    }
    return all;
}

std::optional<ContourCurve> curve_at(const EdgeChain& chain, const Attitude& a,
                                     const Eigen::Vector2d& reference) {
    const Pose sensor_from_workobject = a.workobject_from_sensor.inverse();
    std::vector<TravelPoint> travel;
    for (double s = -kCurveTravelMm; s <= kCurveTravelMm; s += 2) {
        const double arc = a.arc_mm + s;
        if (!chain.closed && (arc < 0 || arc > chain.length_mm())) continue;
        const Eigen::Vector3d p = sensor_from_workobject * chain.at(arc).point_mm;
        travel.push_back({p.y(), p.x() + reference.x(), p.z() + reference.y()});
    }
    auto curve = fit_contour_curve(travel);
    if (!curve) return std::nullopt;
    return *curve;
}

// The region's spots as candidates, each a place of its own.
Expected<PlacingTask> task_of(const Project& project, const Region& region,
                              const std::vector<TaughtBeadPoint>& bead) {
    PlacingTask task;
    const std::vector<SpotObservation> planned = planned_observations(project, region);
    if (planned.size() != region.spot_ids.size())
        return input_error("a spot of it cannot be planned", Text("region {}", region.id));
    for (std::size_t i = 0; i < planned.size(); ++i)
        task.candidates.push_back(
            {planned[i], travel_window_mm(*find_spot(project, planned[i].id)), static_cast<int>(i)});
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const TaughtBeadPoint& p : bead) middle += p.point_mm / static_cast<double>(bead.size());
    task.bead = bead;
    task.displacements = required_displacements(project.requirements, middle);
    task.options = planned_options(project, region);
    return task;
}

}  // namespace

// One spot, attitude and covariance a candidate.
struct Looked {
    Project project;  // without spots and regions
    Region region;    // without spots
    std::vector<Spot> spots;
    std::vector<Attitude> attitudes;
    std::vector<Eigen::Matrix2d> covariances;
    std::optional<SpotPlacing> placing;
    double three_sigma_mm = 0;  // wanted

    ProposedSpot spot(std::size_t candidate, const std::string& id) const {
        ProposedSpot p;
        p.spot = spots[candidate];
        p.spot.id = id;
        p.arc_mm = attitudes[candidate].arc_mm;
        p.turned_deg = attitudes[candidate].turned_deg;
        const Eigen::Matrix2d& s = covariances[candidate];
        const double mean = s.trace() / 2, off = std::hypot((s(0, 0) - s(1, 1)) / 2, s(0, 1));
        p.sigma_mm = {std::sqrt(mean + off), std::sqrt(std::max(0.0, mean - off))};
        p.point_mm = attitudes[candidate].workobject_from_sensor * p.spot.reference_mm;
        const std::vector<int> all = places();
        p.place = static_cast<std::size_t>(
            std::lower_bound(all.begin(), all.end(), attitudes[candidate].place) - all.begin());
        return p;
    }
    // As the safety gate will judge them, one standard deviation; 0: it cannot say.
    double forecast_mm(const std::vector<ProposedSpot>& proposed) const {
        Project with = project;
        Region of = region;
        for (const ProposedSpot& p : proposed) {
            with.spots.push_back(p.spot);
            of.spot_ids.push_back(p.spot.id);
        }
        const auto forecast = forecast_region(with, of);
        return forecast ? forecast->sigma_mm : 0;
    }
    // The numbers of the places that see something, in the order of the chain.
    std::vector<int> places() const {
        std::vector<int> all;
        for (const Attitude& a : attitudes)
            if (all.empty() || all.back() != a.place) all.push_back(a.place);
        return all;
    }
};

namespace {

class Proposer {
  public:
    Proposer(const Project& project, const Drawing& drawing, const ProposeOptions& options)
        : given_(project), drawing_(drawing), o_(options) {}

    Expected<Proposal> propose() {
        SEAM_OK(prepare());
        SEAM_OK(look());
        SEAM_TRY(auto task, placing_task());
        SEAM_TRY(auto made, SpotPlacing::make(std::move(task)));
        looked_->placing.emplace(std::move(made));
        const SpotPlacing& placing = *looked_->placing;
        if (placing.places() < o_.fewest)
            return input_error(Text("a feature is seen at {} places along edge {} only, {} are needed",
                                    placing.places(), o_.edge, o_.fewest),
                               drawing_.source,
                               "choose another edge, or let the sensor turn further (--cone-deg)");
        tell(0.7, "choosing");
        // The bead's own measure and the gate's must both hold: spots that the gate would refuse are not enough.
        for (int least = o_.fewest;;) {
            out_.set = placing.propose(least, o_.most);
            out_.spots.clear();
            take_spots();
            const int count = static_cast<int>(out_.set.chosen.size());
            const bool passes = 3 * out_.sigma_forecast_mm <= o_.three_sigma_mm;
            if (passes || !out_.set.enough || count >= o_.most) {
                out_.set.enough = out_.set.enough && passes;
                break;
            }
            least = count + 1;
        }
        const int k = static_cast<int>(out_.set.chosen.size());
        tell(0.9, "bounding");
        out_.bound_mm = placing.bound_mm(k);
        if (k > 1) out_.bound_of_fewer_mm = placing.bound_mm(k - 1);
        out_.along_mm = placing.along_bead(out_.set.chosen);
        out_.places = placing.places();
        out_.candidates = static_cast<int>(looked_->spots.size());
        looked_->three_sigma_mm = o_.three_sigma_mm;
        out_.looked = looked_;
        return std::move(out_);
    }

  private:
    void tell(double share, const Text& what) const {
        if (o_.progress) o_.progress(share, what);
    }

    Expected<void> prepare() {
        if (!(o_.three_sigma_mm > 0) || !std::isfinite(o_.three_sigma_mm))
            return usage_error("the wanted 3 sigma is not above 0 mm");
        if (o_.fewest < 1 || o_.most < o_.fewest || o_.most > 40)
            return usage_error("the number of spots is not from 1 to 40");
        if (!(o_.noise_mm > 0 && o_.noise_mm <= 1)) return usage_error("the noise is not from 0 to 1 mm");
        if (!(o_.cone_deg >= 0 && o_.cone_deg <= 60))
            return usage_error("the cone is not from 0 to 60 degrees");
        if (!(o_.beyond_mm >= 0)) return usage_error("how far beyond the edge spots may stand is below 0 mm");
        if (!(o_.step_mm >= 0 && o_.step_mm <= 1000) || (o_.step_mm > 0 && o_.step_mm < 1))
            return usage_error("the step between places is not from 1 to 1000 mm");
        if (given_.sensors.empty() || given_.robots.empty())
            return input_error("the project has no sensor or no robot", given_.name, "add both before spots");
        sensor_ = o_.sensor_id.empty() ? &given_.sensors.front() : find_sensor(given_, o_.sensor_id);
        robot_ = o_.robot_id.empty() ? &given_.robots.front() : find_robot(given_, o_.robot_id);
        if (!sensor_) return usage_error(Text("there is no sensor \"{}\"", o_.sensor_id));
        if (!robot_) return usage_error(Text("there is no robot \"{}\"", o_.robot_id));
        region_.id = kRegion;
        if (!o_.region_id.empty()) {
            const auto known = std::find_if(given_.regions.begin(), given_.regions.end(),
                                            [&](const Region& r) { return r.id == o_.region_id; });
            if (known == given_.regions.end())
                return usage_error(Text("there is no region \"{}\"", o_.region_id), given_.name);
            region_ = *known;
        }
        region_.spot_ids.clear();
        calibration_ = calibration_of(given_, sensor_->id);
        if (!calibration_)
            return input_error(Text("sensor {} has no calibration in use", sensor_->id), given_.name,
                               "calibrate it: where it stands on the flange decides where the robot goes");
        SEAM_TRY(auto chain, tangent_chain(drawing_, o_.edge));
        chain_ = std::move(chain);
        SEAM_TRY(auto bead, bead_of(drawing_, o_.edge, o_.bead_step_mm));
        out_.bead = std::move(bead);
        return {};
    }

    // Every attitude's spot, as far as it sees something.
    Expected<void> look() {
        const MeshTree tree(drawing_.mesh);
        const OpticsSettings optics = optics_of(*calibration_, o_.optics);
        looked_->project = given_;
        looked_->project.spots.clear();
        looked_->project.regions.clear();
        looked_->region = region_;
        Spot usual;  // the project's habits
        for (const Spot& spot : given_.spots)
            if (spot.sensor_id == sensor_->id) {
                usual.sigma_mm = spot.sigma_mm, usual.jitter_mm = spot.jitter_mm,
                usual.speed_mm_s = spot.speed_mm_s;
                usual.stop_at_trigger = spot.stop_at_trigger;
                break;
            }
        int places = 0;
        const std::vector<Attitude> all = attitudes(chain_, chain_.arcs_of(drawing_, o_.edge), o_, places);
        out_.tried = static_cast<int>(all.size());
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (o_.cancel.stop_requested())
                return tl::unexpected(Error{ErrorKind::usage, "cancelled", {}, {}, ErrorCode::cancelled});
            if (i % 16 == 0) tell(0.7 * static_cast<double>(i) / static_cast<double>(all.size()), "looking");
            const Attitude& a = all[i];
            const auto seen = expected_feature(tree, a.workobject_from_sensor, optics, sensor_->filter,
                                               o_.noise_mm, hash64(o_.seed, i), Eigen::Vector2d::Zero());
            if (!seen) continue;
            Spot spot = usual;
            spot.id = fmt::format("candidate {}", i + 1);
            spot.sensor_id = sensor_->id;
            spot.robot_id = robot_->id;
            spot.base_from_flange = given_.part.base_from_workobject * a.workobject_from_sensor *
                                    calibration_->flange_from_sensor.inverse();
            spot.feature = seen->recipe;
            spot.reference_mm = Eigen::Vector3d(seen->point_mm.x(), 0, seen->point_mm.y());
            spot.reference_profile = seen->profile;
            spot.curve = curve_at(chain_, a, seen->point_mm);
            spot.reference_state = ReferenceState::from_drawing;
            spot.drawn = DrawingOrigin{drawing_.source, 0, 0, o_.edge, a.arc_mm, spot.reference_mm};
            looked_->spots.push_back(std::move(spot));
            looked_->attitudes.push_back(a);
            looked_->covariances.push_back(seen->covariance_mm2);
        }
        return {};
    }

    Expected<PlacingTask> placing_task() {
        Project project = looked_->project;
        project.spots = looked_->spots;
        Region region = region_;
        for (const Spot& spot : project.spots) region.spot_ids.push_back(spot.id);
        project.regions = {region};
        SEAM_TRY(auto task, task_of(project, region, out_.bead));
        for (std::size_t i = 0; i < task.candidates.size(); ++i)
            task.candidates[i].place = looked_->attitudes[i].place;
        task.three_sigma_mm = o_.three_sigma_mm;
        task.one_may_be_lost = o_.one_may_be_lost;
        task.seed = o_.seed;
        return task;
    }

    void take_spots() {
        for (const std::size_t c : out_.set.chosen) out_.spots.push_back(looked_->spot(c, free_id()));
        out_.sigma_forecast_mm = looked_->forecast_mm(out_.spots);
    }
    std::string free_id() const {
        for (std::size_t n = 1;; ++n) {
            const std::string id = fmt::format("P{}", n);
            const bool taken =
                find_spot(given_, id) || std::any_of(out_.spots.begin(), out_.spots.end(),
                                                     [&](const ProposedSpot& p) { return p.spot.id == id; });
            if (!taken) return id;
        }
    }

    const Project& given_;
    const Drawing& drawing_;
    const ProposeOptions& o_;
    const SensorSetup* sensor_ = nullptr;
    const RobotSetup* robot_ = nullptr;
    const Calibration* calibration_ = nullptr;
    Region region_;  // without spots
    EdgeChain chain_;
    std::shared_ptr<Looked> looked_ = std::make_shared<Looked>();
    Proposal out_;
};

}  // namespace

Expected<PlacedSet> judge_spots(const Project& project, const Region& region,
                                const std::vector<TaughtBeadPoint>& bead) {
    SEAM_TRY(auto task, task_of(project, region, bead));
    std::vector<std::size_t> all(task.candidates.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
    SEAM_TRY(const auto placing, SpotPlacing::make(std::move(task)));
    return placing.judge(all);
}

Expected<std::vector<TaughtBeadPoint>> bead_of(const Drawing& drawing, const std::string& edge,
                                               double step_mm) {
    if (!(step_mm >= 1 && step_mm <= 1000))
        return usage_error("the step along the bead is not from 1 to 1000 mm");
    SEAM_TRY(auto chain, tangent_chain(drawing, edge));
    const auto [from, to] = chain.arcs_of(drawing, edge);
    const int n = std::max(2, static_cast<int>((to - from) / step_mm) + 1);
    std::vector<TaughtBeadPoint> bead;
    for (int i = 0; i < n; ++i) {
        const DrawingPoint p = chain.at(from + (to - from) * (i + 0.5) / n);
        const Eigen::Vector3d normal = middle_normal(p);
        bead.push_back({p.point_mm, normal, p.tangent.cross(normal).normalized()});
    }
    return bead;
}

Expected<Proposal> propose_spots(const Project& project, const Drawing& drawing,
                                 const ProposeOptions& options) {
    return Proposer(project, drawing, options).propose();
}

std::vector<Eigen::Vector3d> places_of(const Proposal& proposal) {
    std::vector<Eigen::Vector3d> points;
    if (!proposal.looked) return points;
    int last = -1;
    for (const Attitude& a : proposal.looked->attitudes)
        if (a.place != std::exchange(last, a.place)) points.push_back(a.workobject_from_sensor.translation());
    return points;
}

Expected<Proposal> move_proposed(const Proposal& proposal, const std::string& spot_id, std::size_t place) {
    const auto of = std::find_if(proposal.spots.begin(), proposal.spots.end(),
                                 [&](const ProposedSpot& p) { return p.spot.id == spot_id; });
    if (!proposal.looked || of == proposal.spots.end())
        return input_error(Text("there is no proposed spot \"{}\"", spot_id));
    const Looked& looked = *proposal.looked;
    const std::vector<int> places = looked.places();
    if (place >= places.size()) return input_error("nothing is seen there", Text("spot {}", spot_id));
    const auto at = static_cast<std::size_t>(of - proposal.spots.begin());
    std::vector<std::size_t> chosen = proposal.set.chosen;
    for (std::size_t i = 0; i < chosen.size(); ++i)
        if (i != at && looked.attitudes[chosen[i]].place == places[place])
            return input_error("another spot stands there", Text("spot {}", spot_id));
    const Attitude& was = looked.attitudes[chosen[at]];
    const auto travels = [](const Attitude& a) { return a.workobject_from_sensor.linear().col(1).eval(); };
    std::optional<PlacedSet> best;
    for (std::size_t c = 0; c < looked.attitudes.size(); ++c) {
        const Attitude& a = looked.attitudes[c];
        if (a.place != places[place]) continue;
        chosen[at] = c;
        PlacedSet set = looked.placing->judge(chosen);
        const bool as_it_was = a.turned_deg == was.turned_deg && travels(a).dot(travels(was)) > 0;
        if (as_it_was || !best || set.three_sigma_mm < best->three_sigma_mm) best = std::move(set);
        if (as_it_was) break;
    }
    std::vector<Eigen::Vector3d> points;
    std::vector<ProposedSpot> spots;
    for (std::size_t i = 0; i < best->chosen.size(); ++i) {
        spots.push_back(looked.spot(best->chosen[i], proposal.spots[i].spot.id));
        points.push_back(spots.back().point_mm);
    }
    Proposal moved = proposal;
    moved.spots.clear();
    moved.set = *best;
    moved.set.chosen.clear();
    for (const std::size_t i : short_way(points, moved.set.way_mm)) {
        moved.spots.push_back(std::move(spots[i]));
        moved.set.chosen.push_back(best->chosen[i]);
    }
    moved.along_mm = looked.placing->along_bead(moved.set.chosen);
    moved.sigma_forecast_mm = looked.forecast_mm(moved.spots);
    moved.set.enough = best->enough && 3 * moved.sigma_forecast_mm <= looked.three_sigma_mm;
    return moved;
}

}  // namespace seamwright
