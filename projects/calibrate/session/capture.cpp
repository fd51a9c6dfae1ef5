#include "projects/calibrate/session/capture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/calibration/board/board.h"
#include "core/calibration/camera/camera.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/input/entry.h"
#include "projects/calibrate/input/plate_images.h"
#include "projects/calibrate/input/sphere_data.h"
#include "projects/calibrate/input/stripe_line_points.h"
#include "projects/calibrate/methods/cameras/stripe_frames.h"
#include "projects/calibrate/session/apex_pair.h"
#include "projects/calibrate/session/capture_file.h"
#include "projects/calibrate/session/sphere_sight.h"
#include "projects/calibrate/solution/camera_json.h"
#include "projects/measure/measure.h"
#include "projects/station/acquire.h"

namespace seamwright {
namespace {

using nlohmann::json;

constexpr int kLeastLinePoints = 200;
constexpr std::size_t kDrawnPoints = 160;

double radius_of(const json& settings) {
    const auto it = settings.find("radius_mm");
    return it != settings.end() && it->is_number() ? it->get<double>() : 0;
}

Expected<json> sphere_entry(const json& settings, const SensorSetup& sensor, const Calibration* base,
                            const Frame& frame, const Pose& base_from_flange) {
    StripePeaks peaks;
    Capture capture;
    Text reason;
    if (capture_frame(frame, sensor.peaks, base && base->model ? &*base->model : nullptr, peaks, capture,
                      reason) != SpotStatus::measured)
        return input_error(
            reason, Text("sensor {}", sensor.id),
            base ? "bring the stripe onto the sphere" : "calibrate camera and laser plane first");
    Profile profile;
    SEAM_OK(track_capture(capture, sensor.filter, profile));
    // Which way a device counts that delivers profiles is its own.
    SEAM_OK(sphere_in_profile(profile, radius_of(settings), frame.profile.size() > 0,
                              Text("sensor {}", sensor.id)));
    json points = json::array();
    for (std::size_t i = 0; i < profile.size(); ++i)
        if (!std::isnan(profile.x_mm[i]) && !std::isnan(profile.z_mm[i]))
            points.push_back({profile.x_mm[i], profile.z_mm[i]});
    return json{{"base_from_flange", pose_json(base_from_flange)}, {"profile", std::move(points)}};
}

Error no_board(const BoardSpec& spec, const BoardMiss& miss, const Text& where) {
    return {ErrorKind::input, why_missed(spec, miss), where, cure_of(miss)};
}

Expected<BoardSpec> board_of(const json& settings) {
    SEAM_TRY(auto field, json_field(settings, "board", ""));
    return parse_board_json(*field, "board");
}

Expected<json> stripe_entry(const json& settings, const SensorSetup& sensor, const Frame& stripe,
                            const Frame* board, const std::optional<Pose>& base_from_flange) {
    SEAM_TRY(auto spec, board_of(settings));
    StripeObservation o;
    if (board) {
        o.width = stripe.image.width;
        o.height = stripe.image.height;
        o.scan = ScanLines::columns;
        BoardSearch search = find_board(board->image, spec);
        o.board = std::move(search.board);
        o.miss = search.miss;
        StripePeaks peaks;
        SEAM_TRY(auto points, stripe_points(stripe.image, peaks));
        o.stripe = std::move(points);
    } else {
        o = observe({"", stripe.image, base_from_flange}, spec);
    }
    o.base_from_flange = base_from_flange;
    if (!o.board) return tl::unexpected(no_board(spec, o.miss, Text("sensor {}", sensor.id)));
    return stripe_frame_json(o);
}

// A view of a board as calibrate camera takes it, with its outline for thumbnails.
json view_json(const FoundBoard& board, const BoardSpec& spec) {
    json points = json::array(), around = json::array();
    for (std::size_t i = 0; i < board.pixel.size(); ++i)
        points.push_back(
            {{"object", vector_json(board.object_mm[i])}, {"pixel", vector_json(board.pixel[i])}});
    for (const Eigen::Vector2d& p : outline(board, spec)) around.push_back({p.x(), p.y()});
    return {{"points", std::move(points)}, {"outline", std::move(around)}};
}

// For thumbnails: where the board is in the picture.
void note_outline(json& entry, const Calibration& base, const FoundBoard& board, const BoardSpec& spec) {
    entry["size"] = {base.model->camera.width, base.model->camera.height};
    entry["outline"] = json::array();
    for (const Eigen::Vector2d& p : outline(board, spec)) entry["outline"].push_back({p.x(), p.y()});
}

Expected<json> board_entry(const Text& where, const Calibration* base, const BoardSearch& search,
                           const BoardSpec& spec, const std::optional<Pose>& base_from_flange) {
    if (!base || !base->model)
        return input_error("the camera is not known", where, "calibrate camera and laser plane first");
    if (!search.board) return tl::unexpected(no_board(spec, search.miss, where));
    const FoundBoard& board = *search.board;
    if (!base_from_flange)
        return input_error("the robot's pose is missing", where,
                           "connect the robot, or put its pose file beside the image");
    SEAM_TRY(auto target, locate_target(base->model->camera, {"", board.object_mm, board.pixel}));
    json entry{{"base_from_flange", pose_json(*base_from_flange)},
               {"camera_from_target", pose_json(target.camera_from_target)}};
    note_outline(entry, *base, board, spec);
    return entry;
}

// The corners that were found farthest out on the board, one in each diagonal direction: part of it may be hidden.
std::array<std::size_t, 4> outer_corners(const FoundBoard& board) {
    std::array<std::size_t, 4> outer{};
    for (std::size_t k = 0; k < outer.size(); ++k) {
        const double right = k % 2 == 0 ? -1 : 1, down = k < 2 ? -1 : 1;
        for (std::size_t i = 1; i < board.object_mm.size(); ++i) {
            const Eigen::Vector3d ahead = board.object_mm[i] - board.object_mm[outer[k]];
            if (right * ahead.x() + down * ahead.y() > 0) outer[k] = i;
        }
    }
    return outer;
}

// Outer corners of the board, on it and in the robot's base.
Expected<json> plate_entry(const Text& where, const Calibration* base, const BoardSearch& search,
                           const BoardSpec& spec, const std::optional<Pose>& base_from_flange) {
    auto seen = board_entry(where, base, search, spec, base_from_flange);
    if (!seen) return seen;
    if (base->flange_from_sensor.isApprox(Pose::Identity()))
        return input_error("where the camera sits on the flange is not known", where,
                           "calibrate hand-eye or with the sphere first, or load measured points");
    const Pose flange_from_camera = base->flange_from_sensor * base->model->camera_from_laser.inverse();
    const auto camera_from_target = parse_pose((*seen)["camera_from_target"], "camera_from_target");
    const Pose base_from_target = *base_from_flange * flange_from_camera * *camera_from_target;
    json points = json::array();
    for (const std::size_t i : outer_corners(*search.board)) {
        const Eigen::Vector3d on_plate = search.board->object_mm[i];
        const Eigen::Vector3d world = base_from_target * on_plate;
        points.push_back({{"plate", {on_plate.x(), on_plate.y(), on_plate.z()}},
                          {"world", {world.x(), world.y(), world.z()}}});
    }
    return json{{"points", std::move(points)},
                {"base_from_flange", pose_json(*base_from_flange)},
                {"outline", (*seen)["outline"]},
                {"size", (*seen)["size"]}};
}

// One shot: the chain ends on the flange, where it stood when the first sensor was shot.
Expected<json> chain_entry(json& settings, const Text& where, const Calibration* base,
                           const BoardSearch& search, const BoardSpec& spec,
                           const std::optional<Pose>& base_from_flange) {
    if (!settings.contains("world_from_plate"))
        return input_error("where the plate stands is not known", where,
                           "find it with \"Plate in the world\" first, or load the chain");
    auto seen = board_entry(where, base, search, spec, base_from_flange);
    if (!seen) return seen;
    const auto reference = settings.find("reference_from_world");
    if (reference == settings.end()) {
        settings["reference_from_world"] = pose_json(base_from_flange->inverse());
    } else {
        // A file may give it with its covariance.
        const auto before = parse_pose(reference->contains("pose") ? (*reference)["pose"] : *reference,
                                       "reference_from_world");
        constexpr double kSameMm = 0.05, kSameDeg = 0.01;
        if (before && (distance_mm(before->inverse(), *base_from_flange) > kSameMm ||
                       angle_rad(before->inverse(), *base_from_flange) > rad_from_deg(kSameDeg)))
            return input_error("the robot has moved since the first shot", where,
                               "one shot is enough: begin anew to take another from here");
    }
    return json{{"world_from_plate", settings["world_from_plate"]},
                {"camera_from_plate", (*seen)["camera_from_target"]},
                {"camera_from_laser", pose_json(base->model->camera_from_laser)},
                {"outline", (*seen)["outline"]},
                {"size", (*seen)["size"]}};
}

// The board's points in one sensor's picture, and where its camera stands in the robot's base.
Expected<json> sights_entry(const Text& where, const Calibration* base, const BoardSearch& search,
                            const BoardSpec& spec, const std::optional<Pose>& base_from_flange) {
    auto seen = board_entry(where, base, search, spec, base_from_flange);
    if (!seen) return seen;
    if (base->flange_from_sensor.isApprox(Pose::Identity()))
        return input_error("where the camera sits on the flange is not known", where,
                           "calibrate hand-eye or with the sphere first");
    const UncertainPose laser{base->flange_from_sensor, base->covariance};
    const UncertainPose camera =
        laser * UncertainPose{base->model->camera_from_laser.inverse(), Matrix6::Zero()};
    const UncertainPose placed = UncertainPose{*base_from_flange, Matrix6::Zero()} * camera;
    json sights = json::array();
    for (std::size_t i = 0; i < search.board->pixel.size(); ++i)
        sights.push_back({{"object", vector_json(search.board->object_mm[i])},
                          {"pixel", vector_json(search.board->pixel[i])}});
    return json{{"camera", camera_json(base->model->camera)},
                {"world_from_camera",
                 {{"pose", pose_json(placed.pose)}, {"covariance", matrix_json(placed.covariance)}}},
                {"sights", std::move(sights)},
                {"outline", (*seen)["outline"]},
                {"size", (*seen)["size"]}};
}

// A method that works on pixels learns the image's size from its first capture.
Expected<void> note_size(json& settings, const SensorSetup& sensor, const Frame& frame) {
    const json size = {frame.image.width, frame.image.height};
    if (settings.contains("size") && settings["size"] != size)
        return input_error("the image has another size than those before", Text("sensor {}", sensor.id),
                           "use one camera at one resolution");
    settings["size"] = size;
    return {};
}

Expected<json> view_entry(json& settings, const SensorSetup& sensor, const Frame& frame,
                          const BoardSpec& spec) {
    SEAM_OK(note_size(settings, sensor, frame));
    const BoardSearch search = find_board(frame.image, spec);
    if (!search.board) return tl::unexpected(no_board(spec, search.miss, Text("sensor {}", sensor.id)));
    return view_json(*search.board, spec);
}

Expected<json> line_entry(json& settings, const SensorSetup& sensor, const Frame& frame) {
    SEAM_OK(note_size(settings, sensor, frame));
    StripePeaks peaks;
    SEAM_TRY(auto points, stripe_points(frame.image, peaks));
    const auto line = on_the_plate(std::move(points));
    if (line.size() < kLeastLinePoints)
        return input_error(Text("only {} points of the stripe lie on one line", line.size()),
                           Text("sensor {}", sensor.id),
                           "hold the sensor over a flat plate that fills the view");
    json entry = json::array();
    for (const auto& p : line) entry.push_back({p.x(), p.y()});
    return entry;
}

}  // namespace

Expected<TakenCapture> capture_shot(const CalibrationMethod& method, const json& settings,
                                    const SensorSetup& sensor, const Calibration* base, const Frame& stripe,
                                    const Frame* board, const std::optional<Pose>& base_from_flange) {
    const Text where("sensor {}", sensor.id);
    for (const Frame* frame : {&stripe, board})
        if (method.capture != CaptureKind::touch && frame && frame->status != FrameStatus::ok)
            return input_error(Text("the frame is {}", to_string(frame->status)), where, "take it again");
    const bool image = method.capture != CaptureKind::sphere_profile && method.capture != CaptureKind::touch;
    if (image && stripe.image.empty())
        return input_error("the sensor gives no image", where, "switch its raw image on");
    if (method.robot && method.capture != CaptureKind::board_and_stripe && !base_from_flange)
        return input_error("the robot does not tell its pose", "robot", "connect the robot");
    TakenCapture taken;
    taken.settings = settings;
    Expected<json> entry = json();
    switch (method.capture) {
        case CaptureKind::sphere_profile:
            entry = sphere_entry(settings, sensor, base, stripe, *base_from_flange);
            break;
        case CaptureKind::board_and_stripe:
            entry = stripe_entry(settings, sensor, stripe, board, base_from_flange);
            break;
        case CaptureKind::board_pose:
        case CaptureKind::board_points:
        case CaptureKind::board_chain:
        case CaptureKind::board_sights: {
            SEAM_TRY(auto spec, board_of(settings));
            const auto found = find_board((board ? *board : stripe).image, spec);
            entry = method.capture == CaptureKind::board_pose
                        ? board_entry(where, base, found, spec, base_from_flange)
                    : method.capture == CaptureKind::board_sights
                        ? sights_entry(where, base, found, spec, base_from_flange)
                    : method.capture == CaptureKind::board_points
                        ? plate_entry(where, base, found, spec, base_from_flange)
                        : chain_entry(taken.settings, where, base, found, spec, base_from_flange);
            break;
        }
        case CaptureKind::board_view: {
            SEAM_TRY(auto spec, board_of(settings));
            entry = view_entry(taken.settings, sensor, board ? *board : stripe, spec);
            break;
        }
        case CaptureKind::stripe_line:
            entry = line_entry(taken.settings, sensor, stripe);
            break;
        case CaptureKind::apex:
            SEAM_OK(note_size(taken.settings, sensor, stripe));
            entry = apex_pair(taken.settings, sensor, base, stripe, base_from_flange);
            break;
        case CaptureKind::touch:
            entry = json{{"base_from_flange", pose_json(*base_from_flange)}};
            break;
        case CaptureKind::files:
            return usage_error("the data of this method are loaded from a file", method.id);
    }
    if (!entry) return tl::unexpected(entry.error());
    taken.capture.entry = std::move(*entry);
    taken.capture.base_from_flange = base_from_flange;
    taken.capture.origin = "live";
    // Of several sensors at once, each is called after its own.
    if (of_all_sensors(method.capture)) taken.capture.id = sensor.id;
    return taken;
}

bool reads_images(const CalibrationMethod& method) {
    return method.capture == CaptureKind::board_and_stripe || method.capture == CaptureKind::board_pose ||
           method.capture == CaptureKind::board_view;
}

Expected<ReadCaptures> read_captures(const CalibrationMethod& method, const json& settings,
                                     const Calibration* base, const std::filesystem::path& path,
                                     const ReadProgress& progress, const std::stop_token& cancel) {
    std::error_code code;
    if (!std::filesystem::is_directory(path, code)) return read_capture_file(method, settings, path);
    if (!reads_images(method))
        return input_error("this method reads no images", path.string(), "give its JSON file");
    SEAM_TRY(auto spec, board_of(settings));
    SEAM_TRY(auto images, plate_images(path, {}));
    ReadCaptures read;
    read.settings = settings;
    std::optional<std::pair<int, int>> size;
    for (std::size_t i = 0; i < images.size(); ++i) {
        if (cancel.stop_requested()) return input_error(kCancelled, path.string());
        const auto& image = images[i];
        SEAM_TRY(auto o, read_stripe_frame(image, spec));
        if (size && *size != std::pair(o.width, o.height))
            return input_error("the images have different sizes", image.string(),
                               "give frames of one camera at one resolution");
        size = {o.width, o.height};
        CalibrationCapture c;
        c.id = image.stem().string();
        c.origin = c.picture = std::filesystem::absolute(image, code).string();
        c.base_from_flange = o.base_from_flange;
        if (method.capture == CaptureKind::board_and_stripe) {
            c.entry = stripe_frame_json(o);
            read.captures.push_back(std::move(c));
        } else if (method.capture == CaptureKind::board_view) {
            read.settings["size"] = {o.width, o.height};
            if (o.board) {
                c.entry = view_json(*o.board, spec);
                read.captures.push_back(std::move(c));
            } else {
                read.skipped.push_back(no_board(spec, o.miss, c.id).text());
            }
        } else if (auto entry = board_entry(c.id, base, {o.board, o.miss}, spec, o.base_from_flange)) {
            c.entry = std::move(*entry);
            read.captures.push_back(std::move(c));
        } else {
            read.skipped.push_back(entry.error().text());
        }
        if (progress) progress(static_cast<int>(i) + 1, static_cast<int>(images.size()));
    }
    if (read.captures.empty())
        return input_error(read.skipped.empty() ? Text("nothing was read") : read.skipped.front(),
                           path.string());
    return read;
}

namespace {

std::vector<Eigen::Vector2d> pixels_of(const json& list) {
    std::vector<Eigen::Vector2d> points;
    if (!list.is_array()) return points;
    for (const json& p : list)
        if (p.is_array() && p.size() == 2 && p[0].is_number() && p[1].is_number())
            points.emplace_back(p[0].get<double>(), p[1].get<double>());
    return points;
}

std::vector<Eigen::Vector2d> thinned(const std::vector<Eigen::Vector2d>& all) {
    std::vector<Eigen::Vector2d> few;
    const std::size_t step = std::max<std::size_t>(1, all.size() / kDrawnPoints);
    for (std::size_t i = 0; i < all.size(); i += step) few.push_back(all[i]);
    return few;
}

void image_size(const json& holder, EntryPicture& picture) {
    const auto it = holder.find("size");
    if (it == holder.end() || !it->is_array() || it->size() != 2 || !(*it)[0].is_number()) return;
    picture.width = static_cast<int>((*it)[0].get<double>());
    picture.height = static_cast<int>((*it)[1].get<double>());
}

}  // namespace

EntryPicture entry_picture(const CalibrationMethod& method, const json& settings, const json& entry) {
    EntryPicture picture;
    if (method.capture == CaptureKind::sphere_profile) {
        auto o = parse_sphere_observation(entry, 0, "");
        if (!o) return picture;
        std::vector<Eigen::Vector2d> all;
        for (std::size_t i = 0; i < o->profile.size(); ++i)
            if (!std::isnan(o->profile.x_mm[i]) && !std::isnan(o->profile.z_mm[i]))
                all.emplace_back(o->profile.x_mm[i], o->profile.z_mm[i]);
        picture.points = thinned(all);
        if (const auto circle = sphere_in_profile(o->profile, radius_of(settings), true, "")) {
            picture.circle = {circle->x_mm, circle->z_mm, circle->radius_mm};
            std::vector<Eigen::Vector2d> arc;
            for (const int i : circle->inliers)
                arc.emplace_back(o->profile.x_mm[static_cast<std::size_t>(i)],
                                 o->profile.z_mm[static_cast<std::size_t>(i)]);
            picture.outline = thinned(arc);
        }
        return picture;
    }
    picture.pixels = true;
    if (method.capture == CaptureKind::board_and_stripe) {
        image_size(entry, picture);
        picture.points = thinned(pixels_of(entry.value("stripe", json())));
        auto spec = board_of(settings);
        auto o = spec ? parse_stripe_frame(entry, *spec, 0, "") : tl::unexpected(spec.error());
        if (o && o->board) {
            picture.outline = outline(*o->board, *spec);
            picture.points.insert(picture.points.end(), o->board->pixel.begin(), o->board->pixel.end());
        }
    } else if (method.capture == CaptureKind::stripe_line) {
        image_size(settings, picture);
        picture.points = thinned(pixels_of(entry));
        picture.outline = picture.points;
    } else if (entry.is_object() && entry.contains("pixel")) {
        image_size(settings, picture);
        if (picture.width == 0 && settings.contains("camera")) {
            if (auto camera = parse_camera(settings["camera"], "camera")) {
                picture.width = camera->width;
                picture.height = camera->height;
            }
        }
        picture.points = pixels_of(json::array({entry["pixel"]}));
        picture.outline = pixels_of(entry.value("flanks", json()));
    } else if (entry.is_object() && entry.contains("outline")) {
        image_size(method.capture == CaptureKind::board_view ? settings : entry, picture);
        picture.outline = picture.points = pixels_of(entry["outline"]);
    } else {
        picture.pixels = false;
    }
    return picture;
}

}  // namespace seamwright
