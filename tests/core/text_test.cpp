#include "core/text.h"

#include <gmock/gmock.h>

#include <cerrno>
#include <cmath>
#include <future>
#include <limits>

#include "core/error.h"
#include "core/system_text.h"

namespace seamwright {
namespace {

TEST(Text, SaysInEnglishWhatFmtWouldSay) {
    EXPECT_EQ(Text("no spots").english(), "no spots");
    EXPECT_EQ(Text("{:.3f} mm of {} at {}", 0.12345, 3U, "left").english(), "0.123 mm of 3 at left");
    EXPECT_EQ(Text("{:>6} {:04d} {}", std::string("a"), 7, true).english(), "     a 0007 true");
    EXPECT_EQ(Text("{} {}", std::nan(""), -std::numeric_limits<double>::infinity()).english(), "nan -inf");
    EXPECT_EQ(Text("a set is {a, b}").english(), "a set is {a, b}") << "no values, so no marks";
    EXPECT_EQ(Text().english(), "");
    EXPECT_TRUE(Text().empty());
    EXPECT_TRUE(Text(std::string()).empty());
}

TEST(Text, IsGermanToTheLastWordOfItsOwn) {
    const Text inner("spot {}", std::string("T1"));
    EXPECT_EQ(inner.in(Language::german), "Messstelle T1");
    EXPECT_EQ(Text("{} degrees, {}", 3, inner).in(Language::german), "3 degrees, Messstelle T1")
        << "a pattern without German is said in English, what goes into it is not";
    EXPECT_EQ(joined(inner, ": ", Text("region {}", std::string("left"))).in(Language::german),
              "Messstelle T1: Korrekturbereich left");
    EXPECT_EQ(Text("spot {}", std::string("left")).in(Language::german), "Messstelle left") << "names stay";
}

TEST(Text, WordsOfOthersStay) {
    const Text said(std::string("Errno 1234 {} %1 {{"));
    EXPECT_TRUE(said.foreign());
    EXPECT_EQ(said.in(Language::german), "Errno 1234 {} %1 {{");
    EXPECT_EQ(Text("spot {}", said).english(), "spot Errno 1234 {} %1 {{");
    EXPECT_EQ(Text(std::string("spot {}")).in(Language::german), "spot {}") << "even where they are a key";
}

TEST(Text, AnErrorIsGermanFromPlaceToCure) {
    const Error error{ErrorKind::input, Text("the id is used twice"), Text("spot {}", std::string("T1")),
                      "rename one"};
    EXPECT_EQ(error.sentence(), "spot T1: the id is used twice; rename one");
    EXPECT_THAT(error.text().in(Language::german), testing::StartsWith("Messstelle T1: "));
    EXPECT_THAT(error.text().in(Language::german), testing::Not(testing::HasSubstr("twice")));
    Error outer = error;
    outer.within(Text("region {}", std::string("left")));
    EXPECT_EQ(outer.sentence(), "region left: spot T1: the id is used twice; rename one");
}

TEST(Text, JoinsWhatThereIs) {
    const Text a("no spots"), none;
    EXPECT_EQ(joined(a, "; ", none), a);
    EXPECT_EQ(joined(none, "; ", a), a);
    EXPECT_EQ(joined(a, "; ", a).english(), "no spots; no spots");
    EXPECT_EQ(joined(joined(a, "; ", a), "; ", joined(a, "; ", a)).arguments().size(), 4U) << "nothing nests";
    EXPECT_EQ(joined(joined(a, "; ", a), ": ", a).english(), "no spots; no spots: no spots");
    EXPECT_EQ(listed({}).english(), "");
    EXPECT_EQ(listed({a}).english(), "no spots");
    EXPECT_EQ(listed({Text("x"), Text("y"), Text("z")}).english(), "x, y and z");
}

// What a forged file may hold.
TEST(Text, StoredPatternsAreChecked) {
    const auto from = [](const std::string& key, std::vector<Text::Argument> arguments) {
        return Text::from(key, std::move(arguments));
    };
    ASSERT_TRUE(from("{:.3f} mm", {0.25}));
    EXPECT_EQ(from("{:.3f} mm", {0.25})->english(), "0.250 mm");
    ASSERT_TRUE(from("plain {", {})) << "without values there are no marks";
    EXPECT_EQ(from("plain {", {})->english(), "plain {");
    EXPECT_FALSE(from("{", {1.0}));
    EXPECT_FALSE(from("{} {}", {1.0}));
    EXPECT_FALSE(from("{:d}", {std::string("a")}));
    EXPECT_FALSE(from("{:999999999}", {1.0}));
    EXPECT_FALSE(from("{:.999999}", {1.0}));
    EXPECT_FALSE(from("{:{}}", {1.0, std::int64_t{2'000'000'000}}));
    EXPECT_FALSE(from(std::string(100'000, 'x'), {1.0}));
    EXPECT_FALSE(from("{}", std::vector<Text::Argument>(100'000, 1.0)));
}

// In English the system's own word, so that scripts find it; in German what an engineer meets at files and at connections.
TEST(SystemText, IsTheSystemsWordOfEveryNumber) {
    for (int number = 1; number < 140; ++number) {
        EXPECT_EQ(system_text(number), std::generic_category().message(number)) << number;
        EXPECT_EQ(system_text(std::error_code(number, std::system_category())), system_text(number))
            << number;
    }
    for (const int number : {ENOENT, EACCES, ENOSPC, EROFS, EISDIR, EEXIST, ECONNREFUSED, EHOSTUNREACH,
                             ENETUNREACH, ETIMEDOUT, EADDRINUSE, EADDRNOTAVAIL, ECONNRESET, EPIPE, EMFILE})
        EXPECT_NE(system_text(number).in(Language::german), system_text(number).english()) << number;
    const Text refused = device_error(system_text(ECONNREFUSED), "10.0.0.5:502").value().text();
    EXPECT_EQ(refused.in(Language::german), "10.0.0.5:502: Verbindung abgelehnt");
    const std::error_code other = std::make_error_code(std::future_errc::no_state);
    EXPECT_EQ(system_text(other), other.message()) << "another category's number is not the system's";
}

}  // namespace
}  // namespace seamwright
