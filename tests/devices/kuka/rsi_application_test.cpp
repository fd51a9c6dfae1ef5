// seamwright_rsi.src as it is delivered, executed: when the robot waits, moves, stops and ends, with the
// release as Seamwright sets it and <Path> as Seamwright reads it.

#include "devices/controllers/kuka/rsi_application.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>

#include "devices/kuka/rsi_program.h"

namespace seamwright::krl {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Clock = std::chrono::steady_clock;

std::vector<ProgramFile> delivered(const nlohmann::json& settings = nlohmann::json::object()) {
    ProgramRequest request;
    request.settings = settings;
    auto files = write_rsi_program(request);
    EXPECT_TRUE(files) << files.error().sentence();
    return *files;
}

// With a line of the program changed.
std::vector<ProgramFile> changed(const std::string& from, const std::string& to) {
    auto files = delivered();
    const auto program = std::find_if(files.begin(), files.end(),
                                      [](const ProgramFile& f) { return f.name == "seamwright_rsi.src"; });
    const auto at = program->text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    program->text.replace(at, from.size(), to);
    return files;
}

// The robot's interpolation cycle, as fast as the program's own threads can follow it.
class RsiRun : public testing::Test {
  protected:
    void load(const std::vector<ProgramFile>& files, double path_s = 0.4) {
        RsiApplicationSettings settings;
        settings.path_s = path_s;
        settings.restart_ms = 60;
        settings.path_over = [this] { ++over_; };
        application_.emplace(settings, files);
    }
    // Cycles until `done`, two seconds at most. The release as `released_` says.
    template <class Done>
    bool cycles(Done done) {
        for (const auto until = Clock::now() + std::chrono::seconds(2); Clock::now() < until;) {
            application_->set_release(released_);
            const RsiApplication::Now before = now_;
            now_ = application_->cycle(4);
            moved_mm_ = (now_.programmed.translation() - before.programmed.translation()).norm();
            if (before.on && now_.on && before.session == now_.session && moved_mm_ > 0) {
                EXPECT_TRUE(now_.under_way);
                way_mm_ += moved_mm_;
            }
            // A stopped path goes from 1 to the end of RSI, never to 0 within the session.
            if (before.on && now_.on && before.session == now_.session && before.under_way && !now_.under_way)
                ++told_over_;
            if (done()) return true;
            std::this_thread::sleep_for(milliseconds(1));
        }
        return false;
    }
    bool for_ms(int ms) {
        const auto until = Clock::now() + milliseconds(ms);
        return cycles([&] { return Clock::now() >= until; });
    }
    std::atomic<int> over_ = 0;
    int told_over_ = 0;
    bool released_ = false;
    double moved_mm_ = 0, way_mm_ = 0;
    RsiApplication::Now now_;
    std::optional<RsiApplication> application_;
};

TEST(RsiProgramFile, IsTakenByTheControllersParser) {
    for (const auto& settings :
         {nlohmann::json::object(), nlohmann::json{{"mode", "relative"}},
          nlohmann::json{{"reference", "tool"}, {"path_output", 4096}, {"release_output", 4095}}}) {
        int programs = 0;
        for (const ProgramFile& f : delivered(settings)) {
            if (!f.name.ends_with(".src") && !f.name.ends_with(".sub") && !f.name.ends_with(".dat")) continue;
            ++programs;
            try {
                (void)parse_module(f.name, f.text);
            } catch (const KrlError& e) {
                ADD_FAILURE() << e.what();
            }
        }
        EXPECT_EQ(programs, 6);
    }
}

TEST_F(RsiRun, WaitsForTheReleaseAndRunsThePathToItsEnd) {
    for (const char* mode : {"absolute", "relative"}) {
        over_ = told_over_ = 0;
        released_ = false;
        load(delivered({{"mode", mode}, {"path_output", 7}, {"release_output", 8}}));
        ASSERT_TRUE(cycles([&] { return now_.on; }));
        EXPECT_EQ(now_.relative, std::string(mode) == "relative");
        way_mm_ = 0;
        ASSERT_TRUE(for_ms(60));
        EXPECT_EQ(way_mm_, 0) << "it waits";
        EXPECT_FALSE(now_.under_way);
        released_ = true;
        ASSERT_TRUE(cycles([&] { return now_.under_way && moved_mm_ > 0; }));
        // As the driver: the release falls once the path is told as over.
        ASSERT_TRUE(cycles([&] { return !now_.under_way; }));
        EXPECT_NEAR(way_mm_, 40, 1e-3) << "0.4 s at 100 mm/s";
        released_ = false;
        const std::uint64_t session = now_.session;
        ASSERT_TRUE(cycles([&] { return now_.session > session; }));
        EXPECT_EQ(over_, 1);
        EXPECT_EQ(told_over_, 1);
        EXPECT_THAT(application_->messages(), IsEmpty());
        application_.reset();
    }
}

TEST_F(RsiRun, AReleaseThatFallsOnThePathStopsItAndTheNextOneBeginsAnew) {
    load(delivered());
    for (int round = 0; round < 2; ++round) {
        ASSERT_TRUE(cycles([&] { return now_.on && !now_.under_way; }));
        const Pose begin = now_.programmed;
        released_ = true;
        way_mm_ = 0;
        ASSERT_TRUE(cycles([&] { return way_mm_ > 5; }));
        const std::uint64_t session = now_.session;
        released_ = false;
        const double then = way_mm_;
        ASSERT_TRUE(cycles([&] { return !now_.on; }));
        EXPECT_LT(way_mm_ - then, 20) << "100 ms of braking";
        ASSERT_TRUE(cycles([&] { return now_.session > session; }));
        EXPECT_LT((now_.programmed.translation() - begin.translation()).norm(), 1e-9);
        ASSERT_TRUE(for_ms(60));
        EXPECT_EQ(moved_mm_, 0) << "it waits again";
    }
    EXPECT_EQ(over_, 0);
    EXPECT_EQ(told_over_, 0);
    EXPECT_THAT(application_->messages(),
                ElementsAre(HasSubstr("the path was stopped"), HasSubstr("the path was stopped")));
}

// However short the release is: no path runs without it, and none is passed over without a word.
TEST_F(RsiRun, AShortReleaseNeverLetsThePathRun) {
    load(delivered());
    int stopped = 0;
    for (int cycles_long = 1; cycles_long <= 12; ++cycles_long) {
        ASSERT_TRUE(cycles([&] { return now_.on && !now_.under_way; }));
        const std::uint64_t session = now_.session;
        const std::size_t said = application_->messages().size();
        way_mm_ = 0;
        released_ = true;
        int n = 0;
        ASSERT_TRUE(cycles([&] { return ++n > cycles_long; }));
        released_ = false;
        ASSERT_TRUE(for_ms(150));
        EXPECT_LT(way_mm_, 35) << cycles_long;
        if (way_mm_ > 0) {
            EXPECT_GT(application_->messages().size(), said) << cycles_long;
        }
        stopped += application_->messages().size() > said;
        if (now_.session == session && now_.on) continue;  // it was too short to be seen
    }
    EXPECT_EQ(over_, 0);
    EXPECT_EQ(told_over_, 0);
    EXPECT_GT(stopped, 3);
}

TEST_F(RsiRun, RsiThatFailsCancelsTheProgram) {
    load(delivered());
    released_ = true;
    ASSERT_TRUE(cycles([&] { return way_mm_ > 5; }));
    application_->rsi_fails();
    released_ = false;
    const std::uint64_t session = now_.session;
    ASSERT_TRUE(cycles([&] { return now_.session > session; }));
    EXPECT_EQ(over_, 0);
    EXPECT_EQ(told_over_, 0);
}

// What would be wrong with the program is seen.
TEST_F(RsiRun, AnotherProgramIsFoundOut) {
    const auto says = [&](const std::vector<ProgramFile>& files) {
        try {
            load(files);
        } catch (const KrlError& e) {
            return std::string(e.what());
        }
        over_ = 0;
        now_ = {};
        way_mm_ = 0;
        released_ = true;
        (void)cycles([&] { return way_mm_ > 5 || !application_->messages().empty(); });
        released_ = false;
        (void)cycles([&] { return over_ > 0 || !application_->messages().empty(); });
        const auto messages = application_->messages();
        return messages.empty() ? std::string() : messages.front();
    };
    EXPECT_EQ(says(changed("INTERRUPT ON 21", "")), "") << "it runs on";
    EXPECT_EQ(over_, 1);
    EXPECT_THAT(says(changed("INTERRUPT DECL 21", "INTERRUPT DECL 41")), HasSubstr("no priority"));
    EXPECT_THAT(says(changed("INTERRUPT ON 21", "INTERRUPT ON 22")), HasSubstr("22 is not declared"));
    EXPECT_THAT(says(changed("seamwright_corrected ( )\n", "seamwright_lost ( )\n")),
                HasSubstr("no program SEAMWRIGHT_LOST"));
    EXPECT_THAT(says(changed("ret = RSI_CREATE(\"SeamwrightRsi.rsi\", contid, TRUE)", "ret = RSIOK")),
                HasSubstr("no context is created"));
    EXPECT_THAT(says(changed("SeamwrightRsi.rsi\"", "Other.rsi\"")), HasSubstr("no file Other.rsi"));
    EXPECT_THAT(says(changed("DECL INT contid", "DECL INT while")), HasSubstr("WHILE is a word of KRL"));
    // RESUME in the program that declares: the path stands in it.
    EXPECT_THAT(
        says(changed("seamwright_corrected ( )\n",
                     "WAIT FOR $OUT[102]\n$OUT[101]=TRUE\nINTERRUPT ON 21\nLIN $POS_ACT\nWAIT SEC 0\n")),
        HasSubstr("RESUME: the program that declared the interrupt"));
}

}  // namespace
}  // namespace seamwright::krl
