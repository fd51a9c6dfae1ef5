// MQTT before Debian's own broker and its tools: what they hear, and a broker that is killed.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "devices/line/mqtt.h"
#include "tests/devices/line/broker.h"

namespace seamwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using namespace std::chrono_literals;

class MqttLine : public testing::Test {
  protected:
    void open(json more = json::object()) {
        json settings = {{"port", broker->port()}, {"group", "hall"},         {"node", "door left"},
                         {"reconnect_ms", 20},     {"reconnect_most_ms", 50}, {"start", "line"},
                         {"timeout_ms", 1000}};
        settings.update(more);
        auto opened = open_line("mqtt", settings, "project");
        ASSERT_TRUE(opened) << opened.error().sentence();
        link = std::move(*opened);
        state.ready = true;
        state.alarm = LineAlarm::none;
        link->publish(state);
    }
    json heard(const std::string& kind, const std::string& more = "") const {
        return json::parse(broker->sub(more + " -C 1 -W 5 -t 'seamwright/hall/" + kind + "/door left'"),
                           nullptr, false);
    }
    bool state_is(const std::string& key, const json& value) const {
        return soon([&] {
            const json kept = heard("STATE");
            return kept.is_object() && kept.contains(key) && kept[key] == value;
        });
    }
    Said command(const std::string& text, const std::string& more = "") const {
        return broker->pub(more + " -t 'seamwright/hall/NCMD/door left' -m '" + text + "'");
    }
    std::optional<LineCall> call(std::chrono::milliseconds patience = 5s) {
        std::optional<LineCall> heard_call;
        (void)soon([&] { return (heard_call = link->take_call()).has_value(); }, patience);
        return heard_call;
    }
    std::string notices() {
        for (const Text& t : link->take_notices()) said += t.english() + "\n";
        return said;
    }

    std::optional<Broker> broker{std::in_place};
    std::unique_ptr<LineLink> link;
    LineState state;
    std::string said;
};

TEST_F(MqttLine, KeepsStateAndResultForWhoComesLater) {
    open();
    link->publish(told_part(7));
    EXPECT_TRUE(state_is("part", "CAR-7"));
    const json shown = heard("STATE");
    EXPECT_EQ(shown["online"], true);
    EXPECT_EQ(shown["state"], "ready");
    const json result = heard("NDATA");
    EXPECT_EQ(result["result"], "corrected");
    EXPECT_EQ(result["run"], 7);
    EXPECT_EQ(result["regions"][0]["shift_mm"], json({1.2345, -2.5, 0.0004}));
    EXPECT_EQ(result["regions"][0]["sigma_abc_deg"][1], 0.0021);
    link.reset();
    EXPECT_TRUE(state_is("online", false)) << "a good-bye in an orderly way";
}

// The broker says it in the place of a program that cannot.
TEST_F(MqttLine, ItsLastWillIsSaidWhenItDies) {
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        auto opened =
            open_line("mqtt", {{"port", broker->port()}, {"group", "hall"}, {"node", "door left"}}, "");
        ::pause();
        ::_exit(0);
    }
    EXPECT_TRUE(state_is("online", true));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    EXPECT_TRUE(state_is("online", false));
}

TEST_F(MqttLine, CommandsCallForParts) {
    open();
    EXPECT_TRUE(state_is("online", true));
    EXPECT_EQ(
        command(R"({"id":"1","start":true,"part_type":2,"part_number":815,"part_name":"CAR-815"})").exit_code,
        0);
    const auto first = call();
    ASSERT_TRUE(first);
    EXPECT_EQ(first->part.type, 2);
    EXPECT_EQ(first->part.id(), "CAR-815");
    command(R"({"id":"2","start":true})");
    EXPECT_TRUE(soon([&] { return notices().find("a part is measured") != said.npos; }));
    EXPECT_FALSE(link->given_up());
    command(R"({"id":"3","start":false})");
    EXPECT_TRUE(soon([&] { return link->given_up(); }));
    link->publish(told_part(1));
    EXPECT_FALSE(link->given_up());
    command(R"({"id":"4","start":true})");
    EXPECT_TRUE(call());
    link->publish(told_part(2));
    command(R"({"id":"4","start":true})");  // QoS 1 may say it twice
    EXPECT_FALSE(call(300ms));
    command(R"({"id":"1","start":true,"part_name":"LATE"})");  // late, with others between
    EXPECT_FALSE(call(300ms));
    command(R"({"id":"5","part_number":9})");
    EXPECT_TRUE(soon([&] { return link->take_announced().number == 9; }));
    EXPECT_EQ(link->take_announced(), LinePart{});  // not the next part too
}

TEST_F(MqttLine, WhatIsNoCommandStartsNothing) {
    // Kept by the broker from an hour ago.
    command(R"({"id":"old","start":true})", "-r");
    open();
    EXPECT_TRUE(soon([&] { return notices().find("retained") != said.npos; }));
    for (const char* bad :
         {"", "start", "{}", "[1]", "null", R"({"id":"1","start":"yes"})", R"({"start":true})",
          R"({"id":"1","start":true,"part_type":-1})", R"({"id":"1","start":true,"speed":3})"}) {
        // One after the other: of many at once the last ones are not told.
        const auto told = notices().size();
        command(bad);
        EXPECT_TRUE(soon([&] { return notices().size() > told; })) << bad;
    }
    broker->pub("-t 'seamwright/hall/NCMD/door left' -f " MOSQUITTO_BROKER);
    EXPECT_TRUE(soon([&] { return notices().find("over 4096") != said.npos; }));
    EXPECT_FALSE(call(100ms));
    command(R"({"id":"good","start":true})");
    EXPECT_TRUE(call());
}

TEST_F(MqttLine, ACallThatNobodyFollowsIsAnswered) {
    open({{"call_timeout_ms", 100}});
    EXPECT_TRUE(state_is("online", true));
    command(R"({"id":"1","start":true,"part_number":5})");
    const json result = heard("NDATA");
    EXPECT_EQ(result["result"], "not_measured");
    EXPECT_EQ(result["alarm"], 30);
    EXPECT_EQ(result["part_number"], 5);
    EXPECT_FALSE(link->take_call());
}

// Everything that came while it was away is told, in order, and telling takes no time meanwhile.
TEST_F(MqttLine, ABrokerThatIsKilledLosesNothing) {
    open();
    ASSERT_TRUE(soon([&] { return link->connected(); }));
    broker->kill();
    auto longest = 0ns;
    for (std::uint32_t i = 1; i <= 50; ++i) {
        const LineState part = told_part(i);
        const auto begun = std::chrono::steady_clock::now();
        link->publish(part);
        (void)link->take_call();
        longest = std::max<std::chrono::nanoseconds>(longest, std::chrono::steady_clock::now() - begun);
        std::this_thread::sleep_for(2ms);
    }
    RecordProperty("longest_us", static_cast<int>(longest / 1us));
    EXPECT_LT(longest, 1s);
    // Heard from the first moment on: the listener is there before the station may come back.
    broker->again();
    const std::string all = broker->sub("-q 1 -C 1 -W 10 -t 'seamwright/hall/NDATA/door left'");
    EXPECT_THAT(all, HasSubstr("\"run\":"));
    EXPECT_TRUE(soon([&] { return heard("NDATA").value("run", 0) == 50; })) << "the newest is what is kept";
    EXPECT_TRUE(soon([&] { return link->connected(); }));
    EXPECT_THAT(notices(), HasSubstr("does not answer"));
    EXPECT_THAT(said, HasSubstr("answers again"));
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 2) << said;
}

// A listener is there from before the station may come back: its password is not known to the broker until then.
TEST_F(MqttLine, EveryResultIsHeardAcrossKills) {
    const TemporaryFolder folder;
    const auto passwords = folder.write("passwords", ""), said_to = folder.path() / "heard";
    const auto know = [&](const std::string& user) {
        std::ofstream(passwords, std::ios::trunc).flush();
        EXPECT_EQ(shell("mosquitto_passwd -b " + passwords.string() + " " + user + " secret").exit_code, 0);
    };
    folder.write("password", "secret\n");
    know("door");
    broker.emplace("allow_anonymous true\npassword_file " + passwords.string() + "\n");
    open({{"username", "door"}, {"password_file", (folder.path() / "password").string()}});
    const auto text = [&] {
        std::ostringstream all;
        all << std::ifstream(said_to).rdbuf();
        return all.str();
    };
    std::uint32_t told = 0;
    for (int kill = 0; kill < 3; ++kill) {
        ASSERT_TRUE(soon([&] { return link->connected(); }));
        broker->kill();
        ASSERT_TRUE(soon([&] { return !link->connected(); }));
        for (int i = 0; i < 30; ++i) link->publish(told_part(++told));
        know("somebody");
        ASSERT_TRUE(broker->again());
        const auto before = text().size();
        const Child listener(
            {"/usr/bin/stdbuf", "-oL", MOSQUITTO_SUB, "-h", "127.0.0.1", "-p", std::to_string(broker->port()),
             "-q", "1", "-d", "-t", "seamwright/hall/NDATA/door left"},
            said_to);
        ASSERT_TRUE(soon([&] { return text().find("Subscribed", before) != std::string::npos; })) << text();
        know("door");
        broker->reread();
        EXPECT_TRUE(
            soon([&] { return text().find("\"run\":" + std::to_string(told) + ",") != std::string::npos; }));
    }
    std::vector<int> runs;
    std::istringstream lines(text());
    for (std::string line; std::getline(lines, line);)
        if (line.starts_with("{")) runs.push_back(json::parse(line).value("run", 0));
    EXPECT_TRUE(std::is_sorted(runs.begin(), runs.end())) << "in their order";
    EXPECT_EQ(std::set<int>(runs.begin(), runs.end()).size(), told);
}

TEST_F(MqttLine, TheQueueIsBoundedAndSaysSo) {
    broker->kill();
    open({{"queue", 10}});
    for (std::uint32_t i = 1; i <= 100; ++i) link->publish(told_part(i));
    EXPECT_THAT(notices(), HasSubstr("more than 10 results"));
    ASSERT_TRUE(broker->again());
    EXPECT_TRUE(soon([&] { return heard("NDATA").value("run", 0) == 100; }));
}

TEST_F(MqttLine, AFrozenBrokerIsAwayAndNobodyWaits) {
    open({{"keepalive_s", 5}});
    ASSERT_TRUE(soon([&] { return link->connected(); }));
    broker->freeze();
    const auto begun = std::chrono::steady_clock::now();
    for (std::uint32_t i = 1; i <= 500; ++i) link->publish(told_part(i));
    EXPECT_LT(std::chrono::steady_clock::now() - begun, 2s);
    EXPECT_TRUE(soon([&] { return !link->connected(); }, 20s));
    broker->thaw();
    EXPECT_TRUE(soon([&] { return link->connected(); }));
    EXPECT_TRUE(soon([&] { return heard("NDATA").value("run", 0) == 500; }));
}

TEST_F(MqttLine, APasswordIsAskedForAndNeverSaid) {
    const TemporaryFolder folder;
    const auto file = (folder.path() / "passwords").string();
    ASSERT_EQ(shell("mosquitto_passwd -b -c " + file + " door top-secret").exit_code, 0);
    broker.emplace("allow_anonymous false\npassword_file " + file + "\n");
    std::ofstream(folder.path() / "secret") << "top-secret\n";
    open({{"username", "door"}, {"password_file", (folder.path() / "secret").string()}});
    EXPECT_TRUE(soon([&] { return link->connected(); }));
    link.reset();
    ::setenv("SEAMWRIGHT_TEST_PASSWORD", "wrong-secret", 1);
    open({{"username", "door"}, {"password_env", "SEAMWRIGHT_TEST_PASSWORD"}});
    EXPECT_TRUE(soon([&] { return !notices().empty(); }));
    EXPECT_FALSE(link->connected());
    EXPECT_THAT(said, HasSubstr("not authorised"));
    EXPECT_THAT(said, testing::Not(HasSubstr("secret")));
    EXPECT_THAT(said, testing::Not(HasSubstr("unencrypted"))) << "it stays on this machine";
    said.clear();
    open({{"address", "192.0.2.1"}, {"username", "door"}, {"password_env", "SEAMWRIGHT_TEST_PASSWORD"}});
    EXPECT_THAT(notices(), HasSubstr("unencrypted"));
}

TEST_F(MqttLine, TalksTlsAndChecksTheCertificate) {
    const TemporaryFolder folder;
    const auto at = [&](const char* name) { return (folder.path() / name).string(); };
    const auto key = [&](const std::string& name) {
        return shell(
                   "openssl req -x509 -newkey rsa:2048 -nodes -days 2 -subj /CN=127.0.0.1 "
                   "-addext 'subjectAltName=IP:127.0.0.1' -keyout " +
                   at((name + ".key").c_str()) + " -out " + at((name + ".pem").c_str()))
            .exit_code;
    };
    ASSERT_EQ(key("broker"), 0);
    ASSERT_EQ(key("other"), 0);
    broker.emplace("allow_anonymous true\ncertfile " + at("broker.pem") + "\nkeyfile " + at("broker.key") +
                   "\n");
    open({{"tls", true}, {"ca_file", at("broker.pem")}});
    EXPECT_TRUE(soon([&] { return link->connected(); })) << notices();
    open({{"tls", true}, {"ca_file", at("other.pem")}});
    EXPECT_TRUE(soon([&] { return !notices().empty(); }));
    EXPECT_FALSE(link->connected()) << "a broker that nobody vouches for";
    open();
    EXPECT_TRUE(soon([&] { return !notices().empty(); }));
    EXPECT_FALSE(link->connected()) << "not encrypted";
}

}  // namespace
}  // namespace seamwright
