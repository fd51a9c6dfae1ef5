#pragma once
// Panel jobs as JSON files. One of measures alone ("spots": `seamwright panel JOB.json`) is fitted without a device; one
// of a project ("places": an entry of "panel_jobs" as `export` writes it, or an export that holds one) is kept in
// a project and measured on its devices.

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "core/panel/panel_fit.h"
#include "projects/model/project.h"

namespace seamwright {

struct PanelMeasures {
    std::vector<PanelSpot> spots;
    PanelOptions options;
};

// "share", "leave_out". Error: another word.
Expected<PanelDeviation> panel_deviation_from(const std::string& word);

// Which of the two it is, its fields say; what has neither is read as measures. Error: the file, its JSON, a field, an
// export with several panel jobs or none.
Expected<std::variant<PanelMeasures, PanelJob>> read_panel_file(const std::filesystem::path& file);

// Error: it holds a panel job, which is for a project.
Expected<PanelMeasures> read_panel_measures(const std::filesystem::path& file);
// Error: it holds measures, which no device measures again.
Expected<PanelJob> read_panel_job(const std::filesystem::path& file);

// The project with it, in the place of a job of its name. Error: what check() finds in it that it did not find before: an
// unknown robot or sensor, a frame that is another's.
Expected<Project> with_panel_job(Project project, PanelJob job);

}  // namespace seamwright
