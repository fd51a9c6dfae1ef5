// seamwright plate-pose: where a plate stands before a camera, from one image of it.

#include <fmt/format.h>

#include "app/cli/answers/result_json.h"
#include "app/cli/arguments/board_argument.h"
#include "app/cli/arguments/pose_argument.h"
#include "app/cli/command.h"
#include "devices/exchange/image_file.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/plate_pose.h"
#include "projects/calibrate/solution/camera_json.h"
#include "projects/calibrate/solution/solution.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

struct PlatePoseArguments {
    std::string image, camera, start, channel = "grey";
    BoardWords board;
};

// {fx,..}, or an answer of `calibrate camera`, which holds it as "camera". Without a size it is the image's.
Expected<CameraModel> read_camera(const std::string& path, const StripeImage& image) {
    SEAM_TRY(const auto document, read_json_file(path));
    const bool within = document.is_object() && document.contains("camera");
    const json& camera = within ? document["camera"] : document;
    if (!camera.is_object())
        return input_error("no camera is in it", path, "give {\"fx\",\"fy\",\"cx\",\"cy\",..} in pixels");
    SEAM_TRY(auto model, parse_camera(camera, within ? path + ": camera" : path));
    if (!camera.contains("width")) model.width = image.width;
    if (!camera.contains("height")) model.height = image.height;
    return model;
}

Answer told(const PlatePose& found, const BoardSpec& spec) {
    const BundleResult& p = found.pose;
    const Judgement& judgement = p.report.judgement;
    const auto given = [&](const json& value) { return p.determined ? value : json(); };
    Answer answer;
    answer.json = {
        {"status", p.determined ? "ok" : "undetermined"},
        {"verdict", name_of(judgement.verdict)},
        {"reason", judgement.reason},
        {"cure", judgement.cure},
        {"camera_from_plate", given(pose_json(p.world_from_object))},
        {"covariance", given(seamwright::matrix_json(p.covariance))},
        {"sigma", given(pose_sigma_json(p.world_from_object, p.covariance))},
        {"rms_px", given(p.rms_px)},
        {"sigma_px", given(p.sigma_px)},
        {"worst_mm", given(p.worst_mm)},
        {"tilt_deg", given(found.tilt_deg)},
        {"rival", p.rival ? pose_json(*p.rival) : json()},
        {"found", found.board.pixel.size()},
        {"expected", board_columns(spec) * board_rows(spec)},
        {"symmetry", found.board.symmetry},
        {"points", json::array()},
    };
    for (std::size_t i = 0; i < found.board.pixel.size(); ++i) {
        const SightResidual& s = p.sights[i];
        answer.json["points"].push_back({{"index", found.board.index[i]},
                                         {"plate", seamwright::vector_json(found.board.object_mm[i])},
                                         {"pixel", seamwright::vector_json(found.board.pixel[i])},
                                         {"off_px", given(seamwright::vector_json(s.off_px))},
                                         {"used", s.used},
                                         {"wrong", s.wrong}});
    }
    answer.text = fmt::format("{}: {}\n", name_of(judgement.verdict), judgement.reason);
    if (!judgement.cure.empty()) answer.text += fmt::format("cure: {}\n", judgement.cure);
    answer.text += fmt::format("{} of {} points found\n", found.board.pixel.size(),
                               board_columns(spec) * board_rows(spec));
    if (p.determined) {
        const json sigma = pose_sigma_json(p.world_from_object, p.covariance);
        const auto three = [&](const char* key, int k) {
            return sigma[key][static_cast<std::size_t>(k)].get<double>();
        };
        answer.text += "camera_from_plate  " + pose_text(p.world_from_object) + "\n";
        answer.text +=
            fmt::format("sigma  X {:.3f}  Y {:.3f}  Z {:.3f} mm   A {:.4f}  B {:.4f}  C {:.4f} deg\n",
                        three("xyz_mm", 0), three("xyz_mm", 1), three("xyz_mm", 2), three("abc_deg", 0),
                        three("abc_deg", 1), three("abc_deg", 2));
        answer.text += fmt::format("tilted by {:.2f} deg against the line of sight; rms {:.3f} px\n",
                                   found.tilt_deg, p.rms_px);
        for (std::size_t i = 0; i < p.sights.size(); ++i)
            if (p.sights[i].wrong)
                answer.text +=
                    fmt::format("  point {} contradicts the others and is left out\n", found.board.index[i]);
    }
    if (p.rival) answer.text += "the other place  " + pose_text(*p.rival) + "\n";
    if (found.board.symmetry > 1)
        answer.text += fmt::format(
            "the board looks alike {} times in a full turn: which way round it lies is not known\n",
            found.board.symmetry);
    answer.exit_code = p.determined && serves(judgement.verdict) ? kExitOk : kExitVerdict;
    return answer;
}

Expected<Answer> plate_pose_command(const PlatePoseArguments& a) {
    SEAM_TRY(const auto spec, parse_board(a.board));
    const auto channel = image_channel(a.channel);
    if (!channel) return usage_error(Text("\"{}\" is no channel", a.channel), "--channel");
    Frame frame;
    SEAM_OK(read_image_file(a.image, frame, 0, *channel));
    SEAM_TRY(const auto camera, read_camera(a.camera, frame.image));
    std::optional<Pose> start;
    if (!a.start.empty()) {
        SEAM_TRY(start, read_pose_argument(a.start, "--start"));
    }
    auto found = plate_pose(frame.image, spec, camera, start);
    if (!found) {
        Error error = found.error();
        error.within(a.image);
        return tl::unexpected(error);
    }
    return told(*found, spec);
}

}  // namespace

void add_plate_pose(CommandLine& line) {
    auto a = std::make_shared<PlatePoseArguments>();
    CLI::App* command = line.add(
        "plate-pose",
        "Where a plate stands before a calibrated camera, from one image: pose, covariance and what every "
        "point is "
        "off.\nA plate that is seen so frontally that it may tilt one way or the other is refused with both "
        "places; "
        "--start decides.\nThe plate's frame: origin at its first point, x along the columns, y along the "
        "rows, z into "
        "the plate. The camera counts\nas exact.",
        "seamwright plate-pose view.png --board 7x6 --pitch-mm 10 --camera camera.json --json -\n"
        "  seamwright plate-pose view.png --board 9x6 --pitch-mm 8 --pattern charuco --camera answer.json\n"
        "  camera.json: {\"fx\":2400,\"fy\":2400,\"cx\":640,\"cy\":512,\"k1\":-0.1}, or the answer of "
        "`calibrate camera "
        "--json`");
    command->add_option("image", a->image, "The image")->required()->type_name("IMAGE");
    command->add_option("--camera", a->camera, "The camera")->required()->type_name("CAMERA.json");
    add_board_options(*command, a->board);
    command
        ->add_option("--start", a->start,
                     "Roughly where it stands, camera_from_plate: decides between two places that fit alike")
        ->type_name("POSE|FILE");
    command->add_option("--channel", a->channel, "Of a colour image: grey, red, green, blue, red-difference")
        ->capture_default_str();
    line.on(command, [a] { return plate_pose_command(*a); });
}

}  // namespace seamwright::cli
