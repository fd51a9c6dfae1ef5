#pragma once
// The project's and the runs' types as JSON, see json_archive.h for the form. Used for the rows of the file,
// for the setup kept with a run, and for export.

#include "projects/file/json_archive.h"
#include "projects/model/evidence.h"
#include "projects/model/project.h"
#include "projects/model/run.h"

namespace seamwright {

// T: Project, PartSetup, PartType, SensorSetup, RobotSetup, Calibration, Spot, Region, PanelJob, SpotMeasurement,
// RegionRecord, PanelMeasurement, PanelRecord, Requirements, FrozenContour, ZeroShift, KnownShift,
// HeadlessRun, RobotReturns, TriggerPasses. Meshes and captures are never part of the JSON; profiles when the options say so.
template <class T>
nlohmann::json to_json_document(const T& value, const ArchiveOptions& options = {});
// Error: input, with the path inside the document after `where`.
template <class T>
Expected<T> from_json_document(const nlohmann::json& document, const std::string& where,
                               const ArchiveOptions& options = {});

// Text of a document. Error: a text inside is not UTF-8.
Expected<std::string> dump_document(const nlohmann::json& document, const std::string& where);
// The same with U+FFFD in the place of what is not UTF-8: for messages of devices, which must never keep a
// run from being recorded.
std::string dump_messages(const nlohmann::json& document);
std::string utf8_text(const std::string& text);

// The status by its word in a document; nullopt: there is no such one.
std::optional<CorrectionStatus> correction_status_named(const std::string& word);

}  // namespace seamwright
