// The one function that writes files, onto whatever may stand there; and the one that reads JSON.

#include "devices/exchange/files.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <fstream>
#include <thread>

#include "devices/exchange/json_fields.h"
#include "devices/exchange/tables/csv_table.h"
#include "tests/devices/temporary_folder.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::string read(const fs::path& path) {
    return read_text_file(path).value();
}

TEST(WriteTextFile, ReplacesAFileAndLeavesNothingBeside) {
    TemporaryFolder folder;
    const fs::path path = folder.path() / "a.txt";
    ASSERT_TRUE(write_text_file(path, "one"));
    ASSERT_EQ(::chmod(path.c_str(), 0640), 0);
    ASSERT_TRUE(write_text_file(path, "two"));
    EXPECT_EQ(read(path), "two");
    EXPECT_EQ(fs::status(path).permissions(), fs::perms(0640));
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1);
}

TEST(WriteTextFile, AnOptionIsNoName) {
    const auto refused = write_text_file("--help", "x");
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, ErrorKind::input);
    EXPECT_FALSE(fs::exists("--help"));
}

TEST(WriteTextFile, ALinkStaysAndItsFileIsReplacedAsAWhole) {
    TemporaryFolder folder;
    fs::create_directory(folder.path() / "far");
    const fs::path target = folder.path() / "far" / "a.txt", link = folder.path() / "link",
                   link_to_link = folder.path() / "link2";
    ASSERT_TRUE(write_text_file(target, "old"));
    fs::create_symlink("far/a.txt", link);
    fs::create_symlink("link", link_to_link);
    std::ifstream reader(target);  // has the old file open
    ASSERT_TRUE(write_text_file(link_to_link, "new"));
    EXPECT_TRUE(fs::is_symlink(link));
    EXPECT_TRUE(fs::is_symlink(link_to_link));
    EXPECT_EQ(read(target), "new");
    std::string seen;
    reader >> seen;
    EXPECT_EQ(seen, "old") << "replaced, not written over";
    fs::remove(target);
    ASSERT_TRUE(write_text_file(link, "made")) << "a link to nothing yet";
    EXPECT_EQ(read(target), "made");
    fs::create_symlink("round", folder.path() / "round");
    EXPECT_FALSE(write_text_file(folder.path() / "round", "x"));
    EXPECT_TRUE(fs::is_symlink(folder.path() / "round"));
}

// `export a.seam --out a.seam` must not cost the project.
TEST(WriteTextFile, NeverTakesThePlaceOfADatabase) {
    TemporaryFolder folder;
    const fs::path project = folder.path() / "a.seam", link = folder.path() / "link",
                   text = folder.path() / "b.txt";
    const std::string database = std::string("SQLite format 3\0", 16) + "and its pages";
    std::ofstream(project, std::ios::binary) << database;
    fs::create_symlink("a.seam", link);
    for (const fs::path& path : {project, link}) {
        const auto refused = write_text_file(path, "{}");
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().kind, ErrorKind::input);
        EXPECT_THAT(refused.error().sentence(), HasSubstr("is a project or a recording"));
        EXPECT_EQ(read(path), database);
    }
    std::ofstream(text, std::ios::binary) << "SQLite format";  // shorter than a database's header
    EXPECT_TRUE(write_text_file(text, "{}"));
}

TEST(WriteTextFile, AFifoIsWrittenThrough) {
    TemporaryFolder folder;
    const fs::path fifo = folder.path() / "fifo";
    ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
    const std::string text(300000, 'x');  // more than a pipe holds
    std::string got;
    std::thread reader([&] { got = read(fifo); });
    EXPECT_TRUE(write_text_file(fifo, text));
    reader.join();
    EXPECT_EQ(got, text);
    EXPECT_TRUE(fs::is_fifo(fifo));
}

TEST(WriteTextFile, DevicesStay) {
    struct stat before {
    }, after{};
    ASSERT_EQ(::stat("/dev/null", &before), 0);
    EXPECT_TRUE(write_text_file("/dev/null", "gone"));
    ASSERT_EQ(::stat("/dev/null", &after), 0);
    EXPECT_EQ(before.st_ino, after.st_ino);
    EXPECT_TRUE(S_ISCHR(after.st_mode));
    const auto full = write_text_file("/dev/full", "no room");
    ASSERT_FALSE(full);
    EXPECT_THAT(full.error().sentence(), HasSubstr("No space left"));
    TemporaryFolder folder;
    fs::create_symlink("/dev/null", folder.path() / "null");
    EXPECT_TRUE(write_text_file(folder.path() / "null", "gone"));
    EXPECT_TRUE(fs::is_symlink(folder.path() / "null"));
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const std::string name = (folder.path() / "socket").string();
    name.copy(address.sun_path, sizeof address.sun_path - 1);
    const int server = ::socket(AF_UNIX, SOCK_STREAM, 0);
    ASSERT_EQ(::bind(server, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    EXPECT_FALSE(write_text_file(name, "x"));
    EXPECT_TRUE(fs::is_socket(name));
    ::close(server);
}

// What the shell has put at a descriptor goes on where it is: neither replaced nor written over.
TEST(WriteTextFile, OwnDescriptorsAreWrittenOn) {
    TemporaryFolder folder;
    const fs::path path = folder.path() / "out.txt";
    const int fd = ::open(path.c_str(), O_CREAT | O_WRONLY | O_CLOEXEC, 0600);
    ASSERT_EQ(::write(fd, "before ", 7), 7);
    EXPECT_TRUE(write_text_file("/dev/fd/" + std::to_string(fd), "this "));
    EXPECT_TRUE(write_text_file("/proc/self/fd/" + std::to_string(fd), "that "));
    ASSERT_EQ(::write(fd, "after", 5), 5);
    ::close(fd);
    EXPECT_EQ(read(path), "before this that after");
    EXPECT_FALSE(write_text_file("/dev/fd/" + std::to_string(fd), "closed"));
}

TEST(WriteTextFile, RefusesAFolder) {
    TemporaryFolder folder;
    EXPECT_FALSE(write_text_file(folder.path(), "x"));
    EXPECT_FALSE(write_text_file(folder.path() / "missing" / "a.txt", "x"));
}

// --- JSON

TEST(ParseJson, ReadsWhatIsWritten) {
    const char* text =
        R"({"a": [1, -2, 3.5, 18446744073709551615, "x\u00fc", null, true, {}], "b": {"a": []}})";
    const auto read = parse_json(text, "x");
    ASSERT_TRUE(read) << read.error().sentence();
    EXPECT_EQ(*read, nlohmann::json::parse(text));
    EXPECT_EQ(parse_json(" 7 ", "x").value(), 7);
    EXPECT_EQ(parse_json("\xEF\xBB\xBF[]", "x").value(), nlohmann::json::array());
}

TEST(ParseJson, RefusesWithASentence) {
    const std::pair<std::string, const char*> bad[] = {
        {"", "empty"},
        {" \n", "empty"},
        {"{", "line 1"},
        {"[1,]", "line 1"},
        {"[1] 2", "line 1"},
        {"{\"a\":1,\"b\":2,\"a\":3}", "\"a\" is given twice"},
        {"[{\"a\":{\"b\":1,\"b\":1}}]", "\"b\" is given twice"},
        {"// no\n1", "line 1"},
        {"1e999", "number"},
        {"\"\xff\"", "UTF-8"},
        {"nan", "line 1"},
    };
    for (const auto& [text, words] : bad) {
        const auto read = parse_json(text, "x.json");
        ASSERT_FALSE(read) << text;
        EXPECT_EQ(read.error().kind, ErrorKind::input);
        EXPECT_THAT(read.error().sentence(), HasSubstr(words)) << text;
        EXPECT_THAT(read.error().sentence(), HasSubstr("x.json"));
    }
}

TEST(ParseJson, DepthIsLimited) {
    const auto nested = [](std::size_t depth, const char* open, const char* close) {
        std::string text;
        for (std::size_t i = 0; i < depth; ++i) text += open;
        text += "1";
        for (std::size_t i = 0; i < depth; ++i) text += close;
        return text;
    };
    for (const auto& [open, close] : {std::pair{"[", "]"}, {"{\"a\":", "}"}, {"[1,[", "]]"}}) {
        const std::size_t each = open == std::string_view("[1,[") ? 2 : 1;
        const auto deepest = parse_json(nested(kDeepestJson / each, open, close), "x");
        ASSERT_TRUE(deepest) << deepest.error().sentence();
        EXPECT_EQ(json_depth(*deepest), kDeepestJson);
        for (const std::size_t depth : {kDeepestJson / each + 1, std::size_t{100000}, std::size_t{5000000}}) {
            const auto refused = parse_json(nested(depth, open, close), "x");
            ASSERT_FALSE(refused) << depth;
            EXPECT_THAT(refused.error().sentence(), HasSubstr("nested deeper than 64"));
        }
    }
    EXPECT_FALSE(parse_json(std::string(100000, '['), "x"));
}

// --- CSV

TEST(CsvField, IsQuotedWhereItMustBeAndReadsBack) {
    EXPECT_EQ(csv::field("door left"), "door left");
    EXPECT_EQ(csv::field("a,b"), "\"a,b\"");
    EXPECT_EQ(csv::field("12\" rim"), "\"12\"\" rim\"");
    EXPECT_EQ(csv::field(" a"), "\" a\"");
    for (const std::string& text :
         {std::string("plain"), std::string("a,b"), std::string("\"quoted\""), std::string(","),
          std::string("\""), std::string("\"\""), std::string(" blanks "), std::string("a\",\"b"),
          std::string("semi;colon")}) {
        const std::string file = "number,name,z\n1," + csv::field(text) + ",3\n";
        CsvTable table(file, "x.csv", "");
        const std::string_view wanted[] = {"number", "name", "z"};
        ASSERT_TRUE(table.header(wanted, 3));
        ASSERT_TRUE(table.row().value()) << text;
        EXPECT_EQ(table.text(1), text);
        EXPECT_EQ(table.number(2, "z").value(), 3) << text;
    }
}

}  // namespace
}  // namespace seamwright
