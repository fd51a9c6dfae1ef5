// What the program says to a person has its German: every key one, and no German without a key.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "core/text.h"
#include "tests/core/said_in_sources.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;

std::string content_of(const fs::path& file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
}

std::map<std::string, std::string> catalogue() {
    return nlohmann::json::parse(
        content_of(fs::path(SEAMWRIGHT_SOURCE) / "resources/translations/texts_de.json"));
}

template <class Each>
void each_source(const std::vector<std::string>& folders, const Each& each) {
    for (const std::string& folder : folders)
        for (const auto& entry : fs::recursive_directory_iterator(fs::path(SEAMWRIGHT_SOURCE) / folder)) {
            if (entry.path().extension() != ".cpp" && entry.path().extension() != ".h") continue;
            each(fs::relative(entry.path(), SEAMWRIGHT_SOURCE).string(), content_of(entry.path()));
        }
}

std::vector<std::string> marks_of(const std::string& pattern) {
    static const std::regex mark(R"(\{\{|\}\}|\{([0-9]*)(:[^{}]*)?\})");
    std::vector<std::string> marks;
    int next = 0;
    for (std::sregex_iterator it(pattern.begin(), pattern.end(), mark), end; it != end; ++it) {
        if ((*it)[0] == "{{" || (*it)[0] == "}}") continue;
        const std::string number = (*it)[1].length() > 0 ? (*it)[1].str() : std::to_string(next++);
        marks.push_back(number + (*it)[2].str());
    }
    std::sort(marks.begin(), marks.end());
    marks.erase(std::unique(marks.begin(), marks.end()), marks.end());
    return marks;
}

TEST(SaidInSources, FindsWhatBecomesAText) {
    const auto said = [](const std::string& source) {
        std::vector<std::string> texts;
        for (const SourceLiteral& literal : literals_of(source))
            if (is_said(literal)) texts.push_back(literal.text);
        return texts;
    };
    using testing::ElementsAre;
    EXPECT_THAT(said("return input_error(\"no such \"\n  \"spot\", w, cond ? \"make it\" : \"leave it\");"),
                ElementsAre("no such spot", "make it", "leave it"));
    EXPECT_THAT(said("const Text why(\"it is {}\", x ? \"too late\" : \"b\"); // \"not this\""),
                ElementsAre("it is {}", "too late"));
    EXPECT_THAT(
        said("report.judgement = {Verdict::poor, Text(\"off by {}\", f(\"id\")), \"measure again\"};"),
        ElementsAre("off by {}", "measure again"));
    EXPECT_THAT(said("s.prepare(\"SELECT a FROM b\"); f(R\"(Text(\"raw one\"))\"); Text('\"', \"a b\")"),
                ElementsAre("a b"));
}

TEST(SaidInSources, OfASettingOnlyItsHelp) {
    const auto said = [](const std::string& source) {
        std::vector<std::string> texts;
        for (const SourceLiteral& literal : literals_of(source))
            if (is_setting_help(literal) && is_said(literal)) texts.push_back(literal.text);
        return texts;
    };
    using testing::ElementsAre;
    using testing::IsEmpty;
    EXPECT_THAT(said("{entry::text(\"listen\", \"this computer\", \"in the \"\n  \"network\"),\n"
                     " whole(\"buffer_size\", 0, 0, 1 << 30, \"bytes\")}"),
                ElementsAre("in the network", "bytes"));
    EXPECT_THAT(
        said("choice(\"kind\", {\"\", \"a b\", \"c\"}, \"which files\"), pose(\"tool\", \"as taught\")"),
        ElementsAre("which files", "as taught"));
    EXPECT_THAT(
        said("object(\"ramp\", {number(\"speed\", f(d, \"a b\", 2), 0, 1, \"of it\"),\n"
             "  list(\"points\", json{{0, 1}}, \"ids\"), yes_no(\"loop\", false, \"anew\")}, \"way of it\")"),
        ElementsAre("of it", "ids", "anew", "way of it"));
    EXPECT_THAT(
        said("f.text(\"serial\", s.serial); r.number(\"low and high\", v, 0, 1); o.pose(\"a b\", p);"),
        IsEmpty());
}

// What only the command line and simulated devices say is not shown in a window; what their settings are for is.
constexpr std::array kElsewhere = {"devices/controllers", "devices/simulated", "devices/cell_server",
                                   "devices/served"};
TEST(Catalogue, EveryKeyHasItsGerman) {
    const auto german = catalogue();
    int keys = 0;
    each_source(
        {"core", "devices", "projects", "widgets"}, [&](const std::string& name, const std::string& source) {
            const bool elsewhere = std::any_of(kElsewhere.begin(), kElsewhere.end(),
                                               [&](const char* folder) { return name.starts_with(folder); });
            for (const SourceLiteral& literal : literals_of(source)) {
                if (elsewhere ? !is_setting_help(literal) : !is_said(literal)) continue;
                ++keys;
                EXPECT_TRUE(german.count(literal.text))
                    << name << ":" << literal.line << ": \"" << literal.text
                    << "\" is missing in resources/translations/texts_de.json";
            }
        });
    EXPECT_GT(keys, 1500);
}

TEST(Catalogue, NoGermanIsWithoutAKey) {
    std::set<std::string> literals;
    each_source({"core", "devices", "projects", "widgets", "app"},
                [&](const std::string&, const std::string& source) {
                    for (const SourceLiteral& literal : literals_of(source)) literals.insert(literal.text);
                });
    for (const auto& [english, german] : catalogue())
        EXPECT_TRUE(literals.count(english)) << "\"" << english << "\" is said nowhere";
}

TEST(Catalogue, BothLanguagesHoldTheSameValues) {
    for (const auto& [english, german] : catalogue()) {
        EXPECT_FALSE(german.empty()) << english;
        EXPECT_EQ(marks_of(german), marks_of(english)) << english << "\n" << german;
        EXPECT_EQ(german_of(english), german);
    }
}

}  // namespace
}  // namespace seamwright
