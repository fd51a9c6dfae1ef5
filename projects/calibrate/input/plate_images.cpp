#include "projects/calibrate/input/plate_images.h"

#include <algorithm>
#include <charconv>
#include <set>

#include "core/number_text.h"
#include "core/system_text.h"

namespace seamwright {

namespace fs = std::filesystem;

Expected<BoardSpec> parse_board(const BoardWords& words) {
    BoardSpec spec;
    const std::string& counts = words.counts;
    const auto bad = [&] {
        return usage_error(Text("'{}' is no board", counts), "--board", "write columns x rows, e.g. 7x6");
    };
    const auto x = counts.find('x');
    if (x == std::string::npos) return bad();
    const char* text = counts.data();
    const auto first = std::from_chars(text, text + x, spec.columns);
    const auto second = std::from_chars(text + x + 1, text + counts.size(), spec.rows);
    if (first.ec != std::errc() || second.ec != std::errc() || first.ptr != text + x ||
        second.ptr != text + counts.size())
        return bad();
    spec.pitch_mm = words.pitch_mm;
    const auto pattern = board_pattern_named(words.pattern);
    if (!pattern)
        return usage_error(Text("the pattern '{}' is unknown", words.pattern), "--pattern",
                           "write chessboard, circles, charuco or aprilgrid");
    spec.pattern = *pattern;
    spec.marker_mm = words.marker_mm;
    if (!words.dictionary.empty()) {
        const auto dictionary = dictionary_named(words.dictionary);
        if (!dictionary)
            return usage_error(Text("the dictionary '{}' is unknown", words.dictionary), "--dictionary",
                               "write one of OpenCV's, e.g. 4x4_50, 5x5_100 or apriltag_36h11");
        spec.dictionary = *dictionary;
    }
    if (!words.legacy.empty()) spec.legacy = words.legacy == "yes";
    SEAM_OK(validate(spec));
    return spec;
}

Expected<std::vector<fs::path>> plate_images(const fs::path& folder,
                                             const std::vector<std::string>& exclude) {
    std::error_code code;
    if (!fs::is_directory(folder, code))
        return file_error("this is no folder", folder.string(), "give a folder of images");
    static const std::set<std::string> kinds{".png", ".jpg",  ".jpeg", ".bmp",
                                             ".tif", ".tiff", ".pgm",  ".ppm"};
    std::vector<fs::path> images;
    std::set<std::string> names;
    for (auto it = fs::directory_iterator(folder, code); !code && it != fs::directory_iterator();
         it.increment(code)) {
        std::string extension = it->path().extension().string();
        std::transform(extension.begin(), extension.end(), extension.begin(),
                       [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        if (!kinds.count(extension)) continue;
        if (!names.insert(it->path().stem().string()).second)
            return input_error(Text("two images are named '{}'", it->path().stem().string()), folder.string(),
                               "keep one of them");
        images.push_back(it->path());
    }
    if (code) return file_error(Text("the folder cannot be read: {}", system_text(code)), folder.string());
    if (images.empty())
        return input_error("there is no image in the folder", folder.string(),
                           "give a folder of PNG, TIFF, PGM, BMP or JPEG images");
    for (const auto& id : exclude)
        if (!names.count(id))
            return input_error(Text("there is no image '{}' to exclude", id), folder.string(),
                               "name images without their extension");
    // Numbers in names by value: 2 before 10.
    const auto key = [](const fs::path& p) {
        const std::string s = p.stem().string();
        std::string digits;
        for (auto i = s.rbegin(); i != s.rend() && std::isdigit(static_cast<unsigned char>(*i)); ++i)
            digits.insert(digits.begin(), *i);
        return std::tuple(s.substr(0, s.size() - digits.size()),
                          digits.size() < 12 ? number_from<long long>(digits).value_or(0) : 0LL, s);
    };
    std::sort(images.begin(), images.end(),
              [&](const fs::path& a, const fs::path& b) { return key(a) < key(b); });
    std::erase_if(images, [&](const fs::path& p) {
        return std::count(exclude.begin(), exclude.end(), p.stem().string()) > 0;
    });
    return images;
}

}  // namespace seamwright
