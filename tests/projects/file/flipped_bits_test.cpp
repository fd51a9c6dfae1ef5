#include "tests/projects/file/flipped_bits_test.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <sstream>

#include "devices/capture/profile_blob.h"
#include "projects/file/project_file.h"
#include "projects/file/row_checksum.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;

void make_full_file(const fs::path& path) {
    Project project = sample_project();
    project.part_types = {{"left", "door left", 1}, {"right", "", 0}};
    project.fixture = Fixture{"fixture", {{"locator 1", {1, 2, 3}, {{0, 0, 1}}}}, "-C([0-9]+)$"};
    project.fleet = FleetLink{"fleet", "postgresql://seam@db.plant/fleet", "line 2"};
    auto file = ProjectFile::create(path, project);
    ASSERT_TRUE(file) << file.error().sentence();
    for (unsigned i = 1; i <= 2; ++i) ASSERT_TRUE(file->append_run(sample_run(i, 3, 40), project));
    RunRecord panel = sample_run(3, 1, 20);
    panel.type_id = "left";
    panel.panel = sample_panel_record(3);
    ASSERT_TRUE(file->append_run(panel, project));
    for (int kind = 0; kind < kSampleEvidence; ++kind)
        ASSERT_TRUE(file->append_evidence(sample_evidence(kind), project));
    DriftPoint point;
    point.run = 2;
    point.utc = "2024-05-01T12:00:00.000Z";
    point.values_mm = {1.0 / 3, -0.25};
    point.sigma_mm = {0.1, 0.1};
    ASSERT_TRUE(file->append_drift_point(point));
    ASSERT_TRUE(file->append_event({0, "2024-05-01T12:00:02.000Z", 0, EventKind::note, "desk", "a word"}));
    ASSERT_TRUE(file->add_user("ada", Role::administrator, "correct horse battery"));
    ASSERT_TRUE(file->sign_in("ada", "correct horse battery"));
    ASSERT_TRUE(file->keep_guide("top.csv", "x_mm,y_mm,z_mm,a_deg,b_deg,c_deg\n1,2,3,0,0,0\n"));
    for (const char* name : {"first", "second"})
        ASSERT_TRUE(file->append_scan({name, "2024-05-01T12:00:03.000Z", "A", "R1", "spots S1, S2", 12, 3400,
                                       std::vector<std::byte>(300, std::byte{0x5a})}));
}

// Everything that a project file says, to the last bit; nullopt: it says that it is damaged.
std::optional<std::string> all_of(const fs::path& path) {
    auto file = ProjectFile::open(path, FileAccess::read_only);
    if (!file) {
        EXPECT_EQ(file.error().kind, ErrorKind::file) << file.error().sentence();
        return std::nullopt;
    }
    std::ostringstream all;
    const auto project = file->load();
    if (!project) return std::nullopt;
    all << exact_text(*project);
    for (const std::byte b : project->part.mesh_ply) all << static_cast<char>(b);
    const auto runs = file->runs();
    if (!runs) return std::nullopt;
    for (const RunSummary& summary : *runs) {
        all << summary.number << summary.part_id << summary.type_id << summary.started_utc
            << summary.finished_utc << summary.push << to_string(summary.status) << summary.message
            << summary.spots << summary.captures << summary.setup;
        const auto run = file->load_run(summary.number);
        const auto setup = file->load_setup(summary.setup);
        if (!run || !setup) return std::nullopt;
        all << exact_text(*setup);
        for (const auto& spot : run->spots) all << exact_text(spot);
        for (const auto& region : run->regions) all << exact_text(region);
        if (run->panel) all << exact_text(*run->panel);
        const auto blobs = pack_captures(run->captures);
        EXPECT_TRUE(blobs);
        for (const CaptureBlob& blob : *blobs)
            all.write(reinterpret_cast<const char*>(blob.bytes.data()),
                      static_cast<std::streamsize>(blob.bytes.size()));
        for (const Capture& capture : run->captures)
            if (capture.image) {
                all << capture.image->width << 'x' << capture.image->height << 'x'
                    << capture.image->bit_depth;
                for (const std::byte b : capture.image->pixels) all << static_cast<char>(b);
            }
        for (const EventRecord& event : run->events) all << event.id << event.text;
    }
    const auto events = file->events();
    const auto evidence = file->evidence();
    const auto points = file->drift_points();
    if (!events || !evidence || !points) return std::nullopt;
    for (const DriftPoint& point : *points) all << exact_text(point);
    for (const EventRecord& event : *events)
        all << event.id << event.utc << event.run << to_string(event.kind) << event.subject << event.text;
    for (const Evidence& e : *evidence) {
        all << e.id << e.utc << e.setup;
        std::visit([&](const auto& what) { all << exact_text(what); }, e.what);
    }
    const auto scans = file->scans();
    if (!scans) return std::nullopt;
    for (const StoredScan& s : *scans) {
        const auto scan = file->load_scan(s.name);
        if (!scan) return std::nullopt;
        all << scan->name << scan->utc << scan->sensor_id << scan->robot_id << scan->path << scan->profiles
            << ' ' << scan->points;
        for (const std::byte b : scan->cloud_ply) all << static_cast<char>(b);
    }
    const auto guides = file->guides();
    if (!guides) return std::nullopt;
    for (const StoredGuide& g : *guides) all << g.name << g.csv << g.utc << g.hash;
    if (!file->check().empty()) return std::nullopt;
    return all.str();
}

}  // namespace

void flip_bits_of_the_file(int flips, unsigned seed, std::size_t header_step) {
    const TemporaryFolder folder;
    const fs::path path = folder / "a.seam", flipped = folder / "flipped.seam";
    make_full_file(path);
    const std::string whole = file_bytes(path);
    const auto as_written = all_of(path);
    ASSERT_TRUE(as_written);
    std::mt19937 rng(seed);
    const std::size_t header_bits = 800 / header_step;
    int noticed = 0, harmless = 0;
    for (std::size_t i = 0; i < header_bits + static_cast<std::size_t>(flips); ++i) {
        const std::size_t bit = i < header_bits ? i * header_step : rng() % (8 * whole.size());
        std::string bytes = whole;
        bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ (1 << bit % 8));
        write_bytes(flipped, bytes);
        const auto read = all_of(flipped);
        if (!read) {
            ++noticed;
            continue;
        }
        ++harmless;
        ASSERT_EQ(*read == *as_written, true)
            << "bit " << bit << " of " << 8 * whole.size() << " went unnoticed";
    }
    std::printf("flipped bits of the file: %d noticed, %d read as before, none read otherwise\n", noticed,
                harmless);
    EXPECT_GT(noticed, flips / 3);  // the rest lies in the unused part of pages
}

void flip_bits_of_the_rows(int flips, unsigned seed) {
    const TemporaryFolder folder;
    const fs::path path = folder / "a.seam", flipped = folder / "flipped.seam";
    make_full_file(path);
    const std::string whole = file_bytes(path);
    std::mt19937 rng(seed);
    std::map<std::string, int> by_table;
    for (int i = 0; i < flips; ++i) {
        write_bytes(flipped, whole);
        const ChecksummedTable& table = checksummed_tables()[rng() % checksummed_tables().size()];
        std::vector<std::string> columns{"checksum"};
        for (std::stringstream names(table.columns); names.good();) {
            std::string name;
            std::getline(names >> std::ws, name, ',');
            columns.push_back(name);
        }
        const std::string column = columns[rng() % columns.size()];
        std::string what;
        {
            auto db = Database::open(flipped.string(), SQLITE_OPEN_READWRITE).value();
            ASSERT_TRUE(db.execute(
                "PRAGMA foreign_keys = OFF; PRAGMA synchronous = OFF; PRAGMA ignore_check_constraints = ON"));
            const std::string name = table.name;
            const bool by_run = name == "run_spots" || name == "run_regions" || name == "run_panels";
            const std::string row = name == "run_panels" ? "run" : by_run ? "run * 1000 + position" : "rowid";
            const auto rows = db.integer("SELECT count(*) FROM " + name).value();
            ASSERT_GT(rows, 0) << name;
            const auto key = db.integer(fmt::format("SELECT {} FROM {} LIMIT 1 OFFSET {}", row, name,
                                                    rng() % static_cast<std::uint64_t>(rows)))
                                 .value();
            auto read = db.prepare(fmt::format("SELECT typeof({0}), CAST({0} AS BLOB), length(CAST({0} AS "
                                               "BLOB)) FROM {1} WHERE {2} = {3}",
                                               column, name, row, key))
                            .value();
            ASSERT_TRUE(read.step().value());
            const std::string type = read.text(0);
            const auto old = read.blob(1);
            std::vector<std::byte> value(old.begin(), old.end());
            read.reset();
            what = fmt::format("{}.{} of row {}", name, column, key);
            if (type == "integer") {
                const auto number =
                    db.integer(fmt::format("SELECT {} FROM {} WHERE {} = {}", column, name, row, key))
                        .value();
                // A key that another row has already: SQLite refuses it by itself.
                if (!db.execute(fmt::format("UPDATE {0} SET {1} = {2} WHERE {3} = {4}", name, column,
                                            number ^ (std::int64_t{1} << rng() % 31), row, key)))
                    continue;
            } else {
                if (value.empty()) continue;
                const std::size_t at = rng() % value.size();
                value[at] ^= static_cast<std::byte>(1 << rng() % 8);
                auto write = db.prepare(fmt::format("UPDATE {} SET {} = CAST(? AS {}) WHERE {} = {}", name,
                                                    column, type, row, key))
                                 .value();
                write.bind(1, std::span<const std::byte>(value));
                if (!write.run()) continue;
            }
        }
        ++by_table[table.name];
        {
            const auto file =
                ProjectFile::open(flipped, i % 8 ? FileAccess::read_only : FileAccess::read_write);
            ASSERT_FALSE(file) << what << " went unnoticed";
            EXPECT_EQ(file.error().kind, ErrorKind::file) << file.error().sentence();
        }
    }
    EXPECT_EQ(by_table.size(), checksummed_tables().size());
}

}  // namespace seamwright
