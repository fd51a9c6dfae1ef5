// A sentence comes back from the file as it was, and says the same in every language; a forged one is words.
#include "projects/file/stored_text.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "devices/exchange/json_fields.h"

namespace seamwright {
namespace {

using nlohmann::json;

std::vector<Text> samples() {
    return {Text(),
            Text("no spot of the region was measured"),
            Text("a set is {a, b}"),
            Text("spot {} is stale: measured {:.1f} s before the part came", std::string("T1"), 3.25),
            Text("{} {} {}", std::nan(""), std::numeric_limits<double>::infinity(),
                 -std::numeric_limits<double>::infinity()),
            Text("{:d} of {}", std::int64_t{-9007199254740993}, 3U),
            Text("{:.2f}", 3.0),
            joined(Text("spot {}", std::string("ä \"q\" \\")), "; ",
                   Text("robot {}: {}", std::string("r"), Text("cancelled"))),
            Text(std::string("words of a device {}")),
            Text(std::string(R"({"text": "forged {}", "with": ["x"]})"))};
}

TEST(StoredText, ComesBack) {
    for (const Text& text : samples()) {
        const Text row = text_from_stored(stored_text(text));
        const auto document = text_from_json(json::parse(text_json(text).dump()));
        ASSERT_TRUE(document) << text;
        for (const Text& back : {row, *document})
            for (const Language language : {Language::english, Language::german})
                EXPECT_EQ(back.in(language), text.in(language));
        EXPECT_EQ(stored_text(row), stored_text(text));
        EXPECT_EQ(row.foreign(), text.foreign());
    }
}

// However long or deep a sentence grew, a run that holds it is read again: nothing of it is lost.
TEST(StoredText, NoSentenceIsTooLongOrTooDeepToComeBack) {
    Text chain, deep("cancelled");
    std::vector<Text> list;
    for (int i = 0; i < 1200; ++i) {
        list.push_back(Text("spot {}", fmt::format("S{}", i)));
        chain = joined(chain, "; ", Text("region {}: {}", fmt::format("R{}", i), Text("cancelled")));
    }
    for (int i = 0; i < 200; ++i) deep = Text("robot {}: {}", std::string("R1"), deep);
    const Text wide("{:>200} {:.3f}", std::string("a"), 0.5);
    for (const Text& text : {chain, deep, wide, listed(list)}) {
        const json document = text_json(text);
        EXPECT_LE(json_depth(document), kDeepestJson - 8) << "room for what it stands in";
        const auto back = text_from_json(json::parse(document.dump()));
        ASSERT_TRUE(back);
        EXPECT_EQ(back->english(), text.english());
        EXPECT_EQ(text_from_stored(stored_text(text)).english(), text.english());
    }
    list.resize(40);
    Text regions;
    for (const Text& one : list) regions = joined(regions, "; ", one);
    EXPECT_EQ(text_from_stored(stored_text(regions)).in(Language::german), regions.in(Language::german));
    EXPECT_NE(regions.in(Language::german), regions.english());
}

TEST(StoredText, OldColumnsAreSomebodysWords) {
    EXPECT_EQ(stored_text(Text(std::string("region left: pushed"))), "region left: pushed");
    const Text old = text_from_stored("region left: 0.2 mm {} {");
    EXPECT_TRUE(old.foreign());
    EXPECT_EQ(old.english(), "region left: 0.2 mm {} {");
}

TEST(StoredText, WhatIsForgedIsRefusedOrWords) {
    for (const char* bad :
         {R"({"text": 5})", R"({"text": "a", "with": 5})", R"({"text": "{:99999}", "with": [1.0]})",
          R"({"text": "{}", "with": [[1]]})", R"({"text": "{}", "with": [null]})",
          R"({"text": "{}", "with": [1], "more": 1})", R"({"text": "{}", "with": [{"number": "big"}]})",
          R"({"text": "{:d}", "with": [99999999999999999999]})", "[]", "5", "null", "{}"}) {
        const auto json_of = json::parse(bad);
        EXPECT_FALSE(text_from_json(json_of)) << bad;
        EXPECT_EQ(text_from_stored(bad).english(), bad);
    }
    json deep = {{"text", "{}"}, {"with", {1}}};
    for (int i = 0; i < 200; ++i) deep = {{"text", "{}"}, {"with", json::array({json{{"text", deep}}})}};
    EXPECT_FALSE(text_from_json(deep));
    EXPECT_EQ(text_from_stored(R"({"text": "half)").english(), R"({"text": "half)");
}

TEST(StoredText, StandsBesideTheEnglishOfAResult) {
    json result = {{"verdict", "poor"}};
    put_text(result, "reason", Text("spot {}", std::string("T1")));
    put_texts(result, "notices", {Text("cancelled"), Text(std::string("of a device"))});
    EXPECT_EQ(result["reason"], "spot T1");
    EXPECT_EQ(result["notices"], json({"cancelled", "of a device"}));
    EXPECT_EQ(text_in(result, "reason").in(Language::german), "Messstelle T1");
    ASSERT_EQ(texts_in(result, "notices").size(), 2U);
    result.erase("texts");  // an old file
    EXPECT_EQ(text_in(result, "reason").english(), "spot T1");
    EXPECT_EQ(texts_in(result, "notices").size(), 2U);
    EXPECT_TRUE(text_in(result, "no such").empty());
    result["texts"] = "forged";
    EXPECT_EQ(text_in(result, "reason").english(), "spot T1");
}

}  // namespace
}  // namespace seamwright
