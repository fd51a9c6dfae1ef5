#pragma once
// The inside of the ContourMatcher, shared by the sources that make it up: the finish
// (registration_finish.cpp), what speaks for and against a pose (registration_support.cpp), the verdict
// (registration_verdict.cpp), and the order of things (registration.cpp).
//
// Twists and rows are in the template's frame: shift along x, shift along z (mm), turn about the template's
// centroid (rad).

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "core/features/contour/contour_model.h"
#include "core/features/registration/registration.h"
#include "core/features/registration/registration_search.h"

namespace seamwright {

inline constexpr int kFewestRegistrationPoints = 5;
// Slopes below this (rms, radian) say nothing about where along the contour we are.
inline constexpr double kStraight_rad = 2e-3;
// Twice the logarithm of a likelihood ratio that tells two places.
inline constexpr double kTelling = 12;

// Row of the Jacobian of the residual, and of the motion along the curve there.
struct RegistrationRow {
    Eigen::Vector3d across, along;
};
inline RegistrationRow registration_row(const ContourModel::Edge& edge, double u) {
    const double bend = edge.curvature * u;
    const double norm = 1 / std::sqrt(1 + bend * bend);
    const double tx = (edge.tx - bend * edge.tz) * norm, tz = (edge.tz + bend * edge.tx) * norm;
    const double qx = edge.cx + u * edge.tx, qz = edge.cz + u * edge.tz;
    // normal (-tz, tx); turning moves the curve's point q by (-qz, qx) per radian.
    return {{tz, -tx, -(tz * qz + tx * qx)}, {-tx, -tz, -(-tx * qz + tz * qx)}};
}

struct ContourMatcher::Impl {
    Profile contour;  // as given to make()
    ContourModel model;
    RegistrationSearch search;
    Eigen::Vector2d reference = Eigen::Vector2d::Zero();
    std::vector<double> arc;  // [edges] length before the edge
    std::vector<JumpEnd> jumps;

    // The template's three directions, from the least determined one on; each moves its farthest parts by
    // about a millimetre per unit. `information` of a direction is what the template's points tell about it,
    // in points' worth, its noise taken off: of a straight line nothing is left for the motion along it.
    struct Direction {
        Eigen::Vector3d twist = Eigen::Vector3d::Zero();
        double information = 0;
        bool determined = false;
    };
    std::array<Direction, 3> directions;
    double fit_variance = 0;   // of the template's curve, in parts of one point's
    double weakest_share = 1;  // information of the least beside that of the best determined one
    // The contour in bins of about half a pitch, then one for each jump.
    int bins = 1;
    std::vector<std::array<float, 3>> bin_information;  // [bins + jumps]
    std::vector<float> bin_across;                      // [bins] |tangent along x|
    std::vector<double>
        slope_doubt;  // [edges] variance of the curve's slope by the template's noise; 0 of a wall

    // Buffers that live as long as the matcher: after the first calls nothing is allocated.
    struct Match {
        int scene = 0;
        ContourModel::Foot foot;
        double weight = 1;  // in the finish
    };
    // The same jump in template and scene: says where along the upper surface we are, within a pitch of each.
    struct JumpMatch {
        int jump;
        Eigen::Vector3d row;
        double residual, variance;
    };
    struct Finish {
        CentredPose pose;
        double gate = 0;  // final
        double sigma = 0;
        double cost = 0;  // once rated
    };
    // What speaks for a pose.
    struct Support {
        CentredPose pose;
        double gate = 0, sigma = 0;
        double share = 0;                         // of the template's length that has a partner
        std::array<double, 3> informed{1, 1, 1};  // of each direction's information, on what has a partner
        // Sum over the template's points, as dense as the scene's, of (residual / sigma)^2, at most kMissing
        // each: minus twice the logarithm of the likelihood, up to a constant. `missing` is the part of those
        // without a partner.
        double cost = 0, missing = 0;
        // The same of the scene's points near the template, less its expectation for points that lie on it:
        // what is missing takes no part.
        double contradicted = 0;
        int on = 0, off = 0;  // scene points near the template that lie on it, that do not
        double least_informed() const { return *std::min_element(informed.begin(), informed.end()); }
    };
    mutable RegistrationSearch finder;
    mutable SceneContour scene;
    mutable std::vector<SearchCandidate> candidates, along;
    mutable std::vector<Finish> finishes;
    mutable std::vector<Match> matches;
    mutable std::vector<JumpMatch> jump_matches;
    mutable std::vector<int> wall_hits;                        // [edges]
    mutable std::vector<std::pair<double, double>> wall_seen;  // [edges] lowest and highest u that is met
    mutable std::vector<Eigen::Vector3d> wall_gradient;        // [edges]
    struct Crossed {
        Eigen::Vector3d of_template, of_scene, along;
        double scene_doubt;
        int count;
    };
    mutable std::vector<Crossed> crossed;  // [matches]
    mutable std::vector<double> sizes;
    mutable std::vector<float> bin_residual2;  // [bins] negative: no partner
    mutable std::vector<char> seen_x;          // whether the scene has a point in the cell along x
    mutable std::vector<std::array<Eigen::Vector3d, 3>> influence;
    mutable int iterations = 0;

    double noise_mm() const { return std::hypot(model.sigma_mm(), scene.sigma_mm); }
    // Noise larger than this hides any shape of the template's size.
    double smallest_gate() const { return std::min(4 * noise_mm(), std::max(0.06 * model.extent_mm(), 0.1)); }
    // A gate beyond the noise lets a shape pass that is a little another one.
    double largest_final_gate() const {
        return std::max(smallest_gate(), std::min(std::max(0.25, 1.5 * smallest_gate()),
                                                  std::max(0.02 * model.extent_mm(), 0.1)));
    }
    // A flank so steep that neighbours on it lie far apart: its points are on it, so its place is known.
    bool sampled_wall(std::size_t edge) const {
        const auto& e = model.edges()[edge];
        for (const int other : {e.previous, e.next})
            if (other >= 0 && model.edges()[other].wall &&
                std::abs(e.tx * model.edges()[other].tx + e.tz * model.edges()[other].tz) > 0.98)
                return true;
        return false;
    }
    // Greatest distance between the two poses of a point of the template's box.
    double apart_mm(const CentredPose& a, const CentredPose& b) const {
        double most = 0;
        for (const double x : {model.lower().x(), model.upper().x()})
            for (const double z : {model.lower().y(), model.upper().y()})
                most = std::max(most, (a * Eigen::Vector2d(x, z) - b * Eigen::Vector2d(x, z)).norm());
        return most;
    }

    void learn_directions();
    void collect(const CentredPose& pose, double gate, int stride) const;
    void drop_sparse_walls() const;
    void collect_jumps(const CentredPose& pose, double gate) const;
    // An end of the template and one of the scene at a pose: how far the scene's lies outwards of it and across that, up to
    // which distance outwards the two may be one, and what their distance outwards tells, without the points' noise.
    struct MetEnd {
        double outside, across, reach;
        Eigen::Vector3d row;
        double variance;
    };
    std::optional<MetEnd> met_edge(const JumpEnd& t, const JumpEnd& s, const CentredPose& pose) const;
    std::optional<MetEnd> met_outline(const SheetOutline& t, const SheetOutline& s,
                                      const CentredPose& pose) const;
    // One step of the finish: what the points ask for and what the ends ask for.
    struct Linearised {
        Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero(), ends_hessian = Eigen::Matrix3d::Zero();
        Eigen::Vector3d gradient = Eigen::Vector3d::Zero(), ends_gradient = Eigen::Vector3d::Zero();
        double weight_sum = 0;
    };
    Eigen::Vector3d solved(const Linearised& normal) const;
    // Whether what `matches` seem to know of a motion along the twist may be waves of the template's noise.
    bool waves_alone(const Eigen::Vector3d& twist, double seen, double weight_sum) const;
    Finish finish(const CentredPose& start, double gate, int stride, int most_iterations) const;
    Support support(const Finish& finish, double sigma, int stride) const;
    // What the scene's points say about a motion along the twist within a search step: held where they speak
    // against it to either side; the likeliest shift (in units of the twist) and its variance.
    struct Held {
        bool held = false;
        double shift = 0, variance = 0;
    };
    // Registration::replaced_share at the pose.
    double replaced(const Finish& finish, double sigma) const;
    // `telling`: by how much the cost must exceed that of the likeliest place.
    Held held(const Finish& finish, const Support& here, double sigma, const Eigen::Vector3d& twist,
              double telling) const;
    // Whether the scene goes on smoothly where the template has a step or a bend: a parabola explains the matched points
    // better than the template does, whose own form stands out of its noise. What holds a place was then not seen there,
    // however well flats lie on flats. Of `matches`, collected at `pose`.
    bool smooth_instead(const CentredPose& pose) const;
    Held held_by_ends(const Eigen::Vector3d& twist) const;
    void follow(Finish& finish, Support& support, double sigma) const;
    // By how much the cost of the second must exceed that of the first to be told from it.
    static double telling_difference(const Support& first);
    // Noise across the contour of `matches` as a function of its inclination: variance = level + slope * nz^2. A
    // triangulation sensor is noisy in z at given x, so a steep flank is quieter across than a flat; a drawn
    // contour may be noisy alike in all directions, and one resampled from places that are known less well than
    // heights is quieter on the flat. Level and slope come from a regression of the squared residuals.
    struct AcrossNoise {
        double mean_square = 0, level = 0, slope = 0;
        // Relative to the mean; the template, recorded with the same kind of sensor, is taken to behave alike.
        double relative(const ContourModel::Edge& edge) const {
            constexpr double kLeast = 0.02;
            return mean_square > 0 ? std::max((level + slope * edge.tx * edge.tx) / mean_square, kLeast)
                                   : 1.0;
        }
    };
    AcrossNoise across_noise() const;
    // Of the linearisation about a pose: what the matches know, how much of it the template's own noise only seems to
    // fix, and the covariance of the gradient.
    struct NormalEquations {
        Eigen::Matrix3d information = Eigen::Matrix3d::Zero(), tilt = Eigen::Matrix3d::Zero(),
                        gradient = Eigen::Matrix3d::Zero();
    };
    NormalEquations normal_equations(const AcrossNoise& noise, const Finish& finish, double gate) const;
    void add_template_noise(NormalEquations& normal) const;  // from `influence`
    // Neighbours whose noise is alike tell less than as many points by themselves: by how much the variance of a mean
    // over many is larger, 1 + 2 (rho1 + rho2 + ...), from the residuals; at least 1.
    double correlation(const AcrossNoise& noise, double scene_variance) const;
    void add_jumps_and_walls(NormalEquations& normal, double sigma) const;
    // The scene's own direction (unit) about one of its points, over up to `reach` points to either side on the same
    // surface; the direction's variance in parts of the noise of a point, 0 where there is none.
    struct SceneSlope {
        double tx = 0, tz = 0, variance = 0;
        int count = 0;
    };
    SceneSlope scene_slope(int at, int reach) const;
    // The least determined direction (a twist), what is seen of it, in points' worth, and whether that may be chance.
    // What is seen is the product of the template's slope and the scene's, whose errors know nothing of each other: that
    // of two flats is nothing on the average, however noisy, and so is that of a flat and a flank that it lies under.
    struct Weakest {
        Eigen::Vector3d twist, scaled;  // scaled: its farthest parts move by 1 mm per unit of length
        double seen = 0;
        bool unsure = false;
    };
    Weakest weakest(const CentredPose& pose, const AcrossNoise& noise) const;  // of `matches`
    Weakest weakest_at(const Finish& finish) const;                            // which it collects
    // What of the template nobody can see at the pose, turned over or too steep for any sensor: its share of the length, and
    // its part in Support::missing.
    struct TurnedAway {
        double share = 0, cost = 0;
    };
    TurnedAway turned_away(const CentredPose& pose) const;
    // Of the twist; `apart`: a direction that the points hold, not the slopes, with its variance.
    Eigen::Matrix3d twist_covariance(const NormalEquations& normal, const Weakest& weak,
                                     const Held& apart) const;
    // What the partners leave, over stretches of the contour, beyond what noise makes of them (mm^2): the shape is a little
    // another one, and nobody knows which part of it is where it was taught.
    double misfit_variance() const;  // of `matches`
    Registration conclude(const Finish& finish, const Support& support, double sigma) const;

    // What follows from the model. False: it has no length.
    bool learn();
    // The scene is longer than the template and knows better how far its points are means of several: the template is read
    // anew with it.
    void share_noise();
    // False: fewer points than the least within reach of the window.
    bool gather(const Profile& profile, const SearchWindow& window) const;
    void search_places(const SearchWindow& window) const;  // fills `finishes`
    bool within(const SearchWindow& window, const CentredPose& pose) const;
};

}  // namespace seamwright
