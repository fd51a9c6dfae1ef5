// Who may do what, and what the chain tells of a file that was changed behind the program's back.

#include "projects/model/users.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <map>

#include "devices/capture/sqlite.h"
#include "devices/exchange/files.h"
#include "projects/file/chain/audit.h"
#include "projects/file/project_file.h"
#include "projects/file/schema.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr const char* kWord = "correct horse battery";

Database raw(const fs::path& path) {
    return std::move(*Database::open(path.string(), SQLITE_OPEN_READWRITE, kProjectFile));
}

// With ada, administrator.
ProjectFile with_administrator(const fs::path& path) {
    auto file = ProjectFile::create(path, sample_project());
    EXPECT_TRUE(file) << file.error().sentence();
    auto added = file->add_user("ada", Role::administrator, kWord);
    EXPECT_TRUE(added) << added.error().sentence();
    return std::move(*file);
}

std::string sentence(const Expected<void>& done) {
    return done ? std::string() : done.error().sentence();
}
template <class T>
std::string sentence(const Expected<T>& done) {
    return done ? std::string() : done.error().sentence();
}

TEST(Users, AProjectWithoutUsersAsksNobody) {
    TemporaryFolder folder;
    auto file = ProjectFile::create(folder / "a.seam", sample_project());
    ASSERT_TRUE(file);
    for (const Deed deed : {Deed::push, Deed::teach, Deed::limits, Deed::override, Deed::remove, Deed::users})
        EXPECT_TRUE(file->may(deed));
    RunRecord run = sample_run(1);
    run.push = true;
    EXPECT_TRUE(file->append_run(run, sample_project()));
    EXPECT_THAT(sentence(file->sign_in("ada", kWord)), HasSubstr("has no users"));
}

TEST(Users, RolesAreEnforcedWhereItIsWritten) {
    TemporaryFolder folder;
    auto file = with_administrator(folder / "a.seam");
    Project project = sample_project();
    project.regions[0].limits.translation_mm = 10;
    EXPECT_THAT(sentence(file.save(project)), HasSubstr("nobody is signed in"));
    RunRecord push = sample_run(1);
    push.push = true;
    EXPECT_THAT(sentence(file.append_run(push, project)), HasSubstr("nobody is signed in"));
    RunRecord dry = sample_run(2);
    dry.push = false;
    EXPECT_TRUE(file.append_run(dry, project)) << "a dry run asks nobody";

    ASSERT_TRUE(file.sign_in("ada", kWord));
    ASSERT_TRUE(file.add_user("grace", Role::engineer, "engineer's word"));
    ASSERT_TRUE(file.add_user("otto", Role::operator_, "operator's word"));
    ASSERT_TRUE(file.add_user("cell-7", Role::service, "service's word"));

    ASSERT_TRUE(file.sign_in("otto", "operator's word"));
    EXPECT_TRUE(file.append_run(push, sample_project()));
    EXPECT_THAT(sentence(file.append_run(push, project)), HasSubstr("not the saved project"))
        << "limits that only stand on his screen";
    Project answered = sample_project();
    answered.sensors[0].identity.serial = "another that answered";
    EXPECT_TRUE(file.append_run(push, answered)) << "whom the gate refuses";
    EXPECT_THAT(sentence(file.save(project)), HasSubstr("otto is operator"));
    EXPECT_FALSE(file.delete_run(1));
    EXPECT_FALSE(file.add_user("x", Role::operator_, "another word"));
    EXPECT_EQ(file.load()->regions[0].limits.translation_mm,
              sample_project().regions[0].limits.translation_mm);

    ASSERT_TRUE(file.sign_in("cell-7", "service's word"));
    EXPECT_TRUE(file.append_run(push, sample_project()));
    EXPECT_TRUE(file.delete_run(1)) << "a service clears old runs away";
    EXPECT_FALSE(file.save(project));

    ASSERT_TRUE(file.sign_in("grace", "engineer's word"));
    EXPECT_TRUE(file.save(project));
    EXPECT_FALSE(file.remove_user("otto"));

    // What was done has its person, and a changed limit its old and new value.
    const auto chain = file.chain();
    ASSERT_TRUE(chain);
    const auto edit = std::ranges::find_if(*chain, [&](const ChainEntry& e) {
        return e.kind == "project" && e.subject == "regions " + project.regions[0].id && e.person == "grace";
    });
    ASSERT_NE(edit, chain->end());
    EXPECT_THAT(edit->note, HasSubstr("limits/translation_mm"));
    EXPECT_THAT(edit->note, HasSubstr("-> 10"));
    const auto events = file.events();
    const auto entered = std::ranges::find_if(*events, [](const EventRecord& e) {
        return e.subject == "user otto" && e.text.english().starts_with("signed in");
    });
    ASSERT_NE(entered, events->end());
    EXPECT_EQ(entered->person, "otto");
    EXPECT_TRUE(file.check().empty()) << file.check().front().sentence();
}

TEST(Users, ARoleThatIsTakenCountsAtOnceInOtherPrograms) {
    TemporaryFolder folder;
    auto file = with_administrator(folder / "a.seam");
    ASSERT_TRUE(file.sign_in("ada", kWord));
    ASSERT_TRUE(file.add_user("grace", Role::engineer, "engineer's word"));
    auto desk = ProjectFile::open(folder / "a.seam");
    ASSERT_TRUE(desk);
    const auto token = desk->sign_in("grace", "engineer's word");
    ASSERT_TRUE(token);
    EXPECT_TRUE(desk->may(Deed::teach));
    ASSERT_TRUE(file.set_role("grace", Role::operator_));
    EXPECT_FALSE(desk->may(Deed::teach));
    EXPECT_TRUE(desk->may(Deed::push));
    auto worker = ProjectFile::open(folder / "a.seam");
    EXPECT_THAT(sentence(worker->act_for(*token)), HasSubstr("changed meanwhile"));
    ASSERT_TRUE(file.remove_user("grace"));
    EXPECT_FALSE(desk->may(Deed::push));
}

TEST(Users, AnotherConnectionActsForWhoSignedInHereAlone) {
    TemporaryFolder folder;
    auto file = with_administrator(folder / "a.seam");
    const auto token = file.sign_in("ada", kWord);
    ASSERT_TRUE(token);
    auto same = ProjectFile::open(folder / "a.seam");
    ASSERT_TRUE(same->act_for(*token));
    EXPECT_TRUE(same->may(Deed::users));
    ASSERT_TRUE(file.copy_to(folder / "copy.seam"));
    auto copy = ProjectFile::open(folder / "copy.seam");
    EXPECT_TRUE(copy->act_for(*token)) << "a copy is the same project";
    auto other = with_administrator(folder / "b.seam");
    EXPECT_FALSE(other.act_for(*token));
    EXPECT_FALSE(other.may(Deed::push));
}

TEST(Users, TheLastAdministratorStays) {
    TemporaryFolder folder;
    auto made = ProjectFile::create(folder / "a.seam", sample_project());
    EXPECT_THAT(sentence(made->add_user("otto", Role::operator_, kWord)), HasSubstr("first user"));
    auto file = with_administrator(folder / "b.seam");
    ASSERT_TRUE(file.sign_in("ada", kWord));
    ASSERT_TRUE(file.add_user("otto", Role::operator_, "operator's word"));
    EXPECT_FALSE(file.remove_user("ada"));
    EXPECT_FALSE(file.set_role("ada", Role::engineer));
    ASSERT_TRUE(file.remove_user("otto"));
    ASSERT_TRUE(file.remove_user("ada")) << "alone he may go: nobody is asked any more";
    file.forget_person();
    EXPECT_TRUE(file.may(Deed::users));
    EXPECT_TRUE(file.check().empty());
}

TEST(Users, NamesAndPasswordsThatAreNone) {
    TemporaryFolder folder;
    auto file = with_administrator(folder / "a.seam");
    ASSERT_TRUE(file.sign_in("ada", kWord));
    for (const std::string name : {"", " ada", "ada ", "-ada", "a\nb", "a\x1b[2J", "a\x7f", "a\xc2\x85",
                                   "a\xe2\x80\xae"
                                   "b",
                                   "a\xe2\x80\x8b", "a\xef\xbb\xbf", "\xff", "a\xc3", "Ada"})
        EXPECT_FALSE(file.add_user(name, Role::engineer, "a good password")) << name;
    EXPECT_FALSE(file.add_user(std::string(65, 'x'), Role::engineer, "a good password"));
    std::string umlauts;  // of two bytes each
    for (int i = 0; i < 64; ++i) umlauts += "\xc3\xbc";
    EXPECT_TRUE(file.add_user(umlauts, Role::engineer, "a good password"));
    EXPECT_FALSE(file.add_user(umlauts + "x", Role::engineer, "a good password"));
    EXPECT_TRUE(file.add_user("J\xc3\xbcrgen M\xc3\xbcller", Role::engineer, "a good password"));
    EXPECT_FALSE(file.add_user("otto", Role::operator_, "short"));
    EXPECT_FALSE(file.add_user("operator", Role::operator_, "Operator"));
    EXPECT_FALSE(file.add_user("otto", Role::operator_, std::string(2000, 'x')));
}

TEST(Users, WrongPasswordsAreWaitedForByAllProgramsTogether) {
    TemporaryFolder folder;
    auto file = with_administrator(folder / "a.seam");
    for (int i = 0; i < 3; ++i)
        EXPECT_THAT(sentence(file.sign_in("ada", "wrong password")), HasSubstr("user or password is wrong"));
    EXPECT_THAT(sentence(file.sign_in("ada", kWord)), HasSubstr("3 wrong passwords"));
    auto other = ProjectFile::open(folder / "a.seam");
    EXPECT_THAT(sentence(other->sign_in("ada", kWord)), HasSubstr("try again in"));
    EXPECT_THAT(sentence(other->sign_in("nobody", kWord)), HasSubstr("user or password is wrong"));
    int wrong = 0;
    const auto chain = file.chain();
    ASSERT_TRUE(chain);
    for (const ChainEntry& e : *chain) wrong += e.kind == "wrong password" && e.subject == "ada";
    EXPECT_EQ(wrong, 3);
}

TEST(Users, AHashFitsNoOtherUserAndNoOtherFile) {
    TemporaryFolder folder;
    auto mine = with_administrator(folder / "mine.seam");
    auto theirs = with_administrator(folder / "theirs.seam");
    ASSERT_TRUE(theirs.sign_in("ada", kWord));
    ASSERT_TRUE(theirs.add_user("otto", Role::operator_, "operator's word"));
    // Both have a user ada with the same password, and ada's row goes over with its checksum.
    std::string hash;
    {
        auto from = raw(folder / "mine.seam");
        auto s = from.prepare("SELECT password FROM users");
        ASSERT_TRUE(*s->step());
        hash = s->text(0);
    }
    {
        auto to = raw(folder / "theirs.seam");
        ASSERT_TRUE(to.execute("UPDATE users SET password = '" + hash + "' WHERE id = 'ada'"));
        ASSERT_TRUE(to.execute("UPDATE users SET checksum = row_checksum(id, role, password, created_utc)"));
    }
    auto opened = ProjectFile::open(folder / "theirs.seam");
    ASSERT_TRUE(opened) << opened.error().sentence();
    EXPECT_THAT(sentence(opened->sign_in("ada", kWord)), HasSubstr("user ada is not as entry"));
    EXPECT_FALSE(opened->may(Deed::push));
    EXPECT_THAT(opened->check().front().sentence(), HasSubstr("user ada is not as entry"));
}

TEST(Chain, UsersThatAreDeletedOrPutInAreSeen) {
    TemporaryFolder folder;
    with_administrator(folder / "a.seam");
    raw(folder / "a.seam").execute("DELETE FROM users");
    auto file = ProjectFile::open(folder / "a.seam");
    ASSERT_TRUE(file);
    EXPECT_THAT(sentence(file->may(Deed::push)), HasSubstr("user ada is not as entry"));
    Project project = sample_project();
    project.name = "mine";
    EXPECT_FALSE(file->save(project));
    const auto findings = file->check();
    ASSERT_FALSE(findings.empty());
    EXPECT_EQ(findings.front().kind, ErrorKind::file);

    with_administrator(folder / "b.seam");
    raw(folder / "b.seam")
        .execute(
            "INSERT INTO users SELECT 'eve', role, password, created_utc, row_checksum('eve', role, "
            "password, "
            "created_utc) FROM users");
    auto other = ProjectFile::open(folder / "b.seam");
    ASSERT_TRUE(other);
    EXPECT_THAT(sentence(other->sign_in("ada", kWord)), HasSubstr("user eve is in no entry"));

    with_administrator(folder / "c.seam");
    raw(folder / "c.seam").execute("DELETE FROM users; DELETE FROM chain");
    EXPECT_THAT(sentence(ProjectFile::open(folder / "c.seam")->may(Deed::push)), HasSubstr("chain"));
}

// Every way in which a row may be changed, with its checksum made right again.
TEST(Chain, NamesTheFirstBrokenEntry) {
    TemporaryFolder folder;
    {
        auto file = with_administrator(folder / "a.seam");
        ASSERT_TRUE(file.sign_in("ada", kWord));
        ASSERT_TRUE(file.append_run(sample_run(1), sample_project()));
        ASSERT_TRUE(
            file.append_event({0, "2024-05-01T12:00:00.000Z", 0, EventKind::note, "R1", "looked at"}));
        EXPECT_TRUE(file.check().empty()) << file.check().front().sentence();
    }
    const auto after = [&](const std::string& sql) {
        fs::copy_file(folder / "a.seam", folder / "b.seam", fs::copy_options::overwrite_existing);
        auto done = raw(folder / "b.seam").execute(sql);
        EXPECT_TRUE(done) << done.error().sentence();
        auto file = ProjectFile::open(folder / "b.seam", FileAccess::read_only);
        if (!file) return file.error().sentence();
        const auto findings = file->check();
        return findings.empty() ? std::string() : findings.front().sentence();
    };
    EXPECT_EQ(after("SELECT 1"), "");
    EXPECT_THAT(after("UPDATE chain SET note = 'x' WHERE number = 7"), HasSubstr("entry 7 of the chain"));
    EXPECT_THAT(after("DELETE FROM chain WHERE number = 5"), HasSubstr("entry 6 of the chain"));
    EXPECT_THAT(after("UPDATE chain SET person = 'eve' WHERE number = (SELECT max(number) FROM chain)"),
                HasSubstr("does not follow"));
    EXPECT_THAT(after("UPDATE regions SET body = replace(body, '\"translation_mm\":', "
                      "'\"translation_mm\":1'), checksum "
                      "= 0; UPDATE regions SET checksum = row_checksum(id, position, frame_name, body)"),
                HasSubstr("regions " + sample_project().regions[0].id + " is not as entry"));
    EXPECT_THAT(
        after("UPDATE runs SET part_id = 'other'; UPDATE runs SET checksum = row_checksum(number, part_id, "
              "started_utc, finished_utc, push, status, message, setup)"),
        HasSubstr("run 1 is not as entry"));
    EXPECT_THAT(
        after("UPDATE events SET subject = 'R2' WHERE id = (SELECT max(id) FROM events); UPDATE events SET "
              "checksum = row_checksum(id, utc, run, kind, subject, text)"),
        HasSubstr("event"));
    EXPECT_THAT(after("DELETE FROM events WHERE id = (SELECT max(id) FROM events)"), HasSubstr("event"));
    EXPECT_THAT(after("DELETE FROM runs"), HasSubstr("run 1 is not as entry"));
    EXPECT_THAT(after("UPDATE captures SET captures = captures + 1"), HasSubstr("raw data of run 1"));
    EXPECT_THAT(after("DROP TABLE users"), HasSubstr("tables"));
}

// sha256sum over netstrings that are put together here, from the exported text alone.
TEST(Chain, AnExportIsComputedAgainBySha256sum) {
    TemporaryFolder folder;
    auto file = with_administrator(folder / "a.seam");
    ASSERT_TRUE(file.sign_in("ada", kWord));
    Project project = sample_project();
    project.regions[0].limits.translation_mm = 12.5;
    ASSERT_TRUE(file.save(project));
    ASSERT_TRUE(file.append_run(sample_run(1), project));
    const auto audit = audit_of(file);
    ASSERT_TRUE(audit);
    EXPECT_TRUE(audit->findings.empty());
    const auto document = audit_json(*audit);
    const auto net = [](const std::string& s) { return std::to_string(s.size()) + ":" + s + ","; };
    std::string before;
    std::map<std::string, std::string> wanted;  // digest by file
    int events = 0;
    const auto add = [&](const std::string& bytes, const std::string& digest) {
        const std::string name = "e" + std::to_string(wanted.size());
        std::ofstream(folder / name, std::ios::binary) << bytes;
        wanted[name] = digest;
    };
    for (const auto& e : document.at("entries")) {
        std::string bytes =
            net("seamwright chain 1") + net(before) + net(std::to_string(e.at("number").get<int>()));
        for (const char* field : {"utc", "person", "kind", "subject", "digest", "note"})
            bytes += net(e.at(field).get<std::string>());
        before = e.at("hash").get<std::string>();
        add(bytes, before);
        if (!e.contains("event")) continue;
        ++events;
        const auto& event = e.at("event");
        add(net("events") + net(e.at("subject").get<std::string>()) +
                net(event.at("utc").get<std::string>()) + net(std::to_string(event.at("run").get<int>())) +
                net(event.at("kind").get<std::string>()) + net(event.at("subject").get<std::string>()) +
                net(event.at("text").get<std::string>()),
            e.at("digest").get<std::string>());
    }
    EXPECT_GE(events, 3);
    const std::string command = "cd '" + (folder / ".").string() + "' && sha256sum e*";
    std::FILE* pipe = popen(command.c_str(), "r");
    ASSERT_NE(pipe, nullptr);
    std::array<char, 256> line{};
    std::size_t lines = 0;
    while (std::fgets(line.data(), line.size(), pipe)) {
        const std::string text = line.data();
        const auto name = text.substr(66, text.find('\n') - 66);
        EXPECT_EQ(text.substr(0, 64), wanted[name]) << name;
        ++lines;
    }
    pclose(pipe);
    EXPECT_EQ(lines, wanted.size());
}

TEST(Chain, AnOlderCopyIsSeenByAnEarlierExport) {
    TemporaryFolder folder;
    auto file = ProjectFile::create(folder / "a.seam", sample_project());
    ASSERT_TRUE(file);
    ASSERT_TRUE(file->copy_to(folder / "old.seam"));
    ASSERT_TRUE(file->append_event({0, {}, 0, EventKind::note, "R1", "a \"quoted\", word\nand a line"}));
    const auto now = audit_of(*file);
    ASSERT_TRUE(now);
    const std::string csv = audit_csv(*now), json = audit_json(*now).dump(),
                      head = now->lines.back().entry.hash;
    EXPECT_TRUE(audit_against(*now, csv, "x")->empty());
    ASSERT_TRUE(file->append_event({0, {}, 0, EventKind::note, "R1", "more"}));
    const auto later = audit_of(*file);
    EXPECT_TRUE(audit_against(*later, csv, "x")->empty());
    EXPECT_TRUE(audit_against(*later, json, "x")->empty());
    EXPECT_TRUE(audit_against_head(*later, head)->empty());

    auto old = ProjectFile::open(folder / "old.seam");
    const auto older = audit_of(*old);
    EXPECT_TRUE(older->findings.empty()) << "in itself it is right";
    EXPECT_THAT(audit_against(*older, csv, "x")->front().sentence(), HasSubstr("older copy"));
    EXPECT_THAT(audit_against_head(*older, head)->front().sentence(), HasSubstr("older copy"));
    ASSERT_TRUE(old->append_event({0, {}, 0, EventKind::note, "R1", "another"}));
    EXPECT_THAT(audit_against(*audit_of(*old), json, "x")->front().sentence(),
                HasSubstr("not the one that was exported"));
    EXPECT_FALSE(audit_against(*later, "number,what\n1,2\n", "x"));
    EXPECT_FALSE(audit_against_head(*later, "abc"));
}

TEST(Chain, OldFilesBeginOne) {
    TemporaryFolder folder;
    {
        auto db = Database::open((folder / "a.seam").string(), SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE,
                                 kProjectFile);
        ASSERT_TRUE(db);
        std::ifstream dump(SEAMWRIGHT_TEST_DATA "/version11.sql");
        const std::string sql((std::istreambuf_iterator<char>(dump)), {});
        ASSERT_FALSE(sql.empty());
        ASSERT_TRUE(db->execute(sql));
    }
    auto file = ProjectFile::open(folder / "a.seam");
    ASSERT_TRUE(file) << file.error().sentence();
    const auto chain = file->chain();
    ASSERT_TRUE(chain);
    EXPECT_EQ(chain->front().kind, "begin");
    EXPECT_EQ(chain->front().note, "version 11");
    EXPECT_GT(chain->size(), 5u);
    EXPECT_TRUE(file->check().empty()) << file->check().front().sentence();
    ASSERT_TRUE(file->append_event({0, {}, 0, EventKind::note, "R1", "after it"}));
    ASSERT_TRUE(file->append_run(sample_run(7), *file->load()));
    EXPECT_TRUE(file->check().empty()) << file->check().front().sentence();
}

}  // namespace
}  // namespace seamwright
