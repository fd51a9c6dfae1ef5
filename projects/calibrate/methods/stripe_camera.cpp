#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <tuple>

#include "core/calibration/camera/camera.h"
#include "core/geometry/pose_convention.h"
#include "core/profile/peaks.h"
#include "devices/exchange/image_file.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/input/plate_images.h"
#include "projects/calibrate/input/pose_lists.h"
#include "projects/calibrate/methods/camera_json.h"
#include "projects/calibrate/methods/methods.h"
#include "projects/calibrate/methods/stripe_frames.h"
#include "projects/file/stored_text.h"

namespace seamwright {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

// The pose that belongs to an image: the file of the same name, or the one with the same number
// ("frame0007.png" and "pose0007.txt", "images/7.png" and "poses/7.yaml").
std::optional<fs::path> pose_file_beside(const fs::path& image) {
    const std::string stem = image.stem().string();
    std::string digits;
    for (auto i = stem.rbegin(); i != stem.rend() && std::isdigit(static_cast<unsigned char>(*i)); ++i)
        digits.insert(digits.begin(), *i);
    std::error_code code;
    const fs::path folder = image.parent_path();
    for (const auto& where : {folder, folder.parent_path() / "poses"})
        for (const auto& name : {stem, "pose" + digits, digits})
            for (const char* extension : {".txt", ".yaml", ".yml", ".json"}) {
                const fs::path path = where / (name + extension);
                if (!name.empty() && fs::is_regular_file(path, code)) return path;
            }
    return std::nullopt;
}

Expected<std::vector<Eigen::Vector2d>> parse_pixels(const json& entry, const char* key,
                                                    const std::string& where) {
    auto list = json_array(entry, key, where);
    if (!list) return tl::unexpected(list.error());
    std::vector<Eigen::Vector2d> pixels;
    pixels.reserve((*list)->size());
    for (std::size_t i = 0; i < (*list)->size(); ++i) {
        auto uv = as_numbers((**list)[i], 2, json_path(json_path(where, key), i));
        if (!uv) return tl::unexpected(uv.error());
        pixels.emplace_back((*uv)[0], (*uv)[1]);
    }
    return pixels;
}

json pixels_json(const std::vector<Eigen::Vector2d>& pixels) {
    json list = json::array();
    for (const auto& p : pixels) list.push_back({p.x(), p.y()});
    return list;
}

Expected<FoundBoard> parse_found_board(const json& value, const BoardSpec& spec, const std::string& where) {
    FoundBoard board;
    auto pixels = parse_pixels(value, "pixel", where);
    if (!pixels) return tl::unexpected(pixels.error());
    board.pixel = std::move(*pixels);
    auto index = json_array(value, "index", where);
    if (!index) return tl::unexpected(index.error());
    for (std::size_t i = 0; i < (*index)->size(); ++i) {
        auto number = as_number((**index)[i], json_path(json_path(where, "index"), i));
        if (!number) return tl::unexpected(number.error());
        if (*number < 0 || *number >= spec.columns * spec.rows || *number != std::floor(*number))
            return input_error("this is no corner of the board", json_path(json_path(where, "index"), i));
        const int k = static_cast<int>(*number);
        board.index.push_back(k);
        board.object_mm.emplace_back(k % spec.columns * spec.pitch_mm, k / spec.columns * spec.pitch_mm, 0);
    }
    if (board.index.size() != board.pixel.size())
        return input_error("pixel and index have different lengths", where);
    auto symmetry = json_number_or(value, "symmetry", 1, where);
    if (!symmetry) return tl::unexpected(symmetry.error());
    board.symmetry = *symmetry == 2 || *symmetry == 4 ? static_cast<int>(*symmetry) : 1;
    auto detector = json_string_or(value, "detector", "", where);
    if (!detector) return tl::unexpected(detector.error());
    board.detector = *detector;
    return board;
}

// Residual of a frame that took no part: board under the solved camera, place of the target, stripe and laser
// plane.
void judge_excluded(const StripeCameraResult& solved, const StripeObservation& o, const BoardSpec& spec,
                    PoseResidual& pose) {
    if (!o.board) return;
    double least_deg = std::numeric_limits<double>::infinity();
    std::optional<Pose> camera_from_target;
    for (int turns = 0; turns < 4; turns += o.board->symmetry == 4 ? 1 : 2) {
        if (turns > 0 && o.board->symmetry == 1) break;
        const FoundBoard board = turns == 0 ? *o.board : turned(*o.board, spec, turns);
        const auto target = locate_target(solved.camera, {o.id, board.object_mm, board.pixel});
        if (!target) continue;
        pose.rms_px = target->rms_px;
        if (!camera_from_target) camera_from_target = target->camera_from_target;
        if (!o.base_from_flange || !solved.flange_from_camera) break;
        const Pose base_from_target =
            *o.base_from_flange * *solved.flange_from_camera * target->camera_from_target;
        const double deg = deg_from_rad(angle_rad(base_from_target, *solved.base_from_target));
        if (deg >= least_deg) continue;
        least_deg = deg;
        camera_from_target = target->camera_from_target;
        pose.deg = deg;
        pose.rms_mm = distance_mm(base_from_target, *solved.base_from_target);
    }
    if (!camera_from_target || !solved.plane || o.stripe.empty()) return;
    // Where the stripe's rays meet the plate, against the laser plane; the median passes over what is no
    // plate.
    const auto edge = outline(*o.board, spec);
    std::vector<double> off;
    const Eigen::Vector3d normal = camera_from_target->linear().col(2);
    for (const auto& p : o.stripe) {
        bool inside = edge.size() >= 3;
        double side = 0;
        for (std::size_t i = 0; i < edge.size() && inside; ++i) {
            const Eigen::Vector2d a = edge[i], b = edge[(i + 1) % edge.size()];
            const double cross = (b - a).x() * (p - a).y() - (b - a).y() * (p - a).x();
            if (side != 0 && cross * side < 0) inside = false;
            if (cross != 0) side = cross;
        }
        if (!inside) continue;
        const Eigen::Vector2d n = solved.camera.undistort(p);
        const Eigen::Vector3d ray(n.x(), n.y(), 1);
        const Eigen::Vector3d point = ray * (normal.dot(camera_from_target->translation()) / normal.dot(ray));
        if (point.allFinite())
            off.push_back(std::abs(solved.plane->normal.dot(point) + solved.plane->offset_mm));
    }
    if (off.empty()) return;
    const auto middle = off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2);
    std::nth_element(off.begin(), middle, off.end());
    pose.note = Text("excluded; stripe {:.2f} mm off the laser plane", *middle);
    if (std::isnan(pose.rms_mm)) pose.rms_mm = *middle;
}

}  // namespace

json stripe_frame_json(const StripeObservation& o) {
    json entry{{"id", o.id},
               {"size", {o.width, o.height}},
               {"scan", o.scan == ScanLines::rows ? "rows" : "columns"},
               {"board", nullptr},
               {"stripe", pixels_json(o.stripe)},
               {"base_from_flange", o.base_from_flange ? pose_json(*o.base_from_flange) : json(nullptr)}};
    if (o.board)
        entry["board"] = {{"pixel", pixels_json(o.board->pixel)},
                          {"index", o.board->index},
                          {"symmetry", o.board->symmetry},
                          {"detector", o.board->detector}};
    return entry;
}

Expected<StripeObservation> parse_stripe_frame(const json& entry, const BoardSpec& spec, std::size_t index,
                                               const std::string& where) {
    StripeObservation o;
    auto id = entry_id(entry, index, where);
    if (!id) return tl::unexpected(id.error());
    o.id = *id;
    auto size_field = json_field(entry, "size", where);
    if (!size_field) return tl::unexpected(size_field.error());
    auto size = as_numbers(**size_field, 2, json_path(where, "size"));
    if (!size) return tl::unexpected(size.error());
    if (!((*size)[0] >= 1 && (*size)[1] >= 1 && (*size)[0] <= 1e5 && (*size)[1] <= 1e5))
        return input_error("this is no image size", json_path(where, "size"),
                           "give [width, height] in pixels");
    o.width = static_cast<int>((*size)[0]);
    o.height = static_cast<int>((*size)[1]);
    auto scan = json_string_or(entry, "scan", "rows", where);
    if (!scan) return tl::unexpected(scan.error());
    if (*scan != "rows" && *scan != "columns")
        return input_error(Text("the scan '{}' is unknown", *scan), json_path(where, "scan"),
                           "write rows or columns");
    o.scan = *scan == "rows" ? ScanLines::rows : ScanLines::columns;
    if (const auto it = entry.find("board"); it != entry.end() && !it->is_null()) {
        auto board = parse_found_board(*it, spec, json_path(where, "board"));
        if (!board) return tl::unexpected(board.error());
        o.board = std::move(*board);
    }
    if (const auto it = entry.find("stripe"); it != entry.end() && !it->is_null()) {
        auto stripe = parse_pixels(entry, "stripe", where);
        if (!stripe) return tl::unexpected(stripe.error());
        o.stripe = std::move(*stripe);
    }
    if (const auto it = entry.find("base_from_flange"); it != entry.end() && !it->is_null()) {
        auto pose = parse_pose(*it, json_path(where, "base_from_flange"));
        if (!pose) return tl::unexpected(pose.error());
        o.base_from_flange = *pose;
    }
    return o;
}

json board_json(const BoardSpec& spec) {
    return {{"columns", spec.columns}, {"rows", spec.rows}, {"pitch_mm", spec.pitch_mm}};
}

Expected<BoardSpec> parse_board_json(const json& value, const std::string& where) {
    BoardSpec spec;
    for (auto [key, target] : {std::pair{"columns", &spec.columns}, std::pair{"rows", &spec.rows}}) {
        auto number = json_number(value, key, where);
        if (!number) return tl::unexpected(number.error());
        if (!(*number >= 0 && *number <= 1000)) return input_error("this is no count", json_path(where, key));
        *target = static_cast<int>(*number);
    }
    auto pitch = json_number(value, "pitch_mm", where);
    if (!pitch) return tl::unexpected(pitch.error());
    spec.pitch_mm = *pitch;
    if (auto ok = validate(spec); !ok) return tl::unexpected(ok.error());
    return spec;
}

namespace {

// Of a colour picture the stripe in the channel that shows it best; the plate is found in grey. nullopt: grey
// does.
using Stripe = std::pair<ScanLines, std::vector<Eigen::Vector2d>>;
Expected<std::optional<Stripe>> stripe_in_colour(const fs::path& path) {
    const auto choice = choose_channel(path);
    if (!choice) return tl::unexpected(choice.error());
    if (!choice->colour || choice->channel == ImageChannel::grey) return std::nullopt;
    Frame frame;
    if (auto read = read_image_file(path, frame, 0, choice->channel); !read)
        return tl::unexpected(read.error());
    PeakOptions options;
    const auto scan = guess_scan_lines(frame.image);
    if (!scan) return tl::unexpected(scan.error());
    options.scan = *scan;
    StripePeaks peaks;
    if (auto found = find_peaks(frame.image, options, peaks); !found) return tl::unexpected(found.error());
    Stripe stripe{*scan, {}};
    for (int line = 0; line < peaks.lines; ++line)
        for (int k = 0; k < peaks.count[static_cast<std::size_t>(line)]; ++k) {
            const auto i = static_cast<std::size_t>(peaks.index(line, k));
            if (!(peaks.flags[i] & StripePeaks::kTruncated))
                stripe.second.push_back(pixel_of(*scan, line, peaks.position_px[i]));
        }
    return stripe;
}

}  // namespace

Expected<StripeObservation> read_stripe_frame(const fs::path& path, const BoardSpec& spec) {
    Frame frame;
    if (auto read = read_image_file(path, frame); !read)
        return input_error(Text("the image cannot be read: {}", read.error().what), path.string(),
                           Text("exclude it with --exclude {}", path.stem().string()));
    StripeFrame f;
    f.id = path.stem().string();
    f.image = frame.image;
    if (const auto pose_file = pose_file_beside(path)) {
        auto pose = read_pose_file(*pose_file);
        if (!pose) {
            Error error = pose.error();
            error.kind = ErrorKind::input;
            return tl::unexpected(std::move(error));
        }
        f.base_from_flange = *pose;
    }
    StripeObservation o = observe(f, spec);
    if (auto stripe = stripe_in_colour(path); !stripe)
        return tl::unexpected(stripe.error());
    else if (*stripe)
        std::tie(o.scan, o.stripe) = std::move(**stripe);
    return o;
}

namespace {

struct ObservedFolder {
    BoardSpec spec;
    std::vector<fs::path> images;
    std::vector<StripeObservation> observations;  // one an image
};

Expected<ObservedFolder> observe_folder(const std::string& directory, const std::string& board,
                                        double pitch_mm, const std::vector<std::string>& exclude) {
    auto spec = parse_board(board, pitch_mm, "chessboard");
    if (!spec) return tl::unexpected(spec.error());
    auto images = plate_images(directory, exclude);
    if (!images) return tl::unexpected(images.error());
    std::vector<StripeObservation> observations;
    for (const auto& path : *images) {
        auto read = read_stripe_frame(path, *spec);
        if (!read) return tl::unexpected(read.error());
        if (!observations.empty() &&
            (read->width != observations.front().width || read->height != observations.front().height))
            return input_error("the images have different sizes", path.string(),
                               "give frames of one camera at one resolution");
        observations.push_back(std::move(*read));
    }
    return ObservedFolder{*spec, std::move(*images), std::move(observations)};
}

}  // namespace

Expected<CalibrateOutcome> calibrate_stripe_camera_folder(const std::string& directory,
                                                          const std::string& board, double pitch_mm,
                                                          const std::vector<std::string>& exclude) {
    const auto folder = observe_folder(directory, board, pitch_mm, exclude);
    if (!folder) return tl::unexpected(folder.error());
    return calibrate_stripe_frames(folder->observations, folder->spec, {});
}

Expected<json> stripe_folder_data(const std::string& directory, const std::string& board, double pitch_mm,
                                  const std::vector<std::string>& exclude) {
    const auto folder = observe_folder(directory, board, pitch_mm, exclude);
    if (!folder) return tl::unexpected(folder.error());
    json frames = json::array();
    for (std::size_t i = 0; i < folder->images.size(); ++i) {
        const StripeObservation& o = folder->observations[i];
        frames.push_back(stripe_frame_json(o));
        const auto file = pose_file_beside(folder->images[i]);
        if (!o.base_from_flange || !file || file->extension() == ".json") continue;
        const PoseNumbers n = write_pose(*o.base_from_flange, {.rotation = RotationReading::quat_wxyz});
        frames.back()["base_from_flange"] = {
            {"xyz", {n.position.x(), n.position.y(), n.position.z()}},
            {"quat_wxyz", {n.rotation[0], n.rotation[1], n.rotation[2], n.rotation[3]}}};
    }
    return json{{"board", board_json(folder->spec)}, {"frames", frames}};
}

Expected<StripeData> parse_stripe_data(const json& data) {
    if (!data.is_object())
        return input_error("the data is not a JSON object", "", "see calibrate stripe-camera --help");
    auto board = json_field(data, "board", "");
    if (!board) return tl::unexpected(board.error());
    auto spec = parse_board_json(**board, "board");
    if (!spec) return tl::unexpected(spec.error());
    auto list = json_array(data, "frames", "");
    if (!list) return tl::unexpected(list.error());
    StripeData set{*spec, {}};
    for (std::size_t i = 0; i < (*list)->size(); ++i) {
        auto o = parse_stripe_frame((**list)[i], *spec, i, json_path("frames", i));
        if (!o) return tl::unexpected(o.error());
        set.observations.push_back(std::move(*o));
    }
    return set;
}

Expected<CalibrateOutcome> calibrate_stripe_camera_json(const json& data,
                                                        const std::vector<std::string>& exclude) {
    auto meant = with_usual_poses("stripe-camera", data);
    if (!meant) return tl::unexpected(meant.error());
    auto set = parse_stripe_data(meant->data());
    if (!set) return tl::unexpected(set.error());
    auto outcome = calibrate_stripe_frames(set->observations, set->spec, exclude);
    if (outcome) meant->put(outcome->result);
    return outcome;
}

Expected<CalibrateOutcome> calibrate_stripe_frames(const std::vector<StripeObservation>& observations,
                                                   const BoardSpec& spec,
                                                   const std::vector<std::string>& exclude) {
    StripeCameraOptions options;
    options.exclude = exclude;
    auto solved = calibrate_stripe_camera(observations, spec, options);
    if (!solved) return tl::unexpected(solved.error());

    CalibrateOutcome outcome;
    json& result = outcome.result;
    const Verdict verdict = solved->report.judgement.verdict;
    const bool known = verdict != Verdict::undetermined;
    result["method"] = "stripe-camera";
    result["status"] = known ? "ok" : "undetermined";
    result["images"] = observations.size();
    result["poses"] = std::count_if(observations.begin(), observations.end(), [](const StripeObservation& o) {
        return o.base_from_flange.has_value();
    });
    result["boards_found"] = solved->boards_found;
    result["camera"] = known ? camera_json(solved->camera) : json(nullptr);
    result["reprojection_rms_px"] = number_json(solved->rms_px);
    const bool plane = known && solved->plane;
    result["laser_plane"] = json(nullptr);
    if (plane)
        result["laser_plane"] = {{"normal", vector_json(solved->plane->normal)},
                                 {"distance_mm", solved->plane_distance_mm},
                                 {"sigma_deg", number_json(solved->plane_sigma_deg)},
                                 {"sigma_mm", number_json(solved->plane_sigma_mm)}};
    result["camera_from_laser"] = plane ? pose_json(solved->camera_from_laser) : json(nullptr);
    result["on_plane_share"] = plane ? number_json(solved->on_plane_share) : json(nullptr);
    result["on_plane_share_all_frames"] = plane ? number_json(solved->on_plane_share_all) : json(nullptr);
    result["plane_rms_mm"] = plane ? number_json(solved->plane_rms_mm) : json(nullptr);
    result["hand_eye"] = json(nullptr);
    if (known && solved->flange_from_camera)
        result["hand_eye"] = {
            {"flange_from_camera", pose_json(*solved->flange_from_camera)},
            {"base_from_target", pose_json(*solved->base_from_target)},
            {"sigma", pose_sigma_json(*solved->flange_from_camera, solved->flange_from_camera_covariance)},
            {"covariance_pose", matrix_json(solved->flange_from_camera_covariance)},
            {"target_spread_mm", solved->target_spread_mm},
            {"target_spread_max_mm", solved->target_spread_max_mm}};
    static constexpr const char* shapes[] = {"rigid", "in-plane", "bowed"};
    result["plate"] = {{"shape", shapes[static_cast<int>(solved->shape_freedom)]},
                       {"stretch", solved->shape.stretch},
                       {"shear", solved->shape.shear},
                       {"bow_mm", vector_json(solved->shape.bow_mm)}};
    json frames = json::array();
    for (std::size_t i = 0; i < solved->frames.size(); ++i) {
        const auto& f = solved->frames[i];
        frames.push_back(
            {{"id", f.id},
             {"board_found", f.board_found},
             {"detector", observations[i].board ? json(observations[i].board->detector) : json(nullptr)},
             {"stripe_used", f.stripe_used},
             {"rows_on_board", f.rows_on_board},
             {"rows_on_plane", f.rows_on_plane},
             {"off_plane_mm", number_json(f.median_off_plane_mm)},
             {"camera_from_target", f.used ? pose_json(f.camera_from_target) : json(nullptr)}});
        put_text(frames.back(), "note", f.note);
    }
    result["frames"] = std::move(frames);
    for (std::size_t i = 0; known && i < observations.size(); ++i)
        if (std::count(exclude.begin(), exclude.end(), observations[i].id) > 0)
            judge_excluded(*solved, observations[i], spec, solved->report.poses[i]);
    add_report(solved->report, result);
    if (!known)
        for (auto& p : result["parameters"]) p["value"] = p["sigma"] = nullptr;
    outcome.exit_code = exit_code_for(verdict);
    return outcome;
}

}  // namespace seamwright
