#include "devices/capture/capture_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "devices/capture/profile_blob.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCaptureFile = "capture";
constexpr std::size_t kMaxUnpacked = std::size_t{512} << 20;
constexpr int kPageBytes = 32768;  // of large blobs; a reader takes any

constexpr const char* kTables = R"sql(
CREATE TABLE capture (
    id INTEGER PRIMARY KEY CHECK (id = 1),
    started_utc TEXT NOT NULL,
    finished_utc TEXT NOT NULL,
    end TEXT NOT NULL
) STRICT;
CREATE TABLE sources (
    id INTEGER PRIMARY KEY,
    kind TEXT NOT NULL CHECK (kind IN ('sensor', 'robot')),
    name TEXT NOT NULL UNIQUE,
    driver TEXT NOT NULL,
    vendor TEXT NOT NULL,
    model TEXT NOT NULL,
    serial TEXT NOT NULL,
    damaged INTEGER NOT NULL,
    lost INTEGER NOT NULL,
    dropped INTEGER NOT NULL
) STRICT;
CREATE TABLE blocks (
    id INTEGER PRIMARY KEY,
    source INTEGER NOT NULL REFERENCES sources (id),
    first INTEGER NOT NULL,
    frames INTEGER NOT NULL,
    first_host_ns INTEGER NOT NULL,
    last_host_ns INTEGER NOT NULL,
    unpacked INTEGER NOT NULL,
    data BLOB NOT NULL
) STRICT;
CREATE TABLE spots (
    source INTEGER NOT NULL REFERENCES sources (id),
    frame INTEGER NOT NULL,
    spot_id TEXT NOT NULL,
    PRIMARY KEY (source, frame)
) STRICT, WITHOUT ROWID;
CREATE TABLE events (
    id INTEGER PRIMARY KEY,
    source INTEGER NOT NULL REFERENCES sources (id),
    kind TEXT NOT NULL CHECK (kind IN ('trigger', 'pose', 'mode', 'note')),
    host_time_ns INTEGER NOT NULL,
    spot_id TEXT NOT NULL,
    text TEXT NOT NULL,
    pose BLOB NOT NULL
) STRICT;
)sql";

Expected<Database::Tables> fresh_tables() {
    SEAM_TRY(auto fresh,
             Database::open(":memory:", SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, kCaptureFile));
    SEAM_OK(fresh.execute(kTables));
    return fresh.tables();
}

constexpr auto kEventNames = std::to_array<std::string_view>({"trigger", "pose", "mode", "note"});

std::array<double, 12> pose_numbers(const Pose& pose) {
    std::array<double, 12> out;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column)
            out[static_cast<std::size_t>(row * 4 + column)] = pose.matrix()(row, column);
    return out;
}

tl::unexpected<Error> damaged(const fs::path& path, const Text& finding) {
    return file_error(Text("the capture is damaged ({})", finding), path.string(),
                      "record it again, or take a copy from the backup");
}

}  // namespace

std::string_view to_string(CaptureEventKind kind) {
    return kEventNames[static_cast<std::size_t>(kind)];
}

Expected<CaptureWriter> CaptureWriter::create(const fs::path& path, std::uint64_t limit_bytes) {
    std::error_code code;
    if (fs::exists(path, code))
        return file_error("the file exists already", path.string(), "choose another name");
    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    if (!fs::is_directory(folder, code))
        return file_error("the folder does not exist", folder.string(), "make it first");
    fs::remove(path.string() + "-journal", code);  // of a file that was deleted by hand
    SEAM_TRY(auto db,
             Database::open(path.string(), SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, kCaptureFile));
    CaptureWriter writer(path, std::move(db));
    const auto make = [&]() -> Expected<void> {
        Database& d = writer.db_;
        if (auto ok = d.execute(fmt::format("PRAGMA page_size = {}; PRAGMA journal_mode = TRUNCATE; PRAGMA "
                                            "cache_size = -16384",
                                            kPageBytes));
            !ok)
            return ok;
        SEAM_TRY(auto transaction, Transaction::begin(d));
        SEAM_OK(d.execute(kTables));
        if (auto ok = d.execute(fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}",
                                            kCaptureApplicationId, kCaptureVersion));
            !ok)
            return ok;
        SEAM_TRY(auto row, d.prepare("INSERT INTO capture VALUES (1, ?, '', '')"));
        row.bind(1, utc_now());
        SEAM_OK(row.run());
        SEAM_OK(transaction.commit());
        if (limit_bytes > 0)
            return d.execute(fmt::format("PRAGMA max_page_count = {}",
                                         std::max<std::uint64_t>(limit_bytes / kPageBytes, 1)));
        return {};
    };
    if (auto made = make(); !made) {
        fs::remove(path, code);
        return tl::unexpected(made.error());
    }
    return writer;
}

Expected<std::int64_t> CaptureWriter::add_source(const CaptureSource& s) {
    SEAM_TRY(auto row, db_.prepare("INSERT INTO sources VALUES (NULL, ?, ?, ?, ?, ?, ?, 0, 0, 0)"));
    SEAM_TRY(auto twice, db_.prepare("SELECT count(*) FROM sources WHERE name = ?"));
    twice.bind(1, s.name);
    SEAM_OK(twice.step());
    if (s.name.empty() || twice.integer(0) != 0)
        return input_error("every source of a capture needs a name of its own",
                           Text("source \"{}\"", s.name));
    twice.reset();
    row.bind(1, s.kind == SourceKind::sensor ? "sensor" : "robot");
    row.bind(2, s.name);
    row.bind(3, s.driver);
    row.bind(4, s.vendor);
    row.bind(5, s.model);
    row.bind(6, s.serial);
    SEAM_OK(row.run());
    return db_.last_rowid();
}

Expected<void> CaptureWriter::write(std::span<const Block> blocks, std::span<const CaptureEvent> events,
                                    const std::map<std::int64_t, CaptureCounters>& counters) {
    SEAM_TRY(auto transaction, Transaction::begin(db_));
    if (!blocks.empty()) {
        SEAM_TRY(auto row, db_.prepare("INSERT INTO blocks VALUES (NULL, ?, ?, ?, ?, ?, ?, ?)"));
        SEAM_TRY(auto spot, db_.prepare("INSERT INTO spots VALUES (?, ?, ?)"));
        for (const Block& b : blocks) {
            row.bind(1, b.source);
            row.bind(2, static_cast<std::int64_t>(b.first));
            row.bind(3, std::int64_t{b.frames});
            row.bind(4, b.first_host_ns);
            row.bind(5, b.last_host_ns);
            row.bind(6, static_cast<std::int64_t>(b.unpacked));
            row.bind(7, b.bytes);
            SEAM_OK(row.run());
            for (const auto& [frame, id] : b.spots) {
                spot.bind(1, b.source);
                spot.bind(2, static_cast<std::int64_t>(frame));
                spot.bind(3, id);
                SEAM_OK(spot.run());
            }
        }
    }
    if (!events.empty()) {
        SEAM_TRY(auto row, db_.prepare("INSERT INTO events VALUES (NULL, ?, ?, ?, ?, ?, ?)"));
        for (const CaptureEvent& e : events) {
            std::array<double, 12> numbers{};
            if (e.base_from_flange) numbers = pose_numbers(*e.base_from_flange);
            row.bind(1, e.source);
            row.bind(2, to_string(e.kind));
            row.bind(3, e.host_time_ns);
            row.bind(4, e.spot_id);
            row.bind(5, e.text);
            row.bind(6,
                     e.base_from_flange ? std::as_bytes(std::span(numbers)) : std::span<const std::byte>());
            SEAM_OK(row.run());
        }
    }
    if (!counters.empty()) {
        SEAM_TRY(auto row, db_.prepare("UPDATE sources SET damaged = ?, lost = ?, dropped = ? WHERE id = ?"));
        for (const auto& [source, c] : counters) {
            row.bind(1, static_cast<std::int64_t>(c.damaged));
            row.bind(2, static_cast<std::int64_t>(c.lost));
            row.bind(3, static_cast<std::int64_t>(c.dropped));
            row.bind(4, source);
            SEAM_OK(row.run());
        }
    }
    return transaction.commit();
}

Expected<void> CaptureWriter::finish(const std::string& how) {
    SEAM_TRY(auto row, db_.prepare("UPDATE capture SET finished_utc = ?, end = ?"));
    row.bind(1, utc_now());
    row.bind(2, how);
    return row.run();
}

SeamFile seam_file_kind(const fs::path& path) {
    std::error_code code;
    if (!fs::is_regular_file(path, code) || fs::file_size(path, code) == 0) return SeamFile::other;
    auto db = Database::open(path.string(), SQLITE_OPEN_READONLY, kCaptureFile);
    if (!db) return SeamFile::other;
    const auto id = db->integer("PRAGMA application_id");
    if (!id) return SeamFile::other;
    return *id == kCaptureApplicationId   ? SeamFile::capture
           : *id == kProjectApplicationId ? SeamFile::project
                                          : SeamFile::other;
}

Expected<CaptureReader> CaptureReader::open(const fs::path& path) {
    std::error_code code;
    if (!fs::exists(path, code)) return file_error("the file does not exist", path.string());
    if (!fs::is_regular_file(path, code))
        return file_error("this is no file", path.string(), "choose a .seam file");
    if (fs::file_size(path, code) == 0)
        return file_error("the file is empty", path.string(), "choose a .seam file");
    if (fs::exists(path.string() + "-journal", code)) {
        // A killed recorder left its journal; a read-only connection may not roll it back.
        if (auto healing = Database::open(path.string(), SQLITE_OPEN_READWRITE, kCaptureFile))
            (void)healing->integer("PRAGMA user_version");
    }
    SEAM_TRY(auto db, Database::open(path.string(), SQLITE_OPEN_READONLY, kCaptureFile));
    CaptureReader reader(path, std::move(db));
    SEAM_TRY(auto id, reader.db_.integer("PRAGMA application_id"));
    if (id == kProjectApplicationId)
        return file_error("this is a project, no recorded capture", path.string(),
                          "choose the file that `seamwright record` wrote");
    if (id != kCaptureApplicationId)
        return file_error("this is another program's database, no capture", path.string(),
                          "choose the file that `seamwright record` wrote");
    SEAM_TRY(auto version, reader.db_.integer("PRAGMA user_version"));
    if (version > kCaptureVersion)
        return file_error(
            Text("the capture has version {}, this program knows up to {}", version, kCaptureVersion),
            path.string(), "open it with a newer Seamwright");
    if (version < 1) return file_error("the capture has no valid version", path.string());
    SEAM_OK(reader.db_.check_length());
    static const Expected<Database::Tables> wanted = fresh_tables();
    if (!wanted) return tl::unexpected(wanted.error());
    SEAM_TRY(const auto found, reader.db_.tables());
    if (found != *wanted) return damaged(path, "its tables are not those of a capture");
    SEAM_OK(reader.read_tables());
    return reader;
}

Expected<void> CaptureReader::read_tables() {
    const auto rows = [&](const char* sql, auto each) -> Expected<void> {
        SEAM_TRY(auto s, db_.prepare(sql));
        for (;;) {
            SEAM_TRY(auto row, s.step());
            if (!row) return {};
            Expected<void> done = each(s);
            if (done) done = s.row_ok();
            if (!done) return done;
        }
    };
    // One read transaction: a recorder that is still writing adds its blocks before or after.
    SEAM_OK(db_.execute("BEGIN"));
    bool head = false;
    if (auto ok = rows("SELECT started_utc, finished_utc, end FROM capture",
                       [&](Statement& s) -> Expected<void> {
                           head = true;
                           started_utc_ = s.text(0);
                           finished_utc_ = s.text(1);
                           end_ = s.text(2);
                           return {};
                       });
        !ok)
        return ok;
    if (!head) return damaged(path_, "its head is missing");
    if (auto ok = rows("SELECT id, kind, name, driver, vendor, model, serial, damaged, lost, dropped FROM "
                       "sources ORDER BY id",
                       [&](Statement& s) -> Expected<void> {
                           CaptureSource& source = sources_.emplace_back();
                           source.id = s.integer(0);
                           source.kind = s.text(1) == "robot" ? SourceKind::robot : SourceKind::sensor;
                           source.name = s.text(2);
                           source.driver = s.text(3);
                           source.vendor = s.text(4);
                           source.model = s.text(5);
                           source.serial = s.text(6);
                           const std::int64_t d = s.integer(7), l = s.integer(8), o = s.integer(9);
                           if (d < 0 || l < 0 || o < 0) return damaged(path_, "a counter is negative");
                           source.counters.damaged = static_cast<std::uint64_t>(d);
                           source.counters.lost = static_cast<std::uint64_t>(l);
                           source.counters.dropped = static_cast<std::uint64_t>(o);
                           return {};
                       });
        !ok)
        return ok;
    if (auto ok = rows("SELECT id, source, first, frames, first_host_ns, last_host_ns, unpacked FROM blocks "
                       "ORDER BY id",
                       [&](Statement& s) -> Expected<void> {
                           BlockRow b;
                           b.id = s.integer(0);
                           b.source = s.integer(1);
                           const std::int64_t first = s.integer(2), frames = s.integer(3),
                                              unpacked = s.integer(6);
                           const auto source = std::find_if(sources_.begin(), sources_.end(),
                                                            [&](auto& x) { return x.id == b.source; });
                           // Blocks are committed in order, so that nothing may be missing in between.
                           if (source == sources_.end() || frames < 1 || frames > (1 << 28) ||
                               first != static_cast<std::int64_t>(source->counters.frames) || unpacked < 0 ||
                               unpacked > static_cast<std::int64_t>(kMaxUnpacked))
                               return damaged(path_, fmt::format("block {} does not fit in", b.id));
                           b.first = source->counters.frames;
                           b.frames = static_cast<int>(frames);
                           b.unpacked = static_cast<std::size_t>(unpacked);
                           if (source->counters.frames == 0) source->first_host_ns = s.integer(4);
                           source->last_host_ns = s.integer(5);
                           source->counters.frames += static_cast<std::uint64_t>(frames);
                           blocks_[b.source].push_back(b);
                           return {};
                       });
        !ok)
        return ok;
    return db_.execute("ROLLBACK");
}

const CaptureSource* CaptureReader::find(const std::string& name, SourceKind kind) const {
    const CaptureSource* found = nullptr;
    for (const CaptureSource& s : sources_) {
        if (s.kind != kind || (!name.empty() && s.name != name)) continue;
        if (found) return nullptr;
        found = &s;
    }
    return found;
}

double CaptureReader::duration_s() const {
    std::int64_t first = std::numeric_limits<std::int64_t>::max(),
                 last = std::numeric_limits<std::int64_t>::min();
    for (const CaptureSource& s : sources_) {
        if (s.counters.frames == 0) continue;
        first = std::min(first, s.first_host_ns);
        last = std::max(last, s.last_host_ns);
    }
    return last > first ? (static_cast<double>(last) - static_cast<double>(first)) * 1e-9 : 0;
}

std::uint64_t CaptureReader::frames(std::int64_t source) const {
    const auto it = blocks_.find(source);
    if (it == blocks_.end()) return 0;
    const BlockRow& last = it->second.back();
    return last.first + static_cast<std::uint64_t>(last.frames);
}

Expected<void> CaptureReader::decode(const BlockRow& row, std::vector<Capture>& frames) {
    frames.clear();
    const std::string where = fmt::format("{}, block {}", path_.string(), row.id);
    SEAM_TRY(auto s, db_.prepare("SELECT data FROM blocks WHERE id = ?"));
    s.bind(1, row.id);
    SEAM_TRY(auto found, s.step());
    if (!found) return file_error("the block of frames is gone", where);
    std::span<const std::byte> data = s.blob(0);
    SEAM_OK(s.row_ok());
    std::vector<std::byte> unpacked;
    if (row.unpacked > 0) {
        // zlib packs no more than about 1030 to 1; a forged size takes no memory.
        if (row.unpacked / 1100 > data.size()) return file_error("the block of frames is not whole", where);
        unpacked.resize(row.unpacked);
        uLongf size = static_cast<uLongf>(unpacked.size());
        if (::uncompress(reinterpret_cast<Bytef*>(unpacked.data()), &size,
                         reinterpret_cast<const Bytef*>(data.data()),
                         static_cast<uLong>(data.size())) != Z_OK ||
            size != unpacked.size())
            return file_error("the block of frames cannot be unpacked: the file is damaged", where);
        data = unpacked;
    }
    SEAM_OK(unpack_frames(data, where, frames));
    if (frames.size() != static_cast<std::size_t>(row.frames))
        return file_error("the block holds another number of frames than it says", where);
    return {};
}

Expected<const Capture*> CaptureReader::frame(std::int64_t source, std::uint64_t number) {
    if (number >= frames(source)) return input_error(Text("there is no frame {}", number), path_.string());
    const std::vector<BlockRow>& rows = blocks_[source];
    const BlockRow& row = *std::prev(std::upper_bound(
        rows.begin(), rows.end(), number, [](std::uint64_t n, const BlockRow& b) { return n < b.first; }));
    Decoded& decoded = decoded_[source];
    if (decoded.block != row.id || decoded.frames.empty()) {
        decoded.block = row.id;
        if (auto ok = decode(row, decoded.frames); !ok) {
            decoded.frames.clear();
            return tl::unexpected(ok.error());
        }
    }
    return &decoded.frames[static_cast<std::size_t>(number - row.first)];
}

Expected<std::vector<std::pair<std::uint64_t, std::string>>> CaptureReader::spots(std::int64_t source) {
    SEAM_TRY(auto s, db_.prepare("SELECT frame, spot_id FROM spots WHERE source = ? ORDER BY frame"));
    s.bind(1, source);
    std::vector<std::pair<std::uint64_t, std::string>> out;
    for (;;) {
        SEAM_TRY(auto row, s.step());
        if (!row) return out;
        const std::int64_t frame = s.integer(0);
        out.emplace_back(static_cast<std::uint64_t>(frame), s.text(1));
        SEAM_OK(s.row_ok());
        if (frame < 0 || out.back().first >= frames(source))
            return damaged(path_, "a spot names a frame that is not there");
    }
}

Expected<std::vector<CaptureEvent>> CaptureReader::events(std::int64_t source) {
    SEAM_TRY(auto s, db_.prepare("SELECT source, kind, host_time_ns, spot_id, text, pose FROM events WHERE "
                                 "?1 = 0 OR source = ?1 ORDER BY host_time_ns, id"));
    s.bind(1, source);
    std::vector<CaptureEvent> out;
    for (;;) {
        SEAM_TRY(auto row, s.step());
        if (!row) return out;
        CaptureEvent& e = out.emplace_back();
        e.source = s.integer(0);
        const std::string kind = s.text(1);
        const auto name = std::find(kEventNames.begin(), kEventNames.end(), kind);
        if (name == kEventNames.end()) return damaged(path_, "an event of no known kind");
        e.kind = static_cast<CaptureEventKind>(name - kEventNames.begin());
        e.host_time_ns = s.integer(2);
        e.spot_id = s.text(3);
        e.text = s.text(4);
        const auto pose = s.blob(5);
        if (!pose.empty()) {
            std::array<double, 12> numbers;
            if (pose.size() != sizeof numbers) return damaged(path_, "a pose of another size");
            std::memcpy(numbers.data(), pose.data(), sizeof numbers);
            Pose p = Pose::Identity();
            for (int r = 0; r < 3; ++r)
                for (int c = 0; c < 4; ++c) p.matrix()(r, c) = numbers[static_cast<std::size_t>(r * 4 + c)];
            e.base_from_flange = p;
        }
        SEAM_OK(s.row_ok());
    }
}

std::vector<Error> CaptureReader::check() {
    std::vector<Error> findings;
    const auto note = [&](const auto& result) {
        if (!result) findings.push_back(result.error());
    };
    const auto sqlite = [&]() -> Expected<void> {
        SEAM_TRY(auto s, db_.prepare("PRAGMA integrity_check(1)"));
        SEAM_TRY(auto row, s.step());
        if (const std::string answer = row ? s.text(0) : "no answer"; answer != "ok")
            return damaged(path_, answer);
        return {};
    };
    note(sqlite());
    std::vector<Capture> frames;
    for (const CaptureSource& source : sources_) {
        const auto it = blocks_.find(source.id);
        if (it != blocks_.end())
            for (const BlockRow& row : it->second) note(decode(row, frames));
        note(spots(source.id));
    }
    note(events());
    return findings;
}

}  // namespace seamwright
