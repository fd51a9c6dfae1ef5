#pragma once
// Spots proposed from the drawing (methods.md 10 and 11): along an edge those that leave the bead best known.
//
// The bead is the edge that is named; candidates stand along the whole chain of tangent edges that it lies in, `step_mm`
// apart: the sensor's travel along the edge in either direction, its height axis along the middle of the two faces'
// normals and turned about the edge by up to cone_deg both ways, the edge in the middle of its range. What a candidate
// would see is cut from the drawing (expected_profile.h); where no feature is found surely it is none. The drawing lies in
// the work object. Noise, arrivals, trigger and calibration are the project's, as the forecast takes them, and the bead is
// judged as taught and displaced by what is required to be recovered (forecast.h); the choice is core/correction/placing.
// What a robot cannot reach or would run into is not known here: a project knows no robot's axes, so that cone_deg alone
// limits the attitudes. The spots are ReferenceState::from_drawing; take.h puts them into a project.

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "core/correction/placing/placing.h"
#include "devices/drawing/drawing.h"
#include "devices/simulated/scene/renderer.h"
#include "projects/model/project.h"

namespace seamwright {

struct ProposeOptions {
    std::string edge;                 // "e12"
    std::string sensor_id, robot_id;  // empty: the project's first
    std::string region_id;            // whose free degrees and limits hold; empty: those of a new region
    double three_sigma_mm = 0.1;
    int fewest = 4, most = 12;
    bool one_may_be_lost = true;
    double step_mm = 0;  // between places; 0: 60 of them on the chain, at least 10 mm apart
    // How far beyond the ends of the edge spots may stand along its chain: a part that bends is the more another body the
    // farther away it is looked at, and the forecast takes it for rigid.
    double beyond_mm = std::numeric_limits<double>::infinity();
    double cone_deg = 15;    // 0: the middle of the normals alone
    double noise_mm = 0.02;  // of a profile's point, one standard deviation
    double bead_step_mm = 20;
    OpticsSettings optics;  // where the calibration does not say it
    std::uint64_t seed = 1;
    std::stop_token cancel;
    std::function<void(double share, const Text& what)> progress;
};

struct ProposedSpot {
    Spot spot;                                           // id "P1", ...; in the order of the way
    double arc_mm = 0;                                   // on the chain
    double turned_deg = 0;                               // about the edge, from the middle of the normals
    Eigen::Vector2d sigma_mm = Eigen::Vector2d::Zero();  // of its feature, the larger first
    Eigen::Vector3d point_mm = Eigen::Vector3d::Zero();  // its reference, work object
    std::size_t place = 0;                               // of places_of()
};

struct Looked;  // all candidates of a proposal, with what they see

struct Proposal {
    std::vector<ProposedSpot> spots;
    PlacedSet set;                 // chosen: of `looked`; enough: by its own measure and by the gate's
    double bound_mm = 0;           // no set of as many spots among these candidates has a smaller 3 sigma
    double bound_of_fewer_mm = 0;  // the same for one spot less; 0: there is none
    std::vector<double> along_mm;  // 3 sigma at every point of the bead
    std::vector<TaughtBeadPoint> bead;
    int places = 0, candidates = 0, tried = 0;  // tried: attitudes; candidates: those that see something
    double sigma_forecast_mm = 0;  // as the safety gate will judge it (forecast.h), one standard deviation
    std::shared_ptr<const Looked> looked = nullptr;
};

// Error (input): no such edge or region, a sensor without calibration, options out of range, too few places see a feature; (usage)
// cancelled.
Expected<Proposal> propose_spots(const Project& project, const Drawing& drawing,
                                 const ProposeOptions& options);

// Where a spot of the proposal can be moved to: the places along the chain that see a feature, work object, in the order of
// the chain. Empty without `looked`.
std::vector<Eigen::Vector3d> places_of(const Proposal& proposal);

// The proposal with one spot at another place (an index of places_of()), turned as it was where that sees a feature there,
// else as leaves the bead best known. Spots keep their names and stand in the order of the new way; set, forecast and
// along_mm are new, the bounds are those of all sets of as many and stay. For ghosts that are dragged: some milliseconds.
// Error (input): no such spot or place, another spot stands there.
Expected<Proposal> move_proposed(const Proposal& proposal, const std::string& spot_id, std::size_t place);

// The same measure of a region's spots as they are: 3 sigma across the bead at its worst point, and with the worst spot
// lost. Error: what SpotPlacing refuses, a spot that cannot be planned.
Expected<PlacedSet> judge_spots(const Project& project, const Region& region,
                                const std::vector<TaughtBeadPoint>& bead);

// The bead as it is judged: the named edge in steps.
Expected<std::vector<TaughtBeadPoint>> bead_of(const Drawing& drawing, const std::string& edge,
                                               double step_mm);

}  // namespace seamwright
