#include "widgets/desk/recovery.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sqlite3.h>

#include "projects/file/row_checksum.h"
#include "tests/widgets/desk/desk_fixture.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

class RecoveryTest : public testing::Test {
  protected:
    TemporaryFolder folder;
    fs::path fresh(const std::string& name) const {
        Project project = sample_project();
        project.name = "saved";
        const fs::path file = folder / name;
        EXPECT_TRUE(ProjectFile::create(file, project));
        return file;
    }
    std::vector<std::string> names() const {
        std::vector<std::string> found;
        for (const auto& entry : fs::directory_iterator(folder.path()))
            if (entry.path().extension() != ".lock") found.push_back(entry.path().filename().string());
        std::sort(found.begin(), found.end());
        return found;
    }
};

int user_version(const fs::path& file, int set = -1) {
    sqlite3* db = nullptr;
    EXPECT_EQ(sqlite3_open(file.c_str(), &db), SQLITE_OK);
    if (set >= 0)
        sqlite3_exec(db, ("PRAGMA user_version=" + std::to_string(set)).c_str(), nullptr, nullptr, nullptr);
    sqlite3_stmt* statement = nullptr;
    sqlite3_prepare_v2(db, "PRAGMA user_version", -1, &statement, nullptr);
    EXPECT_EQ(sqlite3_step(statement), SQLITE_ROW);
    const int version = sqlite3_column_int(statement, 0);
    sqlite3_finalize(statement);
    sqlite3_close(db);
    return version;
}

// Somebody else's lock: readers pass, a writer waits.
class HeldByAnother {
  public:
    explicit HeldByAnother(const fs::path& file) {
        EXPECT_EQ(sqlite3_open(file.c_str(), &db_), SQLITE_OK);
        EXPECT_EQ(sqlite3_exec(db_, "BEGIN IMMEDIATE", nullptr, nullptr, nullptr), SQLITE_OK);
    }
    ~HeldByAnother() { sqlite3_close(db_); }
    HeldByAnother(const HeldByAnother&) = delete;
    HeldByAnother& operator=(const HeldByAnother&) = delete;

  private:
    sqlite3* db_ = nullptr;
};

TEST_F(RecoveryTest, AnEditSurvivesACrashAndComesBack) {
    const fs::path file = fresh("a.seam");
    std::string edited;
    {
        WatchedDesk me;
        ASSERT_TRUE(me.desk.open(file));
        EXPECT_FALSE(me.desk.recovery());
        ASSERT_TRUE(me.desk.remove<Spot>("S2"));
        me.rename_and_wait("edited");
        edited = bits(me.desk.project());
        const Left left = what_a_crash_leaves(file);
        EXPECT_EQ(left.saved.name, "saved");
        ASSERT_TRUE(left.recovery);
        EXPECT_EQ(bits(left.recovery->project), edited);
        EXPECT_EQ(left.recovery->holds,
                  (QStringList{"project renamed", "spot S2 removed", "region edge changed"}));
    }  // ends without close, as a program does that is told to quit: nobody has decided about the edits
    WatchedDesk again;
    ASSERT_TRUE(again.desk.open(file));
    ASSERT_TRUE(again.desk.recovery());
    EXPECT_EQ(again.desk.project().name, "saved") << "nothing before the answer";
    again.desk.restore();
    EXPECT_EQ(bits(again.desk.project()), edited);
    EXPECT_TRUE(again.desk.modified());
    ASSERT_TRUE(again.desk.save());
    EXPECT_FALSE(again.desk.modified());
    EXPECT_FALSE(what_a_crash_leaves(file).recovery);
    again.desk.close();
    EXPECT_THAT(names(), ElementsAre("a.seam"));
    EXPECT_EQ(bits(what_a_crash_leaves(file).saved), edited);
}

class UnreadableRecovery : public RecoveryTest, public testing::WithParamInterface<std::string> {};

TEST_P(UnreadableRecovery, IsSetAsideToldAndAutosaveGoesOn) {
    const fs::path file = fresh("a.seam"), kept = recovery_path(file);
    const std::string kind = GetParam();
    if (kind == "text") write_bytes(kept, std::string(5000, 'x'));
    if (kind == "empty") write_bytes(kept, "");
    if (kind == "truncated") write_bytes(kept, file_bytes(file).substr(0, file_bytes(file).size() / 2));
    if (kind == "flipped") {
        std::string bytes = file_bytes(file);
        for (std::size_t i = 4096; i < bytes.size(); i += 97) bytes[i] = static_cast<char>(~bytes[i]);
        write_bytes(kept, bytes);
    }
    if (kind == "newer") {
        fs::copy_file(file, kept);
        user_version(kept, 99);
    }
    const std::string bytes = file_bytes(kept);
    EXPECT_FALSE(what_a_crash_leaves(file).unreadable.empty());

    WatchedDesk me;
    ASSERT_TRUE(me.desk.open(file));
    EXPECT_FALSE(me.desk.recovery());
    ASSERT_EQ(me.troubles.size(), 1);
    EXPECT_THAT(me.troubles[0].toStdString(), HasSubstr("a.seam.recovery.damaged"));
    EXPECT_THAT(me.desk.events()->back().text, HasSubstr("a.seam.recovery.damaged"));
    EXPECT_EQ(file_bytes(kept.string() + ".damaged"), bytes) << "not a bit is lost";
    if (kind == "newer") {
        EXPECT_THAT(me.troubles[0].toStdString(), HasSubstr("version 99"));
        EXPECT_EQ(user_version(kept.string() + ".damaged"), 99);
    }
    me.rename_and_wait("one");
    me.rename_and_wait("two");
    EXPECT_EQ(me.troubles.size(), 1);
    ASSERT_TRUE(what_a_crash_leaves(file).recovery);
    EXPECT_EQ(what_a_crash_leaves(file).recovery->project.name, "two");
    me.desk.close();
    EXPECT_EQ(file_bytes(kept.string() + ".damaged"), bytes);

    // The next one does not take its place.
    write_bytes(kept, "other");
    ASSERT_TRUE(me.desk.open(file));
    EXPECT_EQ(file_bytes(kept.string() + ".damaged"), bytes);
    EXPECT_EQ(file_bytes(kept.string() + ".damaged-2"), "other");
}
INSTANTIATE_TEST_SUITE_P(Kinds, UnreadableRecovery,
                         testing::Values("text", "empty", "truncated", "flipped", "newer"),
                         [](const auto& kind) { return kind.param; });

TEST_F(RecoveryTest, ThatGoesBadWhileEditingIsBegunAnew) {
    const fs::path file = fresh("a.seam");
    WatchedDesk me;
    ASSERT_TRUE(me.desk.open(file));
    me.rename_and_wait("one");
    {
        std::ofstream out(recovery_path(file), std::ios::in | std::ios::out | std::ios::binary);
        out << std::string(8192, 'x');  // over its first pages
    }
    me.rename_and_wait("two");
    ASSERT_EQ(me.troubles.size(), 1);
    EXPECT_THAT(me.troubles[0].toStdString(), HasSubstr(".damaged"));
    EXPECT_EQ(what_a_crash_leaves(file).recovery->project.name, "two");
    EXPECT_EQ(file_bytes(recovery_path(file).string() + ".damaged").substr(0, 100), std::string(100, 'x'));

    fs::remove(recovery_path(file));
    me.rename_and_wait("three");
    EXPECT_EQ(what_a_crash_leaves(file).recovery->project.name, "three");
    EXPECT_EQ(me.troubles.size(), 1) << "taken away from outside is no trouble";
}

TEST_F(RecoveryTest, AnEditThatCannotBeKeptIsTold) {
    const fs::path file = fresh("a.seam");
    fs::create_directories(recovery_path(file) / "in the way");
    WatchedDesk me;
    ASSERT_TRUE(me.desk.open(file));
    ASSERT_EQ(me.troubles.size(), 1) << "a folder of that name goes aside, too";
    me.rename_and_wait("one");
    me.desk.close();

    const fs::path inner = folder / "inner";
    fs::create_directories(inner);
    fs::rename(file, inner / "b.seam");
    ASSERT_TRUE(me.desk.open(inner / "b.seam"));
    me.troubles.clear();
    fs::rename(inner, folder / "gone");
    const int written = me.written;
    ASSERT_TRUE(me.desk.rename_project("two"));
    ASSERT_TRUE(wait_until([&] { return me.troubles.join("; ").contains("not kept"); }));
    EXPECT_EQ(me.written, written);
}

// A crash between the commit of a save and the removal of the recovery.
TEST_F(RecoveryTest, RightAfterASaveNothingOlderIsOffered) {
    const fs::path file = fresh("a.seam");
    for (const bool as : {false, true}) {
        WatchedDesk me;
        ASSERT_TRUE(me.desk.open(file));
        me.rename_and_wait(as ? "third" : "first");
        auto held = std::make_unique<HeldByAnother>(recovery_path(file));
        std::jthread release([&] {
            std::this_thread::sleep_for(std::chrono::milliseconds(150));
            held.reset();
        });
        ASSERT_TRUE(me.desk.rename_project(as ? "fourth" : "second"));
        int looked = 0;
        QObject::connect(&me.desk, &Desk::modified_changed, &me.desk, [&](bool modified) {
            if (modified || as) return;
            ++looked;
            const Left left = what_a_crash_leaves(file);
            EXPECT_EQ(left.saved.name, "second");
            EXPECT_TRUE(fs::exists(recovery_path(file))) << "this looks before the removal";
            EXPECT_FALSE(left.recovery) << "offers " << left.recovery->project.name;
        });
        if (!as) {
            ASSERT_TRUE(me.desk.save());
            EXPECT_EQ(looked, 1);
        } else {
            ASSERT_TRUE(me.desk.save_as(folder / "b.seam"));
            EXPECT_EQ(what_a_crash_leaves(folder / "b.seam").saved.name, "fourth");
            EXPECT_FALSE(what_a_crash_leaves(folder / "b.seam").recovery);
            EXPECT_FALSE(what_a_crash_leaves(file).recovery);
        }
        me.desk.close();
    }
}

// Devices that answer are no edit, but they are saved: what was kept before they answered is no older state.
TEST_F(RecoveryTest, WhoAnsweredSinceTheLastEditIsNotOffered) {
    const fs::path file = folder / "a.seam";
    Project project;
    SensorSetup sensor;
    sensor.id = "A";
    sensor.driver = "simulated";
    project.sensors = {sensor};
    WatchedDesk me;
    ASSERT_TRUE(me.desk.create(file, project));
    me.rename_and_wait("edited");
    me.desk.worker().connect_devices();
    ASSERT_TRUE(wait_until([&] { return !me.desk.project().sensors[0].identity.serial.empty(); }))
        << me.troubles.join("; ").toStdString();
    int looked = 0;
    QObject::connect(&me.desk, &Desk::modified_changed, &me.desk, [&](bool modified) {
        if (modified) return;
        ++looked;
        EXPECT_TRUE(fs::exists(recovery_path(file)));
        const Left left = what_a_crash_leaves(file);
        EXPECT_FALSE(left.recovery) << left.recovery->holds.join("; ").toStdString();
    });
    ASSERT_TRUE(me.desk.save());
    EXPECT_EQ(looked, 1);
}

TEST_F(RecoveryTest, UndoneToTheSavedStateThereIsNothingToRestore) {
    const fs::path file = fresh("a.seam");
    WatchedDesk me;
    ASSERT_TRUE(me.desk.open(file));
    me.rename_and_wait("one");
    EXPECT_TRUE(fs::exists(recovery_path(file)));
    me.desk.undo_stack().undo();
    ASSERT_TRUE(wait_until([&] { return !fs::exists(recovery_path(file)); }));
    const int before = me.written;
    me.desk.undo_stack().redo();
    ASSERT_TRUE(wait_until([&] { return me.written > before; }));
    EXPECT_EQ(what_a_crash_leaves(file).recovery->project.name, "one");
}

TEST_F(RecoveryTest, LeavingAProjectLeavesNothingBehind) {
    const fs::path a = fresh("a.seam"), b = fresh("b.seam");
    WatchedDesk me;
    ASSERT_TRUE(me.desk.open(a));
    me.rename_and_wait("dropped");
    // What cannot be opened changes nothing.
    EXPECT_FALSE(me.desk.open(folder / "none.seam"));
    EXPECT_EQ(what_a_crash_leaves(a).recovery->project.name, "dropped");
    ASSERT_TRUE(me.desk.open(b));
    EXPECT_THAT(names(), ElementsAre("a.seam", "b.seam"));
    // The same file again: what was dropped is not asked for.
    me.rename_and_wait("dropped, too");
    ASSERT_TRUE(me.desk.open(b));
    EXPECT_FALSE(me.desk.recovery());
    EXPECT_EQ(me.desk.project().name, "saved");
    me.rename_and_wait("dropped for a new one");
    ASSERT_TRUE(me.desk.create(folder / "c.seam", Project{}));
    EXPECT_THAT(names(), ElementsAre("a.seam", "b.seam", "c.seam"));
    me.rename_and_wait("kept elsewhere");
    ASSERT_TRUE(me.desk.save_as(folder / "d.seam"));
    EXPECT_THAT(names(), ElementsAre("a.seam", "b.seam", "c.seam", "d.seam"));
    me.rename_and_wait("closed");
    me.desk.close();
    EXPECT_THAT(names(), ElementsAre("a.seam", "b.seam", "c.seam", "d.seam"));
}

TEST_F(RecoveryTest, WhatNobodyHasDecidedAboutStays) {
    const fs::path a = fresh("a.seam"), b = fresh("b.seam");
    {
        WatchedDesk me;
        ASSERT_TRUE(me.desk.open(a));
        me.rename_and_wait("of the crash");
    }
    WatchedDesk me;
    ASSERT_TRUE(me.desk.open(a));
    ASSERT_TRUE(me.desk.recovery());
    ASSERT_TRUE(me.desk.open(b));  // without an answer
    EXPECT_FALSE(me.desk.recovery());
    EXPECT_EQ(what_a_crash_leaves(a).recovery->project.name, "of the crash");
    ASSERT_TRUE(me.desk.open(a));
    me.desk.close();
    EXPECT_EQ(what_a_crash_leaves(a).recovery->project.name, "of the crash");
    // An edit meanwhile does not write over it; with the answer it is kept itself.
    ASSERT_TRUE(me.desk.open(a));
    ASSERT_TRUE(me.desk.rename_project("meanwhile"));
    ASSERT_TRUE(me.desk.save());
    EXPECT_EQ(what_a_crash_leaves(a).recovery->project.name, "of the crash");
    ASSERT_TRUE(me.desk.rename_project("after"));
    const int before = me.written;
    me.desk.forget_recovery();
    ASSERT_TRUE(wait_until([&] { return me.written > before; }));
    EXPECT_EQ(what_a_crash_leaves(a).recovery->project.name, "after");
    ASSERT_TRUE(me.desk.save());
    ASSERT_TRUE(wait_until([&] { return !fs::exists(recovery_path(a)); }));
}

TEST_F(RecoveryTest, AReplacedFileIsNotOfferedTheEditsOfTheOldOne) {
    const fs::path a = fresh("a.seam"), b = fresh("b.seam");
    {
        WatchedDesk me;
        ASSERT_TRUE(me.desk.open(b));
        me.rename_and_wait("edits of the old b");
    }
    WatchedDesk me;
    ASSERT_TRUE(me.desk.open(a));
    ASSERT_TRUE(me.desk.save_as(b));
    EXPECT_THAT(names(), ElementsAre("a.seam", "b.seam"));
}

TEST_F(RecoveryTest, WrittenMeansTheNewest) {
    const fs::path file = fresh("a.seam");
    WatchedDesk me;
    ASSERT_TRUE(me.desk.open(file));
    int looked = 0;
    QObject::connect(&me.desk, &Desk::recovery_written, &me.desk, [&] {
        ++looked;
        const Left left = what_a_crash_leaves(file);
        ASSERT_TRUE(left.recovery);
        EXPECT_EQ(bits(left.recovery->project), bits(me.desk.project()));
    });
    std::mt19937 rng(5);
    for (int i = 0; i < 60; ++i) {
        ASSERT_TRUE(me.desk.rename_project("edit " + std::to_string(i)));
        const int rest = static_cast<int>(rng() % 12);
        wait_until([] { return false; }, rest);
    }
    ASSERT_TRUE(wait_until(
        [&] { return looked > 0 && what_a_crash_leaves(file).recovery->project.name == "edit 59"; }));
}

TEST(Differences, NameEveryKindOfEdit) {
    const Project before = sample_project();
    EXPECT_TRUE(differences(before, before).isEmpty());
    const auto after = [&](const std::function<void(Project&)>& change) {
        Project changed = before;
        change(changed);
        return differences(before, changed);
    };
    EXPECT_EQ(after([](Project& p) { p.name = "x"; }), QStringList{"project renamed"});
    EXPECT_EQ(after([](Project& p) { p.part.mesh_ply.pop_back(); }), QStringList{"part changed"});
    EXPECT_EQ(after([](Project& p) { p.part.name = "x"; }), QStringList{"part changed"});
    EXPECT_EQ(after([](Project& p) { p.requirements.sigma3_mm = 1; }), QStringList{"requirements changed"});
    EXPECT_EQ(after([](Project& p) { p.sensors[0].filter.noise_mm = 1; }), QStringList{"sensor A changed"});
    EXPECT_EQ(after([](Project& p) { p.robots.clear(); }), QStringList{"robot R1 removed"});
    EXPECT_EQ(after([](Project& p) { p.calibrations[0].id = "C2"; }),
              (QStringList{"calibration C2 added", "calibration C1 removed"}));
    EXPECT_EQ(after([](Project& p) { p.spots[1].reference_profile.z_mm[0] += 1e-12; }),
              QStringList{"spot S2 changed"});
    EXPECT_EQ(after([](Project& p) { std::swap(p.spots[0], p.spots[1]); }), QStringList{"order changed"});
    const auto swapped = [](auto list) {
        list.push_back(list[0]);
        list[1].id += "'";
        return list;
    };
    Project two = before;
    two.sensors = swapped(two.sensors), two.robots = swapped(two.robots);
    two.calibrations = swapped(two.calibrations), two.regions = swapped(two.regions);
    const auto reversed = [&](const std::function<void(Project&)>& change) {
        Project changed = two;
        change(changed);
        return differences(two, changed);
    };
    const QStringList order{"order changed"};
    EXPECT_EQ(reversed([](Project& p) { std::swap(p.sensors[0], p.sensors[1]); }), order);
    EXPECT_EQ(reversed([](Project& p) { std::swap(p.robots[0], p.robots[1]); }), order);
    EXPECT_EQ(reversed([](Project& p) { std::swap(p.calibrations[0], p.calibrations[1]); }), order);
    EXPECT_EQ(reversed([](Project& p) { std::swap(p.regions[0], p.regions[1]); }), order);
}

TEST_F(RecoveryTest, ASecondDeskIsRefusedAndNothingIsLost) {
    const fs::path file = fresh("a.seam"), other = fresh("b.seam");
    WatchedDesk first, second;
    ASSERT_TRUE(first.desk.open(file));
    ASSERT_TRUE(first.desk.rename_project("edited by the first"));
    ASSERT_TRUE(second.desk.open(other));
    for (const auto& refused :
         {second.desk.open(file), second.desk.create(file, sample_project()), second.desk.save_as(file)}) {
        ASSERT_FALSE(refused);
        EXPECT_THAT(refused.error().sentence(), HasSubstr("the project is open already"));
    }
    EXPECT_EQ(second.desk.path(), other) << "it keeps what it had";
    EXPECT_EQ(second.desk.project().name, "saved");
    EXPECT_TRUE(first.desk.open(file)) << "its own file once more";
    ASSERT_TRUE(first.desk.rename_project("edited again"));
    ASSERT_TRUE(first.desk.save());
    first.desk.close();
    ASSERT_TRUE(second.desk.open(file));
    EXPECT_EQ(second.desk.project().name, "edited again");
    EXPECT_TRUE(first.desk.open(other)) << "which the second has left";
}

// Somebody who computes checksums can still not make a window overflow its stack.
TEST_F(RecoveryTest, AForgedFileIsRefusedInASentence) {
    const std::string deep = std::string(100000, '[') + std::string(100000, ']');
    for (const char* table : {"sensors", "spots", "regions", "calibrations"}) {
        const fs::path file = fresh("forged.seam"), other = fresh("other.seam");
        {
            auto db = Database::open(file.string(), SQLITE_OPEN_READWRITE).value();
            ASSERT_TRUE(db.execute(
                fmt::format("UPDATE {0} SET body = '{{\"id\":\"x\",\"settings\":{1}}}'", table, deep)));
            for (const ChecksummedTable& t : checksummed_tables())
                ASSERT_TRUE(
                    db.execute(fmt::format("UPDATE {} SET checksum = row_checksum({})", t.name, t.columns)));
        }
        WatchedDesk me;
        ASSERT_TRUE(me.desk.open(other));
        const auto refused = me.desk.open(file);
        ASSERT_FALSE(refused) << table;
        EXPECT_THAT(refused.error().sentence(), HasSubstr("cannot be read"));
        EXPECT_EQ(me.desk.path(), other);
        me.desk.close();
        fs::remove(file);
        fs::remove(other);
    }
}

}  // namespace
}  // namespace seamwright
