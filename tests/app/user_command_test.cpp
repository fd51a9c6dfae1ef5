// `seamwright user` and `audit`, and what the other commands make of a person, as a script calls them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "tests/app/run_program.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

class UserCommand : public testing::Test {
  protected:
    fs::path folder = test_folder("user_command"), file = folder / "door.seam";

    void SetUp() override { ASSERT_EQ(run({"new", file.string()}).exit_code, 0); }
    ~UserCommand() override { fs::remove_all(folder); }
    ProgramResult run(const std::vector<std::string>& arguments) const {
        return run_program(arguments, folder);
    }
    std::string password_file(const std::string& name, const std::string& password, fs::perms rights) const {
        const fs::path path = folder / name;
        std::ofstream(path) << password << "\n";
        fs::permissions(path, rights);
        return path.string();
    }
    std::string secret(const std::string& name, const std::string& password) const {
        return password_file(name, password, fs::perms::owner_read | fs::perms::owner_write);
    }
    void done(std::vector<std::string> arguments) const {
        const ProgramResult r = run(arguments);
        EXPECT_EQ(r.exit_code, 0) << r.err << r.out;
    }
    void refused(const std::vector<std::string>& arguments, const char* why, int exit_code = 2) const {
        const ProgramResult r = run(arguments);
        EXPECT_EQ(r.exit_code, exit_code) << r.err << r.out;
        EXPECT_THAT(r.err + r.out, HasSubstr(why));
    }
};

TEST_F(UserCommand, PeopleRolesAndTheirEdits) {
    const std::string door = file.string(), ada = secret("ada.key", "administrator's word"),
                      otto = secret("otto.key", "operator's word");
    done({"type", "add", door, "left"});  // nobody is asked
    refused({"type", "add", door, "right", "--user", "ada", "--password-file", ada}, "has no users");
    refused({"user", "add", door, "ada", "--role", "engineer", "--new-password-file", ada}, "first user");
    refused({"user", "add", door, "ada", "--role", "boss", "--new-password-file", ada}, "no role \"boss\"");
    done({"user", "add", door, "ada", "--role", "administrator", "--new-password-file", ada});

    refused({"type", "add", door, "right"}, "nobody is signed in");
    refused({"user", "add", door, "otto", "--role", "operator", "--new-password-file", otto},
            "nobody is signed in");
    done({"user", "add", door, "otto", "--role", "operator", "--new-password-file", otto, "--user", "ada",
          "--password-file", ada});
    refused({"type", "add", door, "right", "--user", "otto", "--password-file", otto}, "otto is operator");
    refused({"type", "add", door, "right", "--user", "ada", "--password-file", otto},
            "user or password is wrong");
    refused({"type", "add", door, "right", "--user", "ada"}, "no terminal asks");
    const std::string open = password_file("open.key", "administrator's word", fs::perms::all);
    refused({"type", "add", door, "right", "--user", "ada", "--password-file", open}, "chmod 600");
    ASSERT_EQ(setenv("SEAMWRIGHT_PASSWORD", "administrator's word", 1), 0);
    done({"type", "add", door, "right", "--user", "ada"});
    ASSERT_EQ(unsetenv("SEAMWRIGHT_PASSWORD"), 0);
    refused({"user", "remove", door, "ada", "--user", "ada", "--password-file", ada}, "last administrator");

    const fs::path key = folder / "cell.key";
    done({"user", "add", door, "cell-7", "--role", "service", "--password-out", key.string(), "--user", "ada",
          "--password-file", ada});
    EXPECT_EQ(fs::status(key).permissions(), fs::perms::owner_read | fs::perms::owner_write);
    EXPECT_EQ(slurp(key).size(), 65u);
    refused({"service", door, "--push"}, "--identity NAME");
    const ProgramResult unit =
        run({"service", door, "--push", "--identity", "cell-7", "--password-file", key.string()});
    EXPECT_EQ(unit.exit_code, 0) << unit.err;
    EXPECT_THAT(unit.out, HasSubstr("\"--user\" \"cell-7\" \"--password-file\""));
    refused({"run", door, "--push"}, "nobody is signed in");

    const json users = json::parse(run({"user", "list", door, "--json", "-"}).out);
    ASSERT_EQ(users.at("users").size(), 3u);
    EXPECT_EQ(users.at("users")[0].at("role"), "administrator");
    EXPECT_THAT(users.dump(), testing::Not(HasSubstr("argon")));
}

TEST_F(UserCommand, AnAuditNamesTheBrokenEntry) {
    const std::string door = file.string(), csv = (folder / "audit.csv").string(),
                      exported = (folder / "audit.json").string();
    done({"type", "add", door, "left"});
    done({"audit", door, "--csv", csv, "--json", exported});
    EXPECT_THAT(slurp(csv), HasSubstr("\"project\",\"part_types left\""));
    fs::copy_file(file, folder / "old.seam");
    done({"type", "add", door, "right"});
    done({"audit", door, "--since-export", csv});
    done({"audit", door, "--since-export", exported});
    const json now = json::parse(run({"audit", door, "--json", "-"}).out);
    refused({"audit", (folder / "old.seam").string(), "--head", now.at("head").get<std::string>()},
            "older copy", 3);

    sqlite3* db = nullptr;
    ASSERT_EQ(sqlite3_open(door.c_str(), &db), SQLITE_OK);
    ASSERT_EQ(sqlite3_exec(db, "UPDATE chain SET person = 'eve' WHERE number = 3", nullptr, nullptr, nullptr),
              SQLITE_OK);
    sqlite3_close(db);
    refused({"audit", door}, "entry 3 of the chain", 3);
    refused({"check", door}, "entry 3 of the chain", 3);
}

}  // namespace
}  // namespace seamwright
