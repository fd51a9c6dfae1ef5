#include "projects/proof/forecast.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "core/correction/predicted.h"
#include "core/correction/sigma.h"
#include "core/correction/travel.h"
#include "core/numbers.h"
#include "projects/measure/measure.h"
#include "projects/measure/nozzle.h"

namespace seamwright {
namespace {

using Spots = std::vector<SpotObservation>;

// How much larger than on the reference profile a feature's sigma may be on another: each profile states its
// own from the few points about the feature, and the gate judges by that. A contour end stands on the fewest:
// at the rendered door's rim one part in twenty states 1.6 times the middle one, and the reference may be one
// of the surest.
double feature_spread(const Spot& spot) {
    return spot.feature.kind == "contour-end" ? 2.5 : 1.5;
}
// A cure that gains less is not worth a word.
constexpr double kWorthIt = 0.98;

struct Sigma {
    double mm = 0, deg = 0;
    std::size_t worst = 0;
};

// One spot changed: without its feature's noise, without jitter.
constexpr std::size_t kNone = static_cast<std::size_t>(-1);
struct Change {
    std::size_t spot = kNone;
    bool feature = false, travel = false;
};

class Forecaster {
  public:
    Forecaster(const Project& project, const Region& region, Spots spots)
        : project_(project),
          options_(planned_options(project, region)),
          spots_(std::move(spots)),
          nozzle_mm_(nozzle_sigma_mm(project, region)),
          middle_(Eigen::Vector3d::Zero()) {
        for (SpotObservation& s : spots_) {
            middle_ += point(s) / static_cast<double>(spots_.size());
            const Spot& spot = *find_spot(project_, s.id);
            const double taught = spot.sigma_mm, more = feature_spread(spot) * feature_spread(spot);
            if (s.covariance_mm2)
                s.covariance_mm2 =
                    more * *s.covariance_mm2 + (1 - more) * taught * taught * Eigen::Matrix2d::Identity();
            s.sigma_mm = std::sqrt(more * s.sigma_mm * s.sigma_mm + (1 - more) * taught * taught);
        }
    }

    Sigma sigma(const Change& change = {}, const SpotObservation* further = nullptr) const {
        Sigma worst;
        for (const Displacement& d : required_displacements(project_.requirements, middle_)) {
            Spots moved = spots_;
            for (std::size_t i = 0; i < moved.size(); ++i) {
                SpotObservation& o = moved[i];
                const Spot& spot = *find_spot(project_, o.id);
                if (i == change.spot && change.feature) {
                    o.sigma_mm = spot.sigma_mm;
                    o.covariance_mm2.reset();
                    o.reference_covariance_mm2.reset();
                }
                o.measured_mm = displaced_measure(o, d);
                if (i != change.spot || !change.travel) add_travel(o, d, travel_window_mm(spot));
            }
            if (further) {
                moved.push_back(*further);
                moved.back().id = "further spot";
            }
            const auto predicted = predicted_covariance(moved, options_, d);
            if (!predicted || !predicted->sum.allFinite()) return {kInfinity, kInfinity, 0};
            const Matrix6& covariance = predicted->sum;
            for (std::size_t i = 0; i < spots_.size(); ++i) {
                const double at =
                    sigma_at_mm(covariance, d.workobject_from_movedworkobject, point(spots_[i]));
                if (!(at <= worst.mm)) worst.mm = at, worst.worst = i;
            }
            worst.deg = std::max(worst.deg, deg_from_rad(worst_sigma(covariance.bottomRightCorner<3, 3>())));
        }
        // As the gate sums it.
        if (nozzle_mm_ > 0) worst.mm = std::hypot(worst.mm, nozzle_mm_);
        return worst;
    }

    std::vector<Cure> cures(const Sigma& now) const {
        std::vector<Cure> all;
        const auto add = [&](const Sigma& then, Text what) {
            if (then.mm < kWorthIt * now.mm) all.push_back({std::move(what), then.mm});
        };
        for (std::size_t i = 0; i < spots_.size(); ++i) {
            const Spot& spot = *find_spot(project_, spots_[i].id);
            const double feature = std::sqrt(std::max(0.0, spots_[i].sigma_mm * spots_[i].sigma_mm -
                                                               spot.sigma_mm * spot.sigma_mm)) /
                                   feature_spread(spot);
            const Sigma with_better_feature = sigma({i, true, false});
            const std::string known = fmt::format("{:.3f}", feature);
            if (spot.feature.kind == "template")
                add(with_better_feature,
                    Text("spot {}: its template is known to {} mm only; take a longer piece with more shape",
                         spot.id, known));
            else
                add(with_better_feature,
                    Text("spot {}: its feature is known to {} mm only; teach it by a template", spot.id,
                         known));
            if (!spot.stop_at_trigger)
                add(sigma({i, false, true}),
                    Text("spot {}: the trigger jitters by up to {} mm along the displaced contour; stand "
                         "still at the trigger, or drag the jitter window to what the robot keeps",
                         spot.id, spot.jitter_mm));
        }
        if (const auto further = best_further_spot(spots_, options_)) {
            const Eigen::Vector3d p = further->spot.workobject_from_sensor.translation();
            const std::string at =
                fmt::format("{:.0f}, {:.0f}, {:.0f}", p.x() + 0.0, p.y() + 0.0, p.z() + 0.0);
            add(sigma({}, &further->spot),
                further->near.empty()
                    ? Text("add a spot towards ({}) mm of the work object, its edge along {}", at,
                           further->edge)
                    : Text("add a spot near {}, at ({}) mm of the work object, its edge along {}",
                           further->near, at, further->edge));
        }
        std::stable_sort(all.begin(), all.end(),
                         [](const Cure& a, const Cure& b) { return a.sigma_mm < b.sigma_mm; });
        return all;
    }

  private:
    static Eigen::Vector3d point(const SpotObservation& o) {
        return o.workobject_from_sensor * o.reference_mm;
    }
    const Project& project_;
    const CorrectionOptions options_;
    Spots spots_;
    const double nozzle_mm_;
    Eigen::Vector3d middle_;
};

}  // namespace

std::vector<Displacement> required_displacements(const Requirements& need, const Eigen::Vector3d& middle) {
    std::vector<Displacement> all(1);
    for (int axis = 0; axis < 3; ++axis)
        for (const double way : {-1.0, 1.0}) {
            const Eigen::Vector3d along = way * Eigen::Vector3d::Unit(axis);
            const Eigen::Matrix3d turn = rotation_exp(along * rad_from_deg(need.known_shift_deg));
            all.push_back({make_pose(turn, middle - turn * middle + along * need.known_shift_mm)});
        }
    return all;
}

Expected<RegionForecast> forecast_region(const Project& project, const Region& region) {
    Spots spots = planned_observations(project, region);
    SEAM_TRY(auto plan, plan_region(spots, planned_options(project, region)));
    RegionForecast forecast;
    forecast.plan = std::move(plan);
    forecast.wanted_mm = std::min(region.sigma_limit_mm, project.requirements.sigma3_mm / 3);
    forecast.wanted_deg = region.sigma_limit_deg;
    if (forecast.plan.status != CorrectionStatus::ok) {
        forecast.sigma_mm = forecast.sigma_deg = kInfinity;
        return forecast;
    }
    const Forecaster forecaster(project, region, spots);
    const Sigma sigma = forecaster.sigma();
    forecast.sigma_mm = sigma.mm;
    forecast.sigma_deg = sigma.deg;
    forecast.worst_spot = spots[sigma.worst].id;
    forecast.cures = forecaster.cures(sigma);
    return forecast;
}

}  // namespace seamwright
