#pragma once
// The sensor against artefacts of certified size (core/acceptance/equipment/sensor_study.h), from data that are captured
// already: a file of points or profiles, or the sphere profiles that the project's calibrations keep.
//
// File: {"sensor":"A"?, "flange_from_sensor":POSE?, "limits_mm":{"form","size","distance","flatness"}?,
//   "spheres":[{"id","diameter_mm"?,"diameter_u_mm"?,"form_mm"?,"certificate"?, DATA}],
//   "distances":[{"from","to","length_mm","u_mm"?}], "planes":[{"id","flatness_mm"?,"certificate"?, DATA}]}
// DATA: "points":[[x,y,z],..] (mm), or "observations":[{"base_from_flange":POSE,"profile":[[x,z],..]}] (null: no
// return), which flange_from_sensor turns into points of the base. A sphere's section is found in each profile among
// post, table and stray points (core/calibration/sphere/circle_section.h); a plane's profile is all of it.
//
// With a project, artefacts without DATA take the observations of the calibration of that id (spheres; of one sphere
// alone those of the sensor's calibration in use), and flange_from_sensor is the sensor's. A certificate is thus
// this file without DATA.

#include <nlohmann/json.hpp>

#include "core/acceptance/equipment/sensor_study.h"
#include "projects/acceptance/study/studies.h"
#include "projects/report/html.h"

namespace seamwright {

struct SensorCheck {
    SensorStudy study;
    StudySource source;                                             // file, sensor and serials, simulated
    std::vector<std::pair<std::string, std::string>> certificates;  // by artefact
    std::vector<Text> remarks;
};

// `project`: where artefacts without data are looked up; nullptr: nowhere. Error (input): what the file or the study
// refuses, an artefact without data, a sphere that no profile shows.
Expected<SensorCheck> sensor_check(const nlohmann::json& data, const std::string& where,
                                   const Project* project);

// {"spheres":[..],"planes":[..],"distances":[..],"verdict"}
nlohmann::json sensor_check_json(const SensorCheck& check);
void add_chapter(report::Page& page, Language language, const SensorCheck& check, int level = 2);

}  // namespace seamwright
