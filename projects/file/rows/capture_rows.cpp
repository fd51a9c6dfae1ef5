// Profiles and images of a run.

#include <fmt/format.h>

#include <array>

#include "devices/capture/profile_blob.h"
#include "projects/file/project_file_detail.h"
#include "projects/file/row_checksum.h"

namespace seamwright {

Expected<void> insert_captures(Database& db, std::span<const Capture> all, std::int64_t number,
                               StoredMeasurements& stored) {
    const auto captures = all.subspan(stored.captures);
    SEAM_TRY(auto blobs, pack_captures(captures));
    SEAM_TRY(auto chunks, db.prepare("SELECT ifnull(max(chunk) + 1, 0) FROM captures WHERE run = ?"));
    chunks.bind(1, number);
    SEAM_OK(chunks.step());
    const std::int64_t first_chunk = chunks.integer(0);
    chunks.reset();
    SEAM_TRY(auto s, db.prepare("INSERT INTO captures (run, chunk, captures, data) VALUES (?, ?, ?, ?)"));
    for (std::size_t i = 0; i < blobs.size(); ++i) {
        s.bind(1, number);
        s.bind(2, first_chunk + static_cast<std::int64_t>(i));
        s.bind(3, std::int64_t{blobs[i].captures});
        s.bind(4, std::span<const std::byte>(blobs[i].bytes));
        SEAM_OK(s.run());
        const std::array<std::int64_t, 3> front{number, first_chunk + static_cast<std::int64_t>(i),
                                                std::int64_t{blobs[i].captures}};
        stored.capture_rows.push_back(blob_row_digest("captures", front, blobs[i].bytes));
    }
    SEAM_TRY(auto image, db.prepare("INSERT INTO images (run, capture, width, height, bit_depth, crc, data) "
                                    "VALUES (?, ?, ?, ?, ?, ?, "
                                    "?)"));
    for (std::size_t i = 0; i < captures.size(); ++i) {
        if (!captures[i].image) continue;
        const StoredImage& raw = *captures[i].image;
        const StripeImage view = raw.view();
        if (view.empty() || raw.pixels.size() != view.row_bytes * static_cast<std::size_t>(view.height))
            return input_error("the image's pixels do not fill its size",
                               Text("capture of spot {}", captures[i].spot_id));
        image.bind(1, number);
        image.bind(2, static_cast<std::int64_t>(stored.captures + i));
        image.bind(3, std::int64_t{raw.width});
        image.bind(4, std::int64_t{raw.height});
        image.bind(5, std::int64_t{raw.bit_depth});
        image.bind(6, std::int64_t{crc_of(std::span<const std::byte>(raw.pixels))});
        image.bind(7, std::span<const std::byte>(raw.pixels));
        SEAM_OK(image.run());
        const std::array<std::int64_t, 5> front{number, static_cast<std::int64_t>(stored.captures + i),
                                                std::int64_t{raw.width}, std::int64_t{raw.height},
                                                std::int64_t{raw.bit_depth}};
        stored.image_rows.push_back(blob_row_digest("images", front, raw.pixels));
    }
    stored.captures += captures.size();
    return {};
}

Expected<void> load_captures(Database& db, RunRecord& run) {
    const std::string where = fmt::format("{}: run {}", db.path(), run.number);
    SEAM_TRY(auto s, db.prepare("SELECT captures, data FROM captures WHERE run = ? ORDER BY chunk"));
    s.bind(1, run.number);
    auto read = for_each_row(s, [&](Statement& row) -> Expected<void> {
        const std::size_t before = run.captures.size();
        SEAM_OK(unpack_captures(row.blob(1), where, run.captures));
        if (static_cast<std::int64_t>(run.captures.size() - before) != row.integer(0))
            return file_error("a block holds another number of profiles than it says", where);
        return {};
    });
    if (!read) return read;
    SEAM_TRY(auto image,
             db.prepare("SELECT capture, width, height, bit_depth, crc, data FROM images WHERE run = ?"));
    image.bind(1, run.number);
    return for_each_row(image, [&](Statement& row) -> Expected<void> {
        const std::int64_t capture = row.integer(0), width = row.integer(1), height = row.integer(2),
                           depth = row.integer(3);
        const auto data = row.blob(5);
        if (capture < 0 || capture >= static_cast<std::int64_t>(run.captures.size()) || width < 1 ||
            height < 1 || width > 65536 || height > 65536 ||
            (depth != 8 && depth != 10 && depth != 12 && depth != 16) ||
            data.size() != static_cast<std::size_t>(width * height * (depth > 8 ? 2 : 1)))
            return file_error("an image does not fit its description", where);
        if (crc_of(data) != row.integer(4))
            return file_error("the checksum of an image is wrong: the file is damaged", where);
        run.captures[static_cast<std::size_t>(capture)].image =
            StoredImage{static_cast<int>(width), static_cast<int>(height), static_cast<int>(depth),
                        std::vector<std::byte>(data.begin(), data.end())};
        return {};
    });
}

}  // namespace seamwright
