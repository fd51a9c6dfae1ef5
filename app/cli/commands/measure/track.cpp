// seamwright track: which of several candidates a line the stripe is, and what of it is an outlier.

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <set>

#include "app/cli/arguments/calibration_argument.h"
#include "app/cli/arguments/filter_options.h"
#include "app/cli/command.h"
#include "core/profile/filter.h"
#include "core/profile/stripe/peaks.h"
#include "core/system_text.h"
#include "devices/exchange/files.h"
#include "devices/exchange/image_file.h"
#include "devices/exchange/tables/candidates_table.h"
#include "devices/exchange/tables/profile_csv.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

struct TrackArguments {
    std::vector<std::string> files;
    std::string out, calibration, calibration_id;
    bool rows = false, columns = false, points = false;
    int per_line = PeakOptions{}.per_line;
    FilterOptions filter;
};

bool is_image(const fs::path& path) {
    std::string end = path.extension().string();
    for (char& c : end) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    for (const char* known : {".png", ".bmp", ".tif", ".tiff", ".pgm", ".ppm", ".jpg", ".jpeg"})
        if (end == known) return true;
    return false;
}

// Peaks of an image, in mm by the model; without one in pixels, x along the lines.
Expected<CandidatesTable> of_image(const std::string& path, const TrackArguments& a, const SensorModel* model,
                                   std::vector<std::string>& warnings) {
    SEAM_TRY(const auto choice, choose_channel(path));
    if (choice.mosaic) warnings.push_back(path + ": " + mosaic_warning().english());
    Frame frame;
    SEAM_OK(read_image_file(path, frame, 0, choice.channel));
    if (model && model->camera.width > 0 &&
        (model->camera.width != frame.image.width || model->camera.height != frame.image.height))
        return input_error(
            Text("it has {} x {} pixels, the calibration was made with images of {} x {}", frame.image.width,
                 frame.image.height, model->camera.width, model->camera.height),
            path, "give images of that camera at that resolution");
    PeakOptions options;
    options.per_line = a.per_line;
    options.scan = a.rows ? ScanLines::rows : ScanLines::columns;
    if (!a.rows && !a.columns) {
        SEAM_TRY(options.scan, guess_scan_lines(frame.image));
    }
    StripePeaks peaks;
    SEAM_OK(find_peaks(frame.image, options, peaks));
    CandidatesTable table;
    if (model) {
        to_millimetres(peaks, *model, table.candidates);
        return table;
    }
    table.pixels = true;
    ProfileCandidates& c = table.candidates;
    c.lines = peaks.lines;
    c.per_line = peaks.per_line;
    c.count = peaks.count;
    c.intensity = peaks.intensity;
    c.z_mm.assign(peaks.position_px.begin(), peaks.position_px.end());
    c.x_mm.resize(c.z_mm.size());
    for (int line = 0; line < c.lines; ++line)
        for (int k = 0; k < c.per_line; ++k) c.x_mm[static_cast<std::size_t>(c.index(line, k))] = line;
    return table;
}

// The candidate that the tracking took on a line, -1: none there.
int taken(const ProfileCandidates& c, const Profile& profile, int line) {
    const auto i = static_cast<std::size_t>(line);
    for (int k = 0; k < c.count[i]; ++k) {
        const auto at = static_cast<std::size_t>(c.index(line, k));
        if (c.x_mm[at] == profile.x_mm[i] && c.z_mm[at] == profile.z_mm[i]) return k;
    }
    return -1;
}

json told(const std::string& file, const CandidatesTable& table, const Profile& profile, bool points) {
    const ProfileCandidates& c = table.candidates;
    int seen = 0, several = 0, accepted = 0, switched = 0;
    std::int32_t segments = 0;
    json list = json::array();
    for (int line = 0; line < c.lines; ++line) {
        const auto i = static_cast<std::size_t>(line);
        if (c.count[i] == 0) continue;
        ++seen;
        several += c.count[i] > 1;
        const int k = taken(c, profile, line);
        const bool is_stripe = profile.segment[i] != kOutlier;
        accepted += is_stripe;
        segments = std::max(segments, profile.segment[i] + 1);
        if (is_stripe && !c.intensity.empty())
            for (int other = 0; other < c.count[i]; ++other)
                if (c.intensity[static_cast<std::size_t>(c.index(line, other))] >
                    c.intensity[static_cast<std::size_t>(c.index(line, k))]) {
                    ++switched;
                    break;
                }
        if (points)
            list.push_back({{"line", line},
                            {"candidate", is_stripe ? json(k) : json()},
                            {"x", profile.x_mm[i]},
                            {"z", profile.z_mm[i]},
                            {"segment", profile.segment[i]}});
    }
    json out = {{"file", file},
                {"unit", table.pixels ? "px" : "mm"},
                {"lines", c.lines},
                {"with_candidates", seen},
                {"with_several", several},
                {"accepted", accepted},
                {"outliers", seen - accepted},
                {"not_the_brightest", c.intensity.empty() ? json() : json(switched)},
                {"segments", segments}};
    if (points) out["points"] = std::move(list);
    return out;
}

// One file goes where --out says, several into that folder under their own names.
Expected<void> write(const TrackArguments& a, const std::string& file, const Profile& profile) {
    if (a.out.empty()) return {};
    if (a.files.size() == 1) return write_profile_csv(a.out, profile);
    std::error_code failed;
    fs::create_directories(a.out, failed);
    if (failed) return file_error(Text("the folder cannot be made ({})", system_text(failed)), a.out);
    return write_profile_csv(fs::path(a.out) / (fs::path(file).stem().string() + ".csv"), profile);
}

Expected<Answer> track(const TrackArguments& a) {
    std::optional<Calibration> calibration;
    if (!a.calibration.empty()) {
        SEAM_TRY(calibration, read_calibration(a.calibration, a.calibration_id));
        if (!calibration->model)
            return input_error("the calibration holds no model of the camera", a.calibration,
                               "give one that turns pixels into millimetres");
    }
    std::set<std::string> names;
    for (const std::string& file : a.files)
        if (!names.insert(fs::path(file).stem().string()).second && !a.out.empty())
            return usage_error("two files of one name go into one folder", file, "rename one of them");
    Answer answer;
    answer.json = {{"status", "ok"}, {"profiles", json::array()}};
    bool all = true;
    std::vector<std::string> warnings;
    for (const std::string& file : a.files) {
        SEAM_TRY(const auto table,
                 is_image(file) ? of_image(file, a, calibration ? &*calibration->model : nullptr, warnings)
                                : read_candidates(file));
        Profile profile;
        SEAM_OK(track_stripe(table.candidates, a.filter, profile));
        SEAM_OK(write(a, file, profile));
        const json one = told(file, table, profile, a.points);
        all = all && one["accepted"] > 0;
        answer.text += fmt::format(
            "{}: {} lines, {} with candidates, {} with several; {} accepted in {} segments, {} outliers{}\n",
            file, one["lines"].get<int>(), one["with_candidates"].get<int>(), one["with_several"].get<int>(),
            one["accepted"].get<int>(), one["segments"].get<int>(), one["outliers"].get<int>(),
            one["not_the_brightest"].is_null()
                ? ""
                : fmt::format("; on {} lines not the brightest", one["not_the_brightest"].get<int>()));
        answer.json["profiles"].push_back(one);
    }
    for (const std::string& w : warnings) answer.text += "warning: " + w + "\n";
    answer.json["warnings"] = warnings;
    if (!all) {
        answer.json["status"] = "no_stripe";
        answer.exit_code = kExitVerdict;
    }
    return answer;
}

}  // namespace

void add_track(CommandLine& line) {
    auto a = std::make_shared<TrackArguments>();
    CLI::App* command =
        line.add("track",
                 "Choose the stripe among several candidates a line, reflections among them, and mark what "
                 "is an outlier: the "
                 "most\nprobable sequence under the model of the point spacing, as a run does. From "
                 "candidates in files, from "
                 "`extract`'s\npeaks, or from images.",
                 "seamwright track candidates.csv --out profile.csv\n"
                 "  seamwright track peaks.csv --points --json -          (of `extract --peaks 3`)\n"
                 "  seamwright track frames/*.png --peaks 4 --calibration door.seam --out profiles\n"
                 "  candidates.csv: line,x_mm,z_mm[,intensity], several rows a line; or JSON "
                 "{\"lines\":[[[x,z,intensity],..],..]}");
    command->add_option("files", a->files, "Candidates (.csv, .json) or images")
        ->required()
        ->type_name("PROFILES...");
    command->add_option("--out", a->out, "The profile, with valid and segment; of several files a folder")
        ->type_name("OUT.csv|DIR");
    command->add_flag("--points", a->points, "Every line's point in the answer");
    auto* rows = command->add_flag("--rows", a->rows, "Of images: one cut per row");
    command->add_flag("--columns", a->columns, "Of images: one cut per column; default: seen from the image")
        ->excludes(rows);
    command->add_option("--peaks", a->per_line, "Of images: candidates a line")
        ->check(CLI::Range(1, 64))
        ->capture_default_str();
    auto* calibration =
        command
            ->add_option("--calibration", a->calibration,
                         "Of images: the sensor's model, as `import` takes it; without it pixels are tracked")
            ->type_name("FILE");
    command->add_option("--calibration-id", a->calibration_id, "Which of the project's calibrations")
        ->needs(calibration);
    add_filter_options(command, a->filter);
    line.on(command, [a] { return track(*a); });
}

}  // namespace seamwright::cli
