#include "projects/file/project_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <fstream>
#include <optional>

#include "devices/capture/profile_blob.h"
#include "devices/capture/sqlite.h"
#include "projects/file/schema.h"
#include "tests/projects/file/kill_test.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST(ProjectFile, RoundTripIsExact) {
    TemporaryFolder folder;
    const Project project = sample_project();
    {
        auto file = ProjectFile::create(folder / "a.seam", project);
        ASSERT_TRUE(file) << file.error().sentence();
    }
    auto file = ProjectFile::open(folder / "a.seam");
    ASSERT_TRUE(file) << file.error().sentence();
    auto loaded = file->load();
    ASSERT_TRUE(loaded) << loaded.error().sentence();
    EXPECT_EQ(exact_text(*loaded), exact_text(project));
    EXPECT_EQ(loaded->part.mesh_ply, project.part.mesh_ply);
    for (std::size_t i = 0; i < project.spots.size(); ++i) {
        EXPECT_TRUE(same_bits(loaded->spots[i].reference_profile, project.spots[i].reference_profile));
        EXPECT_TRUE(
            same_bits(loaded->spots[i].feature.template_profile, project.spots[i].feature.template_profile));
        EXPECT_EQ(loaded->spots[i].base_from_flange.matrix(), project.spots[i].base_from_flange.matrix());
        ASSERT_EQ(loaded->spots[i].via.size(), i % 3);
        for (std::size_t k = 0; k < i % 3; ++k)
            EXPECT_EQ(loaded->spots[i].via[k].matrix(), project.spots[i].via[k].matrix());
    }
    EXPECT_TRUE(std::signbit(loaded->spots[0].feature.template_reference_mm.y()));
    EXPECT_TRUE(file->check().empty());
    EXPECT_FALSE(fs::exists(folder / "a.seam-journal"));
}

TEST(ProjectFile, EmptyProjectRoundTrips) {
    TemporaryFolder folder;
    auto file = ProjectFile::create(folder / "a.seam", Project{});
    ASSERT_TRUE(file) << file.error().sentence();
    auto loaded = file->load();
    ASSERT_TRUE(loaded) << loaded.error().sentence();
    EXPECT_EQ(exact_text(*loaded), exact_text(Project{}));
}

TEST(ProjectFile, SavesEditsReordersAndDeletes) {
    TemporaryFolder folder;
    Project project = sample_project();
    auto file = ProjectFile::create(folder / "a.seam", project);
    ASSERT_TRUE(file);
    project.name = "other";
    std::swap(project.spots[0], project.spots[3]);
    project.spots.erase(project.spots.begin() + 1);
    project.spots[2].reference_profile.z_mm[0] += 1e-9;
    project.regions[0].limits.rotation_deg = 1.25;
    project.calibrations[0].raw["more"] = 1;
    ASSERT_TRUE(file->save(project));
    auto loaded = ProjectFile::open(folder / "a.seam")->load();
    ASSERT_TRUE(loaded);
    EXPECT_EQ(exact_text(*loaded), exact_text(project));
}

TEST(ProjectFile, RefusesWhatCouldNotBeReadAgain) {
    TemporaryFolder folder;
    const Project good = sample_project();
    auto file = ProjectFile::create(folder / "a.seam", good);
    ASSERT_TRUE(file);
    const auto refused = [&](auto edit) {
        Project bad = good;
        edit(bad);
        auto saved = file->save(bad);
        EXPECT_FALSE(saved);
        if (!saved) {
            EXPECT_EQ(saved.error().kind, ErrorKind::input);
        }
        EXPECT_EQ(exact_text(*file->load()), exact_text(good)) << "a refused save must change nothing";
        return saved ? std::string() : saved.error().sentence();
    };
    EXPECT_THAT(refused([](Project& p) { p.spots[1].id = p.spots[0].id; }),
                HasSubstr("two spots are called \"S1\""));
    EXPECT_THAT(refused([](Project& p) { p.sensors[0].id = ""; }), HasSubstr("no id"));
    EXPECT_THAT(refused([](Project& p) { p.spots[2].base_from_flange.translation().x() = std::nan(""); }),
                HasSubstr("spot S3"));
    EXPECT_THAT(refused([](Project& p) { p.regions[0].base_from_frame.linear() *= 1.1; }),
                HasSubstr("orthonormal"));
    EXPECT_THAT(refused([](Project& p) { p.spots[2].reference_profile.z_mm.pop_back(); }),
                HasSubstr("spot S3"));
    EXPECT_THAT(refused([](Project& p) { p.spots[2].id = "\xff\xfe"; }), HasSubstr("UTF-8"));
    EXPECT_THAT(refused([](Project& p) { p.name = "\xc3"; }), HasSubstr("UTF-8"));
}

TEST(ProjectFile, RunsRoundTripExactly) {
    TemporaryFolder folder;
    Project project = sample_project();
    auto file = ProjectFile::create(folder / "a.seam", project);
    ASSERT_TRUE(file);
    const RunRecord first = sample_run(1),
                    second = sample_run(2, 40, 3000);  // the second fills several blobs
    auto one = file->append_run(first, project);
    ASSERT_TRUE(one) << one.error().sentence();
    Project edited = project;
    edited.spots.pop_back();
    auto two = file->append_run(second, edited);
    ASSERT_TRUE(two) << two.error().sentence();
    EXPECT_EQ(*one, 1);
    EXPECT_EQ(*two, 2);
    for (const auto& [number, expected] : {std::pair(*one, first), std::pair(*two, second)}) {
        auto run = file->load_run(number);
        ASSERT_TRUE(run) << run.error().sentence();
        EXPECT_EQ(run->part_id, expected.part_id);
        EXPECT_EQ(run->started_utc, expected.started_utc);
        EXPECT_EQ(run->finished_utc, expected.finished_utc);
        EXPECT_EQ(run->push, expected.push);
        EXPECT_EQ(run->status, expected.status);
        EXPECT_EQ(run->message, expected.message);
        ASSERT_EQ(run->spots.size(), expected.spots.size());
        for (std::size_t i = 0; i < run->spots.size(); ++i)
            EXPECT_EQ(exact_text(run->spots[i]), exact_text(expected.spots[i]));
        ASSERT_EQ(run->regions.size(), 1u);
        EXPECT_EQ(exact_text(run->regions[0]), exact_text(expected.regions[0]));
        ASSERT_EQ(run->captures.size(), expected.captures.size());
        for (std::size_t i = 0; i < run->captures.size(); ++i)
            EXPECT_TRUE(same_bits(run->captures[i], expected.captures[i])) << i;
        ASSERT_EQ(run->events.size(), 1u);
        EXPECT_EQ(run->events[0].run, number);
        EXPECT_EQ(run->events[0].text, "because");
        EXPECT_EQ(file->load_run(number, false)->captures.size(), 0u);
    }
    auto list = file->runs();
    ASSERT_TRUE(list);
    ASSERT_EQ(list->size(), 2u);
    EXPECT_EQ((*list)[1].captures, 40);
    EXPECT_NE((*list)[0].setup, (*list)[1].setup);
    EXPECT_EQ(file->load_run_setup(2)->spots.size(), project.spots.size() - 1);
    EXPECT_EQ(file->load_run_setup(1)->spots.size(), project.spots.size());
    EXPECT_TRUE(same_bits(file->load_run_setup(1)->spots[1].feature.template_profile,
                          project.spots[1].feature.template_profile));
    EXPECT_FALSE(file->load_run(3));
    EXPECT_FALSE(file->load_run(0));

    RunRecord changed = first;
    changed.number = 1;
    changed.status = RunStatus::ok;
    changed.regions[0].push.status = PushStatus::written;
    ASSERT_TRUE(file->update_run(changed));
    EXPECT_EQ(file->load_run(1)->status, RunStatus::ok);
    EXPECT_EQ(file->load_run(1)->regions[0].push.status, PushStatus::written);
    EXPECT_EQ(file->load_run(1)->captures.size(), first.captures.size());
    changed.number = 77;
    EXPECT_FALSE(file->update_run(changed));

    ASSERT_TRUE(file->delete_run(1));
    EXPECT_EQ(file->runs()->size(), 1u);
    EXPECT_EQ(*file->append_run(first, project), 3) << "numbers are never given twice";
    EXPECT_TRUE(file->check().empty());
}

// A controller's message in Latin-1 must not keep a run from being recorded.
TEST(ProjectFile, MessagesInOtherBytesAreKeptReadable) {
    TemporaryFolder folder;
    auto file = ProjectFile::create(folder / "a.seam", sample_project());
    RunRecord run = sample_run(1);
    run.part_id = "St\xf6rung";
    run.message = run.spots[0].message = run.regions[0].refusals[0] = run.events[0].text = Text(run.part_id);
    Project setup = sample_project();
    setup.sensors[0].identity.serial = "\xff";
    auto number = file->append_run(run, setup);
    ASSERT_TRUE(number) << number.error().sentence();
    run.number = *number;
    ASSERT_TRUE(file->update_run(run));
    ASSERT_TRUE(file->append_event({0, "", 0, EventKind::alarm, "\xfe", "\xff"}));
    auto loaded = file->load_run(*number);
    ASSERT_TRUE(loaded) << loaded.error().sentence();
    EXPECT_EQ(loaded->message, "St\xef\xbf\xbdrung");
    EXPECT_EQ(loaded->regions[0].refusals[0], loaded->message);
    EXPECT_TRUE(file->load_run_setup(*number));
    EXPECT_TRUE(file->check().empty());
}

TEST(ProjectFile, EventsKeepTheirOrder) {
    TemporaryFolder folder;
    auto file = ProjectFile::create(folder / "a.seam", Project{});
    ASSERT_TRUE(file);
    for (int i = 0; i < 5; ++i)
        ASSERT_TRUE(
            file->append_event({0, "", i % 2, EventKind::alarm, "frame", "text " + std::to_string(i)}));
    auto all = ProjectFile::open(folder / "a.seam", FileAccess::read_only)->events();
    ASSERT_TRUE(all);
    ASSERT_EQ(all->size(), 5u);
    EXPECT_EQ((*all)[4].text, "text 4");
    EXPECT_EQ((*all)[4].kind, EventKind::alarm);
    EXPECT_EQ((*all)[4].utc.size(), 24u);
    EXPECT_EQ(file->events(1)->size(), 2u);
}

TEST(ProjectFile, CreateNeverOverwritesUnasked) {
    TemporaryFolder folder;
    ASSERT_TRUE(ProjectFile::create(folder / "a.seam", sample_project()));
    auto again = ProjectFile::create(folder / "a.seam", Project{});
    ASSERT_FALSE(again);
    EXPECT_EQ(again.error().kind, ErrorKind::file);
    ASSERT_TRUE(ProjectFile::create(folder / "a.seam", Project{}, true));
    EXPECT_TRUE(ProjectFile::open(folder / "a.seam")->load()->spots.empty());
    write_bytes(folder / "letter.txt", "Dear reader, this is not a database at all.");
    auto foreign = ProjectFile::create(folder / "letter.txt", Project{}, true);
    ASSERT_FALSE(foreign);
    EXPECT_EQ(file_bytes(folder / "letter.txt"), "Dear reader, this is not a database at all.");
    EXPECT_FALSE(ProjectFile::create(folder / "no/such/folder/a.seam", Project{}));
    EXPECT_FALSE(ProjectFile::create(folder.path(), Project{}, true));
    std::size_t left = 0;
    for (const auto& entry : fs::directory_iterator(folder.path())) left += entry.is_regular_file();
    EXPECT_EQ(left, 2u) << "no temporary files stay";
}

TEST(ProjectFile, AStaleJournalOfADeletedFileIsNeverApplied) {
    TemporaryFolder folder;
    write_bytes(folder / "a.seam-journal", std::string(4096, '\x55'));
    auto file = ProjectFile::create(folder / "a.seam", sample_project());
    ASSERT_TRUE(file) << file.error().sentence();
    EXPECT_TRUE(file->check().empty());
}

// A killed maker leaves its unfinished file; the next who makes one clears it away, and nothing else.
TEST(ProjectFile, AbandonedUnfinishedFilesAreClearedAway) {
    TemporaryFolder folder;
    const pid_t dead = ::fork();
    if (dead == 0) ::_exit(0);
    ::waitpid(dead, nullptr, 0);
    const std::string of_dead = std::to_string(dead), of_living = std::to_string(::getppid());
    const auto leave = [&](const std::string& name, std::chrono::minutes age) {
        write_bytes(folder / name, "half");
        std::filesystem::last_write_time(folder / name, std::filesystem::file_time_type::clock::now() - age);
    };
    using std::chrono::minutes;
    leave("a.seam.new-" + of_dead, minutes(5));
    leave("a.seam.new-" + of_dead + "-journal", minutes(5));
    leave("b.seam.new-" + of_dead, minutes(5));
    leave("a.seam.new-parts.seam", minutes(5));
    leave("a.seam.new-" + of_dead + " copy.seam", minutes(5));
    leave("a.seam.new-" + of_living, minutes(5));
    leave("a.seam.new-" + of_dead + "-wal", minutes(0));
    ASSERT_TRUE(ProjectFile::create(folder / "a.seam", sample_project()));
    EXPECT_FALSE(std::filesystem::exists(folder / ("a.seam.new-" + of_dead)));
    EXPECT_FALSE(std::filesystem::exists(folder / ("a.seam.new-" + of_dead + "-journal")));
    EXPECT_TRUE(std::filesystem::exists(folder / ("b.seam.new-" + of_dead))) << "another file's";
    EXPECT_TRUE(std::filesystem::exists(folder / "a.seam.new-parts.seam")) << "a person's";
    EXPECT_TRUE(std::filesystem::exists(folder / ("a.seam.new-" + of_dead + " copy.seam"))) << "a person's";
    EXPECT_TRUE(std::filesystem::exists(folder / ("a.seam.new-" + of_living))) << "still being made";
    EXPECT_TRUE(std::filesystem::exists(folder / ("a.seam.new-" + of_dead + "-wal"))) << "too young";
}

TEST(ProjectFile, ReadOnlyDoesNotWrite) {
    TemporaryFolder folder;
    ASSERT_TRUE(ProjectFile::create(folder / "a.seam", sample_project()));
    auto file = ProjectFile::open(folder / "a.seam", FileAccess::read_only);
    ASSERT_TRUE(file);
    EXPECT_TRUE(file->load());
    EXPECT_FALSE(file->save(Project{}));
    EXPECT_FALSE(file->append_event({}));
}

// --- hostile files

void expect_refused(const fs::path& path, const char* words) {
    for (const FileAccess access : {FileAccess::read_only, FileAccess::read_write}) {
        auto file = ProjectFile::open(path, access);
        ASSERT_FALSE(file) << path;
        EXPECT_EQ(file.error().kind, ErrorKind::file);
        EXPECT_THAT(file.error().sentence(), HasSubstr(words));
        EXPECT_THAT(file.error().sentence(), HasSubstr(path.filename().string()));
    }
}

class HostileFile : public testing::Test {
  protected:
    void SetUp() override {
        auto file = ProjectFile::create(path, sample_project());
        ASSERT_TRUE(file);
        ASSERT_TRUE(file->append_run(sample_run(1), sample_project()));
    }
    void sql(const std::string& text) {
        sqlite3* db = nullptr;
        ASSERT_EQ(sqlite3_open(path.c_str(), &db), SQLITE_OK);
        char* message = nullptr;
        EXPECT_EQ(sqlite3_exec(db, text.c_str(), nullptr, nullptr, &message), SQLITE_OK) << message;
        sqlite3_free(message);
        sqlite3_close(db);
    }
    TemporaryFolder folder;
    fs::path path = folder / "a.seam";
};

TEST_F(HostileFile, ForeignEmptyMissing) {
    expect_refused(folder / "missing.seam", "does not exist");
    write_bytes(folder / "empty.seam", "");
    expect_refused(folder / "empty.seam", "empty");
    write_bytes(folder / "text.seam", "hello\n");
    expect_refused(folder / "text.seam", "no project file");
    write_bytes(folder / "long.seam", std::string(100000, 'x'));
    expect_refused(folder / "long.seam", "no project file");
    write_bytes(folder / "zero.seam", std::string(8192, '\0'));
    expect_refused(folder / "zero.seam", "no project file");
    fs::create_directory(folder / "folder.seam");
    expect_refused(folder / "folder.seam", "no file");
    sqlite3* db = nullptr;
    ASSERT_EQ(sqlite3_open((folder / "other.seam").c_str(), &db), SQLITE_OK);
    ASSERT_EQ(sqlite3_exec(db, "CREATE TABLE t(x)", nullptr, nullptr, nullptr), SQLITE_OK);
    sqlite3_close(db);
    expect_refused(folder / "other.seam", "another program's");
}

TEST_F(HostileFile, NewerVersion) {
    sql("PRAGMA user_version = 9999");
    expect_refused(path, "newer Seamwright");
}

TEST_F(HostileFile, NegativeVersion) {
    sql("PRAGMA user_version = -5");
    expect_refused(path, "no valid version");
}

TEST_F(HostileFile, PlantedTriggerOrView) {
    sql("CREATE TRIGGER evil AFTER INSERT ON runs BEGIN DELETE FROM events; END");
    expect_refused(path, "tables");
    sql("DROP TRIGGER evil; CREATE VIEW evil AS SELECT * FROM runs");
    expect_refused(path, "tables");
    sql("DROP VIEW evil; DROP TABLE events");
    expect_refused(path, "tables");
}

TEST_F(HostileFile, BrokenReference) {
    sql("PRAGMA foreign_keys = OFF; INSERT INTO run_spots VALUES (55, 0, 'S1', 'measured', '{}', 0)");
    expect_refused(path, "not there");
}

TEST_F(HostileFile, TruncatedAtManyLengths) {
    const std::string whole = file_bytes(path);
    std::mt19937 rng(3);
    std::vector<std::size_t> lengths{
        1, 15, 16, 99, 100, 511, 512, 4095, 4096, 4097, whole.size() - 1, whole.size() - 4096};
    for (int i = 0; i < 60; ++i) lengths.push_back(1 + rng() % (whole.size() - 1));
    for (const std::size_t length : lengths) {
        write_bytes(folder / "cut.seam", whole.substr(0, length));
        auto file = ProjectFile::open(folder / "cut.seam");
        ASSERT_FALSE(file) << "of " << whole.size() << " bytes " << length;
        EXPECT_EQ(file.error().kind, ErrorKind::file);
    }
}

TEST_F(HostileFile, WrongValuesInColumns) {
    const auto load_fails = [&](const std::string& change, const char* words) {
        const std::string before = file_bytes(path);
        sql(change);
        expect_refused(path, "checksum");
        seal_all_rows(path);  // as somebody does who means it
        auto file = ProjectFile::open(path);
        ASSERT_TRUE(file) << file.error().sentence();
        auto project = file->load();
        EXPECT_FALSE(project) << change;
        if (!project) {
            EXPECT_EQ(project.error().kind, ErrorKind::file);
            EXPECT_THAT(project.error().sentence(), HasSubstr(words));
        }
        EXPECT_FALSE(file->check().empty());
        write_bytes(path, before);
    };
    load_fails("UPDATE spots SET body = 'x' WHERE id = 'S2'", "cannot be read");
    load_fails("UPDATE spots SET body = '[]' WHERE id = 'S2'", "an object was expected");
    load_fails("UPDATE spots SET body = '{\"id\":\"S9\"}' WHERE id = 'S2'", "another's id");
    load_fails("UPDATE spots SET body = json_set(body, '$.sigma_mm', 'abc') WHERE id = 'S2'", "sigma_mm");
    load_fails(
        "UPDATE spots SET body = json_set(body, '$.base_from_flange.matrix[0][0]', 'nan') WHERE id = 'S2'",
        "base_from_flange");
    load_fails("UPDATE spots SET body = json_set(body, '$.base_from_flange.matrix[0][0]', 7) WHERE id = 'S2'",
               "orthonormal");
    load_fails("UPDATE spots SET body = json_set(body, '$.surprise', 7) WHERE id = 'S2'", "surprise");
    load_fails("UPDATE sensors SET body = json_set(body, '$.peaks.per_line', 99999999999)", "out of range");
    load_fails("UPDATE sensors SET body = json_set(body, '$.peaks.method', 'guess')", "not known");
    load_fails("UPDATE spots SET body = zeroblob(0) || '' WHERE id = 'S2'", "cannot be read");
    load_fails("UPDATE spots SET body = replace(hex(zeroblob(500000)), '00', '[') WHERE id = 'S2'",
               "cannot be read");
    const std::string deep = std::string(100000, '[') + std::string(100000, ']');
    load_fails("UPDATE sensors SET body = replace(body, '\"settings\":', '\"settings\":" + deep + ",\"x\":')",
               "cannot be read");
    load_fails("UPDATE spots SET reference_profile = x'00' WHERE id = 'S2'", "no block of profiles");
    load_fails("UPDATE spots SET reference_profile = substr(reference_profile, 1, 500) WHERE id = 'S2'",
               "checksum");
    load_fails("UPDATE spots SET reference_profile = (SELECT data FROM captures) WHERE id = 'S2'",
               "another kind");
}

// What has the right checksums is not deep all the same: no reader may follow it to the bottom of its stack.
TEST_F(HostileFile, DeepJsonInTheRowsOfARun) {
    const std::string deep = std::string(100000, '[') + std::string(100000, ']');
    const std::string before = file_bytes(path);
    for (const char* table : {"setups", "run_spots", "run_regions"}) {
        sql(fmt::format("UPDATE {} SET body = '{}'", table, "{\"id\":" + deep + "}"));
        seal_all_rows(path);
        auto file = ProjectFile::open(path);
        ASSERT_TRUE(file) << file.error().sentence();
        EXPECT_FALSE(file->load_run(1) && file->load_run_setup(1)) << table;
        EXPECT_FALSE(file->check().empty()) << table;
        write_bytes(path, before);
    }
}

TEST(ProjectFile, WhatCannotBeReadAgainIsNotSaved) {
    const TemporaryFolder folder;
    Project project = sample_project();
    auto file = ProjectFile::create(folder / "a.seam", project).value();
    nlohmann::json deep = 1;
    for (int depth = 1; depth <= 62; ++depth) {
        deep = nlohmann::json::array({deep});
        project.sensors[0].settings = {{"deep", deep}};
        const auto saved = file.save(project);
        ASSERT_TRUE(file.load()) << depth;
        if (saved) {
            EXPECT_TRUE(file.append_run(sample_run(1), project)) << depth;
        }
        EXPECT_EQ(saved.has_value(), depth <= 58) << depth;
    }
    EXPECT_TRUE(file.check().empty());
}

TEST(ProjectFile, IdsHaveALength) {
    const TemporaryFolder folder;
    Project project = sample_project();
    auto file = ProjectFile::create(folder / "a.seam", project).value();
    const auto with = [&](std::size_t bytes) {
        Project changed = project;
        changed.spots[5].id = std::string(bytes, 'x');
        return changed;
    };
    EXPECT_TRUE(file.save(with(64)));
    const auto refused = file.save(with(65));
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().sentence(), HasSubstr("the id of a spot is longer than 64 bytes"));
    EXPECT_EQ(exact_text(*file.load()), exact_text(with(64))) << "nothing of it is saved";
    EXPECT_FALSE(ProjectFile::create(folder / "b.seam", with(300)));

    // One that an older version let pass.
    {
        auto db = Database::open((folder / "a.seam").string(), SQLITE_OPEN_READWRITE).value();
        const std::string old(300, 'x');
        ASSERT_TRUE(db.execute(fmt::format(
            "UPDATE spots SET id = '{0}', body = json_set(body, '$.id', '{0}') WHERE length(id) = 64", old)));
    }
    seal_all_rows(folder / "a.seam");
    {
        auto db = Database::open((folder / "a.seam").string(), SQLITE_OPEN_READWRITE).value();
        ASSERT_TRUE(
            db.execute("DROP TABLE users; DROP TABLE chain; DROP TABLE fixture; DROP TABLE outbox; DROP "
                       "TABLE guides; DROP TABLE fleet; PRAGMA "
                       "user_version = 11"));
    }
    auto old = ProjectFile::open(folder / "a.seam");
    ASSERT_TRUE(old) << old.error().sentence();
    Project loaded = old->load().value();
    EXPECT_EQ(loaded.spots[5].id.size(), 300u);
    loaded.name = "edited";
    EXPECT_TRUE(old->save(loaded));
}

// --- the file's place

TEST(ProjectFile, OneThatWasReplacedOrDeletedIsNotWrittenTo) {
    const TemporaryFolder folder;
    const Project project = sample_project();
    for (const bool log : {false, true}) {
        for (const char* what : {"deleted", "moved", "replaced", "in another folder"}) {
            const fs::path path = folder / "line" / "a.seam";
            fs::remove_all(folder / "line");
            fs::create_directory(folder / "line");
            auto file = ProjectFile::create(path, project).value();
            file.keep_write_ahead(log);
            RunRecord run = sample_run(1);
            run.number = file.begin_run(run, RunSetup::of(project).value()).value();
            const std::string word = what;
            if (word == "deleted") fs::remove(path);
            if (word == "moved") fs::rename(path, folder / "line" / "b.seam");
            if (word == "replaced") {
                ASSERT_TRUE(ProjectFile::create(folder / "line" / "b.seam", project));
                fs::rename(folder / "line" / "b.seam", path);
            }
            if (word == "in another folder") fs::rename(folder / "line", folder / "other");
            StoredMeasurements none;
            const Expected<void> stored[] = {file.finish_run(run, none), file.save(project),
                                             file.update_run(run), file.append_measured(run, none)};
            for (const auto& done : stored) {
                ASSERT_FALSE(done) << what;
                EXPECT_THAT(done.error().sentence(), HasSubstr("replaced or deleted while it was in use"))
                    << what;
                EXPECT_THAT(done.error().sentence(), HasSubstr(path.string()));
            }
            EXPECT_FALSE(file.append_event({})) << what;
            EXPECT_FALSE(file.append_run(sample_run(2), project)) << what;
            fs::remove_all(folder / "other");
        }
    }
}

TEST(ProjectFile, ALinkStaysALink) {
    const TemporaryFolder folder;
    fs::create_directory(folder / "server");
    const fs::path link = folder / "door.seam", target = folder / "server" / "door.seam";
    fs::create_symlink(target, link);
    ASSERT_TRUE(ProjectFile::create(link, sample_project()));
    EXPECT_TRUE(fs::is_symlink(link));
    EXPECT_TRUE(ProjectFile::open(target));
    fs::remove(target);
    make_old_version(target, 3);
    ASSERT_TRUE(ProjectFile::open(link));
    EXPECT_TRUE(fs::is_symlink(link));
    EXPECT_EQ(Database::open(target.string(), SQLITE_OPEN_READONLY)->integer("PRAGMA user_version").value(),
              current_version())
        << "the file was brought up to date where it stands";
    ASSERT_TRUE(ProjectFile::open(link)->copy_to(link));
    EXPECT_TRUE(fs::is_symlink(link));
    ASSERT_EQ(::mkfifo((folder / "pipe.seam").c_str(), 0600), 0);
    const auto refused = ProjectFile::create(folder / "pipe.seam", sample_project(), true);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().sentence(), HasSubstr("this is no file"));
}

TEST_F(HostileFile, DamagedRunIsRefusedAlone) {
    {
        auto file = ProjectFile::open(path);
        ASSERT_TRUE(file->append_run(sample_run(2), sample_project()));
    }
    sql("UPDATE captures SET data = CAST(substr(data, 1, 100) || x'42' || substr(data, 102) AS BLOB) WHERE "
        "run = 1");
    auto file = ProjectFile::open(path);
    ASSERT_TRUE(file);
    EXPECT_FALSE(file->load_run(1));
    EXPECT_TRUE(file->load_run(1, false));
    EXPECT_TRUE(file->load_run(2));
    EXPECT_THAT(file->load_run(1).error().sentence(), HasSubstr("checksum"));
    EXPECT_EQ(file->check().size(), 2u) << "the chain says so too";
}

// --- blobs

TEST(ProfileBlob, PacksToAboutOneMebibyte) {
    SampleMaker make(5);
    std::vector<Capture> captures;
    for (int i = 0; i < 300; ++i) {
        Capture c;
        c.spot_id = "S" + std::to_string(i);
        c.profile = make.profile(1000, false);
        captures.push_back(c);
    }
    auto blobs = pack_captures(captures);
    ASSERT_TRUE(blobs);
    EXPECT_GT(blobs->size(), 3u);
    std::vector<Capture> again;
    for (const CaptureBlob& blob : *blobs) {
        EXPECT_LT(blob.bytes.size(), kCaptureBlobBytes + 20000);
        ASSERT_TRUE(unpack_captures(blob.bytes, "blob", again));
    }
    ASSERT_EQ(again.size(), captures.size());
    for (std::size_t i = 0; i < again.size(); ++i) EXPECT_TRUE(same_bits(again[i], captures[i]));
}

// Forged blobs with a right checksum: lengths must be held against what is there.
TEST(ProfileBlob, ForgedLengthsAreRefused) {
    SampleMaker make(6);
    const Capture capture = make.image_capture("S1", 40);
    const auto blobs = pack_captures(std::span(&capture, 1));
    ASSERT_TRUE(blobs);
    const std::vector<std::byte> good = blobs->front().bytes;
    std::mt19937 rng(8);
    int refused = 0;
    for (int i = 0; i < 3000; ++i) {
        std::vector<std::byte> bad = good;
        if (i % 3 == 0) bad.resize(16 + rng() % (bad.size() - 16));
        for (int k = 0; k < 2 && i % 3; ++k) {
            const std::size_t at = 16 + rng() % std::min<std::size_t>(bad.size() - 16, 200);
            const std::uint32_t value = rng() % 2 ? 0xffffffffu : rng();
            std::memcpy(bad.data() + at, &value, std::min<std::size_t>(4, bad.size() - at));
        }
        set_blob_checksum(bad);
        std::vector<Capture> out;
        if (!unpack_captures(bad, "forged", out)) ++refused;
    }
    EXPECT_GT(refused, 1500);
}

// --- migrations

// Files of older versions, written by their own schema; `tests/data/version<N>.sql` are their dumps.
TEST(Migration, VersionOneBecomesCurrent) {
    TemporaryFolder folder;
    const fs::path path = folder / "old.seam";
    make_old_version(path, 1);
    const std::string before = file_bytes(path);
    {
        auto file = ProjectFile::open(path, FileAccess::read_only);
        ASSERT_TRUE(file) << file.error().sentence();
        EXPECT_EQ(file->load()->name, "first version");
        EXPECT_EQ(file->runs()->size(), 1u);
    }
    EXPECT_EQ(file_bytes(path), before) << "reading must not migrate the file";
    {
        auto file = ProjectFile::open(path);
        ASSERT_TRUE(file) << file.error().sentence();
        EXPECT_EQ(file->load()->spots.size(), 2u);
        EXPECT_EQ(file->load_run(1)->captures.size(), 2u);
        EXPECT_TRUE(file->check().empty());
        RunRecord run = sample_run(1);
        EXPECT_TRUE(file->append_run(run, *file->load())) << "images need the second version";
    }
    auto db = Database::open(path.string(), SQLITE_OPEN_READONLY);
    EXPECT_EQ(*db->integer("PRAGMA user_version"), current_version());
    std::size_t files = 0;
    for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder.path())) ++files;
    EXPECT_EQ(files, 1u);
}

TEST(Migration, VersionTwoBecomesCurrentAndTakesEvidence) {
    TemporaryFolder folder;
    const fs::path path = folder / "old.seam";
    make_old_version(path, 2);
    {
        const auto reading = ProjectFile::open(path, FileAccess::read_only);
        ASSERT_TRUE(reading) << reading.error().sentence();
        EXPECT_EQ(exact_text(reading->load()->requirements), exact_text(Requirements{})) << "defaults";
        EXPECT_TRUE(reading->evidence()->empty());
    }
    auto file = ProjectFile::open(path);
    ASSERT_TRUE(file) << file.error().sentence();
    EXPECT_EQ(file->runs()->size(), 1u);
    EXPECT_EQ(file->load_run(1)->captures.size(), 2u);
    Project project = file->load().value();
    project.requirements.sigma3_mm = 0.1;
    project.requirements.calibration_age_days = 30;
    ASSERT_TRUE(file->save(project));
    for (int kind = 0; kind < kSampleEvidence; ++kind)
        ASSERT_TRUE(file->append_evidence(sample_evidence(kind), project));
    EXPECT_TRUE(file->check().empty());
    EXPECT_EQ(file->load()->requirements.sigma3_mm, 0.1);
}

TEST(Migration, VersionThreeBecomesCurrentAndTakesPanelJobs) {
    TemporaryFolder folder;
    const fs::path path = folder / "old.seam";
    make_old_version(path, 3);
    auto file = ProjectFile::open(path);
    ASSERT_TRUE(file) << file.error().sentence();
    Project project = file->load().value();
    EXPECT_EQ(project.requirements.sigma3_mm, 0.2);
    EXPECT_EQ(file->evidence()->size(), 1u);
    EXPECT_TRUE(project.panel_jobs.empty());
    EXPECT_FALSE(file->load_run(1)->panel);
    project.panel_jobs = sample_project().panel_jobs;
    ASSERT_TRUE(file->save(project));
    RunRecord run = sample_run(1);
    run.panel = sample_panel_record(1);
    ASSERT_TRUE(file->append_run(run, project));
    EXPECT_EQ(exact_text(file->load()->panel_jobs[0]), exact_text(project.panel_jobs[0]));
    EXPECT_TRUE(file->check().empty());
}

// What was required of before stays, what the acceptance asks for has its defaults and is kept from here on; and
// a run's setup does not hold it, so that another tolerance is no other measuring process.
TEST(Migration, VersionFiveBecomesCurrentAndTakesAcceptance) {
    TemporaryFolder folder;
    const fs::path path = folder / "old.seam";
    make_old_version(path, 5);
    {
        auto reading = ProjectFile::open(path, FileAccess::read_only);
        ASSERT_TRUE(reading) << reading.error().sentence();
        EXPECT_EQ(reading->load()->requirements.acceptance, AcceptanceRequirements{});
    }
    auto file = ProjectFile::open(path);
    ASSERT_TRUE(file) << file.error().sentence();
    Project project = file->load().value();
    EXPECT_EQ(project.requirements.sigma3_mm, 0.2);
    EXPECT_EQ(project.requirements.acceptance.cg_share, 0.2);
    const auto before = file->setup_of(project);
    ASSERT_TRUE(before) << before.error().sentence();
    project.requirements.acceptance = {1.5, 0.25, 0.15, 4, 1.67, 1.5, 20, 25, 6, 10, 20};
    ASSERT_TRUE(file->save(project));
    EXPECT_EQ(*file->setup_of(project), *before);
    const auto opened = ProjectFile::open(path);
    const Project again = opened->load().value();
    EXPECT_EQ(again.requirements.acceptance, project.requirements.acceptance);
    EXPECT_EQ(again.requirements.sigma3_mm, 0.2);
    EXPECT_TRUE(opened->check().empty());
}

// A file of before has no guide, takes one, and its chain and checks know it.
TEST(Migration, OlderVersionsTakeAGuide) {
    for (int version = 1; version <= 13; ++version) {
        TemporaryFolder folder;
        const fs::path path = folder / "old.seam";
        make_old_version(path, version);
        auto file = ProjectFile::open(path);
        ASSERT_TRUE(file) << version << file.error().sentence();
        EXPECT_TRUE(file->guides()->empty());
        EXPECT_FALSE(file->load_guide("top.csv"));
        const std::string csv = "x_mm,y_mm,z_mm,a_deg,b_deg,c_deg\r\n0,0,0,0,0,0\r\n0,9,0,0,0,0\r\n";
        const auto kept = file->keep_guide("top.csv", csv);
        ASSERT_TRUE(kept) << kept.error().sentence();
        // sha256sum of these bytes.
        EXPECT_EQ(kept->hash, "5eb4fbf1c93a9fb1644d5a87bb8b35c919843732dbb552577a3a44a72c275b45");
        EXPECT_EQ(file->keep_guide("other name", csv)->utc, kept->utc) << "kept once";
        const auto again = ProjectFile::open(path);
        ASSERT_TRUE(again);
        ASSERT_EQ(again->guides()->size(), 1u);
        EXPECT_EQ(again->load_guide(kept->hash)->csv, csv);
        EXPECT_EQ(again->load_guide("top.csv")->hash, kept->hash);
        EXPECT_TRUE(again->check().empty());
    }
}

// What was taught before there were drawings was taught on the part; a spot from the drawing is kept as such.
TEST(Migration, SpotsOfOlderVersionsAreMeasuredAndTakeTheDrawing) {
    for (int version = 1; version <= 6; ++version) {
        TemporaryFolder folder;
        const fs::path path = folder / "old.seam";
        make_old_version(path, version);
        auto file = ProjectFile::open(path);
        ASSERT_TRUE(file) << file.error().sentence();
        Project project = file->load().value();
        ASSERT_FALSE(project.spots.empty());
        for (const Spot& spot : project.spots) {
            EXPECT_EQ(spot.reference_state, ReferenceState::measured);
            EXPECT_FALSE(spot.drawn);
        }
        const auto before = file->setup_of(project);
        project.spots[0].reference_state = ReferenceState::from_drawing;
        project.spots[0].drawn =
            DrawingOrigin{"door.step", 1234567890123, 0xfedcba98, "e12", 17.25, {1.5, 0, -2}};
        ASSERT_TRUE(file->save(project));
        EXPECT_NE(*file->setup_of(project), *before);
        const auto opened = ProjectFile::open(path);
        const Spot again = opened->load()->spots[0];
        EXPECT_EQ(exact_text(again), exact_text(project.spots[0]));
        EXPECT_EQ(again.reference_state, ReferenceState::from_drawing);
        ASSERT_TRUE(again.drawn);
        EXPECT_EQ(again.drawn->bytes, 1234567890123u);
        EXPECT_EQ(again.drawn->crc32, 0xfedcba98u);
        EXPECT_TRUE(opened->check().empty());
    }
}

// A file of before watches nothing, takes a watch, and keeps its points when the runs are deleted.
TEST(Migration, OlderVersionsTakeADriftWatch) {
    for (int version = 1; version <= 9; ++version) {
        TemporaryFolder folder;
        const fs::path path = folder / "old.seam";
        make_old_version(path, version);
        auto file = ProjectFile::open(path);
        ASSERT_TRUE(file) << version << file.error().sentence();
        Project project = file->load().value();
        EXPECT_FALSE(project.drift);
        EXPECT_TRUE(file->drift_points()->empty());
        const auto before = file->setup_of(project);
        project.drift.emplace().spot_ids = {"W1"};
        project.drift->set_aside = {{1, 2, "2026-06-02T09:00:00.000Z", "Ada", "it was loose"}};
        ASSERT_TRUE(file->save(project));
        EXPECT_EQ(*file->setup_of(project), *before) << "what acts is said by the run";
        DriftPoint point;
        point.run = 1;
        point.values_mm = {1.0 / 3, -2};
        point.sigma_mm = {0.1, 0.1};
        point.mark = 0xfedcba98u;
        point.text =
            Text("a step of {:+.3f} mm in {}: sensor, robot or reference was knocked", 0.5, "X of W1");
        for (int i = 1; i <= 3; ++i) EXPECT_EQ(*file->append_drift_point(point), i);
        ASSERT_TRUE(file->delete_run(1));
        const auto again = ProjectFile::open(path);
        EXPECT_EQ(exact_text(*again->load()->drift), exact_text(*project.drift));
        EXPECT_EQ(exact_text(**again->load_drift_watch()), exact_text(*project.drift));
        const auto points = again->drift_points(2);
        ASSERT_EQ(points->size(), 2u);
        EXPECT_EQ(points->front().id, 2) << "the newest, oldest first";
        EXPECT_EQ(points->front().values_mm, point.values_mm);
        point.step = true;
        ASSERT_TRUE(file->append_drift_point(point));
        point.step = false;
        ASSERT_TRUE(file->append_drift_point(point));
        const auto last = again->drift_points(1);
        ASSERT_EQ(last->size(), 2u) << "a step is never left out";
        EXPECT_TRUE(last->front().step);
        EXPECT_EQ(last->back().id, 5);
        EXPECT_EQ(points->front().text.english(), point.text.english());
        EXPECT_TRUE(again->check().empty());
    }
}

TEST(ProjectFile, PanelRunsComeBackToTheLastBit) {
    TemporaryFolder folder;
    const Project project = sample_project();
    auto file = ProjectFile::create(folder / "a.seam", project).value();
    RunRecord run = sample_run(1);
    run.spots.clear();
    run.regions.clear();
    run.panel = sample_panel_record(5);
    run.number = file.append_run(run, project).value();
    auto loaded = file.load_run(run.number).value();
    ASSERT_TRUE(loaded.panel);
    EXPECT_EQ(exact_text(*loaded.panel), exact_text(*run.panel));
    run.panel->after.pop_back();
    run.panel->verdict = PanelVerdict::in_tolerance;
    ASSERT_TRUE(file.update_run(run));
    EXPECT_EQ(exact_text(*file.load_run(run.number)->panel), exact_text(*run.panel));
    EXPECT_EQ(exact_text(file.load_run_setup(run.number)->panel_jobs[0]), exact_text(project.panel_jobs[0]));
    EXPECT_TRUE(file.check().empty());
    ASSERT_TRUE(file.delete_run(run.number));
    EXPECT_TRUE(file.check().empty());
}

TEST(ProjectFile, EvidenceComesBackToTheLastBitAndOutlivesRuns) {
    TemporaryFolder folder;
    const Project project = sample_project();
    auto file = ProjectFile::create(folder / "a.seam", project).value();
    const auto run = file.append_run(sample_run(1), project).value();
    for (int kind = 0; kind < kSampleEvidence; ++kind) {
        const Evidence put = sample_evidence(kind);
        const auto id = file.append_evidence(put, project);
        ASSERT_TRUE(id) << id.error().sentence();
        const auto all = file.evidence(*id - 1).value();
        ASSERT_EQ(all.size(), 1u) << "only what is newer";
        EXPECT_EQ(all[0].id, *id);
        EXPECT_FALSE(all[0].utc.empty());
        EXPECT_EQ(all[0].what.index(), put.what.index());
        std::visit(
            [&]<class T>(const T& what) { EXPECT_EQ(exact_text(what), exact_text(std::get<T>(put.what))); },
            all[0].what);
    }
    ASSERT_TRUE(file.delete_run(run));
    const auto all = file.evidence().value();
    ASSERT_EQ(all.size(), std::size_t{kSampleEvidence});
    EXPECT_EQ(file.load_setup(all[3].setup)->spots.size(), project.spots.size());
    EXPECT_TRUE(file.check().empty());
}

TEST(Migration, AFailedOneLeavesTheOldFile) {
    TemporaryFolder folder;
    const fs::path path = folder / "old.seam";
    make_old_version(path, 1);
    {
        // A table that the second version wants to make stands there already.
        sqlite3* db = nullptr;
        ASSERT_EQ(sqlite3_open(path.c_str(), &db), SQLITE_OK);
        ASSERT_EQ(sqlite3_exec(db, "CREATE TABLE images (x)", nullptr, nullptr, nullptr), SQLITE_OK);
        sqlite3_close(db);
    }
    const std::string before = file_bytes(path);
    EXPECT_FALSE(ProjectFile::open(path));
    EXPECT_EQ(file_bytes(path), before);
}

TEST(Migration, VersionsCountUp) {
    std::int32_t version = 0;
    for (const Migration& step : migrations()) EXPECT_EQ(step.version, ++version);
    EXPECT_EQ(version, current_version());
}

// --- write-ahead log

class WriteAhead : public testing::Test {
  protected:
    void SetUp() override {
        ASSERT_TRUE(ProjectFile::create(path, sample_project()));
        file.emplace(ProjectFile::open(path).value());
        file->keep_write_ahead(true);
        ASSERT_TRUE(file->append_run(sample_run(1), sample_project()));
        ASSERT_TRUE(fs::exists(path.string() + "-wal"));
    }
    static std::size_t runs_in(const fs::path& of) { return ProjectFile::open(of).value().runs()->size(); }
    TemporaryFolder folder;
    const fs::path path = folder / "a.seam";
    std::optional<ProjectFile> file;
};

TEST_F(WriteAhead, OthersReadAndWriteMeanwhile) {
    auto reader = ProjectFile::open(path, FileAccess::read_only);
    ASSERT_TRUE(reader) << reader.error().sentence();
    EXPECT_EQ(reader->runs()->size(), 1u);
    {
        auto writer = ProjectFile::open(path);
        ASSERT_TRUE(writer) << writer.error().sentence();
        ASSERT_TRUE(writer->append_run(sample_run(2), sample_project()));
    }
    ASSERT_TRUE(file->append_run(sample_run(3), sample_project()));
    EXPECT_EQ(reader->runs()->size(), 3u);
}

TEST_F(WriteAhead, LastToCloseLeavesOneFile) {
    {
        auto second = ProjectFile::open(path);
        ASSERT_TRUE(second);
        file.reset();
        EXPECT_TRUE(fs::exists(path.string() + "-wal"));
        ASSERT_TRUE(second->append_run(sample_run(2), sample_project()));
    }
    for (const char* suffix : {"-wal", "-shm", "-journal"}) EXPECT_FALSE(fs::exists(path.string() + suffix));
    // No log is needed to read it: a folder without write permission is enough.
    const std::string bytes = file_bytes(path);
    EXPECT_EQ(bytes.substr(18, 2), std::string("\1\1")) << "the header still asks for a log";
    EXPECT_EQ(runs_in(path), 2u);
}

TEST_F(WriteAhead, FileAloneIsWholeAfterCheckpointAndSave) {
    file->checkpoint();
    fs::copy_file(path, folder / "b.seam");
    EXPECT_EQ(runs_in(folder / "b.seam"), 1u);
    Project edited = sample_project();
    edited.name = "edited";
    ASSERT_TRUE(file->save(edited));
    fs::copy_file(path, folder / "c.seam");
    EXPECT_EQ(ProjectFile::open(folder / "c.seam")->load()->name, "edited");
}

TEST_F(WriteAhead, CopyHoldsWhatIsStillInTheLog) {
    const fs::path other = folder / "other.seam";
    ASSERT_TRUE(file->copy_to(other));
    ASSERT_TRUE(file->copy_to(other)) << "a project file there is replaced";
    EXPECT_EQ(runs_in(other), 1u);
    EXPECT_TRUE(ProjectFile::open(other)->check().empty());
    std::ofstream(folder / "note.txt") << "mine";
    EXPECT_FALSE(file->copy_to(folder / "note.txt"));
    EXPECT_EQ(file_bytes(folder / "note.txt"), "mine");
}

TEST_F(WriteAhead, FileInUseIsNotReplaced) {
    auto replaced = ProjectFile::create(path, Project{}, true);
    ASSERT_FALSE(replaced);
    EXPECT_THAT(replaced.error().sentence(), HasSubstr("another program works with the file"));
    EXPECT_EQ(file->runs()->size(), 1u);
    file.reset();
    EXPECT_TRUE(ProjectFile::create(path, Project{}, true));
    EXPECT_EQ(runs_in(path), 0u);
}

TEST_F(WriteAhead, LogOfADeletedFileNeverMeetsItsSuccessor) {
    fs::copy_file(path.string() + "-wal", folder / "kept");
    file.reset();
    fs::remove(path);
    fs::copy_file(folder / "kept", path.string() + "-wal");
    ASSERT_TRUE(ProjectFile::create(path, Project{}));
    EXPECT_EQ(runs_in(path), 0u);
    EXPECT_TRUE(ProjectFile::open(path)->load()->spots.empty());
}

// --- kill

TEST(Kill, EveryCommittedRunSurvives) {
    kill_while_appending(20, 1, false);
}

TEST(Kill, EveryCommittedRunSurvivesInTheWriteAheadLog) {
    kill_while_appending(20, 3, true);
}

TEST(Kill, WhileCreating) {
    for (unsigned i = 0; i < 20; ++i) {
        TemporaryFolder folder;
        const fs::path path = folder / "a.seam";
        const pid_t child = fork();
        if (child == 0) {
            (void)ProjectFile::create(path, sample_project());
            _exit(0);
        }
        usleep(500 + 1500 * i);
        kill(child, SIGKILL);
        waitpid(child, nullptr, 0);
        if (!fs::exists(path)) continue;
        auto file = ProjectFile::open(path);
        ASSERT_TRUE(file) << file.error().sentence();
        EXPECT_EQ(file->load()->spots.size(), 6u);
    }
}

}  // namespace
}  // namespace seamwright
