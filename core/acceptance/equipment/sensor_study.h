#pragma once
// A sensor against an artefact of certified size, in the spirit of VDI/VDE 2634 part 2 (and ISO 10360-13), from points
// that were captured already (mm, one frame for all points of an artefact):
//     probing form    PF = max - min of the radial distances from the least-squares sphere (free radius)
//     probing size    PS = diameter of that sphere - certified diameter
//     sphere distance SD = distance of the centres of two such spheres - certified distance
//     flatness        F  = max - min of the distances from the least-squares plane
// Three of a thousand points, those farthest off, may be left out of PF and F (the guideline's own allowance); they
// stay in the fit. It is an acceptance in the guideline's spirit and not by its letter: the artefact's places in the
// measuring volume are those of the data, and points from a robot's poses hold the robot's error too.
//
// Judged against the largest permitted error E of each by ISO 14253-1, U = 2 u of the certificate (form and flatness:
// the artefact's own deviation): ok where |value| + U <= E, not ok where |value| - U > E, conditional between. An E of
// 0 is none: the value is stated and not judged.
//
// Degenerate: a sphere seen in one cut only, or from a cap so small that radius and centre exchange; a plane on a line.

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/acceptance/acceptance.h"
#include "core/error.h"

namespace seamwright {

// What the certificate says. Absent: not certified, then the index is not made.
struct SphereProbing {
    std::string id;
    std::vector<Eigen::Vector3d> points_mm;
    std::optional<double> diameter_mm;
    double diameter_u_mm = 0, form_mm = 0;  // standard uncertainty; the artefact's own form
};
struct PlaneProbing {
    std::string id;
    std::vector<Eigen::Vector3d> points_mm;
    double flatness_mm = 0;  // the artefact's own
};
struct CertifiedDistance {
    std::string from, to;  // ids of spheres
    double length_mm = 0, u_mm = 0;
};
struct SensorLimits {
    double form_mm = 0, size_mm = 0, distance_mm = 0, flatness_mm = 0;  // largest permitted errors; 0: none
};
struct SensorStudyData {
    std::vector<SphereProbing> spheres;
    std::vector<PlaneProbing> planes;
    std::vector<CertifiedDistance> distances;
    SensorLimits limits;
};

inline constexpr int kFewestProbed = 25;        // points of a sphere or plane
inline constexpr double kLeftOutShare = 0.003;  // of PF and F
inline constexpr double kLeastCondition =
    0.01;  // of the sphere's normal equations; a cap of about 15 degrees

struct SensorIndex {
    double value_mm = 0;
    double U_mm = 0;      // of the certificate, k = 2
    double limit_mm = 0;  // 0: not judged
    std::optional<AcceptanceVerdict> verdict;
};
struct ProbedSphere {
    std::string id;
    int points = 0, left_out = 0;
    Eigen::Vector3d centre_mm = Eigen::Vector3d::Zero();
    double diameter_mm = 0, rms_mm = 0;
    SensorIndex form;
    std::optional<SensorIndex> size;
};
struct ProbedPlane {
    std::string id;
    int points = 0, left_out = 0;
    double rms_mm = 0;
    SensorIndex flatness;
};
struct ProbedDistance {
    std::string from, to;
    double measured_mm = 0;
    SensorIndex error;
};
struct SensorStudy {
    std::vector<ProbedSphere> spheres;
    std::vector<ProbedPlane> planes;
    std::vector<ProbedDistance> distances;
    // The worst of those judged; none judged: too little data.
    AcceptanceVerdict verdict = AcceptanceVerdict::too_little_data;
};

// Error (input): nothing to study, fewer than kFewestProbed points, points not finite, a degenerate artefact, one id
// twice, a distance between spheres that are not there, a certificate or limit that is none.
Expected<SensorStudy> sensor_study(const SensorStudyData& data);

}  // namespace seamwright
