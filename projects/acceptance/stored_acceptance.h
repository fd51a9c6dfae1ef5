#pragma once
// The acceptance of one region as the project's file holds it: every study that its stored runs and evidence allow,
// judged by the project's requirements. Command line, studio and hand-over report show this one.

#include <nlohmann/json.hpp>

#include "devices/quality/qdas.h"
#include "projects/acceptance/equipment/measure_robot.h"
#include "projects/acceptance/equipment/measure_trigger.h"
#include "projects/acceptance/equipment/sensor_check.h"
#include "projects/acceptance/study/studies.h"
#include "projects/file/project_file.h"
#include "projects/report/html.h"

namespace seamwright {

// What a file of elsewhere adds to the stored runs.
struct AcceptanceExtras {
    std::vector<StudyValue> references;  // of a CMM or tracker, matched by part: the correlation
    nlohmann::json sensor_data;          // sensor_check.h; null: none
    std::string sensor_data_from;
};

struct StoredAcceptance {
    AcceptanceSettings settings;
    std::string region_id;
    std::optional<Acceptance> studies;
    std::optional<Error> lacking;           // why there are none: the tolerance, no run, ...
    std::optional<StudyForecast> forecast;  // of the studies; before them of the project as it stands
    std::optional<MeasuredRobot> robot;
    std::optional<MeasuredTrigger> trigger;
    std::optional<SensorCheck> sensor;
    std::optional<Error> sensor_lacking;  // why the data of the sensor are none
    bool anything() const { return studies || robot || trigger || sensor; }
};

// `project` is the document as it stands (the file's, or the studio's unsaved one); `region_id` may be empty where it
// has one. Error (usage, input): an unknown region; (file): the file.
Expected<StoredAcceptance> stored_acceptance(const ProjectFile& file, const Project& project,
                                             const std::string& region_id,
                                             const AcceptanceExtras& extras = {});

// Its chapters without title and signatures: studies first, then robot, trigger and sensor, then what the data do not
// allow.
void add_chapters(report::Page& page, Language language, const StoredAcceptance& stored, int level = 2);
// The whole page, with lines to sign.
report::Page acceptance_page(const StoredAcceptance& stored, const std::string& file, Language language,
                             const std::string& program);

// Part, characteristic, limits and values of the studies.
QdasStudy qdas_study(const Acceptance& acceptance);

}  // namespace seamwright
