#include "projects/calibrate/methods/cameras/stripe_frames.h"
#include "projects/calibrate/input/entry.h"

#include <cmath>
#include <optional>
#include <tuple>

#include "core/geometry/pose_convention.h"
#include "core/profile/stripe/peaks.h"
#include "devices/exchange/image_file.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/input/plate_images.h"

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
    SEAM_TRY(auto list, json_array(entry, key, where));
    std::vector<Eigen::Vector2d> pixels;
    pixels.reserve(list->size());
    for (std::size_t i = 0; i < list->size(); ++i) {
        SEAM_TRY(auto uv, as_numbers((*list)[i], 2, json_path(json_path(where, key), i)));
        pixels.emplace_back(uv[0], uv[1]);
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
    SEAM_TRY(auto pixels, parse_pixels(value, "pixel", where));
    board.pixel = std::move(pixels);
    SEAM_TRY(auto index, json_array(value, "index", where));
    for (std::size_t i = 0; i < index->size(); ++i) {
        SEAM_TRY(auto number, as_number((*index)[i], json_path(json_path(where, "index"), i)));
        if (number < 0 || number >= board_columns(spec) * board_rows(spec) || number != std::floor(number))
            return input_error("this is no corner of the board", json_path(json_path(where, "index"), i));
        const int k = static_cast<int>(number);
        board.index.push_back(k);
        board.object_mm.push_back(board_point(spec, k));
    }
    if (board.index.size() != board.pixel.size())
        return input_error("pixel and index have different lengths", where);
    SEAM_TRY(auto symmetry, json_number_or(value, "symmetry", 1, where));
    board.symmetry = symmetry == 2 || symmetry == 4 ? static_cast<int>(symmetry) : 1;
    SEAM_TRY(auto detector, json_string_or(value, "detector", "", where));
    board.detector = detector;
    return board;
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
    SEAM_TRY(auto id, entry_id(entry, index, where));
    o.id = id;
    SEAM_TRY(auto size_field, json_field(entry, "size", where));
    SEAM_TRY(auto size, as_numbers(*size_field, 2, json_path(where, "size")));
    if (!(size[0] >= 1 && size[1] >= 1 && size[0] <= 1e5 && size[1] <= 1e5))
        return input_error("this is no image size", json_path(where, "size"),
                           "give [width, height] in pixels");
    o.width = static_cast<int>(size[0]);
    o.height = static_cast<int>(size[1]);
    SEAM_TRY(auto scan, json_string_or(entry, "scan", "rows", where));
    if (scan != "rows" && scan != "columns")
        return input_error(Text("the scan '{}' is unknown", scan), json_path(where, "scan"),
                           "write rows or columns");
    o.scan = scan == "rows" ? ScanLines::rows : ScanLines::columns;
    if (const auto it = entry.find("board"); it != entry.end() && !it->is_null()) {
        SEAM_TRY(auto board, parse_found_board(*it, spec, json_path(where, "board")));
        o.board = std::move(board);
    }
    if (const auto it = entry.find("stripe"); it != entry.end() && !it->is_null()) {
        SEAM_TRY(auto stripe, parse_pixels(entry, "stripe", where));
        o.stripe = std::move(stripe);
    }
    if (const auto it = entry.find("base_from_flange"); it != entry.end() && !it->is_null()) {
        SEAM_TRY(auto pose, parse_pose(*it, json_path(where, "base_from_flange")));
        o.base_from_flange = pose;
    }
    return o;
}

json board_json(const BoardSpec& spec) {
    json board = {{"columns", spec.columns}, {"rows", spec.rows}, {"pitch_mm", spec.pitch_mm}};
    if (spec.pattern != BoardPattern::chessboard) board["pattern"] = name_of(spec.pattern);
    if (spec.marker_mm > 0) board["marker_mm"] = spec.marker_mm;
    if (spec.dictionary >= 0)
        board["dictionary"] = dictionary_names()[static_cast<std::size_t>(spec.dictionary)];
    if (spec.legacy) board["legacy"] = *spec.legacy;
    return board;
}

Expected<BoardSpec> parse_board_json(const json& value, const std::string& where) {
    BoardSpec spec;
    for (auto [key, target] : {std::pair{"columns", &spec.columns}, std::pair{"rows", &spec.rows}}) {
        SEAM_TRY(auto number, json_number(value, key, where));
        if (!(number >= 0 && number <= 1000)) return input_error("this is no count", json_path(where, key));
        *target = static_cast<int>(number);
    }
    SEAM_TRY(auto pitch, json_number(value, "pitch_mm", where));
    spec.pitch_mm = pitch;
    SEAM_TRY(const auto pattern, json_string_or(value, "pattern", "chessboard", where));
    const auto named = board_pattern_named(pattern);
    if (!named)
        return input_error(Text("the pattern '{}' is unknown", pattern), json_path(where, "pattern"),
                           "write chessboard, circles, charuco or aprilgrid");
    spec.pattern = *named;
    SEAM_TRY(spec.marker_mm, json_number_or(value, "marker_mm", 0, where));
    SEAM_TRY(const auto dictionary, json_string_or(value, "dictionary", "", where));
    if (!dictionary.empty()) {
        const auto number = dictionary_named(dictionary);
        if (!number)
            return input_error(Text("the dictionary '{}' is unknown", dictionary),
                               json_path(where, "dictionary"),
                               "write one of OpenCV's, e.g. 4x4_50, 5x5_100 or apriltag_36h11");
        spec.dictionary = *number;
    }
    if (value.contains("legacy")) {
        SEAM_TRY(spec.legacy, json_bool_or(value, "legacy", false, where));
    }
    SEAM_OK(validate(spec));
    return spec;
}

namespace {

// Of a colour picture the stripe in the channel that shows it best; the plate is found in grey. nullopt: grey
// does.
using Stripe = std::pair<ScanLines, std::vector<Eigen::Vector2d>>;
Expected<std::optional<Stripe>> stripe_in_colour(const fs::path& path) {
    SEAM_TRY(const auto choice, choose_channel(path));
    if (!choice.colour || choice.channel == ImageChannel::grey) return std::nullopt;
    Frame frame;
    SEAM_OK(read_image_file(path, frame, 0, choice.channel));
    PeakOptions options;
    SEAM_TRY(const auto scan, guess_scan_lines(frame.image));
    options.scan = scan;
    StripePeaks peaks;
    SEAM_OK(find_peaks(frame.image, options, peaks));
    Stripe stripe{scan, {}};
    for (int line = 0; line < peaks.lines; ++line)
        for (int k = 0; k < peaks.count[static_cast<std::size_t>(line)]; ++k) {
            const auto i = static_cast<std::size_t>(peaks.index(line, k));
            if (!(peaks.flags[i] & StripePeaks::kTruncated))
                stripe.second.push_back(pixel_of(scan, line, peaks.position_px[i]));
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

Expected<StripeData> parse_stripe_data(const json& data) {
    SEAM_TRY(auto board, json_field(data, "board", ""));
    SEAM_TRY(auto spec, parse_board_json(*board, "board"));
    SEAM_TRY(auto list, json_array(data, "frames", ""));
    StripeData set{spec, {}};
    for (std::size_t i = 0; i < list->size(); ++i) {
        SEAM_TRY(auto o, parse_stripe_frame((*list)[i], spec, i, json_path("frames", i)));
        set.observations.push_back(std::move(o));
    }
    return set;
}

// Poses of text files stay quaternions, as they are written there.
Expected<json> stripe_folder_data(const BoardImages& images) {
    SEAM_TRY(auto spec, parse_board(images.board));
    SEAM_TRY(auto files, plate_images(images.folder, images.exclude));
    json frames = json::array();
    BoardMiss miss;
    bool found = false;
    for (const auto& path : files) {
        SEAM_TRY(auto o, read_stripe_frame(path, spec));
        json frame = stripe_frame_json(o);
        if (!frames.empty() && frames.front()["size"] != frame["size"])
            return input_error("the images have different sizes", path.string(),
                               "give frames of one camera at one resolution");
        const auto file = pose_file_beside(path);
        if (o.base_from_flange && file && file->extension() != ".json") {
            const PoseNumbers n = write_pose(*o.base_from_flange, {.rotation = RotationReading::quat_wxyz});
            frame["base_from_flange"] = {
                {"xyz", {n.position.x(), n.position.y(), n.position.z()}},
                {"quat_wxyz", {n.rotation[0], n.rotation[1], n.rotation[2], n.rotation[3]}}};
        }
        frames.push_back(std::move(frame));
        found |= o.board.has_value();
        if (o.miss.counted || o.miss.several) miss = o.miss;
        if (images.progress) images.progress(static_cast<int>(frames.size()), static_cast<int>(files.size()));
    }
    if (!found && (miss.counted || miss.several))
        return input_error(why_missed(spec, miss), images.folder, cure_of(miss));
    return json{{"board", board_json(spec)}, {"frames", std::move(frames)}};
}

}  // namespace seamwright
