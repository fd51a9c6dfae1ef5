#include "projects/file/project_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <optional>

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
    EXPECT_THAT(refused.error().sentence(), HasSubstr("the id of a spot is longer than 64 signs"));
    EXPECT_EQ(exact_text(*file.load()), exact_text(with(64))) << "nothing of it is saved";
    EXPECT_FALSE(ProjectFile::create(folder / "b.seam", with(300)));
    // Signs are counted, not the bytes that they take.
    const auto umlauts = [&](int signs) {
        Project changed = project;
        changed.spots[5].id.clear();
        for (int k = 0; k < signs; ++k) changed.spots[5].id += "ä";
        return changed;
    };
    EXPECT_TRUE(file.save(umlauts(64)));
    EXPECT_FALSE(file.save(umlauts(65)));
    ASSERT_TRUE(file.save(with(64)));

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

}  // namespace
}  // namespace seamwright
