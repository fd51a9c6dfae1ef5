#include <algorithm>
#include <cmath>

#include "core/calibration/camera/camera.h"
#include "devices/exchange/image_file.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/input/plate_images.h"
#include "projects/calibrate/methods/camera_json.h"
#include "projects/calibrate/methods/methods.h"

namespace seamwright {

using nlohmann::json;

json camera_json(const CameraModel& c) {
    return {{"fx", c.fx}, {"fy", c.fy}, {"cx", c.cx}, {"cy", c.cy},       {"k1", c.k1},        {"k2", c.k2},
            {"p1", c.p1}, {"p2", c.p2}, {"k3", c.k3}, {"width", c.width}, {"height", c.height}};
}

Expected<CameraModel> parse_camera(const json& data, const std::string& where) {
    CameraModel c;
    for (auto [key, target] : {std::pair{"fx", &c.fx}, {"fy", &c.fy}, {"cx", &c.cx}, {"cy", &c.cy}}) {
        auto value = json_number(data, key, where);
        if (!value) return tl::unexpected(value.error());
        *target = *value;
    }
    for (auto [key, target] :
         {std::pair{"k1", &c.k1}, {"k2", &c.k2}, {"p1", &c.p1}, {"p2", &c.p2}, {"k3", &c.k3}}) {
        auto value = json_number_or(data, key, 0, where);
        if (!value) return tl::unexpected(value.error());
        *target = *value;
    }
    if (!(c.fx > 0) || !(c.fy > 0))
        return input_error("a focal length must be positive", where, "give fx and fy in pixels");
    auto width = json_number_or(data, "width", std::ceil(2 * std::abs(c.cx)) + 1, where);
    auto height = json_number_or(data, "height", std::ceil(2 * std::abs(c.cy)) + 1, where);
    if (!width) return tl::unexpected(width.error());
    if (!height) return tl::unexpected(height.error());
    c.width = static_cast<int>(std::clamp(*width, 1.0, 1e6));
    c.height = static_cast<int>(std::clamp(*height, 1.0, 1e6));
    return c;
}

namespace {

Expected<CalibrateOutcome> solve(const CameraData& data, const std::vector<std::string>& exclude,
                                 json result) {
    CameraOptions options;
    options.exclude = exclude;
    auto solved = calibrate_camera(data, options);
    if (!solved) return tl::unexpected(solved.error());
    CalibrateOutcome outcome;
    const bool known = solved->report.judgement.verdict != Verdict::undetermined;
    result["method"] = "camera";
    result["status"] = known ? "ok" : "undetermined";
    result["camera"] = known ? camera_json(solved->camera) : json(nullptr);
    result["reprojection_rms_px"] = number_json(solved->rms_px);
    result["sigma_px"] = number_json(solved->sigma_px);
    result["covered_share"] = number_json(solved->covered_share);
    json views = json::array();
    for (std::size_t i = 0; i < data.views.size(); ++i)
        views.push_back(
            {{"id", data.views[i].id},
             {"camera_from_target", known ? pose_json(solved->camera_from_target[i]) : json(nullptr)},
             {"sigma", pose_sigma_json(solved->camera_from_target[i], solved->pose_covariance[i])}});
    result["views"] = std::move(views);
    add_report(solved->report, result);
    if (!known)
        for (auto& p : result["parameters"]) p["value"] = p["sigma"] = nullptr;
    outcome.exit_code = exit_code_for(solved->report.judgement.verdict);
    outcome.result = std::move(result);
    return outcome;
}

}  // namespace

Expected<CalibrateOutcome> calibrate_camera_json(const json& data, const std::vector<std::string>& exclude) {
    if (!data.is_object())
        return input_error("the data is not a JSON object", "", "see calibrate camera --help");
    auto size_field = json_field(data, "size", "");
    if (!size_field) return tl::unexpected(size_field.error());
    auto size = as_numbers(**size_field, 2, "size");
    if (!size) return tl::unexpected(size.error());
    if ((*size)[0] < 1 || (*size)[1] < 1 || (*size)[0] > 1e5 || (*size)[1] > 1e5)
        return input_error("this is no image size", "size", "give [width, height] in pixels");
    CameraData camera;
    camera.width = static_cast<int>((*size)[0]);
    camera.height = static_cast<int>((*size)[1]);
    auto views = json_array(data, "views", "");
    if (!views) return tl::unexpected(views.error());
    for (std::size_t i = 0; i < (*views)->size(); ++i) {
        const json& entry = (**views)[i];
        const std::string where = json_path("views", i);
        CameraPoints view;
        auto id = entry_id(entry, i, where);
        if (!id) return tl::unexpected(id.error());
        view.id = *id;
        auto points = json_array(entry, "points", where);
        if (!points) return tl::unexpected(points.error());
        for (std::size_t k = 0; k < (*points)->size(); ++k) {
            const std::string at = json_path(json_path(where, "points"), k);
            auto object = json_vector3((**points)[k], "object", at);
            if (!object) return tl::unexpected(object.error());
            auto pixel = json_vector2((**points)[k], "pixel", at);
            if (!pixel) return tl::unexpected(pixel.error());
            view.object_mm.push_back(*object);
            view.pixel.push_back(*pixel);
        }
        camera.views.push_back(std::move(view));
    }
    return solve(camera, exclude, json::object());
}

Expected<CalibrateOutcome> calibrate_camera_folder(const std::string& directory, const std::string& board,
                                                   double pitch_mm, const std::string& pattern,
                                                   const std::vector<std::string>& exclude) {
    auto spec = parse_board(board, pitch_mm, pattern);
    if (!spec) return tl::unexpected(spec.error());
    auto images = plate_images(directory, exclude);
    if (!images) return tl::unexpected(images.error());
    CameraData data;
    json missed = json::array();
    for (const auto& path : *images) {
        Frame frame;
        if (auto read = read_image_file(path, frame); !read)
            return input_error(Text("the image cannot be read: {}", read.error().what), path.string(),
                               Text("exclude it with --exclude {}", path.stem().string()));
        if (data.width == 0) {
            data.width = frame.image.width;
            data.height = frame.image.height;
        } else if (data.width != frame.image.width || data.height != frame.image.height) {
            return input_error("the images have different sizes", path.string(),
                               "give images of one camera at one resolution");
        }
        if (auto found = find_board(frame.image, *spec))
            data.views.push_back({path.stem().string(), found->object_mm, found->pixel});
        else
            missed.push_back(path.stem().string());
    }
    if (data.views.empty())
        return input_error(Text("no board of {} points was found in any of {} images", board,
                                std::to_string(images->size())),
                           directory, "check --board, --pattern, light and focus");
    json result{
        {"images", images->size()}, {"boards_found", data.views.size()}, {"not_found", std::move(missed)}};
    return solve(data, {}, std::move(result));
}

}  // namespace seamwright
