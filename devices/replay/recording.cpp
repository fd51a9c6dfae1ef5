#include "devices/replay/recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>

#include "core/system_text.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "devices/exchange/tables/pose_names.h"

namespace seamwright {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kFrameLimit = 1'000'000;

std::string lower(std::string s) {
    std::transform(s.begin(), s.end(), s.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return s;
}

// In the order in which they count where a folder holds several.
constexpr std::string_view kProfileExtensions[] = {".csv", ".tsv", ".npy", ".ply", ".pcd",
                                                   ".asc", ".xyz", ".dat", ".txt"};
bool is_profile_file(const fs::path& p) {
    const std::string extension = lower(p.extension().string());
    return std::find(std::begin(kProfileExtensions), std::end(kProfileExtensions), extension) !=
           std::end(kProfileExtensions);
}
bool is_image_file(const fs::path& p) {
    static const std::set<std::string> known = {".png", ".bmp", ".tif", ".tiff", ".pgm", ".jpg", ".jpeg"};
    return known.contains(lower(p.extension().string()));
}

// A file of the folder named by a manifest: relative and not leading out.
Expected<fs::path> inside(const fs::path& folder, const std::string& name, const std::string& where) {
    const fs::path relative(name);
    bool leads_out = relative.is_absolute();
    for (const auto& part : relative) leads_out = leads_out || part == "..";
    if (name.empty() || leads_out || name.find('\0') != std::string::npos) {
        return input_error("must be the name of a file inside the folder", where);
    }
    return folder / relative;
}

// The name under which a table of all poses is found by itself.
bool is_pose_table(const fs::path& p) {
    const std::string name = lower(p.filename().string());
    for (const char* known : {"poses.csv", "poses.txt", "poses.dat", "poses.mod", "poses.ls", "poses.json"})
        if (name == known) return true;
    return false;
}

// The pose file that belongs to `file` by its name.
std::optional<fs::path> pose_beside(const fs::path& file) {
    const std::string stem = file.stem().string();
    std::size_t digits = stem.size();
    while (digits > 0 && std::isdigit(static_cast<unsigned char>(stem[digits - 1]))) --digits;
    std::vector<fs::path> stems = {file.parent_path() / stem};
    if (digits < stem.size()) stems.push_back(file.parent_path() / ("pose" + stem.substr(digits)));
    stems.push_back(file.parent_path() / "poses" / stem);
    if (file.parent_path().has_parent_path())
        stems.push_back(file.parent_path().parent_path() / "poses" / stem);
    for (const auto& s : stems) {
        for (const char* extension : {".json", ".txt", ".yaml", ".yml"}) {
            std::error_code ignored;
            fs::path candidate = s;
            candidate += extension;
            if (candidate != file && fs::is_regular_file(candidate, ignored)) return candidate;
        }
    }
    return std::nullopt;
}

Expected<RecordedFrame> manifest_frame(const fs::path& folder, const std::string& file,
                                       const std::string& spot_id, const std::string& pose_file,
                                       const std::string& where, const PoseLayout& layout) {
    RecordedFrame frame;
    SEAM_TRY(const auto path, inside(folder, file, json_path(where, "file")));
    frame.file = path;
    if (!is_profile_file(path) && !is_image_file(path)) {
        return input_error(Text("\"{}\" is neither a profile (.csv) nor an image", file),
                           json_path(where, "file"));
    }
    frame.image = is_image_file(path);
    if (spot_id.empty()) return input_error("is empty", json_path(where, "spot_id"));
    frame.spot_id = spot_id;
    if (!pose_file.empty()) {
        SEAM_TRY(const auto pose_path, inside(folder, pose_file, json_path(where, "pose_file")));
        SEAM_TRY(const auto poses, read_frame_poses({&pose_path, 1}, layout));
        frame.base_from_flange = poses.front();
    }
    return frame;
}

Expected<std::vector<RecordedFrame>> frames_of_json(const fs::path& folder, const fs::path& manifest,
                                                    const PoseLayout& layout) {
    SEAM_TRY(const auto json, read_json_file(manifest));
    const std::string where = manifest.string();
    SEAM_OK(only_fields(json, {"frames"}, where));
    SEAM_TRY(const auto list, json_array(json, "frames", where));
    std::vector<RecordedFrame> frames;
    for (std::size_t i = 0; i < list->size(); ++i) {
        const auto& entry = (*list)[i];
        const std::string at = json_path(where + ": frames", i);
        SEAM_OK(only_fields(entry, {"file", "spot_id", "pose_file", "base_from_flange"}, at));
        SEAM_TRY(const auto file, json_string(entry, "file", at));
        SEAM_TRY(const auto spot, json_string(entry, "spot_id", at));
        SEAM_TRY(const auto pose_file, json_string_or(entry, "pose_file", "", at));
        SEAM_TRY(auto frame, manifest_frame(folder, file, spot, pose_file, at, layout));
        if (entry.contains("base_from_flange")) {
            if (!pose_file.empty())
                return input_error("names two poses", at, "give base_from_flange or pose_file");
            SEAM_TRY(const auto pose,
                     parse_pose(entry["base_from_flange"], json_path(at, "base_from_flange")));
            frame.base_from_flange = pose;
        }
        frames.push_back(std::move(frame));
    }
    return frames;
}

Expected<std::vector<RecordedFrame>> frames_of_csv(const fs::path& folder, const fs::path& manifest,
                                                   const PoseLayout& layout) {
    SEAM_TRY(const auto text, read_text_file(manifest));
    std::vector<RecordedFrame> frames;
    std::string_view rest = text;
    if (rest.starts_with("\xEF\xBB\xBF")) rest.remove_prefix(3);
    std::size_t number = 0, width = 0;
    while (!rest.empty()) {
        const auto end = rest.find('\n');
        std::string_view line = rest.substr(0, end);
        rest = end == std::string_view::npos ? std::string_view{} : rest.substr(end + 1);
        ++number;
        const std::string at = fmt::format("{}, line {}", manifest.string(), number);
        std::vector<std::string> fields;
        for (std::size_t begin = 0;;) {
            const auto comma = line.find(',', begin);
            std::string_view field = line.substr(begin, comma - begin);
            const auto first = field.find_first_not_of(" \t\r\"");
            field = first == std::string_view::npos
                        ? std::string_view{}
                        : field.substr(first, field.find_last_not_of(" \t\r\"") - first + 1);
            fields.emplace_back(field);
            if (comma == std::string_view::npos) break;
            begin = comma + 1;
        }
        if (fields.size() == 1 && fields[0].empty()) continue;
        if (width == 0) {
            width = fields.size();
            const bool two = fields == std::vector<std::string>{"file", "spot_id"};
            const bool three = fields == std::vector<std::string>{"file", "spot_id", "pose_file"};
            if (!two && !three) return input_error("is not the header file,spot_id[,pose_file]", at);
            continue;
        }
        if (fields.size() != width) {
            return input_error(Text("has {} fields where the header names {}", fields.size(), width), at);
        }
        SEAM_TRY(auto frame,
                 manifest_frame(folder, fields[0], fields[1], width == 3 ? fields[2] : "", at, layout));
        frames.push_back(std::move(frame));
    }
    return frames;
}

// Profiles of two kinds: those of the second would be passed over. Text that is somebody's pose, and a table of the first kind's
// stem, are no frames.
Expected<void> one_kind(const fs::path& folder, const std::vector<RecordedFrame>& profiles) {
    const auto extension_of = [](const RecordedFrame& f) { return lower(f.file.extension().string()); };
    for (const std::string_view first : kProfileExtensions) {
        std::set<std::string> stems;
        for (const RecordedFrame& f : profiles)
            if (extension_of(f) == first) stems.insert(f.spot_id);
        if (stems.empty()) continue;
        for (const RecordedFrame& f : profiles) {
            const std::string extension = extension_of(f);
            const bool pose = extension == ".txt" || extension == ".dat";
            if (extension == first || pose || stems.contains(f.spot_id)) continue;
            return input_error(
                Text("holds {} frames beside {}", std::string(first.substr(1)), f.file.filename().string()),
                folder.string(), "write all frames in one kind of file, or take the others away");
        }
        return {};
    }
    return {};
}

Expected<std::vector<RecordedFrame>> frames_of_folder(const fs::path& folder, const std::string& kind) {
    std::vector<RecordedFrame> profiles, images;
    std::error_code problem;
    for (auto it = fs::directory_iterator(folder, problem); !problem && it != fs::directory_iterator();
         it.increment(problem)) {
        std::error_code ignored;
        if (!it->is_regular_file(ignored)) continue;
        const fs::path& p = it->path();
        if (is_pose_table(p)) continue;
        if (is_profile_file(p) &&
            !(lower(p.extension().string()) == ".txt" && lower(p.stem().string()).starts_with("pose")))
            profiles.push_back({p, p.stem().string(), std::nullopt, false, {}});
        if (is_image_file(p)) images.push_back({p, p.stem().string(), std::nullopt, true, {}});
        if (profiles.size() + images.size() > kFrameLimit) {
            return input_error(Text("holds more than {} frames", kFrameLimit), folder.string());
        }
    }
    if (problem) return file_error(Text("cannot be listed ({})", system_text(problem)), folder.string());
    SEAM_OK(one_kind(folder, profiles));
    // Of several kinds the first counts; text beside images is their poses.
    for (const std::string_view extension : kProfileExtensions) {
        const auto is = [&](const RecordedFrame& f) {
            return lower(f.file.extension().string()) == extension;
        };
        if (std::none_of(profiles.begin(), profiles.end(), is)) continue;
        if (!images.empty() && kind != "profiles" && extension != ".csv")
            profiles.clear();
        else
            std::erase_if(profiles, [&](const RecordedFrame& f) { return !is(f); });
        break;
    }
    if (kind.empty() && !profiles.empty() && !images.empty()) {
        return input_error(
            "holds both profiles (.csv) and images", folder.string(),
            "say which with the setting \"kind\": \"profiles\" or \"images\", or write a frames.csv");
    }
    const bool take_images = kind.empty() ? !images.empty() : kind == "images";
    auto& frames = take_images ? images : profiles;
    std::sort(frames.begin(), frames.end(), [](const RecordedFrame& a, const RecordedFrame& b) {
        return natural_less(a.file.filename().string(), b.file.filename().string());
    });
    return frames;
}

}  // namespace

bool natural_less(std::string_view a, std::string_view b) {
    const auto digit = [](char c) { return c >= '0' && c <= '9'; };
    std::size_t i = 0, j = 0;
    while (i < a.size() && j < b.size()) {
        if (digit(a[i]) && digit(b[j])) {
            std::size_t ie = i, je = j;
            while (ie < a.size() && digit(a[ie])) ++ie;
            while (je < b.size() && digit(b[je])) ++je;
            std::string_view na = a.substr(i, ie - i), nb = b.substr(j, je - j);
            na.remove_prefix(std::min(na.find_first_not_of('0'), na.size()));
            nb.remove_prefix(std::min(nb.find_first_not_of('0'), nb.size()));
            if (na.size() != nb.size()) return na.size() < nb.size();
            if (na != nb) return na < nb;
            i = ie;
            j = je;
        } else {
            if (a[i] != b[j]) return a[i] < b[j];
            ++i;
            ++j;
        }
    }
    if (a.size() - i != b.size() - j) return a.size() - i < b.size() - j;
    return a < b;  // "a01" and "a1": any fixed order
}

namespace {

// The profiles of one file.
Expected<std::vector<RecordedFrame>> frames_of_file(const fs::path& file, const RecordingLayout& layout,
                                                    std::vector<std::string>* told) {
    SEAM_TRY(auto read, read_profiles(file, layout.profile));
    if (told) told->push_back(file.filename().string() + ": " + read.understood);
    std::vector<RecordedFrame> frames;
    for (ReadProfile& one : read.profiles) {
        RecordedFrame frame;
        frame.file = file;
        frame.spot_id = read.profiles.size() == 1 ? file.stem().string() : fmt::format("{}", one.number);
        if (one.y_mm.empty()) frame.profile = std::make_shared<const Profile>(std::move(one.profile));
        frames.push_back(std::move(frame));
    }
    return frames;
}

// From one table, where there is one.
Expected<bool> poses_from_table(const fs::path& folder, const RecordingLayout& layout,
                                std::vector<RecordedFrame>& frames, std::vector<std::string>* told) {
    std::optional<fs::path> path;
    if (!layout.poses.empty()) {
        path = fs::path(layout.poses).is_absolute() ? fs::path(layout.poses) : folder / layout.poses;
    } else {
        std::error_code ignored;
        std::vector<fs::path> found;
        for (auto it = fs::directory_iterator(folder, ignored); !ignored && it != fs::directory_iterator();
             it.increment(ignored))
            if (is_pose_table(it->path())) found.push_back(it->path());
        std::sort(found.begin(), found.end());
        if (!found.empty()) path = found.front();
    }
    if (!path) return false;
    SEAM_TRY(const auto table, read_pose_table(*path, layout.pose));
    // Frames that are profiles of one file have its numbers as names.
    std::vector<std::string> names;
    for (const RecordedFrame& frame : frames)
        names.push_back(frame.profile && frame.file.stem() != frame.spot_id ? frame.spot_id
                                                                            : frame.file.filename().string());
    SEAM_TRY(const auto found, poses_of_frames(table, names, path->string()));
    for (std::size_t i = 0; i < frames.size(); ++i)
        if (!frames[i].base_from_flange) frames[i].base_from_flange = found.poses[i];
    if (told)
        told->push_back(
            fmt::format("{}: {}, {}", path->filename().string(), table.understood, found.understood));
    return true;
}

}  // namespace

Expected<std::vector<RecordedFrame>> list_recording(const fs::path& source, const std::string& kind,
                                                    bool poses_required, const RecordingLayout& layout,
                                                    std::vector<std::string>* told) {
    std::error_code ignored;
    const bool one_file = fs::is_regular_file(source, ignored) && is_profile_file(source);
    if (!one_file && !fs::is_directory(source, ignored)) {
        if (!fs::exists(source, ignored))
            return file_error("does not exist", source.string(),
                              "give the folder that holds the recorded frames");
        return file_error("is neither a folder nor a file of profiles", source.string(),
                          "profiles are .csv, .tsv, .txt, .asc, .xyz, .dat, .npy, .ply or .pcd");
    }
    const fs::path folder = one_file ? source.parent_path() : source;
    const bool json = !one_file && fs::exists(folder / "spots.json", ignored),
               csv = !one_file && fs::exists(folder / "frames.csv", ignored);
    auto frames = one_file ? frames_of_file(source, layout, told)
                  : json   ? frames_of_json(folder, folder / "spots.json", layout.pose)
                  : csv    ? frames_of_csv(folder, folder / "frames.csv", layout.pose)
                           : frames_of_folder(folder, kind);
    if (!frames) return frames;
    if (frames->empty()) {
        return input_error("holds no frames", folder.string(),
                           "profiles are .csv, images .png, .bmp, .tiff or .pgm");
    }
    if (!json && !csv) {
        SEAM_OK(poses_from_table(folder, layout, *frames, told));
    }
    std::size_t with_pose = 0;
    const RecordedFrame* missing = nullptr;
    std::vector<fs::path> pose_files;
    std::vector<RecordedFrame*> of_files;
    for (RecordedFrame& frame : *frames) {
        const auto path = !frame.base_from_flange && (!one_file || frames->size() == 1)
                              ? pose_beside(frame.file)
                              : std::nullopt;
        if (path) {
            pose_files.push_back(*path);
            of_files.push_back(&frame);
        }
        if (path || frame.base_from_flange) {
            ++with_pose;
        } else if (!missing) {
            missing = &frame;
        }
    }
    SEAM_TRY(const auto poses, read_frame_poses(pose_files, layout.pose));
    for (std::size_t i = 0; i < poses.size(); ++i) of_files[i]->base_from_flange = poses[i];
    if (missing && (with_pose > 0 || poses_required)) {
        return input_error("has no pose", missing->file.string(),
                           "put its pose beside it, e.g. pose0001.txt for frame0001.png");
    }
    return frames;
}

Recording::Recording(fs::path folder, std::vector<RecordedFrame> frames, bool loop)
    : folder_(std::move(folder)), frames_(std::move(frames)), loop_(loop) {
    for (std::size_t i = 0; i < frames_.size(); ++i) of_spot_[frames_[i].spot_id].push_back(i);
}

Expected<std::size_t> Recording::take(const std::string& spot_id) {
    if (spot_id.empty()) {
        if (cursor_ == frames_.size()) {
            if (!loop_) return device_error(ErrorCode::end_of_recording, kEndOfRecording, folder_.string());
            cursor_ = 0;
        }
        return cursor_++;
    }
    const auto it = of_spot_.find(spot_id);
    if (it == of_spot_.end()) {
        return device_error(Text("the recording has no spot \"{}\"", spot_id), folder_.string());
    }
    std::size_t& played = played_[spot_id];
    if (played == it->second.size()) {
        if (!loop_) return device_error(ErrorCode::end_of_recording, kEndOfRecording, folder_.string());
        played = 0;
    }
    return it->second[played++];
}

Expected<void> Recording::start_moves(const std::vector<std::string>& spot_ids) {
    const std::lock_guard lock(mutex_);
    const auto played_before = played_;
    std::deque<std::size_t> moves;
    for (const std::string& id : spot_ids) {
        if (id.empty()) return input_error("a measuring move names no spot");
        const auto index = take(id);
        if (!index) {
            played_ = played_before;
            return tl::unexpected(index.error());
        }
        moves.push_back(*index);
    }
    driven_ = true;
    moves_ = std::move(moves);
    due_.clear();
    return {};
}

const RecordedFrame* Recording::fire() {
    const std::lock_guard lock(mutex_);
    if (moves_.empty()) return nullptr;
    due_.push_back(moves_.front());
    moves_.pop_front();
    return &frames_[due_.back()];
}

Expected<void> Recording::trigger(const std::string& spot_id) {
    const std::lock_guard lock(mutex_);
    for (const std::size_t i : due_) {
        if (frames_[i].spot_id == spot_id) return {};
    }
    SEAM_TRY(const auto index, take(spot_id));
    driven_ = true;
    due_.push_back(index);
    return {};
}

Recording::Next Recording::next(const RecordedFrame*& frame) {
    const std::lock_guard lock(mutex_);
    if (!due_.empty()) {
        frame = &frames_[due_.front()];
        due_.pop_front();
        return Next::frame;
    }
    if (driven_) return Next::nothing_due;
    const auto index = take("");
    if (!index) return Next::ended;
    frame = &frames_[*index];
    return Next::frame;
}

void Recording::put_back(const RecordedFrame* frame) {
    const std::lock_guard lock(mutex_);
    due_.push_front(static_cast<std::size_t>(frame - frames_.data()));
}

}  // namespace seamwright
