// seamwright import: a project from exported JSON, or from a recording: profiles or camera images with poses,
// as sensors, robots and their tools write them.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "app/cli/arguments/calibration_argument.h"
#include "app/cli/arguments/feature_setting.h"
#include "app/cli/arguments/pose_argument.h"
#include "app/cli/arguments/pose_table_arguments.h"
#include "app/cli/command.h"
#include "core/profile/stripe/peaks.h"
#include "devices/exchange/files.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "devices/replay/recording.h"
#include "projects/file/project_file.h"
#include "projects/reuse/exchange.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

struct ImportArguments {
    std::string file, source, reference, kind = "contour-end", flange_from_sensor, base_from_workobject;
    std::string calibration, calibration_id, channel = "automatic";
    std::vector<std::string> set;
    std::vector<double> piece, landmark;
    RecordingLayout layout;
    PoseTableArguments poses;
    bool rows = false, columns = false, replace = false, look = false;
    double sigma_mm = FolderImport{}.sigma_mm, sigma_limit_mm = FolderImport{}.sigma_limit_mm;
};

// What images need and do not say: the channel that shows the stripe, and how it runs.
Expected<void> look_at_images(const ImportArguments& a, FolderImport& options, std::vector<Text>& notes) {
    SEAM_TRY(auto frames,
             list_recording(fs::absolute(options.folder).lexically_normal(), "", false, options.layout));
    if (!frames.front().image) return {};
    const fs::path& first = frames.front().file;
    SEAM_TRY(auto choice, choose_channel(first));
    if (a.channel == "automatic")
        options.layout.channel = choice.channel;
    else
        options.layout.channel = *image_channel(a.channel);
    if (choice.colour) {
        notes.push_back(
            fmt::format("colour images: the stripe is read in {}", to_string(options.layout.channel)));
        if (options.layout.channel == ImageChannel::grey && choice.channel != ImageChannel::grey)
            notes.push_back(
                fmt::format("colour is folded to grey, where the stripe goes on over {:.0f} % of the lines; "
                            "in {} over {:.0f} %",
                            100 * choice.share_grey, to_string(choice.channel), 100 * choice.share));
    }
    if (choice.mosaic) notes.push_back(mosaic_warning());
    if (a.rows) options.peaks.scan = ScanLines::rows;
    if (a.columns) options.peaks.scan = ScanLines::columns;
    if (!a.rows && !a.columns) {
        Frame frame;
        SEAM_OK(read_image_file(first, frame, 0, options.layout.channel));
        SEAM_TRY(auto guess, guess_scan_lines(frame.image));
        options.peaks.scan = guess;
        notes.push_back(fmt::format("the stripe of {} is cut by {}; --rows or --columns says otherwise",
                                    first.filename().string(),
                                    guess == ScanLines::rows ? "rows" : "columns"));
    }
    return {};
}

Expected<FolderImport> folder_import(const ImportArguments& a) {
    FolderImport options;
    options.folder = a.source;
    if (!a.reference.empty()) options.reference_folder = a.reference;
    options.project_name = fs::path(a.file).stem().string();
    options.feature.kind = a.kind;
    options.layout = a.layout;
    SEAM_TRY(options.layout.pose, a.poses.layout());
    if (!options.layout.poses.empty()) options.layout.poses = fs::absolute(options.layout.poses).string();
    SEAM_TRY(auto kind, find_feature_kind(a.kind));
    for (const std::string& entry : a.set) {
        SEAM_TRY(auto value, feature_setting(*kind, entry));
        options.feature.parameters[value.first] = value.second;
    }
    if (a.kind != "template" && (!a.piece.empty() || !a.landmark.empty()))
        return usage_error("--piece and --landmark belong to --kind template", "import");
    if (!a.piece.empty()) {
        if (!(a.piece[0] < a.piece[1])) return usage_error("the first x must be the smaller one", "--piece");
        options.piece_x_mm = {a.piece[0], a.piece[1]};
    }
    if (!a.landmark.empty()) options.template_reference_mm = {a.landmark[0], a.landmark[1]};
    SEAM_TRY(auto flange, read_place_argument(a.flange_from_sensor, "--flange-from-sensor", kLeastPlace_mm,
                                              "flange_from_sensor"));
    options.flange_from_sensor = flange;
    SEAM_TRY(auto base,
             read_place_argument(a.base_from_workobject, "--base-from-workobject", kLeastPlace_mm));
    options.base_from_workobject = base;
    options.sigma_mm = a.sigma_mm;
    options.sigma_limit_mm = a.sigma_limit_mm;
    if (!a.flange_from_sensor.empty()) options.calibration_verdict = Verdict::usable;
    if (!a.calibration.empty()) {
        SEAM_TRY(auto calibration, read_calibration(a.calibration, a.calibration_id));
        if (!a.flange_from_sensor.empty()) calibration.flange_from_sensor = flange;
        options.calibration = std::move(calibration);
    } else if (!a.calibration_id.empty()) {
        return usage_error("--calibration-id needs --calibration FILE.seam", "import");
    }
    return options;
}

json pose_or_null(const std::optional<Pose>& pose) {
    return pose ? pose_json(*pose) : json(nullptr);
}

json number_or_null(double value) {
    return std::isfinite(value) ? json(value) : json(nullptr);
}

Expected<Answer> look(const ImportArguments& a) {
    RecordingLayout layout = a.layout;
    SEAM_TRY(layout.pose, a.poses.layout());
    if (!layout.poses.empty()) layout.poses = fs::absolute(layout.poses).string();
    if (a.channel != "automatic") layout.channel = *image_channel(a.channel);
    SEAM_TRY(auto flange, read_place_argument(a.flange_from_sensor, "--flange-from-sensor", kLeastPlace_mm,
                                              "flange_from_sensor"));
    layout.flange_from_sensor = flange;
    SEAM_TRY(auto seen, look_at_recording(a.source, layout));
    Answer answer;
    json files = json::array();
    bool sound = seen.problem.empty();
    answer.text = fmt::format("{} frames in {}\n", seen.frames, a.source);
    for (const std::string& line : seen.understood) answer.text += "  " + line + "\n";
    if (!seen.problem.empty()) answer.text += "  problem: " + seen.problem + "\n";
    for (const auto& f : seen.files) {
        json entry{{"file", f.name},
                   {"spot", f.spot_id},
                   {"readable", f.readable},
                   {"understood", f.understood},
                   {"base_from_flange", pose_or_null(f.base_from_flange)}};
        answer.text += fmt::format("{} (spot {}): {}\n", f.name, f.spot_id, f.understood);
        sound = sound && f.readable;
        if (f.readable && f.image) {
            entry["width"] = f.width, entry["height"] = f.height, entry["bit_depth"] = f.bit_depth;
            answer.text += fmt::format("  {} x {}, {} bit\n", f.width, f.height, f.bit_depth);
            if (f.channel) {
                entry["colour"] = f.channel->colour;
                entry["channel"] = to_string(f.channel->channel);
                entry["lines_share"] = f.channel->share;
                entry["mosaic"] = f.channel->mosaic;
                answer.text += fmt::format("  the stripe goes on over {:.0f} % of the lines in {}\n",
                                           100 * f.channel->share, to_string(f.channel->channel));
                if (f.channel->mosaic) answer.text += "  " + mosaic_warning().english() + "\n";
            }
        } else if (f.readable) {
            const ProfileScale& s = f.scale;
            json first = json::array();
            answer.text += "  first";
            for (const auto& p : f.first) {
                first.push_back({number_or_null(p.x()), number_or_null(p.y())});
                answer.text += fmt::format("  ({:.6g}, {:.6g})", p.x(), p.y());
            }
            entry.update({{"points", s.points},
                          {"first", first},
                          {"x", {number_or_null(s.x_low), number_or_null(s.x_high)}},
                          {"z", {number_or_null(s.z_low), number_or_null(s.z_high)}},
                          {"pitch", number_or_null(s.pitch)},
                          {"noise", number_or_null(s.noise)},
                          {"suspected_unit", s.suspected},
                          {"no_returns", f.no_returns}});
            answer.text += fmt::format(
                "\n  {} points, x {:.4g} to {:.4g}, z {:.4g} to {:.4g}, pitch {:.3g}, noise {:.2g} mm\n",
                s.points, s.x_low, s.x_high, s.z_low, s.z_high, s.pitch, s.noise);
            if (!f.no_returns.empty()) answer.text += "  " + f.no_returns.english() + "\n";
            if (!s.suspected.empty()) {
                if (layout.profile.unit.empty()) sound = false;
                answer.text += "  " + s.why.english() + ", which looks like " + s.suspected +
                               ": say what they are in with --unit\n";
            }
        }
        if (f.base_from_flange) {
            const auto t = f.base_from_flange->translation();
            answer.text += fmt::format("  flange at {:.3f}, {:.3f}, {:.3f} mm\n", t.x(), t.y(), t.z());
        }
        files.push_back(std::move(entry));
    }
    answer.json = {{"status", sound ? "ok" : "unclear"},
                   {"frames", seen.frames},
                   {"understood", seen.understood},
                   {"problem", seen.problem},
                   {"files", files}};
    answer.exit_code = sound ? kExitOk : kExitVerdict;
    return answer;
}

Expected<Answer> import_command(const ImportArguments& a) {
    if (a.look) return look(a);
    if (a.file.empty())
        return usage_error("the project to create is missing", "import", "give FILE.seam, or --look");
    Project project;
    std::vector<Text> notes;
    std::vector<std::string> understood;
    bool in_pixels = false;
    // A table is a recording; only .json is a project.
    if (!a.source.ends_with(".json") && (fs::is_directory(a.source) || fs::path(a.source).has_extension())) {
        SEAM_TRY(auto options, folder_import(a));
        SEAM_OK(look_at_images(a, options, notes));
        SEAM_TRY(auto imported, import_folder(options));
        project = std::move(imported.project);
        notes.insert(notes.end(), imported.notes.begin(), imported.notes.end());
        understood = std::move(imported.understood);
        in_pixels = imported.in_pixels;
    } else {
        SEAM_TRY(auto text, read_text_file(a.source));
        SEAM_TRY(auto document, parse_json(text, a.source));
        SEAM_TRY(auto imported, import_project(document));
        project = std::move(imported);
    }
    auto file = ProjectFile::create(a.file, project, a.replace);
    if (!file) return tl::unexpected(file.error());
    Answer answer;
    answer.json = {{"status", "ok"},
                   {"file", a.file},
                   {"spots", project.spots.size()},
                   {"regions", project.regions.size()},
                   {"in_pixels", in_pixels},
                   {"understood", understood},
                   {"notes", notes}};
    answer.text =
        fmt::format("{} created: {} spots, {} regions{}\n", a.file, project.spots.size(),
                    project.regions.size(), in_pixels ? ", measured in pixels (no calibration)" : "");
    for (const std::string& line : understood) answer.text += "  " + line + "\n";
    for (const Text& note : notes) answer.text += "  " + note.english() + "\n";
    return answer;
}

std::vector<std::string> list(auto& words) {
    return {std::begin(words), std::end(words)};
}

}  // namespace

void add_import(CommandLine& line) {
    auto a = std::make_shared<ImportArguments>();
    CLI::App* command = line.add(
        "import",
        "A project from exported JSON, or from profiles or camera images with robot poses as sensors and "
        "robots "
        "write them:\ntext of any separator, decimal comma or point, with or without header (.csv .tsv .txt "
        ".asc .xyz "
        ".dat), .npy, .ply,\n.pcd, .png, .tiff, ..; poses as one table (--poses) or a file beside each "
        "frame.",
        "seamwright import door.seam --from recorded/car7 --reference recorded/master \\\n"
        "      --flange-from-sensor '{\"xyz\":[0,0,120],\"abc\":[0,0,0]}' --kind contour-end --set "
        "side=right\n"
        "  seamwright import --look --from scans --unit um --poses poses.csv --pose-convention fanuc-wpr\n"
        "  seamwright import cam.seam --from images --calibration calibrated.seam --calibration-id "
        "stripe-camera-1\n"
        "  then: seamwright run door.seam");
    command->add_option("file", a->file, "The project to create")->type_name("FILE.seam");
    command->add_option("--from", a->source, "FILE.json of `export`, a folder, or one file with all profiles")
        ->required()
        ->type_name("FILE|DIR");
    command->add_option("--reference", a->reference, "Recorded on the taught part (default: --from itself)")
        ->type_name("FILE|DIR");
    command->add_flag("--look", a->look,
                      "Only say what is understood: first values, range, pitch, noise, suspected unit");
    command
        ->add_option(
            "--unit", a->layout.profile.unit,
            "What the profiles are in: mm, cm, m, um, nm, in (inches) or mil (thousandths of an inch)")
        ->check(CLI::IsMember(list(kFileUnits)));
    command
        ->add_option("--columns-xz", a->layout.profile.columns,
                     "The columns of x and z, by name or by number from 1")
        ->type_name("X,Z");
    command
        ->add_option("--invalid", a->layout.profile.invalid,
                     "Heights that stand for \"no return\", as the files write them, e.g. -9999 (default: "
                     "recognised)")
        ->delimiter(',')
        ->type_name("Z");
    command
        ->add_option("--poses", a->layout.poses,
                     "All poses in one file: CSV by name or by order, 4x4 matrices, JSON, or the points of a "
                     "program: KUKA .dat, ABB .mod, FANUC .ls")
        ->type_name("FILE");
    add_pose_table_options(command, a->poses, nullptr);
    command->add_option("--kind", a->kind, "Feature kind of every spot")->capture_default_str();
    command->add_option("--set", a->set, "Setting of the feature, NAME=VALUE; may be repeated")
        ->type_name("NAME=VALUE");
    command
        ->add_option(
            "--piece", a->piece,
            "Kind template: from which x to which the taught profile is the template (default: all of it)")
        ->delimiter(',')
        ->expected(2)
        ->type_name("X0,X1");
    command
        ->add_option("--landmark", a->landmark,
                     "Kind template: the point x,z it carries (default: its middle)")
        ->delimiter(',')
        ->expected(2)
        ->type_name("X,Z");
    command
        ->add_option(
            "--flange-from-sensor", a->flange_from_sensor,
            "Sensor on the flange: POSE, or a file that holds one or the answer of `calibrate --json`")
        ->type_name("POSE");
    command->add_option("--base-from-workobject", a->base_from_workobject, "Work object in the robot's base")
        ->type_name("POSE");
    command
        ->add_option(
            "--calibration", a->calibration,
            "Images become millimetres with this: a project that holds it, the JSON answer of `calibrate "
            "stripe-camera`, or a table of `calibrate lut --table`")
        ->type_name("FILE.seam|FILE.json|FILE.lut");
    command->add_option("--calibration-id", a->calibration_id, "Which of the project's calibrations");
    command->add_option("--sigma-mm", a->sigma_mm, "Standard deviation of a measured coordinate")
        ->capture_default_str();
    command
        ->add_option("--sigma-limit-mm", a->sigma_limit_mm,
                     "A correction that is less sure than this at any spot is refused")
        ->capture_default_str();
    auto* rows = command->add_flag("--rows", a->rows, "Images: one cut per row");
    command->add_flag("--columns", a->columns, "Images: one cut per column (default: seen from the first)")
        ->excludes(rows);
    command
        ->add_option("--channel", a->channel,
                     "Colour images: grey, red, green, blue, red-difference (R - (G+B)/2), or automatic")
        ->check(CLI::IsMember({"automatic", "grey", "red", "green", "blue", "red-difference"}))
        ->capture_default_str();
    command->add_flag("--replace", a->replace, "Replace an existing project file");
    line.on(command, [a] { return import_command(*a); });
}

}  // namespace seamwright::cli
