#pragma once
// A door that bends and twists, simulated: the bead between the spots by rigid regions and with learnt modes.
//
// Parts: displaced, bent and twisted at random (devices/simulated/scene/door.h). Spots: the door's 12 suggested ones;
// each measures where the part's edge pierces its laser plane, with the sensor's noise, the robot's
// repeatability and the trigger's jitter along the travel, which nobody reports. The references are exact. The modes
// are learnt from `learnt` parts; all figures are of other parts.
//
// Error: from the corrected bead to the true one, across it (inboard and out of the sheet), every 10 mm of the
// contour. Ways: one rigid region of all spots; four rigid regions with the path blended between them (path_blend.h); all
// spots with modes; modes with a third fewer spots. The shape that no part of the learning has,
// dz = bulge sin(3 pi x / L), is to be noticed.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/evaluation/statistics.h"
#include "projects/evaluate/cell.h"

namespace seamwright::evaluation {

struct ElasticWay {
    std::string name;
    int spots = 0;
    Summary error;             // mm, both directions across
    double stated = 0;         // 3 sigma, rms along the bead
    double inside = 0;         // share of the stated 95 %
    int parts = 0, acted = 0;  // parts with an answer; of them with modes
};

struct ElasticExperiment {
    int learnt = 0, tried = 0, modes = 0, modes_of_fewer = 0;
    double noise_mm = 0, repeatability_mm = 0, jitter_mm = 0;
    double bend_mm = 0, twist_mm = 0, bulge_mm = 0, shift_mm = 0, turn_deg = 0;
    std::uint64_t seed = 1;
    std::vector<ElasticWay> ways;  // rigid region, rigid regions, modes, modes with fewer spots
    int unseen = 0, noticed = 0;   // parts with the shape that was not learnt
    double gain() const { return ways[1].error.three_sigma / ways[2].error.three_sigma; }
};

// Error: what the solvers refuse.
Expected<ElasticExperiment> elastic_experiment(const EvaluationSettings& settings);
std::string elastic_text(const ElasticExperiment& e);
nlohmann::json elastic_json(const ElasticExperiment& e);

}  // namespace seamwright::evaluation
