#include "core/cloud/fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <unordered_map>

#include "core/cloud/coarse.h"
#include "core/cloud/fit_steps.h"
#include "core/correction/region_system.h"
#include "core/geometry/decompositions.h"
#include "core/median.h"

namespace seamwright {
namespace fitting {
namespace {

// 0..5: the axis that a normal follows most, and its side.
int facing_of(const Eigen::Vector3d& normal) {
    Eigen::Index axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    return static_cast<int>(2 * axis) + (normal[axis] < 0);
}

using Key = std::array<int, 4>;
Key key_of(const Residual& r, const Eigen::Vector3d& corner, double cell_mm) {
    const Eigen::Vector3d c = (r.place - corner) / cell_mm;
    return {static_cast<int>(std::floor(c.x())), static_cast<int>(std::floor(c.y())),
            static_cast<int>(std::floor(c.z())), facing_of(r.normal)};
}

std::map<Key, std::vector<std::size_t>> cells_of(const std::vector<Residual>& residuals, double cell_mm) {
    Eigen::AlignedBox3d box;
    for (const Residual& r : residuals) box.extend(r.place);
    std::map<Key, std::vector<std::size_t>> cells;
    for (std::size_t i = 0; i < residuals.size(); ++i)
        cells[key_of(residuals[i], box.min(), cell_mm)].push_back(i);
    return cells;
}

double longest(const std::vector<Residual>& residuals) {
    Eigen::AlignedBox3d box;
    for (const Residual& r : residuals) box.extend(r.place);
    constexpr double kLeastSize_mm = 1e-3;
    return box.isEmpty() ? 1 : std::max(kLeastSize_mm, box.diagonal().norm());
}

// Cells of the size at which there are about `count`.
std::map<Key, std::vector<std::size_t>> cells_about(const std::vector<Residual>& residuals,
                                                    std::size_t count) {
    constexpr double kFiner = 1.25;  // from one size of cells to the next
    double cell = longest(residuals);
    auto cells = cells_of(residuals, cell);
    for (int k = 0; k < 24; ++k) {
        auto finer = cells_of(residuals, cell / kFiner);
        if (finer.size() > count) break;
        cell /= kFiner;
        cells = std::move(finer);
    }
    return cells;
}

}  // namespace

std::vector<Residual> residuals_of(const Cloud& cloud, const Surface& surface, const Pose& base_from_part,
                                   double gate_mm, bool facing) {
    const Pose part_from_base = base_from_part.inverse();
    std::vector<Residual> out;
    out.reserve(cloud.size());
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        Eigen::Vector3d side;
        const bool known = facing && cloud.has_towards();
        if (known) side = part_from_base.linear() * cloud.towards[i].cast<double>();
        const auto near = surface.nearest(part_from_base * cloud.points[i], gate_mm, known ? &side : nullptr);
        if (!near || near->at_border) continue;
        const double sigma = cloud.has_sigma() ? static_cast<double>(cloud.sigma_mm[i]) : 0;
        out.push_back({base_from_part * near->point, base_from_part.linear() * near->normal, near->signed_mm,
                       sigma * sigma});
    }
    return out;
}

double local_noise_mm(const std::vector<Residual>& residuals) {
    std::vector<double> variances;
    for (const auto& [key, members] :
         cells_about(residuals, std::max<std::size_t>(1, residuals.size() / 8))) {
        if (members.size() < 3) continue;
        double mean = 0, squares = 0;
        for (const std::size_t i : members)
            mean += residuals[i].value_mm / static_cast<double>(members.size());
        for (const std::size_t i : members)
            squares += (residuals[i].value_mm - mean) * (residuals[i].value_mm - mean);
        variances.push_back(squares / static_cast<double>(members.size() - 1));
    }
    // The median of a variance of some eight points lies a tenth below it.
    constexpr double kMeanOfMedian = 1.1;
    return std::sqrt(kMeanOfMedian * median(variances));
}

std::vector<FormNode> form_nodes(const std::vector<Residual>& residuals, const FitSystem& system,
                                 double noise_mm) {
    constexpr double kLeastNoise_mm2 = 1e-10;
    constexpr double kNoNormal = 1e-3;  // length of a mean of normals that cancel each other
    std::vector<FormNode> nodes;
    for (const auto& [key, members] : cells_about(residuals, 180)) {
        FormNode node;
        const auto n = static_cast<double>(members.size());
        for (const std::size_t i : members) {
            const Residual& r = residuals[i];
            node.place_mm += r.place / n;
            node.normal += r.normal / n;
            node.residual_mm += r.value_mm / n;
            node.noise_mm2 += (r.noise_mm2 > 0 ? r.noise_mm2 : noise_mm * noise_mm) / (n * n);
            Vector6 row;
            row << r.normal, (r.place - system.middle).cross(r.normal) / system.spread_mm;
            node.row += row / n;
        }
        node.noise_mm2 = std::max(node.noise_mm2, kLeastNoise_mm2);
        const double length = node.normal.norm();
        if (length < kNoNormal) continue;
        node.normal /= length;
        nodes.push_back(node);
    }
    return nodes;
}

}  // namespace fitting

namespace {

using namespace fitting;

// Of the part's size: the gate before the residuals are known, and what it does not fall below; how far off points are
// captured, from a given start, from the search and from a rival's.
constexpr double kFirstGate = 0.03, kLeastGate = 1e-4;
constexpr double kCaptureOfStart = 0.05, kCaptureOfSearch = 0.1, kCaptureOfRival = 0.08;
// Of the gate's square: the fit by sides may be so much worse, else the triangles face inwards.
constexpr double kSidedWorse = 0.2;
constexpr double kSettled_mm = 0.1;  // a motion by the form's model that is not repeated
// Of the part's size, at its corners: the same pose; the same rival.
constexpr double kSamePose = 0.004, kSameRival = 0.01;
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

// Mean squared distance, at most the gate's: 0 perfect, 1 nothing of it near.
double badness(const Cloud& judges, const Surface& surface, const Pose& pose, double gate_mm, bool facing) {
    double sum = 0;
    for (const double d : distances(judges, surface, pose, gate_mm, facing)) sum += d * d;
    return sum / (gate_mm * gate_mm * static_cast<double>(judges.size()));
}

class Fit {
  public:
    Fit(const Cloud& cloud, const Surface& surface, const FitOptions& options)
        : surface_(surface), options_(options), size_(surface.size_mm()) {
        levels_.fine = thinned(cloud, 30000);
        if (options.noise_mm > 0) {  // of the raw points; thinning averages it away
            const double averaged =
                std::sqrt(static_cast<double>(levels_.fine.size()) / static_cast<double>(cloud.size()));
            levels_.fine.sigma_mm.assign(levels_.fine.size(),
                                         static_cast<float>(options.noise_mm * averaged));
        }
        levels_.judges = thinned(levels_.fine, 4000);
        levels_.few = thinned(levels_.fine, 500);
        out_.points = cloud.size();
        gate_ = kFirstGate * size_;
        floor_ = std::max(kLeastGate * size_, options.noise_mm * 3);
    }

    Expected<SurfaceFit> run() {
        SEAM_TRY(auto starts, starting_poses());
        if (!take_best(starts) || !on_the_part() || !closed_directions() || !sure()) return out_;
        look_for_rivals();
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
        r = refine(levels_.fine, surface_, r.base_from_part,
                   {std::max(4 * r.gate_mm, floor_), floor_, 60, facing_});
        system_ = r.system;
        rigid_ = out_.base_from_part = r.base_from_part;
        out_.gate_mm = r.gate_mm;
        return true;
    }

    bool on_the_part() {
        std::size_t near = 0;
        for (const double d :
             distances(levels_.judges, surface_, out_.base_from_part, 2 * out_.gate_mm, facing_))
            near += d < out_.gate_mm;
        out_.share_on_part = static_cast<double>(near) / static_cast<double>(levels_.judges.size());
        out_.points_used = system_.matched;
        if (!within_start(out_.base_from_part, surface_, options_))
            return refuse(FitStatus::no_fit,
                          Text("the fit left its start by more than {:g} mm or {:g} degrees",
                               options_.start_mm, options_.start_deg));
        const double limit = options_.form_limit_mm > 0 ? options_.form_limit_mm : kFormLimit * size_;
        if (!(system_.median_mm <= limit))
            return refuse(FitStatus::no_fit,
                          Text("half of the points lie more than {:.2f} mm off the part", system_.median_mm));
        if (out_.share_on_part < options_.share_needed || system_.matched < 30)
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
        return correction::name_directions(in_part, out_.base_from_part.inverse() * system_.middle,
                                           system_.spread_mm);
    }

    bool open(const Eigen::MatrixXd& motions) {
        out_.unobservable = named(motions);
        Text list;
        for (const Text& word : out_.unobservable) list = joined(list, ", ", word);
        return refuse(FitStatus::under_determined, Text("the surface that was seen leaves open: {}", list));
    }

    bool closed_directions() {
        const SymmetricEigen e = symmetric_eigen(system_.information / system_.weight);
        Eigen::Index loose = 0;
        while (loose < 6 && e.values[loose] < kOpenShare) ++loose;
        return loose == 0 || open(e.vectors.leftCols(loose));
    }

    bool sure() {
        // The points that lie on the part as the rigid fit has it: with a bent part its own place leaves them off it.
        const Cloud seen = within_gate(levels_.fine);
        double moved_mm = 0;
        for (int round = 0; round < 2; ++round) {
            if (stopped(options_)) return refuse(FitStatus::cancelled, "cancelled");
            const auto residuals =
                residuals_of(seen, surface_, out_.base_from_part, out_.gate_mm + moved_mm, facing_);
            const double scatter = local_noise_mm(residuals);
            // Of a raw point: thinning averaged over so many.
            const double averaged =
                std::sqrt(static_cast<double>(out_.points) / static_cast<double>(levels_.fine.size()));
            out_.noise_mm = options_.noise_mm > 0 ? options_.noise_mm : scatter * averaged;
            if (!std::isfinite(scatter))
                return refuse(FitStatus::no_fit, "the scan is too thin to tell its noise");
            const FormSolution s =
                solve_with_form(form_nodes(residuals, system_, scatter),
                                plate_axes(surface_, out_.base_from_part), system_.middle, system_.spread_mm);
            if (!s.solved) return refuse(FitStatus::no_fit, "the scan covers too few places of the part");
            const Matrix6 to_tangent =
                tangent_of_motion(out_.base_from_part, system_.middle, system_.spread_mm);
            motion_covariance_ = s.covariance;
            out_.covariance = to_tangent * s.covariance * to_tangent.transpose();
            Matrix6 information = Matrix6::Zero();
            for (const Residual& r : residuals) {
                Vector6 row;
                row << r.normal, (r.place - system_.middle).cross(r.normal) / system_.spread_mm;
                information += row * row.transpose() / (r.noise_mm2 > 0 ? r.noise_mm2 : scatter * scatter);
            }
            out_.covariance_noise = to_tangent * inverse_matrix(information) * to_tangent.transpose();
            out_.form_mm = s.form_mm;
            out_.form_length_mm = s.length_mm;
            out_.base_from_part = retract(out_.base_from_part, to_tangent * s.motion);
            if (s.motion.norm() < kSettled_mm) break;
            moved_mm +=
                4 * s.motion.norm();  // a rotation's entry is that at the spread; points lie farther out
        }
        const SymmetricEigen e = symmetric_eigen(motion_covariance_);
        Eigen::Index vague = 0;
        while (vague < 6 && 3 * std::sqrt(std::max(0.0, e.values[5 - vague])) > options_.sigma_limit_mm)
            ++vague;
        return vague == 0 || open(e.vectors.rightCols(vague));
    }

    Cloud within_gate(const Cloud& cloud) const {
        const std::vector<double> off =
            distances(cloud, surface_, out_.base_from_part, 2 * out_.gate_mm, facing_);
        std::vector<std::size_t> kept;
        for (std::size_t i = 0; i < cloud.size(); ++i)
            if (off[i] <= out_.gate_mm) kept.push_back(i);
        return picked(cloud, kept);
    }

    // Rivals are refined without a bend, so it is the rigid fit that they are compared with.
    bool elsewhere(const Pose& pose) const {
        const double near = std::max(kSamePose * size_, 5 * (out_.noise_mm + out_.form_mm));
        if (corner_distance_mm(surface_, pose, rigid_) <= near) return false;
        if (angle_rad(pose, out_.base_from_part) > 1) return true;
        const Vector6 d = difference(pose, out_.base_from_part);
        return d.dot(solve_symmetric(out_.covariance, d).col(0)) > kNoOtherPlace;
    }

    void look_for_rivals() {
        out_.status = FitStatus::ok;
        std::vector<Pose> candidates;
        for (const Pose& pose : refined_)
            candidates.push_back(
                refine(levels_.few, surface_, pose, {gate_, floor_, 40, facing_}).base_from_part);
        for (const Pose& start : rival_starts(surface_, out_.base_from_part, options_)) {
            if (stopped(options_)) {
                refuse(FitStatus::cancelled, "cancelled");
                return;
            }
            // A symmetry of the part is a rival as it stands; a refinement from it may end elsewhere.
            if (angle_rad(start, out_.base_from_part) > 1) candidates.push_back(start);
            candidates.push_back(refine(levels_.few, surface_, start,
                                        {std::max(gate_, kCaptureOfRival * size_), floor_, 40, facing_})
                                     .base_from_part);
        }
        // What a point is off anyway.
        const double form = std::max({kLeastForm_mm, 3 * out_.form_mm, 3 * local_judges_mm()});
        const double most = std::max(out_.gate_mm, 6 * form);
        for (const Pose& pose : candidates) {
            if (!elsewhere(pose) || !within_start(pose, surface_, options_)) continue;
            // Of several that ended near one another the one that is nearest to being as good.
            FitRival rival = compare(levels_.judges, surface_, rigid_, pose, form, most, facing_);
            const auto known = std::find_if(out_.rivals.begin(), out_.rivals.end(), [&](const FitRival& r) {
                return corner_distance_mm(surface_, r.base_from_part, pose) < kSameRival * size_;
            });
            if (known == out_.rivals.end())
                out_.rivals.push_back(rival);
            else if (net(rival) < net(*known))
                *known = rival;
        }
        std::stable_sort(out_.rivals.begin(), out_.rivals.end(),
                         [](const FitRival& x, const FitRival& y) { return net(x) < net(y); });
        if (out_.rivals.size() > 5) out_.rivals.resize(5);
        if (out_.rivals.empty() || out_.rivals.front().told_apart) return;
        const FitRival& r = out_.rivals.front();
        refuse(FitStatus::ambiguous,
               Text("the part lies as well {:.1f} mm and {:.1f} degrees away: {} points speak for the one "
                    "place, {} for the other",
                    corner_distance_mm(surface_, r.base_from_part, out_.base_from_part),
                    deg_from_rad(angle_rad(r.base_from_part, out_.base_from_part)), r.for_best, r.for_rival));
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
    bool facing_ = false;
    Levels levels_;
    FitSystem system_;
    Matrix6 motion_covariance_ = Matrix6::Zero();
    Pose rigid_ = Pose::Identity();  // before the form's model moved it
    std::vector<Pose> refined_;
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
