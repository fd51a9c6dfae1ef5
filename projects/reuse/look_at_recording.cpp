#include "devices/exchange/image_file.h"
#include "devices/replay/recording.h"
#include "projects/reuse/exchange.h"
#include "projects/reuse/recorded_heights.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t kFirstPoints = 3;

RecordingLook::File look_at(const RecordedFrame& recorded, const RecordingLayout& layout) {
    RecordingLook::File file;
    file.name = recorded.file.filename().string();
    file.spot_id = recorded.spot_id;
    file.image = recorded.image;
    file.base_from_flange = recorded.base_from_flange;
    Frame frame;
    if (auto read = read_recorded(recorded, layout, 0, frame); !read) {
        file.understood = read.error().sentence();
        return file;
    }
    file.readable = true;
    if (recorded.image) {
        file.width = frame.image.width;
        file.height = frame.image.height;
        file.bit_depth = frame.image.bit_depth;
        file.understood = "image";
        if (auto choice = choose_channel(recorded.file)) file.channel = *choice;
        return file;
    }
    if (recorded.profile)
        file.understood = "one profile of " + file.name;
    else if (auto read = read_profiles(recorded.file, layout.profile))
        file.understood = read->understood;
    if (const auto codes = find_no_return_codes(frame.profile); !codes.empty())
        file.no_returns = no_return_sentence(codes);
    file.scale = profile_scale(recorded_heights(frame.profile));
    for (std::size_t i = 0; i < frame.profile.size() && file.first.size() < kFirstPoints; ++i)
        file.first.emplace_back(frame.profile.x_mm[i], frame.profile.z_mm[i]);
    return file;
}

}  // namespace

Expected<RecordingLook> look_at_recording(const fs::path& source, const RecordingLayout& layout,
                                          std::size_t most) {
    RecordingLook look;
    std::error_code code;
    const fs::path path = fs::absolute(source, code).lexically_normal();
    auto frames = list_recording(path, "", true, layout, &look.understood);
    if (!frames) {  // poses may be what is missing
        look.problem = frames.error().sentence();
        const Error first = frames.error();
        look.understood.clear();
        frames = list_recording(path, "", false, layout, &look.understood);
        if (!frames) return tl::unexpected(first);
    }
    look.frames = frames->size();
    for (const RecordedFrame& frame : *frames) {
        if (look.files.size() == most) break;
        look.files.push_back(look_at(frame, layout));
    }
    return look;
}

}  // namespace seamwright
