#include <algorithm>
#include <filesystem>

#include "app/cli/calibrate/camera_json.h"
#include "app/cli/calibrate/commands.h"
#include "app/cli/calibrate/plate_images.h"
#include "core/calibration/stripe_camera.h"
#include "devices/exchange/image_file.h"
#include "devices/exchange/pose_json.h"

namespace seamwright {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

// The pose that belongs to an image: the file of the same name, or the one with the same number
// ("frame0007.png" and "pose0007.txt", "images/7.png" and "poses/7.yaml").
Expected<std::optional<Pose>> pose_beside(const fs::path& image) {
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
                if (name.empty() || !fs::is_regular_file(path, code)) continue;
                auto pose = read_pose_file(path);
                if (!pose) return tl::unexpected(pose.error());
                return std::optional<Pose>(*pose);
            }
    return std::optional<Pose>();
}

}  // namespace

Expected<CalibrateOutcome> calibrate_stripe_camera_folder(const std::string& directory,
                                                          const std::string& board, double pitch_mm,
                                                          const std::vector<std::string>& exclude) {
    auto spec = parse_board(board, pitch_mm, "chessboard");
    if (!spec) return tl::unexpected(spec.error());
    auto images = plate_images(directory, exclude);
    if (!images) return tl::unexpected(images.error());
    std::vector<StripeObservation> observations;
    std::size_t poses = 0;
    for (const auto& path : *images) {
        Frame frame;
        if (auto read = read_image_file(path, frame); !read)
            return input_error("the image cannot be read: " + read.error().what, path.string(),
                               "exclude it with --exclude " + path.stem().string());
        StripeFrame f;
        f.id = path.stem().string();
        f.image = frame.image;
        if (!observations.empty() &&
            (f.image.width != observations.front().width || f.image.height != observations.front().height))
            return input_error("the images have different sizes", path.string(),
                               "give frames of one camera at one resolution");
        auto pose = pose_beside(path);
        if (!pose) {
            Error error = pose.error();
            error.kind = ErrorKind::input;
            return tl::unexpected(std::move(error));
        }
        f.base_from_flange = *pose;
        poses += pose->has_value();
        observations.push_back(observe(f, *spec));
    }
    auto solved = calibrate_stripe_camera(observations, *spec, {});
    if (!solved) return tl::unexpected(solved.error());

    CalibrateOutcome outcome;
    json& result = outcome.result;
    const Verdict verdict = solved->report.judgement.verdict;
    const bool known = verdict != Verdict::undetermined;
    result["method"] = "stripe-camera";
    result["status"] = known ? "ok" : "undetermined";
    result["images"] = observations.size();
    result["poses"] = poses;
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
             {"camera_from_target", f.used ? pose_json(f.camera_from_target) : json(nullptr)},
             {"note", f.note}});
    }
    result["frames"] = std::move(frames);
    add_report(solved->report, result);
    if (!known)
        for (auto& p : result["parameters"]) p["value"] = p["sigma"] = nullptr;
    outcome.exit_code = exit_code_for(verdict);
    return outcome;
}

}  // namespace seamwright
