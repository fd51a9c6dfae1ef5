#include "core/cloud/fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/cloud/coarse.h"
#include "core/cloud/fit_steps.h"
#include "core/correction/region_system.h"
#include "core/geometry/decompositions.h"
#include "core/median.h"

namespace seamwright {
namespace {

using namespace fitting;

// Of the part's size: the gate before the residuals are known, and what it does not fall below; how far off points are
// captured, from a given start, from the search and from a rival's.
constexpr double kFirstGate = 0.03, kLeastGate = 1e-4;
constexpr double kCaptureOfStart = 0.05, kCaptureOfSearch = 0.1, kCaptureOfRival = 0.08;
// Of the gate's square: the fit by sides may be so much worse, else the triangles face inwards.
constexpr double kSidedWorse = 0.2;
// Normals that look to either side at random leave so many points less, or so much farther off.
constexpr double kNormalsMatch = 0.9, kNormalsOff = 1.5, kMedianOff = 0.1;
// Of the part's size, at its corners: a pose near by; the same rival.
constexpr double kNearPose = 0.004, kSameRival = 0.01;
// Of the points: fewer speak for nothing. Poses near by and those on a sheet's other face differ at its ends alone.
constexpr double kLeastShare = 0.004, kLeastShareNear = 0.001;
constexpr std::size_t kFew = 500;      // points that find the way
constexpr double kLeastForm_mm = 0.2;  // that a point is off anyway

struct Levels {
    Cloud fine, judges, few;
};

bool stopped(const FitOptions& options) {
    return options.cancelled && options.cancelled();
}

// How clearly the points speak against a rival.
double net(const FitRival& r) {
    return static_cast<double>(r.for_best) -
           static_cast<double>(kAgainstRival) * static_cast<double>(r.for_rival);
}

bool nearer_to_as_good(const FitRival& x, const FitRival& y) {
    return x.told_apart != y.told_apart ? y.told_apart : net(x) < net(y);
}

// Mean squared distance, at most the gate's: 0 perfect, 1 nothing of it near.
double badness(const Cloud& judges, const Surface& surface, const Pose& pose, double gate_mm, bool facing) {
    double sum = 0;
    for (const double d : distances(judges, surface, pose, gate_mm, facing)) sum += d * d;
    return sum / (gate_mm * gate_mm * static_cast<double>(judges.size()));
}

struct Contender {
    Pose pose;
    bool other_face = false;
    double form_mm = std::numeric_limits<double>::infinity();  // the part's as it would have it, where known
};

class Fit {
  public:
    Fit(const Cloud& cloud, const Surface& surface, const FitOptions& options)
        : surface_(surface), options_(options), size_(surface.size_mm()) {
        levels_.fine = thinned(cloud, 30000, &counts_);
        if (!levels_.fine.has_towards() && levels_.fine.has_normals()) {
            levels_.fine.towards = levels_.fine.normals;
            by_normals_ = true;
        }
        if (options.noise_mm > 0) {  // of the raw points; thinning averages it away
            const double averaged =
                std::sqrt(static_cast<double>(levels_.fine.size()) / static_cast<double>(cloud.size()));
            levels_.fine.sigma_mm.assign(levels_.fine.size(),
                                         static_cast<float>(options.noise_mm * averaged));
        }
        levels_.judges = thinned(levels_.fine, 4000);
        levels_.few = thinned(levels_.fine, kFew);
        out_.points = cloud.size();
        gate_ = kFirstGate * size_;
        floor_ = std::max(kLeastGate * size_, options.noise_mm * 3);
    }

    Expected<SurfaceFit> run() {
        SEAM_TRY(auto starts, starting_poses());
        if (!take_best(starts)) return out_;
        constexpr int kMostSteps = 4;  // from one face to the other, facing by facing
        for (int step = 0; on_the_part() && closed_directions() && sure(); ++step) {
            better_.reset();
            best_net_ = 0;
            out_.rivals.clear();
            look_for_rivals();
            if (!better_ || out_.status != FitStatus::ambiguous || step == kMostSteps) break;
            out_.reason = {};
            settle(*better_, {std::max(4 * out_.gate_mm, floor_), floor_, 60, facing_});
        }
        return out_;
    }

  private:
    bool refuse(FitStatus status, Text reason) {
        out_.status = status;
        out_.reason = std::move(reason);
        return false;
    }

    Expected<std::vector<Pose>> starting_poses() {
        if (!options_.pairs_part.empty()) {
            SEAM_TRY(auto pose, pose_of_pairs(options_.pairs_part, options_.pairs_base));
            options_.start = pose;
        }
        out_.from_start = options_.start.has_value();
        if (options_.start) {
            std::vector<Pose> starts{*options_.start};
            for (const Pose& p : rival_starts(surface_, *options_.start, options_)) starts.push_back(p);
            return starts;
        }
        Cloud seen = thinned(levels_.fine, 6000);
        if (!seen.has_normals()) estimate_normals(seen);
        if (seen.has_towards())
            for (std::size_t i = 0; i < seen.size(); ++i)
                if (seen.normals[i].dot(seen.towards[i]) < 0) seen.normals[i] = -seen.normals[i];
        CoarseOptions coarse;
        coarse.seed = options_.seed;
        return coarse_poses(seen, surface_, coarse);
    }

    bool take_best(const std::vector<Pose>& starts) {
        const double capture =
            options_.start ? std::max(options_.start_mm, kCaptureOfStart * size_) : kCaptureOfSearch * size_;
        const bool sided = levels_.judges.has_towards();
        double least = 0, least_sided = 0;
        Pose best = Pose::Identity(), best_sided = Pose::Identity();
        for (const Pose& start : starts) {
            if (stopped(options_)) return refuse(FitStatus::cancelled, "cancelled");
            for (int with_side = 0; with_side < (sided ? 2 : 1); ++with_side) {
                const Refined r = refine(levels_.few, surface_, start, {capture, floor_, 40, with_side != 0});
                if (r.system.matched < 6 || !within_start(r.base_from_part, surface_, options_)) continue;
                refined_.push_back(r.base_from_part);
                const double plain = badness(levels_.few, surface_, r.base_from_part, gate_, false);
                if (refined_.size() == 1 || plain < least) least = plain, best = r.base_from_part;
                if (!sided) continue;
                const double seen = badness(levels_.few, surface_, r.base_from_part, gate_, true);
                if (refined_.size() == 1 || seen < least_sided)
                    least_sided = seen, best_sided = r.base_from_part;
            }
        }
        if (refined_.empty())
            return refuse(FitStatus::no_fit, options_.start
                                                 ? Text("from its start the scan finds no place on the part")
                                                 : Text("the scan finds no place on the part"));
        // A mesh whose triangles face inwards has no side that a sensor could have seen.
        facing_ = sided && least_sided < least + kSidedWorse;
        Refined r =
            refine(levels_.judges, surface_, facing_ ? best_sided : best, {gate_, floor_, 60, facing_});
        if (facing_ && by_normals_) {
            Refined plain = refine(levels_.judges, surface_, best, {gate_, floor_, 60, false});
            facing_ = static_cast<double>(r.system.matched) >
                          kNormalsMatch * static_cast<double>(plain.system.matched) &&
                      r.system.median_mm < kNormalsOff * plain.system.median_mm + kMedianOff * floor_;
            if (!facing_) r = std::move(plain);
        }
        settle(r.base_from_part, {std::max(4 * r.gate_mm, floor_), floor_, 60, facing_});
        return true;
    }

    void settle(const Pose& near, const RefineOptions& options) {
        settled_ = refine(levels_.fine, surface_, near, options);
        rigid_ = out_.base_from_part = settled_.base_from_part;
        out_.gate_mm = settled_.gate_mm;
    }

    // By points, not by area: the table around a small part is large.
    double share_on_part() const {
        constexpr std::size_t kAsked = 4000;
        std::vector<std::size_t> asked;
        const std::size_t stride = 1 + (levels_.fine.size() - 1) / kAsked;
        for (std::size_t i = 0; i < levels_.fine.size(); i += stride) asked.push_back(i);
        const std::vector<double> off =
            distances(picked(levels_.fine, asked), surface_, out_.base_from_part, 2 * out_.gate_mm, facing_);
        double near = 0, all = 0;
        for (std::size_t k = 0; k < asked.size(); ++k) {
            all += counts_[asked[k]];
            near += off[k] < out_.gate_mm ? counts_[asked[k]] : 0;
        }
        return near / all;
    }

    bool on_the_part() {
        out_.share_on_part = share_on_part();
        out_.points_used = settled_.system.matched;
        if (!within_start(out_.base_from_part, surface_, options_))
            return refuse(FitStatus::no_fit,
                          Text("the fit left its start by more than {:g} mm or {:g} degrees",
                               options_.start_mm, options_.start_deg));
        const double limit = options_.form_limit_mm > 0 ? options_.form_limit_mm : kFormLimit * size_;
        if (!(settled_.system.median_mm <= limit))
            return refuse(FitStatus::no_fit, Text("half of the points lie more than {:.2f} mm off the part",
                                                  settled_.system.median_mm));
        if (out_.share_on_part < options_.share_needed || settled_.system.matched < 30)
            return refuse(FitStatus::no_fit,
                          Text("only {:.0f} % of the scan lie on the part", 100 * out_.share_on_part));
        return true;
    }

    // xi of correction's naming, in the part's frame: motions (a, w spread) as columns.
    std::vector<Text> named(const Eigen::MatrixXd& motions) const {
        Eigen::MatrixXd in_part(6, motions.cols());
        const Eigen::Matrix3d part_from_base = out_.base_from_part.linear().transpose();
        in_part.topRows(3) = part_from_base * motions.topRows(3);
        in_part.bottomRows(3) = part_from_base * motions.bottomRows(3);
        return correction::name_directions(in_part, out_.base_from_part.inverse() * settled_.system.middle,
                                           settled_.system.spread_mm);
    }

    bool open(const Eigen::MatrixXd& motions) {
        out_.unobservable = named(motions);
        Text list;
        for (const Text& word : out_.unobservable) list = joined(list, ", ", word);
        return refuse(FitStatus::under_determined, Text("the surface that was seen leaves open: {}", list));
    }

    bool closed_directions() {
        const SymmetricEigen e = symmetric_eigen(settled_.system.information / settled_.system.weight);
        Eigen::Index loose = 0;
        while (loose < 6 && e.values[loose] < kOpenShare) ++loose;
        return loose == 0 || open(e.vectors.leftCols(loose));
    }

    bool sure() {
        if (stopped(options_)) return refuse(FitStatus::cancelled, "cancelled");
        const Stated own = stated(levels_.fine, surface_, settled_, facing_);
        scatter_mm_ = own.scatter_mm;
        // Of a raw point: thinning averaged over so many.
        const double averaged =
            std::sqrt(static_cast<double>(out_.points) / static_cast<double>(levels_.fine.size()));
        out_.noise_mm = options_.noise_mm > 0 ? options_.noise_mm : scatter_mm_ * averaged;
        if (!own.reason.empty()) return refuse(FitStatus::no_fit, own.reason);
        out_.base_from_part = own.base_from_part;
        out_.covariance = own.covariance;
        out_.covariance_noise = own.covariance_noise;
        out_.form_mm = own.form_mm;
        out_.form_length_mm = own.form_length_mm;
        const SymmetricEigen e = symmetric_eigen(own.motion_covariance);
        Eigen::Index vague = 0;
        while (vague < 6 && 3 * std::sqrt(std::max(0.0, e.values[5 - vague])) > options_.sigma_limit_mm)
            ++vague;
        return vague == 0 || open(e.vectors.rightCols(vague));
    }

    Refined by_few(const Pose& pose) const {
        return refine(levels_.few, surface_, pose, {gate_, floor_, 40, facing_});
    }
    Refined by_judges(const Pose& pose) const {
        return refine(levels_.judges, surface_, pose,
                      {std::max(4 * out_.gate_mm, floor_), floor_, 60, facing_});
    }

    Refined by_all(const Pose& pose) const {
        return refine(levels_.fine, surface_, pose,
                      {std::max(4 * out_.gate_mm, floor_), floor_, 60, facing_});
    }

    static bool beyond(const Matrix6& covariance, const Pose& pose, const Pose& found) {
        if (angle_rad(pose, found) > 1) return true;
        const Vector6 d = difference(pose, found);
        return d.dot(solve_symmetric(covariance, d).col(0)) > kNoOtherPlace;
    }
    bool beyond_the_stated(const Pose& pose, const Pose& found) const {
        return beyond(out_.covariance, pose, found);
    }

    // Rivals are refined without a bend, so it is the rigid fit that they are compared with; near by, the same points
    // find the same place. A pose that has not settled lies off the part and would count as told apart.
    bool elsewhere(Contender& rival) {
        Pose& pose = rival.pose;
        if (rival.other_face) return on_another_face(rival);
        if (!near_by(pose)) return beyond_the_stated(pose, out_.base_from_part);
        if (!beyond_the_stated(pose, few_)) return false;
        pose = by_judges(pose).base_from_part;
        if (!beyond_the_stated(pose, judged_)) return false;
        pose = by_all(pose).base_from_part;
        return beyond_the_stated(pose, rigid_) && !known(pose, ended_);
    }
    // On the wrong face of a curved sheet the misfit passes for a deviation of form, and the region that is stated with
    // it holds the right face too: each of the two is asked whether the other lies in what it would state.
    bool on_another_face(Contender& rival) {
        const Refined there = by_all(by_judges(rival.pose).base_from_part);
        rival.pose = there.base_from_part;
        if (corner_distance_mm(surface_, rival.pose, rigid_) < kSettled_mm || known(rival.pose, ended_))
            return false;
        const Stated own = stated(levels_.fine, surface_, there, facing_);
        if (own.reason.empty()) rival.form_mm = own.form_mm;
        return beyond_the_stated(rival.pose, rigid_) ||
               (own.reason.empty() && (beyond_the_stated(own.base_from_part, out_.base_from_part) ||
                                       beyond(own.covariance, out_.base_from_part, own.base_from_part)));
    }
    // Many starts end at one place.
    bool known(const Pose& pose, std::vector<Pose>& poses) const {
        for (const Pose& other : poses)
            if (corner_distance_mm(surface_, pose, other) < kSettled_mm) return true;
        poses.push_back(pose);
        return false;
    }
    bool near_by(const Pose& pose) const {
        const double near = std::max(kNearPose * size_, 5 * (out_.noise_mm + out_.form_mm));
        return corner_distance_mm(surface_, pose, rigid_) <= near;
    }

    // Few points find the way; that the place is the face's own and not one between the two, only many say.
    std::optional<Pose> on_other_face(const Cloud& seen, std::vector<Pose>& begun) const {
        std::vector<std::size_t> every;
        for (std::size_t i = 0; i < seen.size(); i += 1 + seen.size() / kFew) every.push_back(i);
        const double capture = std::max(gate_, kCaptureOfRival * size_);
        const Pose there =
            refine(picked(seen, every), surface_, rigid_, {capture, floor_, 40, true}).base_from_part;
        if (known(there, begun)) return std::nullopt;
        const double small = std::max(4 * out_.gate_mm, floor_);
        return refine(seen, surface_, there, {small, floor_, 60, true}).base_from_part;
    }

    void look_for_rivals() {
        out_.status = FitStatus::ok;
        few_ = by_few(rigid_).base_from_part;
        ended_.clear();
        judged_ = by_judges(rigid_).base_from_part;
        std::vector<Contender> candidates;
        std::vector<Pose> begun{few_};
        if (!facing_)
            for (const Cloud& seen : on_other_faces(levels_.judges, surface_, rigid_, out_.gate_mm)) {
                if (stopped(options_)) {
                    refuse(FitStatus::cancelled, "cancelled");
                    return;
                }
                if (const auto pose = on_other_face(seen, begun)) candidates.push_back({*pose, true});
            }
        begun = {few_};
        for (const Pose& pose : refined_) candidates.push_back({by_few(pose).base_from_part});
        for (const Pose& start : rival_starts(surface_, out_.base_from_part, options_)) {
            if (stopped(options_)) {
                refuse(FitStatus::cancelled, "cancelled");
                return;
            }
            // A symmetry of the part is a rival as it stands; a refinement from it may end elsewhere.
            if (angle_rad(start, out_.base_from_part) > 1) candidates.push_back({start});
            candidates.push_back({refine(levels_.few, surface_, start,
                                         {std::max(gate_, kCaptureOfRival * size_), floor_, 40, facing_})
                                      .base_from_part});
        }
        // What a point is off anyway.
        const double form = std::max({kLeastForm_mm, 3 * out_.form_mm, 3 * local_judges_mm()});
        for (Contender& candidate : candidates) {
            if (!candidate.other_face && known(candidate.pose, begun)) continue;
            if (!elsewhere(candidate) || !within_start(candidate.pose, surface_, options_)) continue;
            // Of several that ended near one another the one that is nearest to being as good.
            FitRival rival = compared(candidate, form);
            rival.other_face = candidate.other_face;
            const auto same = std::find_if(out_.rivals.begin(), out_.rivals.end(), [&](const FitRival& r) {
                return corner_distance_mm(surface_, r.base_from_part, candidate.pose) < kSameRival * size_;
            });
            if (same == out_.rivals.end())
                out_.rivals.push_back(rival);
            else if (nearer_to_as_good(rival, *same))
                *same = rival;
        }
        std::stable_sort(out_.rivals.begin(), out_.rivals.end(), nearer_to_as_good);
        if (out_.rivals.size() > 5) out_.rivals.resize(5);
        if (out_.rivals.empty() || out_.rivals.front().told_apart) return;
        const FitRival& r = out_.rivals.front();
        const double away_mm = corner_distance_mm(surface_, r.base_from_part, out_.base_from_part);
        refuse(
            FitStatus::ambiguous,
            r.other_face
                ? Text(
                      "the part lies as well on the other face of its sheet, {:.1f} mm away: {} points speak "
                      "for the one place, {} for the other; a scan that shows both faces or where the sheet "
                      "ends, or that says where it was seen from (towards_x, towards_y, towards_z), decides",
                      away_mm, r.for_best, r.for_rival)
                : Text("the part lies as well {:.1f} mm and {:.1f} degrees away: {} points speak for the one "
                       "place, {} for the other",
                       away_mm, deg_from_rad(angle_rad(r.base_from_part, out_.base_from_part)), r.for_best,
                       r.for_rival));
    }

    // Of sheets the rival may turn out to be the better one.
    FitRival compared(const Contender& contender, double form) {
        const Pose& pose = contender.pose;
        if (!contender.other_face && !near_by(pose))
            return compare(levels_.judges, surface_, rigid_, pose, form, std::max(out_.gate_mm, 6 * form),
                           kLeastShare, facing_);
        // Two faces are off alike by what the whole part is off anyway; of a small step a point says on which side it lies.
        // What the part is off is what the face says on which it is less.
        form = std::min(3 * std::max(std::min(out_.form_mm, contender.form_mm), scatter_mm_),
                        corner_distance_mm(surface_, pose, rigid_) / 2);
        bool better = false;
        const FitRival rival = facing_
                                   ? compare(levels_.fine, surface_, rigid_, pose, form,
                                             std::max(out_.gate_mm, 6 * form), kLeastShareNear, true, &better)
                                   : compare_of_sheet(levels_.fine, surface_, rigid_, pose, form, better);
        if (better && net(rival) < best_net_) better_ = pose, best_net_ = net(rival);
        return rival;
    }

    // Of one judge: the points' noise as far as thinning left it.
    double local_judges_mm() const {
        const double scatter =
            local_noise_mm(residuals_of(levels_.judges, surface_, rigid_, out_.gate_mm, facing_));
        return std::isfinite(scatter) ? scatter : 0;
    }

    const Surface& surface_;
    FitOptions options_;
    double size_ = 0, gate_ = 0, floor_ = 0;
    bool facing_ = false, by_normals_ = false;
    Levels levels_;
    std::vector<std::uint32_t> counts_;  // of the scan's points in each of levels_.fine
    Refined settled_;
    Pose rigid_ = Pose::Identity();                            // before the form's model moved it
    Pose few_ = Pose::Identity(), judged_ = Pose::Identity();  // the same place as fewer points have it
    double scatter_mm_ = 0;                                    // of a point of the fine level
    std::vector<Pose> refined_;
    std::vector<Pose> ended_;     // where rivals ended
    std::optional<Pose> better_;  // a rival that the points speak for, the most clearly
    double best_net_ = 0;
    SurfaceFit out_;
};

}  // namespace

const char* to_string(FitStatus status) {
    switch (status) {
        case FitStatus::ok:
            return "ok";
        case FitStatus::ambiguous:
            return "ambiguous";
        case FitStatus::under_determined:
            return "under_determined";
        case FitStatus::no_fit:
            return "no_fit";
        case FitStatus::cancelled:
            return "cancelled";
    }
    return "";
}

Expected<void> check_fit_input(const Cloud& cloud, const Surface& surface, const FitOptions& options) {
    if (cloud.size() < 50)
        return input_error(Text("the scan has {} points, too few to be fitted", cloud.size()), {},
                           "scan more of the part: at least 50 points");
    constexpr double kFarthest_mm = 1e6;
    for (const auto& p : cloud.points)
        if (!p.allFinite() || p.cwiseAbs().maxCoeff() > kFarthest_mm)
            return input_error("the scan has a point that is not finite or beyond 1 km", {},
                               "give millimetres");
    if (surface.empty()) return input_error("the part has no surface");
    if (!(options.noise_mm >= 0) || !(options.start_mm > 0) || !(options.start_deg > 0))
        return input_error("noise and tolerance of the start must be positive");
    return {};
}

Expected<SurfaceFit> fit_surface(const Cloud& cloud, const Surface& surface, const FitOptions& options) {
    SEAM_OK(check_fit_input(cloud, surface, options));
    return Fit(cloud, surface, options).run();
}

}  // namespace seamwright
