// {"size":[w,h],"views":[{"id"?,"points":[{"object":[3],"pixel":[2]}]}],"not_found":[id,..]? (images without a board)} ->
// {"status","camera","reprojection_rms_px","sigma_px","covered_share","views":[{"id","camera_from_target","sigma"}],
//     "images"?,"boards_found"?,"not_found"?,...}

#include <algorithm>
#include <cmath>

#include "core/calibration/camera/camera.h"
#include "devices/exchange/image_file.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/input/entry.h"
#include "projects/calibrate/input/plate_images.h"
#include "projects/calibrate/methods/example/example_cell.h"
#include "projects/calibrate/methods/methods.h"
#include "projects/calibrate/solution/camera_json.h"

namespace seamwright {

using nlohmann::json;

namespace {

Expected<CameraData> parse_views(const json& written) {
    SEAM_TRY(auto size, image_size_of(written, ""));
    CameraData data;
    data.width = size.first;
    data.height = size.second;
    SEAM_TRY(auto views, json_array(written, "views", ""));
    for (std::size_t i = 0; i < views->size(); ++i) {
        const json& entry = (*views)[i];
        const std::string where = json_path("views", i);
        CameraPoints view;
        SEAM_TRY(auto id, entry_id(entry, i, where));
        view.id = id;
        SEAM_TRY(auto points, json_array(entry, "points", where));
        for (std::size_t k = 0; k < points->size(); ++k) {
            const std::string at = json_path(json_path(where, "points"), k);
            SEAM_TRY(auto object, json_vector3((*points)[k], "object", at));
            SEAM_TRY(auto pixel, json_vector2((*points)[k], "pixel", at));
            view.object_mm.push_back(object);
            view.pixel.push_back(pixel);
        }
        data.views.push_back(std::move(view));
    }
    return data;
}

Expected<CalibrationSolution> solve_camera(const json& written, const ExcludedIds& exclude) {
    SEAM_TRY(auto data, parse_views(written));
    CameraOptions options;
    options.exclude = exclude;
    SEAM_TRY(auto solved, calibrate_camera(data, options));

    CalibrationSolution solution;
    json& result = solution.document;
    const bool known = solved.report.judgement.verdict != Verdict::undetermined;
    if (known) solution.found = CameraAndLaser{solved.camera, std::nullopt, std::nullopt};
    if (const auto missed = written.find("not_found"); missed != written.end() && missed->is_array()) {
        result["images"] = data.views.size() + missed->size();
        result["boards_found"] = data.views.size();
        result["not_found"] = *missed;
    }
    result["status"] = known ? "ok" : "undetermined";
    result["camera"] = known ? camera_json(solved.camera) : json(nullptr);
    result["reprojection_rms_px"] = number_json(solved.rms_px);
    result["sigma_px"] = number_json(solved.sigma_px);
    result["covered_share"] = number_json(solved.covered_share);
    json views = json::array();
    for (std::size_t i = 0; i < data.views.size(); ++i)
        views.push_back(
            {{"id", data.views[i].id},
             {"camera_from_target", known ? pose_json(solved.camera_from_target[i]) : json(nullptr)},
             {"sigma", pose_sigma_json(solved.camera_from_target[i], solved.pose_covariance[i])}});
    result["views"] = std::move(views);
    solution.report = std::move(solved.report);
    finish_document(solution);
    return solution;
}

Expected<json> camera_images(const BoardImages& images) {
    SEAM_TRY(auto spec, parse_board(images.board));
    SEAM_TRY(auto files, plate_images(images.folder, images.exclude));
    CameraData data;
    json missed = json::array();
    BoardMiss miss;
    int done = 0;
    for (const auto& path : files) {
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
        const BoardSearch search = find_board(frame.image, spec);
        if (search.board)
            data.views.push_back({path.stem().string(), search.board->object_mm, search.board->pixel});
        else
            missed.push_back(path.stem().string());
        if (search.miss.counted || search.miss.several) miss = search.miss;
        if (images.progress) images.progress(++done, static_cast<int>(files.size()));
    }
    if (data.views.empty() && (miss.counted || miss.several))
        return input_error(why_missed(spec, miss), images.folder, cure_of(miss));
    if (data.views.empty())
        return input_error(Text("no board of {} points was found in any of {} images", images.board.counts,
                                std::to_string(files.size())),
                           images.folder, "check --board, --pattern, light and focus");
    json views = json::array();
    for (const CameraPoints& view : data.views) {
        json points = json::array();
        for (std::size_t i = 0; i < view.pixel.size(); ++i)
            points.push_back(
                {{"object", vector_json(view.object_mm[i])}, {"pixel", vector_json(view.pixel[i])}});
        views.push_back({{"id", view.id}, {"points", std::move(points)}});
    }
    return json{
        {"size", {data.width, data.height}}, {"views", std::move(views)}, {"not_found", std::move(missed)}};
}

json camera_example() {
    example::Dither dither;
    json views = json::array();
    int number = 0;
    for (const TargetPlace& view : plate_views()) {
        json points = json::array();
        TargetPlace far = view;
        // All over the image.
        far.offset_mm += Eigen::Vector3d((number % 3 - 1) * 55, (number / 3 % 3 - 1) * 40, 0);
        for (int i = 0; i < example::kBoardColumns * example::kBoardRows; ++i) {
            const Eigen::Vector2d pixel =
                example::camera().project(example::camera_from_board(far) * example::board_corner(i));
            if (!(pixel.x() > 1 && pixel.y() > 1 && pixel.x() < example::kWidth - 2 &&
                  pixel.y() < example::kHeight - 2))
                continue;
            points.push_back({{"object", example::vector3_json(example::board_corner(i))},
                              {"pixel", example::pair_json(pixel.x() + dither(example::kPixelNoise),
                                                           pixel.y() + dither(example::kPixelNoise))}});
        }
        views.push_back({{"id", "view" + std::to_string(++number)}, {"points", points}});
    }
    return {{"size", {example::kWidth, example::kHeight}}, {"views", views}};
}

}  // namespace

CalibrationMethod camera_method() {
    CalibrationMethod m;
    m.id = "camera";
    m.help = "Intrinsics from views of a plate";
    m.usage = "images --board 9x6 --pitch-mm 25";
    m.layout =
        R"({"size":[W,H],"views":[{"id"?,"points":[{"object":[x,y,z],"pixel":[u,v]},..]},..]}   mm, px)";
    m.fields = {{"", {"size", "views", "not_found"}, {"board"}},
                {"views[]", {"id", "points"}, {"outline"}},
                {"views[].points[]", {"object", "pixel"}}};
    m.example = camera_example;
    m.solve = solve_camera;
    m.data_of_images = camera_images;
    m.entries = "views";
    m.capture = CaptureKind::board_view;
    m.use = AnswerUse::record;
    m.fewest = 3;
    m.advised = 12;
    m.settings = board_settings();
    m.title = "Camera";
    m.why = "Finds focal length, centre and distortion of a camera from views of a plate.";
    m.need = {"A flat board, and light enough to see it by.",
              "10 or more views: tilted to both sides about both axes, and into every corner of the picture.",
              "Or a folder of pictures, or points of any body and their pixels, from a file."};
    m.file = "JSON with views of known points, or a folder of images";
    m.drawing = SetUpDrawing::board;
    return m;
}

}  // namespace seamwright
