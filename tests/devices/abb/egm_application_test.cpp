// SeamwrightEgm.mod as it is delivered, executed: when EGM talks, runs, stops and ends, with the permission as the
// measuring controller gives it and the answers as Seamwright sends them.

#include "devices/controllers/abb/egm_application.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "devices/abb/program.h"

namespace seamwright::rapid {
namespace {

using std::chrono::milliseconds;
using testing::Contains;
using testing::HasSubstr;
using Clock = std::chrono::steady_clock;

constexpr const char* kPlant = R"(MODULE Plant
PERS bool simPermitted:=FALSE;
PERS bool simStopped:=FALSE;
LOCAL CONST robtarget point:=[[0,0,0],[1,0,0,0],[0,0,0,0],[9E+09,9E+09,9E+09,9E+09,9E+09,9E+09]];
PROC main()
SeamwrightEgmPath point,point,point,point,tool0,wobj0,v100;
WaitTime 0.1;
ENDPROC
FUNC bool SW_Take(\num MaxTime)
WaitUntil simPermitted\MaxTime:=3\PollRate:=0.004;
RETURN TRUE;
ERROR
RETURN FALSE;
ENDFUNC
ENDMODULE
)";

std::string delivered() {
    ProgramRequest request;
    request.driver = "abb-egm";
    const auto files = write_abb_program(request);
    EXPECT_TRUE(files) << files.error().sentence();
    return files->back().text;
}
std::string changed(const std::string& from, const std::string& to) {
    std::string text = delivered();
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}

// The cycle of EGM, as fast as the program's own thread can follow it.
class EgmRun : public testing::Test {
  protected:
    void load(const std::string& module = delivered()) {
        EgmApplicationSettings settings;
        settings.lead_s = 0.2;
        settings.path_s = 0.3;
        settings.restart_ms = 60;
        application_.emplace(settings,
                             std::vector<SourceText>{{"Plant.mod", kPlant}, {"SeamwrightEgm.mod", module}});
    }
    template <class Done>
    bool cycles(Done done, int ms = 20000) {
        for (const auto until = Clock::now() + milliseconds(ms); Clock::now() < until;) {
            const auto before = now_;
            now_ = application_->cycle(4, answered_, permitted_);
            const double moved_mm = (now_.programmed.translation() - before.programmed.translation()).norm();
            if (now_.mci == EgmMci::running && before.mci == EgmMci::running) way_mm_ += moved_mm;
            if (before.talks && !now_.talks) heard_at_end_ = before.mci;
            if (done()) return true;
            std::this_thread::sleep_for(milliseconds(4));
        }
        return false;
    }
    bool answered_ = true, permitted_ = false;
    double way_mm_ = 0;
    EgmMci heard_at_end_ = EgmMci::undefined;  // the last that was told before EGM fell silent
    EgmApplication::Now now_;
    std::optional<EgmApplication> application_;
};

TEST_F(EgmRun, TheSeamWaitsForThePermissionAndItsEndIsTold) {
    load();
    ASSERT_TRUE(cycles([&] { return now_.talks && now_.mci == EgmMci::running; }));
    ASSERT_TRUE(cycles([&] { return way_mm_ > 19; }));
    (void)cycles([] { return false; }, 200);
    EXPECT_NEAR(way_mm_, 20, 1) << "the lead-in alone: 0.2 s at 100 mm/s";
    permitted_ = true;
    ASSERT_TRUE(cycles([&] { return now_.paths == 1; }));
    permitted_ = false;
    EXPECT_NEAR(way_mm_, 50, 1);
    EXPECT_TRUE(now_.talks);
    EXPECT_EQ(now_.mci, EgmMci::stopped);
    ASSERT_TRUE(cycles([&] { return !now_.talks; }));
    EXPECT_EQ(heard_at_end_, EgmMci::stopped);
    EXPECT_EQ(now_.stops, 0u);
    // A module that resets EGM at once tells nobody that the path was run to its end.
    load(changed("WaitTime 0.5;", ""));
    now_ = {};
    heard_at_end_ = EgmMci::undefined;
    permitted_ = true;
    int stopped = 0;
    ASSERT_TRUE(cycles([&] {
        stopped += now_.mci == EgmMci::stopped && now_.paths == 1;
        return now_.paths == 1 && !now_.talks;
    }));
    EXPECT_LT(stopped, 60) << "cycles of 4 ms, of 125 with it";
}

TEST_F(EgmRun, WithoutPermissionTheSeamIsNotRun) {
    load();
    ASSERT_TRUE(cycles([&] { return now_.mci == EgmMci::running; }));
    ASSERT_TRUE(cycles([&] { return !now_.talks; }));
    EXPECT_LT(way_mm_, 21);
    EXPECT_EQ(now_.paths, 0u);
    EXPECT_THAT(application_->messages(), Contains(HasSubstr("has not released this part")));
    EXPECT_TRUE(cycles([&] { return now_.mci == EgmMci::running; })) << "the operator starts it again";
}

TEST_F(EgmRun, WithoutAnswersItIsStoppedAndNotRunOn) {
    load(changed("CommTimeout:=1", "CommTimeout:=0.1"));
    permitted_ = true;
    ASSERT_TRUE(cycles([&] { return way_mm_ > 25; }));
    answered_ = permitted_ = false;
    const double then = way_mm_;
    ASSERT_TRUE(cycles([&] { return now_.stops == 1; }));
    EXPECT_LT(way_mm_ - then, 20) << "0.1 s at 100 mm/s";
    const Pose at = now_.programmed;
    ASSERT_TRUE(cycles([&] { return !now_.talks; }));
    EXPECT_LT(distance_mm(now_.programmed, at), 1e-9);
    EXPECT_EQ(now_.paths, 0u);
    ASSERT_TRUE(cycles([&] { return application_->messages().size() > 1; }));
    EXPECT_THAT(application_->messages()[0], HasSubstr("the path was stopped"));
    EXPECT_THAT(application_->messages()[1], HasSubstr("Plant.mod, line 6: an error is raised"))
        << "to the caller";
    answered_ = true;
    EXPECT_TRUE(cycles([&] { return now_.mci == EgmMci::running; }));
}

// What would be wrong with the module is seen.
TEST_F(EgmRun, AnotherModuleIsFoundOut) {
    const auto says = [&](const std::string& module) -> std::string {
        try {
            load(module);
        } catch (const LoadError& e) {
            return e.what();
        }
        permitted_ = true;
        (void)cycles([&] { return now_.paths > 0 || !application_->messages().empty(); });
        const auto messages = application_->messages();
        return messages.empty() ? "" : messages[0];
    };
    EXPECT_EQ(says(delivered()), "");
    EXPECT_THAT(says(changed("EGMGetId egm_id;", "")), HasSubstr("EGMGetId"));
    EXPECT_THAT(says(changed("EGMActMove egm_id, tool_used.tframe\\SampleRate:=4;", "")),
                HasSubstr("not activated"));
    EXPECT_THAT(says(changed("SampleRate:=4", "SampleRate:=5")), HasSubstr("no sample rate of 5 ms"));
    EXPECT_THAT(says(changed("\\PathCorr", "\\Pose_1")), HasSubstr("PathCorr"));
    EXPECT_THAT(says(changed("MoveL start, speed, fine", "MoveL start, speed, z5")), HasSubstr("fine point"));
    EXPECT_THAT(says(changed("\"UCdevice\"", "\"Other\"")), HasSubstr("no UdpUc device Other"));
    EXPECT_THAT(says(changed("LOCAL VAR egmident egm_id", "LOCAL VAR egmident to")),
                HasSubstr("reserved word"));
}

}  // namespace
}  // namespace seamwright::rapid
